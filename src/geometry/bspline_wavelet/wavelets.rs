//! The wavelets of one level: splines over the fine knots that are orthogonal to the coarse ones.

use super::WaveletError;
use super::null_vector::null_vector;
use super::refinement::Refinement;
use crate::geometry::nurbs::KnotVector;

/// The matrix `Q`, column by column, ordered by the last fine control point that each wavelet has.
///
/// INVARIANT: each column has the norm 1 in the mean square over the domain; the first of its entries that are
/// greatest in size is positive.
#[derive(Debug, Clone)]
pub(super) struct Wavelets {
    first: Vec<usize>,
    /// Where the entries of each column begin; the end of the last.
    starts: Vec<usize>,
    values: Vec<f64>,
}

/// Fine control points of one wavelet at most. Least supports have `3 p + 2`; a long row of corners with nothing
/// to remove between them makes them longer, and a bound keeps the time linear.
const LONGEST: usize = 128;

/// Entries within this part of the greatest count as equally great, so that rounding does not choose the sign of
/// a symmetric wavelet.
const EQUALLY_GREAT: f64 = 1e-9;

impl Wavelets {
    pub(super) fn count(&self) -> usize {
        self.first.len()
    }

    /// First row and entries of a column.
    pub(super) fn column(&self, j: usize) -> (usize, &[f64]) {
        (self.first[j], &self.values[self.starts[j]..self.starts[j + 1]])
    }

    /// Finds the wavelets of a level: `gram` in band storage over the fine knots.
    pub(super) fn find(
        fine: &KnotVector,
        coarse: &KnotVector,
        ends: usize,
        refinement: &Refinement,
        gram: &[f64],
    ) -> Result<Self, WaveletError> {
        let search = Search { fine, coarse, ends, refinement, gram, ranges: ranges(fine, coarse, ends) };
        let last_columns = search.last_columns();
        let lacking = |at: usize| WaveletError::NoBasis { at: fine.knots()[at + ends] };
        if last_columns.len() != fine.n_basis() - coarse.n_basis() {
            return Err(lacking(0));
        }
        let mut found = Self { first: Vec::new(), starts: vec![0], values: Vec::new() };
        for last in last_columns {
            let first = search.first_column(last).ok_or_else(|| lacking(last))?;
            let vector = search.vector(first, last).ok_or_else(|| lacking(last))?;
            found.first.push(first + ends);
            found.values.extend(vector);
            found.starts.push(found.values.len());
        }
        Ok(found)
    }
}

/// What the search for wavelets looks at: fine and coarse functions without the first and last `ends`.
struct Search<'a> {
    fine: &'a KnotVector,
    coarse: &'a KnotVector,
    ends: usize,
    refinement: &'a Refinement,
    gram: &'a [f64],
    /// For each fine function the coarse ones that it overlaps, both counted from `ends`.
    ranges: Vec<(usize, usize)>,
}

/// Coarse functions whose supports overlap that of each fine one.
fn ranges(fine: &KnotVector, coarse: &KnotVector, ends: usize) -> Vec<(usize, usize)> {
    let (p, n, m) = (fine.degree(), fine.n_basis(), coarse.n_basis());
    let (t, tau) = (fine.knots(), coarse.knots());
    let (mut low, mut high) = (0, 0);
    let mut ranges = Vec::with_capacity(n);
    for j in ends..n - ends {
        while low < m && tau[low + p + 1] <= t[j] {
            low += 1;
        }
        while high < m && tau[high] < t[j + p + 1] {
            high += 1;
        }
        let (from, to) = (low.clamp(ends, m - ends) - ends, high.clamp(ends, m - ends) - ends);
        ranges.push((from, to.max(from)));
    }
    ranges
}

impl Search<'_> {
    /// Columns at which a wavelet ends: those for which the staircase of rows leaves no row free.
    fn last_columns(&self) -> Vec<usize> {
        let mut free = 0;
        let mut last = Vec::new();
        for (column, &(from, to)) in self.ranges.iter().enumerate() {
            let row = free.max(from);
            if row < to {
                free = row + 1;
            } else {
                last.push(column);
            }
        }
        last
    }

    /// The greatest first column for which columns outnumber the rows that they touch.
    fn first_column(&self, last: usize) -> Option<usize> {
        let (mut low, mut high) = self.ranges[last];
        for first in (last.saturating_sub(LONGEST - 1)..=last).rev() {
            let (from, to) = self.ranges[first];
            (low, high) = (low.min(from), high.max(to));
            if last - first + 1 > high - low {
                return Some(first);
            }
        }
        None
    }

    /// The wavelet over a window of columns.
    fn vector(&self, first: usize, last: usize) -> Option<Vec<f64>> {
        let columns = last - first + 1;
        let window = &self.ranges[first..=last];
        let low = window.iter().map(|r| r.0).min().unwrap_or(0);
        let rows = columns - 1;
        let p = self.fine.degree();
        let diagonal = |column: usize| self.gram[(column + self.ends) * (2 * p + 1) + p];
        let scale: Vec<f64> = (first..=last).map(|column| diagonal(column).sqrt()).collect();
        let mut matrix = vec![0.0; rows * columns];
        for (j, &(from, to)) in window.iter().enumerate() {
            for row in from..to {
                matrix[(row - low) * columns + j] = self.product(row, first + j) / scale[j];
            }
        }
        let mut vector = null_vector(&mut matrix, rows)?;
        vector.iter_mut().zip(&scale).for_each(|(v, s)| *v /= s);
        self.normalise(first, &mut vector)?;
        Some(vector)
    }

    /// Integral of the product of a coarse and a fine function.
    fn product(&self, row: usize, column: usize) -> f64 {
        let (p, n) = (self.fine.degree(), self.fine.n_basis());
        let (row, column) = (row + self.ends, column + self.ends);
        debug_assert!(row < self.coarse.n_basis(), "a coarse function");
        let mut sum = 0.0;
        for i in column.saturating_sub(p)..(column + p + 1).min(n) {
            let (start, entries) = self.refinement.row(i);
            if let Some(entry) = row.checked_sub(start).and_then(|at| entries.get(at)) {
                sum += entry * self.gram[column * (2 * p + 1) + i + p - column];
            }
        }
        sum
    }

    /// Norm 1 and the sign of the rule.
    fn normalise(&self, first: usize, vector: &mut [f64]) -> Option<()> {
        let p = self.fine.degree();
        let mut square = 0.0;
        for (i, left) in vector.iter().enumerate() {
            for (k, right) in vector.iter().enumerate().take(i + p + 1).skip(i.saturating_sub(p)) {
                square += left * right * self.gram[(first + self.ends + i) * (2 * p + 1) + k + p - i];
            }
        }
        let greatest = vector.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let leading = vector.iter().find(|v| v.abs() > greatest * (1.0 - EQUALLY_GREAT))?;
        let norm = square.sqrt().copysign(*leading);
        let usable = norm.is_finite() && norm != 0.0;
        vector.iter_mut().for_each(|v| *v /= norm);
        usable.then_some(())
    }
}
