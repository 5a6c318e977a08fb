//! B-spline surfaces: two knot vectors and a flat homogeneous net.

use super::curve::check_net;
use super::{KnotVector, NetError};
use crate::math::BoundingBox;
use std::sync::OnceLock;

/// A tensor-product surface over homogeneous points `(w x, w y, w z, w)`.
///
/// Control point `(i, j)` stands at `i * nv + j`; `i` runs with `u`.
///
/// INVARIANT: `net.len() == knots_u.n_basis() * knots_v.n_basis()`, all finite, all weights positive.
#[derive(Debug, Clone)]
pub struct NurbsSurface {
    knots_u: KnotVector,
    knots_v: KnotVector,
    net: Vec<[f64; 4]>,
    /// Found when first asked for; the surface never changes.
    extent: OnceLock<Extent>,
}

/// What a net spans.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// Box of the control points.
    pub(super) bounds: BoundingBox,
    /// Greatest distance between control points of the first and the last curve of constant `u`, and of constant `v`.
    pub(super) apart: [f64; 2],
}

impl PartialEq for NurbsSurface {
    fn eq(&self, other: &Self) -> bool {
        (&self.knots_u, &self.knots_v, &self.net) == (&other.knots_u, &other.knots_v, &other.net)
    }
}

impl NurbsSurface {
    /// Checks and takes a net of homogeneous points.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn new(knots_u: KnotVector, knots_v: KnotVector, net: Vec<[f64; 4]>) -> Result<Self, NetError> {
        check_net(&net, knots_u.n_basis() * knots_v.n_basis())?;
        Ok(Self::new_unchecked(knots_u, knots_v, net))
    }

    /// Takes a net that keeps the invariants by construction.
    pub(super) fn new_unchecked(knots_u: KnotVector, knots_v: KnotVector, net: Vec<[f64; 4]>) -> Self {
        Self { knots_u, knots_v, net, extent: OnceLock::new() }
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

    /// What the net spans, found once.
    pub(super) fn extent(&self, find: impl FnOnce() -> Extent) -> &Extent {
        self.extent.get_or_init(find)
    }

    /// Whether some weight differs from the others.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.net.iter().any(|p| p[3].to_bits() != self.net[0][3].to_bits())
    }
}
