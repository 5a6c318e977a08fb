//! Curves in space.
//!
//! Each is parametrised as ISO 10303-42 says, with angles in radians. A curve here is unbounded or
//! closed where the standard's is; an edge bounds it by its vertices.

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
    /// A B-spline curve in any of its forms.
    Nurbs(NurbsCurve3),
}

impl Curve {
    /// The selector and report word for this kind: `line`, `circle`, `ellipse`, `b_spline`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Line { .. } => "line",
            Self::Circle { .. } => "circle",
            Self::Ellipse { .. } => "ellipse",
            Self::Nurbs(_) => "b_spline",
        }
    }
}
