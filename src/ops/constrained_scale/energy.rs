//! The quadratic energy of a displacement field over the net: exact Gram matrices, Kronecker products.

use super::sampling::mean_lengths;
use super::scaling::Energy;
use crate::geometry::nurbs::{NurbsSurface, gram};
use crate::math::{CsMat, kronecker_product};

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

/// Gram matrices of both directions over a domain of given sides.
struct Grams {
    /// `(0,0)`, `(1,1)`, `(2,2)` of `u`, then of `v`.
    u: [CsMat<f64>; 3],
    v: [CsMat<f64>; 3],
    /// `(1,0)` of `u`, and the transpose of that of `v`.
    mixed: [CsMat<f64>; 2],
}

impl Grams {
    fn new(surface: &NurbsSurface, sides: [f64; 2]) -> Self {
        let of = |k: usize, a: usize, b: usize| {
            let knots = if k == 0 { surface.knots_u() } else { surface.knots_v() };
            let (start, end) = knots.domain();
            // Knots mapped by x -> s x: an integral of two derivatives of orders a and b scales by s^(1-a-b).
            let scale = sides[k] / (end - start);
            gram(knots, a, b).map(|x| x * scale.powi(1 - (a + b) as i32))
        };
        let equal = |k: usize| [of(k, 0, 0), of(k, 1, 1), of(k, 2, 2)];
        Self { u: equal(0), v: equal(1), mixed: [of(0, 1, 0), of(1, 1, 0).transpose_into().to_csr()] }
    }

    /// Integral of `X_uu² + 2 X_uv² + X_vv²`.
    fn bending(&self) -> CsMat<f64> {
        let (u, v) = (&self.u, &self.v);
        let twist = kronecker(&u[1], &v[1]).map(|x| 2.0 * x);
        &(&kronecker(&u[2], &v[0]) + &twist) + &kronecker(&u[0], &v[2])
    }

    /// Integral of `X_u² + X_v² + 2 X_u X_v`.
    fn stretching_with_cross(&self) -> CsMat<f64> {
        let stretch = &kronecker(&self.u[1], &self.v[0]) + &kronecker(&self.u[0], &self.v[1]);
        let cross = kronecker(&self.mixed[0], &self.mixed[1]);
        &(&stretch + &cross) + &cross.clone().transpose_into().to_csr()
    }

    /// Integral of `X²`.
    fn mass(&self) -> CsMat<f64> {
        kronecker(&self.u[0], &self.v[0])
    }
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

fn kronecker(a: &CsMat<f64>, b: &CsMat<f64>) -> CsMat<f64> {
    kronecker_product(a.view(), b.view())
}
