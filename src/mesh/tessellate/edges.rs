//! Edges divided once, for all faces that use them.

use super::{TessellateError, Tolerances};
use crate::brep::{Brep, EdgeId};
use crate::geometry::Curve;
use crate::math::Point3;

/// Times that a piece of an edge is halved at most: 4096 pieces.
const DEEPEST: u32 = 12;

/// Pieces of a closed edge at least, so that it encloses an area.
const CLOSED_PIECES: u32 = 4;

/// Share of a period within which the ends of an edge with two vertices count as one parameter: the edge is
/// short, not nearly the whole curve.
const SAME_PARAMETER: f64 = 1e-9;

/// A point of an edge: the curve's parameter and the place.
pub(super) type Sample = (f64, Point3<f64>);

/// Divides an edge from its start to its end. The ends are the vertices' points, whatever the curve says; an
/// edge without length on a curve that is not closed has one sample.
pub(super) fn divide(brep: &Brep, edge: EdgeId, tolerances: &Tolerances) -> Result<Vec<Sample>, TessellateError> {
    let curve = brep.curve_of(edge);
    let Some(curve) = curve.read() else { return Err(TessellateError::curve(edge, curve)) };
    let ends = [brep.edges[edge].start, brep.edges[edge].end].map(|vertex| brep.vertices[vertex].point);
    let Some([from, to]) = range(brep, edge, curve) else { return Ok(vec![(0.0, ends[0])]) };
    if !(from.is_finite() && to.is_finite()) {
        return Err(TessellateError::EdgeRange { edge });
    }
    let at = |t: f64| (t, curve.point_wrapped(t));
    let mut samples = vec![(from, ends[0])];
    let breaks = breaks(curve, [from, to], brep.edges[edge].start == brep.edges[edge].end);
    for (k, &t) in breaks.iter().enumerate() {
        let (start, _) = samples[samples.len() - 1];
        let end = if k + 1 == breaks.len() { (to, ends[1]) } else { at(t) };
        // Halves still to do, the nearest last.
        let mut ahead = vec![(end, 0)];
        let mut before = (start, samples[samples.len() - 1].1);
        while let Some((after, depth)) = ahead.pop() {
            let middle = at(0.5 * (before.0 + after.0));
            if depth < DEEPEST && is_coarse(curve, before, middle, after, tolerances) {
                ahead.push((after, depth + 1));
                ahead.push((middle, depth + 1));
            } else {
                samples.push(after);
                before = after;
            }
        }
    }
    Ok(samples)
}

/// Parameters of the ends, in the edge's direction; `None` for a closed edge on a curve that is not.
fn range(brep: &Brep, edge: EdgeId, curve: &Curve) -> Option<[f64; 2]> {
    let edge = &brep.edges[edge];
    let from = curve.parameter_of(&brep.vertices[edge.start].point, None);
    let closed = edge.start == edge.end;
    let Some(period) = curve.period() else {
        let to = curve.parameter_of(&brep.vertices[edge.end].point, None);
        return (!closed).then_some([from, to]);
    };
    let direction = if edge.same_sense { 1.0 } else { -1.0 };
    let turn = if closed {
        period
    } else {
        let to = curve.parameter_of(&brep.vertices[edge.end].point, None);
        let turn = (direction * (to - from)).rem_euclid(period);
        if turn > period * (1.0 - SAME_PARAMETER) { turn - period } else { turn }
    };
    Some([from, from + direction * turn])
}

/// Ends of the pieces that are divided on their own: knots, where the curve may bend suddenly, and enough
/// of them for a closed edge; the last is `to`.
fn breaks(curve: &Curve, [from, to]: [f64; 2], closed: bool) -> Vec<f64> {
    let mut breaks = Vec::new();
    if let Curve::Nurbs(nurbs) = curve {
        let (knots, _) = nurbs.knots().distinct();
        let (start, end) = curve.domain();
        // A closed curve may be passed from any parameter: the knots of the turns before and after, too.
        let turns = if curve.period().is_some() { vec![start - end, 0.0, end - start] } else { vec![0.0] };
        let shifted = turns.iter().flat_map(|turn| knots.iter().map(move |knot| knot + turn));
        breaks.extend(shifted.filter(|t| (t - from) * (t - to) < 0.0));
    }
    if closed {
        let share = |k: u32| from + (to - from) * f64::from(k) / f64::from(CLOSED_PIECES);
        breaks.extend((1..CLOSED_PIECES).map(share));
    }
    breaks.push(to);
    breaks.sort_by(|a, b| if from < to { a.total_cmp(b) } else { b.total_cmp(a) });
    breaks.dedup_by(|a, b| (*a - *b).abs() <= SAME_PARAMETER * (to - from).abs());
    breaks
}

/// Whether a piece bends more than the tolerances allow. Looks at three places, so that a piece with an
/// inflection in its middle does not pass for straight.
fn is_coarse(curve: &Curve, before: Sample, middle: Sample, after: Sample, tolerances: &Tolerances) -> bool {
    if matches!(curve, Curve::Line { .. }) {
        return false;
    }
    let chord = after.1 - before.1;
    let square = chord.norm_squared();
    let off = |point: Point3<f64>| {
        let along = point - before.1;
        let t = if square > 0.0 { (along.dot(&chord) / square).clamp(0.0, 1.0) } else { 0.0 };
        (along - chord * t).norm()
    };
    let between = |share: f64| curve.point_wrapped(before.0 + share * (after.0 - before.0));
    if off(middle.1) > tolerances.chord || [0.25, 0.75].iter().any(|&s| off(between(s)) > tolerances.chord) {
        return true;
    }
    // The turn between the two halves is half the turn of the piece.
    let turn = (middle.1 - before.1).angle(&(after.1 - middle.1));
    turn > 0.5 * tolerances.angle && chord.norm() > tolerances.chord
}
