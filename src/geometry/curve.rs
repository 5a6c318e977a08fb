//! Curves in space.
//!
//! Each is parametrised as ISO 10303-42 says, with angles in radians. A curve here is unbounded or
//! closed where the standard's is; an edge bounds it by its vertices.

use super::bounded::{Composite, Trimmed};
use super::nurbs::NurbsCurve3;
use crate::math::{Frame, Point3, Vector3};

/// A curve of ISO 10303-42 clause 4.4.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// `origin + t · direction`, the direction with its magnitude.
    Line {
        /// Point at `t = 0`.
        origin: Point3<f64>,
        /// Derivative; not zero.
        direction: Vector3<f64>,
    },
    /// `origin + radius (cos t · x + sin t · y)`.
    Circle {
        /// Centre and plane.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
    },
    /// `origin + semi_axis_1 cos t · x + semi_axis_2 sin t · y`.
    Ellipse {
        /// Centre and plane; the first axis runs along the first semi-axis.
        frame: Frame,
        /// First semi-axis, positive; need not be the greater.
        semi_axis_1: f64,
        /// Second semi-axis, positive.
        semi_axis_2: f64,
    },
    /// `origin + focal_distance (t² x + 2 t y)`.
    Parabola {
        /// Vertex and plane; the first axis points from the vertex to the focus.
        frame: Frame,
        /// Distance of the focus from the vertex, positive.
        focal_distance: f64,
    },
    /// `origin + semi_axis cosh t · x + semi_imaginary_axis sinh t · y`: the branch on the side of `x`.
    Hyperbola {
        /// Centre and plane; the first axis points to the vertex.
        frame: Frame,
        /// Distance of the vertex from the centre, positive.
        semi_axis: f64,
        /// Imaginary semi-axis, positive.
        semi_imaginary_axis: f64,
    },
    /// A B-spline curve in any of its forms.
    Nurbs(NurbsCurve3),
    /// Straight pieces between points, as a B-spline curve of degree one with the knots 0, 1, 2, ….
    Polyline(NurbsCurve3),
    /// A piece of a curve.
    Trimmed(Trimmed<Curve>),
    /// Curves end to end.
    Composite(Composite<Curve>),
    /// `basis(t) + distance · (direction × tangent) / |direction × tangent|`; not defined where the tangent
    /// has the reference direction.
    Offset {
        /// The curve that is left by the distance.
        basis: Box<Curve>,
        /// Signed distance.
        distance: f64,
        /// Reference direction, unit length.
        direction: Vector3<f64>,
    },
}

impl Curve {
    /// The selector and report word for this kind: `line`, `circle`, …, `b_spline`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Line { .. } => "line",
            Self::Circle { .. } => "circle",
            Self::Ellipse { .. } => "ellipse",
            Self::Parabola { .. } => "parabola",
            Self::Hyperbola { .. } => "hyperbola",
            Self::Nurbs(_) => "b_spline",
            Self::Polyline(_) => "polyline",
            Self::Trimmed(_) => "trimmed",
            Self::Composite(_) => "composite",
            Self::Offset { .. } => "offset",
        }
    }
}
