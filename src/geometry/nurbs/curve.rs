//! B-spline curves: a knot vector and a flat homogeneous net.

use super::{KnotVector, NetError};

/// A curve over homogeneous points of `H` coordinates, the last of them the weight.
///
/// INVARIANT: `points.len() == knots.n_basis()`, all finite, all weights positive.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsCurve<const H: usize> {
    knots: KnotVector,
    points: Vec<[f64; H]>,
}

/// A curve in the plane: points `(w x, w y, w)`.
pub type NurbsCurve2 = NurbsCurve<3>;
/// A curve in space: points `(w x, w y, w z, w)`.
pub type NurbsCurve3 = NurbsCurve<4>;

impl<const H: usize> NurbsCurve<H> {
    /// Checks and takes a net of homogeneous points.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn new(knots: KnotVector, points: Vec<[f64; H]>) -> Result<Self, NetError> {
        check_net(&points, knots.n_basis())?;
        Ok(Self { knots, points })
    }

    /// Takes a net that keeps the invariants by construction.
    pub(super) fn new_unchecked(knots: KnotVector, points: Vec<[f64; H]>) -> Self {
        Self { knots, points }
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The homogeneous net.
    #[must_use]
    pub fn points(&self) -> &[[f64; H]] {
        &self.points
    }

    /// Whether some weight differs from the others.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.points.iter().any(|p| p[H - 1].to_bits() != self.points[0][H - 1].to_bits())
    }
}

/// Checks count, finiteness and weights of a flat homogeneous net.
pub(super) fn check_net<const H: usize>(points: &[[f64; H]], expected: usize) -> Result<(), NetError> {
    if points.len() != expected {
        return Err(NetError::CountMismatch { expected, found: points.len() });
    }
    for (index, point) in points.iter().enumerate() {
        if !point.iter().all(|c| c.is_finite()) {
            return Err(NetError::NotFinite { index });
        }
        let weight = point[H - 1];
        if weight <= 0.0 {
            return Err(NetError::NonPositiveWeight { index, weight });
        }
    }
    Ok(())
}
