//! Exit codes of the program: those of a part, and what only a whole run can end with.
//!
//! A run of one part ends with that part's own code. A run of several ends with what would help, see
//! [`Report::overall`](crate::job::report::Report::overall), and each part's own code stands in the report.

pub use crate::job::failure::code::{
    DONE, GATE, INTERNAL, INTERRUPTED, IO, OPERATION, RESOURCE, UNREADABLE, USAGE, VALIDATOR_MISSING,
};
