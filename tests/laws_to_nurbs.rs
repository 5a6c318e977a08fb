//! Laws of exact conversion to B-splines: the points are those of the quadric, by its implicit equation, and the
//! borders those of the given rectangle.

use proptest::prelude::*;
use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::geometry::{Curve, ParameterLine, Surface, Trimmed};
use resurf::math::{Frame, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Relative distance of a point from where it belongs.
const EXACT: f64 = 1e-13;

fn frames() -> impl Strategy<Value = Frame> {
    let unit = || (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64);
    (unit(), unit(), unit()).prop_filter_map("directions that differ", |(o, z, x)| {
        let (z, x) = (Vector3::new(z.0, z.1, z.2), Vector3::new(x.0, x.1, x.2));
        let steep = z.cross(&x).norm() > 0.1 * z.norm() * x.norm() && z.norm() > 0.1;
        let origin = Point3::new(10.0 * o.0, 10.0 * o.1, 10.0 * o.2);
        if steep { Frame::from_axis(origin, z, Some(x)) } else { None }
    })
}

/// A range of angles, of a little or more than a turn.
fn angles() -> impl Strategy<Value = (f64, f64)> {
    (-4.0..4.0f64, 0.05..TAU).prop_map(|(start, way)| (start, start + way))
}

/// Greatest distance of a surface's points from an implicit form, which gives a distance.
fn off(surface: &NurbsSurface, distance: impl Fn(&Point3<f64>) -> f64) -> f64 {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let share = |k: u32| f64::from(k) / 12.0;
    let pairs = (0..=12).flat_map(|i| (0..=12).map(move |j| (share(i), share(j))));
    pairs.map(|(a, b)| distance(&surface.point(u0 + a * (u1 - u0), v0 + b * (v1 - v0)))).fold(0.0, f64::max)
}

/// Corners of the B-spline against those of the surface at the same parameters.
fn corners_off(surface: &Surface, nurbs: &NurbsSurface) -> f64 {
    let ((u0, u1), (v0, v1)) = nurbs.domain();
    let corners = [(u0, v0), (u1, v0), (u0, v1), (u1, v1)];
    corners.iter().map(|&(u, v)| (surface.point(u, v) - nurbs.point(u, v)).norm()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn parameters_are_carried_to_the_same_point(frame in frames(), range in angles(), share in 0.0..1.0f64) {
        let v = (-1.2, 1.1);
        let profile = Curve::Hyperbola { frame, semi_axis: 2.0, semi_imaginary_axis: 1.5 };
        let arc = Curve::Ellipse { frame, semi_axis_1: 3.0, semi_axis_2: 2.0 };
        let turned = Trimmed { basis: Box::new(arc), start: -range.1, end: -range.0, forward: false };
        let surfaces = [
            Surface::Cylinder { frame, radius: 3.0 },
            Surface::Cone { frame, radius: 5.0, semi_angle: 0.4 },
            Surface::Sphere { frame, radius: 4.0 },
            Surface::Torus { frame, major_radius: 7.0, minor_radius: 2.0 },
            Surface::Revolution { curve: Box::new(profile), frame },
            Surface::LinearExtrusion { curve: Box::new(Curve::Trimmed(turned)), direction: frame.z },
        ];
        for surface in surfaces {
            let nurbs = surface.to_nurbs(range, v).expect("good ranges");
            let [along_u, along_v] = ParameterLine::of_surface(&surface, range, v).expect("exact");
            let (x, y) = (range.0 + share * (range.1 - range.0), v.0 + share * share * (v.1 - v.0));
            let ((u, slope), (w, _)) = (along_u.image(x), along_v.image(y));
            prop_assert!((nurbs.point(u, w) - surface.point(x, y)).norm() < 1e-11, "{}", surface.kind());
            let step = 1e-6;
            let difference = (along_u.image(x + step).0 - along_u.image(x - step).0) / (2.0 * step);
            prop_assert!((difference - slope).abs() < 1e-6, "{}", surface.kind());
        }
    }

    #[test]
    fn arcs_lie_on_their_ellipse(frame in frames(), a in 0.1..9.0f64, b in 0.1..9.0f64, range in angles()) {
        let curve = Curve::Ellipse { frame, semi_axis_1: a, semi_axis_2: b };
        let nurbs = curve.to_nurbs(range).expect("a good range");
        prop_assert_eq!(nurbs.domain(), range);
        let scale = 20.0 + a + b;
        for k in 0..=50 {
            let t = range.0 + (range.1 - range.0) * f64::from(k) / 50.0;
            let local = frame.local(&nurbs.point_at(t));
            prop_assert!(((local.x / a).hypot(local.y / b) - 1.0).abs() * a.min(b) < EXACT * scale);
            prop_assert!(local.z.abs() < EXACT * scale);
            // Within a piece the parameters differ by little, so that the arc is the right one.
            prop_assert!((nurbs.point_at(t) - curve.point_at(t)).norm() < 0.05 * (a + b));
        }
        for t in [range.0, range.1] {
            prop_assert!((nurbs.point_at(t) - curve.point_at(t)).norm() < EXACT * scale);
        }
    }

    #[test]
    fn open_conics_lie_on_their_equation(frame in frames(), a in 0.1..5.0f64, b in 0.1..5.0f64, t0 in -3.0..1.0f64, way in 0.1..3.0f64) {
        let parabola = Curve::Parabola { frame, focal_distance: a };
        let nurbs = parabola.to_nurbs((t0, t0 + way)).expect("a good range");
        let hyperbola = Curve::Hyperbola { frame, semi_axis: a, semi_imaginary_axis: b };
        let branch = hyperbola.to_nurbs((t0, t0 + way)).expect("a good range");
        for k in 0..=20 {
            let t = t0 + way * f64::from(k) / 20.0;
            // The parabola keeps its parameter.
            prop_assert!((nurbs.point_at(t) - parabola.point_at(t)).norm() < EXACT * 200.0);
            let local = frame.local(&branch.point_at(t));
            prop_assert!(((local.x / a).powi(2) - (local.y / b).powi(2) - 1.0).abs() < 1e-10 * (local.x / a).powi(2));
            prop_assert!(local.x > 0.0);
        }
    }

    #[test]
    fn quadrics_and_tori_lie_on_their_equations(frame in frames(), r in 0.5..5.0f64, big in 5.5..9.0f64, u in angles(), v in angles(), slope in 0.1..1.2f64) {
        let scale = 30.0;
        let height = (v.0, v.1);
        let cylinder = Surface::Cylinder { frame, radius: r };
        let nurbs = cylinder.to_nurbs(u, height).expect("a good box");
        prop_assert_eq!(nurbs.domain(), (u, height));
        let from_cylinder = |p: &Point3<f64>| { let l = frame.local(p); (l.x.hypot(l.y) - r).abs() };
        prop_assert!(off(&nurbs, from_cylinder) < EXACT * scale);
        prop_assert!(corners_off(&cylinder, &nurbs) < EXACT * scale);

        let cone = Surface::Cone { frame, radius: r, semi_angle: slope };
        let nurbs = cone.to_nurbs(u, (0.0, 4.0)).expect("a good box");
        let from_cone = |p: &Point3<f64>| { let l = frame.local(p); (l.x.hypot(l.y) - r - l.z * slope.tan()).abs() };
        prop_assert!(off(&nurbs, from_cone) < EXACT * scale);
        prop_assert!(corners_off(&cone, &nurbs) < EXACT * scale);

        let sphere = Surface::Sphere { frame, radius: r };
        let nurbs = sphere.to_nurbs(u, (-FRAC_PI_2, 1.0)).expect("a good box");
        prop_assert!(off(&nurbs, |p| (frame.local(p).norm() - r).abs()) < EXACT * scale);
        prop_assert!(corners_off(&sphere, &nurbs) < EXACT * scale);

        let torus = Surface::Torus { frame, major_radius: big, minor_radius: r };
        let nurbs = torus.to_nurbs(u, v).expect("a good box");
        let from_torus = |p: &Point3<f64>| { let l = frame.local(p); ((l.x.hypot(l.y) - big).hypot(l.z) - r).abs() };
        prop_assert!(off(&nurbs, from_torus) < EXACT * scale);
        prop_assert!(corners_off(&torus, &nurbs) < EXACT * scale);
    }

    #[test]
    fn planes_and_pieces_of_splines_keep_their_parameters(frame in frames(), u0 in 0.0..0.4f64, u1 in 0.6..1.0f64, x in -3.0..3.0f64) {
        let plane = Surface::Plane(frame);
        let nurbs = plane.to_nurbs((u0, u1), (x, x + 2.0)).expect("a good box");
        let middle = (0.5 * (u0 + u1), x + 0.7);
        prop_assert!((nurbs.point(middle.0, middle.1) - plane.point(middle.0, middle.1)).norm() < EXACT * 30.0);
        let knots = || KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]).expect("good knots");
        let net = (0..16).map(|k| [f64::from(k / 4), f64::from(k % 4), x * f64::from((k * 7) % 5), 1.0]).collect();
        let whole = Surface::Nurbs(NurbsSurface::new(knots(), knots(), net).expect("a good net"));
        let part = whole.to_nurbs((u0, u1), (0.1, 0.9)).expect("a good box");
        prop_assert_eq!(part.domain(), ((u0, u1), (0.1, 0.9)));
        for (a, b) in [(u0, 0.1), (0.5, 0.5), (u1, 0.9), (0.45, 0.3)] {
            prop_assert!((part.point(a, b) - whole.point(a, b)).norm() < 1e-12);
        }
    }
}

#[test]
fn what_has_no_exact_form_is_refused_by_name() {
    let frame = Frame::from_axis(Point3::origin(), Vector3::z(), None).expect("axes");
    let circle = Curve::Circle { frame, radius: 2.0 };
    let offset = Curve::Offset { basis: Box::new(circle.clone()), distance: 0.5, direction: Vector3::z() };
    assert!(offset.to_nurbs((0.0, 1.0)).expect_err("no form").to_string().contains("offset"));
    let surface = Surface::Offset { basis: Box::new(Surface::Plane(frame)), distance: 1.0 };
    assert!(surface.to_nurbs((0.0, 1.0), (0.0, 1.0)).is_err());
    assert!(circle.to_nurbs((1.0, 1.0)).is_err() && circle.to_nurbs((0.0, f64::INFINITY)).is_err());
    // A piece against its basis: from 90° to 30°.
    let piece = Trimmed { basis: Box::new(circle), start: 0.5, end: 1.5, forward: false };
    let curve = Curve::Trimmed(piece);
    let nurbs = curve.to_nurbs(curve.domain()).expect("an arc");
    assert_eq!(nurbs.domain(), (-1.5, -0.5));
    assert!((nurbs.point_at(-1.5) - curve.point_at(-1.5)).norm() < 1e-14);
    assert!((nurbs.point_at(-0.5) - curve.point_at(-0.5)).norm() < 1e-14);
}
