//! The job: read the file, plan with every check before any data is touched, run over the parts, report.
//!
//! The only room that uses the file system. Prints nothing.

pub mod file;
mod json;
mod nearest;
mod node;
pub mod read;
pub mod selector;

pub use file::Job;
