//! Many parts at once: each in a process of its own with limits on time and memory, what has not changed passed
//! over, shares of the parts for many machines.
//!
//! A part that crashes, hangs or eats memory is one line in the report. Knows no operation and no format: what is
//! done to one part is `job`'s business. Prints nothing.
//!
//! INVARIANT: neither the number of workers nor their order changes a byte of an output. The ceilings of all workers
//! together never exceed the budget, and a part that meets its ceiling is tried once more alone with all of it, so
//! that a part's fate does not hang on the number of workers either.

mod digest;
pub mod illustrate;
pub mod interrupt;
pub mod limits;
pub mod measure;
pub mod merge;
mod queue;
mod record;
pub mod run;
pub mod shard;
mod supervise;
mod system;
pub mod task;
pub mod worker;

pub use interrupt::Interrupt;
pub use limits::Limits;
pub use queue::each;
pub use run::{Progress, Run, run};
pub use shard::Share;
pub use task::JobText;
