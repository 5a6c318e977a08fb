//! The report of a run: what was done to each part, in numbers that a program can compare.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::own_check::OwnFinding;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Source;
use crate::validate::Verdict;

/// The report of one run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "resurf report")]
pub struct Report {
    /// Version of the report format: 1.
    pub version: u32,
    /// Version of the program.
    pub program: String,
    /// Name of the job.
    pub job: String,
    /// Exit code of the run: the gravest of the parts'.
    pub code: u8,
    /// Parts in order of their paths.
    pub parts: Vec<PartReport>,
}

/// Whether a part came through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Written, checked and accepted; or planned, in a dry run.
    Done,
    /// Nothing was written.
    Failed,
}

/// How the output came to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WritePath {
    /// The input's bytes.
    Verbatim,
    /// The input's bytes with edits.
    Patched,
}

/// What happened to one part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PartReport {
    /// Path of the input as the job found it.
    pub input: String,
    /// Path of the output; it stands there only when the status is `done`.
    pub output: String,
    /// Whether the part came through.
    pub status: Status,
    /// Exit code of this part alone.
    pub code: u8,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// How the output was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub write_path: Option<WritePath>,
    /// Side files that were written.
    pub side_files: Vec<String>,
    /// Edits on the input's bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edits: Option<Edits>,
    /// Operations with what they measured.
    pub operations: Vec<OperationReport>,
    /// What became of statements about volume, area and centroid of changed bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub restated: Vec<super::restate::Restated>,
    /// What the file cannot say any more, by code.
    pub losses: Vec<DiagnosticReport>,
    /// Facts about the input, by code.
    pub diagnostics: Vec<DiagnosticReport>,
    /// How often each code was met, also where not every one is listed.
    pub diagnostic_counts: BTreeMap<String, usize>,
    /// The input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<super::measure::Figures>,
    /// The output, read again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<super::measure::Figures>,
    /// Facts that faces with changes and their neighbours violate in the output, as they did in the input: a new
    /// one fails the part.
    pub findings: Vec<OwnFinding>,
    /// Answers of other programs about the output.
    pub validators: Vec<Verdict>,
    /// Wall time.
    pub seconds: f64,
    /// Greatest memory of the process so far, in bytes, where the system tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
}

/// Why a part failed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Failure {
    /// Stable code.
    pub code: String,
    /// What was found, and what would have been right.
    pub message: String,
}

/// Edits on the input's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Edits {
    /// Places where bytes were replaced.
    pub replaced: usize,
    /// Places where something was added.
    pub added: usize,
    /// Places where something was removed.
    pub removed: usize,
    /// Bytes of the input that no edit touches.
    pub bytes_untouched: usize,
}

impl Edits {
    /// The edits of two operations, one after the other; of bytes that neither touches the lesser count is known.
    #[must_use]
    pub fn followed_by(&self, next: &Self) -> Self {
        Self {
            replaced: self.replaced + next.replaced,
            added: self.added + next.added,
            removed: self.removed + next.removed,
            bytes_untouched: self.bytes_untouched.min(next.bytes_untouched),
        }
    }
}

impl From<crate::exchange::EditCounts> for Edits {
    fn from(counts: crate::exchange::EditCounts) -> Self {
        let crate::exchange::EditCounts { replaced, added, removed, bytes_untouched } = counts;
        Self { replaced, added, removed, bytes_untouched }
    }
}

/// One operation on one part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct OperationReport {
    /// The word of the job file.
    pub kind: String,
    /// Elements that got new geometry: `surfaces`, `curves`, `pcurves`, `points`, `free_curves`, `bounds`.
    pub changed: BTreeMap<String, usize>,
    /// Figures of the operation; each operation has its own.
    pub measures: serde_json::Value,
    /// Facts worth telling.
    pub notes: Vec<DiagnosticReport>,
}

/// A fact about a file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiagnosticReport {
    /// Stable code.
    pub code: String,
    /// `note`, `warning` or `error`.
    pub severity: String,
    /// Entity concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entity: Option<String>,
    /// Line in the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// What was found, and what was expected.
    pub message: String,
}

impl DiagnosticReport {
    /// The fact with its line in the file.
    #[must_use]
    pub fn new(diagnostic: &Diagnostic, source: &Source) -> Self {
        Self {
            code: diagnostic.code.to_owned(),
            severity: diagnostic.severity.as_str().to_owned(),
            entity: diagnostic.entity.clone(),
            line: diagnostic.span.map(|span| source.position(span.start).line),
            message: diagnostic.message.clone(),
        }
    }
}

impl PartReport {
    /// A part of which nothing is known yet.
    #[must_use]
    pub fn new(input: String, output: String) -> Self {
        Self {
            input,
            output,
            status: Status::Failed,
            code: 0,
            failure: None,
            write_path: None,
            side_files: Vec::new(),
            edits: None,
            operations: Vec::new(),
            restated: Vec::new(),
            losses: Vec::new(),
            diagnostics: Vec::new(),
            diagnostic_counts: BTreeMap::new(),
            before: None,
            after: None,
            findings: Vec::new(),
            validators: Vec::new(),
            seconds: 0.0,
            peak_bytes: None,
        }
    }

    /// Takes over the facts about the input.
    pub fn take_diagnostics(&mut self, diagnostics: &Diagnostics, source: &Source) {
        self.diagnostics =
            diagnostics.kept().iter().map(|fact| DiagnosticReport::new(fact, source)).collect();
        self.diagnostic_counts =
            diagnostics.counts().iter().map(|(code, count)| ((*code).to_owned(), *count)).collect();
    }
}
