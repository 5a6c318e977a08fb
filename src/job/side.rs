//! Files beside the output: meshes for viewing, a picture of before and after, the proof sheet.

use super::failure::PartError;
use super::file::{Job, SideFile};
use super::judge;
use super::output::Staged;
use super::plan::Part;
use super::proof::{self, Held};
use crate::document::Document;
use crate::math::Vector3;
use crate::mesh::Mesh;
use crate::model::Model;
use crate::picture::{PictureOptions, View, highlight_lines};

/// What side files are made of: the part before and after, and what was held.
pub struct Made<'a> {
    /// The input.
    pub before: (&'a Document, &'a Model),
    /// The output, read again.
    pub after: (&'a Document, &'a Model),
    /// Records that were held.
    pub held: Vec<Held>,
    /// Program that makes them.
    pub program: &'a str,
}

/// Writes the side files of a part beside their places; `chord` bounds their meshes.
///
/// # Errors
/// [`PartError`]; nothing stays.
pub fn staged(
    job: &Job,
    part: &Part,
    made: &Made<'_>,
    chord: Option<f64>,
) -> Result<Vec<(String, Staged)>, PartError> {
    let mut staged = Vec::with_capacity(job.also.len());
    for &side in &job.also {
        let path = part.output.with_extension(side.extension());
        let bytes = match side.mesh() {
            Some(format) => judge::side_bytes(made.after.1, chord, format)?,
            None if side == SideFile::Png => picture(made)?,
            None => sheet(part, made)?,
        };
        let name = path.to_string_lossy().into_owned();
        staged.push((name, Staged::write(&path, &bytes).map_err(PartError::Output)?));
    }
    Ok(staged)
}

/// Chord of a picture's meshes over the diagonal of the part: fine enough for bands to be smooth.
const FINENESS: f64 = 1e-4;

/// Highlight lines of the part before and after, seen along the shortest side of its box.
fn picture(made: &Made<'_>) -> Result<Vec<u8>, PartError> {
    let meshes = [made.before.1, made.after.1].map(|model| judge::whole_mesh(model, FINENESS));
    let [before, after] = meshes;
    let meshes = [before?, after?];
    let views: Vec<View<'_>> = meshes.iter().map(|mesh| View { mesh }).collect();
    highlight_lines(&views, &seen_flat(&meshes[0])).map_err(|error| PartError::Picture(error.to_string()))
}

/// A view from above the broad side of a part, with the lights above it and the longest side across.
fn seen_flat(mesh: &Mesh) -> PictureOptions {
    let sides = mesh
        .extents()
        .map_or([3.0, 2.0, 1.0], |box_| std::array::from_fn(|axis| box_.max[axis] - box_.min[axis]));
    let mut axes = [0, 1, 2];
    // Equal sides keep the order of the coordinates.
    axes.sort_by(|&a, &b| f64::total_cmp(&sides[b], &sides[a]).then(a.cmp(&b)));
    let unit = |axis: usize| Vector3::ith(axis, 1.0);
    let (across, up) = (unit(axes[0]), unit(axes[1]));
    // The eye on the side from which both axes run as on paper.
    let above = across.cross(&up);
    PictureOptions {
        eye: above - up * 0.55,
        up,
        lights_above: above,
        lights_along: up,
        ..PictureOptions::default()
    }
}

/// The proof sheet, once it is checked as anybody would.
fn sheet(part: &Part, made: &Made<'_>) -> Result<Vec<u8>, PartError> {
    let files = [(part.input.as_path(), made.before.0), (part.output.as_path(), made.after.0)];
    let sheet = proof::sheet(made.program, files[0], files[1], &made.held)
        .map_err(|error| PartError::Proof(vec![error.to_string()]))?;
    let found = proof::verify(&sheet, made.before.0, made.after.0);
    if !found.is_proved() {
        return Err(PartError::Proof(found.faults));
    }
    let mut text = serde_json::to_string_pretty(&sheet).expect("a sheet is a tree of texts and numbers");
    text.push('\n');
    Ok(text.into_bytes())
}
