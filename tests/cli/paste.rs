//! Feature paste as a job: results that other programs accept, and bad input that is told apart.
//!
//! The written file is read again: every vertex, every edge curve and every other surface is the same to the bit, and
//! the target surface keeps its domain and, off the feature, its place.

use resurf::brep::FaceId;
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::geometry::Surface;
use resurf::geometry::nurbs::NurbsSurface;
use resurf::model::Model;

use crate::Fixture;

pub fn model(fixture: &Fixture, name: &str) -> Model {
    let bytes = std::fs::read(fixture.path(name)).expect("a file");
    let mut diagnostics = Diagnostics::default();
    let document = Document::open(bytes, "step", &mut diagnostics).expect("a STEP file");
    document.model(&mut diagnostics)
}

pub fn job(part: &str, validators: &str, operations: &[&str]) -> String {
    let operations: Vec<String> =
        operations.iter().map(|o| format!("[[operation]]\nkind = \"feature_paste\"\n{o}\n")).collect();
    format!(
        "version = 1\ninputs = [\"{part}\"]\noutput = \"out/{{stem}}.{{ext}}\"\n\
         [validate]\nwith = [{validators}]\nrequire = true\n{}",
        operations.join("\n")
    )
}

pub fn spline(model: &Model, face: FaceId) -> Option<&NurbsSurface> {
    match model.brep.surface_of(face).read() {
        Some(Surface::Nurbs(surface)) => Some(surface),
        _ => None,
    }
}

/// Greatest distance of two surfaces over their domain, and on its border.
fn apart(a: &NurbsSurface, b: &NurbsSurface) -> (f64, f64) {
    let ((u0, u1), (v0, v1)) = a.domain();
    let (mut anywhere, mut border) = (0.0_f64, 0.0_f64);
    for i in 0..=80 {
        for j in 0..=80 {
            let (u, v) = (u0 + (u1 - u0) * f64::from(i) / 80.0, v0 + (v1 - v0) * f64::from(j) / 80.0);
            let off = (a.point(u, v) - b.point(u, v)).norm();
            anywhere = anywhere.max(off);
            if i % 80 == 0 || j % 80 == 0 {
                border = border.max(off);
            }
        }
    }
    (anywhere, border)
}

/// Runs a job and compares the part before and after; `height` is that of the feature.
fn accepted(fixture: &Fixture, part: &str, target: &str, height: f64) {
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    if said.starts_with("exit code: 5") && std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_none() {
        return;
    }
    assert!(said.starts_with("exit code: 0"), "{said}");
    let (before, after) = (model(fixture, part), model(fixture, &format!("out/{part}")));
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    for verdict in report["parts"][0]["validators"].as_array().expect("a list") {
        assert_eq!(verdict["accepted"], true, "{verdict}");
        assert_eq!(verdict["figures"]["faces"], before.brep.faces.len(), "{verdict}");
    }
    let points = |m: &Model| m.brep.vertices.iter().map(|(_, v)| v.point).collect::<Vec<_>>();
    assert!(points(&before) == points(&after), "vertices");
    let curves =
        |m: &Model| m.brep.edges.iter().map(|(id, _)| m.brep.curve_of(id).clone()).collect::<Vec<_>>();
    assert!(curves(&before) == curves(&after), "curves of edges");
    let pcurves = |m: &Model| m.brep.coedges.iter().map(|(_, c)| c.pcurve.clone()).collect::<Vec<_>>();
    assert!(pcurves(&before) == pcurves(&after), "curves in parameters");
    for face in before.brep.faces.ids() {
        assert_eq!(before.origins.faces[face], after.origins.faces[face]);
        if before.faces[face].name != target {
            assert!(before.brep.surface_of(face) == after.brep.surface_of(face), "another face changed");
            continue;
        }
        let new = spline(&after, face).expect("the target is a B-spline");
        let Some(old) = spline(&before, face) else { continue };
        assert_eq!(old.domain(), new.domain());
        let (anywhere, border) = apart(old, new);
        assert!((anywhere - height).abs() < 0.15 * height, "the feature is {anywhere} high");
        assert!(border < 1e-9, "the border moved by {border}");
    }
}

pub fn with_features(part: &str) -> Fixture {
    Fixture::new()
        .sample(part)
        .sample("features/bump.step")
        .sample("features/groove.step")
        .sample("features/symbol.step")
}

#[test]
fn letters_and_a_turned_groove_on_the_plane_top_of_a_solid() {
    let text = job(
        "plate.step",
        "\"freecad\"",
        &[
            "source = { file = \"symbol.step\" }\ntarget = { face = { name = \"TOP\" }, at = [75, 80, 12] }",
            "source = { file = \"groove.step\" }\ntarget = { face = { name = \"TOP\" }, at = [195, 80, 12] }\nrotate = \"60 deg\"",
        ],
    );
    let fixture = with_features("plate/plate.step").file("job.toml", text);
    accepted(&fixture, "plate.step", "TOP", 3.2);
}

#[test]
fn a_row_of_grooves_by_the_biharmonic_method() {
    let text = job(
        "hood.step",
        "\"freecad\"",
        &["source = { file = \"groove.step\" }\nmethod = \"biharmonic\"\n\
         target = { at = [-200, 800, 100], pattern = { linear = { step = [200, 0, 0], count = 3 } } }"],
    );
    let fixture = with_features("hood/hood.step").file("job.toml", text);
    accepted(&fixture, "hood.step", "OUTER_SKIN", 3.2);
}

#[test]
fn a_ring_of_bumps_on_a_vase() {
    let text = job(
        "vase.step",
        "\"freecad\"",
        &[
            "source = { file = \"bump.step\" }\nscale = 0.9\ntarget = { at = [-77, 0, 60], pattern = { circular = \
         { point = [0, 0, 0], direction = [0, 0, 1], count = 3, angle = \"130 deg\" } } }",
        ],
    );
    let fixture = with_features("vase/vase.step").file("job.toml", text);
    accepted(&fixture, "vase.step", "WALL", 6.2);
}

#[test]
fn a_region_of_the_part_itself_by_a_contour_in_space() {
    let text = job(
        "bump.step",
        "\"freecad\"",
        &["source = { region = { contour = [[-24, -24, 9], [24, -24, 9], [24, 24, 9], [-24, 24, 9]] } }\n\
         target = { at = [0, 0, 6.2] }\nexisting = \"replace\""],
    );
    let fixture = with_features("features/bump.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml"]);
    if said.starts_with("exit code: 5") {
        return;
    }
    assert!(said.starts_with("exit code: 0"), "{said}");
}

/// Runs a job on the plate that must fail, and gives the code of the failure.
fn refused(operation: &str) -> String {
    let text = job("plate.step", "", &[operation]);
    let fixture = with_features("plate/plate.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(!fixture.left().iter().any(|name| name.starts_with("out")), "nothing is written");
    let code = said.lines().next().unwrap_or_default().to_owned();
    let word = said.rsplit_once('[').map(|(_, rest)| rest.trim_end().trim_end_matches(']').to_owned());
    format!("{} {}", code.trim_start_matches("exit code: "), word.unwrap_or_default())
}

#[test]
fn every_bad_input_has_its_own_error() {
    let at = "target = { face = { name = \"TOP\" }, at = [130, 80, 12] }";
    let source = "source = { file = \"bump.step\" }";
    let region = |r: &str| format!("source = {{ file = \"bump.step\", region = {{ {r} }} }}\n{at}");
    let cases = [
        (format!("source = {{}}\n{at}"), "4 select.several"),
        (
            format!("{source}\ntarget = {{ face = {{ name = \"TOP*\" }}, at = [130, 80, 90] }}"),
            "4 paste.place-off-face",
        ),
        (
            format!("{source}\ntarget = {{ face = {{ name = \"*T*\" }}, at = [130, 80, 12] }}"),
            "4 select.several",
        ),
        (format!("{source}\n{at}\nscale = 4"), "4 paste.outside-target"),
        (
            format!("{source}\ntarget = {{ face = {{ name = \"TOP\" }}, at = [36, 80, 12] }}"),
            "4 paste.target-loop-in-region",
        ),
        (
            region("polygon = [[0.2, 0.2], [0.8, 0.8], [0.8, 0.2], [0.2, 0.8]]"),
            "4 paste.contour-crosses-itself",
        ),
        (region("polygon = [[0.2, 0.2], [0.8, 0.2], [0.8, 1.8]]"), "4 paste.contour-outside-source"),
        (region("contour = [[0, 0, 0], [90, 0, 0], [90, 90, 0]]"), "4 paste.contour-projection-failed"),
        (
            region("contour = [[-90, -90, 0], [90, -90, 0], [90, 90, 0], [-90, 90, 0]]"),
            "4 paste.contour-larger-than-face",
        ),
        (region("contour = [[50, 50, 0], [90, 50, 0], [90, 90, 0]]"), "4 paste.contour-off-face"),
        (region("polygon = [[0, 0.2], [0.8, 0.2], [0.8, 0.8]]"), "4 paste.contour-touches-border"),
        (region("contour = [[-40, 0, 0], [10, -10, 0], [10, 10, 0]]"), "4 paste.contour-touches-border"),
        (
            format!("{source}\ntarget = {{ face = {{ name = \"TOP\" }}, at = [-30, 80, 12] }}"),
            "4 paste.place-off-face",
        ),
        (region("loop = 3"), "4 paste.no-such-loop"),
        (region("curve = \"#1\""), "4 paste.no-curve"),
        (
            format!(
                "{source}\ntarget = {{ face = {{ name = \"TOP\" }}, places = [{{ at = [100, 80, 12] }}, {{ at = [110, 80, 12] }}] }}"
            ),
            "4 paste.places-overlap",
        ),
    ];
    for (operation, expected) in cases {
        assert_eq!(refused(&operation), expected, "{operation}");
    }
    // These are wrong before any part is touched.
    let usage = [
        (format!("{source}\ntarget = {{}}"), "names no place"),
        (format!("{source}\n{at}\nscale = -1"), "are no factors"),
        (format!("{source}\n{at}\nmethod = \"poisson\"\nrotate = \"30 deg\""), "only `fit` turns"),
        (format!("source = {{ file = \"bumb.step\" }}\n{at}"), "the nearest name is `bump.step`"),
        (region("polygon = [[0.2, 0.2], [0.8, 0.8]]"), "2 points enclose nothing"),
        (region("loop = 1, polygon = [[0, 0], [1, 0], [1, 1]]"), "expected exactly one of the keys"),
        (format!("{source}\n{at}\nmargin = 0"), "is not a margin"),
    ];
    for (operation, expected) in usage {
        let text = job("plate.step", "", &[&operation]);
        let fixture = with_features("plate/plate.step").file("job.toml", text);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 2") && said.contains(expected), "{operation}\n{said}");
    }
}
