//! Points and derivatives of every curve, in space and in the parameter plane.

use super::nurbs::NurbsCurve;
use super::{Curve, Curve2d};
use crate::math::{Point2, Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Distance of the ends of a bounded curve, relative to its size, at which it counts as closed.
const CLOSED: f64 = 1e-7;

impl Curve {
    /// Point at `t`.
    #[must_use]
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        match self {
            Self::Line { origin, direction } => origin + direction * t,
            Self::Circle { frame, radius } => frame.point(radius * t.cos(), radius * t.sin(), 0.0),
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                frame.point(semi_axis_1 * t.cos(), semi_axis_2 * t.sin(), 0.0)
            }
            Self::Nurbs(curve) | Self::Polyline(curve) => curve.point_at(t),
            _ => Point3::from(self.derivatives(t)[0]),
        }
    }

    /// Point as a vector from the origin, first and second derivative at `t`.
    ///
    /// The second derivative of an offset curve is a difference of first ones.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector3<f64>; 3] {
        match self {
            Self::Line { origin, direction } => [origin.coords + direction * t, *direction, Vector3::zeros()],
            Self::Circle { frame, radius } => conic(frame.origin, frame.x * *radius, frame.y * *radius, t),
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                conic(frame.origin, frame.x * *semi_axis_1, frame.y * *semi_axis_2, t)
            }
            Self::Parabola { frame, focal_distance } => {
                let (x, y) = (frame.x * *focal_distance, frame.y * *focal_distance);
                [frame.origin.coords + x * (t * t) + y * (2.0 * t), x * (2.0 * t) + y * 2.0, x * 2.0]
            }
            Self::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
                let (a, b) = (frame.x * *semi_axis, frame.y * *semi_imaginary_axis);
                let (sinh, cosh) = (t.sinh(), t.cosh());
                let away = a * cosh + b * sinh;
                [frame.origin.coords + away, a * sinh + b * cosh, away]
            }
            Self::Nurbs(curve) | Self::Polyline(curve) => curve.derivatives(t),
            Self::Trimmed(piece) => {
                let (t, sign) = piece.locate(t);
                turned_by(piece.basis.derivatives(piece.basis.wrapped_parameter(t)), sign)
            }
            Self::Composite(whole) => {
                let (curve, t, sign) = whole.locate(t);
                turned_by(curve.derivatives(t), sign)
            }
            Self::Offset { basis, distance, direction } => offset(
                |t| basis.derivatives(t),
                t,
                basis.domain(),
                |d, dd| {
                    let across = direction.cross(&d);
                    unit_with_derivative(across, direction.cross(&dd)).map(|n| n.map(|n| n * *distance))
                },
            ),
        }
    }

    /// First and last parameter; infinite for lines, parabolas and hyperbolas, `[0, 2π]` for closed conics.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Line { .. } | Self::Parabola { .. } | Self::Hyperbola { .. } => ENDLESS,
            Self::Circle { .. } | Self::Ellipse { .. } => (0.0, TAU),
            Self::Nurbs(curve) | Self::Polyline(curve) => curve.domain(),
            Self::Trimmed(piece) => piece.domain(),
            Self::Composite(whole) => whole.domain(),
            Self::Offset { basis, .. } => basis.domain(),
        }
    }

    /// Length of the parameter after which a closed curve repeats; a bounded curve counts as closed when its
    /// ends meet within 1e-7 of its size.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Line { .. } | Self::Parabola { .. } | Self::Hyperbola { .. } => None,
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Nurbs(curve) | Self::Polyline(curve) => {
                let (start, end) = curve.domain();
                curve.is_closed(CLOSED * curve.bounding_box().diagonal()).then_some(end - start)
            }
            Self::Trimmed(_) | Self::Composite(_) => {
                let (start, end) = self.domain();
                let thirds = [1.0, 2.0].map(|k| self.point_at(start + (end - start) * k / 3.0));
                let (first, last) = (self.point_at(start), self.point_at(end));
                let size = thirds
                    .iter()
                    .fold((thirds[1] - thirds[0]).norm(), |size, p| size.max((p - first).norm()));
                ((last - first).norm() <= CLOSED * size).then_some(end - start)
            }
            Self::Offset { basis, .. } => basis.period(),
        }
    }

    /// Point at `t`, where a closed bounded curve goes on past its ends from the start.
    #[must_use]
    pub fn point_wrapped(&self, t: f64) -> Point3<f64> {
        match self {
            Self::Line { .. } | Self::Circle { .. } | Self::Ellipse { .. } => self.point_at(t),
            _ => self.point_at(self.wrapped_parameter(t)),
        }
    }

    /// `t` within the domain of a bounded curve, as if it repeated itself.
    pub(crate) fn wrapped_parameter(&self, t: f64) -> f64 {
        match self {
            Self::Nurbs(curve) | Self::Polyline(curve) => curve.knots().wrapped(t),
            Self::Trimmed(_) | Self::Composite(_) => {
                let (start, end) = self.domain();
                if (start..=end).contains(&t) { t } else { start + (t - start).rem_euclid(end - start) }
            }
            Self::Offset { basis, .. } => basis.wrapped_parameter(t),
            _ => t,
        }
    }
}

const ENDLESS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Part of the domain over which the second derivative of an offset curve is a difference, or of one where
/// the curve is endless: the cube root of the rounding error balances both errors of a difference.
const DIFFERENCE: f64 = 1e-5;

/// Derivatives by a parameter that runs as the curve's, or against it.
fn turned_by<V: std::ops::Mul<f64, Output = V> + Copy>([point, first, second]: [V; 3], sign: f64) -> [V; 3] {
    [point, first * sign, second]
}

/// `v / |v|` and its derivative, from `v` and its derivative; `None` where it vanishes.
fn unit_with_derivative<const N: usize>(
    v: nalgebra::SVector<f64, N>,
    derivative: nalgebra::SVector<f64, N>,
) -> Option<[nalgebra::SVector<f64, N>; 2]> {
    let length = v.norm();
    let unit = v / length;
    (length > 0.0).then(|| [unit, (derivative - unit * unit.dot(&derivative)) / length])
}

/// Derivatives of a basis curve with an offset that `by` gives, with its derivative, from the first two of the
/// basis; none where the offset is not defined.
fn offset<const N: usize>(
    basis: impl Fn(f64) -> [nalgebra::SVector<f64, N>; 3],
    t: f64,
    (start, end): (f64, f64),
    by: impl Fn(nalgebra::SVector<f64, N>, nalgebra::SVector<f64, N>) -> Option<[nalgebra::SVector<f64, N>; 2]>,
) -> [nalgebra::SVector<f64, N>; 3] {
    let at = |t: f64| {
        let [point, d, dd] = basis(t);
        by(d, dd).map_or([point, d], |[away, turn]| [point + away, d + turn])
    };
    let [point, first] = at(t);
    let step = DIFFERENCE * if (end - start).is_finite() { end - start } else { 1.0 };
    // One-sided at the ends, so that no curve is asked beyond its domain.
    let (low, high) = ((t - step).max(start), (t + step).min(end));
    let second = (at(high)[1] - at(low)[1]) / (high - low).max(f64::MIN_POSITIVE);
    [point, first, second]
}

fn conic(origin: Point3<f64>, a: Vector3<f64>, b: Vector3<f64>, t: f64) -> [Vector3<f64>; 3] {
    let (sin, cos) = t.sin_cos();
    let radial = a * cos + b * sin;
    [origin.coords + radial, b * cos - a * sin, -radial]
}

impl Curve2d {
    /// Point at `t`.
    #[must_use]
    pub fn point_at(&self, t: f64) -> Point2<f64> {
        Point2::from(self.derivatives(t)[0])
    }

    /// Point as a vector from the origin, first and second derivative at `t`.
    ///
    /// The second derivative of an offset curve is a difference of first ones.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector2<f64>; 3] {
        let left = |v: &Vector2<f64>| Vector2::new(-v.y, v.x);
        match self {
            Self::Line { origin, direction } => [origin.coords + direction * t, *direction, Vector2::zeros()],
            Self::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
                let (a, b) = (x * *semi_axis_1, y * *semi_axis_2);
                let (sin, cos) = t.sin_cos();
                let radial = a * cos + b * sin;
                [center.coords + radial, b * cos - a * sin, -radial]
            }
            Self::Parabola { vertex, x, focal_distance } => {
                let (x, y) = (x * *focal_distance, left(x) * *focal_distance);
                [vertex.coords + x * (t * t) + y * (2.0 * t), x * (2.0 * t) + y * 2.0, x * 2.0]
            }
            Self::Hyperbola { center, x, semi_axis, semi_imaginary_axis } => {
                let (a, b) = (x * *semi_axis, left(x) * *semi_imaginary_axis);
                let (sinh, cosh) = (t.sinh(), t.cosh());
                let away = a * cosh + b * sinh;
                [center.coords + away, a * sinh + b * cosh, away]
            }
            Self::Nurbs(curve) | Self::Polyline(curve) => curve.derivatives(t),
            Self::Trimmed(piece) => {
                let (t, sign) = piece.locate(t);
                turned_by(piece.basis.derivatives(t), sign)
            }
            Self::Composite(whole) => {
                let (curve, t, sign) = whole.locate(t);
                turned_by(curve.derivatives(t), sign)
            }
            Self::Offset { basis, distance } => offset(
                |t| basis.derivatives(t),
                t,
                basis.domain(),
                |d, dd| unit_with_derivative(left(&d), left(&dd)).map(|n| n.map(|n| n * *distance)),
            ),
            Self::Scaled { basis, factors } => {
                basis.derivatives(t).map(|v| Vector2::new(v.x * factors[0], v.y * factors[1]))
            }
        }
    }

    /// First and last parameter; infinite for lines, parabolas and hyperbolas, `[0, 2π]` for closed conics.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Line { .. } | Self::Parabola { .. } | Self::Hyperbola { .. } => ENDLESS,
            Self::Ellipse { .. } => (0.0, TAU),
            Self::Nurbs(curve) | Self::Polyline(curve) => NurbsCurve::domain(curve),
            Self::Trimmed(piece) => piece.domain(),
            Self::Composite(whole) => whole.domain(),
            Self::Offset { basis, .. } | Self::Scaled { basis, .. } => basis.domain(),
        }
    }

    /// Whether the curve goes on past its domain as if it repeated itself.
    #[must_use]
    pub fn repeats(&self) -> bool {
        match self {
            Self::Ellipse { .. } => true,
            Self::Offset { basis, .. } | Self::Scaled { basis, .. } => basis.repeats(),
            _ => false,
        }
    }
}
