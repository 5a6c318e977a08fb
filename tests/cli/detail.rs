//! Jobs of `detail_transfer`: wires are replaced in place, and what cannot be done is refused.

use insta::assert_snapshot;
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::geometry::Surface;
use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::{Point3, Vector3};
use serde_json::json;

use super::Fixture;

fn job(input: &str, operation: &str) -> String {
    format!(
        "version = 1\ninputs = [\"{input}\"]\noutput = \"out/{{stem}}.{{ext}}\"\n\n\
         [[operation]]\nkind = \"detail_transfer\"\n{operation}\n"
    )
}

fn wires(operation: &str) -> Fixture {
    let fixture = Fixture::new().sample("curves/arch.step").sample("curves/sources.step");
    fixture.file("job.toml", job("arch.step", operation))
}

const SOURCE: &str = "source = { file = \"sources.step\", curve = { name = \"SOURCE_4\" } }\n";

/// Start, middle and end of the only free curve.
fn points(fixture: &Fixture, name: &str) -> [[f64; 3]; 3] {
    let bytes = std::fs::read(fixture.path(name)).expect("a file");
    let mut diagnostics = Diagnostics::default();
    let model = Document::open(bytes, "step", &mut diagnostics).expect("STEP").model(&mut diagnostics);
    let [curve] = model.free_curves[..] else { panic!("one curve") };
    assert_eq!(model.free_curve_names, ["TARGET"]);
    let curve = model.brep.curves[curve].read().expect("a curve");
    let (start, end) = curve.domain();
    [0.0, 0.5, 1.0].map(|part| curve.point_at(start + (end - start) * part).coords.into())
}

#[test]
fn a_wire_is_replaced_in_place_and_its_ends_stay() {
    let fixture = wires(SOURCE);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let ([a, middle, b], [c, other, d]) = (points(&fixture, "arch.step"), points(&fixture, "out/arch.step"));
    assert_eq!((a, b), (c, d));
    let moved: f64 = middle.iter().zip(other).map(|(x, y)| (x - y).powi(2)).sum();
    assert!(moved.sqrt() > 0.1, "the middle moved by {moved}");
}

/// The only free curve, at equal parts of its parameter.
fn sampled(fixture: &Fixture, name: &str) -> Vec<Point3<f64>> {
    let bytes = std::fs::read(fixture.path(name)).expect("a file");
    let mut diagnostics = Diagnostics::default();
    let model = Document::open(bytes, "step", &mut diagnostics).expect("STEP").model(&mut diagnostics);
    let curve = model.brep.curves[model.free_curves[0]].read().expect("a curve");
    let exact = curve.to_nurbs(curve.domain()).expect("a curve with an exact form");
    let (start, end) = exact.domain();
    (0..=200).map(|i| exact.point_at(start + (end - start) * f64::from(i) / 200.0)).collect()
}

#[test]
fn a_circle_gets_the_same_detail_as_a_spline() {
    let words = format!("{SOURCE}frame = \"global\"\nends = \"tangent\"\n");
    let fixture = wires(&words);
    let text = std::fs::read_to_string(fixture.path("arch.step")).expect("a sample");
    let (before, rest) = text.split_once("#20=").expect("the curve");
    let (_, rest) = rest.split_once(';').expect("its end");
    let round = format!("{before}#20=CIRCLE('',#32,40.);{rest}");
    let fixture = fixture.file("round.step", round).file("round.toml", job("round.step", &words));
    for name in ["job.toml", "round.toml"] {
        let said = fixture.run(&["run", name, "--report", &format!("{name}.json")]);
        assert!(said.starts_with("exit code: 0"), "{said}");
    }
    let report = std::fs::read_to_string(fixture.path("round.toml.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    let measures = &report["parts"][0]["operations"][0]["measures"];
    assert_eq!((&measures["degree"], &measures["target_deviation"]), (&json!([2, 5]), &json!(0.0)));
    // In world directions detail does not depend on the target: it is what the arch got.
    let added = |name: &str| -> Vec<_> {
        let pairs = sampled(&fixture, &format!("out/{name}")).into_iter().zip(sampled(&fixture, name));
        pairs.map(|(after, before)| after - before).collect()
    };
    for (round, arch) in added("round.step").into_iter().zip(added("arch.step")) {
        assert!((round - arch).norm() <= 1e-11 * 80.0, "{round} against {arch}");
    }
}

#[test]
fn no_gain_gives_the_same_bytes() {
    let fixture = wires(&format!("{SOURCE}gain = 0\n"));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let read = |name| std::fs::read(fixture.path(name)).expect("a file");
    assert_eq!(read("arch.step"), read("out/arch.step"));
}

#[test]
fn a_curve_that_is_an_edge_of_faces_is_refused() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/door/door.step"));
    let text = text.expect("a sample");
    let edge =
        text.lines().find(|line| line.contains("=EDGE_CURVE(")).and_then(|line| line.split('=').next());
    let target = format!("{SOURCE}target = {{ curve = \"{}\" }}", edge.expect("an edge"));
    let fixture = Fixture::new().sample("door/door.step").sample("curves/sources.step");
    assert_snapshot!(fixture.file("job.toml", job("door.step", &target)).run(&["run", "job.toml"]));
}

#[test]
fn a_curve_that_is_not_there_is_refused_with_the_candidates() {
    assert_snapshot!(wires("source = { file = \"sources.step\" }").run(&["run", "job.toml"]));
    assert_snapshot!(wires(&format!("{SOURCE}target = {{ curve = \"#999\" }}")).run(&["run", "job.toml"]));
    assert_snapshot!(wires("source = { file = \"source.step\" }").run(&["run", "job.toml"]));
}

#[test]
fn impossible_words_are_placed() {
    assert_snapshot!(wires(&format!("{SOURCE}levels = [1, 0]")).run(&["run", "job.toml"]));
    assert_snapshot!(wires(&format!("{SOURCE}interval = [0.8, 0.2]")).run(&["run", "job.toml"]));
    assert_snapshot!(wires(&format!("{SOURCE}levels = [9]")).run(&["run", "job.toml"]));
    assert_snapshot!(wires(&format!("{SOURCE}gain = 1e300")).run(&["run", "job.toml"]));
    assert_snapshot!(wires(&format!("{SOURCE}scale = -1e9")).run(&["run", "job.toml"]));
}

/// The B-spline surface of the named face.
fn surface(fixture: &Fixture, file: &str, name: &str) -> NurbsSurface {
    match read_surface(fixture, file, name) {
        Surface::Nurbs(surface) => surface,
        other => panic!("{other:?} is no B-spline surface"),
    }
}

/// The surface of the named face.
fn read_surface(fixture: &Fixture, file: &str, name: &str) -> Surface {
    let bytes = std::fs::read(fixture.path(file)).expect("a file");
    let mut diagnostics = Diagnostics::default();
    let model = Document::open(bytes, "step", &mut diagnostics).expect("STEP").model(&mut diagnostics);
    let face = model.brep.faces.ids().find(|&face| model.faces[face].name == name).expect("the face");
    model.brep.surface_of(face).read().expect("a surface").clone()
}

fn over(file: &str, words: &str) -> Fixture {
    let fixture = Fixture::new().sample(file).sample("curves/arch.step").sample("curves/sources.step");
    let name = file.rsplit('/').next().expect("a name");
    fixture.file("job.toml", job(name, words))
}

#[test]
fn a_face_gets_the_detail_along_and_keeps_its_borders() {
    let words = format!("{SOURCE}frame = \"global\"\nends = \"tangent\"\n");
    let target = "target = { face = { name = \"WALL\" }, direction = \"u\" }\n";
    let fixture =
        over("vase/vase.step", &format!("{words}{target}")).file("arch.toml", job("arch.step", &words));
    for name in ["job.toml", "arch.toml"] {
        let said = fixture.run(&["run", name]);
        assert!(said.starts_with("exit code: 0"), "{said}");
    }
    let (before, after) =
        (surface(&fixture, "vase.step", "WALL"), surface(&fixture, "out/vase.step", "WALL"));
    // In world directions detail does not depend on the target: it is what the arch got.
    let (arch, changed) = (sampled(&fixture, "arch.step"), sampled(&fixture, "out/arch.step"));
    let size = before.bounding_box().diagonal();
    for (i, (arch, changed)) in arch.iter().zip(&changed).enumerate() {
        let u = i as f64 / 200.0;
        let added = after.point(u, 0.5) - before.point(u, 0.5);
        assert!((added - (changed - arch)).norm() <= 1e-11 * size, "along at {u}");
    }
    for k in 0..=100 {
        let t = f64::from(k) / 100.0;
        for (u, v) in [(0.0, t), (1.0, t), (t, 0.0), (t, 1.0)] {
            let (a, b) = (before.derivatives(u, v), after.derivatives(u, v));
            assert!((a.point - b.point).norm() <= 1e-12 * size, "border at ({u}, {v})");
            let (du, dv) = ((a.du - b.du).norm(), (a.dv - b.dv).norm());
            assert!(du.max(dv) <= 1e-9 * size, "tangents at ({u}, {v}): {du:e} {dv:e}");
        }
    }
}

#[test]
fn detail_over_a_face_leaves_its_holes_and_neighbours() {
    let words = format!(
        "{SOURCE}target = {{ face = {{ name = \"OUTER_SKIN\" }}, direction = \"v\" }}\ngain = 0.05\n"
    );
    let fixture = over("door-solid/door-solid.step", &words);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let after = surface(&fixture, "out/door-solid.step", "OUTER_SKIN");
    let before = surface(&fixture, "door-solid.step", "OUTER_SKIN");
    let moved = |u: f64, v: f64| (after.point(u, v) - before.point(u, v)).norm();
    let greatest = (0..=40).flat_map(|i| (0..=40).map(move |j| (i, j)));
    let greatest = greatest.map(|(i, j)| moved(f64::from(i) / 40.0, f64::from(j) / 40.0)).fold(0.0, f64::max);
    assert!(greatest > 0.5, "{greatest}");
    // Every edge is where it was, to the byte: only the face's surface changed.
    let records = |name: &str| -> Vec<String> {
        let text = std::fs::read_to_string(fixture.path(name)).expect("a file");
        let edges =
            text.split(';').filter(|record| record.contains("EDGE_CURVE(") || record.contains("PCURVE("));
        edges.map(str::to_owned).collect()
    };
    assert_eq!(records("door-solid.step"), records("out/door-solid.step"));
}

#[test]
fn a_band_of_a_face_is_changed_alone() {
    let target = "target = { face = { name = \"WALL\" }, direction = \"v\", across = [0.6, 0.9] }\n";
    let fixture = over("vase/vase.step", &format!("{SOURCE}{target}gain = 0.3\n"));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let (before, after) =
        (surface(&fixture, "vase.step", "WALL"), surface(&fixture, "out/vase.step", "WALL"));
    let moved = |u: f64, v: f64| (after.point(u, v) - before.point(u, v)).norm();
    let at = |part: [f64; 2], v: u32| {
        let along = (0..=20).map(move |i| part[0] + (part[1] - part[0]) * f64::from(i) / 20.0);
        along.map(|u| moved(u, f64::from(v) / 20.0)).fold(0.0, f64::max)
    };
    assert!((0..=20).all(|v| at([0.0, 0.55], v).max(at([0.95, 1.0], v)) <= 1e-10));
    assert!((0..=20).any(|v| at([0.7, 0.8], v) > 0.5));
}

/// What each point of a named face moved by along the middle of the band; the face before may be of any kind.
fn moved_along(fixture: &Fixture, [before, after]: [&str; 2], name: &str) -> Vec<Vector3<f64>> {
    let after = surface(fixture, after, name);
    let (u, v) = after.domain();
    let before = read_surface(fixture, before, name).to_nurbs(u, v).expect("an exact form");
    let middle = 0.5 * (v.0 + v.1);
    let at = (0..=200).map(|i| u.0 + (u.1 - u.0) * f64::from(i) / 200.0);
    at.map(|u| after.point(u, middle) - before.point(u, middle)).collect()
}

/// In world directions detail does not depend on the target: a surface of revolution gets what the arch gets, and so does
/// the rational B-spline that it has become, at a higher degree each time until there is none.
#[test]
fn faces_with_weights_get_the_same_detail_exactly() {
    let words = format!("{SOURCE}frame = \"global\"\nends = \"tangent\"\n");
    let target = "target = { face = { name = \"TREAD\" }, direction = \"u\" }\n";
    let again = job("out/wheel.step", &format!("{words}{target}")).replace("out/{stem}", "again/{stem}");
    let third = again.replace("\"out/wheel", "\"again/wheel").replace("again/{stem}", "third/{stem}");
    let fixture = over("wheel/wheel.step", &format!("{words}{target}"))
        .file("arch.toml", job("arch.step", &words))
        .file("again.toml", again)
        .file("third.toml", third);
    for name in ["job.toml", "arch.toml", "again.toml"] {
        let said = fixture.run(&["run", name]);
        assert!(said.starts_with("exit code: 0"), "{name}: {said}");
    }
    let (arch, changed) = (sampled(&fixture, "arch.step"), sampled(&fixture, "out/arch.step"));
    let wanted: Vec<_> = arch.iter().zip(&changed).map(|(a, b)| b - a).collect();
    assert!(wanted.iter().any(|d| d.norm() > 0.5));
    for files in [["wheel.step", "out/wheel.step"], ["out/wheel.step", "again/wheel.step"]] {
        for (moved, wanted) in moved_along(&fixture, files, "TREAD").iter().zip(&wanted) {
            assert!((moved - wanted).norm() <= 1e-10 * 220.0, "{files:?}: {moved} against {wanted}");
        }
    }
    let said = fixture.run(&["run", "third.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("its degree is too high"), "{said}");
}

/// Beside a plane, a cylinder's quarters meet without a crease, before and after.
#[test]
fn quarters_of_a_cylinder_stay_smooth() {
    let target = "target = { face = { name = \"BORE\" }, direction = \"v\" }\n";
    let fixture = over("wheel/wheel.step", &format!("{SOURCE}{target}gain = 0.2\n"));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let after = surface(&fixture, "out/wheel.step", "BORE");
    let ((first, last), v) = after.domain();
    let mut moved = 0.0_f64;
    for quarter in 1..4 {
        let u = first + (last - first) * f64::from(quarter) / 4.0;
        for k in 0..=40 {
            let v = v.0 + (v.1 - v.0) * f64::from(k) / 40.0;
            let step = 1e-9 * (last - first);
            let sides = [u - step, u + step].map(|u| after.normal(u, v).expect("a normal"));
            let angle = sides[0].cross(&sides[1]).norm();
            assert!(angle <= 1e-6, "a crease of {angle:e} at ({u}, {v})");
            moved = moved.max((after.point(u, v).coords.xy().norm() - 30.0).abs());
        }
    }
    assert!(moved > 0.1, "{moved}");
}

#[test]
fn faces_that_cannot_take_detail_are_refused() {
    let seats = "target = { face = { name = \"TREAD\" } }\nexisting = \"replace\"";
    let replaced = over("wheel/wheel.step", &format!("{SOURCE}{seats}"));
    assert_snapshot!(replaced.run(&["run", "job.toml"]));
    let free = format!("{SOURCE}target = {{ face = {{ name = \"WALL\" }} }}\nends = \"free\"");
    assert_snapshot!(over("vase/vase.step", &free).run(&["run", "job.toml"]));
    let both = format!("{SOURCE}target = {{ face = {{ name = \"WALL\" }}, curve = \"#1\" }}");
    assert_snapshot!(over("vase/vase.step", &both).run(&["run", "job.toml"]));
    let across = format!("{SOURCE}target = {{ across = [0.1, 0.2] }}");
    assert_snapshot!(over("vase/vase.step", &across).run(&["run", "job.toml"]));
}

/// The report of a job that others judge; `None` where they are missing and not required.
fn judged(fixture: &Fixture) -> Option<serde_json::Value> {
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    if said.starts_with("exit code: 5") && std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_none() {
        return None;
    }
    assert!(said.starts_with("exit code: 0"), "{said}");
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    Some(serde_json::from_str(&report).expect("JSON"))
}

#[test]
fn the_rim_of_the_sample_is_accepted() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/vase/rim.toml");
    let text = std::fs::read_to_string(folder).expect("a sample").replace("../curves/", "");
    let fixture =
        Fixture::new().sample("vase/vase.step").sample("curves/sources.step").file("job.toml", text);
    let Some(report) = judged(&fixture) else { return };
    let verdict = &report["parts"][0]["validators"][0];
    assert_eq!((&verdict["accepted"], &verdict["figures"]["faces"]), (&json!(true), &json!(1)));
}

#[test]
fn faces_of_real_solids_get_detail() {
    let Some(corpus) = super::support::corpus() else { return };
    let parts = [
        ("issue153.stp", "#540", "u"),
        ("s1-c5-214/MAINBODY_BACK.stp", "#783", "v"),
        ("Amazing Hand Parts - R-Top_Shell.step", "#1609", "u"),
        ("s1-c5-214/MAINBODY_FRONT.stp", "#757", "v"),
        // A cylinder along and across, one in centimetres, one in inches.
        ("io1-cm-214.stp", "#6510", "u"),
        ("io1-cm-214.stp", "#6510", "v"),
        ("boxed_sphere.step", "#119", "u"),
        ("featuretype.STEP", "#38", "v"),
    ];
    for (part, face, direction) in parts {
        let input = std::fs::read(corpus.join("step").join(part)).expect("a file of the corpus");
        let words = format!(
            "{SOURCE}target = {{ face = \"{face}\", direction = \"{direction}\" }}\ngain = 0.2\n\
             [validate]\nwith = [\"freecad\"]\nrequire = true\n"
        );
        let fixture = Fixture::new().sample("curves/sources.step").file("in.stp", input);
        let fixture = fixture.file("job.toml", job("in.stp", &words));
        let Some(report) = judged(&fixture) else { return };
        let part = &report["parts"][0];
        assert_eq!(part["operations"][0]["changed"]["surfaces"], 1, "{part}");
        let verdict = &part["validators"][0]["figures"];
        assert_eq!(
            (&verdict["faces"], &verdict["solids"]),
            (&part["before"]["counts"]["faces"], &part["before"]["counts"]["solids"],)
        );
    }
}

const KEPT: &str = "source = { detail = \"ripples.detail.json\" }\n";

/// The wires, and the detail of a source in a file of its own.
fn kept() -> (Fixture, String) {
    let fixture = wires(SOURCE);
    let said = fixture.run(&[
        "feature",
        "detail",
        "sources.step",
        "--curve",
        "{ name = \"SOURCE_4\" }",
        "-o",
        "ripples.detail.json",
    ]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let text = std::fs::read_to_string(fixture.path("ripples.detail.json")).expect("a file");
    (fixture, text)
}

#[test]
fn detail_from_the_library_is_that_of_the_curve() {
    let (fixture, _) = kept();
    assert!(fixture.run(&["run", "job.toml"]).starts_with("exit code: 0"));
    let wanted = sampled(&fixture, "out/arch.step");
    let fixture = fixture.file("kept.toml", job("arch.step", KEPT));
    std::fs::remove_file(fixture.path("sources.step")).expect("the part is not needed any more");
    let said = fixture.run(&["run", "kept.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    for (kept, wanted) in sampled(&fixture, "out/arch.step").into_iter().zip(wanted) {
        assert!((kept - wanted).norm() <= 1e-12 * 120.0, "{kept} against {wanted}");
    }
}

#[test]
fn detail_of_a_library_that_does_not_hold_together_is_refused() {
    let (fixture, text) = kept();
    let fixture = fixture.file("kept.toml", job("arch.step", KEPT));
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut other = value.clone();
        change(&mut other);
        std::fs::write(fixture.path("ripples.detail.json"), other.to_string()).expect("written");
        let said = fixture.run(&["run", "kept.toml"]);
        assert!(!fixture.path("out/arch.step").exists());
        said
    };
    let all = [
        refused(&|file| file["version"] = json!(2)),
        refused(&|file| file["metres_per_unit"] = json!(-1)),
        refused(&|file| file["knots"][9] = json!(-7)),
        refused(&|file| drop(file["levels"].as_array_mut().expect("a list").pop())),
        refused(&|file| drop(file["levels"][0].as_array_mut().expect("a list").pop())),
        refused(&|file| file["levels"].as_array_mut().expect("a list").push(json!([]))),
        refused(&|file| file["format"] = json!("resurf-feature")),
    ];
    assert_snapshot!(all.join("\n"));
    std::fs::write(fixture.path("ripples.detail.json"), &text[..text.len() / 2]).expect("written");
    assert!(fixture.run(&["run", "kept.toml"]).contains("source.detail"));
}

#[test]
fn a_curve_without_detail_is_not_kept() {
    let fixture = wires(SOURCE);
    let text = std::fs::read_to_string(fixture.path("arch.step")).expect("a sample");
    let (before, rest) = text.split_once("#20=").expect("the curve");
    let (_, rest) = rest.split_once(';').expect("its end");
    let fixture = fixture.file("straight.step", format!("{before}#20=POLYLINE('',(#9,#19));{rest}"));
    let said = fixture.run(&["feature", "detail", "straight.step", "-o", "straight.detail.json"]);
    assert!(said.starts_with("exit code: 4\n") && said.contains("detail.no-levels"), "{said}");
    assert!(!fixture.path("straight.detail.json").exists());
}
