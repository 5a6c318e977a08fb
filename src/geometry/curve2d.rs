//! Curves in the parameter plane of a surface.

use super::bounded::{Composite, Trimmed};
use super::nurbs::NurbsCurve2;
use crate::math::{Point2, Vector2};

/// A curve of ISO 10303-42 clause 4.4 in two dimensions; parametrised as its counterpart in space.
///
/// Coordinates are surface parameters: angles in radians, lengths in file units.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve2d {
    /// `origin + t · direction`.
    Line {
        /// Point at `t = 0`.
        origin: Point2<f64>,
        /// Derivative; not zero.
        direction: Vector2<f64>,
    },
    /// `center + semi_axis_1 cos t · x + semi_axis_2 sin t · y`; a circle when the semi-axes are equal.
    Ellipse {
        /// Centre.
        center: Point2<f64>,
        /// First axis, unit length.
        x: Vector2<f64>,
        /// Second axis, unit length, `x` turned by a right angle to the left.
        y: Vector2<f64>,
        /// First semi-axis, positive.
        semi_axis_1: f64,
        /// Second semi-axis, positive.
        semi_axis_2: f64,
    },
    /// `vertex + focal_distance (t² x + 2 t y)`, `y` being `x` turned by a right angle to the left.
    Parabola {
        /// Vertex.
        vertex: Point2<f64>,
        /// From the vertex to the focus, unit length.
        x: Vector2<f64>,
        /// Distance of the focus from the vertex, positive.
        focal_distance: f64,
    },
    /// `center + semi_axis cosh t · x + semi_imaginary_axis sinh t · y`, `y` being `x` turned by a right angle
    /// to the left.
    Hyperbola {
        /// Centre.
        center: Point2<f64>,
        /// From the centre to the vertex, unit length.
        x: Vector2<f64>,
        /// Distance of the vertex from the centre, positive.
        semi_axis: f64,
        /// Imaginary semi-axis, positive.
        semi_imaginary_axis: f64,
    },
    /// A B-spline curve.
    Nurbs(NurbsCurve2),
    /// Straight pieces between points, as a B-spline curve of degree one with the knots 0, 1, 2, ….
    Polyline(NurbsCurve2),
    /// A piece of a curve.
    Trimmed(Trimmed<Curve2d>),
    /// Curves end to end.
    Composite(Composite<Curve2d>),
    /// The curve moved by the distance to the left of its tangent.
    Offset {
        /// The curve that is left by the distance.
        basis: Box<Curve2d>,
        /// Signed distance.
        distance: f64,
    },
    /// `(factors[0] x, factors[1] y)` of another curve: one whose file counts a parameter in another unit, so
    /// that its circle is an ellipse with turned axes, and its offset none at all.
    Scaled {
        /// The curve as the file says it.
        basis: Box<Curve2d>,
        /// Factors of the coordinates, positive.
        factors: [f64; 2],
    },
}

impl Curve2d {
    /// The report word for this kind.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Line { .. } => "line",
            Self::Ellipse { .. } => "ellipse",
            Self::Parabola { .. } => "parabola",
            Self::Hyperbola { .. } => "hyperbola",
            Self::Nurbs(_) => "b_spline",
            Self::Polyline(_) => "polyline",
            Self::Trimmed(_) => "trimmed",
            Self::Composite(_) => "composite",
            Self::Offset { .. } => "offset",
            Self::Scaled { basis, .. } => basis.kind(),
        }
    }
}
