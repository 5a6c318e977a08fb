//! Constrained scaling of faces: the part is scaled by different factors, and holes and cut-outs keep their exact
//! size ("fix and stretch").
//!
//! A held loop moves rigidly together with all control points that act on it, so that it is exact, whatever its
//! shape; the border is scaled plainly; the control points in between are chosen so that the surface stays as fair
//! as the plainly scaled one.
//!
//! The numeric core ([`scale_faces`]) takes surfaces and polygons in their parameters. [`plan`] decides for a model
//! which element gets which motion, and gives a change set. Neither knows file formats; nothing is repaired.
//!
//! What it does not do: loops that meet the border, held loops on surfaces other than B-splines, different factors
//! for parts of one model.
//!
//! Source: fix-and-stretch scaling with the corrections of
//! `docs/decisions/constrained-scale.md`; the slide reference is our own.

pub mod energy;
pub mod envelope;
pub mod error;
pub mod faces;
pub mod fold;
mod grouping;
pub mod measures;
pub mod motion;
pub mod plan;
mod prepare;
pub mod refine;
pub mod rule;
pub mod scaling;
pub mod skins;
pub mod slide;
pub mod solve;
mod stage;
mod strips;
pub mod task;

pub use super::net::{cells, polygon, sampling};
pub use error::ScaleError;
pub use faces::{scale_face, scale_faces, scale_faces_by};
pub use motion::Motion;
pub use scaling::{Continuity, Energy, Freedom, Hold, Scaling};
pub use task::{Contour, FaceTask, Group, HeldLoop, Scaled, ScaledFace};
