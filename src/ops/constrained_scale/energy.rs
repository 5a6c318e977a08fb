//! The quadratic energy of a displacement field over the net.

use super::sampling::mean_lengths;
use super::scaling::Energy;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::CsMat;
use crate::ops::net::grams::Grams;

/// Points in each direction at which the physical size of the domain is measured.
const SIZE_SAMPLES: usize = 33;

/// The energy matrix of one face, the same for x, y and z.
#[derive(Debug, Clone)]
pub struct EnergyMatrix {
    /// Symmetric, positive definite on the free points; control point `(i, j)` is row `i * nv + j`.
    pub matrix: CsMat<f64>,
    /// What makes the energies of several faces comparable: one over the product of their mean lengths.
    pub per_area: f64,
}

/// The energy of a face, `scaled` being its plainly scaled surface.
#[must_use]
pub fn energy_matrix(scaled: &NurbsSurface, energy: Energy) -> EnergyMatrix {
    let [length_u, length_v] = mean_lengths(scaled, SIZE_SAMPLES);
    let per_area = 1.0 / (length_u * length_v);
    let matrix = match energy {
        Energy::Slide => {
            // A domain of area 1 in the proportions of the part: no unit, knot range or direction matters.
            let side = (length_u / length_v).sqrt();
            Grams::new(scaled, [side, 1.0 / side]).bending()
        }
        Energy::Published => published(scaled),
    };
    EnergyMatrix { matrix, per_area }
}

/// Bending, stretching and mass, each weighted by its own energy in the scaled surface: equations (16) to (20).
fn published(scaled: &NurbsSurface) -> CsMat<f64> {
    let grams = Grams::new(scaled, [1.0, 1.0]);
    let parts = [grams.bending(), grams.stretching_with_cross(), grams.mass()];
    let weights: Vec<f64> = parts.iter().map(|part| quadratic_form(part, scaled.net())).collect();
    let sum: f64 = weights.iter().sum();
    let [bending, stretching, mass] = parts;
    let weighted = |part: CsMat<f64>, k: usize| part.map(|x| x * (weights[k] / sum));
    &(&weighted(bending, 0) + &weighted(stretching, 1)) + &weighted(mass, 2)
}

/// Sum of `xᵀ K x` over the four homogeneous coordinates of a net.
fn quadratic_form(matrix: &CsMat<f64>, net: &[[f64; 4]]) -> f64 {
    let mut sum = 0.0;
    for (row, entries) in matrix.outer_iterator().enumerate() {
        for (column, value) in entries.iter() {
            let product: f64 = net[row].iter().zip(&net[column]).map(|(a, b)| a * b).sum();
            sum += value * product;
        }
    }
    sum
}
