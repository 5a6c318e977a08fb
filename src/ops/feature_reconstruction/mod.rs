//! Feature reconstruction: a region of a part that was replaced by another surface, rebuilt from a cloud of points.
//!
//! Pure: clouds come as points, results go as geometry.

pub mod feet;

pub use feet::{Foot, Projector};
