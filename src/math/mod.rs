//! Vectors, frames, affine maps, roots, quadrature, sparse and banded solves.
//!
//! The only room that names the matrix crates; it knows nothing of curves or files.

pub mod affine;
pub mod banded;
pub mod banded_cholesky;
pub mod bounds;
pub mod frame;
pub mod grid_matrix;
pub mod least_squares;
pub mod nested_dissection;
pub mod quadrature;
pub mod rigid_fit;
pub mod sparse;

pub use affine::{Affine, cofactor, minimal_rotation};
pub use bounds::BoundingBox;
pub use frame::Frame;
pub use grid_matrix::{GridFactor, GridMatrix, GridRow};
pub use least_squares::{NormalEquations, PrincipalAxes, Solution};
pub use nalgebra::{Matrix2, Matrix3, Point2, Point3, Vector2, Vector3, Vector4};
pub use nested_dissection::nested_dissection;
pub use rigid_fit::{nearest_rotation, rigid_fit};
pub use sprs::{CsMat, TriMat, kronecker_product};
