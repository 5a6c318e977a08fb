//! The loops of a face as polygons in the parameter plane of its surface, tied to their coedges.
//!
//! From pcurves where they agree with their edges, else by projecting points of the edges onto the surface,
//! each seeded by the one before. On closed surfaces the walk goes on across the seam, so that a loop is
//! continuous in the covering plane: parameters may leave the domain by whole periods, and a loop that runs
//! once round ends a period from its start.
//!
//! Repairs nothing: the greatest distance of an edge from the surface is reported, not removed.

use super::edge_samples::{EdgePoint, EdgeSampling, sample_edge};
use super::{Brep, CoedgeId, EdgeId, FaceId, LoopId};
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, SurfaceProjection, Wrap};
use crate::geometry::parameters::unwrapped;
use crate::geometry::{Curve2d, Surface};
use crate::math::{Point2, Point3, Vector3};
use std::borrow::Cow;
use std::cell::OnceCell;

/// How loops are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSampling {
    /// Sampling of the edges in space.
    pub edge: EdgeSampling,
    /// Greatest distance of the true loop from the polygon's chords in the parameter plane, along `u` and
    /// along `v`; infinite for no bound.
    pub parameter_chord: (f64, f64),
    /// Distance within which a pcurve agrees with its edge, and below which a parameter line counts as
    /// shrunk to a pole; in file units: the file's uncertainty.
    pub tolerance: f64,
}

impl LoopSampling {
    /// Eight chords a span and no bound on chords, for a file of the given uncertainty.
    #[must_use]
    pub fn of_tolerance(tolerance: f64) -> Self {
        Self { edge: EdgeSampling::default(), parameter_chord: (f64::INFINITY, f64::INFINITY), tolerance }
    }
}

/// A vertex of a loop's polygon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopPoint {
    /// First parameter on the surface.
    pub u: f64,
    /// Second parameter on the surface.
    pub v: f64,
    /// The coedge that leaves from here, or that passes here.
    pub coedge: CoedgeId,
    /// Parameter on the coedge's curve in space.
    pub t: f64,
    /// Point of the edge's curve.
    pub point: Point3<f64>,
    /// Its distance from the surface at the parameters, in file units.
    pub gap: f64,
}

/// A loop in the parameter plane.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterLoop {
    /// The loop.
    pub of: LoopId,
    /// Vertices of the closed polygon, the first not repeated at the end. They run so that the face is to
    /// the left as seen against the face's normal: a face of the surface's own sense has its outer loop
    /// counter-clockwise. At a pole the vertex stands twice, with both parameters. Empty for a vertex loop.
    pub points: Vec<LoopPoint>,
    /// End minus start in the covering plane: whole periods, or zero.
    pub winding: (f64, f64),
    /// Greatest distance of a sampled point of an edge from the surface, in file units.
    pub gap: f64,
}

/// Why a face has no loops in the parameter plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterLoopError {
    /// The surface is carried unread.
    #[error("surface {entity} of the face is not read")]
    UnreadSurface {
        /// Entity name in the file.
        entity: String,
    },
    /// The curve of an edge is carried unread, or its ends have no parameters.
    #[error("the curve of an edge is not read")]
    UnreadCurve {
        /// The edge.
        edge: EdgeId,
    },
    /// A point has no finite parameters.
    #[error("an edge has no finite parameters on the surface")]
    NotFinite {
        /// The coedge.
        coedge: CoedgeId,
    },
}

/// Rounds of halving in the parameter plane.
const MAX_ROUNDS: usize = 8;
/// Greatest count of points of one coedge.
const MAX_POINTS: usize = 1 << 14;
/// Distance, in parts of the surface's box, below which a seeded projection is trusted whatever the
/// tolerance says: far below any detail, far above rounding.
const SURE_PART: f64 = 1e-6;

/// Part of a surface's box beyond which a seeded projection is not trusted, however coarse the file says it is.
const COARSE_PART: f64 = 1e-4;
/// Length of a parameter line, relative to the longest of its kind, above which it is no pole, however coarse the
/// file says it is: a face may be narrower than the file's uncertainty and yet have two sides.
const POLE_PART: f64 = 1e-2;
/// Samples each way that tell the length of parameter lines.
const LINE_SAMPLES: usize = 4;

/// Part of a parameter curve's domain by which a point may lie past its end through rounding.
const PAST_END: f64 = 1e-9;

/// The loops of a face in file order.
///
/// # Errors
/// See [`ParameterLoopError`].
pub fn parameter_loops(
    brep: &Brep,
    face: FaceId,
    sampling: &LoopSampling,
) -> Result<Vec<ParameterLoop>, ParameterLoopError> {
    parameter_loops_with(brep, face, sampling, &|edge| {
        sample_edge(brep, edge, &sampling.edge).map(Cow::Owned)
    })
}

/// Points of an edge from its start to its end, where they are known.
pub type Samples<'f, 's> = dyn Fn(EdgeId) -> Option<Cow<'s, [EdgePoint]>> + 'f;

/// As [`parameter_loops`], with the points of each edge, from its start to its end, given by the caller.
///
/// # Errors
/// See [`ParameterLoopError`].
pub fn parameter_loops_with<'s>(
    brep: &Brep,
    face: FaceId,
    sampling: &LoopSampling,
    samples: &Samples<'_, 's>,
) -> Result<Vec<ParameterLoop>, ParameterLoopError> {
    let surface = match brep.surface_of(face) {
        crate::geometry::Carried::Read(surface) => surface,
        crate::geometry::Carried::Unread { entity, .. } => {
            return Err(ParameterLoopError::UnreadSurface { entity: entity.clone() });
        }
    };
    let walk = Walk::new(surface, sampling, brep.faces[face].same_sense);
    let mut loops = Vec::new();
    for &id in &brep.faces[face].loops {
        loops.push(walk.around(brep, id, samples)?);
    }
    gather(&mut loops, brep, surface);
    Ok(loops)
}

/// One place on a coedge.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: EdgePoint,
    u: f64,
    v: f64,
    gap: f64,
    /// Which parameters mean nothing here.
    singular: (bool, bool),
}

/// A locator that is built when first asked.
struct LazyLocator<'a> {
    nurbs: &'a NurbsSurface,
    wrap: Wrap,
    built: OnceCell<SurfaceLocator<'a>>,
}

impl<'a> LazyLocator<'a> {
    fn built(&self) -> &SurfaceLocator<'a> {
        self.built.get_or_init(|| SurfaceLocator::new(self.nurbs, self.wrap))
    }

    /// The foot point from a seed when it lies within `close`, else the closest point over the domain.
    fn closest_near(&self, target: &Point3<f64>, seed: (f64, f64), close: f64) -> SurfaceProjection {
        let found = self.nurbs.closest_from(target, seed, self.wrap);
        if found.distance <= close { found } else { self.built().nearer_than(target, found) }
    }
}

/// What a walk round a face needs at every step.
struct Walk<'a> {
    surface: &'a Surface,
    /// The search without a guess, built when a point first needs it: pcurves that agree need none.
    locator: Option<LazyLocator<'a>>,
    periods: (Option<f64>, Option<f64>),
    sampling: &'a LoopSampling,
    /// Distance at which a seeded projection is not trusted.
    lost: f64,
    /// Length at which lines along `u` and `v` are poles.
    pole: (f64, f64),
    same_sense: bool,
}

impl<'a> Walk<'a> {
    fn new(surface: &'a Surface, sampling: &'a LoopSampling, same_sense: bool) -> Self {
        let periods = surface.periods();
        let (locator, size) = match surface {
            Surface::Nurbs(nurbs) => {
                let wrap = Wrap { u: periods.0.is_some(), v: periods.1.is_some() };
                (Some(LazyLocator { nurbs, wrap, built: OnceCell::new() }), nurbs.bounding_box().diagonal())
            }
            _ => (None, 0.0),
        };
        let coarse = if size > 0.0 { COARSE_PART * size } else { f64::INFINITY };
        let lost = sampling.tolerance.min(coarse).max(SURE_PART * size);
        let longest = longest_lines(surface);
        let pole = [longest.0, longest.1].map(|length| sampling.tolerance.min(POLE_PART * length));
        Self { surface, locator, periods, sampling, lost, pole: (pole[0], pole[1]), same_sense }
    }

    fn around(
        &self,
        brep: &Brep,
        id: LoopId,
        samples: &Samples<'_, '_>,
    ) -> Result<ParameterLoop, ParameterLoopError> {
        let bound = &brep.loops[id];
        let mut order = bound.coedges.clone();
        if !bound.forward {
            order.reverse();
        }
        let mut points: Vec<LoopPoint> = Vec::new();
        let mut before: Option<(EdgeId, Vec<Place>)> = None;
        let (mut first, mut gap) = (None, 0.0_f64);
        for coedge in order {
            let use_of = &brep.coedges[coedge];
            let edge = use_of.edge;
            let along =
                samples(edge).filter(|s| s.len() >= 2).ok_or(ParameterLoopError::UnreadCurve { edge })?;
            let entry = before.as_ref().and_then(|(_, places)| places.last()).copied();
            let pcurve = use_of.pcurve.as_ref().filter(|p| self.agrees(p, &along));
            let mut places = if use_of.forward == bound.forward {
                self.trace(along.iter(), pcurve, entry)
            } else {
                self.trace(along.iter().rev(), pcurve, entry)
            };
            if places.iter().any(|p| !(p.u.is_finite() && p.v.is_finite())) {
                return Err(ParameterLoopError::NotFinite { coedge });
            }
            self.halve(brep, edge, pcurve, &mut places);
            if let Some((last_edge, last)) = &before {
                self.join(last, &mut places, *last_edge == edge);
            }
            gap = places.iter().fold(gap, |m, p| m.max(p.gap));
            first = first.or_else(|| places.first().copied());
            // A pole stands twice, with the parameter of the way in and of the way out.
            let count = places.len();
            let keep = if places[count - 1].is_singular() { count } else { count - 1 };
            points.extend(places[..keep].iter().map(|p| p.on(coedge)));
            before = Some((edge, places));
        }
        let winding = match (first, before.as_ref().and_then(|(_, places)| places.last())) {
            (Some(first), Some(last)) => self.winding(&first, last),
            _ => (0.0, 0.0),
        };
        Ok(ParameterLoop { of: id, points, winding, gap })
    }

    /// Whole periods between the ends of a walk; none where it ends at a pole, whose line closes it.
    fn winding(&self, first: &Place, last: &Place) -> (f64, f64) {
        let whole = |way: f64, period: Option<f64>, pole: bool| match period {
            Some(p) if !pole => p * (way / p).round(),
            _ => 0.0,
        };
        (
            whole(last.u - first.u, self.periods.0, first.singular.0 || last.singular.0),
            whole(last.v - first.v, self.periods.1, first.singular.1 || last.singular.1),
        )
    }

    /// Parameters of points along a coedge, continuous from one to the next.
    fn trace<'p>(
        &self,
        along: impl ExactSizeIterator<Item = &'p EdgePoint>,
        pcurve: Option<&Curve2d>,
        entry: Option<Place>,
    ) -> Vec<Place> {
        let mut places: Vec<Place> = Vec::with_capacity(along.len());
        let mut seed = entry.map(|e| (e.u, e.v));
        for at in along {
            let place = match pcurve {
                Some(pcurve) => self.on_pcurve(*at, pcurve, seed),
                None => self.project(*at, seed, onward(&places, at.t)),
            };
            // A pole has no say in where the walk goes on, but for the other parameter.
            seed = match seed {
                Some(s) => Some((
                    if place.singular.0 { s.0 } else { place.u },
                    if place.singular.1 { s.1 } else { place.v },
                )),
                None if place.is_singular() => None,
                None => Some((place.u, place.v)),
            };
            places.push(place);
        }
        inherit(&mut places);
        places
    }

    fn agrees(&self, pcurve: &Curve2d, along: &[EdgePoint]) -> bool {
        let limit = self.sampling.tolerance;
        let (low, high) = pcurve.domain();
        along.iter().all(|at| {
            let p = pcurve.point_at(at.t);
            let slack = PAST_END * (high - low);
            let inside = at.t >= low - slack && at.t <= high + slack;
            let conic = pcurve.repeats();
            (inside || conic) && (self.surface.point(p.x, p.y) - at.point).norm() <= limit
        })
    }

    fn on_pcurve(&self, at: EdgePoint, pcurve: &Curve2d, seed: Option<(f64, f64)>) -> Place {
        let p = pcurve.point_at(at.t);
        let (u, v) = self.near(seed, p.x, p.y);
        self.place(at, u, v)
    }

    /// The closest place to a point, next to the one before, `seed`; `guess` is where the search had better begin.
    fn project(&self, at: EdgePoint, seed: Option<(f64, f64)>, guess: Option<(f64, f64)>) -> Place {
        if let Some(locator) = &self.locator {
            let found = match seed {
                Some(seed) => {
                    let begin = self.in_domain(guess.unwrap_or(seed));
                    locator.closest_near(&at.point, begin, self.lost)
                }
                None => locator.built().closest(&at.point),
            };
            let (u, v) = self.near(seed, found.u, found.v);
            return self.seen(at, (u, v), found.point, found.tangents);
        }
        let mut found = self.surface.parameters_of(&at.point, seed);
        if seed.is_some() && self.is_searched() {
            let away = (self.surface.point(found.0, found.1) - at.point).norm();
            if away > self.lost {
                found = self.surface.parameters_of(&at.point, None);
            }
        }
        let (u, v) = self.near(seed, found.0, found.1);
        self.place(at, u, v)
    }

    /// Whether parameters are found by a search that a bad seed may mislead.
    fn is_searched(&self) -> bool {
        !matches!(
            self.surface,
            Surface::Plane(_)
                | Surface::Cylinder { .. }
                | Surface::Cone { .. }
                | Surface::Sphere { .. }
                | Surface::Torus { .. }
        )
    }

    fn in_domain(&self, (u, v): (f64, f64)) -> (f64, f64) {
        let ((u0, _), (v0, _)) = self.surface.domain();
        let wrap = |x: f64, start: f64, period: Option<f64>| match period {
            Some(p) if !(x >= start && x <= start + p) => start + (x - start).rem_euclid(p),
            _ => x,
        };
        (wrap(u, u0, self.periods.0), wrap(v, v0, self.periods.1))
    }

    /// Moved by whole periods next to the seed.
    fn near(&self, seed: Option<(f64, f64)>, u: f64, v: f64) -> (f64, f64) {
        let Some(seed) = seed else { return (u, v) };
        (
            self.periods.0.map_or(u, |p| unwrapped(u, seed.0, p)),
            self.periods.1.map_or(v, |p| unwrapped(v, seed.1, p)),
        )
    }

    fn place(&self, at: EdgePoint, u: f64, v: f64) -> Place {
        let (wu, wv) = self.in_domain((u, v));
        let d = self.surface.derivatives(wu, wv);
        self.seen(at, (u, v), d.point, [d.du, d.dv])
    }

    /// The place of a point of an edge where the surface has the given point and tangents.
    fn seen(
        &self,
        at: EdgePoint,
        (u, v): (f64, f64),
        foot: Point3<f64>,
        [du, dv]: [Vector3<f64>; 2],
    ) -> Place {
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        // The whole parameter line through the point is shorter than the tolerance, as far as its speed tells.
        let shrunk = |speed: f64, length: f64, pole: f64| length.is_finite() && speed * length <= pole;
        let singular = (shrunk(du.norm(), u1 - u0, self.pole.0), shrunk(dv.norm(), v1 - v0, self.pole.1));
        Place { at, u, v, gap: (foot - at.point).norm(), singular }
    }

    /// Halves chords until the polygon follows the loop in the parameter plane.
    fn halve(&self, brep: &Brep, edge: EdgeId, pcurve: Option<&Curve2d>, places: &mut Vec<Place>) {
        let (limit_u, limit_v) = self.sampling.parameter_chord;
        if limit_u.is_infinite() && limit_v.is_infinite() {
            return;
        }
        let Some(curve) = brep.curve_of(edge).read() else { return };
        for _ in 0..MAX_ROUNDS {
            let mut finer = vec![places[0]];
            for pair in places.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let t = 0.5 * (a.at.t + b.at.t);
                let (u, v) = (0.5 * (a.u + b.u), 0.5 * (a.v + b.v));
                let at = EdgePoint { t, point: curve.point_wrapped(t) };
                let middle = match pcurve {
                    Some(pcurve) => self.on_pcurve(at, pcurve, Some((u, v))),
                    None => self.project(at, Some((u, v)), None),
                };
                let off = (middle.u - u).abs() > limit_u || (middle.v - v).abs() > limit_v;
                if off && !middle.is_singular() {
                    finer.push(middle);
                }
                finer.push(b);
            }
            let done = finer.len() == places.len() || finer.len() > MAX_POINTS;
            *places = finer;
            if done {
                return;
            }
        }
    }

    /// Moves a coedge's places by whole periods to where the last coedge ended; where an edge doubles back
    /// at a pole, on to the other side of the seam, so that the face is between the two ways.
    fn join(&self, last: &[Place], next: &mut [Place], doubles_back: bool) {
        let (end, start) = (last[last.len() - 1], next[0]);
        let mut shift = (0.0, 0.0);
        if !start.singular.0
            && let Some(p) = self.periods.0
        {
            shift.0 = unwrapped(start.u, end.u, p) - start.u;
        }
        if !start.singular.1
            && let Some(p) = self.periods.1
        {
            shift.1 = unwrapped(start.v, end.v, p) - start.v;
        }
        let left = if self.same_sense { 1.0 } else { -1.0 };
        if doubles_back && last.len() > 1 && next.len() > 1 {
            let from = last[last.len() - 2];
            if let (true, Some(p)) = (start.singular.0, self.periods.0) {
                // Heading up in v, the left is towards smaller u.
                let heading = (end.v - from.v).signum();
                shift.0 = end.u - left * heading * p - start.u;
            } else if let (true, Some(p)) = (start.singular.1, self.periods.1) {
                let heading = (end.u - from.u).signum();
                shift.1 = end.v + left * heading * p - start.v;
            }
        }
        for place in next {
            place.u += shift.0;
            place.v += shift.1;
        }
    }
}

/// The longest of some parameter lines along `u` and along `v`, as far as their speed tells; infinite where the
/// domain is.
fn longest_lines(surface: &Surface) -> (f64, f64) {
    let ((u0, u1), (v0, v1)) = surface.domain();
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return (f64::INFINITY, f64::INFINITY);
    }
    let at = |low: f64, high: f64, i: usize| low + (high - low) * ((i as f64 + 0.5) / LINE_SAMPLES as f64);
    let mut longest = (0.0f64, 0.0f64);
    for i in 0..LINE_SAMPLES * LINE_SAMPLES {
        let d = surface.derivatives(at(u0, u1, i % LINE_SAMPLES), at(v0, v1, i / LINE_SAMPLES));
        longest.0 = longest.0.max(d.du.norm() * (u1 - u0));
        longest.1 = longest.1.max(d.dv.norm() * (v1 - v0));
    }
    longest
}

impl ParameterLoop {
    /// Area enclosed in the parameter plane, positive when the polygon runs counter-clockwise; `None` for a
    /// loop without an inside: one that runs round the surface, or has no points.
    #[must_use]
    pub fn signed_area(&self) -> Option<f64> {
        if self.points.is_empty() || self.winding != (0.0, 0.0) {
            return None;
        }
        let first = &self.points[0];
        let cross = |a: &LoopPoint, b: &LoopPoint| {
            (a.u - first.u) * (b.v - first.v) - (b.u - first.u) * (a.v - first.v)
        };
        Some(0.5 * self.points.windows(2).map(|w| cross(&w[0], &w[1])).sum::<f64>())
    }
}

impl Place {
    fn is_singular(&self) -> bool {
        self.singular.0 || self.singular.1
    }

    fn on(&self, coedge: CoedgeId) -> LoopPoint {
        LoopPoint { u: self.u, v: self.v, coedge, t: self.at.t, point: self.at.point, gap: self.gap }
    }
}

/// Where a walk at an even pace comes next, at parameter `t` of the edge.
fn onward(places: &[Place], t: f64) -> Option<(f64, f64)> {
    let [.., before, last] = places else { return None };
    let share = (t - last.at.t) / (last.at.t - before.at.t);
    let regular = !before.is_singular() && !last.is_singular() && share.is_finite();
    regular.then(|| (last.u + (last.u - before.u) * share, last.v + (last.v - before.v) * share))
}

/// Gives poles the lost parameter of their nearest neighbour on the same coedge.
fn inherit(places: &mut [Place]) {
    let known_u: Vec<Option<f64>> = nearest_known(places, |p| (!p.singular.0).then_some(p.u));
    let known_v: Vec<Option<f64>> = nearest_known(places, |p| (!p.singular.1).then_some(p.v));
    for (place, (u, v)) in places.iter_mut().zip(known_u.into_iter().zip(known_v)) {
        place.u = u.unwrap_or(place.u);
        place.v = v.unwrap_or(place.v);
    }
}

/// For every place the value of the nearest place that has one.
fn nearest_known(places: &[Place], value: impl Fn(&Place) -> Option<f64>) -> Vec<Option<f64>> {
    let mut out: Vec<Option<(usize, f64)>> = Vec::with_capacity(places.len());
    let mut last = None;
    for (i, place) in places.iter().enumerate() {
        last = value(place).map(|x| (i, x)).or(last);
        out.push(last);
    }
    let mut next: Option<(usize, f64)> = None;
    for (i, place) in places.iter().enumerate().rev() {
        next = value(place).map(|x| (i, x)).or(next);
        if let Some((j, _)) = next
            && out[i].is_none_or(|(k, _)| j - i < i - k)
        {
            out[i] = next;
        }
    }
    out.into_iter().map(|o| o.map(|(_, x)| x)).collect()
}

/// Moves the loops of a face by whole periods: the outer one to the domain, the others to the outer one.
fn gather(loops: &mut [ParameterLoop], brep: &Brep, surface: &Surface) {
    let periods = surface.periods();
    let ((u0, u1), (v0, v1)) = surface.domain();
    let Some(outer) = (0..loops.len())
        .find(|&i| brep.loops[loops[i].of].outer && !loops[i].points.is_empty())
        .or_else(|| (0..loops.len()).find(|&i| !loops[i].points.is_empty()))
    else {
        return;
    };
    let into = |middle: f64, start: f64, end: f64, period: Option<f64>| {
        period.map_or(0.0, |p| {
            // The middle of a loop that fills the period lies in the middle of the domain, but for rounding.
            unwrapped(middle, 0.5 * (start + end), p) - middle
        })
    };
    let middle = middle_of(&loops[outer]);
    shift(&mut loops[outer], into(middle.x, u0, u1, periods.0), into(middle.y, v0, v1, periods.1));
    let home = middle_of(&loops[outer]);
    for (i, other) in loops.iter_mut().enumerate() {
        if i != outer && !other.points.is_empty() {
            let middle = middle_of(other);
            let to =
                |x: f64, home: f64, period: Option<f64>| period.map_or(0.0, |p| unwrapped(x, home, p) - x);
            shift(other, to(middle.x, home.x, periods.0), to(middle.y, home.y, periods.1));
        }
    }
}

fn middle_of(of: &ParameterLoop) -> Point2<f64> {
    let ends = |value: &dyn Fn(&LoopPoint) -> f64| {
        let (low, high) = of
            .points
            .iter()
            .map(value)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        0.5 * (low + high)
    };
    Point2::new(ends(&|p| p.u), ends(&|p| p.v))
}

fn shift(of: &mut ParameterLoop, du: f64, dv: f64) {
    for point in &mut of.points {
        point.u += du;
        point.v += dv;
    }
}
