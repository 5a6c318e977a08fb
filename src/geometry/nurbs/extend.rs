//! Exact extension over a larger domain: the polynomials of the end spans go on.
//!
//! The end knots move outwards, and each control point whose function reaches an end becomes the polar form (blossom) of
//! the end span's polynomial at its knots. Inside the old domain nothing changes; outside, a
//! polynomial far from where it was meant may do anything, which is the caller's business.

use super::refine::to_points;
use super::{KnotVector, NurbsSurface};

/// A surface that cannot be extended.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExtensionError {
    /// A length that is no finite number of at least 0.
    #[error("a domain cannot be extended by {length}")]
    Length {
        /// Length in parameters.
        length: f64,
    },
    /// The weight function of a rational surface is not positive out there.
    #[error("the weights of the extended surface are not positive (control point {index})")]
    Weight {
        /// Index in the flat net.
        index: usize,
    },
}

/// Knots with the ends moved outwards by `(before, after)`.
fn moved_ends(knots: &KnotVector, (before, after): (f64, f64)) -> Result<KnotVector, ExtensionError> {
    for length in [before, after] {
        if !(length.is_finite() && length >= 0.0) {
            return Err(ExtensionError::Length { length });
        }
    }
    let (p, n) = (knots.degree(), knots.n_basis());
    let mut all = knots.knots().to_vec();
    let (start, end) = knots.domain();
    all[..=p].fill(start - before);
    all[n..].fill(end + after);
    KnotVector::new(p, all).map_err(|_| ExtensionError::Length { length: before.max(after) })
}

/// Rows of the same curve over the extended knots; `knots` are clamped.
///
/// The copies of an end in the polar forms are replaced one after the other, each by going on along the line between two
/// forms that differ in it alone (the steps of A12.1 of The NURBS Book). Steps are in parts of the widest interval there is.
fn extended_rows(knots: &KnotVector, extended: &KnotVector, rows: &[f64], width: usize) -> Vec<f64> {
    let (p, n) = (knots.degree(), knots.n_basis());
    let (old, new) = (knots.domain(), extended.domain());
    let mut all = knots.knots().to_vec();
    let mut out = rows.to_vec();
    for k in 1..=p {
        for i in 0..=p - k {
            let share = (new.0 - old.0) / (all[p + i + 1] - old.0);
            towards(&mut out, width, (i, i + 1), share);
        }
    }
    all[..=p].fill(new.0);
    for k in 1..=p {
        for i in 0..=p - k {
            let share = (new.1 - old.1) / (all[n - 1 - i] - old.1);
            towards(&mut out, width, (n - 1 - i, n - 2 - i), share);
        }
    }
    out
}

/// Moves a row by a share of the way to another; nothing moves for a share of 0.
fn towards(rows: &mut [f64], width: usize, (row, other): (usize, usize), share: f64) {
    for c in 0..width {
        rows[row * width + c] += share * (rows[other * width + c] - rows[row * width + c]);
    }
}

impl NurbsSurface {
    /// The same surface over a domain that is longer at its four sides by the given lengths in parameters, before and
    /// after along `u` and along `v`.
    ///
    /// # Errors
    /// [`ExtensionError`].
    pub fn extended(&self, u: (f64, f64), v: (f64, f64)) -> Result<Self, ExtensionError> {
        let surface = self.clamped().extended_u(u)?.swapped().extended_u(v)?.swapped();
        let bad = surface.weights().position(|w| !(w.is_finite() && w > 0.0));
        bad.map_or(Ok(surface), |index| Err(ExtensionError::Weight { index }))
    }

    fn extended_u(&self, lengths: (f64, f64)) -> Result<Self, ExtensionError> {
        if lengths == (0.0, 0.0) {
            return Ok(self.clone());
        }
        let knots = moved_ends(self.knots_u(), lengths)?;
        let rows = extended_rows(self.knots_u(), &knots, self.net().as_flattened(), 4 * self.shape().1);
        Ok(Self::from_valid(knots, self.knots_v().clone(), to_points(&rows)))
    }
}
