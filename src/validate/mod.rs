//! Other programs asked for a verdict on written files: FreeCAD on STEP and IGES, OpenSCAD on closed meshes.
//!
//! Both lie by default: `freecadcmd` 0.20 ends with code 0 after an exception or a file that it could not
//! read, and OpenSCAD imports an open mesh without a word. So FreeCAD runs a script that the binary carries
//! and that writes a sentinel file when it came to its end, and OpenSCAD is made to do a CSG operation whose
//! result is read back. Every run has a time limit and bounded captured output.
//!
//! This room spawns processes and writes into the directory that it is handed, nowhere else. It prints
//! nothing and judges nothing beyond what the programs say: comparing figures is the job's business.

mod freecad;
mod openscad;
mod process;

use crate::mesh::{Extents, MeshReadError};
pub use freecad::ask_freecad;
pub use openscad::ask_openscad;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::time::Duration;

/// A program that gives verdicts.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum Validator {
    /// FreeCAD without its window, for STEP and IGES.
    FreeCad,
    /// OpenSCAD, for closed meshes as OFF or STL.
    OpenScad,
}

impl Validator {
    /// The word in jobs and reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::FreeCad => "freecad",
            Self::OpenScad => "openscad",
        }
    }

    /// Program looked up in `PATH`.
    #[must_use]
    pub fn default_program(self) -> &'static str {
        match self {
            Self::FreeCad => "freecadcmd",
            Self::OpenScad => "openscad",
        }
    }

    /// Environment variable that names another program, with or without its path.
    #[must_use]
    pub fn program_variable(self) -> &'static str {
        match self {
            Self::FreeCad => "RESURF_FREECADCMD",
            Self::OpenScad => "RESURF_OPENSCAD",
        }
    }

    /// Command that installs the program on Debian and Ubuntu.
    #[must_use]
    pub fn install_command(self) -> &'static str {
        match self {
            Self::FreeCad => "apt-get install --no-install-recommends freecad-python3",
            Self::OpenScad => "apt-get install --no-install-recommends openscad",
        }
    }

    /// Program to run: what [`program_variable`](Self::program_variable) names, or else the default.
    #[must_use]
    pub fn program(self) -> OsString {
        std::env::var_os(self.program_variable())
            .filter(|name| !name.is_empty())
            .unwrap_or_else(|| self.default_program().into())
    }
}

/// A question to a validator.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The written file; its extension must be one that the program knows.
    pub file: &'a Path,
    /// An existing directory for scripts and answers, of this run alone.
    pub scratch: &'a Path,
    /// Time after which the program is killed.
    pub timeout: Duration,
    /// Program to run; [`Validator::program`] when absent.
    pub program: Option<&'a OsStr>,
}

impl Request<'_> {
    /// Time limit that suits parts of some thousand faces and meshes of some ten thousand triangles.
    pub const DEFAULT_TIMEOUT: Duration = Duration::from_secs(300);
}

/// What a program found in a file; a figure that it does not give is absent.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Figures {
    /// Format as the program took it: `step`, `iges`, `brep`, `off`, `stl`.
    pub format: String,
    /// Version of the program, as far as it says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Count of solids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solids: Option<u64>,
    /// Count of shells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shells: Option<u64>,
    /// Count of faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces: Option<u64>,
    /// Count of edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<u64>,
    /// Count of triangles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
    /// Volume in the program's cubic units: millimetres for FreeCAD, file units for OpenSCAD.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<f64>,
    /// Area in the program's square units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Whether the shape passes the program's own checks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid: Option<bool>,
    /// Box, in the program's units. FreeCAD's may be wider than the shape where faces are freeform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extents: Option<Extents>,
    /// Greatest tolerance of any element after reading, in the program's units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

/// A program's answer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Verdict {
    /// Who answered.
    pub validator: Validator,
    /// Whether the program read the file, found something in it, and calls it valid.
    pub accepted: bool,
    /// What it found.
    pub figures: Figures,
    /// Its complaints, and the reasons of a refusal; at most [`Verdict::MESSAGES`].
    pub messages: Vec<String>,
    /// Wall time.
    pub seconds: f64,
}

impl Verdict {
    /// Most messages that are kept.
    pub const MESSAGES: usize = 20;

    fn new(validator: Validator, figures: Figures, mut messages: Vec<String>, seconds: f64) -> Self {
        let more = messages.len().saturating_sub(Self::MESSAGES);
        messages.truncate(Self::MESSAGES);
        if more > 0 {
            messages.push(format!("{more} more messages"));
        }
        Self { validator, accepted: messages.is_empty(), figures, messages, seconds }
    }
}

/// Why there is no verdict.
#[derive(Debug, thiserror::Error)]
pub enum ValidateError {
    /// The program is not there.
    #[error("program '{program}' not found; install it with '{install}' or name it in {variable}")]
    Missing {
        /// Program that was looked for.
        program: String,
        /// Command that installs it.
        install: &'static str,
        /// Environment variable that names another one.
        variable: &'static str,
    },
    /// The program is there and cannot be run.
    #[error("program '{program}' cannot be run: {source}")]
    NotRunnable {
        /// Program.
        program: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The program took too long and was killed.
    #[error("program '{program}' gave no answer within {seconds} s")]
    Timeout {
        /// Program.
        program: String,
        /// The limit.
        seconds: f64,
        /// End of its output.
        output: String,
    },
    /// The program ended by a signal.
    #[error("program '{program}' crashed ({status}); its last words: {output}")]
    Crashed {
        /// Program.
        program: String,
        /// How it ended.
        status: String,
        /// End of its output.
        output: String,
    },
    /// The program ended and did not write its answer, or a garbled one.
    #[error(
        "program '{program}' ended ({status}) without a usable answer, {reason}; its last words: {output}"
    )]
    NoSentinel {
        /// Program.
        program: String,
        /// How it ended.
        status: String,
        /// Lower-case fragment: why the answer is not usable.
        reason: String,
        /// End of its output.
        output: String,
    },
    /// The scratch directory or the file cannot be used.
    #[error("'{path}' cannot be used: {source}")]
    Scratch {
        /// Path.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file to ask about is not a mesh.
    #[error("'{path}' is not a mesh: {source}")]
    NotAMesh {
        /// Path.
        path: String,
        /// What is wrong with it.
        source: MeshReadError,
    },
}

impl ValidateError {
    fn scratch(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.display().to_string();
        move |source| Self::Scratch { path, source }
    }
}
