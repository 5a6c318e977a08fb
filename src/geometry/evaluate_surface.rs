//! Points and derivatives of every surface.

use super::nurbs::Wrap;
use super::{Surface, SurfaceDerivatives};
use crate::math::{Frame, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Distance of opposite borders of a B-spline surface, relative to its box, at which it counts as closed.
const CLOSED: f64 = 1e-7;

impl Surface {
    /// Point at `(u, v)`.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        match self {
            Self::Plane(frame) => frame.point(u, v, 0.0),
            Self::Cylinder { frame, radius } => frame.point(radius * u.cos(), radius * u.sin(), v),
            Self::Nurbs(surface) => surface.point(u, v),
            _ => self.derivatives(u, v).point,
        }
    }

    /// Point with partial derivatives to second order.
    #[must_use]
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        match self {
            Self::Plane(frame) => {
                let zero = Vector3::zeros();
                let point = frame.point(u, v, 0.0);
                SurfaceDerivatives { point, du: frame.x, dv: frame.y, duu: zero, duv: zero, dvv: zero }
            }
            Self::Cylinder { frame, radius } => turned(frame, u, [*radius, 0.0, 0.0], [v, 1.0, 0.0]),
            Self::Cone { frame, radius, semi_angle } => {
                let slope = semi_angle.tan();
                turned(frame, u, [radius + v * slope, slope, 0.0], [v, 1.0, 0.0])
            }
            Self::Sphere { frame, radius } => {
                let (sin, cos) = (radius * v.sin(), radius * v.cos());
                turned(frame, u, [cos, -sin, -cos], [sin, cos, -sin])
            }
            Self::Torus { frame, major_radius, minor_radius } => {
                let (sin, cos) = (minor_radius * v.sin(), minor_radius * v.cos());
                turned(frame, u, [major_radius + cos, -sin, -cos], [sin, cos, -sin])
            }
            Self::LinearExtrusion { curve, direction } => {
                let [c, du, duu] = curve.derivatives(u);
                let zero = Vector3::zeros();
                let point = Point3::from(c + direction * v);
                SurfaceDerivatives { point, du, dv: *direction, duu, duv: zero, dvv: zero }
            }
            Self::Revolution { curve, frame } => {
                let [c, d1, d2] = curve.derivatives(v);
                let (sin, cos) = u.sin_cos();
                let z = frame.z;
                // Rodrigues: the part along the axis stays, the part across it turns.
                let turn = |p: Vector3<f64>| {
                    let along = z * z.dot(&p);
                    along + (p - along) * cos + z.cross(&p) * sin
                };
                let arm = turn(c - frame.origin.coords);
                let du = z.cross(&arm);
                let dv = turn(d1);
                let point = frame.origin + arm;
                SurfaceDerivatives { point, du, dv, duu: z.cross(&du), duv: z.cross(&dv), dvv: turn(d2) }
            }
            Self::Nurbs(surface) => surface.derivatives(u, v),
        }
    }

    /// Unit normal `du × dv / |du × dv|`; `None` where the parametrisation is singular.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<Vector3<f64>> {
        self.derivatives(u, v).normal()
    }

    /// First and last `u`, first and last `v`; infinite where the surface is.
    #[must_use]
    pub fn domain(&self) -> ((f64, f64), (f64, f64)) {
        let endless = (f64::NEG_INFINITY, f64::INFINITY);
        match self {
            Self::Plane(_) => (endless, endless),
            Self::Cylinder { .. } | Self::Cone { .. } => ((0.0, TAU), endless),
            Self::Sphere { .. } => ((0.0, TAU), (-FRAC_PI_2, FRAC_PI_2)),
            Self::Torus { .. } => ((0.0, TAU), (0.0, TAU)),
            Self::LinearExtrusion { curve, .. } => (curve.domain(), endless),
            Self::Revolution { curve, .. } => ((0.0, TAU), curve.domain()),
            Self::Nurbs(surface) => surface.domain(),
        }
    }

    /// Lengths of `u` and of `v` after which the surface repeats; a B-spline counts as closed when its
    /// opposite borders meet within 1e-7 of its size.
    #[must_use]
    pub fn periods(&self) -> (Option<f64>, Option<f64>) {
        match self {
            Self::Plane(_) => (None, None),
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => (Some(TAU), None),
            Self::Torus { .. } => (Some(TAU), Some(TAU)),
            Self::LinearExtrusion { curve, .. } => (curve.period(), None),
            Self::Revolution { curve, .. } => (Some(TAU), curve.period()),
            Self::Nurbs(surface) => {
                let tolerance = CLOSED * surface.bounding_box().diagonal();
                let ((u0, u1), (v0, v1)) = surface.domain();
                (
                    surface.is_closed_u(tolerance).then_some(u1 - u0),
                    surface.is_closed_v(tolerance).then_some(v1 - v0),
                )
            }
        }
    }

    /// The directions in which the surface repeats.
    #[must_use]
    pub fn wrap(&self) -> Wrap {
        let (u, v) = self.periods();
        Wrap { u: u.is_some(), v: v.is_some() }
    }
}

/// A surface of revolution `rho(v)` off the axis and `z(v)` along it, each given with two derivatives.
fn turned(frame: &Frame, u: f64, rho: [f64; 3], z: [f64; 3]) -> SurfaceDerivatives {
    let (sin, cos) = u.sin_cos();
    let out = frame.x * cos + frame.y * sin;
    let along = frame.y * cos - frame.x * sin;
    SurfaceDerivatives {
        point: frame.origin + out * rho[0] + frame.z * z[0],
        du: along * rho[0],
        dv: out * rho[1] + frame.z * z[1],
        duu: out * -rho[0],
        duv: along * rho[1],
        dvv: out * rho[2] + frame.z * z[2],
    }
}
