//! Files beside the output: meshes for viewing, pictures of what changed, the proof sheet.

pub mod illustrate;
pub(in crate::job) mod pictures;
pub mod proof;

use crate::document::Document;
use crate::job::failure::PartError;
use crate::job::file::Job;
use crate::job::judge;
use crate::job::output::Staged;
use crate::job::plan::Part;
use crate::job::report::{DiagnosticReport, PartReport, PictureReport};
use crate::job::side::proof::Held;
use crate::model::Model;

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

/// Writes the side files of a part beside their places, and names them in its report; `chord` bounds their meshes.
///
/// # Errors
/// [`PartError`]; nothing stays.
pub fn staged(
    job: &Job,
    part: &Part,
    made: &Made<'_>,
    chord: Option<f64>,
    report: &mut PartReport,
) -> Result<Vec<Staged>, PartError> {
    let mut staged = Vec::with_capacity(job.also.len());
    for &side in &job.also {
        let path = part.output.with_extension(side.extension());
        let bytes = match side.mesh() {
            Some(format) => judge::side_bytes(made.after.1, chord, format)?,
            None => sheet(part, made)?,
        };
        staged.push(Staged::write(&path, &bytes).map_err(PartError::Output)?);
        report.side_files.push(path.to_string_lossy().into_owned());
    }
    staged.extend(pictures(job, part, made, report)?);
    Ok(staged)
}

/// Pictures of the faces that changed.
fn pictures(
    job: &Job,
    part: &Part,
    made: &Made<'_>,
    report: &mut PartReport,
) -> Result<Vec<Staged>, PartError> {
    let drawn = crate::job::side::pictures::draw(made.before.1, made.after.1, &job.pictures)?;
    if drawn.is_empty() && !job.pictures.is_empty() {
        let text = "no picture was drawn, since no face changed".to_owned();
        report.losses.push(DiagnosticReport::warning("picture.no-face", text));
    }
    let mut staged = Vec::new();
    for picture in drawn {
        let path = part.output.with_extension(format!("{}.png", picture.kind.as_str()));
        staged.push(Staged::write(&path, &picture.png).map_err(PartError::Output)?);
        let (path, full_colour) = (path.to_string_lossy().into_owned(), picture.full_colour);
        report.pictures.push(PictureReport { path, kind: picture.kind, full_colour });
    }
    Ok(staged)
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
