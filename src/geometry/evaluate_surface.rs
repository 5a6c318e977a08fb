//! Points and derivatives of every surface.

use super::nurbs::Wrap;
use super::surface::PatchGrid;
use super::{Surface, SurfaceDerivatives};
use crate::math::{Frame, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Distance of opposite borders of a B-spline surface, relative to its box, at which it counts as closed.
const CLOSED: f64 = 1e-7;

/// Part of the domain over which the second derivative of an offset is a difference, or of one where the
/// domain is endless: the cube root of the rounding error balances both errors of a difference.
const DIFFERENCE: f64 = 1e-5;
/// Sine of the angle between tangents below which a normal is not one: a hundred rounding errors.
const SINGULAR: f64 = 1e-14;
/// Places at which opposite borders of a composite surface are compared.
const BORDER_SAMPLES: usize = 8;

/// Where a surface repeats itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repetition {
    starts: (f64, f64),
    periods: (Option<f64>, Option<f64>),
}

impl Repetition {
    /// Parameters within the domain of the directions that repeat themselves.
    #[must_use]
    pub fn wrapped(&self, u: f64, v: f64) -> (f64, f64) {
        let wrap = |x: f64, start: f64, period: Option<f64>| match period {
            Some(p) if !(x >= start && x <= start + p) => start + (x - start).rem_euclid(p),
            _ => x,
        };
        (wrap(u, self.starts.0, self.periods.0), wrap(v, self.starts.1, self.periods.1))
    }
}

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
            Self::Offset { basis, distance } => offset(basis, *distance, u, v, self.domain()),
            Self::Trimmed { basis, forward, .. } => {
                let (u, v) = (if forward[0] { u } else { -u }, if forward[1] { v } else { -v });
                let (u, v) = basis.wrapped(u, v);
                stretched(basis.derivatives(u, v), forward.map(|f| if f { 1.0 } else { -1.0 }))
            }
            Self::CurveBounded { basis } => basis.derivatives(u, v),
            Self::Composite(grid) => {
                let (patch, (u, v), factors) = grid.locate(u, v);
                stretched(patch.derivatives(u, v), factors)
            }
        }
    }

    /// Parameters within the domain of the directions that repeat themselves.
    #[must_use]
    pub fn wrapped(&self, u: f64, v: f64) -> (f64, f64) {
        self.repetition().wrapped(u, v)
    }

    /// Where the surface repeats itself, for many parameters: a B-spline looks at its whole net to tell.
    #[must_use]
    pub fn repetition(&self) -> Repetition {
        let ((u, _), (v, _)) = self.domain();
        Repetition { starts: (u, v), periods: self.periods() }
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
            Self::Offset { basis, .. } | Self::CurveBounded { basis } => basis.domain(),
            Self::Trimmed { u, v, forward, .. } => {
                let side =
                    |(low, high): (f64, f64), forward| if forward { (low, high) } else { (-high, -low) };
                (side(*u, forward[0]), side(*v, forward[1]))
            }
            Self::Composite(grid) => {
                let (columns, rows) = grid.shape();
                ((0.0, columns as f64), (0.0, rows as f64))
            }
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
            Self::Offset { basis, .. } | Self::CurveBounded { basis } => basis.periods(),
            Self::Trimmed { basis, u, v, .. } => {
                let whole = |(low, high): (f64, f64), period: Option<f64>| {
                    period.filter(|p| (high - low - p).abs() <= CLOSED * p)
                };
                let (pu, pv) = basis.periods();
                (whole(*u, pu), whole(*v, pv))
            }
            Self::Composite(grid) => {
                let (columns, rows) = grid.shape();
                let (pu, pv) = if grid.patches().len() == 1 {
                    grid.patches()[0].surface.periods()
                } else {
                    (None, None)
                };
                let (u, v) = (columns as f64, rows as f64);
                (
                    pu.map(|_| u).or_else(|| self.meets(|s| ((0.0, s * v), (u, s * v))).then_some(u)),
                    pv.map(|_| v).or_else(|| self.meets(|s| ((s * u, 0.0), (s * u, v))).then_some(v)),
                )
            }
        }
    }

    /// Whether opposite borders, given as pairs of parameters by a share of their length, meet.
    fn meets(&self, pair: impl Fn(f64) -> ((f64, f64), (f64, f64))) -> bool {
        let mut size = 0.0f64;
        let mut off = 0.0f64;
        let mut first: Option<Point3<f64>> = None;
        for i in 0..=BORDER_SAMPLES {
            let ((u0, v0), (u1, v1)) = pair(i as f64 / BORDER_SAMPLES as f64);
            let (a, b) = (self.point(u0, v0), self.point(u1, v1));
            let middle = self.point(0.5 * (u0 + u1), 0.5 * (v0 + v1));
            off = off.max((a - b).norm());
            size = size.max((a - *first.get_or_insert(a)).norm()).max((a - middle).norm());
        }
        off <= CLOSED * size
    }

    /// The directions in which the surface repeats.
    #[must_use]
    pub fn wrap(&self) -> Wrap {
        let (u, v) = self.periods();
        Wrap { u: u.is_some(), v: v.is_some() }
    }
}

/// Derivatives by parameters that run as others do, times factors.
fn stretched(at: SurfaceDerivatives, [a, b]: [f64; 2]) -> SurfaceDerivatives {
    let SurfaceDerivatives { point, du, dv, duu, duv, dvv } = at;
    SurfaceDerivatives {
        point,
        du: du * a,
        dv: dv * b,
        duu: duu * (a * a),
        duv: duv * (a * b),
        dvv: dvv * (b * b),
    }
}

/// Point and derivatives of an offset surface. First derivatives are exact, by the derivative of the normal;
/// the second are differences of them. Where the basis has no normal, that of a place a little inside its
/// domain is taken.
fn offset(
    basis: &Surface,
    distance: f64,
    u: f64,
    v: f64,
    (us, vs): ((f64, f64), (f64, f64)),
) -> SurfaceDerivatives {
    let step =
        |(start, end): (f64, f64)| DIFFERENCE * if (end - start).is_finite() { end - start } else { 1.0 };
    let (hu, hv) = (step(us), step(vs));
    let first = |u: f64, v: f64| {
        let at = basis.derivatives(u, v);
        let cross = at.cross();
        // The sine of the angle between the tangents, times their lengths, against rounding.
        if cross.norm() <= SINGULAR * at.du.norm() * at.dv.norm() || cross.norm_squared() == 0.0 {
            let inside = |x: f64, (start, end): (f64, f64), h: f64| {
                if x + h <= end || x - h < start { x + h } else { x - h }
            };
            let normal = basis.derivatives(inside(u, us, hu), inside(v, vs, hv)).normal();
            let away = normal.unwrap_or_else(Vector3::zeros) * distance;
            return (at.point + away, at.du, at.dv);
        }
        let (length, n) = (cross.norm(), cross.normalize());
        let turn = |change: Vector3<f64>| (change - n * n.dot(&change)) / length * distance;
        let nu = turn(at.duu.cross(&at.dv) + at.du.cross(&at.duv));
        let nv = turn(at.duv.cross(&at.dv) + at.du.cross(&at.dvv));
        (at.point + n * distance, at.du + nu, at.dv + nv)
    };
    let (point, du, dv) = first(u, v);
    let between = |x: f64, (start, end): (f64, f64), h: f64| ((x - h).max(start), (x + h).min(end));
    let ((u0, u1), (v0, v1)) = (between(u, us, hu), between(v, vs, hv));
    let (a, b) = (first(u0, v), first(u1, v));
    let (c, d) = (first(u, v0), first(u, v1));
    let (ru, rv) = (1.0 / (u1 - u0).max(f64::MIN_POSITIVE), 1.0 / (v1 - v0).max(f64::MIN_POSITIVE));
    SurfaceDerivatives { point, du, dv, duu: (b.1 - a.1) * ru, duv: (d.1 - c.1) * rv, dvv: (d.2 - c.2) * rv }
}

impl PatchGrid {
    /// The surface under parameters, the parameters on it, and the derivatives of these.
    #[must_use]
    pub fn locate(&self, u: f64, v: f64) -> (&Surface, (f64, f64), [f64; 2]) {
        let (columns, rows) = self.shape();
        let cell = |x: f64, count: usize| (x.max(0.0).floor() as usize).min(count - 1);
        let (i, j) = (cell(u, columns), cell(v, rows));
        let patch = &self.patches()[i * rows + j];
        let (us, vs) = patch.surface.domain();
        let along = |into: f64, (start, end): (f64, f64), forward: bool| {
            if forward {
                (start + into * (end - start), end - start)
            } else {
                (end - into * (end - start), start - end)
            }
        };
        let (u, du) = along(u - i as f64, us, patch.forward[0]);
        let (v, dv) = along(v - j as f64, vs, patch.forward[1]);
        (&patch.surface, (u, v), [du, dv])
    }

    /// Parameters of the grid of parameters on one of its patches.
    #[must_use]
    pub fn parameters_on(&self, patch: usize, (u, v): (f64, f64)) -> (f64, f64) {
        let rows = self.shape().1;
        let of = &self.patches()[patch];
        let (us, vs) = of.surface.domain();
        let share = |x: f64, (start, end): (f64, f64), forward: bool| {
            let share = ((x - start) / (end - start)).clamp(0.0, 1.0);
            if forward { share } else { 1.0 - share }
        };
        (
            (patch / rows) as f64 + share(u, us, of.forward[0]),
            (patch % rows) as f64 + share(v, vs, of.forward[1]),
        )
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
