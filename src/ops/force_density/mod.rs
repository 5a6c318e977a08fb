//! Force density: a B-spline surface deformed as a network of bars is by loads, until points of it lie where they should.
//!
//! Nodes of the network are the control points, bars join neighbours along both directions of the net, and each bar pulls
//! with its length times its force density. Of all displacements that meet the constraints, the one is taken that makes a
//! quadratic measure of the network least: of the change of the forces, of the forces, of the bar lengths, or of the
//! displacements themselves. Coordinates decouple. Linear throughout: no step, no start value.
//!
//! Knows surfaces and numbers; knows no model, no cloud and no file.

pub mod constraint;
pub mod criteria;
pub mod error;
mod independence;
pub mod network;
pub mod system;

pub use constraint::{Constraint, Quantity};
pub use criteria::Criteria;
pub use error::ForceDensityError;
pub use independence::redundant;
pub use network::{Ghosts, Network};
pub use system::{Deformed, System};

#[cfg(test)]
mod tests;
