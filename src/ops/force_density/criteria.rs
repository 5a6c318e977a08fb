//! What is made least: four measures of the network, and weighted sums of them.
//!
//! All have the form `½ eᵀ G e + Hᵀ e` in the displacements `e`, with a common factor ½, so that they may be added.

use super::ForceDensityError;
use super::network::{Network, of};
use crate::math::{GridMatrix, GridRow};

/// Weights of the measures; none is negative, and one is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// Of the change of the forces, `|D e|²`: the shape between the constraints bends as the old one did.
    pub force_variation: f64,
    /// Of the forces, `|f + D e|²`: the net is drawn to balance, as a membrane is.
    pub force: f64,
    /// Of the bars' lengths times their densities, `lᵀ Q l`.
    pub bar_length: f64,
    /// Of the displacements, `|e|²`: only what the constraints reach moves.
    pub displacement: f64,
}

impl Criteria {
    /// No measure: to be filled in.
    pub const NONE: Self = Self { force_variation: 0.0, force: 0.0, bar_length: 0.0, displacement: 0.0 };

    /// The same measures on a net that was refined until its bars were `share` times as long: sums over more and shorter bars
    /// count otherwise, and without this a finer net would be another problem.
    #[must_use]
    pub fn refined(&self, share: f64) -> Self {
        // Forces go with the square of a bar's length, per node: those of all nodes together with its square.
        let square = share * share;
        Self {
            bar_length: self.bar_length * square,
            displacement: self.displacement * square * square,
            ..*self
        }
    }

    /// # Errors
    /// [`ForceDensityError::NotPositive`].
    pub(super) fn check(&self) -> Result<(), ForceDensityError> {
        let all = [self.force_variation, self.force, self.bar_length, self.displacement];
        match all.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
            Some(&found) => {
                Err(ForceDensityError::NotPositive { what: "a weight of what is minimised", found })
            }
            None if all.iter().sum::<f64>() > 0.0 => Ok(()),
            None => Err(ForceDensityError::NotPositive { what: "the sum of the weights", found: 0.0 }),
        }
    }

    /// `G` and `H` over the nodes; rows of nodes that are not free have no meaning.
    pub(super) fn quadratic(
        &self,
        network: &Network,
        points: &[[f64; 3]],
        reach: [usize; 2],
    ) -> (GridMatrix, Vec<[f64; 3]>) {
        let [rows, columns] = network.shape();
        let mut g = GridMatrix::zeros(rows, columns, reach);
        let mut h = vec![[0.0; 3]; points.len()];
        if self.force_variation + self.force > 0.0 {
            let forces = if self.force > 0.0 { network.forces(points) } else { vec![[0.0; 3]; points.len()] };
            for (row, force) in network.force_rows().iter().zip(forces) {
                g.add_outer(row, self.force_variation + self.force);
                row.add_to(columns, &force.map(|f| self.force * f), &mut h);
            }
        }
        if self.bar_length > 0.0 {
            self.add_bars(network, points, &mut g, &mut h);
        }
        (0..points.len()).for_each(|a| g.add_diagonal(a, self.displacement));
        (g, h)
    }

    fn add_bars(&self, network: &Network, points: &[[f64; 3]], g: &mut GridMatrix, h: &mut [[f64; 3]]) {
        let columns = network.shape()[1];
        for bar in network.bars() {
            let factor = self.bar_length * bar.density;
            let before = of(&bar.before, points);
            let row = between(bar.change, columns);
            g.add_outer(&row, factor);
            row.add_to(columns, &before.map(|b| factor * b), h);
        }
    }
}

/// Two nodes on a line of the net, or one twice, as a row.
fn between(ends: [(usize, f64); 2], columns: usize) -> GridRow {
    let [(a, x), (b, y)] = ends;
    if a == b {
        return GridRow { first: [a / columns, a % columns], shape: [1, 1], values: vec![x + y] };
    }
    let ((a, x), (b, y)) = if a < b { ((a, x), (b, y)) } else { ((b, y), (a, x)) };
    let shape = if a / columns == b / columns { [1, 2] } else { [2, 1] };
    GridRow { first: [a / columns, a % columns], shape, values: vec![x, y] }
}
