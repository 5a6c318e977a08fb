//! Sparse Cholesky factorisation over plain slices.
//!
//! faer is generic to the last kernel, so that a crate that calls it compiles all of it anew with each of
//! its own changes. This one calls it once, for `f64` and `usize`, behind a face without generics. It
//! assembles nothing and knows no matrix type but compressed columns.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::mat::MatMut;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side};

/// Which triangle of the matrix is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Triangle {
    /// Entries with row at or below the column.
    Lower,
    /// Entries with row at or above the column.
    Upper,
}

/// In which order the unknowns are eliminated. It decides time and memory, not the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordering<'a> {
    /// An approximate minimum degree order, found from the pattern alone.
    MinimumDegree,
    /// This one: a permutation of all unknowns, first to last.
    Given(&'a [usize]),
}

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// A pivot is zero, negative or not finite.
    NotPositiveDefinite,
    /// The factor does not fit into memory or into the index type.
    TooLarge,
    /// The given order is no permutation of the unknowns.
    NoPermutation,
}

/// A factor `L Lᵀ` of the reordered matrix. Sequential and deterministic.
#[derive(Debug, Clone)]
pub struct Factor {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
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
        ordering: Ordering<'_>,
    ) -> Result<Self, FactorError> {
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, starts, None, indices);
        let side = match triangle {
            Triangle::Lower => Side::Lower,
            Triangle::Upper => Side::Upper,
        };
        let inverse;
        let order = match ordering {
            Ordering::MinimumDegree => SymmetricOrdering::Amd,
            Ordering::Given(order) => {
                inverse = inverted(order, size).ok_or(FactorError::NoPermutation)?;
                SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, size))
            }
        };
        let symbolic = factorize_symbolic_cholesky(pattern, side, order, Default::default());
        let symbolic = symbolic.map_err(|_| FactorError::TooLarge)?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut scratch = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
        let mut factor = Vec::new();
        factor.try_reserve_exact(symbolic.len_val()).map_err(|_| FactorError::TooLarge)?;
        factor.resize(symbolic.len_val(), 0.0);
        let done = symbolic.factorize_numeric_llt(
            &mut factor,
            SparseColMatRef::new(pattern, values),
            side,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut scratch),
            Default::default(),
        );
        done.map_err(|_| FactorError::NotPositiveDefinite)?;
        Ok(Self { symbolic: Arc::new(symbolic), values: factor })
    }

    /// Count of the factor's stored numbers: 8 bytes each.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// Solves in place; each right side is a column of `size` numbers, one after another.
    ///
    /// # Panics
    /// When the length of `columns` is not a multiple of the size.
    pub fn solve(&self, columns: &mut [f64]) {
        let size = self.symbolic.nrows();
        assert_eq!(columns.len() % size, 0, "right sides are whole columns");
        let count = columns.len() / size;
        let right = MatMut::from_column_major_slice_mut(columns, size, count);
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(count, Par::Seq);
        let mut scratch = MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right,
            Par::Seq,
            MemStack::new(&mut scratch),
        );
    }
}

/// The inverse of a permutation of `size` numbers; `None` when it is none.
fn inverted(order: &[usize], size: usize) -> Option<Vec<usize>> {
    let mut inverse = vec![usize::MAX; size];
    for (at, &unknown) in order.iter().enumerate() {
        let place = inverse.get_mut(unknown).filter(|place| **place == usize::MAX)?;
        *place = at;
    }
    (order.len() == size).then_some(inverse)
}
