//! A job over its parts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::mpsc::Sender;
use std::time::Instant;

use super::digest::{self, Digest};
use super::interrupt::Interrupt;
use super::limits::Limits;
use super::queue;
use super::record::{self, Circumstances};
use super::shard::{largest_first, split};
use super::supervise::supervise;
use super::task::{JobError, JobText, Order, Task, Word};
use crate::job::failure::{PartError, code};
use crate::job::output::{FileError, sweep};
use crate::job::plan::Part;
use crate::job::report::{DiagnosticReport, PartReport, Report, Shard};
use crate::job::run::{Mode, Stage, program};

/// A run that is wanted.
#[derive(Debug, Clone)]
pub struct Run<'a> {
    /// The job.
    pub job: &'a JobText,
    /// All its parts, in order of their paths.
    pub parts: &'a [Part],
    /// Whether it writes.
    pub mode: Mode,
    /// What the workers may use.
    pub limits: Limits,
    /// The share to do; `None` for all.
    pub shard: Option<Shard>,
    /// Whether parts that have not changed are passed over.
    pub memory: Memory,
}

/// What counts of earlier runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Memory {
    /// Parts that have not changed are passed over.
    Kept,
    /// Every part is done.
    Fresh,
}

/// What is told of a run while it goes on.
#[derive(Debug, Clone, Copy)]
pub enum Progress<'a> {
    /// It begins with so many parts of so many bytes together.
    Begun {
        /// Parts.
        parts: usize,
        /// Bytes of their inputs.
        bytes: u64,
    },
    /// Something begins with a part.
    Stage {
        /// The input.
        input: &'a Path,
        /// What.
        stage: &'a Stage,
    },
    /// A part is done, in the order in which they come to an end.
    Finished {
        /// Its report.
        report: &'a PartReport,
        /// Bytes of its input.
        bytes: u64,
    },
}

/// What the hands of the queue say.
enum Said {
    Stage(usize, Stage),
    Finished(usize, Box<PartReport>),
}

/// Runs a job over its parts, or one share of them. A part that fails does not stop the others.
///
/// # Errors
/// When the job cannot be carried out as it stands; nothing was touched.
pub fn run(
    run: &Run<'_>,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(Progress<'_>),
) -> Result<Report, JobError> {
    let begin = Instant::now();
    let size = |part: &Part| std::fs::metadata(&part.input).map_or(0, |data| data.len());
    let all: Vec<(Part, u64)> = run.parts.iter().map(|part| (part.clone(), size(part))).collect();
    let plan = plan_digest(&all, run.job);
    let parts = match run.shard {
        None => all,
        Some(Shard { index, count }) => {
            split(&all, count)[index - 1].iter().map(|&at| all[at].clone()).collect()
        }
    };
    watch(Progress::Begun { parts: parts.len(), bytes: parts.iter().map(|(_, bytes)| bytes).sum() });
    let batch =
        Batch { run, parts: &parts, circumstances: Circumstances::of(run.job, &run.job.job()?), interrupt };
    let parts = batch.reports(watch);
    Ok(Report {
        version: 1,
        program: program(),
        job: run.job.job()?.name,
        code: if run.shard.is_some() { Report::of_several(&parts) } else { Report::overall(&parts) },
        shard: run.shard,
        plan,
        seconds: begin.elapsed().as_secs_f64(),
        parts,
    })
}

/// What all shares of a run agree on.
fn plan_digest(parts: &[(Part, u64)], job: &JobText) -> String {
    let mut digest = Digest::new();
    digest.add("job", job.text.as_bytes());
    for (part, bytes) in parts {
        digest.add(&part.input.to_string_lossy(), &bytes.to_le_bytes());
    }
    digest.text()
}

/// A run under way.
struct Batch<'a> {
    run: &'a Run<'a>,
    parts: &'a [(Part, u64)],
    circumstances: Circumstances,
    interrupt: &'a Interrupt,
}

impl Batch<'_> {
    fn reports(&self, watch: &mut dyn FnMut(Progress<'_>)) -> Vec<PartReport> {
        let limits = self.run.limits;
        if self.run.mode == Mode::Write {
            self.sweep_all();
        }
        let mut reports = self.pass(&largest_first(self.parts), limits.jobs, limits.share(), watch);
        if limits.jobs > 1 {
            // Alone, a part may have all the memory: its fate must not hang on how many work beside it.
            let again: Vec<usize> =
                reports.iter().filter(|(_, r)| is_out_of_memory(r)).map(|(&at, _)| at).collect();
            reports.extend(self.pass(&again, 1, limits.memory, watch));
        }
        for (at, report) in &mut reports {
            self.remember_failure(*at, report);
        }
        let missing = |at: usize| {
            let mut report = self.blank(at);
            report.fail(&PartError::Interrupted);
            report
        };
        (0..self.parts.len()).map(|at| reports.remove(&at).unwrap_or_else(|| missing(at))).collect()
    }

    /// Does some parts in the given order, so many at a time.
    fn pass(
        &self,
        order: &[usize],
        hands: usize,
        memory: Option<u64>,
        watch: &mut dyn FnMut(Progress<'_>),
    ) -> BTreeMap<usize, PartReport> {
        let last = hands == 1 || self.run.limits.jobs == 1;
        let mut reports = BTreeMap::new();
        let work = |at: usize, tell: &Sender<Said>| {
            let report = self.one(at, memory, &mut |stage| drop(tell.send(Said::Stage(at, stage.clone()))));
            let _ = tell.send(Said::Finished(at, Box::new(report)));
        };
        let mut hear = |said: Said| match said {
            Said::Stage(at, stage) => {
                watch(Progress::Stage { input: &self.parts[at].0.input, stage: &stage })
            }
            Said::Finished(at, report) => {
                if last || !is_out_of_memory(&report) {
                    watch(Progress::Finished { report: &report, bytes: self.parts[at].1 });
                }
                reports.insert(at, *report);
            }
        };
        queue::each(order.iter().copied(), hands, &|| self.interrupt.asked(), &work, &mut hear);
        reports
    }

    fn blank(&self, at: usize) -> PartReport {
        let name = |path: &Path| path.to_string_lossy().into_owned();
        PartReport::new(name(&self.parts[at].0.input), name(&self.parts[at].0.output))
    }

    /// One part: recalled when nothing has changed, else done by a worker.
    fn one(&self, at: usize, memory: Option<u64>, hear: &mut dyn FnMut(&Stage)) -> PartReport {
        let part = &self.parts[at].0;
        // What cannot be read is the worker's to tell.
        let sha256 = digest::of_file(&part.input).ok();
        let key = sha256.as_ref().map(|sha256| self.circumstances.key(sha256));
        if self.run.mode == Mode::Write
            && self.run.memory == Memory::Kept
            && let Some(report) = key.as_ref().and_then(|key| record::recall(part, key))
        {
            return report;
        }
        let begin = Instant::now();
        let task = Task::Run { job: self.run.job.clone(), part: part.clone(), mode: self.run.mode };
        let order = Order { task, memory, threads: self.run.limits.threads() };
        let mut report = match supervise(&order, self.run.limits.time, self.interrupt, hear) {
            Ok(Word::Ran(report)) => *report,
            Ok(_) => {
                let words = "the worker gave the answer to another question".to_owned();
                self.dead(at, &PartError::Crash { stage: None, words })
            }
            Err(error) => self.dead(at, &error),
        };
        if report.seconds == 0.0 {
            report.seconds = begin.elapsed().as_secs_f64();
        }
        report.sha256 = sha256;
        if report.code == code::DONE
            && self.run.mode == Mode::Write
            && let Some(key) = key
            && let Err(error) = record::remember(part, &key, &report)
        {
            // The output stands, and the next run does it again: that is all that is lost.
            report.losses.push(not_remembered(&error));
        }
        report
    }

    /// The report of a part whose worker died, after what it left behind is gone.
    fn dead(&self, at: usize, error: &PartError) -> PartReport {
        if self.run.mode == Mode::Write
            && let Some(folder) = self.parts[at].0.output.parent()
        {
            sweep(folder);
        }
        let mut report = self.blank(at);
        report.fail(error);
        report
    }

    fn remember_failure(&self, at: usize, report: &mut PartReport) {
        if report.code == code::DONE || report.unchanged || self.run.mode != Mode::Write {
            return;
        }
        let key = report.sha256.as_ref().map(|sha256| self.circumstances.key(sha256));
        if let Some(key) = key
            && let Err(error) = record::remember(&self.parts[at].0, &key, report)
        {
            report.losses.push(not_remembered(&error));
        }
    }

    fn sweep_all(&self) {
        let folders: BTreeSet<&Path> =
            self.parts.iter().filter_map(|(part, _)| part.output.parent()).collect();
        for folder in folders {
            sweep(folder);
            sweep(&folder.join(record::FOLDER));
        }
    }
}

fn is_out_of_memory(report: &PartReport) -> bool {
    report.failure.as_ref().is_some_and(|failure| failure.code == "resource.memory")
}

fn not_remembered(error: &FileError) -> DiagnosticReport {
    DiagnosticReport::warning("run.not-remembered", format!("the next run will do this part again: {error}"))
}
