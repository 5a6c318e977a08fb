//! The vectors b1 to b6, computed by another program.

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::math::Point3;
use resurf::ops::constrained_scale::{Continuity, Energy, Freedom, HeldLoop, Scaled, Scaling, scale_face};
use serde_json::Value;

use super::parts::{contour, distance, held, points};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn pairs(value: &Value) -> Vec<[f64; 2]> {
    value.as_array().unwrap().iter().map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()]).collect()
}

fn triples(value: &Value) -> Vec<Point3<f64>> {
    let point =
        |p: &Value| Point3::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap(), p[2].as_f64().unwrap());
    value.as_array().unwrap().iter().map(point).collect()
}

fn surface(value: &Value) -> NurbsSurface {
    let degree = |k: usize| value["degree"][k].as_u64().unwrap() as usize;
    let weights = numbers(&value["weights"]);
    let net = triples(&value["points_xyz"]).into_iter().enumerate().map(|(k, p)| {
        let w = weights.get(k).copied().unwrap_or(1.0);
        [p.x * w, p.y * w, p.z * w, w]
    });
    let knots = |k: usize, name: &str| KnotVector::new(degree(k), numbers(&value[name])).unwrap();
    NurbsSurface::new(knots(0, "knots_u"), knots(1, "knots_v"), net.collect()).unwrap()
}

fn scaling(input: &Value) -> Scaling {
    let factors = numbers(&input["scale"]);
    let options = &input["options"];
    let mut scaling = Scaling::new([factors[0], factors[1], factors[2]]);
    if options["weights"] == "paper" {
        scaling.energy = Energy::Published;
    }
    if options["free"] == "xyz" {
        scaling.freedom = Freedom::Free;
    }
    if options["cont"] == 0 {
        scaling.continuity = Continuity::Position;
    }
    scaling
}

/// Runs a vector and compares all control points, knots, counts, motions and the compression.
fn check(text: &str) {
    let vector: Value = serde_json::from_str(text).unwrap();
    let (input, output, figures) = (&vector["input"], &vector["output"], &vector["check"]);
    let tolerance = vector["tolerance"].as_f64().unwrap();
    let loops = input["loops_uv"].as_array().unwrap().iter().enumerate();
    let loops: Vec<HeldLoop> = loops.map(|(k, l)| held(k, pairs(l))).collect();
    let outer = (!input["outer_uv"].is_null()).then(|| contour(pairs(&input["outer_uv"])));
    let scaled = scale_face(&surface(&input["surface"]), &loops, outer, &scaling(input)).unwrap();
    let face = &scaled.faces[0];
    check_knots(face.surface.knots_u().knots(), &output["knots_u"]);
    check_knots(face.surface.knots_v().knots(), &output["knots_v"]);
    assert_eq!(face.level as u64, figures["levels"].as_u64().unwrap());
    assert_eq!(face.held.count() as u64, figures["type1"].as_u64().unwrap());
    assert_eq!(face.free_points as u64, figures["type2"].as_u64().unwrap());
    let off = distance(&points(&face.surface), &triples(&output["points_xyz"]));
    assert!(off <= tolerance, "control points are off by {off:.3e}");
    assert!((face.compression.ratio - figures["Jmin"].as_f64().unwrap()).abs() < 1e-6);
    check_motions(&scaled, figures, tolerance);
    assert!(scaled.residual < 1e-11, "residual {:.3e}", scaled.residual);
}

/// Bisected knots differ by rounding from those of another order of bisection.
fn check_knots(found: &[f64], expected: &Value) {
    let expected = numbers(expected);
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-15));
}

fn check_motions(scaled: &Scaled, figures: &Value, tolerance: f64) {
    let expected = figures["motion"].as_array().unwrap();
    assert_eq!(scaled.groups.len(), expected.len());
    for (group, expected) in scaled.groups.iter().zip(expected) {
        for (found, expected) in group.motion.amounts.iter().zip(numbers(&expected["d"])) {
            assert!((found - expected).abs() <= tolerance, "amount {found}, expected {expected}");
        }
        let center = group.motion.target + group.motion.shift();
        for (found, expected) in center.iter().zip(numbers(&expected["centre"])) {
            assert!((found - expected).abs() <= tolerance, "centre {found}, expected {expected}");
        }
    }
}

#[test]
fn b1_one_hole_by_default() {
    check(include_str!("../vectors/b1_default.json"));
}

#[test]
fn b2_published_energy_doubles() {
    check(include_str!("../vectors/b2_paper.json"));
}

#[test]
fn b3_published_energy_with_a_free_vector() {
    check(include_str!("../vectors/b3_paper_eq6.json"));
}

#[test]
fn b4_two_holes_in_a_rational_face() {
    check(include_str!("../vectors/b4_two_rational.json"));
}

#[test]
fn b5_degrees_three_and_five() {
    check(include_str!("../vectors/b5_degree_3x5.json"));
}

#[test]
fn b6_outer_loop_off_the_natural_border() {
    check(include_str!("../vectors/b6_outer_loop.json"));
}
