//! OpenSCAD: whether a mesh is closed enough for exact CSG, and what comes out.
//!
//! Exact CSG costs about 0.4 ms a triangle: give it a coarse mesh.

use super::process::{Finished, run};
use super::{Figures, Request, ValidateError, Validator, Verdict};
use crate::mesh::{Extents, Mesh, MeshReadError, off, stl};
use std::ffi::OsStr;
use std::path::Path;

const SCRIPT: &str = include_str!("closed_mesh.scad");

/// Greatest relative difference of volume between the mesh and OpenSCAD's result: it reads and writes
/// single precision in places, and a collapsed or lost piece is far greater.
const VOLUME_DIFFERENCE: f64 = 1e-4;

/// Asks OpenSCAD to do a CSG operation on an OFF or STL file that leaves the mesh as it is, and reads the
/// result back.
///
/// A mesh that is open, empty or changed by the operation gives a verdict that is not accepted.
///
/// # Errors
/// When the file is not a mesh; when OpenSCAD is missing, hangs or crashes; when it ends well and its
/// result is missing or garbled; when the scratch directory cannot be written.
pub fn ask_openscad(request: &Request) -> Result<Verdict, ValidateError> {
    let format = format_of(request.file);
    let bytes = std::fs::read(request.file).map_err(ValidateError::scratch(request.file))?;
    let mesh = read_mesh(&bytes, format).map_err(|source| {
        let path = request.file.display().to_string();
        ValidateError::NotAMesh { path, source }
    })?;
    let scratch = std::path::absolute(request.scratch).map_err(ValidateError::scratch(request.scratch))?;
    // A copy under a plain name: nothing in a path needs to be spelled in OpenSCAD's language.
    let name = format!("mesh.{format}");
    let paths = [scratch.join(&name), scratch.join("closed_mesh.scad"), scratch.join("result.off")];
    let [copy, script, result] = &paths;
    std::fs::write(copy, &bytes).map_err(ValidateError::scratch(copy))?;
    std::fs::write(script, fill_in(&name, mesh.extents())).map_err(ValidateError::scratch(script))?;
    if result.exists() {
        std::fs::remove_file(result).map_err(ValidateError::scratch(result))?;
    }
    let arguments = [OsStr::new("-o"), result.as_os_str(), script.as_os_str()];
    let finished = run(Validator::OpenScad, &arguments, &[], &scratch, request)?;
    judge(&mesh, format, finished, result)
}

/// The script, with a cube beside the mesh. The mesh is put round the origin: OpenSCAD writes six digits of a
/// coordinate, which are few for a small part that lies far off.
fn fill_in(name: &str, extents: Option<Extents>) -> String {
    let extents = extents.unwrap_or(Extents { min: [0.0; 3], max: [0.0; 3] });
    let size = if extents.diagonal() > 0.0 { extents.diagonal() } else { 1.0 };
    let center = extents.center();
    let [x, y, z] = [0, 1, 2].map(|k| extents.max[k] - center[k] + size);
    SCRIPT
        .replace("@MESH@", name)
        .replace("@CX@", &center.x.to_string())
        .replace("@CY@", &center.y.to_string())
        .replace("@CZ@", &center.z.to_string())
        .replace("@X@", &x.to_string())
        .replace("@Y@", &y.to_string())
        .replace("@Z@", &z.to_string())
        .replace("@SIZE@", &size.to_string())
}

fn judge(mesh: &Mesh, format: &str, finished: Finished, result: &Path) -> Result<Verdict, ValidateError> {
    let mut messages = complaints(&finished.output);
    let seconds = finished.seconds;
    let mut figures = Figures { format: format.to_owned(), valid: Some(false), ..Figures::default() };
    let refused = !finished.status.success() || !messages.is_empty();
    let Ok(bytes) = std::fs::read(result) else {
        if !refused {
            return Err(finished.no_sentinel("no result file"));
        }
        if messages.is_empty() {
            messages.push(format!("OpenSCAD ended with {}", finished.status));
        }
        return Ok(Verdict::new(Validator::OpenScad, figures, messages, seconds));
    };
    let mut out = match off::read(&bytes) {
        Ok(out) => out,
        Err(error) => return Err(finished.no_sentinel(format!("garbled result: {error}"))),
    };
    if let Some(extents) = mesh.extents() {
        let back = extents.center().coords;
        out.vertices.iter_mut().for_each(|vertex| *vertex += back);
    }
    figures.triangles = Some(out.triangles.len() as u64);
    figures.volume = Some(out.signed_volume());
    figures.area = Some(out.area());
    figures.extents = out.extents();
    if !finished.status.success() {
        messages.push(format!("OpenSCAD ended with {}", finished.status));
    }
    messages.extend(difference(mesh, &out));
    figures.valid = Some(messages.is_empty());
    Ok(Verdict::new(Validator::OpenScad, figures, messages, seconds))
}

/// Lines in which OpenSCAD complains.
fn complaints(output: &str) -> Vec<String> {
    let bad = ["ERROR", "WARNING", "not closed", "is empty"];
    output
        .lines()
        .filter(|line| bad.iter().any(|word| line.contains(word)))
        .map(|l| l.trim().to_owned())
        .collect()
}

/// What the operation changed, though it should have changed nothing.
fn difference(before: &Mesh, after: &Mesh) -> Option<String> {
    if after.triangles.is_empty() {
        return Some("the result has no triangle".to_owned());
    }
    let [before, after] = [before.signed_volume(), after.signed_volume()];
    let same = (before - after).abs() <= VOLUME_DIFFERENCE * before.abs();
    (!same).then(|| format!("volume {before} became {after}"))
}

fn format_of(path: &Path) -> &'static str {
    match path.extension().and_then(OsStr::to_str) {
        Some(extension) if extension.eq_ignore_ascii_case("stl") => "stl",
        _ => "off",
    }
}

fn read_mesh(bytes: &[u8], format: &str) -> Result<Mesh, MeshReadError> {
    if format == "stl" { stl::read(bytes) } else { off::read(bytes) }
}
