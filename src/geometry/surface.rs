//! Surfaces in space.
//!
//! Each is parametrised as ISO 10303-42 says, with angles in radians.

use super::curve::Curve;
use super::nurbs::NurbsSurface;
use crate::math::{Frame, Vector3};

/// A surface of ISO 10303-42 clause 4.5.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// `origin + u x + v y`.
    Plane(Frame),
    /// `origin + radius (cos u · x + sin u · y) + v z`.
    Cylinder {
        /// Axis placement.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
    },
    /// `origin + (radius + v tan semi_angle)(cos u · x + sin u · y) + v z`.
    Cone {
        /// Axis placement.
        frame: Frame,
        /// Radius in the placement's plane; zero when the apex is the origin.
        radius: f64,
        /// Half opening angle in radians, within (-π/2, π/2) and not zero.
        semi_angle: f64,
    },
    /// `origin + radius cos v (cos u · x + sin u · y) + radius sin v · z`.
    Sphere {
        /// Axis placement.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
    },
    /// `origin + (major_radius + minor_radius cos v)(cos u · x + sin u · y) + minor_radius sin v · z`.
    Torus {
        /// Axis placement.
        frame: Frame,
        /// Distance of the tube's centre from the axis, positive.
        major_radius: f64,
        /// Radius of the tube, positive.
        minor_radius: f64,
    },
    /// `curve(u) + v · direction`.
    LinearExtrusion {
        /// Swept curve.
        curve: Box<Curve>,
        /// Derivative by `v`, with its magnitude.
        direction: Vector3<f64>,
    },
    /// `curve(v)` turned by the angle `u` about the axis through `frame.origin` along `frame.z`.
    Revolution {
        /// Turned curve.
        curve: Box<Curve>,
        /// Axis; its first axis is arbitrary.
        frame: Frame,
    },
    /// A B-spline surface in any of its forms.
    Nurbs(NurbsSurface),
}

impl Surface {
    /// The selector and report word for this kind: `plane`, `cylinder`, …, `b_spline`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::LinearExtrusion { .. } => "linear_extrusion",
            Self::Revolution { .. } => "revolution",
            Self::Nurbs(_) => "b_spline",
        }
    }
}
