//! The report of a run: what was done to each part, in numbers that a program can compare.

pub mod contents;
pub mod difference;
pub mod finding;
pub mod measure;
pub mod measured;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::job::failure::{PartError, code};
use crate::job::file::PictureKind;
use crate::job::own_check::OwnFinding;
use crate::source::Source;
use crate::validate::Verdict;

/// The report of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "resurf report")]
pub struct Report {
    /// Version of the report format: 1.
    pub version: u32,
    /// Version of the program.
    pub program: String,
    /// Name of the job.
    pub job: String,
    /// Exit code of the run: of one part its own; of several, see [`Report::overall`].
    pub code: u8,
    /// The share of the parts that this run did, when it did not do all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// SHA-256 of the names and sizes of all parts of the job: equal for the shards of one run.
    #[serde(default)]
    pub plan: String,
    /// Wall time of the run; of merged reports the sum.
    #[serde(default)]
    pub seconds: f64,
    /// Parts in order of their paths.
    pub parts: Vec<PartReport>,
}

/// One share of the parts of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Shard {
    /// Which one, from 1.
    pub index: usize,
    /// How many there are.
    pub count: usize,
}

impl Report {
    /// Exit code of a run: one part's own code, or that [of several](Self::of_several).
    #[must_use]
    pub fn overall(parts: &[PartReport]) -> u8 {
        if let [only] = parts { only.code } else { Self::of_several(parts) }
    }

    /// Exit code of a run of several parts, or of a share of one. A failed part makes it tell a scheduler what would
    /// help: [`INTERRUPTED`](code::INTERRUPTED) when parts were not done, [`IO`](code::IO) when trying again may help some
    /// part, [`RESOURCE`](code::RESOURCE) when more memory or time may, and else [`GATE`](code::GATE).
    #[must_use]
    pub fn of_several(parts: &[PartReport]) -> u8 {
        let helped = [code::INTERRUPTED, code::IO, code::RESOURCE];
        let found = |wanted: &u8| parts.iter().any(|part| part.code == *wanted);
        match helped.into_iter().find(found) {
            Some(code) => code,
            None if parts.iter().all(|part| part.code == code::DONE) => code::DONE,
            None => code::GATE,
        }
    }

    /// The report as text, with a line end.
    ///
    /// # Errors
    /// When a number or a text has no JSON form.
    pub fn text(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

/// Whether a part came through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Written, checked and accepted; or planned, in a dry run.
    Done,
    /// Nothing was written.
    Failed,
}

/// How the output came to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WritePath {
    /// The input's bytes.
    Verbatim,
    /// The input's bytes with edits.
    Patched,
}

/// What happened to one part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PartReport {
    /// Path of the input as the job found it.
    pub input: String,
    /// Path of the output; it stands there only when the status is `done`.
    pub output: String,
    /// Whether the part came through.
    pub status: Status,
    /// Exit code of this part alone.
    pub code: u8,
    /// Nothing has changed since an earlier run, and this is what it reported.
    #[serde(default)]
    pub unchanged: bool,
    /// SHA-256 of the input's bytes, where the run looked at them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// How the output was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub write_path: Option<WritePath>,
    /// Side files that were written.
    pub side_files: Vec<String>,
    /// Pictures that were written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<PictureReport>,
    /// Edits on the input's bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edits: Option<Edits>,
    /// Operations with what they measured.
    pub operations: Vec<OperationReport>,
    /// What became of statements about volume, area and centroid of changed bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub restated: Vec<crate::job::restate::Restated>,
    /// What the file cannot say any more, by code.
    pub losses: Vec<DiagnosticReport>,
    /// Facts about the input, by code.
    pub diagnostics: Vec<DiagnosticReport>,
    /// How often each code was met, also where not every one is listed.
    pub diagnostic_counts: BTreeMap<String, usize>,
    /// The input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<crate::job::report::measure::Figures>,
    /// The output, read again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<crate::job::report::measure::Figures>,
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

/// A picture beside the output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureReport {
    /// Its file.
    pub path: String,
    /// What it shows.
    pub kind: PictureKind,
    /// The number that has the full red; the same below zero has the full blue. A curvature in 1 over file units or a
    /// distance in file units; absent for highlight lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_colour: Option<f64>,
}

/// Why a part failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Failure {
    /// Stable code.
    pub code: String,
    /// What was found, and what would have been right.
    pub message: String,
}

/// Edits on the input's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// A warning about no place.
    #[must_use]
    pub fn warning(code: &str, message: String) -> Self {
        Self { code: code.to_owned(), severity: "warning".to_owned(), entity: None, line: None, message }
    }

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
            unchanged: false,
            sha256: None,
            failure: None,
            write_path: None,
            side_files: Vec::new(),
            pictures: Vec::new(),
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

    /// Takes over why the part failed.
    pub fn fail(&mut self, error: &PartError) {
        self.status = Status::Failed;
        self.code = error.exit_code();
        self.failure = Some(error.failure());
        self.side_files.clear();
        self.pictures.clear();
    }

    /// Takes over the facts about the input.
    pub fn take_diagnostics(&mut self, diagnostics: &Diagnostics, source: &Source) {
        self.diagnostics =
            diagnostics.kept().iter().map(|fact| DiagnosticReport::new(fact, source)).collect();
        self.diagnostic_counts =
            diagnostics.counts().iter().map(|(code, count)| ((*code).to_owned(), *count)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_with_nothing_in_it_is_read_again() {
        // Workers answer with it, and records keep it: a field that is left out when empty must be read as empty.
        let report = PartReport::new("a.step".to_owned(), "b.step".to_owned());
        let text = serde_json::to_string(&report).expect("a tree of texts and numbers");
        assert_eq!(serde_json::from_str::<PartReport>(&text).expect("the same form"), report);
    }
}
