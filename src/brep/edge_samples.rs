//! Where an edge begins and ends on its curve, and points along it.
//!
//! Does not know faces: neighbours that share an edge get the same points.

use super::{Brep, EdgeId};
use crate::geometry::Curve;
use crate::math::Point3;
use std::f64::consts::FRAC_PI_2;

/// Parameters of an edge's ends on its curve.
///
/// Ascending when the edge runs as its curve does. On a closed curve the end may lie past the domain by up
/// to a period: [`Curve::point_wrapped`] takes such parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeRange {
    /// At the edge's start vertex.
    pub start: f64,
    /// At the edge's end vertex.
    pub end: f64,
}

/// A point of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// Parameter on the edge's curve.
    pub t: f64,
    /// Point of the curve there.
    pub point: Point3<f64>,
}

/// How densely an edge is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeSampling {
    /// Greatest distance of the curve from its chords, in file units; infinite for no bound.
    pub chord: f64,
    /// Least count of chords for each knot span, each quarter of a conic, each line.
    pub per_span: usize,
}

impl Default for EdgeSampling {
    fn default() -> Self {
        Self { chord: f64::INFINITY, per_span: 8 }
    }
}

/// Part of a period below which the ends of an edge on a closed curve count as the same point, so that the
/// edge is the whole curve.
const WHOLE_TURN: f64 = 1e-9;
/// Further distance, relative to the curve's box, that an end of the domain may have from a vertex and
/// still be preferred to the closest point.
const AT_END: f64 = 1e-9;
/// Greatest count of chords of one edge; a bound for hostile files.
const MAX_CHORDS: usize = 1 << 14;
/// Greatest count of halvings of one chord.
const MAX_DEPTH: u32 = 12;

/// Parameters of the ends of an edge; `None` when its curve was not read or the result is not finite.
#[must_use]
pub fn edge_range(brep: &Brep, edge: EdgeId) -> Option<EdgeRange> {
    let curve = brep.curve_of(edge).read()?;
    let edge = &brep.edges[edge];
    let (start, end) = (&brep.vertices[edge.start].point, &brep.vertices[edge.end].point);
    let (from, to) = if edge.same_sense { (start, end) } else { (end, start) };
    let mut low = end_parameter(curve, from);
    let mut high = end_parameter(curve, to);
    if let Some(period) = curve.period() {
        let (first, last) = curve.domain();
        if last - low <= WHOLE_TURN * period {
            low = first;
        }
        let way = (high - low).rem_euclid(period);
        let whole =
            edge.start == edge.end || way <= WHOLE_TURN * period || way >= (1.0 - WHOLE_TURN) * period;
        high = low + if whole { period } else { way };
    }
    let (start, end) = if edge.same_sense { (low, high) } else { (high, low) };
    (start.is_finite() && end.is_finite()).then_some(EdgeRange { start, end })
}

/// The parameter of a vertex, with the ends of a bounded curve preferred where they are as near as anything.
fn end_parameter(curve: &Curve, point: &Point3<f64>) -> f64 {
    let search = || curve.parameter_of(point, None);
    let size = match curve {
        Curve::Nurbs(nurbs) | Curve::Polyline(nurbs) => nurbs.bounding_box().diagonal(),
        Curve::Trimmed(_) | Curve::Composite(_) | Curve::Offset { .. } => {
            let (first, last) = curve.domain();
            if !(last - first).is_finite() {
                return search();
            }
            let middle = curve.point_at(0.5 * (first + last));
            (middle - curve.point_at(first)).norm()
        }
        _ => return search(),
    };
    let (first, last) = curve.domain();
    let slack = AT_END * size;
    let away = |t: f64| (curve.point_at(t) - point).norm();
    let (a, b) = (away(first), away(last));
    if a.min(b) <= slack {
        // Nothing that a search finds could be preferred.
        return if a <= b { first } else { last };
    }
    let found = search();
    let nearest = away(found);
    if a <= b && a <= nearest + slack {
        first
    } else if b <= nearest + slack {
        last
    } else {
        found
    }
}

/// Points along an edge from its start to its end, both included; neighbours' chords meet the tolerance.
///
/// `None` when [`edge_range`] has nothing to give.
#[must_use]
pub fn sample_edge(brep: &Brep, edge: EdgeId, sampling: &EdgeSampling) -> Option<Vec<EdgePoint>> {
    let curve = brep.curve_of(edge).read()?;
    let range = edge_range(brep, edge)?;
    Some(sample_curve(curve, range, sampling))
}

/// Points along a piece of a curve.
#[must_use]
pub fn sample_curve(curve: &Curve, range: EdgeRange, sampling: &EdgeSampling) -> Vec<EdgePoint> {
    let breaks = breaks(curve, range);
    let per_span = sampling.per_span.clamp(1, (MAX_CHORDS / breaks.len().max(1)).max(1));
    let at = |t: f64| EdgePoint { t, point: curve.point_wrapped(t) };
    let mut points = vec![at(range.start)];
    for pair in breaks.windows(2) {
        for i in 1..=per_span {
            let last = i == per_span;
            let t = if last { pair[1] } else { pair[0] + (pair[1] - pair[0]) * (i as f64 / per_span as f64) };
            let from = points[points.len() - 1];
            if sampling.chord.is_finite() {
                bisect(&at, from, at(t), sampling.chord, &mut points);
            } else {
                points.push(at(t));
            }
        }
    }
    points
}

/// Appends the points after `from` up to `to`, halving while the middle is off the chord.
fn bisect(
    at: &impl Fn(f64) -> EdgePoint,
    from: EdgePoint,
    to: EdgePoint,
    chord: f64,
    points: &mut Vec<EdgePoint>,
) {
    let mut from = from;
    let mut open = vec![(to, 0)];
    while let Some((to, depth)) = open.pop() {
        let middle = at(0.5 * (from.t + to.t));
        let off = (middle.point - center(&from.point, &to.point)).norm();
        if off > chord && depth < MAX_DEPTH && points.len() + open.len() < MAX_CHORDS {
            open.push((to, depth + 1));
            open.push((middle, depth + 1));
        } else {
            points.push(to);
            from = to;
        }
    }
}

fn center(a: &Point3<f64>, b: &Point3<f64>) -> Point3<f64> {
    a + (b - a) * 0.5
}

/// Parameters between two where a curve may change its form, ascending.
///
/// Quarters of conics, knots, the joints of composites; none of a line.
#[must_use]
pub fn inner_breaks(curve: &Curve, low: f64, high: f64) -> Vec<f64> {
    let mut all: Vec<f64> = match curve {
        Curve::Line { .. } => Vec::new(),
        Curve::Circle { .. } | Curve::Ellipse { .. } => {
            let count = ((high - low) / FRAC_PI_2).ceil().clamp(1.0, 8.0) as usize;
            (1..count).map(|i| low + (high - low) * (i as f64 / count as f64)).collect()
        }
        // Halves at the vertex, where the bend is greatest.
        Curve::Parabola { .. } | Curve::Hyperbola { .. } => vec![0.0],
        Curve::Nurbs(nurbs) | Curve::Polyline(nurbs) => repeated(curve, nurbs.knots().distinct().0),
        Curve::Trimmed(piece) => {
            let mut inner = inner_breaks(&piece.basis, piece.start, piece.end);
            if !piece.forward {
                inner.iter_mut().for_each(|t| *t = -*t);
            }
            let (start, end) = piece.domain();
            inner.extend([start, end]);
            repeated(curve, inner)
        }
        Curve::Composite(whole) => {
            let mut inner = whole.breaks().to_vec();
            for (at, segment) in whole.segments().iter().enumerate() {
                let (low, high) = segment.domain;
                inner.extend(
                    inner_breaks(&segment.curve, low, high).iter().map(|&t| whole.parameter_on(at, t)),
                );
            }
            repeated(curve, inner)
        }
        Curve::Offset { basis, .. } => inner_breaks(basis, low, high),
    };
    all.retain(|&t| t > low && t < high);
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Parameters, and where the curve is closed those a turn on and a turn back.
fn repeated(curve: &Curve, parameters: Vec<f64>) -> Vec<f64> {
    let Some(period) = curve.period() else { return parameters };
    [-period, 0.0, period].iter().flat_map(|turn| parameters.iter().map(move |t| t + turn)).collect()
}

/// Ends and the parameters between them where the curve may change its form, in the edge's direction.
fn breaks(curve: &Curve, range: EdgeRange) -> Vec<f64> {
    let (low, high) = (range.start.min(range.end), range.start.max(range.end));
    let mut inner = inner_breaks(curve, low, high);
    if range.start > range.end {
        inner.reverse();
    }
    let mut out = vec![range.start];
    out.append(&mut inner);
    out.push(range.end);
    out
}
