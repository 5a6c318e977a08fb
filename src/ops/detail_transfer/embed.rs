//! Sums of splines over different knots, and splines that are zero outside a part of the domain.

use super::error::TransferError;
use super::spline::Spline;
use crate::geometry::nurbs::KnotVector;

/// Knots of two summands closer than this part of the domain count as one.
const MERGED: f64 = 1e-12;

/// Puts differences over `[a, b]` into the domain of a target: zero elsewhere, with continuity of order
/// `ends - 1` where the interval ends inside.
///
/// The first and last `ends` points are zero, so they and as many knots can go: what is left is a spline over
/// knots of less multiplicity.
pub(super) fn embedded(
    detail: &Spline,
    (a, b): (f64, f64),
    domain: (f64, f64),
    ends: usize,
) -> Result<Spline, TransferError> {
    let bad = TransferError::BadInterval { start: a, end: b };
    let (start, end) = detail.domain();
    let p = detail.knots.degree();
    let mapped = |k: &f64| {
        // The ends exactly, so that they are knots of the target where they should be.
        if *k <= start {
            a
        } else if *k >= end {
            b
        } else {
            (a + (k - start) * ((b - a) / (end - start))).clamp(a, b)
        }
    };
    let mut knots: Vec<f64> = detail.knots.knots().iter().map(mapped).collect();
    let mut points = detail.points.clone();
    if a > domain.0 {
        knots.drain(..ends);
        knots.splice(..0, std::iter::repeat_n(domain.0, p + 1));
        points.splice(..ends, std::iter::repeat_n([0.0; 3], p + 1));
    }
    if b < domain.1 {
        knots.truncate(knots.len() - ends);
        knots.extend(std::iter::repeat_n(domain.1, p + 1));
        points.truncate(points.len() - ends);
        points.extend(std::iter::repeat_n([0.0; 3], p + 1));
    }
    let knots = KnotVector::new(p, knots).map_err(|_| bad)?;
    Ok(Spline { knots, points })
}

/// The sum of a target and differences over the same domain, on the union of their knots.
pub(super) fn sum(target: &Spline, detail: &Spline) -> Result<Spline, TransferError> {
    let too_high = || TransferError::Curve {
        curve: "the result".to_owned(),
        reason: "its degree or knots are beyond what can be held".to_owned(),
    };
    let degree = target.knots.degree().max(detail.knots.degree());
    let target = target.elevated(degree).ok_or_else(too_high)?;
    let detail = detail.elevated(degree).ok_or_else(too_high)?;
    let (union, snapped) = union(&target.knots, &detail.knots).ok_or_else(too_high)?;
    let mut result = target.over(&union);
    let detail = Spline { knots: snapped, points: detail.points }.over(&union);
    for (r, d) in result.points.iter_mut().zip(&detail.points) {
        for (r, d) in r.iter_mut().zip(d) {
            *r += d;
        }
    }
    let finite = result.points.iter().flatten().all(|c| c.is_finite());
    if finite { Ok(result) } else { Err(TransferError::NotFinite) }
}

/// The union with the greater multiplicity of each knot, and the second knots moved onto those of the first that
/// they nearly meet.
fn union(a: &KnotVector, b: &KnotVector) -> Option<(KnotVector, KnotVector)> {
    let snapped = snapped(a, b);
    let mut all: Vec<f64> = a.knots().to_vec();
    let mut more: Vec<f64> = Vec::new();
    for same in snapped.chunk_by(|x, y| x == y) {
        let lacking = same.len().saturating_sub(a.multiplicity(same[0]));
        more.extend(std::iter::repeat_n(same[0], lacking));
    }
    all.extend(more);
    all.sort_by(f64::total_cmp);
    let degree = a.degree();
    Some((KnotVector::new(degree, all).ok()?, KnotVector::new(degree, snapped).ok()?))
}

/// The second knots, moved onto those of the first that they nearly meet.
pub(super) fn snapped(a: &KnotVector, b: &KnotVector) -> Vec<f64> {
    let (start, end) = a.domain();
    let near = MERGED * (end - start);
    b.knots().iter().map(|&k| nearest(a.knots(), k, near)).collect()
}

fn nearest(knots: &[f64], k: f64, near: f64) -> f64 {
    let at = knots.partition_point(|&other| other < k);
    let around = [at.checked_sub(1), Some(at)].into_iter().flatten();
    let candidates = around.filter_map(|i| knots.get(i).copied()).filter(|other| (other - k).abs() <= near);
    candidates.min_by(|x, y| (x - k).abs().total_cmp(&(y - k).abs())).unwrap_or(k)
}
