//! Simplify: knots of a B-spline face go where the surface does without them, within a certified distance.
//!
//! A paste runs its new knots through the whole target; those that carry nothing can go again. Rows and columns along the
//! border, and all that acts on a loop of the face, keep their places. Pure: no I/O. All or nothing.
//!
//! The numeric core ([`simplified`]) takes a surface and cells to hold. It knows neither models nor files.

pub mod error;
pub mod plan;
mod remove;

pub use error::SimplifyError;
pub use remove::{Held, Simplified, simplified};
