//! The vectors p1 to p7, computed by another program.

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::math::{Point3, Vector3};
use resurf::ops::feature_paste::{
    EdgeWeights, Ends, Existing, Feature, Ground, Method, Mirror, Plane, Rule, Settings, Turn,
    contour_polygon, identify, paste, project_contour,
};
use resurf::ops::net::Mask;
use serde_json::Value;

use super::parts::{distance, points};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn pairs(value: &Value) -> Vec<[f64; 2]> {
    value.as_array().unwrap().iter().map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()]).collect()
}

fn triples(value: &Value) -> Vec<Point3<f64>> {
    let point = |p: &Value| Point3::from(Vector3::from_vec(numbers(p)));
    value.as_array().unwrap().iter().map(point).collect()
}

fn surface(value: &Value) -> NurbsSurface {
    let degree = |k: usize| value["degree"][k].as_u64().unwrap() as usize;
    let knots = |k: usize, name: &str| KnotVector::new(degree(k), numbers(&value[name])).unwrap();
    let weights = numbers(&value["weights"]);
    let points = triples(&value["points_xyz"]);
    NurbsSurface::from_points(knots(0, "knots_u"), knots(1, "knots_v"), &points, Some(&weights)).unwrap()
}

fn places(mask: &Mask) -> Vec<[u64; 2]> {
    let columns = mask.shape().1;
    mask.indices().map(|at| [(at / columns) as u64, (at % columns) as u64]).collect()
}

fn expected_places(value: &Value) -> Vec<[u64; 2]> {
    let pair = |p: &Value| [p[0].as_u64().unwrap(), p[1].as_u64().unwrap()];
    value.as_array().unwrap().iter().map(pair).collect()
}

fn vector(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn p1_index_sets_of_both_rules() {
    let vector = vector(include_str!("../vectors/p1_identify.json"));
    let source = surface(&vector["input"]["surface"]);
    let contour = contour_polygon(&source, &pairs(&vector["input"]["contour_uv"])).unwrap();
    for (rule, name) in [(Rule::Support, "support"), (Rule::RowsAndColumns, "paper")] {
        let sets = identify(&source, &contour, rule);
        assert_eq!(places(&sets.acting), expected_places(&vector["output"][name]["ccps"]), "{name}");
        assert_eq!(places(&sets.own), expected_places(&vector["output"][name]["pcps"]), "{name}");
    }
}

fn anchors(input: &Value) -> ([f64; 2], [f64; 2]) {
    let pair = |v: &Value| [v[0].as_f64().unwrap(), v[1].as_f64().unwrap()];
    (pair(&input["anchor_source"]), pair(&input["anchor_target"]))
}

/// Runs a vector of the matched engines and compares sets, maps and all control points.
fn check(text: &str, settings: &Settings) {
    let vector = vector(text);
    let (input, output) = (&vector["input"], &vector["output"]);
    let (source, target) = (surface(&input["source"]), surface(&input["target"]));
    let (anchor, at) = anchors(input);
    let contour = pairs(&input["contour_uv"]);
    let feature = Feature { source: &source, contour: &contour, anchor };
    let result = paste(&feature, &Ground { target: &target, at }, settings).unwrap();
    assert_eq!(places(&result.changed), expected_places(&output["pcps_target"]));
    let offset = result.offset.unwrap().map(|d| d as i64);
    assert_eq!(offset[0], output["index_offset"][0].as_i64().unwrap());
    assert_eq!(offset[1], output["index_offset"][1].as_i64().unwrap());
    assert!((result.map.linear[0][0] - output["knot_map_u"][0].as_f64().unwrap()).abs() < 1e-12);
    assert!((result.map.linear[1][1] - output["knot_map_v"][0].as_f64().unwrap()).abs() < 1e-12);
    let expected = surface(&output["surface"]);
    let off = distance(&points(&result.surface), &points(&expected));
    assert!(off <= 1e-9, "control points are off by {off:.3e}");
    let weights = result.surface.weights().zip(expected.weights());
    assert!(weights.into_iter().all(|(a, b)| (a - b).abs() <= 1e-9));
    let knots = result.surface.knots_u().knots().iter().zip(expected.knots_u().knots());
    assert!(knots.into_iter().all(|(a, b)| (a - b).abs() <= 1e-12));
}

fn poisson() -> Settings {
    Settings {
        method: Some(Method::Poisson),
        existing: Existing::Replace,
        ends: Ends::Open,
        ..Settings::new(1e-3)
    }
}

#[test]
fn p2_published_poisson_with_uniform_weights() {
    let settings = Settings { turn: Turn::None, edge_weights: EdgeWeights::Uniform, ..poisson() };
    check(include_str!("../vectors/p2_poisson_uniform.json"), &settings);
}

#[test]
fn p3_poisson_with_finite_volumes_turned_by_normals() {
    let settings = Settings { turn: Turn::Normal, ..poisson() };
    check(include_str!("../vectors/p3_poisson_rotated.json"), &settings);
}

#[test]
fn p4_poisson_with_mixed_gradients_turned_by_frames() {
    let settings = Settings { existing: Existing::Stronger, ..poisson() };
    check(include_str!("../vectors/p4_poisson_mixed.json"), &settings);
}

#[test]
fn p5_displacement_of_a_rational_feature_onto_a_rational_cylinder_of_lower_degree() {
    let settings = Settings { scale: [1.2; 3], ends: Ends::Open, ..Settings::new(1e-3) };
    check(include_str!("../vectors/p5_displacement_rational.json"), &settings);
}

#[test]
fn p6_fit_turned_and_mirrored() {
    let vector = vector(include_str!("../vectors/p6_fit_rotated.json"));
    let (input, output) = (&vector["input"], &vector["output"]);
    let (source, target) = (surface(&input["source"]), surface(&input["target"]));
    let (anchor, at) = anchors(input);
    let contour = pairs(&input["contour_uv"]);
    let feature = Feature { source: &source, contour: &contour, anchor };
    let settings = Settings {
        angle: input["angle_deg"].as_f64().unwrap().to_radians(),
        mirror: Mirror::V,
        ..Settings::new(input["tol"].as_f64().unwrap())
    };
    let result = paste(&feature, &Ground { target: &target, at }, &settings).unwrap();
    assert_eq!(result.method, Method::Fit);
    for (row, expected) in result.map.linear.iter().zip(output["uv_map"].as_array().unwrap()) {
        assert!(row.iter().zip(numbers(expected)).all(|(a, b)| (a - b).abs() < 1e-12));
    }
    // The other program fits a few points of the border too, so the geometry is compared, not the net.
    let probes = triples(&vector["check"]["probe_points_at_fraction_u_15_50_85_v_20_50_70"]);
    let fractions = [0.15, 0.5, 0.85].iter().flat_map(|&u| [0.2, 0.5, 0.7].map(|v| (u, v)));
    for ((u, v), expected) in fractions.zip(probes) {
        assert!((result.surface.point(u, v) - expected).norm() < 1e-2);
    }
    assert!(result.fit_error.unwrap() <= settings.tolerance);
}

#[test]
fn p7_contour_along_the_normal_of_a_plane() {
    let vector = vector(include_str!("../vectors/p7_contour.json"));
    let input = &vector["input"];
    let target = surface(&input["surface"]);
    let plane = Plane {
        origin: Point3::from(Vector3::from_vec(numbers(&input["plane_origin"]))),
        normal: Vector3::from_vec(numbers(&input["plane_normal"])),
    };
    let found = project_contour(&target, &triples(&input["contour_xyz"]), plane).unwrap();
    for (found, expected) in found.iter().zip(pairs(&vector["output"]["contour_uv"])) {
        assert!((found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9);
    }
}
