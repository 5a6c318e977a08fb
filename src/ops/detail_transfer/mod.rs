//! Detail of one curve carried to another: wavelet levels of a source curve added to a target curve.
//!
//! One step of synthesis is linear, so the levels of source and target need not match: the result is the exact
//! sum of the target and the chosen levels of the source, on the union of their knots. In the local frame each
//! wavelet turns with the coarse curve that it sits on, so that detail follows a target that runs elsewhere.
//!
//! [`transfer()`] takes and gives splines; [`plan()`] curves of a model, and gives a change set. Neither knows files.
//!
//! What it does not do: curves that are edges of faces, curves in the plane, periodic decompositions.
//!
//! Source: transfer of multiresolution curve details with the corrections of `docs/decisions/detail-transfer.md`.

mod embed;
pub mod error;
mod face;
mod frames;
mod measure;
pub mod on_curve;
pub mod params;
pub mod plan;
pub mod prepare;
pub mod settings;
pub mod spline;
mod transfer;
mod weighted;

pub use error::TransferError;
pub use params::{Direction, FaceTarget, Params, Plan, Source, Target};
pub use plan::plan;
pub use prepare::{Prepared, prepare};
pub use settings::{Existing, Frame, LevelChoice, Scale, Settings, TargetBase};
pub use spline::Spline;
pub use transfer::{SourceDetail, Transferred, transfer, transfer_split};
