//! Knot removal from a net, with the distance bounded at every step and certified at the end.
//!
//! One removal is algorithm A5.8 of The NURBS Book for every row at once; bounds add up over spans as in A9.9. What the
//! steps add up to is not relied on: at the end the two surfaces are compared cell by cell.

use super::SimplifyError;
use crate::geometry::nurbs::{KnotVector, NurbsSurface, deviation_at_equal_parameters};
use crate::ops::net::Mask;

/// Distance, as a part of the surface's size, within which held control points may be off: rounding of a removal that is
/// exact.
const EXACT: f64 = 1e-12;
/// Share of the tolerance for each direction.
const SHARE: f64 = 0.5;
/// Part by which a certified bound may pass the sum of the steps: rounding.
const ROUNDING: f64 = 1e-9;

/// Parameters that must stay: control points that act there move by rounding only.
pub trait Held {
    /// The control points of a net over these knots that must stay.
    fn control_points(&self, knots_u: &KnotVector, knots_v: &KnotVector) -> Mask;
}

impl<F: Fn(&KnotVector, &KnotVector) -> Mask> Held for F {
    fn control_points(&self, knots_u: &KnotVector, knots_v: &KnotVector) -> Mask {
        self(knots_u, knots_v)
    }
}

/// A surface with fewer knots.
#[derive(Debug, Clone)]
pub struct Simplified {
    /// The surface, over the same domain.
    pub surface: NurbsSurface,
    /// Greatest distance from the old surface at equal parameters, certified.
    pub bound: f64,
    /// Knots removed along `u` and along `v`.
    pub removed: [usize; 2],
}

/// Removes what knots it can.
///
/// # Errors
/// [`SimplifyError::BadTolerance`], [`SimplifyError::BoundBroken`].
pub fn simplified(
    surface: &NurbsSurface,
    tolerance: f64,
    held: &dyn Held,
) -> Result<Simplified, SimplifyError> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(SimplifyError::BadTolerance { found: tolerance });
    }
    let start = surface.clamped();
    let (along_u, removed_u) = one_direction(&start, SHARE * tolerance, held, Axis::U);
    let (turned, removed_v) = one_direction(&along_u.swapped(), SHARE * tolerance, held, Axis::V);
    let surface = turned.swapped();
    let bound = deviation_at_equal_parameters(&start, &surface);
    if bound > tolerance * (1.0 + ROUNDING) {
        return Err(SimplifyError::BoundBroken { bound, tolerance });
    }
    Ok(Simplified { surface, bound, removed: [removed_u, removed_v] })
}

/// Which parameter of the surface the rows run along now.
#[derive(Clone, Copy, PartialEq)]
enum Axis {
    U,
    V,
}

/// Removes knots along the first direction, pass after pass: of the knots that can go, the cheapest go first, and those
/// near one that went wait for the next pass.
fn one_direction(
    surface: &NurbsSurface,
    tolerance: f64,
    held: &dyn Held,
    axis: Axis,
) -> (NurbsSurface, usize) {
    let p = surface.knots_u().degree();
    let exact = EXACT * surface.bounding_box().diagonal();
    let per_length = homogeneous_share(surface);
    let mut rows = Rows {
        knots: surface.knots_u().knots().to_vec(),
        net: surface.net().to_vec(),
        p,
        columns: surface.shape().1,
    };
    // What the spans between distinct knots have cost so far.
    let mut spent = vec![0.0; rows.knots.len()];
    let mut removed = 0;
    while let Ok(knots) = KnotVector::new(p, rows.knots.clone()) {
        let mask = match axis {
            Axis::U => held.control_points(&knots, surface.knots_v()),
            Axis::V => held.control_points(surface.knots_v(), &knots).transposed(),
        };
        let mut candidates: Vec<(f64, usize)> = rows
            .interior()
            .filter_map(|r| {
                let cost = rows.cost(r, &mask, (exact, tolerance), per_length)?;
                let range = r - p..=r + p;
                let worst = spent[range].iter().fold(0.0, |a: f64, b| a.max(*b));
                (worst + cost <= tolerance).then_some((cost, r))
            })
            .collect();
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut gone: Vec<(f64, usize)> = Vec::new();
        for (cost, r) in candidates {
            if gone.iter().all(|(_, other)| r.abs_diff(*other) > 2 * p + 2) {
                gone.push((cost, r));
            }
        }
        if gone.is_empty() {
            break;
        }
        gone.sort_by_key(|(_, r)| std::cmp::Reverse(*r));
        for (cost, r) in gone {
            rows.remove(r);
            for s in &mut spent[r - p..=r + p] {
                *s += cost;
            }
            // The two spans at the knot become one, which has cost what the dearer has.
            let joined = spent[r - 1].max(spent[r]);
            spent[r - 1] = joined;
            spent.remove(r);
            removed += 1;
        }
    }
    let net = std::mem::take(&mut rows.net);
    let rebuilt = KnotVector::new(p, rows.knots)
        .ok()
        .and_then(|knots| NurbsSurface::new(knots, surface.knots_v().clone(), net).ok());
    rebuilt.map_or_else(|| (surface.clone(), 0), |s| (s, removed))
}

/// How far a point of space moves at most for a unit of distance of homogeneous ones; 1 without weights.
fn homogeneous_share(surface: &NurbsSurface) -> f64 {
    if !surface.is_rational() {
        return 1.0;
    }
    let least = surface.net().iter().map(|p| p[3]).fold(f64::INFINITY, f64::min);
    let farthest = surface.control_points().map(|p| p.coords.norm()).fold(0.0, f64::max);
    (1.0 + farthest) / least
}

/// A net whose rows lie along the knots at work.
struct Rows {
    knots: Vec<f64>,
    net: Vec<[f64; 4]>,
    p: usize,
    columns: usize,
}

/// Most rows that a removal works on, with one on each side.
const WORK: usize = 16;

impl Rows {
    /// Last index of each interior knot, one for each value.
    fn interior(&self) -> impl Iterator<Item = usize> + '_ {
        let (p, n) = (self.p, self.knots.len() - self.p - 1);
        (p + 1..n).filter(move |&r| self.knots[r] < self.knots[r + 1] && self.knots[r] < self.knots[n])
    }

    fn multiplicity(&self, r: usize) -> usize {
        let value = self.knots[r];
        self.knots[..=r].iter().rev().take_while(|k| **k == value).count()
    }

    fn point(&self, row: usize, column: usize) -> [f64; 4] {
        self.net[row * self.columns + column]
    }

    /// Rows that change: from the first to the last.
    fn changing(&self, r: usize) -> (usize, usize) {
        (r - self.p, r - self.multiplicity(r))
    }

    /// Bound of the distance that removing a knot costs; `None` when it cannot go.
    fn cost(&self, r: usize, held: &Mask, (exact, tolerance): (f64, f64), per_length: f64) -> Option<f64> {
        let (first, last) = self.changing(r);
        if first == 0 || last < first || last - first + 3 > WORK {
            return None;
        }
        let mut worst = 0.0_f64;
        for column in 0..self.columns {
            let (_, error) = self.removal(r, column);
            let error = error * per_length;
            let stays = (first..=last).any(|row| held.contains(row, column));
            if error > if stays { exact.min(tolerance) } else { tolerance } {
                return None;
            }
            worst = worst.max(error);
        }
        Some(worst)
    }

    /// A5.8 for one knot and one column: the changed points, and the distance that bounds the curve's change.
    fn removal(&self, r: usize, column: usize) -> ([[f64; 4]; WORK], f64) {
        let (u, all) = (self.knots[r], &self.knots);
        let (first, last) = self.changing(r);
        let off = first - 1;
        let mut temp = [[0.0; 4]; WORK];
        temp[0] = self.point(off, column);
        temp[last + 1 - off] = self.point(last + 1, column);
        let (mut i, mut j) = (first, last);
        let share = |k: usize| (u - all[k]) / (all[k + self.p + 1] - all[k]);
        while j > i {
            let (a, b) = (share(i), share(j));
            let (left, right) = (temp[i - off - 1], temp[j - off + 1]);
            let (pi, pj) = (self.point(i, column), self.point(j, column));
            temp[i - off] = [0, 1, 2, 3].map(|c| (pi[c] - (1.0 - a) * left[c]) / a);
            temp[j - off] = [0, 1, 2, 3].map(|c| (pj[c] - b * right[c]) / (1.0 - b));
            i += 1;
            j -= 1;
        }
        let error = if j < i {
            distance(&temp[i - off - 1], &temp[j + 1 - off])
        } else {
            let a = share(i);
            let (left, right) = (temp[i - off - 1], temp[i - off + 1]);
            let mean = [0, 1, 2, 3].map(|c| a * right[c] + (1.0 - a) * left[c]);
            distance(&self.point(i, column), &mean)
        };
        (temp, error)
    }

    fn remove(&mut self, r: usize) {
        let (first, last) = self.changing(r);
        let off = first - 1;
        let drop = (2 * r - self.multiplicity(r) - self.p) / 2;
        for column in 0..self.columns {
            let (temp, _) = self.removal(r, column);
            let (mut i, mut j) = (first, last);
            while j > i {
                self.net[i * self.columns + column] = temp[i - off];
                self.net[j * self.columns + column] = temp[j - off];
                i += 1;
                j -= 1;
            }
        }
        self.net.drain(drop * self.columns..(drop + 1) * self.columns);
        self.knots.remove(r);
    }
}

fn distance(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}
