//! The boundary of a face as paths in the parameter plane: along coedges, and straight from one to the next.

use super::{Between, Quadrature};
use crate::brep::{Brep, LoopPoint, ParameterLoop, edge_range, inner_breaks};
use crate::geometry::nurbs::Wrap;
use crate::geometry::parameters::unwrapped;
use crate::geometry::{Curve, Surface};
use crate::math::Point3;

/// A place in the parameter plane.
pub(super) type Place = (f64, f64);

/// One of the two parameters of a place.
pub(super) type Pick = fn(Place) -> f64;

/// A parameter of the surface, and the values of it that matter between two.
pub(super) type LinesOf<'a> = (Pick, &'a dyn Fn(f64, f64) -> Vec<f64>);

/// One piece of the boundary.
pub(super) enum Path<'a> {
    /// Along an edge.
    Edge(EdgePath<'a>),
    /// Along a straight line: at a pole, over a gap, round a whole surface.
    Straight(Place, Place),
}

/// An edge, with the places of some of its points.
pub(super) struct EdgePath<'a> {
    curve: &'a Curve,
    /// Parameters on the curve with places, in the direction of the loop: ascending or descending.
    places: Vec<(f64, Place)>,
    /// Distance from the surface beyond which a projection is not believed.
    lost: f64,
    between: Between,
}

/// Finds parameters of points near given ones.
pub(super) struct Foot<'a> {
    surface: &'a Surface,
    wrap: Wrap,
    periods: (Option<f64>, Option<f64>),
}

/// Speed of one parameter line against the other below which the parameter cannot be found: rounding of a
/// projection, with a margin.
const SINGULAR: f64 = 1e-9;
/// Cosine between the way to a point and a tangent above which a foot at a border is held there.
const HELD: f64 = 1e-6;
/// Steps in the search for a knot line's crossing.
const CROSSING_STEPS: usize = 40;
/// Part of an edge's range within which a crossing is found, and two breaks are one.
const CROSSING: f64 = 1e-10;
/// Ratio of the steps between places above which the path is broken.
const CLOSER: f64 = 1.5;
/// Factor on the greatest gap of a loop beyond which a projection went astray.
const ASTRAY: f64 = 10.0;

impl<'a> Foot<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        let periods = surface.periods();
        Self { surface, wrap: Wrap { u: periods.0.is_some(), v: periods.1.is_some() }, periods }
    }

    fn of(&self, point: &Point3<f64>, seed: Place) -> Place {
        let (u, v) = match self.surface {
            Surface::Nurbs(nurbs) => {
                let found = nurbs.closest_from(point, self.surface_place(seed), self.wrap);
                (found.u, found.v)
            }
            surface => surface.parameters_of(point, Some(seed)),
        };
        let near = |x: f64, seed: f64, period: Option<f64>| period.map_or(x, |p| unwrapped(x, seed, p));
        (near(u, seed.0, self.periods.0), near(v, seed.1, self.periods.1))
    }

    fn surface_place(&self, (u, v): Place) -> Place {
        let ((u0, _), (v0, _)) = self.surface.domain();
        let wrap = |x: f64, start: f64, period: Option<f64>| match period {
            Some(p) if !(x >= start && x <= start + p) => start + (x - start).rem_euclid(p),
            _ => x,
        };
        (wrap(u, u0, self.periods.0), wrap(v, v0, self.periods.1))
    }
}

impl Foot<'_> {
    /// Whether the foot of a point is held at an end of `u` and of `v`: it stands there, and the surface, were it
    /// longer, would come nearer.
    fn held(&self, (u, v): Place, slope: (f64, f64), metric: (f64, f64, f64), away: f64) -> (bool, bool) {
        let (us, vs) = self.surface.domain();
        let one = |x: f64, (low, high): (f64, f64), wraps: bool, slope: f64, square: f64| {
            let counts = slope.abs() > HELD * square.sqrt() * away;
            !wraps && counts && ((x <= low && slope > 0.0) || (x >= high && slope < 0.0))
        };
        (one(u, us, self.wrap.u, slope.0, metric.0), one(v, vs, self.wrap.v, slope.1, metric.2))
    }
}

impl Path<'_> {
    /// Places that it is known to pass.
    pub(super) fn places(&self) -> impl Iterator<Item = Place> + '_ {
        let (ends, known) = match self {
            Self::Straight(from, to) => (vec![*from, *to], &[][..]),
            Self::Edge(edge) => (Vec::new(), &edge.places[..]),
        };
        ends.into_iter().chain(known.iter().map(|&(_, place)| place))
    }
}

impl EdgePath<'_> {
    pub(super) fn first(&self) -> Place {
        self.places[0].1
    }

    pub(super) fn last(&self) -> Place {
        self.places[self.places.len() - 1].1
    }

    /// Parameters of the ends.
    pub(super) fn range(&self) -> (f64, f64) {
        (self.places[0].0, self.places[self.places.len() - 1].0)
    }

    /// Between the known places.
    pub(super) fn guess(&self, t: f64) -> Place {
        let up = self.range().0 <= self.range().1;
        let after = self.places.partition_point(|&(s, _)| if up { s <= t } else { s >= t });
        let i = after.clamp(1, self.places.len() - 1);
        let ((s0, a), (s1, b)) = (self.places[i - 1], self.places[i]);
        let part = if s1 == s0 { 0.0 } else { ((t - s0) / (s1 - s0)).clamp(0.0, 1.0) };
        (a.0 + (b.0 - a.0) * part, a.1 + (b.1 - a.1) * part)
    }

    /// On the cubic through the four known places about `t`, and how it moves with `t`.
    fn on_cubic(&self, t: f64) -> (Place, Place) {
        let up = self.range().0 <= self.range().1;
        let after = self.places.partition_point(|&(s, _)| if up { s <= t } else { s >= t });
        let count = self.places.len().min(4);
        let first = after.saturating_sub(2).min(self.places.len() - count);
        let near = &self.places[first..first + count];
        // Newton's differences, in both parameters at once; then Horner's scheme with its derivative.
        let mut differences: Vec<Place> = near.iter().map(|&(_, place)| place).collect();
        for order in 1..count {
            for i in (order..count).rev() {
                let step = near[i].0 - near[i - order].0;
                let (a, b) = (differences[i - 1], differences[i]);
                differences[i] = ((b.0 - a.0) / step, (b.1 - a.1) / step);
            }
        }
        let (mut place, mut speed) = (differences[count - 1], (0.0, 0.0));
        for i in (0..count - 1).rev() {
            let away = t - near[i].0;
            speed = (speed.0 * away + place.0, speed.1 * away + place.1);
            place = (place.0 * away + differences[i].0, place.1 * away + differences[i].1);
        }
        (place, speed)
    }

    /// The place of the curve's point.
    fn place(&self, foot: &Foot<'_>, t: f64) -> Place {
        if self.between == Between::Cubics {
            return self.on_cubic(t).0;
        }
        let guess = self.guess(t);
        let point = self.curve.point_wrapped(t);
        let found = foot.of(&point, guess);
        let (u, v) = foot.surface_place(found);
        let away = (foot.surface.point(u, v) - point).norm();
        // Written so that no number that is not one passes.
        if away <= self.lost && found.0.is_finite() && found.1.is_finite() { found } else { guess }
    }

    /// The place of the curve's point and how it moves with the curve's parameter.
    ///
    /// The foot of a point off the surface moves by the Hessian of the distance, not by the metric alone; at a
    /// border that holds it, along the border.
    pub(super) fn place_and_speed(&self, foot: &Foot<'_>, t: f64) -> (Place, Place) {
        if self.between == Between::Cubics {
            return self.on_cubic(t);
        }
        let place = self.place(foot, t);
        let (u, v) = foot.surface_place(place);
        let d = foot.surface.derivatives(u, v);
        let off = d.point - self.curve.point_wrapped(t);
        let along = self.curve.derivatives(self.curve.wrapped_parameter(t))[1];
        let metric = (d.du.norm_squared(), d.du.dot(&d.dv), d.dv.norm_squared());
        let bent = (metric.0 + off.dot(&d.duu), metric.1 + off.dot(&d.duv), metric.2 + off.dot(&d.dvv));
        let way = (along.dot(&d.du), along.dot(&d.dv));
        let alone = |way: f64, bent: f64, metric: f64| {
            if bent > 0.0 {
                way / bent
            } else if metric > 0.0 {
                way / metric
            } else {
                0.0
            }
        };
        let held = foot.held((u, v), (off.dot(&d.du), off.dot(&d.dv)), metric, off.norm());
        let speed = match held {
            (true, true) => (0.0, 0.0),
            (true, false) => (0.0, alone(way.1, bent.2, metric.2)),
            (false, true) => (alone(way.0, bent.0, metric.0), 0.0),
            (false, false) => {
                solved(bent, metric, way).or_else(|| solved(metric, metric, way)).unwrap_or_else(|| {
                    if metric.0 >= metric.2 {
                        (alone(way.0, bent.0, metric.0), 0.0)
                    } else {
                        (0.0, alone(way.1, bent.2, metric.2))
                    }
                })
            }
        };
        (place, speed)
    }

    /// Parameters where the curve changes its form or crosses given values of the surface's parameters, from
    /// the first to the last.
    pub(super) fn breaks(&self, foot: &Foot<'_>, lines: &[LinesOf<'_>]) -> Vec<f64> {
        let (first, last) = self.range();
        let (low, high) = (first.min(last), first.max(last));
        let mut breaks = inner_breaks(self.curve, low, high);
        // Places stand closer where the path turns quickly, as beside a pole.
        for near in self.places.windows(3) {
            let (before, after) = ((near[1].0 - near[0].0).abs(), (near[2].0 - near[1].0).abs());
            if before.max(after) > CLOSER * before.min(after) {
                breaks.push(near[1].0);
            }
        }
        for (pick, lines) in lines {
            for pair in self.places.windows(2) {
                let (x, y) = (pick(pair[0].1), pick(pair[1].1));
                // A path along a line never crosses it.
                for line in lines(x.min(y), x.max(y)).into_iter().filter(|_| x != y) {
                    breaks.push(self.crossing(foot, *pick, line, (pair[0].0, x), (pair[1].0, y)));
                }
            }
        }
        breaks.sort_by(f64::total_cmp);
        let apart = CROSSING * (high - low);
        breaks.retain(|&t| t - low > apart && high - t > apart);
        breaks.dedup_by(|b, a| *b - *a <= apart);
        if first > last {
            breaks.reverse();
        }
        let mut all = vec![first];
        all.append(&mut breaks);
        all.push(last);
        all
    }

    /// Where the path crosses a line between two of its points: regula falsi, the Illinois way.
    fn crossing(
        &self,
        foot: &Foot<'_>,
        pick: fn(Place) -> f64,
        line: f64,
        a: (f64, f64),
        b: (f64, f64),
    ) -> f64 {
        let ((mut s, mut x), (mut t, mut y)) = ((a.0, a.1 - line), (b.0, b.1 - line));
        let enough = CROSSING * (t - s).abs();
        let mut middle = 0.5 * (s + t);
        for _ in 0..CROSSING_STEPS {
            middle = if y == x { 0.5 * (s + t) } else { (s * y - t * x) / (y - x) };
            let z = pick(self.place(foot, middle)) - line;
            if z == 0.0 || (t - s).abs() <= enough {
                break;
            }
            if (z > 0.0) == (y > 0.0) {
                (t, y) = (middle, z);
                x *= 0.5;
            } else {
                (s, x) = (middle, z);
                y *= 0.5;
            }
        }
        middle
    }
}

/// The solution of a symmetric pair of equations, where it is definite against a metric.
fn solved(matrix: (f64, f64, f64), metric: (f64, f64, f64), way: (f64, f64)) -> Option<(f64, f64)> {
    let (e, f, g) = matrix;
    let determinant = e * g - f * f;
    let definite = e > 0.0 && g > 0.0 && determinant > SINGULAR * SINGULAR * metric.0 * metric.2;
    definite.then(|| ((way.0 * g - way.1 * f) / determinant, (way.1 * e - way.0 * f) / determinant))
}

/// The boundary of one loop, closed but for its winding.
pub(super) fn paths<'a>(
    brep: &'a Brep,
    foot: &Foot<'_>,
    of: &ParameterLoop,
    quadrature: &Quadrature,
) -> Vec<Path<'a>> {
    let lost = ASTRAY * of.gap.max(quadrature.tolerance);
    let mut paths: Vec<Path<'a>> = Vec::new();
    let (mut start, mut here): (Option<Place>, Option<Place>) = (None, None);
    for of_coedge in of.points.chunk_by(|a, b| a.coedge == b.coedge) {
        // Where an edge passes through a pole, it stands there twice.
        let mut pieces = of_coedge.chunk_by(|a, b| a.t != b.t).peekable();
        while let Some(points) = pieces.next() {
            let end = end_of(brep, of_coedge).filter(|_| pieces.peek().is_none());
            let Some(edge) = edge_path(brep, foot, points, end, (lost, quadrature.between)) else { continue };
            start = start.or(Some(edge.first()));
            paths.extend(here.and_then(|from| straight(from, edge.first())));
            here = Some(edge.last());
            paths.push(Path::Edge(edge));
        }
    }
    if let (Some(from), Some(start)) = (here, start) {
        paths.extend(straight(from, (start.0 + of.winding.0, start.1 + of.winding.1)));
    }
    paths
}

fn straight<'a>(from: Place, to: Place) -> Option<Path<'a>> {
    (from != to).then_some(Path::Straight(from, to))
}

/// Parameter at which a coedge ends: its last point is the first of the next one, by that one's parameter.
fn end_of(brep: &Brep, points: &[LoopPoint]) -> Option<f64> {
    let range = edge_range(brep, brep.coedges[points[0].coedge].edge)?;
    let from = points[0].t;
    Some(if (from - range.start).abs() <= (from - range.end).abs() { range.end } else { range.start })
}

fn edge_path<'a>(
    brep: &'a Brep,
    foot: &Foot<'_>,
    points: &[LoopPoint],
    end: Option<f64>,
    (lost, between): (f64, Between),
) -> Option<EdgePath<'a>> {
    let curve = brep.curve_of(brep.coedges[points[0].coedge].edge).read()?;
    let mut places: Vec<(f64, Place)> = points.iter().map(|p| (p.t, (p.u, p.v))).collect();
    let last = places[places.len() - 1];
    if let Some(end) = end.filter(|&end| end != last.0) {
        let found = foot.of(&curve.point_wrapped(end), last.1);
        places.push((end, if found.0.is_finite() && found.1.is_finite() { found } else { last.1 }));
    }
    (places.len() >= 2).then_some(EdgePath { curve, places, lost, between })
}
