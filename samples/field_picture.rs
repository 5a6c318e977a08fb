//! Draws what an operation did to the faces that it changed, as numbers over the surface: mean curvature before, mean
//! curvature after, and the deviation of the one from the other.
//!
//! `cargo run --release --example make-field-picture -- OUT.png BEFORE.step AFTER.step`. The surface is drawn, not only the
//! face on it. `docs/paste-fields.png` is the wheel of `samples/wheel`.

use std::process::ExitCode;

use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use resurf::geometry::{Carried, Surface};
use resurf::math::Point3;
use resurf::mesh::Mesh;
use resurf::model::Model;
use resurf::picture::{FieldView, PictureOptions, field};

/// Steps along each parameter.
const STEPS: u32 = 360;
/// Part of the samples that may be beyond the full colour: peaks would leave the rest pale.
const BEYOND: f64 = 0.01;

fn model(path: &str) -> Result<Model, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    let mut diagnostics = Diagnostics::default();
    let document =
        Document::open(bytes, "step", &mut diagnostics).map_err(|error| format!("{path}: {error}"))?;
    Ok(document.model(&mut diagnostics))
}

/// A grid over the surface, and its parameters.
fn grid(surface: &NurbsSurface) -> (Mesh, Vec<[f64; 2]>) {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let share = |k: u32| f64::from(k) / f64::from(STEPS);
    let mut mesh = Mesh::default();
    let mut places = Vec::new();
    for i in 0..=STEPS {
        for j in 0..=STEPS {
            let at = [u0 + share(i) * (u1 - u0), v0 + share(j) * (v1 - v0)];
            mesh.vertices.push(surface.point(at[0], at[1]));
            places.push(at);
        }
    }
    let normal = |k: u32| {
        let [u, v] = places[k as usize];
        surface.normal(u, v).unwrap_or_default()
    };
    for i in 0..STEPS {
        for j in 0..STEPS {
            let k = i * (STEPS + 1) + j;
            mesh.triangles.extend([[k, k + STEPS + 1, k + STEPS + 2], [k, k + STEPS + 2, k + 1]]);
        }
    }
    mesh.normals = mesh.triangles.iter().map(|corners| corners.map(normal)).collect();
    (mesh, places)
}

/// Mean curvature of the old surface at the foot of a point, and the signed distance from it.
fn against(old: &Surface, locator: Option<&SurfaceLocator<'_>>, point: &Point3<f64>) -> (f64, f64) {
    let (u, v) = locator.map_or_else(
        || old.parameters_of(point, None),
        |locator| {
            let found = locator.closest(point);
            (found.u, found.v)
        },
    );
    let at = old.derivatives(u, v);
    let way = point - at.point;
    let mean = at.curvatures().map_or(0.0, |(_, mean)| mean);
    (mean, at.normal().map_or(0.0, |normal| normal.dot(&way)))
}

/// The number that all but a few of the values stay below.
fn full(values: &[&[f64]]) -> f64 {
    let mut all: Vec<f64> = values.iter().flat_map(|v| v.iter()).map(|x| x.abs()).collect();
    all.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of the list")]
    let at = (all.len() as f64 * (1.0 - BEYOND)) as usize;
    all.get(at.min(all.len().saturating_sub(1))).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

fn draw(arguments: &[String]) -> Result<(), String> {
    let [out, before, after] = arguments else {
        return Err("expected OUT.png BEFORE.step AFTER.step".to_owned());
    };
    let (before, after) = (model(before)?, model(after)?);
    let changed = before.brep.faces.ids().find_map(|face| {
        let (old, new) = (before.brep.surface_of(face), after.brep.surface_of(face));
        match (old, new) {
            (Carried::Read(old), Carried::Read(Surface::Nurbs(new)))
                if old != &Surface::Nurbs(new.clone()) =>
            {
                Some((old, new))
            }
            _ => None,
        }
    });
    let (old, new) = changed.ok_or("no face has another surface")?;
    let (mesh, places) = grid(new);
    let locator = match old {
        Surface::Nurbs(old) => Some(SurfaceLocator::new(old, Wrap::default())),
        _ => None,
    };
    let compared: Vec<(f64, f64)> =
        mesh.vertices.iter().map(|point| against(old, locator.as_ref(), point)).collect();
    let flat = compared.iter().map(|c| c.0).collect::<Vec<f64>>();
    let deviation = compared.iter().map(|c| c.1).collect::<Vec<f64>>();
    let bent: Vec<f64> = places
        .iter()
        .map(|[u, v]| new.derivatives(*u, *v).curvatures().map_or(0.0, |(_, mean)| mean))
        .collect();
    let curvature = full(&[&flat, &bent]);
    let views = [(&flat, curvature), (&bent, curvature), (&deviation, full(&[&deviation]))]
        .map(|(values, full)| FieldView { mesh: &mesh, values, full });
    let eye = resurf::math::Vector3::new(1.0, -0.35, 0.35);
    let options = PictureOptions { eye, up: resurf::math::Vector3::z(), ..PictureOptions::default() };
    let png = field(&views, &options).map_err(|error| error.to_string())?;
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
