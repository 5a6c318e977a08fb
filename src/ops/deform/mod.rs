//! Deform: lines on a B-spline face are pulled to given curves or points, and the face follows as a network of bars does.
//!
//! The border of the face, its loops and its neighbours stay as they are, so that a solid stays closed. Pure: no I/O. All or
//! nothing.

pub mod error;
mod line;
mod net;
pub mod plan;

pub use error::DeformError;
pub use line::{Line, Normal, Path};
pub use plan::{Form, Measures, Params, Plan, plan};
