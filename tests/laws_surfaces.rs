//! Laws of every kind of curve and surface: derivatives against differences, parameters of points,
//! exact images under affine maps.

#![expect(clippy::unwrap_used, reason = "builders of fixtures stop at what cannot be built")]

use resurf::geometry::nurbs::{KnotVector, NurbsCurve3, NurbsSurface};
use resurf::geometry::{Curve, Surface};
use resurf::math::{Affine, Frame, Matrix3, Point2, Point3, Vector3, minimal_rotation};

fn frame() -> Frame {
    Frame::from_axis(
        Point3::new(1.0, -2.0, 0.5),
        Vector3::new(0.3, -0.5, 1.0),
        Some(Vector3::new(1.0, 1.0, 0.0)),
    )
    .unwrap()
}

fn wavy_curve() -> NurbsCurve3 {
    let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.1, 2.0, 2.0, 2.0, 2.0]).unwrap();
    let points = [
        Point3::new(3.0, 0.0, 0.0),
        Point3::new(4.0, 0.2, 1.0),
        Point3::new(3.5, 0.5, 2.0),
        Point3::new(5.0, 0.3, 3.0),
        Point3::new(4.5, 0.0, 4.0),
        Point3::new(4.0, -0.5, 5.0),
    ];
    NurbsCurve3::from_points(knots, &points, Some(&[1.0, 1.2, 0.8, 1.5, 1.0, 0.7])).unwrap()
}

fn curves() -> Vec<Curve> {
    vec![
        Curve::Line { origin: Point3::new(1.0, 2.0, 3.0), direction: Vector3::new(0.5, -2.0, 1.0) },
        Curve::Circle { frame: frame(), radius: 2.5 },
        Curve::Ellipse { frame: frame(), semi_axis_1: 1.5, semi_axis_2: 4.0 },
        Curve::Nurbs(wavy_curve()),
    ]
}

fn surfaces() -> Vec<Surface> {
    let mut all = vec![
        Surface::Plane(frame()),
        Surface::Cylinder { frame: frame(), radius: 2.0 },
        Surface::Cone { frame: frame(), radius: 2.0, semi_angle: 0.4 },
        Surface::Cone { frame: frame(), radius: 3.0, semi_angle: -0.3 },
        Surface::Sphere { frame: frame(), radius: 3.0 },
        Surface::Torus { frame: frame(), major_radius: 5.0, minor_radius: 1.5 },
    ];
    for curve in curves() {
        let direction = Vector3::new(0.4, 0.3, 2.0);
        all.push(Surface::LinearExtrusion { curve: Box::new(curve), direction });
    }
    let axis = Frame::from_axis(Point3::new(-3.0, 0.0, 0.0), Vector3::z(), None).unwrap();
    all.push(Surface::Revolution { curve: Box::new(Curve::Nurbs(wavy_curve())), frame: axis });
    let line = Curve::Line { origin: Point3::new(4.0, 1.0, 0.0), direction: Vector3::new(0.2, 0.3, 1.0) };
    all.push(Surface::Revolution { curve: Box::new(line), frame: axis });
    let knots = KnotVector::clamped_uniform(3, 2, 0.0, 1.0).unwrap();
    let mut points = Vec::new();
    for i in 0..5 {
        for j in 0..5 {
            let (x, y) = (f64::from(i), f64::from(j));
            points.push(Point3::new(x, y, (x * 0.7).sin() * (y * 0.5).cos()));
        }
    }
    all.push(Surface::Nurbs(NurbsSurface::from_points(knots.clone(), knots, &points, None).unwrap()));
    all
}

/// Parameters inside the domain, or within 1.5 of zero where it is endless.
fn inside((low, high): (f64, f64), part: f64) -> f64 {
    if low.is_finite() { low + (high - low) * part } else { -1.5 + 3.0 * part }
}

fn places(surface: &Surface) -> Vec<(f64, f64)> {
    let (du, dv) = surface.domain();
    let mut out = Vec::new();
    for i in 0..7 {
        for j in 0..7 {
            out.push((inside(du, 0.03 + 0.155 * f64::from(i)), inside(dv, 0.04 + 0.151 * f64::from(j))));
        }
    }
    out
}

/// Central differences, step 1e-5: truncation and rounding both near 1e-10.
const STEP: f64 = 1e-5;
const DIFFERENCE: f64 = 1e-8;

#[test]
fn curve_derivatives_agree_with_differences() {
    for curve in curves() {
        for i in 0..9 {
            let t = inside(curve.domain(), 0.06 + 0.11 * f64::from(i));
            let [p, d1, d2] = curve.derivatives(t);
            assert!((curve.point_at(t).coords - p).norm() < 1e-14);
            let (a, b) = (curve.derivatives(t + STEP), curve.derivatives(t - STEP));
            assert!(((a[0] - b[0]) / (2.0 * STEP) - d1).norm() < DIFFERENCE, "{}", curve.kind());
            assert!(((a[1] - b[1]) / (2.0 * STEP) - d2).norm() < DIFFERENCE * 10.0, "{}", curve.kind());
        }
    }
}

#[test]
fn surface_derivatives_agree_with_differences() {
    for surface in surfaces() {
        for (u, v) in places(&surface) {
            let d = surface.derivatives(u, v);
            assert!((surface.point(u, v) - d.point).norm() < 1e-14);
            let (a, b) = (surface.derivatives(u + STEP, v), surface.derivatives(u - STEP, v));
            let scale = 1.0 / (2.0 * STEP);
            let kind = surface.kind();
            assert!(((a.point - b.point) * scale - d.du).norm() < DIFFERENCE, "{kind}");
            assert!(((a.du - b.du) * scale - d.duu).norm() < DIFFERENCE * (10.0 + d.duu.norm()), "{kind}");
            assert!(((a.dv - b.dv) * scale - d.duv).norm() < DIFFERENCE, "{kind}");
            let (a, b) = (surface.derivatives(u, v + STEP), surface.derivatives(u, v - STEP));
            assert!(((a.point - b.point) * scale - d.dv).norm() < DIFFERENCE, "{kind}");
            assert!(((a.dv - b.dv) * scale - d.dvv).norm() < DIFFERENCE * (10.0 + d.dvv.norm()), "{kind}");
        }
    }
}

#[test]
fn parameters_of_a_point_of_a_curve_return() {
    for curve in curves() {
        for i in 0..9 {
            let t = inside(curve.domain(), 0.06 + 0.11 * f64::from(i));
            let point = curve.point_at(t);
            assert!((curve.parameter_of(&point, None) - t).abs() < 1e-12, "{} at {t}", curve.kind());
            assert!(
                (curve.parameter_of(&point, Some(t + 0.05)) - t).abs() < 1e-12,
                "{} at {t}",
                curve.kind()
            );
        }
    }
}

#[test]
fn a_point_off_an_ellipse_has_its_foot_where_the_residual_is_normal() {
    let curve = Curve::Ellipse { frame: frame(), semi_axis_1: 5.0, semi_axis_2: 2.0 };
    for (x, y) in [(0.3, 0.1), (6.0, 4.0), (-1.0, 7.0), (-2.0, -0.5), (4.0, -0.1), (0.0, 1.0), (0.0, -9.0)] {
        let point = frame().point(x, y, 0.7);
        let t = curve.parameter_of(&point, None);
        let [p, d, _] = curve.derivatives(t);
        let residual = p - point.coords;
        assert!(residual.dot(&d).abs() < 1e-12 * d.norm() * residual.norm().max(1.0), "({x}, {y})");
        let least = (0..2000)
            .map(|i| (curve.point_at(f64::from(i) * std::f64::consts::TAU / 2000.0) - point).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(residual.norm() <= least + 1e-12, "({x}, {y})");
    }
}

#[test]
fn parameters_of_a_point_of_a_surface_return() {
    for surface in surfaces() {
        for (u, v) in places(&surface) {
            let d = surface.derivatives(u, v);
            for height in [0.0, 0.05] {
                let point = d.point + d.normal().unwrap() * height;
                let found = surface.parameters_of(&point, Some((u + 0.02, v - 0.03)));
                let off = (found.0 - u).abs().max((found.1 - v).abs());
                assert!(off < 1e-9, "{} at ({u}, {v}) with a seed: {found:?}", surface.kind());
                let found = surface.parameters_of(&point, None);
                let away = (surface.point(found.0, found.1) - point).norm();
                assert!(away <= height + 1e-9, "{} at ({u}, {v}): {away}", surface.kind());
            }
        }
    }
}

fn maps() -> Vec<(&'static str, Affine)> {
    let turn = minimal_rotation(&Vector3::new(1.0, 2.0, 3.0), &Vector3::new(-2.0, 1.0, 0.5), &Vector3::x());
    let center = Point3::new(3.0, 1.0, -2.0);
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    // Stretches along and across the axis of `frame`.
    let f = frame();
    let axes = Matrix3::from_columns(&[f.x, f.y, f.z]);
    let axial = axes * Matrix3::from_diagonal(&Vector3::new(2.0, 2.0, 0.7)) * axes.transpose();
    vec![
        ("rigid", Affine::about(&center, turn)),
        ("similar", Affine::about(&center, turn * 1.7)),
        ("mirror", Affine::about(&center, turn * mirror)),
        ("axial", Affine::about(&center, turn * axial)),
        ("general", Affine::about(&center, Matrix3::new(1.1, 0.2, 0.0, -0.1, 1.3, 0.4, 0.0, 0.3, 0.8))),
        ("diagonal", Affine::about(&center, Matrix3::from_diagonal(&Vector3::new(1.1, 1.2, 1.25)))),
    ]
}

#[test]
fn images_of_curves_are_the_images_of_their_points() {
    for (name, map) in maps() {
        for curve in curves() {
            let (image, shift) = curve.transformed_with_shift(&map).unwrap();
            for i in 0..9 {
                let t = inside(curve.domain(), 0.06 + 0.11 * f64::from(i));
                let off = (image.point_at(t - shift) - map.point(&curve.point_at(t))).norm();
                assert!(off < 1e-13 * 20.0, "{name} {}: {off}", curve.kind());
            }
        }
    }
}

#[test]
fn circles_stay_circles_under_similarities() {
    let circle = Curve::Circle { frame: frame(), radius: 2.5 };
    for (name, map) in maps() {
        let (image, shift) = circle.transformed_with_shift(&map).unwrap();
        match name {
            "rigid" | "similar" | "mirror" | "axial" => {
                assert_eq!((image.kind(), shift), ("circle", 0.0), "{name}");
            }
            _ => assert_eq!(image.kind(), "ellipse", "{name}"),
        }
    }
}

#[test]
fn images_of_surfaces_are_the_images_of_their_points_with_the_normal_kept() {
    let mut refused = Vec::new();
    for (name, map) in maps() {
        for surface in surfaces() {
            let Ok(image) = surface.transformed(&map) else {
                refused.push((name, surface.kind()));
                continue;
            };
            let change = surface.parameter_map(&map).unwrap();
            let sign = if surface.image_turns_normal(&map) { -1.0 } else { 1.0 };
            let inverse = map.linear.try_inverse().unwrap().transpose();
            for (u, v) in places(&surface) {
                let at = change.point(&Point2::new(u, v));
                let off = (image.point(at.x, at.y) - map.point(&surface.point(u, v))).norm();
                assert!(off < 1e-12, "{name} {}: {off}", surface.kind());
                let normal = (inverse * surface.normal(u, v).unwrap()).normalize();
                let found = image.normal(at.x, at.y).unwrap() * sign;
                assert!((normal - found).norm() < 1e-12, "{name} {}", surface.kind());
            }
        }
    }
    let quadrics = ["cylinder", "cone", "cone", "sphere", "torus", "revolution", "revolution"];
    for name in ["general", "diagonal"] {
        let kinds: Vec<_> = refused.iter().filter(|r| r.0 == name).map(|r| r.1).collect();
        assert_eq!(kinds, quadrics, "{name}");
    }
    // The stretch follows the axis of cylinder and cones, not that of the revolutions.
    let kinds: Vec<_> = refused.iter().filter(|r| r.0 == "axial").map(|r| r.1).collect();
    assert_eq!(kinds, ["sphere", "torus", "revolution", "revolution"]);
    assert!(refused.iter().all(|r| !["rigid", "similar", "mirror"].contains(&r.0)));
}

#[test]
fn a_flattening_map_is_refused() {
    let flat = Affine::about(&Point3::origin(), Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)));
    let circle =
        Curve::Circle { frame: Frame::from_axis(Point3::origin(), Vector3::x(), None).unwrap(), radius: 1.0 };
    assert!(circle.transformed(&flat).is_err());
    assert!(
        Surface::Plane(Frame::from_axis(Point3::origin(), Vector3::x(), None).unwrap())
            .transformed(&flat)
            .is_err()
    );
}
