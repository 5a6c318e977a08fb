//! One part measured by a worker, as it stands or as a job makes it.

use std::path::Path;

use super::digest;
use super::interrupt::Interrupt;
use super::limits::Limits;
use super::supervise::supervise;
use super::task::{JobText, Order, Task, Word};
use crate::job::failure::PartError;
use crate::job::file::ValidatorName;
use crate::job::plan::Part;
use crate::job::report::measured::Measures;
use crate::job::run::Mode;

/// Code and message of what went wrong.
type Failed = (String, String);

/// Measures a file.
///
/// # Errors
/// Code and message of why it cannot be measured.
pub fn part(
    path: &Path,
    validators: &[ValidatorName],
    limits: &Limits,
    interrupt: &Interrupt,
) -> Result<Measures, Failed> {
    let task = Task::Measure { part: path.to_owned(), validators: validators.to_vec() };
    match done(task, limits, interrupt)? {
        Word::Measured(measured) => measured,
        _ => Err(other_answer()),
    }
}

/// Measures what a job makes of a part; the output is written to the part's own place.
///
/// # Errors
/// Code and message of why the job or the measuring fails.
pub fn job(
    job: &JobText,
    of: &Part,
    validators: &[ValidatorName],
    limits: &Limits,
    interrupt: &Interrupt,
) -> Result<Measures, Failed> {
    let task = Task::Run { job: job.clone(), part: of.clone(), mode: Mode::Write };
    match done(task, limits, interrupt)? {
        Word::Ran(report) => match report.failure {
            Some(failure) => Err((failure.code, failure.message)),
            None => part(&of.output, validators, limits, interrupt),
        },
        _ => Err(other_answer()),
    }
}

fn done(task: Task, limits: &Limits, interrupt: &Interrupt) -> Result<Word, Failed> {
    let order = Order { task, memory: limits.share(), threads: limits.threads() };
    supervise(&order, limits.time, interrupt, &mut |_| {}).map_err(|error| failed(&error))
}

fn failed(error: &PartError) -> Failed {
    let failure = error.failure();
    (failure.code, failure.message)
}

fn other_answer() -> Failed {
    ("internal.crash".to_owned(), "the worker gave the answer to another question".to_owned())
}

/// SHA-256 of a file.
///
/// # Errors
/// When it cannot be read.
pub fn digest(path: &Path) -> std::io::Result<String> {
    digest::of_file(path)
}
