//! Exit codes of the program: those of a part, and what only a whole run can end with.
//!
//! A run of one part ends with that part's own code. A run of several ends with [`GATE`] when any part
//! failed, and each part's own code stands in the report.

pub use crate::job::failure::code::{
    DONE, GATE, INTERNAL, IO, OPERATION, RESOURCE, UNREADABLE, USAGE, VALIDATOR_MISSING,
};

/// Interrupted by the user: what the shell reports for a process that SIGINT ended.
pub const INTERRUPTED: u8 = 130;
