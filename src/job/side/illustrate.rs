//! Pictures of what became of a part, made from the two files as anybody reads them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::job::failure::PartError;
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::report::difference::{Compared, lines};
use crate::mesh::Mesh;
use crate::picture::{FieldView, PictureError, PictureOptions, View, field, highlight_lines};
use crate::view;
use crate::view::base64::encode;

/// Pictures and words of one part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Illustration {
    /// Pictures in the order in which they are looked at.
    pub pictures: Vec<Picture>,
    /// How the two files differ.
    pub lines: Vec<String>,
}

/// A picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// What it shows.
    pub caption: String,
    /// PNG in base 64.
    pub png: String,
}

/// Pixels across a picture of one and of two views.
const WIDTHS: [u32; 2] = [420, 840];

/// Draws a part before and after, and writes a page that shows it in three dimensions.
///
/// # Errors
/// [`PartError`] when a file cannot be read or the page cannot be written. What cannot be drawn is left out.
pub fn illustrate(before: &Path, after: &Path, page: &Path) -> Result<Illustration, PartError> {
    let (mut input, mut output) = (Read::file(before)?, Read::file(after)?);
    let title = after.file_name().unwrap_or_default().to_string_lossy();
    let unchanged = input.document.source().bytes() == output.document.source().bytes();
    let after = output.model();
    if unchanged {
        write(page, &view::page(&after, &title, None).html)?;
        let compared = Compared::new(&after, &after, None);
        let picture = picture("Highlight lines", lines_of(&[&compared.meshes().1]));
        let lines = vec!["the output is the input, byte for byte".to_owned()];
        return Ok(Illustration { pictures: picture.into_iter().collect(), lines });
    }
    let before = input.model();
    let compared = Compared::new(&before, &after, None);
    write(page, &compared.page(&title).html)?;
    let ((was, is), values) = (compared.meshes(), compared.distances());
    let most = values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
    let caption = format!("Distance from the input: full red is {most:.3e} {}", compared.difference.unit);
    let view = FieldView { mesh: &is, values: &values, full: if most > 0.0 { most } else { 1.0 } };
    let drawn = field(&[view], &PictureOptions { width: WIDTHS[0], ..PictureOptions::default() });
    let pictures =
        [picture("Highlight lines, before and after", lines_of(&[&was, &is])), picture(&caption, drawn)];
    Ok(Illustration {
        pictures: pictures.into_iter().flatten().collect(),
        lines: lines(&compared.difference),
    })
}

fn lines_of(meshes: &[&Mesh]) -> Result<Vec<u8>, PictureError> {
    let views: Vec<View<'_>> = meshes.iter().map(|mesh| View { mesh }).collect();
    let width = WIDTHS[usize::from(views.len() > 1)];
    highlight_lines(&views, &PictureOptions { width, ..PictureOptions::default() })
}

fn picture(caption: &str, drawn: Result<Vec<u8>, PictureError>) -> Option<Picture> {
    Some(Picture { caption: caption.to_owned(), png: encode(&drawn.ok()?) })
}

fn write(page: &Path, html: &str) -> Result<(), PartError> {
    Staged::write(page, html.as_bytes()).and_then(Staged::commit).map_err(PartError::Output)
}
