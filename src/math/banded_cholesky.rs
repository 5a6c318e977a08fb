//! Cholesky factors of banded symmetric positive definite matrices.

/// A matrix that is not positive definite in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the banded system is not positive definite at row {row}")]
pub struct NotPositiveDefinite {
    /// Row of the pivot that is not positive.
    pub row: usize,
}

/// The factor `L` of `L Lᵀ`.
///
/// INVARIANT: row `i` stores columns `i - half ..= i`, the diagonal last; columns below 0 are zeros.
#[derive(Debug, Clone)]
pub struct BandedCholesky {
    size: usize,
    half: usize,
    rows: Vec<f64>,
}

impl BandedCholesky {
    /// Factors the matrix whose lower band is given row by row: `rows[i * (half + 1) + half - d]` is the entry
    /// `(i, i - d)`. Time is linear in the size.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`].
    ///
    /// # Panics
    /// When the length of `rows` is not a multiple of `half + 1`.
    pub fn new(half: usize, mut rows: Vec<f64>) -> Result<Self, NotPositiveDefinite> {
        let width = half + 1;
        assert_eq!(rows.len() % width, 0, "the band is whole rows");
        let size = rows.len() / width;
        for i in 0..size {
            let (above, from_here) = rows.split_at_mut(i * width);
            let row = &mut from_here[..width];
            for j in i.saturating_sub(half)..i {
                // Both rows hold the columns from `first` on, shifted against each other.
                let first = i.saturating_sub(half).max(j.saturating_sub(half));
                let (at, other) = (first + half - i, first + half - j);
                let count = j - first;
                let earlier = &above[j * width..(j + 1) * width];
                let dot: f64 =
                    row[at..at + count].iter().zip(&earlier[other..other + count]).map(|(a, b)| a * b).sum();
                row[j + half - i] = (row[j + half - i] - dot) / earlier[half];
            }
            let square: f64 = row[..half].iter().map(|v| v * v).sum();
            let pivot = row[half] - square;
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(NotPositiveDefinite { row: i });
            }
            row[half] = pivot.sqrt();
        }
        Ok(Self { size, half, rows })
    }

    /// Solves in place for right sides stored as one row of `D` numbers each.
    ///
    /// # Panics
    /// When there are not as many rows as the matrix has.
    pub fn solve<const D: usize>(&self, right: &mut [[f64; D]]) {
        assert_eq!(right.len(), self.size, "as many right sides as rows");
        let width = self.half + 1;
        for i in 0..self.size {
            let row = &self.rows[i * width..(i + 1) * width];
            let mut sum = right[i];
            for j in i.saturating_sub(self.half)..i {
                let factor = row[j + self.half - i];
                for (s, x) in sum.iter_mut().zip(&right[j]) {
                    *s -= factor * x;
                }
            }
            right[i] = sum.map(|s| s / row[self.half]);
        }
        for i in (0..self.size).rev() {
            let row = &self.rows[i * width..(i + 1) * width];
            let value = right[i].map(|s| s / row[self.half]);
            right[i] = value;
            for j in i.saturating_sub(self.half)..i {
                let factor = row[j + self.half - i];
                for (s, x) in right[j].iter_mut().zip(&value) {
                    *s -= factor * x;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_is_solved() {
        // Rows of the lower band of [[4,1,.5,0],[1,5,2,-1],[.5,2,6,1],[0,-1,1,3]].
        let band = vec![0.0, 0.0, 4.0, 0.0, 1.0, 5.0, 0.5, 2.0, 6.0, -1.0, 1.0, 3.0];
        let full = [[4.0, 1.0, 0.5, 0.0], [1.0, 5.0, 2.0, -1.0], [0.5, 2.0, 6.0, 1.0], [0.0, -1.0, 1.0, 3.0]];
        let exact = [[1.0, -2.0], [0.5, 3.0], [-4.0, 0.25], [2.0, 7.0]];
        let mut right = [[0.0; 2]; 4];
        for i in 0..4 {
            for j in 0..4 {
                for c in 0..2 {
                    right[i][c] += full[i][j] * exact[j][c];
                }
            }
        }
        BandedCholesky::new(2, band).expect("positive definite").solve(&mut right);
        for (found, exact) in right.iter().flatten().zip(exact.iter().flatten()) {
            assert!((found - exact).abs() < 1e-14);
        }
    }

    #[test]
    fn an_indefinite_band_is_refused() {
        let result = BandedCholesky::new(1, vec![0.0, 1.0, 2.0, 1.0]);
        assert_eq!(result.map(|_| ()), Err(NotPositiveDefinite { row: 1 }));
    }
}
