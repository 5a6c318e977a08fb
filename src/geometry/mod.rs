//! Curves and surfaces of ISO 10303-42, in two and three dimensions.
//!
//! Knows neither topology nor files. Angles are radians here, whatever the file counts in; lengths are
//! in file units.

pub mod bounded;
pub mod bspline_wavelet;
pub mod curve;
pub mod curve2d;
mod evaluate_curve;
mod evaluate_surface;
mod foot_on_curve;
pub mod nurbs;
pub mod parameters;
mod replica;
pub mod surface;
pub mod to_nurbs;
pub mod transform;

pub use bounded::{Composite, Segment, Trimmed};
pub use curve::Curve;
pub use curve2d::Curve2d;
pub use evaluate_surface::Repetition;
pub use nurbs::SurfaceDerivatives;
pub use surface::{Patch, PatchGrid, Surface};
pub use to_nurbs::{ParameterLine, ToNurbsError};
pub use transform::{NotRepresentable, ParameterMap};

/// Geometry that was read, or the entity name of geometry that is only carried.
///
/// Carried geometry stays in the file untouched; an operation that needs it says which entity it
/// cannot use.
#[derive(Debug, Clone, PartialEq)]
pub enum Carried<G> {
    /// Understood and valid.
    Read(G),
    /// Not understood: the entity name in the file, and why.
    Unread {
        /// Entity name, upper case (`OFFSET_SURFACE`), or empty when the reference dangles.
        entity: String,
        /// Lower-case fragment: `not read yet`, `9 knots expected, found 8`.
        reason: String,
    },
}

impl<G> Carried<G> {
    /// The geometry, if it was read.
    #[must_use]
    pub fn read(&self) -> Option<&G> {
        match self {
            Self::Read(geometry) => Some(geometry),
            Self::Unread { .. } => None,
        }
    }
}
