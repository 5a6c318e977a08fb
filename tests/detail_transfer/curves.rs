//! Curves of every kind as splines.

use resurf::geometry::nurbs::{KnotVector, NurbsCurve3};
use resurf::geometry::{Composite, Curve, Segment, Trimmed};
use resurf::math::{Frame, Point3, Vector3};
use resurf::ops::detail_transfer::prepare;

fn frame() -> Frame {
    Frame::from_axis(Point3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 1.0), None).expect("a frame")
}

fn line() -> Curve {
    Curve::Line { origin: Point3::new(1.0, 0.0, 0.0), direction: Vector3::new(2.0, 0.0, 1.0) }
}

fn trimmed(basis: Curve, start: f64, end: f64, forward: bool) -> Curve {
    Curve::Trimmed(Trimmed { basis: Box::new(basis), start, end, forward })
}

/// Greatest distance at equal parameters.
fn off(curve: &Curve, tolerance: f64) -> f64 {
    let prepared = prepare(curve, "#1", tolerance).expect("a spline");
    let (start, end) = curve.domain();
    let domain = prepared.spline.domain();
    assert!((domain.0 - start).abs() <= 1e-12 && (domain.1 - end).abs() <= 1e-12);
    let at = |i: u32| start + (end - start) * f64::from(i) / 333.0;
    let distance = |t: f64| (prepared.spline.at(t)[0] - curve.point_at(t).coords).norm();
    let worst = (0..=333).map(|i| distance(at(i))).fold(0.0, f64::max);
    assert!(worst <= prepared.deviation.max(1e-12) * 1.5, "{worst:e} against {:e}", prepared.deviation);
    worst
}

#[test]
fn polynomial_curves_are_exact() {
    let parabola = Curve::Parabola { frame: frame(), focal_distance: 2.0 };
    let zigzag = [[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0], [2.0, 0.0, 0.0, 1.0]];
    let knots = KnotVector::clamped_uniform(1, 2, 0.0, 2.0).expect("good knots");
    let polyline = Curve::Polyline(NurbsCurve3::new(knots, zigzag.to_vec()).expect("a polyline"));
    for curve in [
        trimmed(line(), -1.0, 2.0, true),
        trimmed(line(), -1.0, 2.0, false),
        trimmed(parabola, -1.0, 0.5, true),
        polyline.clone(),
        trimmed(polyline, 0.25, 1.5, false),
    ] {
        assert_eq!(prepare(&curve, "#1", 1e-9).expect("a spline").deviation.to_bits(), 0);
        assert!(off(&curve, 1e-9) <= 1e-12);
    }
}

#[test]
fn conics_are_approximated_within_the_tolerance() {
    let circle = Curve::Circle { frame: frame(), radius: 25.0 };
    let ellipse = Curve::Ellipse { frame: frame(), semi_axis_1: 3.0, semi_axis_2: 8.0 };
    let hyperbola = Curve::Hyperbola { frame: frame(), semi_axis: 1.0, semi_imaginary_axis: 2.0 };
    let rational = Curve::Nurbs(circle.to_nurbs((0.0, 4.0)).expect("an arc"));
    for curve in [
        circle.clone(),
        ellipse,
        trimmed(hyperbola, -1.0, 1.0, true),
        trimmed(circle, 1.0, 7.0, false),
        rational,
    ] {
        for tolerance in [1e-2, 1e-6] {
            let worst = off(&curve, tolerance);
            assert!(worst > 0.0 && worst <= tolerance, "{worst:e}");
        }
    }
}

#[test]
fn composites_keep_their_joints() {
    let arc = Curve::Circle { frame: frame(), radius: 2.0 };
    let end = arc.point_at(1.0);
    let onwards = Curve::Line { origin: end, direction: Vector3::new(0.0, 0.0, 1.0) };
    let segments = vec![
        Segment { curve: arc, domain: (1.0, 3.0), forward: false },
        Segment { curve: onwards, domain: (0.0, 4.0), forward: true },
    ];
    let whole = Composite::new(segments).expect("two segments");
    let curve = Curve::Composite(whole);
    assert!(off(&curve, 1e-7) <= 1e-7);
    let spline = prepare(&curve, "#1", 1e-7).expect("a spline").spline;
    assert_eq!(spline.knots.multiplicity(2.0), 3);
}

#[test]
fn what_has_no_ends_is_refused() {
    let error = prepare(&line(), "#7", 1e-3).expect_err("a refusal");
    assert_eq!(
        (error.code(), error.to_string().as_str()),
        ("detail.unusable-curve", "#7: a line has no ends of its own")
    );
}
