//! What a file says of its shape beside the shape: dimensions, tolerances, datums, notes, validation properties
//! and tessellations, and which elements each speaks of.
//!
//! Recognised and linked, not understood: whether a tolerance holds is nobody's knowledge here.

use super::{Model, Origin};
use crate::brep::{BodyId, EdgeId, FaceId};

/// One such statement.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    /// What it is.
    pub kind: AnnotationKind,
    /// Name of its entity in the file.
    pub entity: String,
    /// Decoded name; the letter of a datum.
    pub name: String,
    /// Numbers that it states, in the units that stand beside them.
    pub values: Vec<Measure>,
    /// Its record.
    pub origin: Origin,
    /// What it speaks of, in file order and each once; empty when the file ties it to nothing that is known.
    pub on: Vec<Element>,
}

/// Kinds of annotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AnnotationKind {
    /// A size, or a location of one feature from another.
    Dimension,
    /// A geometric tolerance.
    Tolerance,
    /// A datum, or a target of one.
    Datum,
    /// What is drawn: callouts and annotation occurrences.
    Presentation,
    /// What the sender measured.
    ValidationProperty,
    /// Triangles or polylines that stand for geometry or for what is drawn.
    Tessellation,
}

impl AnnotationKind {
    /// Word in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Dimension => "dimension",
            Self::Tolerance => "tolerance",
            Self::Datum => "datum",
            Self::Presentation => "presentation",
            Self::ValidationProperty => "validation_property",
            Self::Tessellation => "tessellation",
        }
    }
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// Name of its item, decoded: `volume measure`, `surface area measure`, `centre point`.
    pub name: String,
    /// As written.
    pub value: f64,
    /// How many metres, or square or cubic metres, one is; `None` where the file does not say, or it is of another
    /// quantity.
    pub metres: Option<f64>,
    /// Name of the unit of length or angle; empty for any other.
    pub unit: String,
    /// Record of its item: the three coordinates of a point have one.
    pub origin: Origin,
}

/// What an annotation speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Element {
    /// A face.
    Face(FaceId),
    /// An edge.
    Edge(EdgeId),
    /// A body.
    Body(BodyId),
    /// A product: an index into [`Model::products`].
    Product(usize),
    /// A use of a product: an index into [`Model::occurrences`].
    Occurrence(usize),
}

impl Model {
    /// Annotations that speak of a face itself.
    pub fn annotations_on(&self, face: FaceId) -> impl Iterator<Item = &Annotation> {
        self.annotations.iter().filter(move |annotation| annotation.on.contains(&Element::Face(face)))
    }
}
