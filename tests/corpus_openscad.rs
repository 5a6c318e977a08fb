//! OpenSCAD's forced CSG over the mesh of every solid of the corpus: it accepts closed, manifold meshes only.
//!
//! Takes minutes, so it runs when `RESURF_CORPUS_OPENSCAD=1` asks for it; the corpus is no part of the project.
//! Meshes keep to 0.1 mm as far as exact CSG can take them, and are coarser where they would have more than
//! [`MOST`] triangles.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use resurf::brep::BodyKind;
use resurf::diagnostic::Diagnostics;
use resurf::mesh::{Mesh, Tolerances, off, tessellate_bodies};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};
use resurf::validate::{Request, ask_openscad};

/// Triangles that OpenSCAD is given at most: it takes about half a millisecond for each.
const MOST: usize = 6_000;

/// Least share of meshes that are accepted.
const GOAL: f64 = 0.98;

fn corpus() -> Option<PathBuf> {
    let wanted = std::env::var_os("RESURF_CORPUS_OPENSCAD").is_some_and(|value| value == "1");
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus");
    let dir = std::env::var_os("RESURF_CORPUS").map_or_else(beside, PathBuf::from);
    (wanted && dir.is_dir()).then_some(dir)
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// What OpenSCAD says of a mesh: `None` when it accepts it. Millimetres, since OpenSCAD rounds vertices to a grid of
/// a millionth of its unit.
fn refusal(mesh: &Mesh) -> Option<String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("given.off");
    let mut bytes = Vec::new();
    off::write(mesh, &mut bytes).expect("a vector takes all bytes");
    std::fs::write(&file, bytes).expect("the folder is ours");
    let scratch = folder.path().join("scratch");
    std::fs::create_dir(&scratch).expect("the folder is ours");
    let request =
        Request { file: &file, scratch: &scratch, timeout: Duration::from_secs(120), program: None };
    match ask_openscad(&request) {
        Ok(verdict) if verdict.accepted => None,
        Ok(verdict) => Some(verdict.messages.join("; ")),
        Err(error) => Some(error.to_string()),
    }
}

#[test]
fn openscad_accepts_the_meshes_of_solids() {
    let Some(corpus) = corpus() else { return };
    let mut paths = Vec::new();
    files(&corpus.join("step"), &mut paths);
    let (mut count, mut accepted) = (0u32, 0u32);
    let say = |line: &str| writeln!(std::io::stderr(), "{line}").expect("standard error is open");
    for path in paths {
        let bytes = std::fs::read(&path).expect("a file of the corpus");
        let mut sink = Diagnostics::default();
        let structure = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
        let model = to_model(&structure, &mut sink);
        for (id, _) in model.brep.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Solid) {
            let name = format!("{} {:?}", path.display(), model.origins.bodies[id]);
            let metres = model.contexts[model.body_context[id]].length.metres;
            let mut chord = 1e-4 / metres;
            let mesh_at = |chord: f64| {
                tessellate_bodies(&model.brep, &[id], &Tolerances { chord, angle: 30f64.to_radians() })
            };
            let mut mesh = mesh_at(chord);
            // A chord as great as the part's details makes its bounds cross: the last mesh stays then.
            while mesh.as_ref().is_ok_and(|mesh| mesh.triangles.len() > MOST) && chord * metres < 1.0 {
                let coarser = mesh_at(4.0 * chord);
                if coarser.is_err() {
                    break;
                }
                (chord, mesh) = (4.0 * chord, coarser);
            }
            count += 1;
            let refused = match mesh {
                Ok(mut mesh) => {
                    mesh.vertices.iter_mut().for_each(|vertex| vertex.coords *= 1e3 * metres);
                    refusal(&mesh).map(|said| format!("{} triangles: {said}", mesh.triangles.len()))
                }
                Err(error) => Some(format!("no mesh: {error}")),
            };
            accepted += u32::from(refused.is_none());
            if let Some(said) = refused {
                say(&format!("{name}, chord {:.1} mm, {said}", chord * metres * 1e3));
            }
        }
    }
    say(&format!("OpenSCAD accepts {accepted} of {count} solids"));
    assert!(count > 20 && f64::from(accepted) >= GOAL * f64::from(count), "{accepted} of {count}");
}
