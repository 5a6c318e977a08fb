//! A symmetric positive definite system whose unknowns are control points of a net, each coupled with those at most a
//! few rows and columns away: assembled in place, solved by nested dissection.

use super::Mask;
use crate::math::sparse::SingularSystem;
use crate::math::{CsMat, GridFactor, GridMatrix};

/// The system in the making: a matrix over the box of the unknowns.
#[derive(Debug, Clone)]
pub struct GridSystem {
    matrix: GridMatrix,
    /// First row and column of the box, and its count of columns.
    first: [usize; 2],
    width: usize,
    /// Columns of the net.
    columns: usize,
    /// Flat indices of the unknowns on the net.
    places: Vec<usize>,
    /// Number of the unknown at a flat index.
    number: Vec<Option<usize>>,
}

impl GridSystem {
    /// The zero matrix over the places of a set; `reach` is the greatest distance of coupled places in rows and columns.
    #[must_use]
    pub fn new(unknowns: &Mask, reach: [usize; 2]) -> Self {
        let (rows, columns) = unknowns.shape();
        let places: Vec<usize> = unknowns.indices().collect();
        let mut number = vec![None; rows * columns];
        for (k, &at) in places.iter().enumerate() {
            number[at] = Some(k);
        }
        let sides = unknowns.extent().map(|extent| extent.map(|(first, last)| (first, last + 1 - first)));
        let [(i, height), (j, width)] = sides.unwrap_or_default();
        let matrix = GridMatrix::zeros(height, width, reach);
        Self { matrix, first: [i, j], width, columns, places, number }
    }

    /// Count of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is nothing to solve.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Flat indices of the unknowns, ascending.
    #[must_use]
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// Number of the unknown at a flat index; `None` for a place that is given.
    #[must_use]
    pub fn number(&self, at: usize) -> Option<usize> {
        self.number[at]
    }

    /// Adds to the entry of the unknown of this number with the one at a flat index. The matrix is symmetric: of both
    /// orders of a pair the one counts whose second place comes first, and the other is left out.
    ///
    /// # Panics
    /// When the places are farther apart than the reach.
    pub fn add(&mut self, unknown: usize, at: usize, value: f64) {
        let own = self.places[unknown];
        if at <= own && self.number[at].is_some() {
            self.matrix.add(self.node(own), self.node(at), value);
        }
    }

    /// Place in the box.
    fn node(&self, at: usize) -> usize {
        (at / self.columns - self.first[0]) * self.width + at % self.columns - self.first[1]
    }

    fn nodes(&self) -> Vec<usize> {
        self.places.iter().map(|&at| self.node(at)).collect()
    }

    /// The lower triangle as compressed rows.
    #[must_use]
    pub fn lower(&self) -> CsMat<f64> {
        self.matrix.lower(&self.nodes())
    }

    /// The factor.
    ///
    /// # Errors
    /// [`SingularSystem`].
    pub fn factor(&self) -> Result<GridFactor, SingularSystem> {
        self.matrix.factored(&self.nodes())
    }

    /// Solves in place: a column of right sides after another, each in the order of the unknowns.
    ///
    /// # Errors
    /// [`SingularSystem`].
    pub fn solve(&self, right: &mut [f64]) -> Result<(), SingularSystem> {
        self.factor()?.unknowns().solve(right);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The five-point Laplacian with given values around: linear functions are its solutions.
    #[test]
    fn a_linear_function_is_harmonic() {
        let linear =
            |at: usize, columns: usize| 3.0 * (at / columns) as f64 - 2.0 * (at % columns) as f64 + 1.0;
        let (rows, columns) = (30, 24);
        let mut inner = Mask::empty(rows, columns);
        for i in 1..rows - 1 {
            for j in 1..columns - 1 {
                // A hole of given places.
                if (i, j) != (10, 10) {
                    inner.insert(i, j);
                }
            }
        }
        let mut system = GridSystem::new(&inner, [1, 1]);
        let mut right = vec![0.0; system.len()];
        for (k, sum) in right.iter_mut().enumerate() {
            let own = system.places()[k];
            system.add(k, own, 4.0);
            for at in [own - columns, own - 1, own + 1, own + columns] {
                system.add(k, at, -1.0);
                if system.number(at).is_none() {
                    *sum += linear(at, columns);
                }
            }
        }
        system.solve(&mut right).unwrap();
        for (x, &at) in right.iter().zip(system.places()) {
            assert!((x - linear(at, columns)).abs() < 1e-11);
        }
    }
}
