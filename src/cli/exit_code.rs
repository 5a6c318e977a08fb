//! Exit codes: what a caller may rely on, and whether trying again makes sense.
//!
//! A run of one part ends with that part's own code. A run of several ends with [`GATE`] when any part
//! failed, and each part's own code stands in the report.

/// All well.
pub const DONE: u8 = 0;
/// The program ran, and some part failed its gate or differs. Trying again gives the same.
pub const GATE: u8 = 1;
/// Command line or job file wrong. Nothing was touched.
pub const USAGE: u8 = 2;
/// An input cannot be read as what it is. Trying again gives the same.
pub const UNREADABLE: u8 = 3;
/// The operation cannot be done on this part.
pub const OPERATION: u8 = 4;
/// A validator that the job requires is not installed. Nothing was touched.
pub const VALIDATOR_MISSING: u8 = 5;
/// A ceiling on memory, time or size was met: try again with more.
pub const RESOURCE: u8 = 6;
/// Reading or writing failed for a reason outside the file: try again.
pub const IO: u8 = 7;
/// A bug of the program.
pub const INTERNAL: u8 = 70;
/// Interrupted by the user: what the shell reports for a process that SIGINT ended.
pub const INTERRUPTED: u8 = 130;

const _: () = {
    // The job's codes are these; the job cannot import them, since arrows point down.
    use crate::job::failure::code;
    assert!(code::DONE == DONE && code::GATE == GATE && code::USAGE == USAGE);
    assert!(code::UNREADABLE == UNREADABLE && code::OPERATION == OPERATION);
    assert!(code::VALIDATOR_MISSING == VALIDATOR_MISSING && code::RESOURCE == RESOURCE);
    assert!(code::IO == IO && code::INTERNAL == INTERNAL);
};
