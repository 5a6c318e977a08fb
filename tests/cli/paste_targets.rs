//! Feature paste onto quadrics and surfaces of revolution, across seams, with holes, from a library, and simplified.
//!
//! The parts are turned solids from formulas, so that what lies off the feature is known: a cylinder of radius 95, a
//! cone from 95 to 75 over 120, a wheel with an axis of symmetry.

use resurf::brep::edge_range;
use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::Point3;
use resurf::model::Model;

use crate::Fixture;
use crate::paste::{job, model, spline, with_features};

const AXIS: &str = "point = [0, 0, 0], direction = [0, 0, 1]";

/// Runs a paste of the bump at half its size, at a point of the tread; gives both models and the report's measures.
fn pasted(part: &str, operation: &str) -> (Model, Model, serde_json::Value) {
    let validators = if std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_some() { "\"freecad\"" } else { "" };
    let text = job(part, validators, &[operation]);
    let fixture = with_features(&format!("wheel/{part}")).file("job.toml", text);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let part_report = &report["parts"][0];
    for verdict in part_report["validators"].as_array().into_iter().flatten() {
        assert_eq!(verdict["accepted"], true, "{verdict}");
        assert_eq!(verdict["figures"]["faces"], 4, "{verdict}");
    }
    let measures = part_report["operations"][0]["measures"].clone();
    (model(&fixture, part), model(&fixture, &format!("out/{part}")), measures)
}

/// The face of a name.
fn tread(model: &Model) -> resurf::brep::FaceId {
    model.faces.iter().find(|(_, a)| a.name == "TREAD").map(|(id, _)| id).expect("a tread")
}

/// Everything but the tread's surface is the same to the bit; edges too, but for a seam that moved.
fn only_the_tread_changed(before: &Model, after: &Model, seam_moved: bool) {
    let points = |m: &Model| m.brep.vertices.iter().map(|(_, v)| v.point).collect::<Vec<_>>();
    assert!(points(before) == points(after), "vertices");
    let uses = before.brep.faces_of_edges();
    for edge in before.brep.edges.ids() {
        let seam = uses[edge].len() == 2 && uses[edge][0] == uses[edge][1] && uses[edge][0] == tread(before);
        let same = before.brep.curve_of(edge) == after.brep.curve_of(edge);
        assert_eq!(same, !(seam && seam_moved), "edge {}", before.origins.edges[edge]);
    }
    for face in before.brep.faces.ids() {
        assert_eq!(before.origins.faces[face], after.origins.faces[face]);
        assert_eq!(before.brep.faces[face].loops, after.brep.faces[face].loops);
        if face != tread(before) {
            assert!(before.brep.surface_of(face) == after.brep.surface_of(face), "another face changed");
        }
    }
}

/// Greatest distance, at equal parameters of the edge, of the curves in parameters from the edges of the tread.
fn pcurves_off(model: &Model) -> (usize, f64) {
    let face = tread(model);
    let surface = spline(model, face).expect("a B-spline");
    let (mut count, mut worst) = (0, 0.0_f64);
    for coedge in model.brep.coedges_of(face) {
        let of = &model.brep.coedges[coedge];
        let Some(pcurve) = &of.pcurve else { continue };
        count += 1;
        let range = edge_range(&model.brep, of.edge).expect("a range");
        let curve = model.brep.curve_of(of.edge).read().expect("a curve");
        for k in 0..=200 {
            let t = range.start + (range.end - range.start) * f64::from(k) / 200.0;
            let p = pcurve.point_at(t);
            worst = worst.max((surface.point(p.x, p.y) - curve.point_wrapped(t)).norm());
        }
    }
    (count, worst)
}

/// Greatest and least signed distance of the surface from the old one, as `height` measures it, and how many of the
/// samples lie on it.
fn off_shape(surface: &NurbsSurface, height: impl Fn(&Point3<f64>) -> f64) -> (f64, usize) {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let (mut greatest, mut on) = (0.0_f64, 0);
    for i in 0..=200 {
        for j in 0..=60 {
            let (u, v) = (u0 + (u1 - u0) * f64::from(i) / 200.0, v0 + (v1 - v0) * f64::from(j) / 60.0);
            let off = height(&surface.point(u, v));
            greatest = greatest.max(off);
            on += usize::from(off.abs() < 1e-10);
        }
    }
    (greatest, on)
}

/// The surface meets itself along `u`, with one tangent plane on both sides.
fn closed_and_smooth(surface: &NurbsSurface) {
    let (rows, columns) = surface.shape();
    let net = surface.net();
    assert!(net[..columns] == net[(rows - 1) * columns..], "the seam's control points differ");
    let ((u0, u1), (v0, v1)) = surface.domain();
    for k in 0..=100 {
        let v = v0 + (v1 - v0) * f64::from(k) / 100.0;
        let (a, b) = (surface.normal(u0, v).expect("regular"), surface.normal(u1, v).expect("regular"));
        assert!(a.cross(&b).norm() < 1e-9, "a crease of {} at {v}", a.cross(&b).norm());
    }
}

const SOURCE: &str = "source = { file = \"bump.step\" }\nscale = 0.5\n";
/// The bump is 8.0 mm high above its sheet, less what its B-spline smooths away.
const HEIGHT: (f64, f64) = (3.3, 4.2);

fn cylinder_height(p: &Point3<f64>) -> f64 {
    p.x.hypot(p.y) - 95.0
}

fn cone_height(p: &Point3<f64>) -> f64 {
    let slope = 20.0 / 120.0_f64;
    (p.x.hypot(p.y) - (95.0 - slope * p.z)) / slope.hypot(1.0)
}

#[test]
fn a_cylinder_and_a_cone_take_a_bump_off_their_seam() {
    for (part, height) in
        [("cylinder.step", cylinder_height as fn(&Point3<f64>) -> f64), ("cone.step", cone_height)]
    {
        let target = "target = { face = { name = \"TREAD\" }, at = [-60, 60, 60] }";
        let (before, after, measures) = pasted(part, &format!("{SOURCE}{target}"));
        only_the_tread_changed(&before, &after, false);
        let surface = spline(&after, tread(&after)).expect("a B-spline");
        let (greatest, on) = off_shape(surface, height);
        assert!((HEIGHT.0..HEIGHT.1).contains(&greatest), "{part}: {greatest}");
        assert!(on > 201 * 61 * 8 / 10, "{part}: {on} samples are on the quadric");
        closed_and_smooth(surface);
        let (count, off) = pcurves_off(&after);
        assert!(count == 2 && off < 1e-6, "{part}: {count} curves in parameters, {off} off");
        assert_eq!(measures["seam_moved"], serde_json::json!([false, false]));
    }
}

#[test]
fn a_cylinder_takes_a_bump_across_its_seam() {
    for turn in ["", "rotate = \"40 deg\"\nmirror = \"u\"\ntolerance = 0.02\n"] {
        let operation =
            format!("{SOURCE}{turn}target = {{ face = {{ name = \"TREAD\" }}, at = [95, 0, 60] }}");
        let (before, after, measures) = pasted("cylinder.step", &operation);
        only_the_tread_changed(&before, &after, true);
        let surface = spline(&after, tread(&after)).expect("a B-spline");
        let (greatest, on) = off_shape(surface, cylinder_height);
        assert!((HEIGHT.0..HEIGHT.1).contains(&greatest), "{greatest}");
        assert!(on > 201 * 61 * 7 / 10, "{on} samples are on the cylinder");
        closed_and_smooth(surface);
        let (_, off) = pcurves_off(&after);
        assert!(off < 1e-6, "{off}");
        assert_eq!(measures["seam_moved"], serde_json::json!([true, false]));
    }
}

#[test]
fn the_place_on_a_cylinder_does_not_matter() {
    // The same feature turned by quarters with the cylinder, once across the seam: equal samples, equal heights.
    let heights: Vec<f64> = ["[95, 0, 60]", "[-95, 0, 60]", "[0, 95, 60]"]
        .iter()
        .map(|at| {
            let operation = format!("{SOURCE}target = {{ face = {{ name = \"TREAD\" }}, at = {at} }}");
            let (_, after, measures) = pasted("cylinder.step", &operation);
            let collar = measures["places"][0]["collar_curvature_ratio"].as_f64().expect("a curved target");
            assert!(collar <= 1.05, "{at}: {collar}");
            let surface = spline(&after, tread(&after)).expect("a B-spline");
            off_shape(surface, cylinder_height).0
        })
        .collect();
    let (low, high) = heights.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), h| (a.min(*h), b.max(*h)));
    assert!(high - low < 1e-9, "{heights:?}");
}

#[test]
fn a_wheel_takes_a_ring_of_bumps_one_of_them_on_its_seam() {
    let target = format!(
        "target = {{ face = {{ name = \"TREAD\" }}, at = [109, 0, 60], pattern = {{ circular = {{ {AXIS}, count = 5 }} }} }}"
    );
    let (before, after, measures) = pasted("wheel.step", &format!("{SOURCE}{target}"));
    only_the_tread_changed(&before, &after, true);
    assert_eq!(measures["places"].as_array().map(Vec::len), Some(5));
    assert_eq!(measures["converted"], "revolution");
    closed_and_smooth(spline(&after, tread(&after)).expect("a B-spline"));
    let (count, off) = pcurves_off(&after);
    assert!(count == 4 && off < 1e-6, "{count} curves in parameters, {off} off");
}

#[test]
fn bumps_that_overlap_across_the_seam_are_refused() {
    let text = job(
        "cylinder.step",
        "",
        &[&format!(
            "{SOURCE}target = {{ face = {{ name = \"TREAD\" }}, places = [{{ at = [94, 10, 60] }}, {{ at = [94, -10, 60] }}] }}"
        )],
    );
    let fixture = with_features("wheel/cylinder.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("paste.places-overlap"), "{said}");
}

#[test]
fn a_quadric_refuses_the_engines_that_smooth_it() {
    let operation = format!(
        "{SOURCE}method = \"poisson\"\ntarget = {{ face = {{ name = \"TREAD\" }}, at = [95, 0, 60] }}"
    );
    let fixture =
        with_features("wheel/cylinder.step").file("job.toml", job("cylinder.step", "", &[&operation]));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("paste.method-cannot"), "{said}");
    assert!(!fixture.left().iter().any(|name| name.starts_with("out")), "nothing is written");
}

/// The region round one hole of the door.
const HOLE: &str = "source = { file = \"door.step\", region = { polygon = [[0.05, 0.45], [0.45, 0.45], [0.45, 0.95], [0.05, 0.95]] } }\n\
     holes = \"carry\"\nscale = 0.5\n";

#[test]
fn a_hole_of_the_feature_becomes_one_of_the_sheet() {
    for turn in ["", "rotate = \"30 deg\"\nmirror = \"u\"\ntolerance = 0.05\n"] {
        let operation = format!("{HOLE}{turn}target = {{ at = [0, 800, 100] }}");
        let fixture = Fixture::new()
            .sample("door/door.step")
            .sample("hood/hood.step")
            .file("job.toml", job("hood.step", "", &[&operation]));
        // The own checks hold that the new loop closes, lies on the surface and runs the right way round.
        let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
        assert!(said.starts_with("exit code: 0"), "{said}");
        let (before, after) = (model(&fixture, "hood.step"), model(&fixture, "out/hood.step"));
        let face = before.brep.faces.ids().next().expect("a face");
        let (old, new) = (&before.brep.faces[face].loops, &after.brep.faces[face].loops);
        assert_eq!(old.len() + 1, new.len());
        let surface = spline(&after, face).expect("a B-spline");
        let added = *new.last().expect("a loop");
        for &coedge in &after.brep.loops[added].coedges {
            let of = &after.brep.coedges[coedge];
            let (curve, range) = (after.brep.curve_of(of.edge), edge_range(&after.brep, of.edge));
            let (curve, range) = (curve.read().expect("a curve"), range.expect("a range"));
            let pcurve = of.pcurve.as_ref().expect("a curve in parameters");
            for k in 0..=100 {
                let t = range.start + (range.end - range.start) * f64::from(k) / 100.0;
                let p = pcurve.point_at(t);
                assert!((surface.point(p.x, p.y) - curve.point_at(t)).norm() < 1e-4);
            }
        }
        // The hole itself is half as long in each direction as the door's, on a hood that bends little.
        let length = |m: &Model, edge| {
            let samples = resurf::brep::sample_edge(&m.brep, edge, &resurf::brep::EdgeSampling::default());
            let points: Vec<_> = samples.expect("points").into_iter().map(|s| s.point).collect();
            points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>()
        };
        let door = model(&fixture, "door.step");
        let source = door.brep.edges.ids().map(|e| length(&door, e)).collect::<Vec<_>>();
        let hole = length(&after, after.brep.coedges[after.brep.loops[added].coedges[0]].edge);
        assert!(source.iter().any(|l| (0.5 * l - hole).abs() < 0.03 * hole), "{hole} of {source:?}");
    }
}

#[test]
fn a_hole_that_would_open_a_solid_is_refused() {
    let operation = format!("{HOLE}target = {{ face = {{ name = \"OUTER_SKIN\" }}, at = [500, 500, 95] }}");
    let fixture = Fixture::new()
        .sample("door/door.step")
        .sample("door-solid/door-solid.step")
        .file("job.toml", job("door-solid.step", "", &[&operation]));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("paste.hole-opens-solid"), "{said}");
    assert!(!fixture.left().iter().any(|name| name.starts_with("out")), "nothing is written");
}

#[test]
fn a_feature_from_the_library_gives_the_bytes_of_one_from_its_part() {
    let target = "target = { face = { name = \"TOP\" }, at = [130, 80, 12] }";
    let run = |source: &str| {
        let text = job("plate.step", "", &[&format!("source = {{ {source} }}\n{target}")]);
        let fixture = with_features("plate/plate.step").file("job.toml", text);
        let said = fixture.run(&["feature", "export", "symbol.step", "-o", "rs.feature.json"]);
        assert!(said.starts_with("exit code: 0"), "{said}");
        // The part is gone when its feature comes from the library.
        if source.starts_with("feature") {
            std::fs::remove_file(fixture.path("symbol.step")).expect("a file");
        }
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 0"), "{said}");
        std::fs::read(fixture.path("out/plate.step")).expect("a result")
    };
    assert!(run("file = \"symbol.step\"") == run("feature = \"rs.feature.json\""));
}

#[test]
fn a_feature_file_that_is_none_is_refused() {
    let target = "target = { face = { name = \"TOP\" }, at = [130, 80, 12] }";
    for (text, expected) in
        [("{}", "missing field"), ("{\"format\":\"other\"}", "unknown variant"), ("not JSON", "expected")]
    {
        let operation = format!("source = {{ feature = \"x.json\" }}\n{target}");
        let fixture = with_features("plate/plate.step")
            .file("x.json", text)
            .file("job.toml", job("plate.step", "", &[&operation]));
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 4") && said.contains("job.feature-file"), "{said}");
        assert!(said.contains(expected), "{said}");
    }
    let both = format!("source = {{ feature = \"x.json\", file = \"bump.step\" }}\n{target}");
    let fixture = with_features("plate/plate.step").file("job.toml", job("plate.step", "", &[&both]));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 2") && said.contains("no other key"), "{said}");
}

#[test]
fn simplify_takes_knots_back_within_its_certified_tolerance() {
    let paste = format!(
        "{SOURCE}rotate = \"25 deg\"\ntolerance = 0.02\ntarget = {{ face = {{ name = \"TREAD\" }}, at = [-95, 0, 60] }}"
    );
    let text = job("cylinder.step", "", &[&paste])
        + "[[operation]]\nkind = \"simplify\"\nface = { name = \"TREAD\" }\ntolerance = \"0.005 mm\"\n";
    let fixture = with_features("wheel/cylinder.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let measures = &report["parts"][0]["operations"][1]["measures"];
    let counts: Vec<u64> =
        measures["control_points"].as_array().expect("two").iter().filter_map(|c| c.as_u64()).collect();
    assert!(counts[1] < counts[0] * 9 / 10, "{counts:?}");
    let (bound, sampled) = (measures["deviation_bound"].as_f64(), measures["deviation_sampled"].as_f64());
    assert!(bound.expect("a bound") <= 0.005 && sampled.expect("a figure") <= bound.expect("a bound"));
    let after = model(&fixture, "out/cylinder.step");
    let surface = spline(&after, tread(&after)).expect("a B-spline");
    closed_and_smooth(surface);
    let ((u0, u1), (v0, v1)) = surface.domain();
    for k in 0..=100 {
        let u = u0 + (u1 - u0) * f64::from(k) / 100.0;
        for v in [v0, v1] {
            assert!(cylinder_height(&surface.point(u, v)).abs() < 1e-10, "the border moved");
        }
    }
}

#[test]
fn simplify_refuses_what_has_no_knots() {
    let text = "version = 1\ninputs = [\"cylinder.step\"]\noutput = \"out/{stem}.{ext}\"\n\
         [[operation]]\nkind = \"simplify\"\nface = { name = \"TREAD\" }\ntolerance = 0.1\n";
    let fixture = with_features("wheel/cylinder.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("simplify.surface-kind"), "{said}");
    let fixture = with_features("wheel/cylinder.step").file("job.toml", text.replace("0.1", "-1"));
    assert!(fixture.run(&["run", "job.toml"]).starts_with("exit code: 2"));
}
