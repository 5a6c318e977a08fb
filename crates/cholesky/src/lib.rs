//! Sparse Cholesky factorisation over plain slices.
//!
//! faer is generic to the last kernel, so that a crate that calls it compiles all of it anew with each of
//! its own changes. This one calls it once, for `f64` and `usize`, behind a face without generics. It
//! assembles nothing and knows no matrix type but compressed columns.

use faer::Side;
use faer::linalg::solvers::SolveCore;
use faer::mat::MatMut;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

/// Which triangle of the matrix is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Triangle {
    /// Entries with row at or below the column.
    Lower,
    /// Entries with row at or above the column.
    Upper,
}

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// A pivot is zero, negative or not finite.
    NotPositiveDefinite,
    /// The factor does not fit into memory or into the index type.
    TooLarge,
}

/// A factor `L Lᵀ` with an approximate minimum degree ordering. Sequential and deterministic.
#[derive(Debug, Clone)]
pub struct Factor {
    size: usize,
    factor: Llt<usize, f64>,
}

impl Factor {
    /// Factors a symmetric matrix of `size > 0` rows in compressed columns: column `j` holds the rows
    /// `indices[starts[j]..starts[j + 1]]`, ascending. Both triangles may be stored; one is read.
    ///
    /// # Errors
    /// See [`FactorError`].
    ///
    /// # Panics
    /// When the slices are no compressed columns of that size.
    pub fn new(
        size: usize,
        starts: &[usize],
        indices: &[usize],
        values: &[f64],
        triangle: Triangle,
    ) -> Result<Self, FactorError> {
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, starts, None, indices);
        let side = match triangle {
            Triangle::Lower => Side::Lower,
            Triangle::Upper => Side::Upper,
        };
        let symbolic = SymbolicLlt::try_new(pattern, side).map_err(|_| FactorError::TooLarge)?;
        let matrix = SparseColMatRef::new(pattern, values);
        let factor = Llt::try_new_with_symbolic(symbolic, matrix, side)
            .map_err(|_| FactorError::NotPositiveDefinite)?;
        Ok(Self { size, factor })
    }

    /// Solves in place; each right side is a column of `size` numbers, one after another.
    ///
    /// # Panics
    /// When the length of `columns` is not a multiple of the size.
    pub fn solve(&self, columns: &mut [f64]) {
        assert_eq!(columns.len() % self.size, 0, "right sides are whole columns");
        let count = columns.len() / self.size;
        let right = MatMut::from_column_major_slice_mut(columns, self.size, count);
        self.factor.solve_in_place_with_conj(faer::Conj::No, right);
    }
}
