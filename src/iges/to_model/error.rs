//! Why an entity does not give the element that it is asked for.

use super::code::ModelCode;
use crate::geometry::ToNurbsError;
use crate::geometry::nurbs::{KnotVectorError, NetError};
use crate::iges::EntryNumber;
use crate::iges::view::{FieldError, OUT_OF_RANGE};

/// Why geometry or topology cannot be read from an entity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(in crate::iges) enum ReadError {
    /// An entity, or a form of one, that the program carries only.
    #[error("not read yet")]
    NotReadYet,
    /// A kind of geometry within an entity that is not read.
    #[error("{0}: not read yet")]
    KindNotReadYet(&'static str),
    /// Another entity that this one is made of.
    #[error("{field} {number} {entity}: {source}")]
    Basis { field: &'static str, number: EntryNumber, entity: &'static str, source: Box<Self> },
    /// A pointer without an entry.
    #[error("{0} is not in the file")]
    Dangling(EntryNumber),
    /// A pointer to the wrong kind of entity.
    #[error("{number} is {found}, expected {expected}")]
    WrongEntity { number: EntryNumber, found: &'static str, expected: &'static str },
    /// Pointers that return to where they came from, or a chain beyond any use.
    #[error("the pointers from {0} return to themselves or are nested too deep")]
    Cycle(EntryNumber),
    /// A field that is not what the schema says.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A radius, semi-axis or the like.
    #[error("{field} is {value}, expected a positive number")]
    NotPositive { field: &'static str, value: f64 },
    /// A cone that is a cylinder or a plane.
    #[error("the semi-angle is {degrees} degrees, expected an angle between 0 and a right angle")]
    SemiAngle { degrees: f64 },
    /// A vector of length zero.
    #[error("{field} has length zero")]
    ZeroVector { field: &'static str },
    /// A line, arc or conic without extent.
    #[error("start and end are the same point")]
    NoExtent,
    /// Coefficients of no conic in standard position.
    #[error("the coefficients are those of no ellipse, parabola or hyperbola with axes along x and y")]
    NoConic,
    /// Knots that are none.
    #[error(transparent)]
    Knots(#[from] KnotVectorError),
    /// A net that does not fit its knots, or has bad numbers.
    #[error(transparent)]
    Net(#[from] NetError),
    /// A curve or surface without the exact form that is needed here.
    #[error(transparent)]
    Exact(#[from] ToNurbsError),
    /// A range of parameters without extent.
    #[error("nothing lies between the parameters {from} and {to}")]
    EmptyRange { from: f64, to: f64 },
    /// A matrix that flattens what it moves.
    #[error("the transformation {0} flattens what it moves")]
    Flat(EntryNumber),
    /// An affine image that no kind of geometry has.
    #[error("{0}")]
    Image(String),
    /// An index into a list that the list does not have.
    #[error("{field} is {index}, and {list} has {count} members")]
    Index { field: &'static str, index: i64, list: EntryNumber, count: usize },
    /// A loop without edges, a shell without faces, a composite without curves.
    #[error("{0} is empty")]
    Empty(&'static str),
    /// A surface without natural bounds.
    #[error("a {kind} has no bounds of its own")]
    Unbounded { kind: &'static str },
}

impl ReadError {
    /// The code to report a geometry's failure under.
    pub(super) fn geometry_code(&self) -> ModelCode {
        match self {
            Self::NotReadYet | Self::KindNotReadYet(_) => ModelCode::NotReadYet,
            Self::Basis { source, .. } => source.geometry_code(),
            _ => self.code_or(ModelCode::BadGeometry),
        }
    }

    /// The code to report a topological element's failure under.
    pub(super) fn topology_code(&self) -> ModelCode {
        match self {
            Self::Basis { source, .. } => source.topology_code(),
            _ => self.code_or(ModelCode::BadTopology),
        }
    }

    fn code_or(&self, other: ModelCode) -> ModelCode {
        match self {
            Self::Dangling(_) => ModelCode::Dangling,
            Self::Cycle(_) => ModelCode::Cycle,
            Self::Field(error) if error.found == OUT_OF_RANGE => ModelCode::NotFinite,
            _ => other,
        }
    }
}
