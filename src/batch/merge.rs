//! The reports of all shares as the report of one run.

use std::collections::BTreeSet;

use crate::job::report::{PartReport, Report};

/// Reports that are not those of all shares of one run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// None is given.
    #[error("no report is given")]
    Empty,
    /// A report is one of a whole run.
    #[error("the report of \"{job}\" is one of a whole run, not of a share")]
    NoShare {
        /// Name of the job.
        job: String,
    },
    /// Two reports are of different runs.
    #[error(
        "the reports are of different runs: the job, the names or the sizes of its parts are not the same"
    )]
    OtherRun,
    /// A share that cannot be.
    #[error("share {index} of {count} cannot be")]
    Impossible {
        /// The share, from 1.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A share was done twice.
    #[error("share {index} stands in two reports")]
    Twice {
        /// The share, from 1.
        index: usize,
    },
    /// Shares are not there.
    #[error("the reports of shares {} of {count} are missing", list(.missing))]
    Missing {
        /// Shares, from 1.
        missing: Vec<usize>,
        /// How many there are.
        count: usize,
    },
}

fn list(numbers: &[usize]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Missing shares that are named at most.
const NAMED: usize = 20;

/// Puts the reports of all shares together.
///
/// # Errors
/// [`MergeError`] when a part could be missing from the result or stand there twice.
pub fn merged(reports: Vec<Report>) -> Result<Report, MergeError> {
    let first = reports.first().ok_or(MergeError::Empty)?;
    let (program, job, plan) = (first.program.clone(), first.job.clone(), first.plan.clone());
    let shard = first.shard.ok_or_else(|| MergeError::NoShare { job: job.clone() })?;
    let mut known = BTreeSet::new();
    for report in &reports {
        let own = report.shard.ok_or_else(|| MergeError::NoShare { job: report.job.clone() })?;
        if own.count != shard.count || report.plan != plan {
            return Err(MergeError::OtherRun);
        }
        if own.index == 0 || own.index > own.count {
            return Err(MergeError::Impossible { index: own.index, count: own.count });
        }
        if !known.insert(own.index) {
            return Err(MergeError::Twice { index: own.index });
        }
    }
    let missing = (1..=shard.count).filter(|index| !known.contains(index));
    let missing: Vec<usize> = missing.take(NAMED).collect();
    if !missing.is_empty() {
        return Err(MergeError::Missing { missing, count: shard.count });
    }
    let seconds = reports.iter().map(|report| report.seconds).sum();
    let mut parts: Vec<PartReport> = reports.into_iter().flat_map(|report| report.parts).collect();
    parts.sort_by(|a, b| a.input.cmp(&b.input));
    Ok(Report { version: 1, program, job, code: Report::overall(&parts), shard: None, plan, seconds, parts })
}
