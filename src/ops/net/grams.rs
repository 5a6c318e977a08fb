//! Exact quadratic energies over a net: Gram matrices of both directions, and their Kronecker products.

use crate::geometry::nurbs::{NurbsSurface, gram};
use crate::math::{CsMat, kronecker_product};

/// Gram matrices of both directions over a domain of given sides.
#[derive(Debug, Clone)]
pub struct Grams {
    /// `(0,0)`, `(1,1)`, `(2,2)` of `u`, then of `v`.
    u: [CsMat<f64>; 3],
    v: [CsMat<f64>; 3],
    /// `(1,0)` of `u`, and the transpose of that of `v`.
    mixed: [CsMat<f64>; 2],
}

impl Grams {
    /// The matrices of a surface whose domain is mapped to the given sides.
    #[must_use]
    pub fn new(surface: &NurbsSurface, sides: [f64; 2]) -> Self {
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
    #[must_use]
    pub fn bending(&self) -> CsMat<f64> {
        let (u, v) = (&self.u, &self.v);
        let twist = kronecker(&u[1], &v[1]).map(|x| 2.0 * x);
        &(&kronecker(&u[2], &v[0]) + &twist) + &kronecker(&u[0], &v[2])
    }

    /// Integral of `X_u² + X_v² + 2 X_u X_v`.
    #[must_use]
    pub fn stretching_with_cross(&self) -> CsMat<f64> {
        let stretch = &kronecker(&self.u[1], &self.v[0]) + &kronecker(&self.u[0], &self.v[1]);
        let cross = kronecker(&self.mixed[0], &self.mixed[1]);
        &(&stretch + &cross) + &cross.clone().transpose_into().to_csr()
    }

    /// Integral of `X²`.
    #[must_use]
    pub fn mass(&self) -> CsMat<f64> {
        kronecker(&self.u[0], &self.v[0])
    }
}

fn kronecker(a: &CsMat<f64>, b: &CsMat<f64>) -> CsMat<f64> {
    kronecker_product(a.view(), b.view())
}
