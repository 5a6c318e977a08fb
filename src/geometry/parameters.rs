//! Parameters of points: closed forms for conics and quadrics, Newton's method for the others.
//!
//! The point need not lie on the curve or surface: the parameters are those of its closest point there, or,
//! with a seed, of the closest point near the seed. Without a seed, angles are given in `[0, 2π)`; with
//! one, in the turn around it, so that a walk along an edge does not jump at a seam.

use super::foot_on_curve::{hyperbola_seeds, nearest_foot, on_polyline, parabola_seeds};
use super::nurbs::{SearchRange, SurfaceLocator, foot_point};
use super::{Curve, Surface};
use crate::math::{Frame, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Samples of a sweep's profile in the search for a first guess; per span for B-splines.
const PROFILE_SAMPLES: usize = 8;
/// Steps of Newton's method on an ellipse.
const ELLIPSE_STEPS: usize = 50;
/// Greatest parameter of a parabola or hyperbola that is searched without a guess: ten times a hyperbola's
/// axes, nine focal distances.
const CONIC_REACH: f64 = 3.0;
/// Half the length of an unbounded profile that is searched, in units of its derivative.
const LINE_REACH: f64 = 1.0;

/// `angle` moved by whole turns of `period` to within half a one of `seed`.
#[must_use]
pub fn unwrapped(angle: f64, seed: f64, period: f64) -> f64 {
    angle + period * ((seed - angle) / period).round()
}

/// The angle of `(x, y)` in `[0, 2π)`, or in the turn round a seed.
fn angle(y: f64, x: f64, seed: Option<f64>) -> f64 {
    let angle = y.atan2(x);
    match seed {
        Some(seed) => unwrapped(angle, seed, TAU),
        None if angle < 0.0 => (angle + TAU).min(TAU.next_down()),
        None => angle,
    }
}

impl Curve {
    /// Parameter of the closest point, near `seed` where one is given.
    ///
    /// The centre of a conic gives the seed, or 0.
    #[must_use]
    pub fn parameter_of(&self, point: &Point3<f64>, seed: Option<f64>) -> f64 {
        match self {
            Self::Line { origin, direction } => (point - origin).dot(direction) / direction.norm_squared(),
            Self::Circle { frame, .. } => {
                let local = frame.local(point);
                if local.x == 0.0 && local.y == 0.0 {
                    return seed.unwrap_or(0.0);
                }
                angle(local.y, local.x, seed)
            }
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                let local = frame.local(point);
                let t = on_ellipse(*semi_axis_1, *semi_axis_2, local.x, local.y);
                angle(t.sin(), t.cos(), seed)
            }
            Self::Parabola { frame, focal_distance } => {
                nearest_foot(self, point, parabola_seeds(frame, *focal_distance, point)).0
            }
            Self::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
                nearest_foot(self, point, hyperbola_seeds(frame, *semi_axis, *semi_imaginary_axis, point)).0
            }
            Self::Nurbs(curve) => match seed {
                Some(seed) => curve.closest_from(point, seed).t,
                None => curve.closest(point).t,
            },
            Self::Polyline(curve) => on_polyline(curve.control_points(), point).0,
            Self::Trimmed(piece) => {
                let seed = seed.map(|seed| piece.locate(seed).0);
                piece.parameter_of(piece.basis.parameter_of(point, seed), piece.basis.period())
            }
            Self::Composite(whole) => {
                let mut best = (0.0, f64::INFINITY);
                for (at, segment) in whole.segments().iter().enumerate() {
                    let t = whole.parameter_on(at, segment.curve.parameter_of(point, None));
                    let away = (self.point_at(t) - point).norm_squared();
                    if away < best.1 {
                        best = (t, away);
                    }
                }
                best.0
            }
            Self::Offset { basis, .. } => {
                let seeds = [seed, Some(basis.parameter_of(point, seed))];
                nearest_foot(self, point, seeds.into_iter().flatten()).0
            }
        }
    }
}

/// Angle of the closest point of an ellipse: by symmetry in the first quadrant, where the search is monotone.
fn on_ellipse(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let (px, py) = (x.abs(), y.abs());
    // Root of f(t) = (a² - b²) sin t cos t - a px sin t + b py cos t, which is f(0) >= 0 >= f(π/2).
    let f = |t: f64| (a * a - b * b) * t.sin() * t.cos() - a * px * t.sin() + b * py * t.cos();
    let slope = |t: f64| (a * a - b * b) * (2.0 * t).cos() - a * px * t.cos() - b * py * t.sin();
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    let mut t = (py / b).atan2(px / a);
    for _ in 0..ELLIPSE_STEPS {
        let value = f(t);
        if value > 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope(t);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if value == 0.0 || (next - t).abs() <= f64::EPSILON {
            break;
        }
        t = next;
    }
    let (sin, cos) = t.sin_cos();
    sin.copysign(y).atan2(cos.copysign(x))
}

impl Surface {
    /// Parameters of the closest point, near `seed` where one is given.
    ///
    /// Where a parameter is not defined (a pole, the axis) it is the seed's, or 0.
    #[must_use]
    pub fn parameters_of(&self, point: &Point3<f64>, seed: Option<(f64, f64)>) -> (f64, f64) {
        match self {
            Self::Plane(frame) => {
                let local = frame.local(point);
                (local.x, local.y)
            }
            Self::Cylinder { frame, .. } => {
                let local = frame.local(point);
                (turn_angle(&local, seed), local.z)
            }
            Self::Cone { frame, radius, semi_angle } => on_cone(frame, *radius, *semi_angle, point, seed),
            Self::Sphere { frame, .. } => {
                let local = frame.local(point);
                (turn_angle(&local, seed), local.z.atan2(local.x.hypot(local.y)))
            }
            Self::Torus { frame, major_radius, minor_radius } => {
                on_torus(&frame.local(point), *major_radius, *minor_radius, seed)
            }
            Self::LinearExtrusion { curve, direction } => match seed {
                Some(seed) => self.searched(point, seed).0,
                None => self.best_of(point, extrusion_seeds(curve, direction, point)),
            },
            Self::Revolution { curve, frame } => match seed {
                Some(seed) => {
                    let (u, v) = self.searched(point, seed).0;
                    (unwrapped(u, seed.0, TAU), v)
                }
                None => self.best_of(point, revolution_seeds(curve, frame, point)),
            },
            Self::Nurbs(surface) => {
                let found = match seed {
                    Some(seed) => surface.closest_from(point, seed, self.wrap()),
                    None => SurfaceLocator::new(surface, self.wrap()).closest(point),
                };
                (found.u, found.v)
            }
            // The normals of an offset are those of its basis, so the feet have the same parameters; but on the
            // far side of a centre of curvature another foot of the basis may be the nearer one.
            Self::Offset { basis, .. } => {
                let on_basis = basis.parameters_of(point, seed);
                let away = |at: (f64, f64)| (self.point(at.0, at.1) - point).norm();
                let (searched, found) = self.searched(point, seed.unwrap_or(on_basis));
                if found < away(on_basis) { searched } else { on_basis }
            }
            Self::Trimmed { basis, u, v, forward } => {
                let turned =
                    |(u, v): (f64, f64)| (if forward[0] { u } else { -u }, if forward[1] { v } else { -v });
                let found = basis.parameters_of(point, seed.map(turned));
                let periods = basis.periods();
                let held = |x: f64, (low, high): (f64, f64), period: Option<f64>| {
                    period.map_or(x, |p| unwrapped(x, 0.5 * (low + high), p)).clamp(low, high)
                };
                turned((held(found.0, *u, periods.0), held(found.1, *v, periods.1)))
            }
            Self::CurveBounded { basis } => basis.parameters_of(point, seed),
            Self::Composite(grid) => {
                let mut best = ((0.0, 0.0), f64::INFINITY);
                for at in 0..grid.patches().len() {
                    let on_patch = grid.patches()[at].surface.parameters_of(point, None);
                    let found = grid.parameters_on(at, on_patch);
                    let away = (self.point(found.0, found.1) - point).norm_squared();
                    if away < best.1 {
                        best = (found, away);
                    }
                }
                best.0
            }
        }
    }

    /// Newton's method from a seed: parameters and distance.
    fn searched(&self, point: &Point3<f64>, seed: (f64, f64)) -> ((f64, f64), f64) {
        let (u, v) = self.domain();
        let range = SearchRange { u, v, wrap: self.wrap() };
        let found = foot_point(&|u, v| self.derivatives(u, v), &range, point, seed);
        ((found.u, found.v), found.distance)
    }

    /// The nearest of the foot points reached from several seeds.
    fn best_of(&self, point: &Point3<f64>, seeds: Vec<(f64, f64)>) -> (f64, f64) {
        let mut best = ((0.0, 0.0), f64::INFINITY);
        for seed in seeds {
            let found = self.searched(point, seed);
            if found.1 < best.1 {
                best = found;
            }
        }
        best.0
    }
}

fn turn_angle(local: &Vector3<f64>, seed: Option<(f64, f64)>) -> f64 {
    if local.x == 0.0 && local.y == 0.0 {
        return seed.map_or(0.0, |s| s.0);
    }
    angle(local.y, local.x, seed.map(|s| s.0))
}

/// The nearer of the two circles in the point's half plane and the opposite one: on a torus that meets itself
/// the inner part lies on the opposite one.
fn on_torus(local: &Vector3<f64>, major: f64, minor: f64, seed: Option<(f64, f64)>) -> (f64, f64) {
    let rho = local.x.hypot(local.y);
    let away = |rho: f64| ((rho - major).hypot(local.z) - minor).abs();
    let v = |rho: f64| angle(local.z, rho - major, seed.map(|s| s.1));
    if major < minor && away(-rho) < away(rho) {
        return (turn_angle(&Vector3::new(-local.x, -local.y, local.z), seed), v(-rho));
    }
    (turn_angle(local, seed), v(rho))
}

/// The nearer of the two generatrices in the point's half plane; beyond the apex the cone goes on with the
/// angle turned by π.
fn on_cone(
    frame: &Frame,
    radius: f64,
    semi_angle: f64,
    point: &Point3<f64>,
    seed: Option<(f64, f64)>,
) -> (f64, f64) {
    let local = frame.local(point);
    let rho = local.x.hypot(local.y);
    let slope = semi_angle.tan();
    let foot = |rho: f64| {
        let v = ((rho - radius) * slope + local.z) / (1.0 + slope * slope);
        (v, (radius + v * slope - rho).hypot(v - local.z))
    };
    let ((v, near), (beyond, far)) = (foot(rho), foot(-rho));
    let seed_u = seed.map(|s| s.0);
    if rho == 0.0 {
        (seed_u.unwrap_or(0.0), v)
    } else if far < near {
        (angle(-local.y, -local.x, seed_u), beyond)
    } else {
        (angle(local.y, local.x, seed_u), v)
    }
}

/// Parameters along a profile: a few on each span of a B-spline or on each quarter of a conic.
fn profile_samples(curve: &Curve) -> Vec<f64> {
    let spread = |low: f64, high: f64| {
        let part = (high - low) / PROFILE_SAMPLES as f64;
        (0..=PROFILE_SAMPLES).map(move |i| low + part * i as f64)
    };
    match curve {
        Curve::Line { .. } => spread(-LINE_REACH, LINE_REACH).collect(),
        Curve::Circle { .. } | Curve::Ellipse { .. } => {
            (0..4).flat_map(|q| spread(FRAC_PI_2 * f64::from(q), FRAC_PI_2 * f64::from(q + 1))).collect()
        }
        Curve::Parabola { .. } | Curve::Hyperbola { .. } => spread(-CONIC_REACH, CONIC_REACH).collect(),
        Curve::Composite(whole) => {
            whole.breaks().windows(2).flat_map(|pair| spread(pair[0], pair[1])).collect()
        }
        Curve::Trimmed(piece) => {
            let (start, end) = piece.domain();
            let inner = profile_samples(&piece.basis).into_iter().map(|t| piece.parameter_of(t, None));
            let mut all: Vec<f64> = inner.chain(spread(start, end)).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        }
        Curve::Offset { basis, .. } => profile_samples(basis),
        Curve::Nurbs(nurbs) | Curve::Polyline(nurbs) => {
            let knots = nurbs.knots();
            knots.spans().flat_map(|k| spread(knots.knots()[k], knots.knots()[k + 1])).collect()
        }
    }
}

/// The samples at which a value is least among its neighbours.
fn valleys(samples: &[f64], value: impl Fn(f64) -> f64) -> Vec<f64> {
    let values: Vec<f64> = samples.iter().map(|&t| value(t)).collect();
    let at = |i: usize| values.get(i).copied().unwrap_or(f64::INFINITY);
    let valley = |&i: &usize| values[i] <= at(i.wrapping_sub(1)) && values[i] <= at(i + 1);
    (0..samples.len()).filter(valley).map(|i| samples[i]).collect()
}

fn extrusion_seeds(curve: &Curve, direction: &Vector3<f64>, point: &Point3<f64>) -> Vec<(f64, f64)> {
    let square = direction.norm_squared();
    let along = |u: f64| (point - curve.point_at(u)).dot(direction) / square;
    let off = |u: f64| (point - curve.point_at(u) - direction * along(u)).norm_squared();
    valleys(&profile_samples(curve), off).into_iter().map(|u| (u, along(u))).collect()
}

fn revolution_seeds(curve: &Curve, frame: &Frame, point: &Point3<f64>) -> Vec<(f64, f64)> {
    let local = frame.local(point);
    let rho = local.x.hypot(local.y);
    let off = |v: f64| {
        let c = frame.local(&curve.point_at(v));
        (c.x.hypot(c.y) - rho).powi(2) + (c.z - local.z).powi(2)
    };
    let turn = |v: f64| {
        let c = frame.local(&curve.point_at(v));
        (local.y.atan2(local.x) - c.y.atan2(c.x)).rem_euclid(TAU)
    };
    valleys(&profile_samples(curve), off).into_iter().map(|v| (turn(v), v)).collect()
}
