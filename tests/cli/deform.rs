//! Jobs of `deform`: lines are met, everything that holds the face stays, and what cannot be done is refused.

use resurf::brep::FaceId;
use resurf::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use resurf::geometry::{Carried, Surface};
use resurf::math::Point3;
use resurf::model::Model;
use serde_json::Value;

use crate::Fixture;
use crate::paste::model;
use crate::paste_golden::nothing_else_changed;
use crate::support::corpus;

fn job(part: &str, operation: &str) -> String {
    format!(
        "version = 1\ninputs = [\"{part}\"]\noutput = \"out/{{stem}}.{{ext}}\"\n\n\
         [validate]\nwith = [\"freecad\"]\n\n[[operation]]\nkind = \"deform\"\n{operation}\n"
    )
}

fn door(operation: &str) -> Fixture {
    let part = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/door/door.step");
    let fixture = Fixture::new().file("part.stp", std::fs::read(part).expect("a sample"));
    fixture.sample("crease/lines.step").file("job.toml", job("part.stp", operation))
}

/// Nothing but the face has changed, and FreeCAD finds the part valid.
fn held(fixture: &Fixture, before: &Model, face: FaceId) {
    nothing_else_changed(before, &model(fixture, "out/part.stp"), face);
    let report = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    for verdict in report["parts"][0]["validators"].as_array().into_iter().flatten() {
        assert_eq!(verdict["accepted"], true, "{verdict}");
        assert_eq!(verdict["figures"]["faces"], before.brep.faces.len(), "{verdict}");
    }
}

fn face_named(model: &Model, name: &str) -> FaceId {
    model.faces.iter().find(|(_, face)| face.name == name).map(|(face, _)| face).expect("the face")
}

fn spline(model: &Model, face: FaceId) -> &NurbsSurface {
    match model.brep.surface_of(face) {
        Carried::Read(Surface::Nurbs(surface)) => surface,
        other => panic!("{other:?}"),
    }
}

/// The door's skin before and after, and the measures of the report.
fn deformed(operation: &str) -> (NurbsSurface, NurbsSurface, Value) {
    let fixture = door(operation);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let (before, after) = (model(&fixture, "part.stp"), model(&fixture, "out/part.stp"));
    held(&fixture, &before, face_named(&before, "OUTER_SKIN"));
    let report: Value =
        serde_json::from_str(&std::fs::read_to_string(fixture.path("report.json")).expect("a report"))
            .expect("JSON");
    let skin = |model: &Model| spline(model, face_named(model, "OUTER_SKIN")).clone();
    (skin(&before), skin(&after), report["parts"][0]["operations"][0]["measures"].clone())
}

/// The border and its tangent planes are where they were.
fn assert_border(old: &NurbsSurface, new: &NurbsSurface) {
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        for (u, v) in [(t, 0.0), (t, 1.0), (0.0, t), (1.0, t)] {
            assert!((old.point(u, v) - new.point(u, v)).norm() < 1e-9);
            let [was, is] = [old, new].map(|surface| surface.normal(u, v).expect("a regular face"));
            let angle = was.angle(&is);
            assert!(angle < 1e-7, "the border turns by {angle} at ({u}, {v})");
        }
    }
}

#[test]
fn a_face_goes_through_points_exactly_and_what_holds_it_stays() {
    let points = [[300.0, 330.0, 88.0], [500.0, 340.0, 97.0], [640.0, 320.0, 92.0]];
    let (old, new, measures) = deformed(&format!(
        "face = {{ name = \"OUTER_SKIN\" }}\nform = \"exact\"\nlines = [{{ points = {points:?} }}]"
    ));
    let locator = SurfaceLocator::new(&new, Wrap::default());
    for point in points {
        assert!(locator.closest(&Point3::from(point)).distance < 1e-6);
    }
    assert_border(&old, &new);
    let moved = measures["moved"].as_f64().unwrap();
    assert!(moved > 1.0 && moved < 60.0, "{measures}");
    assert_eq!(measures["constraints"], 3);
    assert_eq!(measures["redundant"], 0);
}

#[test]
fn a_face_follows_the_curves_of_another_file_within_the_tolerance() {
    let lines = "lines = [{ file = \"lines.step\", curve = { name = \"CREST\" } }, \
                 { file = \"lines.step\", curve = { name = \"BELOW\" } }, \
                 { file = \"lines.step\", curve = { name = \"ABOVE\" } }]";
    for form in
        ["tolerance = \"0.02 mm\"", "tolerance = \"0.02 mm\"\nform = \"exact\"\nminimise = \"displacement\""]
    {
        let (old, new, measures) = deformed(&format!("{lines}\n{form}"));
        let fixture = Fixture::new().sample("crease/lines.step");
        let wires = model(&fixture, "lines.step");
        let locator = SurfaceLocator::new(&new, Wrap::default());
        for &curve in &wires.free_curves {
            let curve = wires.brep.curves[curve].read().unwrap();
            let (start, end) = curve.domain();
            for k in 0..=300 {
                let at = curve.point_at(start + (end - start) * f64::from(k) / 300.0);
                let off = locator.closest(&at).distance;
                assert!(off < 0.021, "{form}: {off} from a line at {at}");
            }
        }
        assert_border(&old, &new);
        assert!(measures["pull"].as_f64().unwrap() > 6.0, "{measures}");
        assert!(measures["deviation"][1].as_f64().unwrap() <= 0.02, "{measures}");
    }
}

#[test]
fn a_line_on_the_face_goes_where_it_is_told() {
    let from = [[430.0, 330.0, 90.0], [560.0, 330.0, 93.0]];
    // The start must lie on the face: its heights are those of the door there.
    let start = door("lines = [{ points = [[0, 0, 0]] }]");
    let before = model(&start, "part.stp");
    let skin = spline(&before, face_named(&before, "OUTER_SKIN")).clone();
    let locator = SurfaceLocator::new(&skin, Wrap::default());
    let feet = from.map(|p| locator.closest(&Point3::from(p)));
    let on: Vec<[f64; 3]> = feet.iter().map(|foot| foot.point.coords.into()).collect();
    let moves = [[6.0, 4.0, 3.0], [5.0, -3.0, -2.0]];
    let to = [0, 1].map(|k| [0, 1, 2].map(|c| on[k][c] + moves[k][c]));
    let (_, new, _) =
        deformed(&format!("form = \"exact\"\nlines = [{{ points = {to:?}, from = {{ points = {on:?} }} }}]"));
    for (foot, to) in feet.iter().zip(to) {
        assert!((new.point(foot.u, foot.v) - Point3::from(to)).norm() < 1e-6);
    }
}

#[test]
fn normals_along_a_line_are_kept_or_given() {
    let points = [[470.0, 330.0, 99.0], [520.0, 330.0, 99.0]];
    for (word, normal) in [("\"keep\"", None), ("[0.2, 0.1, 1.0]", Some([0.2, 0.1, 1.0]))] {
        let (old, new, _) =
            deformed(&format!("form = \"exact\"\nlines = [{{ points = {points:?}, normal = {word} }}]"));
        let locator = SurfaceLocator::new(&old, Wrap::default());
        for point in points {
            let foot = locator.closest(&Point3::from(point));
            let wanted = normal.map_or_else(
                || old.normal(foot.u, foot.v).unwrap(),
                |n| resurf::math::Vector3::from(n).normalize(),
            );
            let angle = new.normal(foot.u, foot.v).unwrap().angle(&wanted).to_degrees();
            assert!(angle < 1e-3, "{word}: {angle} degrees");
        }
    }
}

#[test]
fn a_line_in_inches_means_the_same() {
    let plain = "lines = [{ file = \"lines.step\", curve = { name = \"CREST\" } }]";
    let (_, expected, _) = deformed(plain);
    // The same file with its unit renamed to metres, and the numbers a thousandth.
    let lines = std::fs::read_to_string(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/crease/lines.step"),
    )
    .unwrap();
    let scaled: String = lines
        .split_inclusive(';')
        .map(|record| match record.find("CARTESIAN_POINT('',(") {
            Some(at) => {
                let (head, rest) = record.split_at(at + "CARTESIAN_POINT('',(".len());
                let (numbers, tail) = rest.split_once(')').unwrap();
                let numbers: Vec<String> = numbers
                    .split(',')
                    .map(|n| format!("{:?}", n.trim().parse::<f64>().unwrap() * 1e-3))
                    .collect();
                format!("{head}{}){tail}", numbers.join(","))
            }
            None => record.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"),
        })
        .collect();
    let fixture = door(plain).file("lines.step", scaled);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let after = model(&fixture, "out/part.stp");
    let found = spline(&after, face_named(&after, "OUTER_SKIN"));
    assert_eq!(found.shape(), expected.shape());
    for (a, b) in found.control_points().zip(expected.control_points()) {
        assert!((a - b).norm() < 1e-6);
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_nothing_is_written() {
    let point = |x: f64, y: f64, z: f64| format!("{{ points = [[{x:?}, {y:?}, {z:?}]] }}");
    let inside = point(500.0, 330.0, 90.0);
    let start = door("lines = [{ points = [[0, 0, 0]] }]");
    let before = model(&start, "part.stp");
    let skin = spline(&before, face_named(&before, "OUTER_SKIN"));
    let on = SurfaceLocator::new(skin, Wrap::default()).closest(&Point3::new(500.0, 330.0, 90.0)).point;
    let edge = skin.point(0.5, 0.0);
    let from = format!("from = {{ points = [[{:?}, {:?}, {:?}]] }}", on.x, on.y, on.z);
    let cases = [
        // The border is held.
        (
            format!(
                "lines = [{{ points = [[{:?}, {:?}, {:?}]], from = {{ points = [[{:?}, {:?}, {:?}]] }} }}]",
                edge.x,
                edge.y,
                edge.z + 5.0,
                edge.x,
                edge.y,
                edge.z
            ),
            4,
            "deform.pulls-held",
        ),
        (format!("lines = [{}]", point(500.0, 3000.0, 60.0)), 4, "deform."),
        // Inside a hole there is no face.
        (format!("lines = [{}]", point(500.0, 210.0, 60.0)), 4, "deform.line-off-face"),
        (
            "lines = [{ points = [[500, 330, 90]], from = { points = [[500, 330, 700]] } }]".to_owned(),
            4,
            "deform.line-off-face",
        ),
        // The same place cannot go to two heights.
        (
            format!(
                "form = \"exact\"\ntolerance = 0.001\nlines = [{{ points = [[500, 330, 95]], {from} }}, \
                 {{ points = [[500, 330, 105]], {from} }}]"
            ),
            4,
            "deform.constraint-conflict",
        ),
        (format!("lines = [{inside}]\nspans = [0, 8]"), 2, "`spans` is [0, 8]"),
        (format!("lines = [{inside}]\nstrength = -1.0"), 2, "`strength` is -1"),
        (format!("lines = [{inside}]\nform = \"exact\"\nstrength = 10.0"), 2, "`strength` needs"),
        (format!("lines = [{inside}]\nminimise = \"bending\""), 2, "force_variation"),
        (format!("lines = [{inside}]\nminimise = {{ force = -1.0 }}"), 2, "-1 is not a weight"),
        (format!("lines = [{inside}]\nminimise = {{ force = 0.0 }}"), 2, "needs a weight above 0"),
        (format!("lines = [{inside}]\ntolerance = 0.0"), 2, "0 is not a tolerance"),
        ("lines = []".to_owned(), 2, "`lines` needs a line"),
        ("lines = [{}]".to_owned(), 2, "expected `points`, `curve`, or `file`"),
        ("lines = [{ points = [[1, 2, 3]], curve = \"#1\" }]".to_owned(), 2, "neither `curve` nor `file`"),
        ("lines = [{ points = [[1, 2, 3]], normal = [0, 0, 0] }]".to_owned(), 2, "`normal` has no direction"),
        ("lines = [{ points = [[1, 2, 3]], weight = 0 }]".to_owned(), 2, "0 is not a weight"),
        ("lines = [{ file = \"none.step\" }]".to_owned(), 2, "none.step"),
        ("lines = [{ file = \"lines.step\", curve = { name = \"CRUST\" } }]".to_owned(), 4, "CREST"),
        ("lines = [{ file = \"lines.step\" }]".to_owned(), 4, "lines[0]"),
        ("lines = [{ curve = \"#999999\" }]".to_owned(), 4, "deform.no-line"),
    ];
    for (operation, code, wanted) in cases {
        let fixture = door(&operation);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(
            said.starts_with(&format!("exit code: {code}")) && said.contains(wanted),
            "{operation}\n{said}"
        );
        assert!(!fixture.path("out").exists(), "{operation}");
    }
}

/// A freeform panel of a real solid, in metres, pulled up at one place between its holes.
#[test]
fn a_freeform_face_of_a_real_part_is_deformed() {
    let Some(corpus) = corpus() else { return };
    let path = corpus.join("step/Amazing Hand Parts - R-Top_Shell.step");
    if !path.is_file() {
        return;
    }
    let bytes = std::fs::read(&path).unwrap();
    let fixture = Fixture::new().file("part.stp", &bytes);
    let before = model(&fixture, "part.stp");
    let splines = before.brep.faces.ids().filter(|&face| {
        matches!(before.brep.surface_of(face), Carried::Read(Surface::Nurbs(s)) if s.net().len() > 1000)
    });
    let face = splines.max_by_key(|&face| spline(&before, face).net().len()).expect("a freeform face");
    let surface = spline(&before, face);
    let ((u0, u1), (v0, v1)) = surface.domain();
    let metres = before.context_of(face).length.metres;
    let mut done = 0;
    for (a, b) in [(0.5, 0.5), (0.35, 0.6), (0.62, 0.4)] {
        let (u, v) = (u0 + a * (u1 - u0), v0 + b * (v1 - v0));
        let to = surface.point(u, v) + surface.normal(u, v).unwrap() * (0.4e-3 / metres);
        let operation = format!(
            "face = \"{}\"\nform = \"exact\"\nlines = [{{ points = [[{:?}, {:?}, {:?}]] }}]",
            before.origins.faces[face], to.x, to.y, to.z
        );
        let fixture = Fixture::new().file("part.stp", &bytes).file("job.toml", job("part.stp", &operation));
        let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
        if said.starts_with("exit code: 4") && said.contains("deform.line-off-face") {
            continue;
        }
        assert!(said.starts_with("exit code: 0"), "{said}");
        held(&fixture, &before, face);
        let after = model(&fixture, "out/part.stp");
        let found = SurfaceLocator::new(spline(&after, face), Wrap::default()).closest(&to);
        assert!(found.distance < 1e-9 / metres, "{}", found.distance);
        done += 1;
    }
    assert!(done > 0, "no place lies on the face");
}
