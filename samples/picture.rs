//! Draws highlight lines of parts side by side: `cargo run --release --example make-picture -- OUT.png PART.step…`.
//!
//! `docs/door-highlight.png` is the bundled door before and after its job.

use std::process::ExitCode;

use resurf::brep::BodyId;
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::mesh::{Mesh, Tolerances, tessellate_bodies};
use resurf::picture::{PictureOptions, View, highlight_lines};

/// Chord tolerance over the diagonal of a part: fine enough for the bands of a picture to be smooth.
const FINENESS: f64 = 1e-4;

fn mesh(path: &str) -> Result<Mesh, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    let mut diagnostics = Diagnostics::default();
    let document =
        Document::open(bytes, "step", &mut diagnostics).map_err(|error| format!("{path}: {error}"))?;
    let model = document.model(&mut diagnostics);
    let points: Vec<_> = model.brep.vertices.iter().map(|(_, vertex)| vertex.point).collect();
    let diagonal = resurf::math::BoundingBox::of(points.iter()).diagonal();
    let bodies: Vec<BodyId> = model.brep.bodies.ids().collect();
    let tolerances = Tolerances { chord: FINENESS * diagonal, ..Tolerances::for_size(diagonal) };
    tessellate_bodies(&model.brep, &bodies, &tolerances).map_err(|error| format!("{path}: {error}"))
}

fn draw(arguments: &[String]) -> Result<(), String> {
    let [out, parts @ ..] = arguments else { return Err("expected OUT.png PART.step…".to_owned()) };
    let meshes = parts.iter().map(|path| mesh(path)).collect::<Result<Vec<Mesh>, String>>()?;
    let views: Vec<View> = meshes.iter().map(|mesh| View { mesh }).collect();
    let png = highlight_lines(&views, &PictureOptions::default()).map_err(|error| error.to_string())?;
    std::fs::write(out, png).map_err(|error| format!("{out}: {error}"))
}

#[expect(clippy::print_stderr, reason = "a program of its own")]
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match draw(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
