//! What operations on nets share: knot cells and the control points that act on them, polygons in parameters, exact
//! energies, systems over a net, sampling, and the loops of a face in its parameters.
//!
//! Knows no operation.

pub mod acting;
pub mod cells;
pub mod creases;
pub mod grams;
pub mod grid_system;
pub mod knot_removal;
pub mod layout;
pub mod polygon;
pub mod sampling;
pub mod spline_form;

pub use cells::{CellGrid, Mask};
pub use grid_system::GridSystem;
pub use knot_removal::KnotRows;
pub use polygon::{Contour, Domain, Polygon, PolygonFault};
