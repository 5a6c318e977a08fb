//! Reference vectors `k1` (knot insertion) and `k2` (degree elevation) of the scaling specification and `r8` (extension,
//! sub-rectangle) of the reconstruction's: numbers of another program, at the tolerances that come with them.

#![expect(clippy::unwrap_used, reason = "builders of fixtures stop at what cannot be built")]

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::math::Point3;
use serde_json::Value;
use std::path::Path;

fn vector(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(name);
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn surface(value: &Value) -> NurbsSurface {
    let degree = numbers(&value["degree"]);
    let knots = |d: f64, name: &str| KnotVector::new(d as usize, numbers(&value[name])).unwrap();
    let points: Vec<Point3<f64>> = value["points_xyz"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| {
            let p = numbers(p);
            Point3::new(p[0], p[1], p[2])
        })
        .collect();
    let weights = numbers(&value["weights"]);
    NurbsSurface::from_points(
        knots(degree[0], "knots_u"),
        knots(degree[1], "knots_v"),
        &points,
        Some(&weights),
    )
    .unwrap()
}

fn assert_same(found: &NurbsSurface, expected: &NurbsSurface, tolerance: f64) {
    assert_eq!(found.shape(), expected.shape());
    for (a, b) in [(found.knots_u(), expected.knots_u()), (found.knots_v(), expected.knots_v())] {
        assert_eq!(a.degree(), b.degree());
        assert!(a.knots().iter().zip(b.knots()).all(|(a, b)| (a - b).abs() <= tolerance));
    }
    let size = expected.bounding_box().diagonal();
    for (a, b) in found.control_points().zip(expected.control_points()) {
        assert!((a - b).norm() <= tolerance * size, "{a} against {b}");
    }
    for (a, b) in found.weights().zip(expected.weights()) {
        assert!((a - b).abs() <= tolerance);
    }
}

/// Points at 15, 50, 85 % of `u` and 20, 50, 70 % of `v`, with the other program's evaluation.
fn assert_probes(found: &NurbsSurface, vector: &Value, tolerance: f64) {
    let probes = vector["check"]["probe_points_at_fraction_u_15_50_85_v_20_50_70"].as_array().unwrap();
    let mut points = Vec::new();
    for u in [0.15, 0.5, 0.85] {
        points.extend([0.2, 0.5, 0.7].map(|v| found.point(u, v)));
    }
    assert_eq!(points.len(), probes.len());
    for (point, probe) in points.iter().zip(probes) {
        let probe = numbers(probe);
        assert!((point - Point3::new(probe[0], probe[1], probe[2])).norm() <= tolerance, "{point}");
    }
}

#[test]
fn k1_knot_insertion() {
    let k1 = vector("k1_insert.json");
    let input = surface(&k1["input"]["surface"]);
    let found = input
        .refined_u(&numbers(&k1["input"]["insert_u"]))
        .unwrap()
        .refined_v(&numbers(&k1["input"]["insert_v"]))
        .unwrap();
    assert_same(&found, &surface(&k1["output"]["surface"]), 1e-13);
    assert_probes(&found, &k1, 1e-12);
}

#[test]
fn k2_degree_elevation() {
    let k2 = vector("k2_elevate.json");
    let degree = numbers(&k2["input"]["degree"]);
    let input = surface(&k2["input"]["surface"]);
    let found = input.elevated(degree[0] as usize, degree[1] as usize).unwrap();
    assert_same(&found, &surface(&k2["output"]["surface"]), 1e-11);
    assert_probes(&found, &k2, 1e-11);
}

/// A bicubic surface as `r8` writes it.
fn bicubic(value: &Value) -> NurbsSurface {
    let knots = |name: &str| KnotVector::new(3, numbers(&value[name])).unwrap();
    let rows = value["controls"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
    let points: Vec<Point3<f64>> = rows.map(numbers).map(|p| Point3::new(p[0], p[1], p[2])).collect();
    NurbsSurface::from_points(knots("tu"), knots("tv"), &points, None).unwrap()
}

#[test]
fn r8_extension_and_sub_rectangle() {
    let r8 = vector("r8_surface_tools.json");
    let surface = bicubic(&r8);
    let tolerance = r8["tolerance"].as_f64().unwrap();
    let size = surface.bounding_box().diagonal();
    let e = numbers(&r8["extend"]["e"]);
    let larger = surface.extended((e[0], e[1]), (e[2], e[3])).unwrap();
    assert_same(&larger, &bicubic(&r8["extend"]), tolerance / size);
    let rect = numbers(&r8["sub"]["rect"]);
    let piece = surface.piece((rect[0], rect[1]), (rect[2], rect[3])).unwrap();
    assert_same(&piece, &bicubic(&r8["sub"]), tolerance / size);
}
