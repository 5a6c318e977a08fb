//! Assemblies against Open CASCADE's document model: components, where each solid stands, colours of its faces.
//!
//! Needs a Python with `cadquery-ocp`, named by `RESURF_OCC_PYTHON`, and the corpus; without either the test
//! passes over it. `RESURF_REQUIRE_OCC=1` makes a missing Python a failure.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use resurf::brep::BodyKind;
use resurf::diagnostic::Diagnostics;
use resurf::math::Point3;
use resurf::model::{Instances, Model, PlacedBody};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};
use resurf::units::LengthUnit;

/// Files, and how many more components the other program has, because it makes one of each item of a part
/// that is more than one solid.
const FILES: [(&str, usize); 13] = [
    // 18 placed parts, each a solid and a set of curves.
    ("as1_pe_203.stp", 36),
    ("trj3_as1-tc-214.stp", 0),
    ("dm1-id-214.stp", 0),
    ("twoCars.stp", 0),
    // One part has a wire beside its solid.
    ("flipping_joystick_assembly.stp", 2),
    ("tail_section_asm.stp", 0),
    ("magnet_geom_with_casing.step", 0),
    // One part: its solid and its supplemental geometry.
    ("nist_ftc_06.step", 2),
    ("io1-cm-214.stp", 0),
    ("13_5_hinge_R_assy.stp", 0),
    ("ExpansionCard_ThreadedInsert.stp", 0),
    ("#332_file.stp", 0),
    ("ANC101.stp", 0),
];

/// Millimetres by which boxes may differ for each millimetre of size: files write six digits and more.
const BOX: f64 = 1e-6;

/// Steps of 255 by which colours may differ: the other program keeps them as linear single-precision numbers.
const COLOUR_STEPS: i32 = 1;

#[derive(Debug, serde::Deserialize)]
struct Theirs {
    file: String,
    #[serde(default)]
    error: String,
    #[serde(default)]
    components: usize,
    #[serde(default)]
    solids: Vec<Solid>,
}

#[derive(Debug, serde::Deserialize)]
struct Solid {
    #[serde(rename = "box")]
    extents: [f64; 6],
    colours: BTreeMap<String, usize>,
}

fn corpus() -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus");
    let dir = std::env::var_os("RESURF_CORPUS").map_or_else(beside, PathBuf::from).join("step");
    dir.is_dir().then_some(dir)
}

fn theirs(corpus: &Path) -> Option<Vec<Theirs>> {
    let required = std::env::var_os("RESURF_REQUIRE_OCC").is_some_and(|value| value == "1");
    let Some(python) = std::env::var_os("RESURF_OCC_PYTHON") else {
        assert!(!required, "RESURF_OCC_PYTHON does not name a Python with cadquery-ocp");
        return None;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/external/assembly.py");
    let files = FILES.iter().map(|(file, _)| corpus.join(file));
    let output = Command::new(python).arg(script).args(files).output().expect("the Python runs");
    let text = String::from_utf8(output.stdout).expect("JSON is UTF-8");
    let found: Vec<Theirs> = text
        .lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).expect(line))
        .collect();
    assert_eq!(found.len(), FILES.len(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(found)
}

fn read(path: &Path) -> Model {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut sink = Diagnostics::default();
    let file = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
    to_model(&file, &mut sink)
}

fn ours(model: &Model, instances: &Instances) -> Vec<Solid> {
    let solids =
        instances.bodies.iter().filter(|placed| model.brep.bodies[placed.body].kind == BodyKind::Solid);
    solids.map(|placed| solid(model, instances, placed)).collect()
}

fn solid(model: &Model, instances: &Instances, placed: &PlacedBody) -> Solid {
    let brep = &model.brep;
    let shells = brep.bodies[placed.body].shells.iter();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut colours = BTreeMap::new();
    let mut add = |point: &Point3<f64>| {
        let point = placed.transform.point(point);
        for k in 0..3 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    };
    for &face in shells.flat_map(|&shell| &brep.shells[shell].faces) {
        for coedge in brep.coedges_of(face) {
            let edge = &brep.edges[brep.coedges[coedge].edge];
            add(&brep.vertices[edge.start].point);
            add(&brep.vertices[edge.end].point);
        }
        let name = instances.colour(model, placed, face).map_or("none".to_owned(), |colour| {
            let parts = [colour.red, colour.green, colour.blue];
            "#".to_owned() + &parts.map(|part| format!("{:02x}", (part * 255.0).round() as u8)).concat()
        });
        *colours.entry(name).or_insert(0) += 1;
    }
    Solid { extents: [low[0], low[1], low[2], high[0], high[1], high[2]], colours }
}

fn same_box(a: &Solid, b: &Solid) -> bool {
    let size = a.extents.iter().fold(1.0f64, |size, part| size.max(part.abs()));
    a.extents.iter().zip(&b.extents).all(|(a, b)| (a - b).abs() <= BOX * size)
}

fn same_colours(a: &Solid, b: &Solid) -> bool {
    let near = |a: &str, b: &str| {
        let part = |text: &str, k: usize| {
            text.get(2 * k + 1..2 * k + 3).and_then(|t| i32::from_str_radix(t, 16).ok())
        };
        a == b
            || (0..3).all(|k| part(a, k).zip(part(b, k)).is_some_and(|(a, b)| (a - b).abs() <= COLOUR_STEPS))
    };
    let total = |solid: &Solid, name: &str| -> usize {
        solid.colours.iter().filter(|(other, _)| near(name, other)).map(|(_, count)| count).sum()
    };
    a.colours.keys().chain(b.colours.keys()).all(|name| total(a, name) == total(b, name))
}

#[test]
fn components_places_and_colours_are_those_of_another_reader() {
    let Some(corpus) = corpus() else { return };
    let Some(theirs) = theirs(&corpus) else { return };
    let mut faults = Vec::new();
    for ((file, more), theirs) in FILES.iter().zip(theirs) {
        assert_eq!((theirs.file.as_str(), theirs.error.as_str()), (*file, ""));
        let model = read(&corpus.join(file));
        let instances = Instances::of(&model, &LengthUnit::millimetre(), Instances::LIMIT);
        let components = instances.nodes.iter().filter(|node| node.occurrence.is_some()).count();
        if components + more != theirs.components {
            faults.push(format!("{file}: {components} components, expected {} - {more}", theirs.components));
        }
        let mut ours = ours(&model, &instances);
        if ours.len() != theirs.solids.len() {
            faults.push(format!("{file}: {} placed solids, expected {}", ours.len(), theirs.solids.len()));
        }
        for solid in &theirs.solids {
            let placed = ours.iter().position(|own| same_box(own, solid) && same_colours(own, solid));
            match placed.or_else(|| ours.iter().position(|own| same_box(own, solid))) {
                Some(at) => {
                    let own = ours.remove(at);
                    if !same_colours(&own, solid) {
                        faults.push(format!("{file}: {:?}, expected {:?}", own.colours, solid.colours));
                    }
                }
                None => faults.push(format!("{file}: no solid within {:?}", solid.extents)),
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
