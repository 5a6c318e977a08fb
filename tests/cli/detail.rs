//! Jobs of `detail_transfer`: wires are replaced in place, and what cannot be done is refused.

use insta::assert_snapshot;
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::math::Point3;
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
}
