//! Closest points on the curves that have neither a closed form nor a control net.
//!
//! Newton's method on the squared distance from several seeds, each held to the domain and only ever downhill.
//! Finds a local minimum near one of the seeds; whether it is the global one rests with them.

use super::Curve;
use crate::math::{Frame, Point3};

/// Steps allowed; a good seed takes 3 to 6.
const MAX_STEPS: usize = 40;
/// Halvings of a step that leads uphill.
const MAX_HALVINGS: usize = 12;
/// Cosine between residual and tangent at which the foot is exact to rounding.
const COSINE_END: f64 = 1e-15;
/// Change of the parameter, relative to its size, that ends the search: a few rounding errors.
const STEP_END: f64 = 4.0 * f64::EPSILON;

/// Relative change of the squared distance below which it says nothing.
const NOISE: f64 = 16.0 * f64::EPSILON;

/// The nearest of the feet reached from some seeds: parameter and squared distance.
pub(super) fn nearest_foot(
    curve: &Curve,
    point: &Point3<f64>,
    seeds: impl IntoIterator<Item = f64>,
) -> (f64, f64) {
    let mut best = (0.0, f64::INFINITY);
    for seed in seeds {
        let found = foot(curve, point, seed);
        if found.1 < best.1 {
            best = found;
        }
    }
    best
}

/// The foot reached from a seed: parameter and squared distance.
fn foot(curve: &Curve, point: &Point3<f64>, seed: f64) -> (f64, f64) {
    let (start, end) = curve.domain();
    let held = |t: f64| if t.is_nan() { 0.0 } else { t.clamp(start, end) };
    let mut t = held(seed);
    let mut now = curve.derivatives(t);
    let mut square = (now[0] - point.coords).norm_squared();
    for _ in 0..MAX_STEPS {
        let residual = now[0] - point.coords;
        let (slope, speed) = (now[1].dot(&residual), now[1].norm_squared());
        let outward = (t <= start && slope > 0.0) || (t >= end && slope < 0.0);
        if outward || speed <= 0.0 || slope.abs() <= COSINE_END * (speed * square).sqrt() {
            break;
        }
        let bent = speed + now[2].dot(&residual);
        let mut step = -slope / if bent > 0.0 { bent } else { speed };
        let mut moved = false;
        for _ in 0..MAX_HALVINGS {
            let next = held(t + step);
            let trial = curve.derivatives(next);
            let trial_square = (trial[0] - point.coords).norm_squared();
            // Near the foot the distance is flat to rounding: there the slope tells what is nearer.
            let trial_slope = trial[1].dot(&(trial[0] - point.coords)).abs() / trial[1].norm();
            let flat =
                trial_square <= square + NOISE * square.max(point.coords.norm_squared() * f64::EPSILON);
            if trial_square < square - NOISE * square || flat && trial_slope < slope.abs() / speed.sqrt() {
                moved = (next - t).abs() > STEP_END * t.abs();
                (t, now, square) = (next, trial, trial_square);
                break;
            }
            step *= 0.5;
        }
        if !moved {
            break;
        }
    }
    (t, square)
}

/// Seeds on a parabola: the point at the same height, the vertex, and the points at the same distance along
/// the axis. The foot's parameter is a root of a cubic, and these stand in the basins of its three roots.
pub(super) fn parabola_seeds(frame: &Frame, focal_distance: f64, point: &Point3<f64>) -> [f64; 4] {
    let local = frame.local(point);
    let side = (local.x / focal_distance).max(0.0).sqrt();
    [local.y / (2.0 * focal_distance), 0.0, side, -side]
}

/// Seeds on a hyperbola, as on a parabola.
pub(super) fn hyperbola_seeds(frame: &Frame, a: f64, b: f64, point: &Point3<f64>) -> [f64; 4] {
    let local = frame.local(point);
    let side = (local.x / a).max(1.0).acosh();
    [(local.y / b).asinh(), 0.0, side, -side]
}

/// The parameter of the closest point of a polyline with the knots 0, 1, 2, …, and its squared distance.
pub(super) fn on_polyline(points: impl Iterator<Item = Point3<f64>>, point: &Point3<f64>) -> (f64, f64) {
    let mut best = (0.0, f64::INFINITY);
    let mut before: Option<Point3<f64>> = None;
    for (at, end) in points.enumerate() {
        if let Some(start) = before {
            let way = end - start;
            let square = way.norm_squared();
            let share = if square > 0.0 { ((point - start).dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 };
            let away = (start + way * share - point).norm_squared();
            if away < best.1 {
                best = ((at - 1) as f64 + share, away);
            }
        }
        before = Some(end);
    }
    best
}
