//! Curves in the parameter plane of a surface.

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
    /// A B-spline curve.
    Nurbs(NurbsCurve2),
}
