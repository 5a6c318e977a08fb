//! Points and derivatives of every curve, in space and in the parameter plane.

use super::nurbs::{NurbsCurve, NurbsCurve3};
use super::{Curve, Curve2d};
use crate::math::{Point2, Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Distance of the ends of a B-spline curve, relative to its box, at which it counts as closed.
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
            Self::Nurbs(curve) => curve.point_at(t),
        }
    }

    /// Point as a vector from the origin, first and second derivative at `t`.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector3<f64>; 3] {
        match self {
            Self::Line { origin, direction } => [origin.coords + direction * t, *direction, Vector3::zeros()],
            Self::Circle { frame, radius } => conic(frame.origin, frame.x * *radius, frame.y * *radius, t),
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                conic(frame.origin, frame.x * *semi_axis_1, frame.y * *semi_axis_2, t)
            }
            Self::Nurbs(curve) => curve.derivatives(t),
        }
    }

    /// First and last parameter; infinite for a line, `[0, 2π]` for conics.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Line { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Circle { .. } | Self::Ellipse { .. } => (0.0, TAU),
            Self::Nurbs(curve) => curve.domain(),
        }
    }

    /// Length of the parameter after which a closed curve repeats; a B-spline counts as closed when its ends
    /// meet within 1e-7 of its size.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Line { .. } => None,
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Nurbs(curve) => {
                let (start, end) = curve.domain();
                curve.is_closed(CLOSED * curve.bounding_box().diagonal()).then_some(end - start)
            }
        }
    }

    /// Point at `t`, where a closed B-spline goes on past its ends from the start.
    #[must_use]
    pub fn point_wrapped(&self, t: f64) -> Point3<f64> {
        match self {
            Self::Nurbs(curve) => curve.point_at(wrapped_parameter(curve, t)),
            _ => self.point_at(t),
        }
    }
}

/// `t` within the domain of a curve that repeats itself.
fn wrapped_parameter(curve: &NurbsCurve3, t: f64) -> f64 {
    curve.knots().wrapped(t)
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
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector2<f64>; 3] {
        match self {
            Self::Line { origin, direction } => [origin.coords + direction * t, *direction, Vector2::zeros()],
            Self::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
                let (a, b) = (x * *semi_axis_1, y * *semi_axis_2);
                let (sin, cos) = t.sin_cos();
                let radial = a * cos + b * sin;
                [center.coords + radial, b * cos - a * sin, -radial]
            }
            Self::Nurbs(curve) => curve.derivatives(t),
        }
    }

    /// First and last parameter; infinite for a line, `[0, 2π]` for conics.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        match self {
            Self::Line { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Ellipse { .. } => (0.0, TAU),
            Self::Nurbs(curve) => NurbsCurve::domain(curve),
        }
    }
}
