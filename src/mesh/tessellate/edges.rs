//! Edges divided once, for all faces that use them.

use super::{TessellateError, Tolerances};
use crate::brep::{Brep, EdgeId, EdgePoint, EdgeRange, edge_range, inner_breaks};
use crate::geometry::Curve;
use crate::math::Point3;

/// Times that a piece of an edge is halved at most: 4096 pieces.
const DEEPEST: u32 = 12;

/// Pieces of a closed edge at least, so that it encloses an area.
const CLOSED_PIECES: u32 = 4;

/// Pieces of another curved edge at least, so that two edges between the same vertices never share a chord.
const OPEN_PIECES: u32 = 2;

/// Share of the chord tolerance within which two points of an edge count as one.
const SAME_PLACE: f64 = 0.02;

/// Share of an edge within which two breaks count as one.
const SAME_PARAMETER: f64 = 1e-9;

/// Divides an edge from its start to its end. The ends are the vertices' points, whatever the curve says.
pub(super) fn divide(
    brep: &Brep,
    edge: EdgeId,
    tolerances: &Tolerances,
) -> Result<Vec<EdgePoint>, TessellateError> {
    let curve = brep.curve_of(edge);
    let Some(curve) = curve.read() else { return Err(TessellateError::curve(edge, curve)) };
    let ends = [brep.edges[edge].start, brep.edges[edge].end].map(|vertex| brep.vertices[vertex].point);
    let EdgeRange { start: from, end: to } =
        edge_range(brep, edge).ok_or(TessellateError::EdgeRange { edge })?;
    let at = |t: f64| EdgePoint { t, point: curve.point_wrapped(t) };
    let mut samples = vec![EdgePoint { t: from, point: ends[0] }];
    let close = SAME_PLACE * tolerances.chord;
    let breaks = breaks(curve, [from, to], brep.edges[edge].start == brep.edges[edge].end);
    for (k, &t) in breaks.iter().enumerate() {
        let end = if k + 1 == breaks.len() { EdgePoint { t: to, point: ends[1] } } else { at(t) };
        // Halves still to do, the nearest last.
        let mut ahead = vec![(end, 0)];
        let mut before = samples[samples.len() - 1];
        // Knots may stand closer than anybody can see, where a point more only makes slivers and knots.
        let is_last = k + 1 == breaks.len();
        let near = [before.point, ends[1]].iter().any(|p| (p - end.point).norm() < close);
        if near && !is_last && breaks.len() > CLOSED_PIECES as usize {
            continue;
        }
        while let Some((after, depth)) = ahead.pop() {
            let middle = at(0.5 * (before.t + after.t));
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

/// Ends of the pieces that are divided on their own: knots, where the curve may bend suddenly, and the
/// least count of them; the last is `to`.
fn breaks(curve: &Curve, [from, to]: [f64; 2], closed: bool) -> Vec<f64> {
    let mut breaks = match curve {
        Curve::Circle { .. } | Curve::Ellipse { .. } => Vec::new(),
        _ => inner_breaks(curve, from.min(to), from.max(to)),
    };
    let pieces = match curve {
        Curve::Line { .. } => 1,
        _ if closed => CLOSED_PIECES,
        _ => OPEN_PIECES,
    };
    let share = |k: u32| from + (to - from) * f64::from(k) / f64::from(pieces);
    breaks.extend((1..pieces).map(share));
    breaks.push(to);
    breaks.sort_by(|a, b| if from < to { a.total_cmp(b) } else { b.total_cmp(a) });
    let same = |a: f64, b: f64| (a - b).abs() <= SAME_PARAMETER * (to - from).abs();
    // Where an edge begins at the vertex of its hyperbola but for rounding, that is no break.
    breaks.retain(|&t| t == to || !same(t, from) && !same(t, to));
    breaks.dedup_by(|a, b| same(*a, *b));
    breaks
}

/// Whether a piece bends more than the tolerances allow. Looks at three places, so that a piece with an
/// inflection in its middle does not pass for straight.
fn is_coarse(
    curve: &Curve,
    before: EdgePoint,
    middle: EdgePoint,
    after: EdgePoint,
    tolerances: &Tolerances,
) -> bool {
    if matches!(curve, Curve::Line { .. }) {
        return false;
    }
    let chord = after.point - before.point;
    let square = chord.norm_squared();
    let off = |point: Point3<f64>| {
        let along = point - before.point;
        let t = if square > 0.0 { (along.dot(&chord) / square).clamp(0.0, 1.0) } else { 0.0 };
        (along - chord * t).norm()
    };
    let between = |share: f64| curve.point_wrapped(before.t + share * (after.t - before.t));
    if off(middle.point) > tolerances.chord
        || [0.25, 0.75].iter().any(|&s| off(between(s)) > tolerances.chord)
    {
        return true;
    }
    // The turn between the two halves is half the turn of the piece.
    let turn = (middle.point - before.point).angle(&(after.point - middle.point));
    turn > 0.5 * tolerances.angle && chord.norm() > tolerances.chord
}
