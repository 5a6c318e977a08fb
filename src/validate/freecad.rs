//! FreeCAD: what its shape reader finds in a STEP or IGES file, and whether its checks pass.

use super::process::{Finished, run};
use super::{Figures, Request, ValidateError, Validator, Verdict};
use crate::mesh::Extents;
use std::ffi::OsStr;
use std::path::Path;

const SCRIPT: &str = include_str!("freecad.py");

/// Most bytes of a sentinel: its parts are bounded, so a longer one is not ours.
const SENTINEL_LIMIT: u64 = 1 << 20;

/// The sentinel file, as the script writes it.
#[derive(serde::Deserialize)]
struct Sentinel {
    read: bool,
    messages: Vec<String>,
    version: Option<String>,
    solids: Option<u64>,
    shells: Option<u64>,
    faces: Option<u64>,
    edges: Option<u64>,
    volume: Option<f64>,
    area: Option<f64>,
    tolerance: Option<f64>,
    extents: Option<SentinelExtents>,
    valid: Option<bool>,
}

#[derive(serde::Deserialize)]
struct SentinelExtents {
    min: [f64; 3],
    max: [f64; 3],
}

/// Asks FreeCAD to read a STEP, IGES or BREP file and to check it.
///
/// A file that FreeCAD cannot read, finds nothing in or calls invalid gives a verdict that is not accepted.
///
/// # Errors
/// When FreeCAD is missing, hangs, crashes, or ends without its sentinel; when the scratch directory
/// cannot be written.
pub fn ask_freecad(request: &Request) -> Result<Verdict, ValidateError> {
    let part = std::path::absolute(request.file).map_err(ValidateError::scratch(request.file))?;
    std::fs::metadata(&part).map_err(ValidateError::scratch(&part))?;
    let scratch = std::path::absolute(request.scratch).map_err(ValidateError::scratch(request.scratch))?;
    let script = scratch.join("resurf_validate.py");
    std::fs::write(&script, SCRIPT).map_err(ValidateError::scratch(&script))?;
    let sentinel = scratch.join("freecad.json");
    remove_old(&sentinel)?;
    let variables = [("RESURF_PART", part.as_os_str()), ("RESURF_SENTINEL", sentinel.as_os_str())];
    let finished = run(Validator::FreeCad, &[script.as_os_str()], &variables, &scratch, request)?;
    let (answer, seconds) = read_sentinel(&sentinel, finished)?;
    Ok(judge(answer, format_of(&part), seconds))
}

/// An answer of an earlier run must not pass for this one's.
fn remove_old(path: &Path) -> Result<(), ValidateError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(ValidateError::scratch(path)(error))
        }
        _ => Ok(()),
    }
}

fn read_sentinel(path: &Path, finished: Finished) -> Result<(Sentinel, f64), ValidateError> {
    let Ok(metadata) = std::fs::metadata(path) else {
        return Err(finished.no_sentinel("no sentinel file"));
    };
    if metadata.len() > SENTINEL_LIMIT {
        return Err(finished.no_sentinel(format!("sentinel of {} bytes", metadata.len())));
    }
    let bytes = std::fs::read(path).map_err(ValidateError::scratch(path))?;
    match serde_json::from_slice(&bytes) {
        Ok(sentinel) => Ok((sentinel, finished.seconds)),
        Err(error) => Err(finished.no_sentinel(format!("garbled sentinel: {error}"))),
    }
}

fn judge(answer: Sentinel, format: &str, seconds: f64) -> Verdict {
    let mut messages = answer.messages;
    if messages.is_empty() {
        // A refusal without a reason is still a refusal.
        let refusals = [
            (!answer.read, "not read"),
            (answer.valid != Some(true), "not called valid"),
            (answer.edges.unwrap_or(0) == 0, "no edges found"),
        ];
        messages.extend(refusals.iter().filter(|(refused, _)| *refused).map(|(_, why)| (*why).to_owned()));
    }
    let figures = Figures {
        format: format.to_owned(),
        version: answer.version,
        solids: answer.solids,
        shells: answer.shells,
        faces: answer.faces,
        edges: answer.edges,
        triangles: None,
        volume: answer.volume,
        area: answer.area,
        valid: answer.valid,
        extents: answer.extents.map(|SentinelExtents { min, max }| Extents { min, max }),
        tolerance: answer.tolerance,
    };
    Verdict::new(Validator::FreeCad, figures, messages, seconds)
}

/// Format by extension, as FreeCAD decides it.
fn format_of(path: &Path) -> &'static str {
    let extension = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("step" | "stp") => "step",
        Some("iges" | "igs") => "iges",
        Some("brep" | "brp") => "brep",
        _ => "unknown",
    }
}
