//! Jobs of `detail_transfer`: wires are replaced in place, and what cannot be done is refused.

use insta::assert_snapshot;
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;

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
