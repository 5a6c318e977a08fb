//! Non-uniform rational B-splines after The NURBS Book.
//!
//! `knot_vector` is the one holder of knots; `curve` and `surface` are the nets. Nets are flat arrays of
//! homogeneous points `(w x, w y, …, w)`.

pub mod basis;
mod bezier;
pub mod curve;
mod degree;
pub mod deviation;
pub mod evaluate;
mod extend;
pub mod gram;
pub mod interpolate;
pub mod join;
pub mod knot_vector;
mod mended;
mod open;
pub mod project;
mod refine;
mod reshape;
pub mod surface;

pub use basis::LocalBasis;
pub use curve::{NurbsCurve, NurbsCurve2, NurbsCurve3};
pub use deviation::{Accuracy, Deviation, deviation, deviation_at_equal_parameters};
pub use evaluate::SurfaceDerivatives;
pub use extend::ExtensionError;
pub use gram::{gram, gram_band};
pub use interpolate::{GrevilleCollocation, interpolate_grid};
pub use join::JoinError;
pub use knot_vector::{KnotVector, KnotVectorError};
pub use project::{CurveProjection, SearchRange, SurfaceLocator, SurfaceProjection, Wrap, foot_point};
pub use surface::NurbsSurface;

/// The net does not fit the knots, or a weight is not a positive number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NetError {
    /// The count of control points is not what the knots ask for.
    #[error("{expected} control points expected for degree and knots, found {found}")]
    CountMismatch {
        /// Count that the knots ask for.
        expected: usize,
        /// Count given.
        found: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("control point {index} is not finite")]
    NotFinite {
        /// Index in the flat net.
        index: usize,
    },
    /// A weight is zero, negative or not finite.
    #[error("weight {index} is {weight}, expected a positive number")]
    NonPositiveWeight {
        /// Index in the flat net.
        index: usize,
        /// Weight found.
        weight: f64,
    },
}
