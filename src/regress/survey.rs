//! The parts and jobs of a folder, measured by workers.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::time::Instant;

use crate::batch::{Interrupt, JobText, Limits, measure};
use crate::document::Format;
use crate::job::file::ValidatorName;
use crate::job::plan::{self, Part, normal};
use crate::job::report::measured::{Measure, Measures};

/// What a part measures now.
#[derive(Debug, Clone, PartialEq)]
pub struct Surveyed {
    /// Its path in the folder; of a job's part that of the job, a colon, and the part's.
    pub name: String,
    /// What it measures.
    pub measures: Measures,
    /// Wall time.
    pub seconds: f64,
}

/// Something to measure.
#[derive(Debug, Clone)]
struct Item {
    name: String,
    input: PathBuf,
    /// The job that makes what is measured, or why there is none.
    job: Option<Result<JobText, String>>,
    bytes: u64,
}

/// Folders below that are searched.
const DEPTH: usize = 64;

/// Measures every part of a folder, and what every job in it makes of its parts; outputs go to a folder that vanishes.
///
/// # Errors
/// When the folder cannot be read, or no scratch folder can be made.
pub fn survey(
    folder: &Path,
    validators: &[ValidatorName],
    limits: &Limits,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Surveyed),
) -> std::io::Result<Vec<Surveyed>> {
    let mut items = items(folder)?;
    items.sort_by(|a, b| b.bytes.cmp(&a.bytes).then_with(|| a.name.cmp(&b.name)));
    let scratch = tempfile::tempdir()?;
    let numbered = items.into_iter().enumerate();
    let work = |(at, item): (usize, Item), tell: &Sender<Surveyed>| {
        let place = scratch.path().join(at.to_string());
        let _ = tell.send(one(&item, &place, validators, limits, interrupt));
    };
    let mut all = Vec::new();
    crate::batch::each(numbered, limits.jobs, &|| interrupt.asked(), &work, &mut |surveyed| {
        watch(&surveyed);
        all.push(surveyed);
    });
    all.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(all)
}

fn one(
    item: &Item,
    scratch: &Path,
    validators: &[ValidatorName],
    limits: &Limits,
    interrupt: &Interrupt,
) -> Surveyed {
    let begin = Instant::now();
    let measured = match &item.job {
        None => measure::part(&item.input, validators, limits, interrupt),
        Some(Err(message)) => Err(("job".to_owned(), message.clone())),
        Some(Ok(job)) => {
            let output = scratch.join(item.input.file_name().unwrap_or_default());
            let part = Part { input: item.input.clone(), output };
            measure::job(job, &part, validators, limits, interrupt)
        }
    };
    let seconds = begin.elapsed().as_secs_f64();
    let mut measures = match measured {
        Ok(mut measures) => {
            measures.insert("outcome".to_owned(), Measure::Word("done".to_owned()));
            measures
        }
        // The message has paths and times in it: the code is what must come again.
        Err((code, _)) => Measures::from([("outcome".to_owned(), Measure::Word(code))]),
    };
    if let Ok(digest) = measure::digest(&item.input) {
        measures.insert("sha256".to_owned(), Measure::Word(digest));
    }
    measures.insert("seconds".to_owned(), Measure::Number(rounded(seconds)));
    Surveyed { name: item.name.clone(), measures, seconds }
}

/// Two digits: more would say nothing.
fn rounded(seconds: f64) -> f64 {
    format!("{seconds:.1e}").parse().unwrap_or(seconds)
}

/// Parts and jobs below a folder. Outputs of its jobs are no parts, nor is what is hidden.
fn items(folder: &Path) -> std::io::Result<Vec<Item>> {
    std::fs::read_dir(folder)?;
    let hidden =
        |entry: &walkdir::DirEntry| entry.depth() > 0 && entry.file_name().to_string_lossy().starts_with('.');
    let walk = walkdir::WalkDir::new(folder).max_depth(DEPTH).follow_links(true).sort_by_file_name();
    let mut files = Vec::new();
    for entry in walk.into_iter().filter_entry(|entry| !hidden(entry)) {
        match entry {
            Ok(entry) if entry.file_type().is_file() => files.push(entry.into_path()),
            Ok(_) => {}
            // A link to nothing fails by its name when it is measured; what cannot be searched must not seem to be gone.
            Err(error) if error.io_error().is_some_and(|e| e.kind() == std::io::ErrorKind::NotFound) => {
                files.extend(error.path().map(Path::to_path_buf));
            }
            Err(error) if error.loop_ancestor().is_some() => {}
            Err(error) => return Err(error.into()),
        }
    }
    let (mut items, mut outputs) = (Vec::new(), BTreeSet::new());
    for path in files.iter().filter(|path| is(path, &["toml", "json"])) {
        if let Some(found) = job(folder, path, &mut outputs) {
            items.extend(found);
        }
    }
    let parts = files.iter().filter(|path| is_part(path) && !outputs.contains(&normal(path)));
    items.extend(parts.map(|path| item(name(folder, path), path.clone(), None)));
    Ok(items)
}

fn is(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    extensions.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

fn is_part(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    Format::of_extension(extension).is_some()
}

fn name(folder: &Path, path: &Path) -> String {
    path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

fn item(name: String, input: PathBuf, job: Option<Result<JobText, String>>) -> Item {
    let bytes = std::fs::metadata(&input).map_or(0, |data| data.len());
    Item { name, input, job, bytes }
}

/// The parts of a job; `None` for a file that is no job at all.
fn job(folder: &Path, path: &Path, outputs: &mut BTreeSet<PathBuf>) -> Option<Vec<Item>> {
    let text = match JobText::file(path) {
        Ok(text) => text,
        Err(error) => {
            return Some(vec![item(name(folder, path), path.to_owned(), Some(Err(error.to_string())))]);
        }
    };
    if !["inputs", "output"].iter().all(|key| text.text.contains(key)) {
        return None;
    }
    let job_name = name(folder, path);
    let parts = text
        .job()
        .map_err(|error| error.to_string())
        .and_then(|job| plan::parts(&job, &text.folder).map_err(|error| error.to_string()));
    Some(match parts {
        Ok(parts) => {
            outputs.extend(parts.iter().map(|part| normal(&part.output)));
            let named = |part: Part| {
                let name = format!("{job_name}: {}", name(&text.folder, &part.input));
                item(name, part.input, Some(Ok(text.clone())))
            };
            parts.into_iter().map(named).collect()
        }
        Err(message) => vec![item(job_name, path.to_owned(), Some(Err(message)))],
    })
}
