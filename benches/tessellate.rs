//! Faces per second of tessellation, without reading: for `benches/peer/mesh.py`, which runs it beside another
//! program.
//!
//! `tessellate FILE.step CHORD ANGLE [ROUNDS]` with the chord in metres and the angle in degrees prints one JSON object: faces
//! meshed, triangles, and the least processor time for all bodies. Without a file it meshes a sample of the
//! project, so that `cargo bench` has something to do.

use std::io::Write as _;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Instant;

use resurf::brep::{BodyId, FaceId};
use resurf::diagnostic::Diagnostics;
use resurf::mesh::{Integrity, Tolerances, tessellate_bodies};
use resurf::model::Model;
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};

/// What one round made.
#[derive(Debug, Default)]
struct Made {
    faces: usize,
    refused: Vec<String>,
    triangles: usize,
    closed: usize,
    seconds: f64,
}

/// Processor time of all threads of this process; where the system does not say, time on the wall.
fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    // The system counts a running thread's time up when it gives way, else only at its ticks.
    std::thread::yield_now();
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = |thread: std::fs::DirEntry| -> Option<f64> {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    let sum: f64 = threads.filter_map(nanoseconds).sum();
    if sum > 0.0 { 1e-9 * sum } else { START.elapsed().as_secs_f64() }
}

fn faces_of(model: &Model, body: BodyId) -> impl Iterator<Item = FaceId> {
    let shells = model.brep.bodies[body].shells.iter();
    shells.flat_map(|&shell| model.brep.shells[shell].faces.iter().copied())
}

fn round(model: &Model, chord: f64, angle: f64) -> Made {
    let mut made = Made::default();
    for (id, _) in model.brep.bodies.iter() {
        let metres = model.contexts[model.body_context[id]].length.metres;
        let tolerances = Tolerances { chord: chord / metres, angle };
        let bodies: [BodyId; 1] = [id];
        let start = seconds();
        let mesh = tessellate_bodies(&model.brep, &bodies, &tolerances);
        made.seconds += seconds() - start;
        match mesh {
            Ok(mesh) => {
                made.faces += faces_of(model, id).count();
                made.triangles += mesh.triangles.len();
                made.closed += usize::from(Integrity::of(&mesh).is_closed());
            }
            Err(error) => made.refused.push(error.to_string()),
        }
    }
    made
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|given| given != "--bench").collect();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/door/door.step");
    let file = arguments.first().map_or(sample.as_path(), Path::new);
    let number = |at: usize, default: f64| arguments.get(at).and_then(|n| n.parse().ok()).unwrap_or(default);
    let (chord, angle, rounds) = (number(1, 1e-4), number(2, 20.0).to_radians(), number(3, 1.0));
    let begin = seconds();
    let bytes = std::fs::read(file).expect("the file can be read");
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(bytes).expect("below 4 GiB"), &mut sink);
    let model = to_model(&structure, &mut sink);
    let read = seconds() - begin;
    let mut best = round(&model, chord, angle);
    let mut done = 1.0;
    while done < rounds {
        best.seconds = best.seconds.min(round(&model, chord, angle).seconds);
        done += 1.0;
    }
    let Made { faces, refused, triangles, closed, seconds } = best;
    let line = serde_json::json!({
        "faces": faces, "triangles": triangles, "closed": closed, "seconds": seconds, "refused": refused, "read": read,
    });
    writeln!(std::io::stdout(), "{line}").expect("standard output is open");
}
