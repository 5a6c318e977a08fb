//! What a worker is told and what it answers: a line of JSON each.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::job::Job;
use crate::job::file::ValidatorName;
use crate::job::plan::{self, Part, PlanError};
use crate::job::report::PartReport;
use crate::job::report::measured::Measures;
use crate::job::run::{Mode, Stage};
use crate::job::side::illustrate::Illustration;
use crate::job::text::{JobFileError, Syntax, read};

/// A job as it stands in its file: every worker reads the same text, whatever happens to the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobText {
    /// The text.
    pub text: String,
    /// Its syntax.
    pub syntax: Syntax,
    /// Folder that its paths are relative to.
    pub folder: PathBuf,
}

/// A job file that is wrong.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The text is no job.
    #[error(transparent)]
    Read(#[from] JobFileError),
    /// The job cannot be carried out as it stands.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

impl JobText {
    /// Reads a job file.
    ///
    /// # Errors
    /// When it cannot be read from its place, or is a folder.
    pub fn file(path: &Path) -> std::io::Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let json = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
        let syntax = if json { Syntax::Json } else { Syntax::Toml };
        Ok(Self { text, syntax, folder: path.parent().unwrap_or(Path::new("")).to_owned() })
    }

    /// What it says, with the files that its operations read found.
    ///
    /// # Errors
    /// [`JobError`].
    pub fn job(&self) -> Result<Job, JobError> {
        let mut job = read(&self.text, self.syntax)?;
        plan::resolve(&mut job, &self.folder)?;
        Ok(job)
    }
}

/// What a worker does.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum Task {
    /// A job on one part.
    Run {
        /// The job.
        job: JobText,
        /// The part.
        part: Part,
        /// Whether it writes.
        mode: Mode,
    },
    /// Every number of a part.
    Measure {
        /// The part.
        part: PathBuf,
        /// Programs that are asked whether they accept it.
        validators: Vec<ValidatorName>,
    },
    /// Pictures of a part before and after.
    Illustrate {
        /// The part.
        part: Part,
        /// Where its page goes.
        page: PathBuf,
    },
}

/// A task with what it may use.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Order {
    /// The task.
    pub task: Task,
    /// Bytes of memory.
    pub memory: Option<u64>,
    /// Threads.
    pub threads: usize,
}

/// What a worker says.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum Word {
    /// It begins with something.
    Stage(Stage),
    /// It has done a part.
    Ran(Box<PartReport>),
    /// It has measured a part, or could not: a code and a message.
    Measured(Result<Measures, (String, String)>),
    /// It has drawn a part, or could not.
    Drawn(Result<Illustration, String>),
}
