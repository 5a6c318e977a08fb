//! Meshes of the solids of real files: closed, manifold, oriented, of the volume that another program finds.
//!
//! The corpus is no part of the project: without `RESURF_CORPUS` (or `../shared/corpus`) this passes over it.
//! `corpus_volumes.tsv` holds volumes by Open CASCADE 8.0 with an accuracy of 1e-7; files whose meshes take
//! long in a build without optimisation are not among them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use resurf::brep::{BodyId, BodyKind};
use resurf::diagnostic::Diagnostics;
use resurf::geometry::Surface;
use resurf::geometry::nurbs::{SurfaceLocator, Wrap};
use resurf::math::Point3;
use resurf::mesh::{Integrity, Tolerances, tessellate_bodies};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};

fn corpus() -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus");
    let dir = std::env::var_os("RESURF_CORPUS").map_or_else(beside, PathBuf::from);
    dir.is_dir().then_some(dir)
}

/// Greatest distance of a mesh from its part: 0.1 mm, in metres.
const CHORD: f64 = 1e-4;

#[test]
fn solids_become_closed_meshes_of_their_volume() {
    let Some(corpus) = corpus() else { return };
    let rows = include_str!("corpus_volumes.tsv").lines().filter(|line| !line.starts_with("# "));
    let mut count = 0;
    for line in rows {
        let (file, volumes) = line.split_once('|').expect("file|volumes");
        let expected: Vec<f64> = volumes.split_whitespace().map(|v| v.parse().expect("a number")).collect();
        let bytes = std::fs::read(corpus.join("step").join(file)).expect("a file of the corpus");
        let mut sink = Diagnostics::default();
        let structure = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
        let model = to_model(&structure, &mut sink);
        let mut found = Vec::new();
        for (id, body) in model.brep.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Solid) {
            let metres = model.contexts[model.body_context[id]].length.metres;
            let tolerances = Tolerances { chord: CHORD / metres, angle: 20f64.to_radians() };
            let bodies: [BodyId; 1] = [id];
            let mesh = tessellate_bodies(&model.brep, &bodies, &tolerances)
                .unwrap_or_else(|error| panic!("{file} {:?}: {error}", model.origins.bodies[id]));
            let integrity = Integrity::of(&mesh);
            assert!(integrity.is_closed(), "{file} {:?}: {integrity:?}", model.origins.bodies[id]);
            assert!(!body.shells.is_empty());
            // In cubic millimetres; a mesh may be off by the tolerance over its area.
            let cubic = (metres * 1e3).powi(3);
            found.push((mesh.signed_volume() * cubic, mesh.area() * tolerances.chord * cubic));
            count += 1;
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(found.len(), expected.len(), "{file}");
        for ((volume, slack), expected) in found.iter().zip(&expected) {
            assert!((volume - expected).abs() <= *slack, "{file}: {volume}, expected {expected} ± {slack}");
        }
    }
    assert!(count > 20, "{count}");
}

/// One triangle of so many is looked at: closest points take long in a build without optimisation.
const EVERY: usize = 11;

#[test]
fn middles_of_triangles_and_sides_keep_to_the_chord() {
    let Some(corpus) = corpus() else { return };
    let (mut worst, mut over, mut count) = (0.0_f64, 0u32, 0u32);
    for file in ["Amazing Hand Parts - Distal_Shell.step", "issue153.stp"] {
        let bytes = std::fs::read(corpus.join("step").join(file)).expect("a file of the corpus");
        let mut sink = Diagnostics::default();
        let structure = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
        let model = to_model(&structure, &mut sink);
        for (id, _) in model.brep.bodies.iter() {
            let metres = model.contexts[model.body_context[id]].length.metres;
            let tolerances = Tolerances { chord: CHORD / metres, angle: 20f64.to_radians() };
            let mesh = tessellate_bodies(&model.brep, &[id], &tolerances).expect("a mesh");
            let mut locators = BTreeMap::new();
            for ([a, b, c], &face) in mesh.corners().zip(&mesh.faces).step_by(EVERY) {
                let surface = model.brep.surface_of(face).read().expect("a surface that is read");
                let Surface::Nurbs(nurbs) = surface else { continue };
                let (u, v) = surface.periods();
                let wrap = Wrap { u: u.is_some(), v: v.is_some() };
                let locator = locators.entry(face).or_insert_with(|| SurfaceLocator::new(nurbs, wrap));
                let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| nalgebra::center(&a, &b));
                for point in sides.iter().chain([&middle]) {
                    let off = locator.closest(point).distance / tolerances.chord;
                    worst = worst.max(off);
                    over += u32::from(off > 1.0);
                    count += 1;
                }
            }
        }
    }
    // The bend of a side is taken from its ends: a few may be off by a little more.
    assert!(
        count > 500 && worst < 1.2 && f64::from(over) < 0.01 * f64::from(count),
        "{worst}, {over} of {count}"
    );
}
