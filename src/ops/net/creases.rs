//! Knots where a net could fold: an exact cylinder is made of quarters that meet at full multiplicity, and only the
//! places of its control points keep it smooth there.
//!
//! After a change the control points on such a line go where the tangents of both sides meet again, so that the
//! result is as smooth in direction as the target was. A crease that the target has stays.

use super::cells::Mask;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};

/// Distance of a control point from the line through its neighbours, over their distance, below which the surface goes
/// on straight there.
const STRAIGHT: f64 = 1e-4;
/// Relative difference of weights that is rounding.
const SAME_WEIGHT: f64 = 1e-12;

/// A line of the net that a knot of full multiplicity makes its own: its index, and the shares of the lines before and
/// behind it, per weight.
struct Fold {
    line: usize,
    shares: [f64; 2],
}

fn folds(knots: &KnotVector) -> Vec<Fold> {
    let (p, all) = (knots.degree(), knots.knots());
    let (start, end) = knots.domain();
    let (distinct, counts) = knots.distinct();
    let full = distinct.into_iter().zip(counts).filter(|(k, count)| *k > start && *k < end && *count >= p);
    let one = |(knot, _): (f64, usize)| {
        let first = all.partition_point(|k| *k < knot);
        let (before, behind) = (knot - all[first - 1], all[first + p] - knot);
        // Between the two sides' end tangents: the inverse lengths of their spans.
        Fold { line: first - 1, shares: [1.0 / before, 1.0 / behind] }
    };
    full.map(one).filter(|f| f.line > 0 && f.shares.iter().all(|s| s.is_finite())).collect()
}

/// The net of the result with its folds mended; `refined` is the target over the same knots, `changed` says which
/// control points may move.
#[must_use]
pub fn mended(refined: &NurbsSurface, surface: &NurbsSurface, changed: &Mask) -> Vec<[f64; 4]> {
    let (rows, columns) = refined.shape();
    let old = refined.net();
    let mut net = surface.net().to_vec();
    let lines = [(folds(refined.knots_u()), columns, rows), (folds(refined.knots_v()), 1, columns)];
    for (k, (folds, step, count)) in lines.into_iter().enumerate() {
        let across = if k == 0 { columns } else { rows };
        for fold in folds.iter().filter(|f| f.line + 1 < count) {
            for m in 0..across {
                let at = fold.line * step + if k == 0 { m } else { m * columns };
                let three = [at - step, at, at + step];
                if !goes_straight(old, &net, three, fold.shares) {
                    continue;
                }
                if changed.contains_index(at) {
                    mend(old, &mut net, three, fold.shares);
                } else {
                    // The line itself stays: what moved beside it would fold the surface.
                    net[three[0]] = old[three[0]];
                    net[three[2]] = old[three[2]];
                }
            }
        }
    }
    net
}

fn coordinate(net: &[[f64; 4]], k: usize, c: usize) -> f64 {
    net[k][c] / net[k][3]
}

/// The place between two neighbours where the tangents of both sides meet.
fn between(old: &[[f64; 4]], [a, b]: [usize; 2], shares: [f64; 2]) -> impl Fn(f64, f64) -> f64 {
    let (left, right) = (shares[0] * old[a][3], shares[1] * old[b][3]);
    move |x, y| (left * x + right * y) / (left + right)
}

/// Whether the target has no crease there, and its weights are those of the result.
fn goes_straight(old: &[[f64; 4]], net: &[[f64; 4]], [a, at, b]: [usize; 3], shares: [f64; 2]) -> bool {
    let kept = |k: usize| (net[k][3] - old[k][3]).abs() <= SAME_WEIGHT * old[k][3];
    if ![a, at, b].into_iter().all(kept) {
        return false;
    }
    let between = between(old, [a, b], shares);
    let (mut off, mut wide) = (0.0, 0.0);
    for c in 0..3 {
        let [x, m, y] = [a, at, b].map(|k| coordinate(old, k, c));
        off += (m - between(x, y)).powi(2);
        wide += (y - x).powi(2);
    }
    off <= STRAIGHT * STRAIGHT * wide
}

fn mend(old: &[[f64; 4]], net: &mut [[f64; 4]], [a, at, b]: [usize; 3], shares: [f64; 2]) {
    let between = between(old, [a, b], shares);
    for c in 0..3 {
        let moved = |k: usize| coordinate(net, k, c) - coordinate(old, k, c);
        let way = between(moved(a), moved(b));
        net[at][c] = (coordinate(old, at, c) + way) * net[at][3];
    }
}
