//! B-spline surfaces: two knot vectors and a flat homogeneous net.

use super::curve::check_net;
use super::{KnotVector, NetError};

/// A tensor-product surface over homogeneous points `(w x, w y, w z, w)`.
///
/// Control point `(i, j)` stands at `i * nv + j`; `i` runs with `u`.
///
/// INVARIANT: `net.len() == knots_u.n_basis() * knots_v.n_basis()`, all finite, all weights positive.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsSurface {
    knots_u: KnotVector,
    knots_v: KnotVector,
    net: Vec<[f64; 4]>,
}

impl NurbsSurface {
    /// Checks and takes a net of homogeneous points.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn new(knots_u: KnotVector, knots_v: KnotVector, net: Vec<[f64; 4]>) -> Result<Self, NetError> {
        check_net(&net, knots_u.n_basis() * knots_v.n_basis())?;
        Ok(Self { knots_u, knots_v, net })
    }

    /// Takes a net that keeps the invariants by construction.
    pub(super) fn new_unchecked(knots_u: KnotVector, knots_v: KnotVector, net: Vec<[f64; 4]>) -> Self {
        Self { knots_u, knots_v, net }
    }

    /// Knots of the first parameter.
    #[must_use]
    pub fn knots_u(&self) -> &KnotVector {
        &self.knots_u
    }

    /// Knots of the second parameter.
    #[must_use]
    pub fn knots_v(&self) -> &KnotVector {
        &self.knots_v
    }

    /// The homogeneous net, row-major in `u`.
    #[must_use]
    pub fn net(&self) -> &[[f64; 4]] {
        &self.net
    }

    /// Rows (along `u`) and columns (along `v`) of the net.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.knots_u.n_basis(), self.knots_v.n_basis())
    }

    /// Whether some weight differs from the others.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.net.iter().any(|p| p[3].to_bits() != self.net[0][3].to_bits())
    }
}
