//! Knot insertion as a matrix: the control points of a spline over more knots.

use crate::geometry::nurbs::KnotVector;

/// The matrix `P` that takes control points over coarse knots to those of the same spline over finer ones.
///
/// INVARIANT: row `i` has `degree + 1` entries, from the column `first[i]` on.
#[derive(Debug, Clone)]
pub struct Refinement {
    width: usize,
    columns: usize,
    first: Vec<usize>,
    values: Vec<f64>,
}

impl Refinement {
    /// The matrix between two knot vectors of one degree, of which the finer holds every knot of the coarser at
    /// least as often, over one domain. Time is linear in the count of knots (the Oslo algorithm, Cohen, Lyche
    /// and Riesenfeld 1980).
    ///
    /// Knots that are not nested give some matrix that means nothing.
    #[must_use]
    pub fn new(coarse: &KnotVector, fine: &KnotVector) -> Self {
        let (p, rows, columns) = (fine.degree(), fine.n_basis(), coarse.n_basis());
        let (tau, t) = (coarse.knots(), fine.knots());
        let mut first = Vec::with_capacity(rows);
        let mut values = vec![0.0; rows * (p + 1)];
        let mut span = p;
        for (i, row) in values.chunks_exact_mut(p + 1).enumerate() {
            while span + 1 < columns && tau[span + 1] <= t[i] {
                span += 1;
            }
            first.push(span - p);
            row[0] = 1.0;
            for k in 1..=p {
                let x = t[i + k];
                let mut carried = 0.0;
                for (r, value) in row.iter_mut().enumerate().take(k) {
                    let (low, high) = (tau[span + 1 + r - k], tau[span + 1 + r]);
                    let share = (x - low) / (high - low);
                    let before = *value;
                    *value = carried + (1.0 - share) * before;
                    carried = share * before;
                }
                row[k] = carried;
            }
        }
        Self { width: p + 1, columns, first, values }
    }

    /// Rows: fine control points.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.first.len()
    }

    /// Columns: coarse control points.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// First column and entries of a row.
    #[must_use]
    pub fn row(&self, i: usize) -> (usize, &[f64]) {
        (self.first[i], &self.values[i * self.width..(i + 1) * self.width])
    }

    /// Control points over the fine knots.
    ///
    /// # Panics
    /// When there are fewer coarse points than columns.
    #[must_use]
    pub fn apply<const D: usize>(&self, coarse: &[[f64; D]]) -> Vec<[f64; D]> {
        let combine = |i: usize| {
            let (first, values) = self.row(i);
            let mut sum = [0.0; D];
            for (factor, point) in values.iter().zip(&coarse[first..]) {
                for (s, c) in sum.iter_mut().zip(point) {
                    *s += factor * c;
                }
            }
            sum
        };
        (0..self.rows()).map(combine).collect()
    }

    /// The transposed matrix on values at the fine control points.
    ///
    /// # Panics
    /// When there are more values than rows.
    #[must_use]
    pub fn apply_transposed<const D: usize>(&self, fine: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut sums = vec![[0.0; D]; self.columns];
        for (i, value) in fine.iter().enumerate() {
            let (first, factors) = self.row(i);
            for (factor, sum) in factors.iter().zip(&mut sums[first..]) {
                for (s, c) in sum.iter_mut().zip(value) {
                    *s += factor * c;
                }
            }
        }
        sums
    }
}
