//! Removal of one knot from all rows of a net at once: algorithm A5.8 of The NURBS Book, with the distance that it costs.

use super::cells::Mask;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};

/// A net whose rows lie along the knots at work.
#[derive(Debug, Clone)]
pub struct KnotRows {
    across: KnotVector,
    knots: Vec<f64>,
    net: Vec<[f64; 4]>,
    p: usize,
    columns: usize,
}

/// Most rows that a removal works on, with one on each side.
const WORK: usize = 16;

impl KnotRows {
    /// The rows of a clamped surface along `u`.
    #[must_use]
    pub fn new(surface: &NurbsSurface) -> Self {
        Self {
            across: surface.knots_v().clone(),
            knots: surface.knots_u().knots().to_vec(),
            net: surface.net().to_vec(),
            p: surface.knots_u().degree(),
            columns: surface.shape().1,
        }
    }

    /// The knots as they are now.
    #[must_use]
    pub fn knots(&self) -> Option<KnotVector> {
        KnotVector::new(self.p, self.knots.clone()).ok()
    }

    /// The surface as it is now.
    #[must_use]
    pub fn surface(&self) -> Option<NurbsSurface> {
        NurbsSurface::new(self.knots()?, self.across.clone(), self.net.clone()).ok()
    }

    /// Removes a knot as often as that moves control points by `exact` at most, but for its last occurrence; gives how
    /// often it is left.
    pub fn smooth(&mut self, knot: f64, exact: f64) -> usize {
        let columns = self.columns;
        while let Some(r) = self.knots.iter().rposition(|k| *k == knot) {
            let count = self.multiplicity(r);
            if count < 2
                || self
                    .cost(r, &Mask::empty(self.net.len() / columns, columns), (exact, exact), 1.0)
                    .is_none()
            {
                return count;
            }
            self.remove(r);
        }
        0
    }

    /// Last index of each interior knot, one for each value.
    pub fn interior(&self) -> impl Iterator<Item = usize> + '_ {
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
    #[must_use]
    pub fn cost(
        &self,
        r: usize,
        held: &Mask,
        (exact, tolerance): (f64, f64),
        per_length: f64,
    ) -> Option<f64> {
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

    /// Removes the knot at an index.
    pub fn remove(&mut self, r: usize) {
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
