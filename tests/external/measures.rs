//! Counts, surfaces, volume, area and centroid of every STEP file of the corpus against Open CASCADE.
//!
//! Both measure each solid once, in millimetres. Within [`AGREED`] there is nothing to say; what differs by more
//! stands in [`DIFFERENCES`] with its explanation, and a row that is not needed any more fails as well.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use resurf::brep::BodyKind;
use resurf::brep::mass_properties::{Quadrature, of_body};
use resurf::diagnostic::Diagnostics;
use resurf::model::{Inventory, Model};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};
use serde_json::Value;

use super::{python, root, support};

/// Relative difference of volume and area, and of the centroid against the root of the area.
const AGREED: f64 = 1e-6;

/// Why the two differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Why {
    /// The file's edges lie off its surfaces by up to some micrometres or more: where a face ends is open to that
    /// extent. Open CASCADE widens the tolerance of these edges to the same gap.
    EdgesOffSurface,
    /// Open CASCADE's quadrature does not reach the accuracy it was asked for on faces that splines bound, also where
    /// edges lie on their surface to 1e-8. Its figure for a disc of radius 10 in `dm1-id-214.stp` is 314.16019, where
    /// π r² is 314.15927; for a plane of `s1-c5-214/MAINBODY_BACK.stp` 1661.7593, where polygons of 200, 2,000 and
    /// 20,000 points an edge give 1661.8272, 1661.8956 and 1661.8962, and we 1661.89625.
    TheirQuadrature,
    /// Open CASCADE takes three quarters of a sphere for the quarter that the bound runs round.
    TheirOtherSide,
    /// Not looked into yet.
    Open,
}

/// File, the greatest relative difference of its solids that is excused, and why.
const DIFFERENCES: [(&str, f64, Why); 13] = [
    ("13_5_hinge_R_assy.stp", 2e-5, Why::EdgesOffSurface),
    ("Amazing Hand Parts - Proximal_Shell.step", 2e-4, Why::EdgesOffSurface),
    ("ExpansionCard_ThreadedInsert.stp", 2e-6, Why::EdgesOffSurface),
    ("MX Series-Cherry Key.step", 2e-5, Why::Open),
    ("Moving_Jaw_08d v1.step", 4e-6, Why::Open),
    ("dm1-id-214.stp", 3e-6, Why::TheirQuadrature),
    ("flipping_joystick_assembly.stp", 6e-6, Why::EdgesOffSurface),
    ("issue153.stp", 2e-3, Why::EdgesOffSurface),
    ("lower_leg_structure_base.STEP", 4e-6, Why::Open),
    ("s1-c5-214/HEAD_BACK.stp", 1.0, Why::TheirOtherSide),
    ("s1-c5-214/MAINBODY_BACK.stp", 3e-4, Why::TheirQuadrature),
    ("s1-c5-214/MAINBODY_FRONT.stp", 2e-4, Why::TheirQuadrature),
    ("top_cover_r_full_framework_logo.stp", 2e-6, Why::Open),
];

/// Files whose great freeform faces take minutes in a build without optimisation, or which Open CASCADE does not
/// end with; `DME.stp` it refuses.
const LEFT_OUT: [&str; 13] = [
    "Amazing Hand Parts - Distal_Shell.step",
    "Amazing Hand Parts - R-Palm_Shell.step",
    "Amazing Hand Parts - R-Top_Shell.step",
    "Amazing Hand base.STEP",
    "DME.stp",
    "IEA_15MW_CFD.stp",
    "Wrist_Roll_Pitch_SO101.step",
    "boxed_sphere.step",
    "magnet_geom_with_casing.step",
    "nacelle.stp",
    "race_car_nose.stp",
    "repatch-hpdc.stp",
    "tail_section_asm.stp",
];

/// Edges are counted by use; Open CASCADE adds seams, and splits and joins edges while it heals. Where shells differ
/// the file says closed shells whose faces share no edge.
const COUNTS: [&str; 2] = ["solids", "faces"];

fn read(path: &Path) -> Model {
    let bytes = std::fs::read(path).expect("a file of the corpus");
    let mut sink = Diagnostics::default();
    let file = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
    to_model(&file, &mut sink)
}

/// Volume, area and centroid of each solid, in millimetres.
fn solids(model: &Model, file: &str) -> Vec<(f64, f64, [f64; 3])> {
    let solids = model.brep.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Solid);
    let measure = |(id, _)| {
        let context = &model.contexts[model.body_context[id]];
        let mm = context.length.metres * 1e3;
        let tolerance = context.uncertainty.map_or(1e-3 / mm, |tolerance| tolerance.0);
        let found = of_body(&model.brep, id, &Quadrature::exact(tolerance))
            .unwrap_or_else(|error| panic!("{file} {}: {error}", model.origins.bodies[id]));
        let centroid = found.centroid().coords * mm;
        (found.volume() * mm.powi(3), found.area() * mm * mm, centroid.into())
    };
    solids.map(measure).collect()
}

fn theirs(solid: &Value) -> (f64, f64, [f64; 3]) {
    let number = |value: &Value| value.as_f64().expect("a number");
    let centroid = [0, 1, 2].map(|k| number(&solid["centroid"][k]));
    (number(&solid["volume"]), number(&solid["area"]), centroid)
}

fn difference(a: &(f64, f64, [f64; 3]), b: &(f64, f64, [f64; 3])) -> f64 {
    let apart: f64 = a.2.iter().zip(b.2).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    ((a.0 - b.0).abs() / b.0.abs()).max((a.1 - b.1).abs() / b.1).max(apart / b.1.sqrt())
}

/// The greatest difference of solids, each against the nearest that is left.
fn worst(ours: &[(f64, f64, [f64; 3])], mut others: Vec<(f64, f64, [f64; 3])>) -> f64 {
    let mut worst = 0.0f64;
    for one in ours {
        let nearest = (0..others.len())
            .min_by(|&i, &j| difference(one, &others[i]).total_cmp(&difference(one, &others[j])));
        let Some(at) = nearest else { return f64::INFINITY };
        worst = worst.max(difference(one, &others.swap_remove(at)));
    }
    worst
}

#[test]
fn every_solid_measures_what_open_cascade_measures_or_is_explained() {
    let (Some(python), Some(corpus)) = (python(), support::corpus()) else { return };
    let folder = corpus.join("step");
    let name =
        |path: &Path| path.strip_prefix(&folder).ok().map(|name| name.to_string_lossy().replace('\\', "/"));
    let mut wrong = Vec::new();
    let mut measured = 0;
    for path in support::corpus_step_files() {
        let Some(file) = name(&path).filter(|name| !LEFT_OUT.contains(&name.as_str())) else { continue };
        let script = root().join("tests/external/occ_measures.py");
        let output = Command::new(&python).arg(script).arg(&path).output().expect("the interpreter starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let found: Value = serde_json::from_str(text.trim_end().lines().next_back().unwrap_or_default())
            .unwrap_or_else(|error| panic!("{file}: {error}: {text}"));
        let model = read(&path);
        let ours = Inventory::of(&model);
        if found["error"].is_string() {
            assert_eq!(ours.faces, 0, "{file}: {found}");
            continue;
        }
        let counts = [ours.solids, ours.faces];
        for (word, count) in COUNTS.iter().zip(counts) {
            assert_eq!(found["counts"][word], count, "{file}: {word}");
        }
        let kinds: BTreeMap<&str, usize> =
            ours.surfaces.iter().map(|(kind, count)| (*kind, *count)).collect();
        assert_eq!(found["surfaces"], serde_json::json!(kinds), "{file}");
        let others = found["solids"].as_array().expect("a list").iter().map(theirs).collect();
        let solids = solids(&model, &file);
        measured += solids.len();
        let worst = worst(&solids, others);
        let excused = DIFFERENCES.iter().find(|(known, ..)| *known == file);
        let limit = excused.map_or(AGREED, |(_, limit, _)| *limit);
        if worst > limit || (excused.is_some() && worst <= AGREED) {
            wrong.push(format!("{file}: {worst:.2e}, {excused:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(measured > 40, "{measured}");
}
