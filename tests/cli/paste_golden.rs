//! Golden jobs of feature paste on solids: what the written file says when it is read again, and what FreeCAD and Open
//! CASCADE say of it.
//!
//! Jobs on files of the corpus pass in silence where it is not there. The two programs are asked where they are
//! installed.

use resurf::brep::FaceId;
use resurf::geometry::Surface;
use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::model::{Model, Origin};
use serde_json::Value;

use crate::Fixture;
use crate::occ::occ_compared;
use crate::paste::{job, model, spline, with_features};
use crate::support::corpus;

/// A job on a solid: its part, the target face, and the rest of the operation.
struct Golden {
    part: &'static str,
    face: u64,
    words: &'static str,
}

const OF_SAMPLES: [Golden; 4] = [
    Golden {
        part: "plate/plate.step",
        face: 63,
        words: "source = { file = \"symbol.step\" }\nat = [75, 80, 12]",
    },
    Golden {
        part: "vamp/vamp.step",
        face: 1204,
        words: "source = { file = \"symbol.step\" }\nscale = [0.6, 0.6, 1.0]\nat = [170, 8, 75]",
    },
    Golden {
        part: "door-solid/door-solid.step",
        face: 1970,
        words: "source = { file = \"bump.step\" }\nrotate = \"30 deg\"\nmirror = \"v\"\ntolerance = \"0.05 mm\"\n\
                at = [500, 500, 95]",
    },
    Golden {
        part: "wheel/wheel.step",
        face: 82,
        words: "source = { file = \"groove.step\" }\nscale = 0.5\nat = [0, 109, 60]",
    },
];

const OF_CORPUS: [Golden; 8] = [
    // Metres; two halves of a palm, the first with a window.
    Golden {
        part: "step/Amazing Hand Parts - R-Palm_Shell.step",
        face: 2076,
        words: "source = { file = \"bump.step\" }\nscale = 0.5\nrotate = \"90 deg\"\n\
                at = [0.061775898, -0.0599267, -0.01820854]",
    },
    Golden {
        part: "step/Amazing Hand Parts - R-Top_Shell.step",
        face: 1604,
        words: "source = { file = \"bump.step\" }\nscale = 0.07\nmethod = \"biharmonic\"\n\
                at = [0.05678549, -0.04377863, 0.02593524]",
    },
    // A dome of 2332 control points.
    Golden {
        part: "step/Amazing Hand Parts - Distal_Shell.step",
        face: 538,
        words: "source = { file = \"groove.step\" }\nscale = 0.1\nat = [0.0038997, 0.06618969, -0.00725637]",
    },
    Golden {
        part: "step/Moving_Jaw_08d v1.step",
        face: 3258,
        words: "source = { file = \"bump.step\" }\nscale = 0.02\nmethod = \"poisson\"\nexisting = \"replace\"\n\
                at = [-1.4584978, -32.8538031, 9.4523131]",
    },
    // Centimetres.
    Golden {
        part: "step/boxed_sphere.step",
        face: 119,
        words: "source = { file = \"bump.step\" }\nscale = 0.0038\nat = [-0.4915061, -0.3475135, 0.3475135]",
    },
    Golden {
        part: "step/io1-cm-214.stp",
        face: 6510,
        words: "source = { file = \"bump.step\" }\nscale = 0.27\nmirror = \"v\"\nrotate = \"200 deg\"\n\
                at = [15.5, 6.8883018, 16.6298316]",
    },
    // Inches.
    Golden {
        part: "step/featuretype.STEP",
        face: 38,
        words: "source = { file = \"groove.step\" }\nscale = 0.06\nat = [-0.96732, 1.15468, 0.875]",
    },
    Golden {
        part: "step/lower_leg_structure_base.STEP",
        face: 9008,
        words: "source = { file = \"bump.step\" }\nscale = 0.016\nat = [12.9375, 3.4913397, -163.4913397]",
    },
];

/// The place is a key of the target.
fn operation(golden: &Golden) -> String {
    let (words, at) = golden.words.rsplit_once("at = ").expect("a place");
    format!("{words}target = {{ face = \"#{}\", at = {at} }}", golden.face)
}

fn fixture(golden: &Golden) -> Option<Fixture> {
    let sample = !golden.part.starts_with("step/");
    let fixture = with_features(if sample { golden.part } else { "features/bump.step" });
    if sample {
        let name = golden.part.rsplit('/').next().unwrap_or_default();
        std::fs::rename(fixture.path(name), fixture.path("part.step")).expect("a sample");
        return Some(fixture);
    }
    let file = corpus()?.join(golden.part);
    Some(fixture.file("part.step", std::fs::read(file).ok()?))
}

/// A job that was run and compared by ourselves.
struct Done<'a> {
    golden: &'a Golden,
    fixture: Fixture,
    faces: usize,
    /// Control points that the report says were changed.
    changed: u64,
}

fn run_all(jobs: &[Golden]) {
    let done: Vec<Done> = jobs.iter().filter_map(run).collect();
    let paths = |one: &Done| (one.fixture.path("part.step"), one.fixture.path("out/part.step"));
    let pairs: Vec<_> = done.iter().map(paths).collect();
    for (one, theirs) in done.iter().zip(occ_compared(&pairs)) {
        agrees(one, &theirs);
    }
}

fn run(golden: &Golden) -> Option<Done<'_>> {
    let fixture = fixture(golden)?;
    let text = job("part.step", "\"freecad\"", &[&operation(golden)]);
    let required = std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_some();
    let text = text.replace("require = true", &format!("require = {required}"));
    let fixture = fixture.file("job.toml", text);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{}: {said}", golden.part);
    let (before, after) = (model(&fixture, "part.step"), model(&fixture, "out/part.step"));
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    for verdict in report["parts"][0]["validators"].as_array().into_iter().flatten() {
        assert_eq!(verdict["accepted"], true, "{verdict}");
        assert_eq!(verdict["figures"]["faces"], before.brep.faces.len(), "{verdict}");
    }
    let find = |(_, origin): &(FaceId, &Origin)| **origin == Origin::Instance(golden.face);
    let target = before.origins.faces.iter().find(find).expect("the target").0;
    nothing_else_changed(&before, &after, target);
    let measures = &report["parts"][0]["operations"][0]["measures"];
    let changed = measures["places"][0]["changed"].as_u64().expect("a count");
    stays_outside(&before, &after, target, changed);
    Some(Done { golden, faces: before.brep.faces.len(), changed, fixture })
}

/// Vertices, edges, bounds and all other surfaces are the same to the bit, and keep their names.
pub fn nothing_else_changed(before: &Model, after: &Model, target: FaceId) {
    let points = |m: &Model| m.brep.vertices.iter().map(|(_, v)| v.point).collect::<Vec<_>>();
    assert!(points(before) == points(after), "vertices");
    for edge in before.brep.edges.ids() {
        assert!(before.brep.curve_of(edge) == after.brep.curve_of(edge), "{}", before.origins.edges[edge]);
    }
    for face in before.brep.faces.ids() {
        assert_eq!(before.origins.faces[face], after.origins.faces[face]);
        assert_eq!(before.brep.faces[face].loops, after.brep.faces[face].loops);
        let same = before.brep.surface_of(face) == after.brep.surface_of(face);
        assert_eq!(same, face != target, "{}", before.origins.faces[face]);
    }
}

/// Knots that the second has and the first lacks.
fn lacking(have: &KnotVector, wanted: &KnotVector) -> Vec<f64> {
    let (knots, counts) = wanted.distinct();
    let more = knots.into_iter().zip(counts);
    more.flat_map(|(k, count)| std::iter::repeat_n(k, count.saturating_sub(have.multiplicity(k)))).collect()
}

/// A surface over the degrees and knots of another.
fn brought_to(old: &NurbsSurface, new: &NurbsSurface) -> NurbsSurface {
    let old = old.clamped().elevated(new.knots_u().degree(), new.knots_v().degree()).expect("a degree");
    let (u, v) = (lacking(old.knots_u(), new.knots_u()), lacking(old.knots_v(), new.knots_v()));
    old.refined_u(&u).expect("knots").refined_v(&v).expect("knots")
}

/// Outside the feature the control points are those of the old surface over the new knots, to the bit; of a surface of
/// another kind, all points of the new one outside the feature are points of the old.
fn stays_outside(before: &Model, after: &Model, target: FaceId, changed: u64) {
    let new = spline(after, target).expect("a B-spline");
    if let Some(old) = spline(before, target) {
        let refined = brought_to(old, new);
        assert_eq!(refined.shape(), new.shape());
        let bits = |p: &[f64; 4]| p.map(f64::to_bits);
        let moved = refined.net().iter().zip(new.net()).filter(|(a, b)| bits(a) != bits(b)).count() as u64;
        assert!(moved > 0 && moved <= changed, "{moved} control points differ, {changed} were changed");
        return;
    }
    let old = before.brep.surface_of(target).read().expect("a surface");
    let ((u0, u1), (v0, v1)) = new.domain();
    let size = new.bounding_box().diagonal();
    let (mut on, mut off) = (0, 0);
    for i in 0..=60 {
        for j in 0..=60 {
            let (u, v) = (u0 + (u1 - u0) * f64::from(i) / 60.0, v0 + (v1 - v0) * f64::from(j) / 60.0);
            let point = new.point(u, v);
            let foot = old.parameters_of(&point, None);
            let away = (old.point(foot.0, foot.1) - point).norm();
            on += usize::from(away <= 1e-10 * size);
            off += usize::from(away > 1e-4 * size);
        }
    }
    assert!(off > 10 && on > 61 * 61 / 3, "{on} points on the old surface, {off} off it");
}

/// Open CASCADE finds the part as sound as before, with the same faces, one of them changed, and their bounds the same.
fn agrees(&Done { golden, faces, changed, .. }: &Done<'_>, theirs: &Value) {
    let pair = |name: &str| [theirs[name][0].as_bool(), theirs[name][1].as_bool()];
    assert_eq!(pair("valid"), [Some(true); 2], "{}: {theirs}", golden.part);
    assert_eq!(pair("closed"), [Some(true); 2], "{}: {theirs}", golden.part);
    for (name, counts) in theirs["counts"].as_object().expect("counts") {
        assert_eq!(counts[0], counts[1], "{}: {name}: {theirs}", golden.part);
    }
    assert_eq!(theirs["counts"]["faces"][0], faces);
    let changes = theirs["changed"].as_array().expect("a list");
    assert!(changes.len() == 1 && theirs["other_bounds"] == 0, "{}: {theirs}", golden.part);
    assert_eq!(changes[0]["kinds"][1], "BSplineSurface");
    if let Some(moved) = changes[0]["moved"].as_u64() {
        assert!(moved > 0 && moved <= changed, "{}: {theirs}", golden.part);
        let (border, highest) = (&changes[0]["border_moved"], &changes[0]["highest"]);
        let part = border.as_f64().expect("a number") / highest.as_f64().expect("a number");
        assert!(part < 1e-8, "{}: {theirs}", golden.part);
    }
}

#[test]
fn samples_take_features_and_nothing_else_changes() {
    run_all(&OF_SAMPLES);
}

#[test]
fn splines_of_real_parts_take_features() {
    run_all(&OF_CORPUS[..5]);
}

#[test]
fn quadrics_of_real_parts_take_features() {
    run_all(&OF_CORPUS[5..]);
}

/// The kinds are what the comments say, so that a change of the corpus is not taken for a pass.
#[test]
fn the_targets_are_of_the_kinds_that_they_stand_for() {
    for (at, golden) in OF_SAMPLES.iter().chain(&OF_CORPUS).enumerate() {
        let Some(fixture) = fixture(golden) else { continue };
        let model = model(&fixture, "part.step");
        let found = model.origins.faces.iter().find(|(_, o)| **o == Origin::Instance(golden.face));
        let surface = model.brep.surface_of(found.expect("the target").0).read().map(Surface::kind);
        let expected = [
            "plane",
            "b_spline",
            "b_spline",
            "revolution",
            "b_spline",
            "b_spline",
            "b_spline",
            "b_spline",
            "b_spline",
            "cylinder",
            "cylinder",
            "cone",
        ];
        assert_eq!(surface, Some(expected[at]), "{}", golden.part);
    }
}
