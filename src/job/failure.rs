//! Why a part fails, and which exit code that is.

use crate::document::{CompressedError, ConvertError, LowerError, OpenError};
use crate::job::operate::OperateError;
use crate::job::output::FileError;
use crate::job::report::Failure;
use crate::job::run::Stage;
use crate::validate::ValidateError;

/// The first thing that kept a part from being written.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The input cannot be read from its place.
    #[error("the input cannot be read: {}{}", .0.source, advice(.0))]
    Input(FileError),
    /// The input is a folder.
    #[error("the input is a folder; name the files in it, such as `{}`", .0.join("*.step").display())]
    Folder(std::path::PathBuf),
    /// The input is a device, a pipe or the like, whose end may never come.
    #[error("`{}` is no regular file; write what it gives to one first", .0.display())]
    NoFile(std::path::PathBuf),
    /// A key of the job, or an argument, does not fit the part.
    #[error("`{key}`: {message}")]
    Setting {
        /// The key in the job's words.
        key: &'static str,
        /// Lower-case fragment: what was found, and what would fit.
        message: String,
    },
    /// The input is no file of a known format.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The input is damaged beyond use.
    #[error("the input is damaged: {0}")]
    Damaged(String),
    /// The operation cannot be done.
    #[error(transparent)]
    Operate(#[from] OperateError),
    /// The change cannot be written in this format.
    #[error("the result cannot be written: {0}")]
    Lower(#[from] LowerError),
    /// The part cannot be written in the other format.
    #[error("the part cannot be written in this format: {0}")]
    Convert(#[from] ConvertError),
    /// The written bytes, read again, are not what was meant.
    #[error("the result does not pass the own checks: {}", .0.join("; "))]
    Check(Vec<String>),
    /// A side file cannot be made.
    #[error("the side mesh cannot be made: {0}")]
    Mesh(String),
    /// A picture cannot be drawn.
    #[error("the picture cannot be drawn: {0}")]
    Picture(String),
    /// What was held cannot be proved.
    #[error("the proof sheet cannot be made: {}", .0.join("; "))]
    Proof(Vec<String>),
    /// Another program refuses the result.
    #[error("{program} refuses the result: {}", .messages.join("; "))]
    Refused {
        /// The program.
        program: &'static str,
        /// Its words.
        messages: Vec<String>,
    },
    /// Another program gives no verdict.
    #[error(transparent)]
    NoVerdict(#[from] ValidateError),
    /// The output cannot be written.
    #[error("the output cannot be written: {0}")]
    Output(FileError),
    /// The part took longer than it may.
    #[error("stopped after {seconds} s{}; more are given by `--timeout`", at(.stage))]
    OutOfTime {
        /// The limit.
        seconds: f64,
        /// What was being done.
        stage: Option<Stage>,
    },
    /// The part needs more memory than it may have.
    #[error("more memory is needed than {} MB{}; more is given by `--memory`", .bytes / 1_000_000, at(.stage))]
    OutOfMemory {
        /// The limit.
        bytes: u64,
        /// What was being done.
        stage: Option<Stage>,
    },
    /// The process that worked on the part came to no end of its own.
    #[error("internal error{}: please report it with this part and job: {words}", at(.stage))]
    Crash {
        /// What was being done.
        stage: Option<Stage>,
        /// How it ended, and its last words.
        words: String,
    },
    /// No process can be started for the part.
    #[error("no process can be started for the part: {0}")]
    NotStarted(std::io::Error),
    /// The run was interrupted before the part was done.
    #[error("interrupted before the part was done; the same command goes on with it")]
    Interrupted,
    /// The program met a bug of its own.
    #[error("internal error: please report it with this part and job")]
    Internal,
}

fn at(stage: &Option<Stage>) -> String {
    stage.as_ref().map(|stage| format!(" while {stage}")).unwrap_or_default()
}

/// What to do about an input that cannot be read.
fn advice(error: &FileError) -> &'static str {
    match error.source.kind() {
        std::io::ErrorKind::PermissionDenied => "; allow this user to read it",
        _ => "",
    }
}

/// Exit codes of a part: what a caller may rely on, and whether trying again makes sense.
pub mod code {
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
    /// Interrupted by SIGINT, SIGTERM or SIGHUP: the same command goes on.
    pub const INTERRUPTED: u8 = 130;
}

impl PartError {
    /// The exit code.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(error) if error.source.kind() == std::io::ErrorKind::NotFound => code::UNREADABLE,
            Self::Input(error) | Self::Output(error)
                if error.source.kind() == std::io::ErrorKind::OutOfMemory =>
            {
                code::RESOURCE
            }
            Self::Input(_) | Self::Output(_) | Self::NotStarted(_) => code::IO,
            Self::OutOfTime { .. } | Self::OutOfMemory { .. } => code::RESOURCE,
            Self::Crash { .. } => code::INTERNAL,
            Self::Interrupted => code::INTERRUPTED,
            Self::Open(
                OpenError::TooLarge(_)
                | OpenError::Compressed(CompressedError::TooLarge { .. } | CompressedError::OutOfMemory),
            ) => code::RESOURCE,
            Self::Open(_) | Self::Damaged(_) | Self::Folder(_) | Self::NoFile(_) => code::UNREADABLE,
            Self::Setting { .. } => code::USAGE,
            Self::Operate(error) if error.code().starts_with("internal.") => code::INTERNAL,
            Self::Operate(error) if error.code().ends_with(".net-too-large") => code::RESOURCE,
            Self::Operate(_)
            | Self::Lower(_)
            | Self::Convert(_)
            | Self::Mesh(_)
            | Self::Picture(_)
            | Self::Proof(_) => code::OPERATION,
            Self::NoVerdict(ValidateError::Missing { .. }) => code::VALIDATOR_MISSING,
            Self::NoVerdict(ValidateError::Scratch { .. }) => code::IO,
            Self::Internal => code::INTERNAL,
            Self::Check(_) | Self::Refused { .. } | Self::NoVerdict(_) => code::GATE,
        }
    }

    /// The failure for the report.
    #[must_use]
    pub fn failure(&self) -> Failure {
        let code = match self {
            Self::Input(_) => "io.input",
            Self::Folder(_) => "io.folder",
            Self::NoFile(_) => "io.no-file",
            Self::Setting { .. } => "job.setting",
            Self::Open(error) => error.code(),
            Self::Damaged(_) => "document.damaged",
            Self::Operate(error) => error.code(),
            Self::Lower(_) => "write.cannot-lower",
            Self::Convert(_) => "write.cannot-convert",
            Self::Check(_) => "check.failed",
            Self::Mesh(_) => "mesh.failed",
            Self::Picture(_) => "picture.failed",
            Self::Proof(_) => "proof.failed",
            Self::Refused { .. } => "validate.refused",
            Self::NoVerdict(ValidateError::Missing { .. }) => "validate.missing",
            Self::NoVerdict(_) => "validate.no-verdict",
            Self::Output(_) => "io.output",
            Self::OutOfTime { .. } => "resource.time",
            Self::OutOfMemory { .. } => "resource.memory",
            Self::Crash { .. } => "internal.crash",
            Self::NotStarted(_) => "io.process",
            Self::Interrupted => "run.interrupted",
            Self::Internal => "internal.panic",
        };
        Failure { code: code.to_owned(), message: self.to_string() }
    }
}
