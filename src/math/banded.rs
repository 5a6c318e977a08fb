//! LU factors of banded matrices with partial pivoting.

/// A square banded matrix, factored in place by [`factored`](Self::factored).
///
/// INVARIANT: row `i` stores columns `i - lower ..= i + upper + lower`, the last `lower` of them being
/// room for the fill that row exchanges make.
#[derive(Debug, Clone)]
pub struct Banded {
    size: usize,
    lower: usize,
    width: usize,
    rows: Vec<f64>,
}

/// A banded matrix that is not invertible: a pivot vanished.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the banded system is singular at row {row}")]
pub struct SingularBand {
    /// Row at which no pivot is left.
    pub row: usize,
}

/// LU factors of a [`Banded`] matrix.
#[derive(Debug, Clone)]
pub struct BandedFactor {
    matrix: Banded,
    pivots: Vec<usize>,
}

/// Pivot, relative to the greatest entry, at which a system counts as singular.
const SINGULAR: f64 = 1e-14;

impl Banded {
    /// The zero matrix with `lower` diagonals below and `upper` above the main one.
    #[must_use]
    pub fn zeros(size: usize, lower: usize, upper: usize) -> Self {
        let width = 2 * lower + upper + 1;
        Self { size, lower, width, rows: vec![0.0; size * width] }
    }

    /// Adds to an entry. Entries outside the band are ignored when `value` is zero.
    ///
    /// # Panics
    /// When a value that is not zero falls outside the band.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let offset = (column + self.lower).checked_sub(row).filter(|&o| o < self.width - self.lower);
        match offset {
            Some(offset) => self.rows[row * self.width + offset] += value,
            None => assert!(value == 0.0, "entry ({row}, {column}) is outside the band"),
        }
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.rows[row * self.width + column + self.lower - row]
    }

    fn last_column(&self, row: usize) -> usize {
        (row + self.width - self.lower - 1).min(self.size - 1)
    }

    /// Factors by Gauss elimination with row exchanges.
    ///
    /// # Errors
    /// [`SingularBand`] when a pivot is at most 1e-14 of the greatest entry.
    pub fn factored(mut self) -> Result<BandedFactor, SingularBand> {
        let greatest = self.rows.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut pivots = Vec::with_capacity(self.size);
        for k in 0..self.size {
            let end = (k + self.lower).min(self.size - 1);
            let mut pivot = k;
            for row in k + 1..=end {
                if self.at(row, k).abs() > self.at(pivot, k).abs() {
                    pivot = row;
                }
            }
            let value = *self.at(pivot, k);
            if value.is_nan() || value.abs() <= SINGULAR * greatest {
                return Err(SingularBand { row: k });
            }
            let last = self.last_column(k);
            if pivot != k {
                for column in k..=last {
                    let (a, b) = (*self.at(k, column), *self.at(pivot, column));
                    (*self.at(k, column), *self.at(pivot, column)) = (b, a);
                }
            }
            for row in k + 1..=end {
                let factor = *self.at(row, k) / value;
                *self.at(row, k) = factor;
                for column in k + 1..=last {
                    let above = *self.at(k, column);
                    *self.at(row, column) -= factor * above;
                }
            }
            pivots.push(pivot);
        }
        Ok(BandedFactor { matrix: self, pivots })
    }
}

impl BandedFactor {
    /// Solves in place for right sides stored row by row: `rows` holds `size` rows of `width` numbers.
    ///
    /// # Panics
    /// When the length of `rows` is not `size * width`.
    pub fn solve_rows(&self, rows: &mut [f64], width: usize) {
        let m = &self.matrix;
        assert_eq!(rows.len(), m.size * width, "right sides are whole rows");
        for k in 0..m.size {
            let pivot = self.pivots[k];
            if pivot != k {
                let (head, tail) = rows.split_at_mut(pivot * width);
                head[k * width..][..width].swap_with_slice(&mut tail[..width]);
            }
            for row in k + 1..=(k + m.lower).min(m.size - 1) {
                let factor = m.rows[row * m.width + k + m.lower - row];
                subtract_row(rows, row, k, width, factor);
            }
        }
        for k in (0..m.size).rev() {
            for column in k + 1..=m.last_column(k) {
                let factor = m.rows[k * m.width + column + m.lower - k];
                subtract_row(rows, k, column, width, factor);
            }
            let pivot = m.rows[k * m.width + m.lower];
            for value in &mut rows[k * width..][..width] {
                *value /= pivot;
            }
        }
    }
}

/// `rows[target] -= factor * rows[source]`.
fn subtract_row(rows: &mut [f64], target: usize, source: usize, width: usize, factor: f64) {
    if factor == 0.0 {
        return;
    }
    for c in 0..width {
        rows[target * width + c] -= factor * rows[source * width + c];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_that_needs_exchanges_is_solved() {
        // Zero diagonal at the start: without exchanges there is no factor.
        let entries =
            [[0.0, 2.0, 0.0, 0.0], [3.0, 1.0, -1.0, 0.0], [0.0, 4.0, 0.5, 2.0], [0.0, 0.0, 1.0, 1.0]];
        let mut matrix = Banded::zeros(4, 1, 1);
        for (i, row) in entries.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                matrix.add(i, j, value);
            }
        }
        let x = [[1.0, -2.0], [0.5, 3.0], [-4.0, 0.25], [2.0, 7.0]];
        let mut rows = vec![0.0; 8];
        for i in 0..4 {
            for j in 0..4 {
                for c in 0..2 {
                    rows[2 * i + c] += entries[i][j] * x[j][c];
                }
            }
        }
        matrix.factored().unwrap().solve_rows(&mut rows, 2);
        for (found, exact) in rows.iter().zip(x.as_flattened()) {
            assert!((found - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn a_singular_band_is_refused() {
        let mut matrix = Banded::zeros(2, 1, 1);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            matrix.add(i, j, 1.0);
        }
        assert_eq!(matrix.factored().map(|_| ()), Err(SingularBand { row: 1 }));
    }
}
