//! Feature reconstruction: from a cloud of points to a blended feature on the part.
//!
//! A region of a primary surface was replaced by a secondary one, and the edge between them rounded by a rolling ball.
//! From points of the secondary and of the blend follow the limiting line (the sharp edge that is no more), the secondary
//! surface, the radius and the blend; they take the region's place in the body.

pub mod backbone;
pub mod ball;
pub mod blend_surface;
pub mod chord_sampling;
pub mod deviation;
pub mod error;
pub mod feet;
pub mod fishbone;
pub mod guide;
pub mod limiting_line;
pub mod metric;
pub mod path;
pub mod polynomial_slice;
pub mod profile;
pub mod radius;
pub mod radius_law;
pub mod radius_on_primary;
pub mod relief;
pub mod rolling;
pub mod secondary;
pub mod sewing;
pub mod smoothing;

pub use error::ReconstructionError;
pub use feet::{Foot, Projector};

/// Whether a line comes back to its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Closure {
    /// Its last point is followed by its first.
    Closed,
    /// It has two ends.
    Open,
}

#[cfg(test)]
mod tests;
