//! Pictures and pages of the parts of a run, each made by a worker of its own; those of parts that have not changed are
//! kept beside the records.

use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;

use serde::{Deserialize, Serialize};

use super::digest;
use super::interrupt::Interrupt;
use super::limits::Limits;
use super::queue;
use super::record;
use super::supervise::supervise;
use super::task::{Order, Task, Word};
use crate::job::output::Staged;
use crate::job::plan::Part;
use crate::job::report::{PartReport, Report, Status};
use crate::job::side::illustrate::Illustration;

/// A part with its pictures, or why there are none.
#[derive(Debug)]
pub struct Illustrated {
    /// Path of the input, as the report has it.
    pub input: String,
    /// Where its page is.
    pub page: PathBuf,
    /// The pictures.
    pub illustration: Result<Illustration, String>,
}

/// Pictures as they are kept.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    key: String,
    /// Digest of the page: its place is a number among the parts of a run, and may be another part's by now.
    page: String,
    illustration: Illustration,
}

/// Draws the parts of a report that are done. Pages go into `folder`, named after the parts.
#[must_use]
pub fn illustrate(
    report: &Report,
    folder: &Path,
    limits: &Limits,
    interrupt: &Interrupt,
) -> Vec<Illustrated> {
    let done = report.parts.iter().enumerate().filter(|(_, part)| part.status == Status::Done);
    let items: Vec<(usize, &PartReport, PathBuf)> =
        done.map(|(at, part)| (at, part, folder.join(page_name(at, part)))).collect();
    let work = |(at, report, page): (usize, &PartReport, PathBuf), tell: &Sender<(usize, Illustrated)>| {
        let part = Part { input: PathBuf::from(&report.input), output: PathBuf::from(&report.output) };
        let illustration = drawn(&part, &page, limits, interrupt);
        let _ = tell.send((at, Illustrated { input: report.input.clone(), page, illustration }));
    };
    let mut all = Vec::new();
    queue::each(items, limits.jobs, &|| interrupt.asked(), &work, &mut |drawn| all.push(drawn));
    all.sort_by_key(|(at, _)| *at);
    all.into_iter().map(|(_, drawn)| drawn).collect()
}

/// The number keeps parts of one name apart, the name is for people.
fn page_name(at: usize, part: &PartReport) -> String {
    let stem = Path::new(&part.output).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let plain: String =
        stem.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
    format!("{:04}-{plain}.html", at + 1)
}

fn drawn(part: &Part, page: &Path, limits: &Limits, interrupt: &Interrupt) -> Result<Illustration, String> {
    let key = key(part).map_err(|error| error.to_string())?;
    let place = record::beside(&part.output, "pictures.json");
    let kept = place.as_ref().and_then(|place| std::fs::read_to_string(place).ok());
    let kept = kept.and_then(|text| serde_json::from_str::<Kept>(&text).ok());
    if let Some(kept) = kept.filter(|kept| kept.key == key && is_of(page, &kept.page)) {
        return Ok(kept.illustration);
    }
    let task = Task::Illustrate { part: part.clone(), page: page.to_owned() };
    let order = Order { task, memory: limits.share(), threads: limits.threads() };
    let illustration = match supervise(&order, limits.time, interrupt, &mut |_| {}) {
        Ok(Word::Drawn(drawn)) => drawn?,
        Ok(_) => return Err("the worker gave another answer".to_owned()),
        Err(error) => return Err(error.to_string()),
    };
    let digest = digest::of_file(page).map_err(|error| error.to_string())?;
    let kept = Kept { key, page: digest, illustration };
    // Pictures that cannot be kept are drawn again.
    if let (Some(place), Ok(text)) = (place, serde_json::to_string(&kept)) {
        let _ = Staged::write(&place, text.as_bytes()).and_then(Staged::commit);
    }
    Ok(kept.illustration)
}

fn is_of(page: &Path, digest: &str) -> bool {
    digest::of_file(page).is_ok_and(|found| found == digest)
}

/// Both files and the program.
fn key(part: &Part) -> std::io::Result<String> {
    let mut digest = digest::Digest::new();
    digest.add("build", record::build().as_bytes());
    for path in [&part.input, &part.output] {
        digest.add("file", digest::of_file(path)?.as_bytes());
    }
    Ok(digest.text())
}
