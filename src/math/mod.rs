//! Vectors, frames, roots, quadrature, sparse assembly and solves.
//!
//! The only room that names the matrix crates; it knows nothing of curves or files.

pub mod frame;

pub use frame::Frame;
pub use nalgebra::{Matrix2, Matrix3, Point2, Point3, Vector2, Vector3, Vector4};
