//! What is remembered of a part: in `.resurf` beside its output, a file for each part, written whole.
//!
//! A record counts only while its key is the part's own and every output has the digest that it had: whoever changes
//! an input, the job, a file that it reads, the program, a validator or an output has the part done again. Runs
//! side by side, killed ones and shares on many machines need no more than that.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::digest::{self, Digest};
use super::system;
use super::task::JobText;
use crate::job::Job;
use crate::job::failure::code;
use crate::job::judge::program_of;
use crate::job::output::{FileError, Staged};
use crate::job::plan::{self, Part};
use crate::job::report::{PartReport, Status};
use crate::job::run::program;

/// Folder of the records, beside the outputs.
pub(super) const FOLDER: &str = ".resurf";

/// Version of the records' own form.
const VERSION: u32 = 1;

/// Everything but the part that an output depends on.
pub(super) struct Circumstances(String);

impl Circumstances {
    /// Of a job, as this program on this machine carries it out.
    pub(super) fn of(text: &JobText, job: &Job) -> Self {
        let mut digest = Digest::new();
        digest.add("record", &VERSION.to_le_bytes());
        digest.add("program", program().as_bytes());
        digest.add("build", build().as_bytes());
        digest.add("job", text.text.as_bytes());
        for path in plan::referenced(job) {
            digest.add("file", digest::of_file(&path).unwrap_or_default().as_bytes());
        }
        for &validator in &job.validate.with {
            let found = program_of(validator).and_then(|path| digest::of_file(&path).ok());
            digest.add("validator", found.unwrap_or_default().as_bytes());
        }
        digest.add("date", std::env::var("SOURCE_DATE_EPOCH").unwrap_or_default().as_bytes());
        Self(digest.text())
    }

    /// The key of an input with this digest.
    pub(super) fn key(&self, sha256: &str) -> String {
        let mut digest = Digest::new();
        digest.add("circumstances", self.0.as_bytes());
        digest.add("input", sha256.as_bytes());
        digest.text()
    }
}

/// Tells builds of one version apart: a new one may give other bytes.
pub(super) fn build() -> String {
    let found = system::this_program().and_then(std::fs::metadata);
    let time = |data: &std::fs::Metadata| {
        let modified = data.modified().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some(modified.as_nanos())
    };
    found.map(|data| format!("{} {:?}", data.len(), time(&data))).unwrap_or_default()
}

/// A record as its file has it.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    version: u32,
    key: String,
    /// Files beside the record's folder, with their digests.
    outputs: Vec<(String, String)>,
    report: PartReport,
}

/// The place of something that is kept about an output.
pub(super) fn beside(output: &Path, extension: &str) -> Option<PathBuf> {
    let name = format!("{}.{extension}", output.file_name()?.to_string_lossy());
    Some(output.parent()?.join(FOLDER).join(name))
}

fn place(output: &Path) -> Option<PathBuf> {
    beside(output, "json")
}

/// What an earlier run reported of a part, when nothing has changed since.
pub(super) fn recall(part: &Part, key: &str) -> Option<PartReport> {
    let text = std::fs::read_to_string(place(&part.output)?).ok()?;
    let record: Record = serde_json::from_str(&text).ok()?;
    let folder = part.output.parent()?;
    let stands = |(name, sha256): &(String, String)| {
        digest::of_file(&folder.join(name)).is_ok_and(|found| found == *sha256)
    };
    let valid = record.version == VERSION && record.key == key && record.outputs.iter().all(stands);
    // A failed part has no output: one that stands there is not of this run.
    let absent = record.report.status == Status::Done || !part.output.exists();
    (valid && absent).then(|| {
        let mut report = record.report;
        report.unchanged = true;
        report.input = part.input.to_string_lossy().into_owned();
        report.output = part.output.to_string_lossy().into_owned();
        report
    })
}

/// Whether the same again would come of trying again.
fn is_settled(report: &PartReport) -> bool {
    let no_verdict = report.failure.as_ref().is_some_and(|failure| failure.code == "validate.no-verdict");
    report.status == Status::Done
        || [code::GATE, code::UNREADABLE, code::OPERATION].contains(&report.code) && !no_verdict
}

/// Remembers a part. A failure is remembered only where records are: it makes no folder.
///
/// # Errors
/// When the record cannot be written.
pub(super) fn remember(part: &Part, key: &str, report: &PartReport) -> Result<(), FileError> {
    let Some(place) = place(&part.output) else { return Ok(()) };
    let folder_there = place.parent().is_some_and(Path::is_dir);
    if !is_settled(report) || (report.status == Status::Failed && !folder_there) {
        return Ok(());
    }
    let outputs = written(part, report)?;
    let mut report = report.clone();
    report.unchanged = false;
    let record = Record { version: VERSION, key: key.to_owned(), outputs, report };
    let text = serde_json::to_string_pretty(&record)
        .map_err(|error| FileError { path: place.clone(), source: std::io::Error::other(error) })?;
    Staged::write(&place, text.as_bytes()).and_then(Staged::commit)
}

/// Names and digests of the files of a part.
fn written(part: &Part, report: &PartReport) -> Result<Vec<(String, String)>, FileError> {
    if report.status == Status::Failed {
        return Ok(Vec::new());
    }
    let sides = report.side_files.iter().map(PathBuf::from);
    let files = std::iter::once(part.output.clone()).chain(sides);
    let named = files.map(|path| {
        let sha256 = digest::of_file(&path).map_err(|source| FileError { path: path.clone(), source })?;
        Ok((path.file_name().unwrap_or_default().to_string_lossy().into_owned(), sha256))
    });
    named.collect()
}
