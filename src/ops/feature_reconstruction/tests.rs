//! The parts of a reconstruction against the reference vectors `r4` to `r7`, and against closed forms.

use super::Closure::{Closed, Open};
use super::ball::{Station, Unrest, rest};
use super::blend_surface::{lofted, middle};
use super::radius_law::{LinearLaw, SliceRadius};
use super::smoothing::{Order, smoothed, smoothed_against_outliers};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::math::{PlaneCircle, Point2, Point3, Vector3};
use serde_json::Value;
use std::f64::consts::TAU;

fn vector(name: &str) -> Value {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(name);
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn triples(value: &Value) -> Vec<[f64; 3]> {
    numbers(value).chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

fn assert_near(found: &[f64], wanted: &[f64], tolerance: f64) {
    assert_eq!(found.len(), wanted.len());
    for (k, (f, w)) in found.iter().zip(wanted).enumerate() {
        assert!((f - w).abs() <= tolerance, "{k}: {f} instead of {w}");
    }
}

#[test]
fn vector_r3_circles() {
    let data = vector("r3_circle.json");
    let tolerance = data["tolerance"].as_f64().unwrap();
    for case in data["cases"].as_array().unwrap() {
        let (x, y) = (numbers(&case["x"]), numbers(&case["y"]));
        let points: Vec<_> = x.iter().zip(&y).map(|(&x, &y)| Point2::new(x, y)).collect();
        let Some(found) = PlaneCircle::pratt(&points) else {
            assert_eq!(case["error"], "CIRCLE_COLLINEAR");
            continue;
        };
        let flat = |c: PlaneCircle| [c.center.x, c.center.y, c.radius];
        assert_near(&flat(found), &numbers(&case["pratt"]), tolerance);
        assert_near(&flat(found.refined(&points)), &numbers(&case["geometric"]), tolerance);
    }
}

#[test]
fn vector_r4_smoothing() {
    let data = vector("r4_smoothing.json");
    for (name, closure) in [("closed", Closed), ("open", Open), ("weighted", Open)] {
        let case = &data[name];
        let points = triples(&case["points"]);
        let mut weights = numbers(&case["beta"]);
        if weights.len() == 1 {
            weights = vec![weights[0]; points.len()];
        }
        let found = smoothed(&points, case["alpha"].as_f64().unwrap(), &weights, closure).unwrap();
        assert_near(found.as_flattened(), &numbers(&case["result"]), 1e-10);
    }
}

#[test]
fn a_wave_is_kept_by_the_part_that_the_formula_says() {
    let (n, waves) = (60, 5);
    let step = 0.7;
    let wave: Vec<f64> = (0..n).map(|i| (TAU * waves as f64 * f64::from(i) / f64::from(n)).sin()).collect();
    for wavelength in [4.0, 8.4, 30.0] {
        let alpha = Order::Second.stiffness(wavelength, step);
        let gain = |l: f64| 1.0 / (1.0 + alpha * (2.0 - 2.0 * (TAU * step / l).cos()).powi(2));
        assert!((gain(wavelength) - 0.5).abs() < 1e-12);
        let kept = gain(f64::from(n) * step / waves as f64);
        let expected: Vec<f64> = wave.iter().map(|w| kept * w).collect();
        let points: Vec<[f64; 1]> = wave.iter().map(|w| [*w]).collect();
        let weights = vec![1.0; wave.len()];
        assert_near(smoothed(&points, alpha, &weights, Closed).unwrap().as_flattened(), &expected, 1e-10);
        // A floor above all residuals: nothing counts as an outlier.
        let floor = 1e3;
        let found =
            smoothed_against_outliers(&points, (Order::Second, alpha), &weights, floor, Closed).unwrap();
        assert_near(found.as_flattened(), &expected, 1e-10);
        let alpha = Order::Third.stiffness(wavelength, step);
        let twice = 2.0 - 2.0 * (TAU * waves as f64 / f64::from(n)).cos();
        let expected: Vec<f64> = wave.iter().map(|w| w / (1.0 + alpha * twice.powi(3))).collect();
        let found =
            smoothed_against_outliers(&points, (Order::Third, alpha), &weights, floor, Closed).unwrap();
        assert_near(found.as_flattened(), &expected, 1e-10);
    }
    let none = smoothed(&[[1.0], [5.0], [2.0]], 0.0, &[1.0; 3], Open).unwrap();
    assert_near(none.as_flattened(), &[1.0, 5.0, 2.0], 1e-15);
}

#[test]
fn what_costs_nothing_stays_and_a_point_far_off_it_does_not_count() {
    for (order, bend) in [(Order::Second, 0.0), (Order::Third, 0.02)] {
        let at = |i: usize| [2.0 - 0.1 * i as f64 + bend * (i * i) as f64];
        let smooth: Vec<[f64; 1]> = (0..40).map(at).collect();
        let mut points = smooth.clone();
        points[17][0] += 5.0;
        let found = smoothed_against_outliers(&points, (order, 100.0), &[1.0; 40], 1e-6, Open).unwrap();
        assert_near(found.as_flattened(), smooth.as_flattened(), 1e-6);
        // Where nothing is known the line goes on.
        let mut weights = vec![1.0; 40];
        weights[30..].fill(0.0);
        points[17][0] -= 5.0;
        points[30..].fill([99.0]);
        let found = smoothed_against_outliers(&points, (order, 1.0), &weights, 1e-9, Open).unwrap();
        assert_near(found.as_flattened(), smooth.as_flattened(), 1e-7);
    }
}

#[test]
fn vector_r7_radius() {
    let data = vector("r7_radius.json");
    let read = |name: &str| numbers(&data[name]);
    let (s, radii, deviations) = (read("s"), read("R"), read("design_sd"));
    let slices: Vec<SliceRadius> =
        (0..s.len()).map(|k| SliceRadius { at: s[k], radius: radii[k], deviation: deviations[k] }).collect();
    let flat = |law: LinearLaw| [law.mean, law.slope, law.middle, law.errors[1]];
    let wanted = |name: &str| ["a", "b", "s_mean", "sd_b"].map(|key| data[name][key].as_f64().unwrap());
    let law = LinearLaw::of_radii(&slices).unwrap();
    assert_near(&flat(law), &wanted("curvature_space"), 1e-6);
    let values: Vec<_> = (0..s.len()).map(|k| (s[k], radii[k], deviations[k])).collect();
    let law = LinearLaw::through(&values).unwrap();
    assert_near(&flat(law), &wanted("radius_space"), 1e-6);
    assert_eq!(law.kept, 23);
}

/// The bicubic Bezier surface of a net.
fn patch(net: &Value) -> NurbsSurface {
    let knots = || KnotVector::clamped_uniform(3, 1, 0.0, 1.0).unwrap();
    let points: Vec<Point3<f64>> = triples(net).into_iter().map(Point3::from).collect();
    NurbsSurface::from_points(knots(), knots(), &points, None).unwrap()
}

#[test]
fn vector_r5_rolling_ball() {
    let data = vector("r5_rolling_ball.json");
    let (first, second) = (patch(&data["S1"]), patch(&data["S2"]));
    let (points, tangents) = (triples(&data["L"]), triples(&data["T"]));
    let mut sections = Vec::new();
    for k in 0..points.len() {
        let station = Station { point: Point3::from(points[k]), tangent: Vector3::from(tangents[k]) };
        // The limiting point itself is start enough.
        let start = [points[k][0] / 40.0, points[k][1] / 40.0];
        let section = rest([&first, &second], 3.0, &station, [start; 2]).unwrap();
        let [a, b] = section.contacts;
        let wanted = ["u1", "v1", "u2", "v2"].map(|name| data[name][k].as_f64().unwrap());
        assert_near(&[a.at[0], a.at[1], b.at[0], b.at[1]], &wanted, 1e-9);
        assert_near(
            &[section.centre.x, section.centre.y, section.centre.z],
            &numbers(&data["centre"][k]),
            1e-8,
        );
        let [x, y, z, w] = middle(&section).unwrap();
        assert_near(&[x / w, y / w, z / w], &numbers(&data["mid"][k]), 1e-8);
        assert_near(&[w], &numbers(&data["weight"][k]), 1e-9);
        sections.push(section);
    }
    for radius in [40.0, 1e3] {
        let station = Station { point: Point3::from(points[3]), tangent: Vector3::from(tangents[3]) };
        let start = [points[3][0] / 40.0, points[3][1] / 40.0];
        let found = rest([&first, &second], radius, &station, [start; 2]);
        assert!(matches!(found, Err(Unrest::Outside(_) | Unrest::NotFound)), "{found:?}");
    }
}

/// A flat square at a height, seen from above.
fn flat(height: f64) -> NurbsSurface {
    let knots = || KnotVector::clamped_uniform(1, 1, -10.0, 10.0).unwrap();
    let corners = [(-10.0, -10.0), (-10.0, 10.0), (10.0, -10.0), (10.0, 10.0)];
    let points = corners.map(|(x, y)| Point3::new(x, y, height));
    NurbsSurface::from_points(knots(), knots(), &points, None).unwrap()
}

/// A ball of radius 2 in the corner of the floor and a wall turned by an angle about y.
#[test]
fn the_blend_of_two_planes_is_a_cylinder() {
    let radius = 2.0;
    for degrees in [30.0_f64, 60.0, 90.0, 120.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let floor = flat(0.0);
        let turn = |p: Point3<f64>| Point3::new(cosine * p.x - sine * p.z, p.y, sine * p.x + cosine * p.z);
        let wall: Vec<Point3<f64>> = floor.control_points().map(turn).collect();
        let wall =
            NurbsSurface::from_points(floor.knots_u().clone(), floor.knots_v().clone(), &wall, None).unwrap();
        let sections: Vec<_> = (0..8)
            .map(|k| {
                let station = Station { point: Point3::new(0.0, f64::from(k), 0.0), tangent: Vector3::y() };
                rest([&floor, &wall], radius, &station, [[-1.0, 0.0], [1.0, 0.0]]).unwrap()
            })
            .collect();
        let away = radius * (0.5 * degrees.to_radians()).tan();
        for section in &sections {
            assert!((section.contacts[0].point.x + away).abs() < 1e-12);
            assert!((section.centre.z - radius).abs() < 1e-12);
        }
        let blend = lofted(&sections, Open).unwrap();
        for (u, v) in [(0.0, 0.1), (0.5, 0.33), (0.8, 0.71), (1.0, 1.0)] {
            let p = blend.surface.point(u, v);
            let off = ((p.x + away).powi(2) + (p.z - radius).powi(2)).sqrt();
            assert!((off - radius).abs() < 1e-12 && (p.y - 7.0 * v).abs() < 1e-12);
        }
    }
}
