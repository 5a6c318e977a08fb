//! Areas of the faces on which Open CASCADE and we differ most, by a third way: `referee.py` reads the file itself and
//! measures polygons. It uses neither program, only numpy.

use std::path::Path;
use std::process::Command;

use resurf::brep::mass_properties::{Quadrature, of_face};
use resurf::math::Point3;
use resurf::model::Origin;
use serde_json::Value;

use super::measures::read;
use super::{python, root, support};

/// Points of each piece of an edge.
const POINTS: &str = "160";
/// Relative difference that the limit of the polygons leaves.
const AGREED: f64 = 1e-7;

/// File, its unit in millimetres, and face, its area by Open CASCADE (`BRepGProp` with an accuracy of 1e-9) in square
/// millimetres. One row for each file that the comparison excuses, where it is small enough.
const FACES: [(&str, f64, u64, f64); 15] = [
    ("13_5_hinge_R_assy.stp", 1.0, 7919, 11.578515),
    ("13_5_hinge_R_assy.stp", 1.0, 8394, 0.848536),
    ("Amazing Hand Parts - Proximal_Shell.step", 1e3, 414, 2195.85655),
    ("ExpansionCard_ThreadedInsert.stp", 1.0, 5941, 0.00670972),
    ("ExpansionCard_ThreadedInsert.stp", 1.0, 6551, 0.0869879),
    ("ExpansionCard_ThreadedInsert.stp", 1.0, 7024, 0.0127063),
    ("ExpansionCard_ThreadedInsert.stp", 1.0, 7245, 0.00671017),
    ("dm1-id-214.stp", 25.4, 914, 314.16019),
    ("issue153.stp", 1e3, 548, 7.099118),
    ("s1-c5-214/MAINBODY_BACK.stp", 25.4, 831, 1661.7593),
    ("s1-c5-214/MAINBODY_BACK.stp", 25.4, 1241, 3171.1124),
    ("s1-c5-214/MAINBODY_FRONT.stp", 25.4, 829, 276.28241),
    ("s1-c5-214/TAIL_TURBINE.stp", 25.4, 558, 1152.25220),
    ("s1-c5-214/TAIL_TURBINE.stp", 25.4, 617, 159.838536),
    ("s1-c5-214/TAIL_TURBINE.stp", 25.4, 658, 159.836577),
];

/// Whether the interpreter has numpy.
fn can(python: &Path) -> bool {
    let asked = Command::new(python).args(["-c", "import numpy"]).output();
    let can = asked.is_ok_and(|output| output.status.success());
    let required = std::env::var("RESURF_REQUIRE_OCC").is_ok_and(|value| value == "1");
    assert!(can || !required, "{} has no numpy", python.display());
    can
}

/// Areas of some faces, in the unit of their file, by polygons.
fn refereed(python: &Path, file: &Path, faces: impl Iterator<Item = u64>) -> Vec<f64> {
    let mut command = Command::new(python);
    command.arg(root().join("tests/external/referee.py")).args(["--points", POINTS]).arg(file);
    command.args(faces.map(|face| format!("#{face}")));
    let output = command.output().expect("the interpreter starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let said = String::from_utf8_lossy(&output.stderr);
    let area = |line: &str| {
        let found: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {said}"));
        found["area"].as_f64().unwrap_or_else(|| panic!("{}: {found}", file.display()))
    };
    text.lines().map(area).collect()
}

#[test]
fn polygons_of_the_edges_side_with_us() {
    let (Some(python), Some(corpus)) = (python(), support::corpus()) else { return };
    if !can(&python) {
        return;
    }
    for rows in FACES.chunk_by(|a, b| a.0 == b.0) {
        let path = corpus.join("step").join(rows[0].0);
        let model = read(&path);
        let referees = refereed(&python, &path, rows.iter().map(|row| row.2));
        assert_eq!(referees.len(), rows.len(), "{}", rows[0].0);
        for (&(file, millimetres, name, theirs), referee) in rows.iter().zip(referees) {
            let face = model.origins.faces.iter().find(|(_, origin)| **origin == Origin::Instance(name));
            let face = face.map(|(face, _)| face).expect("a face of that name");
            let body = model.body_of(face);
            let uncertainty = model.contexts[model.body_context[body]].uncertainty.map_or(0.0, |u| u.0);
            let quadrature = Quadrature::exact(uncertainty);
            let ours = of_face(&model.brep, face, &quadrature, Point3::origin()).expect("a face").area();
            let apart = (ours - referee).abs() / referee;
            assert!(apart < AGREED, "{file} #{name}: {ours}, and {referee} by polygons");
            let theirs = theirs / millimetres.powi(2);
            let further = (theirs - referee).abs() / referee;
            assert!(further > 3.0 * apart, "{file} #{name}: Open CASCADE is as near: {theirs}");
        }
    }
}
