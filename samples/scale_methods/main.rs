//! The published energy, the default and the method before them on the same parts:
//! `cargo run --release --example compare-methods -- [FOLDER]`.
//!
//! Prints the table of `docs/scaling-methods.md`; with a folder, writes its pictures there: the part, plainly scaled,
//! published, default, attached and deformed, under the same lights.

mod attach_and_deform;
#[path = "../../tests/support/nets.rs"]
#[allow(clippy::unwrap_used, reason = "shared with the tests")]
mod nets;
#[path = "../../tests/constrained_scale/parts.rs"]
#[allow(dead_code, unused_imports, reason = "shared with the tests")]
mod parts;

use std::path::Path;
use std::process::ExitCode;

use attach_and_deform::{Attached, attach_and_deform};
use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::Vector3;
use resurf::mesh::Mesh;
use resurf::ops::constrained_scale::fold::strongest_compression;
use resurf::ops::constrained_scale::measures::{certified, motion_deviation, quality};
use resurf::ops::constrained_scale::{HeldLoop, ScaledFace, Scaling, scale_face};
use resurf::ops::net::{Mask, Polygon};
use resurf::picture::{PictureOptions, View, highlight_lines};

/// Samples of the figures in each direction.
const SAMPLES: usize = 101;
/// Cells of a picture's mesh in each direction.
const CELLS: usize = 240;

type Loops = Vec<Vec<[f64; 2]>>;

/// One result: its name, its face, its loops, and the greatest relative deviation of these from their shape.
struct Outcome {
    method: &'static str,
    face: ScaledFace,
    loops: Loops,
    loop_deviation: f64,
}

fn solved(method: &'static str, part: &NurbsSurface, held: &[HeldLoop], scaling: &Scaling) -> Outcome {
    let scaled = scale_face(part, held, None, scaling).expect("the panels of the specification scale");
    let face = scaled.faces[0].clone();
    let off = scaled.groups.iter().flat_map(|group| {
        let face = &face;
        group.loops.iter().map(move |&(_, k)| {
            motion_deviation(part, &face.surface, &held[k].contour.points, &group.motion).relative
        })
    });
    let loop_deviation = off.fold(0.0, f64::max);
    Outcome { method, face, loops: held.iter().map(|l| l.contour.points.clone()).collect(), loop_deviation }
}

fn attached(part: &NurbsSurface, default: &Outcome, scaling: &Scaling) -> Outcome {
    let map = scaling.affine().expect("positive factors");
    let plain = &default.face.plain;
    let Attached { surface, loops, deviation } = attach_and_deform(part, plain, &map, &default.loops);
    let (rows, columns) = surface.shape();
    let face = ScaledFace {
        compression: strongest_compression(&surface, plain),
        surface,
        held: Mask::empty(rows, columns),
        ..default.face.clone()
    };
    let loop_deviation = deviation.into_iter().fold(0.0, f64::max);
    Outcome { method: "attach and deform", face, loops, loop_deviation }
}

fn row(part: &str, factors: [f64; 3], outcome: &Outcome) -> String {
    let q = quality(&outcome.face, SAMPLES);
    let bound = certified(&outcome.face).outside.map_or(f64::NAN, |found| found.bound);
    let part_of = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.3}"));
    format!(
        "| {part} | {}/{}/{} | {} | {:.3} | {:.3} | {bound:.3} | {:.2} | {} | {} | {} | {:.0e} |\n",
        factors[0],
        factors[1],
        factors[2],
        outcome.method,
        q.deviation_max,
        q.deviation_rms,
        q.normal_angle_max.to_degrees(),
        part_of(q.gaussian_correlation),
        part_of(q.mean_correlation),
        part_of(q.bending_ratio),
        outcome.loop_deviation,
    )
}

/// A surface without the inside of its loops, for a picture.
fn mesh(surface: &NurbsSurface, loops: &Loops) -> Mesh {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let holes = loops.iter().map(|l| Polygon::new(l, [0.0; 2], [(u0, u1), (v0, v1)]));
    let holes: Vec<Polygon> = holes.collect::<Result<_, _>>().expect("loops are simple");
    let at = |i: usize, j: usize| {
        let part = |k: usize| k as f64 / CELLS as f64;
        [u0 + (u1 - u0) * part(i), v0 + (v1 - v0) * part(j)]
    };
    let mut mesh = Mesh::default();
    let mut normals = Vec::new();
    for k in 0..(CELLS + 1) * (CELLS + 1) {
        let [u, v] = at(k / (CELLS + 1), k % (CELLS + 1));
        mesh.vertices.push(surface.point(u, v));
        normals.push(surface.normal(u, v).unwrap_or_else(Vector3::z));
    }
    for k in 0..CELLS * CELLS {
        let (i, j) = (k / CELLS, k % CELLS);
        let middle = [at(i, j), at(i + 1, j + 1)];
        let middle = [0, 1].map(|c| 0.5 * (middle[0][c] + middle[1][c]));
        if holes.iter().any(|hole| hole.contains(middle)) {
            continue;
        }
        let corner = |i: usize, j: usize| i * (CELLS + 1) + j;
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        for triangle in [[a, b, c], [a, c, d]] {
            mesh.triangles.push(triangle.map(|k| u32::try_from(k).expect("a small grid")));
            mesh.normals.push(triangle.map(|k| normals[k]));
        }
    }
    mesh
}

fn picture(part: &NurbsSurface, outcomes: &[Outcome]) -> Result<Vec<u8>, String> {
    let held = &outcomes[0].loops;
    let mut meshes = vec![mesh(part, held), mesh(&outcomes[0].face.plain, held)];
    meshes.extend(outcomes.iter().map(|outcome| mesh(&outcome.face.surface, &outcome.loops)));
    let views: Vec<View> = meshes.iter().map(|mesh| View { mesh }).collect();
    highlight_lines(&views, &PictureOptions { width: 2000, ..PictureOptions::default() })
        .map_err(|error| error.to_string())
}

fn compare(folder: Option<&Path>) -> Result<String, String> {
    let mut table = String::from(
        "| part | factors | method | max | rms | bound | angle | Kc | Hc | bend | loops |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, part) in [("door", parts::door()), ("trunk", parts::trunk()), ("hood", parts::hood())] {
        for factors in [[1.1, 1.2, 1.25], [2.0; 3]] {
            let (surface, held) = &part;
            let scaling = Scaling::new(factors);
            let published = solved("published", surface, held, &parts::published(factors));
            let default = solved("default", surface, held, &scaling);
            let attached = attached(surface, &default, &scaling);
            let outcomes = [published, default, attached];
            table.extend(outcomes.iter().map(|outcome| row(name, factors, outcome)));
            if let Some(folder) = folder {
                let path = folder.join(format!("methods-{name}-{}.png", factors[0]));
                let png = picture(surface, &outcomes)?;
                std::fs::write(&path, png).map_err(|error| format!("{}: {error}", path.display()))?;
            }
        }
    }
    Ok(table)
}

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a program of its own")]
fn main() -> ExitCode {
    let folder = std::env::args().nth(1);
    match compare(folder.as_deref().map(Path::new)) {
        Ok(table) => {
            print!("{table}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
