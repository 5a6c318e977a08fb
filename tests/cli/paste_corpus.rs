//! Feature paste on real files: the bump, scaled to the face, on faces of every kind of surface.
//!
//! Skips silently without the corpus. FreeCAD is asked where it is installed, and must then find the part valid with as
//! many faces as the file has.

use resurf::brep::FaceId;
use resurf::brep::parameter_loop::{LoopSampling, parameter_loops};
use resurf::geometry::{Carried, Surface};
use resurf::math::Point3;
use resurf::model::Model;

use crate::Fixture;
use crate::paste::{job, model};
use crate::support::corpus;

/// Side of the bump's sheet in metres.
const SHEET: f64 = 0.08;
/// Part of a face's width that the feature takes.
const SHARE: f64 = 0.35;
/// Faces of a kind that are tried, widest first.
const TRIED: usize = 6;

/// A face with a place in its middle and its least width there, in file units.
type Candidate = (f64, FaceId, Point3<f64>);

fn candidates(model: &Model, kind: &str) -> Vec<Candidate> {
    let mut found: Vec<Candidate> =
        model.brep.faces.ids().filter_map(|face| candidate(model, face, kind)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    found.truncate(TRIED);
    found
}

fn candidate(model: &Model, face: FaceId, kind: &str) -> Option<Candidate> {
    let Carried::Read(surface) = model.brep.surface_of(face) else { return None };
    if surface.kind() != kind {
        return None;
    }
    let loops = parameter_loops(&model.brep, face, &LoopSampling::of_tolerance(1e-3)).ok()?;
    let range = |k: usize| {
        let at = loops.iter().flat_map(|l| &l.points).map(|p| if k == 0 { p.u } else { p.v });
        at.fold(None, |range: Option<(f64, f64)>, x| {
            let (a, b) = range.unwrap_or((x, x));
            Some((a.min(x), b.max(x)))
        })
    };
    let (u, v) = (range(0)?, range(1)?);
    let middle = (0.5 * (u.0 + u.1), 0.5 * (v.0 + v.1));
    let length = |at: &dyn Fn(f64) -> Point3<f64>| -> f64 {
        (0..32).map(|k| (at(f64::from(k) / 32.0) - at(f64::from(k + 1) / 32.0)).norm()).sum()
    };
    let inside = |surface: &Surface, x: f64, y: f64| {
        let (x, y) = surface.wrapped(x, y);
        surface.point(x, y)
    };
    let along = length(&|s| inside(surface, u.0 + s * (u.1 - u.0), middle.1));
    let across = length(&|s| inside(surface, middle.0, v.0 + s * (v.1 - v.0)));
    let width = along.min(across);
    (width.is_finite() && width > 0.0).then(|| (width, face, inside(surface, middle.0, middle.1)))
}

/// Pastes onto one of the widest faces of a kind; false when the corpus is absent.
fn pasted(path: &str, kind: &str) -> bool {
    let Some(path) = corpus().map(|folder| folder.join(path)).filter(|p| p.is_file()) else { return false };
    let bytes = std::fs::read(&path).expect("a file");
    let mut said = String::new();
    let fixture = Fixture::new().sample("features/bump.step").file("part.stp", &bytes);
    let before = model(&fixture, "part.stp");
    for (width, face, at) in candidates(&before, kind) {
        let metres = before.context_of(face).length.metres;
        let scale = SHARE * width * metres / SHEET;
        let name = before.origins.faces[face];
        let text = job(
            "part.stp",
            "\"freecad\"",
            &[&format!(
                "source = {{ file = \"bump.step\" }}\nscale = {scale:?}\n\
                 target = {{ face = \"{name}\", at = [{:?}, {:?}, {:?}] }}",
                at.x, at.y, at.z
            )],
        )
        .replace("require = true", "require = false");
        let fixture =
            Fixture::new().sample("features/bump.step").file("part.stp", &bytes).file("job.toml", text);
        said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
        if said.starts_with("exit code: 0") {
            held(&fixture, &before, face);
            return true;
        }
        assert!(said.starts_with("exit code: 4"), "{}: {name}: {said}", path.display());
    }
    panic!("{}: no {kind} takes the feature; the last said: {said}", path.display());
}

/// Nothing but the face, and perhaps its seam, has changed, and FreeCAD finds the part valid.
pub fn held(fixture: &Fixture, before: &Model, face: FaceId) {
    let after = model(fixture, "out/part.stp");
    let points = |m: &Model| m.brep.vertices.iter().map(|(_, v)| v.point).collect::<Vec<_>>();
    assert!(points(before) == points(&after), "vertices");
    let uses = before.brep.faces_of_edges();
    for edge in before.brep.edges.ids() {
        let seam = uses[edge] == [face, face];
        let same = before.brep.curve_of(edge) == after.brep.curve_of(edge);
        assert!(same || seam, "edge {}", before.origins.edges[edge]);
    }
    for other in before.brep.faces.ids() {
        assert_eq!(before.origins.faces[other], after.origins.faces[other]);
        let same = before.brep.surface_of(other) == after.brep.surface_of(other);
        assert_eq!(same, other != face, "face {}", before.origins.faces[other]);
    }
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    for verdict in report["parts"][0]["validators"].as_array().into_iter().flatten() {
        assert_eq!(verdict["accepted"], true, "{verdict}");
        assert_eq!(verdict["figures"]["faces"], before.brep.faces.len(), "{verdict}");
    }
}

#[test]
fn a_cylinder_of_a_real_part_takes_a_feature() {
    pasted("step/io1-cm-214.stp", "cylinder");
}

#[test]
fn a_plane_of_a_real_part_takes_a_feature() {
    pasted("step/ANC101.stp", "plane");
}

#[test]
fn an_extrusion_of_a_real_part_takes_a_feature() {
    pasted("step/ANC101.stp", "linear_extrusion");
}

#[test]
fn a_torus_of_a_real_part_takes_a_feature() {
    pasted("step/io1-cm-214.stp", "torus");
}

#[test]
fn a_cone_of_a_real_part_takes_a_feature() {
    pasted("step/hole_model.stp", "cone");
}

#[test]
fn b_splines_of_real_parts_take_a_feature() {
    pasted("step/nacelle.stp", "b_spline");
    pasted("step/repatch-hpdc.stp", "b_spline");
}
