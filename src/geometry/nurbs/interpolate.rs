//! Interpolation at the Greville abscissae: banded collocation, tensor product for surfaces.

use super::KnotVector;
use crate::math::banded::{Banded, BandedFactor, SingularBand};

/// LU factors of the collocation matrix `N_j(g_i)` at the Greville abscissae of a knot vector.
#[derive(Debug, Clone)]
pub struct GrevilleCollocation {
    abscissae: Vec<f64>,
    factor: BandedFactor,
}

impl GrevilleCollocation {
    /// Factors the collocation matrix.
    ///
    /// # Errors
    /// [`SingularBand`] when an interior knot occurs `degree + 1` times, so that abscissae coincide.
    pub fn new(knots: &KnotVector) -> Result<Self, SingularBand> {
        let abscissae = knots.greville();
        let p = knots.degree();
        let mut matrix = Banded::zeros(abscissae.len(), p, p);
        for (i, &g) in abscissae.iter().enumerate() {
            let basis = knots.basis_derivatives(g, 0);
            for (j, value) in basis.values().iter().enumerate() {
                if *value != 0.0 {
                    matrix.add(i, basis.first() + j, *value);
                }
            }
        }
        Ok(Self { abscissae, factor: matrix.factored()? })
    }

    /// The Greville abscissae.
    #[must_use]
    pub fn abscissae(&self) -> &[f64] {
        &self.abscissae
    }

    /// Values at the abscissae become control points, in place: `n` rows of `width` numbers.
    ///
    /// # Panics
    /// When the length of `rows` is not `n * width`.
    pub fn solve_rows(&self, rows: &mut [f64], width: usize) {
        self.factor.solve_rows(rows, width);
    }
}

/// Values over the grid of Greville abscissae, `nu x nv` points of `width` numbers row by row in `u`, become
/// the control net, in place.
///
/// # Panics
/// When the length of `values` is not `nu * nv * width`.
pub fn interpolate_grid(u: &GrevilleCollocation, v: &GrevilleCollocation, values: &mut [f64], width: usize) {
    let nv = v.abscissae.len();
    u.solve_rows(values, nv * width);
    for row in values.chunks_exact_mut(nv * width) {
        v.solve_rows(row, width);
    }
}
