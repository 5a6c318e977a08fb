//! Whether the parts of a folder still measure what they measured: a baseline in TOML, and what differs from it.
//!
//! Reads parts and runs jobs through `batch`, so that a part that dies is one line here too. Prints nothing.

pub mod baseline;
pub mod compare;
pub mod survey;

pub use baseline::{Baseline, BaselineError, Tolerances};
pub use compare::{Comparison, Outcome, compare};
pub use survey::{Surveyed, survey};
