//! Parts that Open CASCADE makes and writes, in three forms each, measured, checked and meshed against formulas.

use std::path::Path;
use std::process::Command;

use resurf::brep::mass_properties::{Quadrature, of_body};
use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::job::own_check::{OwnFinding, own_findings};
use resurf::mesh::{Integrity, Tolerances, tessellate_bodies};
use serde_json::Value;

use super::{occ, root};

/// Relative difference of volume and area, and of the centroid against the root of the area.
const AGREED: f64 = 1e-8;
/// The same where an edge runs through a pole, with parameter curves that come within a ten-millionth of it only.
const AT_POLE: f64 = 2e-6;
/// The same where it is a spline, some millionths off the sphere.
const NEAR_POLE: f64 = 5e-5;
/// Chord of the meshes, in millimetres.
const CHORD: f64 = 0.05;

/// What differs from the formulas in one file.
fn wrong(file: &Path, exact: &Value) -> Vec<String> {
    let mut sink = Diagnostics::default();
    let bytes = std::fs::read(file).expect("a file that was just written");
    let document = Document::open(bytes, "step", &mut sink).expect("it is read");
    let model = document.model(&mut sink);
    assert_eq!((sink.kept().len(), model.brep.bodies.len()), (0, 1), "{}", file.display());
    let body = model.brep.bodies.ids().next().expect("one body");
    let context = &model.contexts[model.body_context[body]];
    let mm = context.length.metres * 1e3;
    let tolerance = context.uncertainty.map_or(1e-6, |tolerance| tolerance.0);
    let found = of_body(&model.brep, body, &Quadrature::exact(tolerance)).expect("it has a volume");
    let number = |value: &Value| value.as_f64().expect("a number");
    let (volume, area) = (number(&exact["volume"]), number(&exact["area"]));
    let mut off = vec![found.volume() * mm.powi(3) / volume - 1.0, found.area() * mm.powi(2) / area - 1.0];
    if let Some(centroid) = exact["centroid"].as_array() {
        let found = found.centroid().coords * mm;
        off.extend(found.iter().zip(centroid).map(|(own, other)| (own - number(other)) / area.sqrt()));
    }
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let agreed = match name.split('-').next() {
        Some("through_pole") => AT_POLE,
        Some("through_pole_nurbs") => NEAR_POLE,
        _ => AGREED,
    };
    let mut wrong: Vec<String> =
        off.iter().filter(|off| off.abs() > agreed).map(|off| format!("off by {off:e}")).collect();
    let errors = own_findings(&document, &model, 1.0).into_iter().filter(OwnFinding::is_error);
    wrong.extend(errors.map(|finding| finding.code));
    match tessellate_bodies(&model.brep, &[body], &Tolerances { chord: CHORD / mm, angle: 0.3 }) {
        Ok(mesh) => {
            let integrity = Integrity::of(&mesh);
            let away = (mesh.signed_volume() * mm.powi(3) - volume).abs();
            if !integrity.is_closed() || away > CHORD * area {
                wrong.push(format!("mesh {integrity:?}, volume off by {away}"));
            }
        }
        Err(error) => wrong.push(error.to_string()),
    }
    wrong
}

#[test]
fn parts_made_by_open_cascade_measure_what_formulas_say() {
    let script = "made_parts.py";
    let Some(python) = occ::open_cascade(script) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = root().join("tests/external").join(script);
    let output =
        Command::new(python).arg(script).arg(folder.path()).output().expect("the interpreter starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    let (mut count, mut all) = (0, Vec::new());
    for line in lines.lines() {
        let exact: Value = serde_json::from_str(line).expect("JSON");
        let file = Path::new(exact["file"].as_str().expect("a path"));
        all.extend(wrong(file, &exact).iter().map(|wrong| format!("{}: {wrong}", file.display())));
        count += 1;
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
    assert!(count == 42, "{count}");
}
