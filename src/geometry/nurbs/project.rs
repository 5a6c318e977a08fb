//! Closest points on B-spline curves and surfaces.
//!
//! Newton's method on the squared distance with the full Hessian, where that is positive definite, else
//! Gauss-Newton (The NURBS Book 6.1), held to the domain or wrapped round it, and only ever downhill.
//! Seeds without a guess come from a branch and bound over spans: a span lies in the box of the control
//! points over it, so that a span whose box is further than the best point found needs no look.

use super::evaluate::SurfaceDerivatives;
use super::{KnotVector, NurbsCurve3, NurbsSurface};
use crate::math::{BoundingBox, Point3, Vector3};
use std::cell::OnceCell;

/// A closest point on a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveProjection {
    /// Parameter, within the domain.
    pub t: f64,
    /// Point of the curve.
    pub point: Point3<f64>,
    /// Its distance from the point that was projected.
    pub distance: f64,
}

/// A closest point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceProjection {
    /// First parameter, within the domain.
    pub u: f64,
    /// Second parameter, within the domain.
    pub v: f64,
    /// Point of the surface.
    pub point: Point3<f64>,
    /// Derivatives by `u` and `v` there.
    pub tangents: [Vector3<f64>; 2],
    /// Its distance from the point that was projected.
    pub distance: f64,
}

/// Directions in which a search may pass over the seam of a closed surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wrap {
    /// Along `u`.
    pub u: bool,
    /// Along `v`.
    pub v: bool,
}

/// Steps allowed; a good seed takes 3 to 6.
const MAX_STEPS: usize = 40;
/// Steps allowed by first derivatives alone: next to the surface two or three do, and far from it they never end.
const NEAR_STEPS: usize = 6;
/// Halvings of a step that leads uphill.
const MAX_HALVINGS: usize = 12;
/// A step shorter than this part of the coordinates' magnitude ends the search: a few rounding errors.
const STEP_END: f64 = 4.0 * f64::EPSILON;
/// Cosine between residual and tangents at which the foot point is exact to rounding.
const COSINE_END: f64 = 1e-15;
/// Part of the domain that one step may cross: keeps a wild first step from leaving the basin.
const MAX_PART: f64 = 0.25;
/// Rounding errors of a coordinate, in units of its last place, below which a change of distance says nothing.
const NOISE: f64 = 16.0 * f64::EPSILON;

impl NurbsCurve3 {
    /// The foot point reached from a seed: a local minimum of the distance over the domain.
    #[must_use]
    pub fn closest_from(&self, target: &Point3<f64>, seed: f64) -> CurveProjection {
        self.closest_between(target, seed, self.domain())
    }

    /// As [`closest_from`](Self::closest_from), over a part of the domain.
    #[must_use]
    pub fn closest_between(&self, target: &Point3<f64>, seed: f64, range: (f64, f64)) -> CurveProjection {
        let (start, end) = range;
        let mut t = if seed.is_nan() { start } else { seed.clamp(start, end) };
        let mut now = self.derivatives(t);
        let mut square = (now[0] - target.coords).norm_squared();
        for _ in 0..MAX_STEPS {
            let residual = now[0] - target.coords;
            let slope = now[1].dot(&residual);
            let speed = now[1].norm_squared();
            let outward = (t <= start && slope > 0.0) || (t >= end && slope < 0.0);
            if outward || slope.abs() <= COSINE_END * speed.sqrt() * residual.norm() || speed <= 0.0 {
                break;
            }
            let bent = speed + now[2].dot(&residual);
            let limit = MAX_PART * (end - start);
            let mut step = (-slope / if bent > 0.0 { bent } else { speed }).clamp(-limit, limit);
            let mut moved = false;
            for _ in 0..MAX_HALVINGS {
                let next = (t + step).clamp(start, end);
                let trial = self.derivatives(next);
                let trial_square = (trial[0] - target.coords).norm_squared();
                let slack = 2.0 * square.sqrt() * NOISE * magnitude(target, &now[0]);
                if trial_square <= square + slack {
                    // Near the foot the distance is flat to rounding: there the slope tells what is nearer.
                    let tangential =
                        |d: &[Vector3<f64>; 3]| d[1].dot(&(d[0] - target.coords)).abs() / d[1].norm();
                    let nearer = trial_square < square - slack || tangential(&trial) < tangential(&now);
                    let length = (trial[0] - now[0]).norm();
                    if nearer {
                        (t, now, square) = (next, trial, trial_square);
                    }
                    moved = nearer && length > STEP_END * magnitude(target, &now[0]);
                    break;
                }
                step *= 0.5;
            }
            if !moved {
                break;
            }
        }
        CurveProjection { t, point: Point3::from(now[0]), distance: square.sqrt() }
    }

    /// The closest point over the whole domain.
    #[must_use]
    pub fn closest(&self, target: &Point3<f64>) -> CurveProjection {
        let knots = self.knots();
        let p = knots.degree();
        let points: Vec<Point3<f64>> = self.control_points().collect();
        let mut order: Vec<(f64, usize)> = knots
            .spans()
            .map(|k| (BoundingBox::of(&points[k - p..=k]).distance_squared(target), k))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (start, end) = self.domain();
        let mut best = self.closest_from(target, start);
        for seed in [end].into_iter().chain(order.iter().flat_map(|&(_, k)| samples_of(knots, k))) {
            // One cheap evaluation tells whether a seed is worth Newton's steps.
            let span = knots.span(seed);
            let spread = BoundingBox::of(&points[span - p..=span]).diagonal();
            let away = (self.point_at(seed) - target).norm();
            if away <= best.distance + spread {
                let found = self.closest_from(target, seed);
                if found.distance < best.distance {
                    best = found;
                }
            }
        }
        best
    }
}

/// Greatest absolute coordinate in play, for steps relative to rounding.
fn magnitude(target: &Point3<f64>, point: &Vector3<f64>) -> f64 {
    target.coords.amax().max(point.amax())
}

/// Sample parameters inside span `k`: one more than the degree, at least 3.
fn samples_of(knots: &KnotVector, k: usize) -> impl Iterator<Item = f64> + use<> {
    let (low, high) = (knots.knots()[k], knots.knots()[k + 1]);
    let count = (knots.degree() + 1).max(3);
    (0..count).map(move |i| low + (high - low) * ((i as f64 + 0.5) / count as f64))
}

/// The rectangle of parameters that a search keeps to; sides may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchRange {
    /// First and last `u`.
    pub u: (f64, f64),
    /// First and last `v`.
    pub v: (f64, f64),
    /// Directions in which the ends of the range are the same place.
    pub wrap: Wrap,
}

/// Where a search on a surface stands.
struct Stand {
    u: f64,
    v: f64,
    at: SurfaceDerivatives,
    square: f64,
}

impl Stand {
    fn projection(&self) -> SurfaceProjection {
        let tangents = [self.at.du, self.at.dv];
        let distance = self.square.sqrt();
        SurfaceProjection { u: self.u, v: self.v, point: self.at.point, tangents, distance }
    }

    /// Part of the residual along the tangents.
    fn tangential(&self, target: &Point3<f64>) -> f64 {
        let r = self.at.point - target;
        let along = |d: &Vector3<f64>| {
            let norm = d.norm();
            if norm > 0.0 { d.dot(&r).abs() / norm } else { 0.0 }
        };
        along(&self.at.du) + along(&self.at.dv)
    }
}

/// The foot point on any surface that `evaluate` describes, reached from a seed: a local minimum of the
/// distance over the range.
pub fn foot_point(
    evaluate: &impl Fn(f64, f64) -> SurfaceDerivatives,
    range: &SearchRange,
    target: &Point3<f64>,
    seed: (f64, f64),
) -> SurfaceProjection {
    descended(evaluate, range, target, seed, MAX_STEPS).0.projection()
}

/// Where a number of steps downhill lead, and whether no further one would lead on.
fn descended(
    evaluate: &impl Fn(f64, f64) -> SurfaceDerivatives,
    range: &SearchRange,
    target: &Point3<f64>,
    seed: (f64, f64),
    steps: usize,
) -> (Stand, bool) {
    let stand = |u: f64, v: f64| {
        let (u, v) = (place_in(range.u, u, range.wrap.u), place_in(range.v, v, range.wrap.v));
        let at = evaluate(u, v);
        Stand { u, v, at, square: (at.point - target).norm_squared() }
    };
    let mut now = stand(seed.0, seed.1);
    for _ in 0..steps {
        let Some((mut du, mut dv)) = downhill(&now, target, range) else { return (now, true) };
        let mut moved = false;
        for _ in 0..MAX_HALVINGS {
            let trial = stand(now.u + du, now.v + dv);
            let slack = 2.0 * now.square.sqrt() * NOISE * magnitude(target, &now.at.point.coords);
            if trial.square <= now.square + slack {
                let length = (trial.at.point - now.at.point).norm();
                // Near the foot the distance is flat to rounding: there the slope tells what is nearer.
                let closer =
                    trial.square < now.square - slack || trial.tangential(target) < now.tangential(target);
                let end = STEP_END * magnitude(target, &trial.at.point.coords);
                if closer {
                    now = trial;
                }
                moved = closer && length > end;
                break;
            }
            (du, dv) = (0.5 * du, 0.5 * dv);
        }
        if !moved {
            return (now, true);
        }
    }
    (now, false)
}

/// Newton's step, with parameters that are held at a bound left alone; `None` at a minimum.
fn downhill(now: &Stand, target: &Point3<f64>, range: &SearchRange) -> Option<(f64, f64)> {
    let at = &now.at;
    let r = at.point - target;
    let (gu, gv) = (at.du.dot(&r), at.dv.dot(&r));
    let (uu, uv, vv) = (at.du.norm_squared(), at.du.dot(&at.dv), at.dv.norm_squared());
    let distance = r.norm();
    let held_u = held(now.u, range.u, gu, range.wrap.u);
    let held_v = held(now.v, range.v, gv, range.wrap.v);
    let still_u = held_u || gu.abs() <= COSINE_END * uu.sqrt() * distance;
    let still_v = held_v || gv.abs() <= COSINE_END * vv.sqrt() * distance;
    if still_u && still_v {
        return None;
    }
    let (hu, hm, hv) = (uu + r.dot(&at.duu), uv + r.dot(&at.duv), vv + r.dot(&at.dvv));
    let alone =
        |g: f64, h: f64, gauss: f64| if gauss > 0.0 { -g / if h > 0.0 { h } else { gauss } } else { 0.0 };
    let (du, dv) = match (held_u, held_v) {
        (true, _) => (0.0, alone(gv, hv, vv)),
        (_, true) => (alone(gu, hu, uu), 0.0),
        _ => solve_two((hu, hm, hv), (gu, gv))
            .or_else(|| solve_two((uu, uv, vv), (gu, gv)))
            .unwrap_or((alone(gu, uu, uu), alone(gv, vv, vv))),
    };
    // A way that rounding of the coordinates could make is none.
    if (at.du * du + at.dv * dv).norm() <= STEP_END * magnitude(target, &at.point.coords) {
        return None;
    }
    let part = |d: f64, (start, end): (f64, f64)| d.abs() / (MAX_PART * (end - start));
    let part = part(du, range.u).max(part(dv, range.v));
    let shrink = if part > 1.0 { 1.0 / part } else { 1.0 };
    (du.is_finite() && dv.is_finite()).then_some((du * shrink, dv * shrink))
}

impl NurbsSurface {
    /// The foot point reached from a seed: a local minimum of the distance over the domain.
    #[must_use]
    pub fn closest_from(&self, target: &Point3<f64>, seed: (f64, f64), wrap: Wrap) -> SurfaceProjection {
        let (u, v) = self.domain();
        let range = SearchRange { u, v, wrap };
        // Next to the surface its bend has no say, and first derivatives cost half.
        let (near, found) = descended(&|u, v| self.tangent_plane(u, v), &range, target, seed, NEAR_STEPS);
        if found {
            return near.projection();
        }
        foot_point(&|u, v| self.derivatives(u, v), &range, target, seed)
    }
}

/// Determinant, relative to the diagonal's product, below which a 2 x 2 Hessian counts as singular.
const SINGULAR: f64 = 1e-12;

/// `-H⁻¹ g` for a positive definite `H`.
fn solve_two(h: (f64, f64, f64), g: (f64, f64)) -> Option<(f64, f64)> {
    let det = h.0 * h.2 - h.1 * h.1;
    let definite = h.0 > 0.0 && h.2 > 0.0 && det > SINGULAR * h.0 * h.2;
    definite.then(|| (-(h.2 * g.0 - h.1 * g.1) / det, -(h.0 * g.1 - h.1 * g.0) / det))
}

/// Whether a parameter sits at a bound that the descent points out of.
fn held(x: f64, (start, end): (f64, f64), slope: f64, wraps: bool) -> bool {
    !wraps && ((x <= start && slope > 0.0) || (x >= end && slope < 0.0))
}

fn place_in((start, end): (f64, f64), x: f64, wraps: bool) -> f64 {
    if x.is_nan() {
        if start.is_finite() { start } else { 0.0 }
    } else if wraps && !(x >= start && x <= end) {
        (start + (x - start).rem_euclid(end - start)).clamp(start, end)
    } else {
        x.clamp(start, end)
    }
}

/// Greatest count of samples that a locator keeps: 24 MB.
const MAX_SAMPLES: usize = 1 << 20;

/// Finds closest points on one surface without a guess. Built once, asked often; a span is sampled when a
/// search first comes near it, since most searches stay within a few.
#[derive(Debug, Clone)]
pub struct SurfaceLocator<'a> {
    surface: &'a NurbsSurface,
    wrap: Wrap,
    us: Vec<f64>,
    vs: Vec<f64>,
    cells: Vec<Cell>,
}

/// A span rectangle: the box of its control points, its ranges of samples, and these, row by row.
#[derive(Debug, Clone)]
struct Cell {
    bounds: BoundingBox,
    rows: (usize, usize),
    columns: (usize, usize),
    points: OnceCell<Vec<Point3<f64>>>,
}

impl<'a> SurfaceLocator<'a> {
    /// Samples a surface; `wrap` names the directions in which it is closed.
    #[must_use]
    pub fn new(surface: &'a NurbsSurface, wrap: Wrap) -> Self {
        let spans_u: Vec<usize> = surface.knots_u().spans().collect();
        let spans_v: Vec<usize> = surface.knots_v().spans().collect();
        let (mut per_u, mut per_v) = (surface.knots_u().degree() + 1, surface.knots_v().degree() + 1);
        (per_u, per_v) = (per_u.max(3), per_v.max(3));
        while (spans_u.len() * per_u).saturating_mul(spans_v.len() * per_v) > MAX_SAMPLES && per_u * per_v > 1
        {
            (per_u, per_v) = ((per_u / 2).max(1), (per_v / 2).max(1));
        }
        let us = span_samples(surface.knots_u(), &spans_u, per_u);
        let vs = span_samples(surface.knots_v(), &spans_v, per_v);
        let control: Vec<Point3<f64>> = surface.control_points().collect();
        let (p, q, nv) = (surface.knots_u().degree(), surface.knots_v().degree(), surface.shape().1);
        let mut cells = Vec::with_capacity(spans_u.len() * spans_v.len());
        for (a, &su) in spans_u.iter().enumerate() {
            for (b, &sv) in spans_v.iter().enumerate() {
                let mut bounds = BoundingBox::EMPTY;
                for i in su - p..=su {
                    bounds.merge(&BoundingBox::of(&control[i * nv + sv - q..=i * nv + sv]));
                }
                let (rows, columns) = ((a * per_u, (a + 1) * per_u), (b * per_v, (b + 1) * per_v));
                cells.push(Cell { bounds, rows, columns, points: OnceCell::new() });
            }
        }
        Self { surface, wrap, us, vs, cells }
    }

    /// The closest point over the whole domain.
    #[must_use]
    pub fn closest(&self, target: &Point3<f64>) -> SurfaceProjection {
        let bounds: Vec<f64> = self.cells.iter().map(|c| c.bounds.distance_squared(target)).collect();
        let nearest = (0..bounds.len()).min_by(|&a, &b| bounds[a].total_cmp(&bounds[b])).unwrap_or(0);
        let best = self.descend(self.best_sample(nearest, target).1, target);
        self.closer(target, best, &bounds, Some(nearest))
    }

    /// The closest point where a good one is known: only spans whose boxes are nearer are looked into.
    fn closer(
        &self,
        target: &Point3<f64>,
        mut best: SurfaceProjection,
        bounds: &[f64],
        done: Option<usize>,
    ) -> SurfaceProjection {
        let mut order: Vec<usize> = (0..bounds.len())
            .filter(|&c| Some(c) != done && bounds[c] < best.distance * best.distance)
            .collect();
        order.sort_by(|&a, &b| bounds[a].total_cmp(&bounds[b]).then(a.cmp(&b)));
        for cell in order {
            if bounds[cell] >= best.distance * best.distance {
                break;
            }
            let (away, seed) = self.best_sample(cell, target);
            if away <= best.distance + self.spread(cell) {
                let found = self.descend(seed, target);
                if found.distance < best.distance {
                    best = found;
                }
            }
        }
        best
    }

    /// The closest point over the domain, where one is known that may be it: only what may be nearer is searched.
    #[must_use]
    pub fn nearer_than(&self, target: &Point3<f64>, known: SurfaceProjection) -> SurfaceProjection {
        let bounds: Vec<f64> = self.cells.iter().map(|c| c.bounds.distance_squared(target)).collect();
        self.closer(target, known, &bounds, None)
    }

    fn descend(&self, seed: (f64, f64), target: &Point3<f64>) -> SurfaceProjection {
        self.surface.closest_from(target, seed, self.wrap)
    }

    /// Distance between neighbouring samples of a cell, roughly: how far the true foot may be from them.
    fn spread(&self, cell: usize) -> f64 {
        let cell = &self.cells[cell];
        let least = (cell.rows.1 - cell.rows.0).min(cell.columns.1 - cell.columns.0);
        cell.bounds.diagonal() / least as f64
    }

    fn best_sample(&self, cell: usize, target: &Point3<f64>) -> (f64, (f64, f64)) {
        let cell = &self.cells[cell];
        let mut best = (f64::INFINITY, (self.us[cell.rows.0], self.vs[cell.columns.0]));
        let (us, vs) = (&self.us[cell.rows.0..cell.rows.1], &self.vs[cell.columns.0..cell.columns.1]);
        let places = || us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v)));
        let points = cell.points.get_or_init(|| places().map(|(u, v)| self.surface.point(u, v)).collect());
        for (point, place) in points.iter().zip(places()) {
            let square = (point - target).norm_squared();
            if square < best.0 {
                best = (square, place);
            }
        }
        (best.0.sqrt(), best.1)
    }
}

/// `count` parameters inside each of the spans.
fn span_samples(knots: &KnotVector, spans: &[usize], count: usize) -> Vec<f64> {
    let sample = |k: usize, i: usize| {
        let (low, high) = (knots.knots()[k], knots.knots()[k + 1]);
        low + (high - low) * ((i as f64 + 0.5) / count as f64)
    };
    spans.iter().flat_map(|&k| (0..count).map(move |i| sample(k, i))).collect()
}
