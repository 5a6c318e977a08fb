//! Factorisation of sparse symmetric positive definite matrices.
//!
//! Assembly is sprs' (triplets, Kronecker products) or a grid's; the factor is faer's sequential sparse Cholesky, with
//! an approximate minimum degree ordering or a given one. Deterministic.

use resurf_cholesky::{Factor, FactorError, Ordering, Triangle};
use sprs::CsMat;

/// The matrix has no Cholesky factor in double precision.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SingularSystem {
    /// A pivot is zero, negative or not finite.
    #[error("the {size} x {size} system is singular or not positive definite")]
    NotPositiveDefinite {
        /// Rows.
        size: usize,
    },
    /// Rows and columns differ in number.
    #[error("the system has {rows} rows and {columns} columns")]
    NotSquare {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// The given order is no permutation of the unknowns.
    #[error("the order of elimination is no permutation of {size} unknowns")]
    NoPermutation {
        /// Rows.
        size: usize,
    },
    /// The factor does not fit into memory or into the index type.
    #[error("the factor of the {size} x {size} system is too large")]
    TooLarge {
        /// Rows.
        size: usize,
    },
}

/// Cholesky factor of a sparse symmetric positive definite matrix, to be used for many right sides.
#[derive(Debug, Clone)]
pub struct SymmetricFactor {
    size: usize,
    factor: Option<Factor>,
}

impl SymmetricFactor {
    /// Factors a matrix of which the lower triangle, at least, is stored; only that one is read.
    ///
    /// # Errors
    /// See [`SingularSystem`]. The matrix of size 0 is fine.
    pub fn new(matrix: &CsMat<f64>) -> Result<Self, SingularSystem> {
        Self::by(matrix, Ordering::MinimumDegree)
    }

    /// As [`new`](Self::new), the unknowns eliminated in the given order, a permutation of all of them.
    ///
    /// # Errors
    /// See [`SingularSystem`].
    pub fn ordered(matrix: &CsMat<f64>, order: &[usize]) -> Result<Self, SingularSystem> {
        Self::by(matrix, Ordering::Given(order))
    }

    fn by(matrix: &CsMat<f64>, ordering: Ordering<'_>) -> Result<Self, SingularSystem> {
        let (rows, columns) = matrix.shape();
        if rows != columns {
            return Err(SingularSystem::NotSquare { rows, columns });
        }
        if rows == 0 {
            return Ok(Self { size: 0, factor: None });
        }
        // A symmetric matrix is its own transpose, so that compressed rows serve as compressed columns,
        // of which the upper triangle is then the lower one of the rows.
        let indptr = matrix.proper_indptr();
        let triangle = if matrix.is_csr() { Triangle::Upper } else { Triangle::Lower };
        let factor = Factor::new(rows, &indptr, matrix.indices(), matrix.data(), triangle, ordering);
        let factor = factor.map_err(|error| match error {
            FactorError::NotPositiveDefinite => SingularSystem::NotPositiveDefinite { size: rows },
            FactorError::TooLarge => SingularSystem::TooLarge { size: rows },
            FactorError::NoPermutation => SingularSystem::NoPermutation { size: rows },
        })?;
        Ok(Self { size: rows, factor: Some(factor) })
    }

    /// Rows of the matrix.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Bytes that the factor's numbers take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.factor.as_ref().map_or(0, |factor| size_of::<f64>() * factor.stored())
    }

    /// Solves in place for any number of right sides, each a column of `size` numbers one after another.
    ///
    /// # Panics
    /// When the length of `columns` is not a multiple of `size`.
    pub fn solve(&self, columns: &mut [f64]) {
        let Some(factor) = &self.factor else {
            assert!(columns.is_empty(), "a system of size 0 has no right side");
            return;
        };
        factor.solve(columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sprs::TriMat;

    /// The second difference matrix, whose solution for a constant right side is a parabola.
    fn second_difference(n: usize) -> CsMat<f64> {
        let mut triplets = TriMat::new((n, n));
        for i in 0..n {
            triplets.add_triplet(i, i, 2.0);
            if i + 1 < n {
                triplets.add_triplet(i, i + 1, -1.0);
                triplets.add_triplet(i + 1, i, -1.0);
            }
        }
        triplets.to_csr()
    }

    #[test]
    fn second_differences_of_a_constant_give_the_parabola() {
        for n in [1, 2, 7, 300] {
            let factor = SymmetricFactor::new(&second_difference(n)).unwrap();
            let mut x = vec![1.0; 2 * n];
            x[n..].fill(-2.0);
            factor.solve(&mut x);
            for i in 0..n {
                let k = i as f64 + 1.0;
                let exact = k * (n as f64 + 1.0 - k) / 2.0;
                assert!((x[i] - exact).abs() <= 1e-11 * exact);
                assert!((x[n + i] + 2.0 * exact).abs() <= 1e-11 * exact);
            }
        }
    }

    #[test]
    fn a_given_order_changes_nothing_but_must_be_one() {
        let n = 300;
        let matrix = second_difference(n);
        let order: Vec<usize> = (0..n).map(|k| (k * 77) % n).collect();
        let factor = SymmetricFactor::ordered(&matrix, &order).unwrap();
        let mut x = vec![1.0; n];
        factor.solve(&mut x);
        for (i, x) in x.into_iter().enumerate() {
            let k = i as f64 + 1.0;
            let exact = k * (n as f64 + 1.0 - k) / 2.0;
            assert!((x - exact).abs() <= 1e-10 * exact);
        }
        let twice: Vec<usize> = (0..n).map(|k| (k * 2) % n).collect();
        for wrong in [&order[1..], &twice] {
            let found = SymmetricFactor::ordered(&matrix, wrong).map(|f| f.size());
            assert_eq!(found, Err(SingularSystem::NoPermutation { size: n }));
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let mut triplets = TriMat::new((2, 2));
        triplets.add_triplet(0, 0, 1.0);
        triplets.add_triplet(0, 1, 2.0);
        triplets.add_triplet(1, 0, 2.0);
        triplets.add_triplet(1, 1, 1.0);
        let found = SymmetricFactor::new(&triplets.to_csr()).map(|f| f.size());
        assert_eq!(found, Err(SingularSystem::NotPositiveDefinite { size: 2 }));
    }
}
