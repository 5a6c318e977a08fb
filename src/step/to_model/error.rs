//! Why a record does not give the element that it is asked for.

use super::code::ModelCode;
use crate::geometry::nurbs::{KnotVectorError, NetError};
use crate::step::InstanceName;
use crate::step::view::{AttributeError, OUT_OF_RANGE};

/// Why geometry or topology cannot be read from a record.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum ReadError {
    /// An entity that the program carries only.
    #[error("not read yet")]
    NotReadYet,
    /// A curve that a surface is made of.
    #[error("{attribute} {name} {entity}: {source}")]
    Basis { attribute: &'static str, name: InstanceName, entity: String, source: Box<Self> },
    /// A reference without a record.
    #[error("{0} is not in the file")]
    Dangling(InstanceName),
    /// A reference to the wrong kind of record.
    #[error("{name} is {found}, expected {expected}")]
    WrongEntity { name: InstanceName, found: String, expected: &'static str },
    /// References that return to where they came from, or a chain beyond any use.
    #[error("the references from {0} return to themselves or are nested too deep")]
    Cycle(InstanceName),
    /// An attribute that is not what the schema says.
    #[error(transparent)]
    Attribute(#[from] AttributeError),
    /// A word of an SI unit that is none, or not the one of the quantity.
    #[error("the word `{found}` of the unit is not known here, expected {expected}")]
    UnitName { found: String, expected: String },
    /// A radius, semi-axis or the like.
    #[error("{attribute} is {value}, expected a positive number")]
    NotPositive { attribute: &'static str, value: f64 },
    /// A cone that is a cylinder or a plane.
    #[error("semi_angle is {radians} rad, expected an angle between 0 and a right angle")]
    SemiAngle { radians: f64 },
    /// Coordinates or direction ratios are too few, not numbers, or all zero.
    #[error("{0} has no two or three coordinates")]
    Coordinates(InstanceName),
    /// A coordinate or direction ratio that no number of 64 bits holds.
    #[error("{0} has the coordinate {1}, which is beyond every finite number; write it as a finite real")]
    NotFinite(InstanceName, String),
    /// A direction of length zero.
    #[error("{0} is a direction of length zero")]
    ZeroDirection(InstanceName),
    /// A multiplicity that is no positive integer.
    #[error("multiplicity {index} (from 0){direction} is {}, expected an integer of at least 1", whole(.value))]
    Multiplicity { direction: &'static str, index: usize, value: Option<i64> },
    /// Count of knots.
    #[error(
        "{expected} knots{direction} expected for degree {degree} and {points} control points, found {found}"
    )]
    KnotCount { direction: &'static str, degree: usize, points: usize, expected: usize, found: usize },
    /// The rows of a net differ in length.
    #[error("row {row} of the net has {found} members, expected {expected}")]
    RaggedNet { row: usize, expected: usize, found: usize },
    /// Weights do not fit the net.
    #[error("{expected} weights expected, found {found}")]
    WeightCount { expected: usize, found: usize },
    /// Knots that are none.
    #[error(transparent)]
    Knots(#[from] KnotVectorError),
    /// A net that does not fit its knots, or has bad numbers.
    #[error(transparent)]
    Net(#[from] NetError),
    /// A piece of a curve or surface without extent.
    #[error("nothing lies between the trims {from} and {to}")]
    NoPiece { from: f64, to: f64 },
    /// A part of a composite without ends.
    #[error("{attribute} has a member without ends, or is no full grid")]
    Unbounded { attribute: &'static str },
    /// A loop without edges, a shell without faces.
    #[error("{attribute} is empty")]
    Empty { attribute: &'static str },
}

fn whole(value: &Option<i64>) -> String {
    value.map_or_else(|| "no integer".to_owned(), |value| value.to_string())
}

impl ReadError {
    /// The code to report a geometry's failure under.
    pub(super) fn geometry_code(&self) -> ModelCode {
        match self {
            Self::NotReadYet => ModelCode::NotReadYet,
            Self::Basis { source, .. } => source.geometry_code(),
            Self::Dangling(_) => ModelCode::Dangling,
            Self::Cycle(_) => ModelCode::Cycle,
            _ if self.is_not_finite() => ModelCode::NotFinite,
            _ => ModelCode::BadGeometry,
        }
    }

    /// The code to report a topological element's failure under.
    pub(super) fn topology_code(&self) -> ModelCode {
        match self {
            Self::Dangling(_) => ModelCode::Dangling,
            Self::Cycle(_) => ModelCode::Cycle,
            _ if self.is_not_finite() => ModelCode::NotFinite,
            _ => ModelCode::BadTopology,
        }
    }

    /// Whether a number of the file is beyond every finite one.
    fn is_not_finite(&self) -> bool {
        match self {
            Self::NotFinite(..) => true,
            Self::Attribute(error) => error.found == OUT_OF_RANGE,
            _ => false,
        }
    }
}
