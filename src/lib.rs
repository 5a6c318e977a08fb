//! resurf: freeform operations on exchanged CAD parts, with everything else kept byte for byte.
//!
//! One direction of flow: bytes become an [`exchange structure`](step), the structure becomes a read-only
//! [`model`], an [operation](ops) plans a [`ChangeSet`](model::ChangeSet), the change set is lowered to a
//! [`Patch`](exchange::Patch) of byte edits, and the patch is applied to the input bytes.
//! `docs/architecture.md` names the rooms and who may import whom; `tests/tidy.rs` holds them to it.
//!
//! What this crate does not do: repair files, guess units, renumber instances, or write a file anew
//! when a patch will do.

pub mod batch;
pub mod brep;
pub mod cli;
pub mod cloud;
pub mod diagnostic;
pub mod diff;
pub mod digest;
pub mod document;
pub mod exchange;
pub mod geometry;
pub mod iges;
pub mod job;
pub mod math;
pub mod mesh;
pub mod model;
pub mod number;
pub mod ops;
pub mod picture;
pub mod publish;
pub mod regress;
pub mod source;
pub mod step;
pub mod units;
pub mod validate;
pub mod view;
