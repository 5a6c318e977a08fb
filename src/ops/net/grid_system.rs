//! A symmetric positive definite system whose unknowns are control points of a net, each coupled with those at most a
//! few rows and columns away: assembled in place, solved by nested dissection.

use super::Mask;
use crate::math::sparse::{SingularSystem, SymmetricFactor};
use crate::math::{CsMat, nested_dissection};

/// The system in the making.
///
/// INVARIANT: unknowns are numbered by ascending flat index; the stencil of one has a slot for each place up to itself
/// that is within reach.
#[derive(Debug, Clone)]
pub struct GridSystem {
    columns: usize,
    reach: [usize; 2],
    /// Flat indices of the unknowns.
    places: Vec<usize>,
    /// Number of the unknown at a flat index.
    number: Vec<Option<usize>>,
    /// Entries with places before and at the unknown's own, row by row of the grid.
    stencils: Vec<f64>,
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
        let stencils = vec![0.0; places.len() * slots(reach)];
        Self { columns, reach, places, number, stencils }
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
    /// orders of a pair the one counts whose place comes first, and the other is left out.
    ///
    /// # Panics
    /// When the places are farther apart than the reach.
    pub fn add(&mut self, unknown: usize, at: usize, value: f64) {
        let own = self.places[unknown];
        if at > own || self.number[at].is_none() {
            return;
        }
        let (back, across) = (own / self.columns - at / self.columns, at % self.columns + self.reach[1]);
        let column = across - own % self.columns;
        assert!(back <= self.reach[0] && column <= 2 * self.reach[1], "coupled places are within reach");
        let slot = (self.reach[0] - back) * (2 * self.reach[1] + 1) + column;
        self.stencils[unknown * slots(self.reach) + slot] += value;
    }

    /// The lower triangle as compressed rows.
    #[must_use]
    pub fn matrix(&self) -> CsMat<f64> {
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        let width = 2 * self.reach[1] + 1;
        for (own, stencil) in self.places.iter().zip(self.stencils.chunks_exact(slots(self.reach))) {
            let (row, column) = (own / self.columns, own % self.columns);
            for (slot, value) in stencil.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                // Entries were added at places that exist.
                let at = (row + slot / width - self.reach[0]) * self.columns + column + slot % width
                    - self.reach[1];
                indices.extend(self.number[at]);
                values.push(*value);
            }
            starts.push(indices.len());
        }
        CsMat::new((self.len(), self.len()), starts, indices, values)
    }

    /// The factor.
    ///
    /// # Errors
    /// [`SingularSystem`].
    pub fn factor(&self) -> Result<SymmetricFactor, SingularSystem> {
        let places: Vec<[usize; 2]> =
            self.places.iter().map(|at| [at / self.columns, at % self.columns]).collect();
        SymmetricFactor::ordered(&self.matrix(), &nested_dissection(&places, self.reach))
    }

    /// Solves in place: a column of right sides after another, each in the order of the unknowns.
    ///
    /// # Errors
    /// [`SingularSystem`].
    pub fn solve(&self, right: &mut [f64]) -> Result<(), SingularSystem> {
        self.factor()?.solve(right);
        Ok(())
    }
}

/// Slots of one stencil: whole rows before the own one, and that up to the own place.
fn slots(reach: [usize; 2]) -> usize {
    reach[0] * (2 * reach[1] + 1) + reach[1] + 1
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
        for k in 0..system.len() {
            let own = system.places()[k];
            system.add(k, own, 4.0);
            for at in [own - columns, own - 1, own + 1, own + columns] {
                system.add(k, at, -1.0);
                if system.number(at).is_none() {
                    right[k] += linear(at, columns);
                }
            }
        }
        system.solve(&mut right).unwrap();
        for (x, &at) in right.iter().zip(system.places()) {
            assert!((x - linear(at, columns)).abs() < 1e-11);
        }
    }
}
