//! Gram matrices of B-spline bases: integrals of products of derivatives over the whole domain.
//!
//! Exact: `p + 1` Gauss-Legendre points on every span, for products of degree up to `2 p`.

use super::KnotVector;
use crate::math::{CsMat, TriMat, quadrature::gauss_legendre};

/// `G[i][k] = ∫ N_i^(a) N_k^(b) du` as an `n x n` matrix in compressed rows with sorted columns; orders `a`
/// and `b` are at most 2.
///
/// # Panics
/// For an order above 2.
#[must_use]
pub fn gram(knots: &KnotVector, a: usize, b: usize) -> CsMat<f64> {
    let (p, n) = (knots.degree(), knots.n_basis());
    let width = 2 * p + 1;
    let band = gram_band(knots, a, b);
    let mut triplets = TriMat::with_capacity((n, n), n * width);
    for i in 0..n {
        for k in i.saturating_sub(p)..(i + p + 1).min(n) {
            triplets.add_triplet(i, k, band[i * width + k + p - i]);
        }
    }
    triplets.to_csr()
}

/// The same matrix in band storage: row `i` holds the columns `i - p ..= i + p`, so that `G[i][k]` stands at
/// `i (2 p + 1) + k + p - i`; what lies beside the matrix is zero.
///
/// # Panics
/// For an order above 2.
#[must_use]
pub fn gram_band(knots: &KnotVector, a: usize, b: usize) -> Vec<f64> {
    assert!(a <= 2 && b <= 2, "derivatives above the second are not offered");
    let (p, n) = (knots.degree(), knots.n_basis());
    let width = 2 * p + 1;
    let mut band = vec![0.0; n * width];
    let (nodes, weights) = gauss_legendre(p + 1);
    for span in knots.spans() {
        let (low, high) = (knots.knots()[span], knots.knots()[span + 1]);
        let (half, middle) = (0.5 * (high - low), 0.5 * (low + high));
        for (x, w) in nodes.iter().zip(&weights) {
            let basis = knots.basis_of_span(span, middle + half * x, a.max(b));
            let first = basis.first();
            for (i, left) in basis.derivatives(a).iter().enumerate() {
                for (k, right) in basis.derivatives(b).iter().enumerate() {
                    band[(first + i) * width + k + p - i] += w * half * left * right;
                }
            }
        }
    }
    band
}
