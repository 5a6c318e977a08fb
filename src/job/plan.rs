//! From a job to its parts: every path is found and every clash refused before any data is touched.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use globset::{GlobBuilder, GlobMatcher};
use serde::{Deserialize, Serialize};

use super::Job;
use crate::document::Format;
use crate::job::file::{Operation, SideFile};

/// One part of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// The file to read.
    pub input: PathBuf,
    /// The file to write.
    pub output: PathBuf,
}

/// A job that cannot be carried out as it stands.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// An input pattern is not a glob.
    #[error("input `{pattern}` is not a path or glob: {reason}")]
    BadGlob {
        /// The pattern.
        pattern: String,
        /// Why.
        reason: String,
    },
    /// No file matches an input.
    #[error("input `{pattern}` matches no file{}", near(.nearest))]
    NoMatch {
        /// The pattern.
        pattern: String,
        /// The nearest name in the folder.
        nearest: Option<String>,
    },
    /// An input is a folder.
    #[error("input `{pattern}` is a folder; name the files in it, such as `{}*.step`", below(.pattern))]
    Folder {
        /// The input.
        pattern: String,
    },
    /// A folder that an input asks for cannot be searched.
    #[error("{} cannot be searched: {reason}", .folder.display())]
    Unseen {
        /// The folder.
        folder: PathBuf,
        /// Why.
        reason: String,
    },
    /// `output` names something in braces that is not known.
    #[error("output `{template}` has `{{{name}}}`; known are `{{dir}}`, `{{stem}}` and `{{ext}}`")]
    BadTemplate {
        /// The template.
        template: String,
        /// The unknown name.
        name: String,
    },
    /// The output's extension is that of no format of parts.
    #[error("output {} is neither STEP nor IGES; name it .step or .igs", .output.display())]
    OtherFormat {
        /// The output.
        output: PathBuf,
    },
    /// Two parts would be written to one file.
    #[error("{} and {} would both be written to {}", .first.display(), .second.display(), .output.display())]
    Clash {
        /// A part.
        first: PathBuf,
        /// Another.
        second: PathBuf,
        /// The file.
        output: PathBuf,
    },
    /// A proof sheet is asked for, and no operation holds anything.
    #[error("`also` asks for a proof, and no operation of the job has a `hold` to prove")]
    NothingToProve,
    /// A part would be written over an input.
    #[error("{} would be written over itself or another input", .output.display())]
    OverInput {
        /// The file.
        output: PathBuf,
    },
}

fn below(pattern: &str) -> String {
    if pattern.ends_with('/') { pattern.to_owned() } else { format!("{pattern}/") }
}

fn near(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; the nearest name is `{name}`")).unwrap_or_default()
}

/// Puts the job file's folder before the files that its operations read, which must exist.
///
/// # Errors
/// [`PlanError::NoMatch`].
pub fn resolve(job: &mut Job, folder: &Path) -> Result<(), PlanError> {
    for file in job.operation.iter_mut().flat_map(files) {
        let path = folder.join(&*file);
        if !path.is_file() {
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            return Err(PlanError::NoMatch { pattern: file.clone(), nearest: nearest_file(&path, &name) });
        }
        *file = path.to_string_lossy().into_owned();
    }
    Ok(())
}

/// Files that an operation reads.
fn files(operation: &mut Operation) -> Vec<&mut String> {
    match operation {
        Operation::ConstrainedScale(_) | Operation::Simplify(_) => Vec::new(),
        Operation::Deform(deform) => deform.files().collect(),
        Operation::FeatureReconstruction(words) => words.files().collect(),
        Operation::DetailTransfer(transfer) => {
            let source = &mut transfer.source;
            source.file.as_mut().or(source.detail.as_mut()).into_iter().collect()
        }
        Operation::FeaturePaste(paste) => {
            let source = &mut paste.source;
            source.file.as_mut().or(source.feature.as_mut()).into_iter().collect()
        }
    }
}

/// Files that the operations of a [resolved](resolve) job read beside its parts, in the order of the operations.
#[must_use]
pub fn referenced(job: &Job) -> Vec<PathBuf> {
    let mut operations = job.operation.clone();
    operations.iter_mut().flat_map(files).map(|file| PathBuf::from(&*file)).collect()
}

/// The parts of a job, sorted by path; `folder` is the job file's.
///
/// # Errors
/// [`PlanError`]. Nothing but names is looked at.
pub fn parts(job: &Job, folder: &Path) -> Result<Vec<Part>, PlanError> {
    let holds = |operation: &Operation| match operation {
        Operation::ConstrainedScale(scale) => !scale.hold.is_empty(),
        Operation::Deform(_)
        | Operation::DetailTransfer(_)
        | Operation::FeaturePaste(_)
        | Operation::FeatureReconstruction(_)
        | Operation::Simplify(_) => false,
    };
    if job.also.contains(&SideFile::Proof) && !job.operation.iter().any(holds) {
        return Err(PlanError::NothingToProve);
    }
    let mut inputs = Vec::new();
    for pattern in &job.inputs {
        inputs.extend(matches(pattern, folder)?);
    }
    inputs.sort();
    inputs.dedup();
    let mut parts = Vec::with_capacity(inputs.len());
    let mut outputs: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    for input in inputs {
        let output = folder.join(fill(&job.output, &input, folder)?);
        let extension = output.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if Format::of_extension(extension).is_none() {
            return Err(PlanError::OtherFormat { output });
        }
        if let Some(first) = outputs.insert(normal(&output), input.clone()) {
            return Err(PlanError::Clash { first, second: input, output });
        }
        parts.push(Part { input, output });
    }
    let others = referenced(job).into_iter().map(|file| folder.join(file));
    let mut read = parts.iter().map(|part| part.input.clone()).chain(others);
    match read.find(|file| outputs.contains_key(&normal(file))) {
        Some(output) => Err(PlanError::OverInput { output }),
        None => Ok(parts),
    }
}

/// The file that a path means, also when it and some of its folders do not exist yet: links are followed as
/// far as there is something to follow, and `..` takes a name back.
#[must_use]
pub fn normal(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut place = PathBuf::new();
    for part in absolute.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                place.pop();
            }
            _ => {
                place.push(part);
                place = place.canonicalize().unwrap_or(place);
            }
        }
    }
    place
}

/// Files that a path or glob means.
fn matches(pattern: &str, folder: &Path) -> Result<Vec<PathBuf>, PlanError> {
    let plain = folder.join(pattern);
    if plain.is_file() {
        return Ok(vec![plain]);
    }
    if plain.is_dir() {
        return Err(PlanError::Folder { pattern: pattern.to_owned() });
    }
    let bad = |e: globset::Error| PlanError::BadGlob { pattern: pattern.to_owned(), reason: e.to_string() };
    let first_special = pattern.find(['*', '?', '[', '{']).unwrap_or(pattern.len());
    let fixed = pattern[..first_special].rfind('/').map_or("", |slash| &pattern[..=slash]);
    let root = folder.join(fixed);
    let rest = &pattern[fixed.len()..];
    let glob = GlobBuilder::new(rest).literal_separator(true).build().map_err(bad)?.compile_matcher();
    let depth = if rest.contains("**") { DEPTH } else { rest.matches('/').count() + 1 };
    let found = walk(&root, depth, &glob)?;
    if found.is_empty() {
        let name = plain.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        return Err(PlanError::NoMatch { pattern: pattern.to_owned(), nearest: nearest_file(&plain, &name) });
    }
    Ok(found)
}

/// Folders below a `**` that are searched: a link that leads to its own parent must end somewhere.
const DEPTH: usize = 64;

/// A link to nothing counts as a part, so that it fails by its name; a folder that cannot be searched ends the search.
fn walk(root: &Path, depth: usize, glob: &GlobMatcher) -> Result<Vec<PathBuf>, PlanError> {
    let here = Path::new(".");
    let root = if root.as_os_str().is_empty() { here } else { root };
    let entries = walkdir::WalkDir::new(root).max_depth(depth).follow_links(true).into_iter();
    let below = |path: &Path| path.strip_prefix(root).is_ok_and(|rest| glob.is_match(rest));
    let mut found = Vec::new();
    for entry in entries {
        let path = match entry {
            Ok(entry) if entry.file_type().is_file() => entry.into_path(),
            Ok(_) => continue,
            Err(error) => match unseen(&error) {
                Some(refused) => return Err(refused),
                None => error.path().map(Path::to_path_buf).unwrap_or_default(),
            },
        };
        if below(&path) {
            found.push(path.strip_prefix(here).map(Path::to_path_buf).unwrap_or(path));
        }
    }
    Ok(found)
}

/// A folder whose parts would be passed over in silence.
fn unseen(error: &walkdir::Error) -> Option<PlanError> {
    let reason = error.io_error().filter(|error| error.kind() == std::io::ErrorKind::PermissionDenied)?;
    Some(PlanError::Unseen { folder: error.path()?.to_owned(), reason: reason.to_string() })
}

fn nearest_file(path: &Path, name: &str) -> Option<String> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::read_dir(parent).ok()?;
    let mut names: Vec<String> = folder.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    crate::job::text::nearest::nearest(name, names.iter().map(String::as_str)).map(str::to_owned)
}

/// Puts the parts of an input's path into a template.
fn fill(template: &str, input: &Path, folder: &Path) -> Result<String, PlanError> {
    let mut out = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        out.push_str(before);
        let (name, after) = after.split_once('}').unwrap_or((after, ""));
        let part = match name {
            "stem" => input.file_stem().map(|s| s.to_string_lossy().into_owned()),
            "ext" => input.extension().map(|s| s.to_string_lossy().into_owned()),
            "dir" => {
                let dir = input.parent().unwrap_or(Path::new(""));
                let dir = dir.strip_prefix(folder).unwrap_or(dir).to_string_lossy().into_owned();
                Some(if dir.is_empty() { ".".to_owned() } else { dir })
            }
            name => return Err(PlanError::BadTemplate { template: template.into(), name: name.into() }),
        };
        out.push_str(&part.unwrap_or_default());
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(inputs: &[&str], output: &str) -> Job {
        let list = inputs.iter().map(|i| format!("{i:?}")).collect::<Vec<_>>().join(",");
        let text = format!("version = 1\ninputs = [{list}]\noutput = {output:?}\n");
        crate::job::text::read(&text, crate::job::text::Syntax::Toml).expect("a valid job")
    }

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in names {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("below the folder")).expect("a folder");
            std::fs::write(path, "x").expect("a file");
        }
        folder
    }

    #[test]
    fn parts_are_sorted_and_each_stands_once() {
        let folder = folder(&["b.step", "a.stp", "deep/c.step", "d.igs"]);
        let job = job(&["*.st*p", "b.step", "deep/*.step"], "out/{stem}-x.{ext}");
        let parts = parts(&job, folder.path()).expect("a plan");
        let names: Vec<_> =
            parts.iter().map(|p| p.output.strip_prefix(folder.path()).expect("below")).collect();
        assert_eq!(names, ["out/a-x.stp", "out/b-x.step", "out/c-x.step"].map(Path::new));
    }

    #[test]
    fn impossible_plans_are_refused() {
        let folder = folder(&["a.step", "deep/a.step"]);
        let plan = |inputs: &[&str], output: &str| parts(&job(inputs, output), folder.path());
        assert!(matches!(plan(&["*.igs"], "out/{stem}.step"), Err(PlanError::NoMatch { .. })));
        assert!(matches!(plan(&["b.step"], "o.step"),
            Err(PlanError::NoMatch { nearest: Some(name), .. }) if name == "a.step"));
        assert!(matches!(plan(&["**/*.step"], "out/{stem}.step"), Err(PlanError::Clash { .. })));
        assert!(matches!(plan(&["a.step"], "./{stem}.{ext}"), Err(PlanError::OverInput { .. })));
        assert!(matches!(plan(&["a.step"], "o/{name}.step"), Err(PlanError::BadTemplate { .. })));
        assert!(matches!(plan(&["a.step"], "o/{stem}.stl"), Err(PlanError::OtherFormat { .. })));
        assert!(matches!(plan(&["[a.step"], "o.step"), Err(PlanError::BadGlob { .. })));
    }
}
