//! The walk along the edges of a face: parameters of their points, continuous from one to the next.

use super::{LoopPoint, LoopSampling, ParameterLoop, ParameterLoopError, Samples};
use crate::brep::{Brep, CoedgeId, EdgeId, EdgePoint, LoopId};
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, SurfaceProjection, Wrap};
use crate::geometry::parameters::unwrapped;
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::{Point3, Vector3};
use std::cell::OnceCell;

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

/// Part of a domain by which a parameter may lie past its end through rounding.
const PAST_END: f64 = 1e-9;

/// One place on a coedge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) at: EdgePoint,
    pub(super) uv: [f64; 2],
    gap: f64,
    /// Which parameters mean nothing here.
    pub(super) singular: [bool; 2],
}

/// An edge on the surface: its curve in space, and in the parameter plane where the file has one that agrees.
#[derive(Clone, Copy)]
pub(super) struct Track<'a> {
    pub(super) curve: &'a Curve,
    pub(super) pcurve: Option<&'a Curve2d>,
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
pub(super) struct Walk<'a> {
    surface: &'a Surface,
    /// The search without a guess, built when a point first needs it: pcurves that agree need none.
    locator: Option<LazyLocator<'a>>,
    pub(super) periods: [Option<f64>; 2],
    pub(super) sampling: &'a LoopSampling,
    /// Distance at which a seeded projection is not trusted.
    lost: f64,
    /// Length at which lines along `u` and `v` are poles.
    pole: [f64; 2],
    /// The side of a path in the parameter plane on which the face lies: 1 for the left.
    pub(super) left: f64,
}

impl<'a> Walk<'a> {
    pub(super) fn new(surface: &'a Surface, sampling: &'a LoopSampling, same_sense: bool) -> Self {
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
        let pole = longest_lines(surface).map(|length| sampling.tolerance.min(POLE_PART * length));
        let left = if same_sense { 1.0 } else { -1.0 };
        Self { surface, locator, periods: [periods.0, periods.1], sampling, lost, pole, left }
    }

    pub(super) fn around(
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
            let unread = ParameterLoopError::UnreadCurve { edge };
            let along = samples(edge).filter(|s| s.len() >= 2).ok_or(unread.clone())?;
            let curve = brep.curve_of(edge).read().ok_or(unread)?;
            let entry = before.as_ref().and_then(|(_, places)| places.last()).copied();
            let pcurve = use_of.pcurve.as_ref().filter(|p| self.agrees(p, &along));
            let track = Track { curve, pcurve };
            let mut places = if use_of.forward == bound.forward {
                self.trace(along.iter(), track, entry)
            } else {
                self.trace(along.iter().rev(), track, entry)
            };
            if !places.iter().flat_map(|p| p.uv).all(f64::is_finite) {
                return Err(ParameterLoopError::NotFinite { coedge });
            }
            self.halve(track, &mut places);
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
        let whole = |axis: usize| match self.periods[axis] {
            Some(p) if !(first.singular[axis] || last.singular[axis]) => {
                p * ((last.uv[axis] - first.uv[axis]) / p).round()
            }
            _ => 0.0,
        };
        (whole(0), whole(1))
    }

    /// Parameters of points along a coedge, continuous from one to the next.
    fn trace<'p>(
        &self,
        along: impl ExactSizeIterator<Item = &'p EdgePoint>,
        track: Track<'_>,
        entry: Option<Place>,
    ) -> Vec<Place> {
        let mut places: Vec<Place> = Vec::with_capacity(along.len());
        let mut seed = entry.map(|e| e.uv);
        for at in along {
            let place = match track.pcurve {
                Some(pcurve) => self.on_pcurve(*at, pcurve, seed),
                None => self.project(*at, seed, onward(&places, at.t)),
            };
            // A pole has no say in where the walk goes on, but for the other parameter.
            seed = match seed {
                Some(s) => Some([0, 1].map(|k| if place.singular[k] { s[k] } else { place.uv[k] })),
                None if place.is_singular() => None,
                None => Some(place.uv),
            };
            places.push(place);
        }
        self.settled(track, places)
    }

    /// Whether a pcurve is where its edge is, by places of the surface's own: a sphere has points a turn above its pole
    /// too, from where no walk comes back.
    fn agrees(&self, pcurve: &Curve2d, along: &[EdgePoint]) -> bool {
        let limit = self.sampling.tolerance;
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        let domain = [(u0, u1), (v0, v1)];
        let within = |k: usize, x: f64| self.periods[k].is_some() || covers(domain[k], x);
        along.iter().all(|at| {
            let p = pcurve.point_at(at.t);
            (covers(pcurve.domain(), at.t) || pcurve.repeats())
                && within(0, p.x)
                && within(1, p.y)
                && (self.surface.point(p.x, p.y) - at.point).norm() <= limit
        })
    }

    /// The place of a parameter on a track, next to another place.
    pub(super) fn place_on(&self, track: Track<'_>, t: f64, beside: [f64; 2]) -> Place {
        let at = EdgePoint { t, point: track.curve.point_wrapped(t) };
        match track.pcurve {
            Some(pcurve) => self.on_pcurve(at, pcurve, Some(beside)),
            None => self.project(at, Some(beside), None),
        }
    }

    fn on_pcurve(&self, at: EdgePoint, pcurve: &Curve2d, seed: Option<[f64; 2]>) -> Place {
        let p = pcurve.point_at(at.t);
        self.place(at, self.near(seed, [p.x, p.y]))
    }

    /// The closest place to a point, next to the one before, `seed`; `guess` is where the search had better begin.
    fn project(&self, at: EdgePoint, seed: Option<[f64; 2]>, guess: Option<[f64; 2]>) -> Place {
        if let Some(locator) = &self.locator {
            let found = match seed {
                Some(seed) => {
                    let [u, v] = self.in_domain(guess.unwrap_or(seed));
                    locator.closest_near(&at.point, (u, v), self.lost)
                }
                None => locator.built().closest(&at.point),
            };
            return self.seen(at, self.near(seed, [found.u, found.v]), found.point, found.tangents);
        }
        let mut found = self.surface.parameters_of(&at.point, seed.map(|[u, v]| (u, v)));
        if seed.is_some() && self.is_searched() {
            let away = (self.surface.point(found.0, found.1) - at.point).norm();
            if away > self.lost {
                found = self.surface.parameters_of(&at.point, None);
            }
        }
        self.place(at, self.near(seed, [found.0, found.1]))
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

    fn in_domain(&self, uv: [f64; 2]) -> [f64; 2] {
        let ((u0, _), (v0, _)) = self.surface.domain();
        let wrap = |x: f64, start: f64, period: Option<f64>| match period {
            Some(p) if !(x >= start && x <= start + p) => start + (x - start).rem_euclid(p),
            _ => x,
        };
        [wrap(uv[0], u0, self.periods[0]), wrap(uv[1], v0, self.periods[1])]
    }

    /// Moved by whole periods next to the seed.
    fn near(&self, seed: Option<[f64; 2]>, uv: [f64; 2]) -> [f64; 2] {
        let Some(seed) = seed else { return uv };
        [0, 1].map(|k| self.periods[k].map_or(uv[k], |p| unwrapped(uv[k], seed[k], p)))
    }

    fn place(&self, at: EdgePoint, uv: [f64; 2]) -> Place {
        let [u, v] = self.in_domain(uv);
        let d = self.surface.derivatives(u, v);
        self.seen(at, uv, d.point, [d.du, d.dv])
    }

    /// The place of a point of an edge where the surface has the given point and tangents.
    fn seen(&self, at: EdgePoint, uv: [f64; 2], foot: Point3<f64>, tangents: [Vector3<f64>; 2]) -> Place {
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        let lengths = [u1 - u0, v1 - v0];
        // The whole parameter line through the point is shorter than the tolerance, as far as its speed tells.
        let shrunk = |k: usize| lengths[k].is_finite() && tangents[k].norm() * lengths[k] <= self.pole[k];
        Place { at, uv, gap: (foot - at.point).norm(), singular: [shrunk(0), shrunk(1)] }
    }

    /// Halves chords until the polygon follows the loop in the parameter plane.
    fn halve(&self, track: Track<'_>, places: &mut Vec<Place>) {
        let (limit_u, limit_v) = self.sampling.parameter_chord;
        if limit_u.is_infinite() && limit_v.is_infinite() {
            return;
        }
        for _ in 0..MAX_ROUNDS {
            let mut finer = vec![places[0]];
            for pair in places.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let uv = [0, 1].map(|k| 0.5 * (a.uv[k] + b.uv[k]));
                let middle = self.place_on(track, 0.5 * (a.at.t + b.at.t), uv);
                let away = [0, 1].map(|k| (middle.uv[k] - uv[k]).abs());
                if (away[0] > limit_u || away[1] > limit_v) && !middle.is_singular() {
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

    /// Moves a coedge's places by whole periods to where the last coedge ended; at a pole to the other side of the
    /// face, which lies between the way in and the way out.
    fn join(&self, last: &[Place], next: &mut [Place], doubles_back: bool) {
        let (end, start) = (last[last.len() - 1], next[0]);
        let shift = [0, 1].map(|k| {
            let Some(period) = self.periods[k] else { return 0.0 };
            if !start.singular[k] {
                return unwrapped(start.uv[k], end.uv[k], period) - start.uv[k];
            }
            let from = last.iter().rev().find(|place| !place.is_singular());
            let onward = next.iter().any(|place| !place.is_singular());
            match from {
                Some(from) if onward && end.singular[k] => {
                    end.uv[k] + self.turn_at_pole(k, from, &end, start.uv[k], doubles_back) - start.uv[k]
                }
                _ => 0.0,
            }
        });
        for place in next {
            place.shift(shift);
        }
    }
}

/// Whether a domain has a parameter, but for rounding.
fn covers((low, high): (f64, f64), x: f64) -> bool {
    let slack = if (high - low).is_finite() { PAST_END * (high - low) } else { 0.0 };
    x >= low - slack && x <= high + slack
}

/// The longest of some parameter lines along `u` and along `v`, as far as their speed tells; infinite where the
/// domain is.
fn longest_lines(surface: &Surface) -> [f64; 2] {
    let ((u0, u1), (v0, v1)) = surface.domain();
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return [f64::INFINITY; 2];
    }
    let at = |low: f64, high: f64, i: usize| low + (high - low) * ((i as f64 + 0.5) / LINE_SAMPLES as f64);
    let mut longest = [0.0f64; 2];
    for i in 0..LINE_SAMPLES * LINE_SAMPLES {
        let d = surface.derivatives(at(u0, u1, i % LINE_SAMPLES), at(v0, v1, i / LINE_SAMPLES));
        longest[0] = longest[0].max(d.du.norm() * (u1 - u0));
        longest[1] = longest[1].max(d.dv.norm() * (v1 - v0));
    }
    longest
}

impl Place {
    pub(super) fn is_singular(&self) -> bool {
        self.singular[0] || self.singular[1]
    }

    pub(super) fn shift(&mut self, by: [f64; 2]) {
        self.uv = [self.uv[0] + by[0], self.uv[1] + by[1]];
    }

    fn on(&self, coedge: CoedgeId) -> LoopPoint {
        let [u, v] = self.uv;
        LoopPoint { u, v, coedge, t: self.at.t, point: self.at.point, gap: self.gap }
    }
}

/// Where a walk at an even pace comes next, at parameter `t` of the edge.
fn onward(places: &[Place], t: f64) -> Option<[f64; 2]> {
    let [.., before, last] = places else { return None };
    let share = (t - last.at.t) / (last.at.t - before.at.t);
    let regular = !before.is_singular() && !last.is_singular() && share.is_finite();
    regular.then(|| [0, 1].map(|k| last.uv[k] + (last.uv[k] - before.uv[k]) * share))
}
