//! Conic arcs (IGES 5.3 section 4.5) by their six coefficients, wherever their axes lie.

use super::error::ReadError;
use crate::geometry::Curve;
use crate::math::{Frame, Matrix2, Point2, Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Part of the greatest coefficient below which the determinant of the quadratic part counts as zero.
const PARABOLIC: f64 = 1e-10;

/// `a x² + b x y + c y² + d x + e y + f = 0` between two of its points, in the plane `z`.
///
/// An ellipse runs counter-clockwise from its start; the others run from start to end.
pub(super) fn conic(
    [a, b, c, d, e, f]: [f64; 6],
    z: f64,
    start: Point2<f64>,
    end: Point2<f64>,
) -> Result<(Curve, (f64, f64)), ReadError> {
    let quadratic = Matrix2::new(a, 0.5 * b, 0.5 * b, c);
    let linear = Vector2::new(d, e);
    let size = quadratic.abs().max();
    if !(size > 0.0 && size.is_finite()) {
        return Err(ReadError::NoConic);
    }
    let axes = axes(&quadratic);
    if quadratic.determinant().abs() <= PARABOLIC * size * size {
        return parabola(&axes, &linear, f, z, start, end);
    }
    let center = quadratic.try_inverse().map(|inverse| inverse * linear * -0.5).ok_or(ReadError::NoConic)?;
    let rest = f + 0.5 * linear.dot(&center);
    let [x, y] = axes.map(|axis| axis.direction);
    match axes.map(|axis| -rest / axis.bend) {
        [p, q] if p > 0.0 && q > 0.0 => Ok(ellipse(center, x, [p.sqrt(), q.sqrt()], z, start, end)),
        [p, q] if p > 0.0 => hyperbola(center, x, [p.sqrt(), (-q).sqrt()], z, start, end),
        [p, q] if q > 0.0 => hyperbola(center, y, [q.sqrt(), (-p).sqrt()], z, start, end),
        _ => Err(ReadError::NoConic),
    }
}

/// A principal direction of a quadratic form and its value along it.
#[derive(Debug, Clone, Copy)]
struct Axis {
    direction: Vector2<f64>,
    bend: f64,
}

fn axes(quadratic: &Matrix2<f64>) -> [Axis; 2] {
    let angle = 0.5 * (2.0 * quadratic[(0, 1)]).atan2(quadratic[(0, 0)] - quadratic[(1, 1)]);
    let x = Vector2::new(angle.cos(), angle.sin());
    [x, left(&x)].map(|direction| Axis { direction, bend: direction.dot(&(quadratic * direction)) })
}

fn left(x: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-x.y, x.x)
}

/// The frame in the plane `z` with a first axis, seen from above or, when `y` is to the right of `x`, from below.
fn frame(origin: Vector2<f64>, x: Vector2<f64>, y: Vector2<f64>, z: f64) -> Frame {
    let up = x.perp(&y).signum();
    Frame {
        origin: Point3::new(origin.x, origin.y, z),
        x: Vector3::new(x.x, x.y, 0.0),
        y: Vector3::new(y.x, y.y, 0.0),
        z: Vector3::new(0.0, 0.0, up),
    }
}

fn ellipse(
    center: Vector2<f64>,
    x: Vector2<f64>,
    [p, q]: [f64; 2],
    z: f64,
    start: Point2<f64>,
    end: Point2<f64>,
) -> (Curve, (f64, f64)) {
    // The first semi-axis is the greater, as others expect it.
    let (x, p, q) = if p >= q { (x, p, q) } else { (left(&x), q, p) };
    let y = left(&x);
    let angle = |point: Point2<f64>| {
        let arm = point.coords - center;
        (y.dot(&arm) / q).atan2(x.dot(&arm) / p)
    };
    let from = angle(start);
    let way = (angle(end) - from).rem_euclid(TAU);
    let whole = (start - end).norm() <= f64::EPSILON * (p + q) || way == 0.0;
    let curve = Curve::Ellipse { frame: frame(center, x, y, z), semi_axis_1: p, semi_axis_2: q };
    (curve, (from, from + if whole { TAU } else { way }))
}

fn hyperbola(
    center: Vector2<f64>,
    x: Vector2<f64>,
    [p, q]: [f64; 2],
    z: f64,
    start: Point2<f64>,
    end: Point2<f64>,
) -> Result<(Curve, (f64, f64)), ReadError> {
    let x = x * x.dot(&(start.coords - center)).signum();
    let parameter = |y: &Vector2<f64>, point: Point2<f64>| (y.dot(&(point.coords - center)) / q).asinh();
    let (y, range) = ascending(&x, |y| (parameter(y, start), parameter(y, end)))?;
    Ok((Curve::Hyperbola { frame: frame(center, x, y, z), semi_axis: p, semi_imaginary_axis: q }, range))
}

/// The second axis, to the left or to the right of the first, along which the parameters of start and end ascend.
fn ascending(
    x: &Vector2<f64>,
    ends: impl Fn(&Vector2<f64>) -> (f64, f64),
) -> Result<(Vector2<f64>, (f64, f64)), ReadError> {
    for y in [left(x), -left(x)] {
        let (from, to) = ends(&y);
        if from < to {
            return Ok((y, (from, to)));
        }
    }
    Err(ReadError::NoExtent)
}

fn parabola(
    [first, second]: &[Axis; 2],
    linear: &Vector2<f64>,
    f: f64,
    z: f64,
    start: Point2<f64>,
    end: Point2<f64>,
) -> Result<(Curve, (f64, f64)), ReadError> {
    // One direction bends, the other is the axis.
    let (bent, straight) =
        if second.bend.abs() > first.bend.abs() { (second, first) } else { (first, second) };
    let (across, along) = (bent.direction, straight.direction);
    // With coordinates s along and t across: m t² + g s + h t + f = 0.
    let (m, g, h) = (bent.bend, linear.dot(&along), linear.dot(&across));
    if g == 0.0 {
        return Err(ReadError::NoConic);
    }
    let t = -0.5 * h / m;
    let s = -(m * t * t + h * t + f) / g;
    let vertex = along * s + across * t;
    // s - s0 = -(m / g) (t - t0)²: the focal distance is a quarter of the inverse.
    let focal = (-0.25 * g / m).abs();
    let x = along * (-g / m).signum();
    let parameter = |y: &Vector2<f64>, point: Point2<f64>| y.dot(&(point.coords - vertex)) / (2.0 * focal);
    let (y, range) = ascending(&x, |y| (parameter(y, start), parameter(y, end)))?;
    Ok((Curve::Parabola { frame: frame(vertex, x, y, z), focal_distance: focal }, range))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients after the plane was turned by an angle and moved.
    fn moved([a, b, c, d, e, f]: [f64; 6], angle: f64, shift: Vector2<f64>) -> [f64; 6] {
        let turn = Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
        let q = turn * Matrix2::new(a, 0.5 * b, 0.5 * b, c) * turn.transpose();
        let l = turn * Vector2::new(d, e);
        let linear = l - q * shift * 2.0;
        [
            q[(0, 0)],
            2.0 * q[(0, 1)],
            q[(1, 1)],
            linear.x,
            linear.y,
            f + shift.dot(&(q * shift)) - l.dot(&shift),
        ]
    }

    #[test]
    fn conics_pass_through_their_ends_wherever_they_lie() {
        // Coefficients and two points.
        let shapes = [
            ("ellipse", [0.25, 0.0, 1.0, 0.0, 0.0, -1.0], [[2.0, 0.0], [0.0, 1.0]]),
            ("parabola", [1.0, 0.0, 0.0, 0.0, -4.0, 0.0], [[-2.0, 1.0], [4.0, 4.0]]),
            ("hyperbola", [1.0, 0.0, -1.0, 0.0, 0.0, -1.0], [[2.0, 3f64.sqrt()], [1.0, 0.0]]),
        ];
        for (kind, coefficients, ends) in shapes {
            for (angle, shift) in [(0.0, [0.0, 0.0]), (0.7, [3.0, -2.0]), (-2.5, [0.1, 5.0])] {
                let shift = Vector2::new(shift[0], shift[1]);
                let turn = Matrix2::new(f64::cos(angle), -f64::sin(angle), f64::sin(angle), f64::cos(angle));
                let [p, q] = ends.map(|p| Point2::from(turn * Vector2::new(p[0], p[1]) + shift));
                let k = moved(coefficients, angle, shift);
                let (curve, (from, to)) = conic(k, 7.0, p, q).expect(kind);
                assert_eq!(curve.kind(), kind);
                assert!(from < to);
                for (t, point) in [(from, p), (to, q)] {
                    let found = curve.point_at(t);
                    assert!(
                        (found - Point3::new(point.x, point.y, 7.0)).norm() < 1e-9,
                        "{kind} {angle}: {found}"
                    );
                }
                let m = curve.point_at(0.4 * from + 0.6 * to);
                let value =
                    k[0] * m.x * m.x + k[1] * m.x * m.y + k[2] * m.y * m.y + k[3] * m.x + k[4] * m.y + k[5];
                assert!(value.abs() < 1e-8, "{kind} {angle}: {value}");
            }
        }
    }

    #[test]
    fn an_ellipse_runs_counter_clockwise_and_closes() {
        let circle = [1.0, 0.0, 1.0, 0.0, 0.0, -1.0];
        let (east, north) = (Point2::new(1.0, 0.0), Point2::new(0.0, 1.0));
        let length =
            |start, end| conic(circle, 0.0, start, end).map(|(_, (from, to))| to - from).expect("a circle");
        assert!((length(east, north) - 0.25 * TAU).abs() < 1e-12);
        assert!((length(north, east) - 0.75 * TAU).abs() < 1e-12);
        assert!((length(east, east) - TAU).abs() < 1e-12);
    }

    #[test]
    fn pairs_of_lines_are_no_conics() {
        let (p, q) = (Point2::new(0.0, 0.0), Point2::new(1.0, 1.0));
        assert!(conic([1.0, 0.0, -1.0, 0.0, 0.0, 0.0], 0.0, p, q).is_err());
        assert!(conic([0.0; 6], 0.0, p, q).is_err());
        assert!(conic([1.0, 0.0, 0.0, 0.0, 0.0, -1.0], 0.0, p, q).is_err());
    }
}
