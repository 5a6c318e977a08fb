//! The job: read the file, plan with every check before any data is touched, run over the parts, report.
//!
//! Knows one part at a time; many are `batch`'s business. Prints nothing. INVARIANT: an output appears whole or not at
//! all, an input is never touched, and the same input and job give the same bytes.

mod clock;
pub mod convert;
pub mod failure;
pub mod file;
pub mod flagged;
mod held;
pub mod judge;
pub mod library;
pub mod operate;
pub mod output;
pub mod own_check;
pub mod part;
pub mod plan;
pub mod report;
pub mod restate;
pub mod run;
pub mod schema;
pub mod side;
pub mod text;
pub mod validation_property;

pub use file::Job;
