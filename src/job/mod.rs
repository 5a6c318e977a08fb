//! The job: read the file, plan with every check before any data is touched, run over the parts, report.
//!
//! Knows one part at a time; many are `batch`'s business. Prints nothing. INVARIANT: an output appears whole or not at
//! all, an input is never touched, and the same input and job give the same bytes.

mod clock;
pub mod contents;
pub mod convert;
pub mod deform_file;
mod deform_operate;
pub mod detail_file;
pub mod detail_library;
mod detail_operate;
pub mod difference;
pub mod failure;
pub mod feature_file;
pub mod file;
pub mod finding;
pub mod flagged;
mod held;
pub mod illustrate;
mod json;
pub mod judge;
pub mod measure;
pub mod measured;
pub mod nearest;
mod node;
pub mod operate;
pub mod output;
pub mod own_check;
pub mod part;
pub mod paste_file;
mod paste_operate;
mod pictures;
pub mod plan;
pub mod proof;
pub mod read;
pub mod report;
pub mod restate;
pub mod run;
pub mod scale_file;
mod scale_operate;
pub mod schema;
pub mod select;
mod select_curve;
pub mod selector;
mod side;
pub mod simplify_file;
pub mod validation_property;

pub use file::Job;
