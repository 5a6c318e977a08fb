//! Multiresolution of B-spline curves: nested spline spaces and semi-orthogonal wavelets of least support.
//!
//! A spline over clamped knots, uniform or not, is split into one over every other knot, the best in the mean
//! square, and detail in a wavelet basis; again and again, until no knot can go. Splitting and joining take time
//! and memory linear in the count of control points: two banded symmetric solves for each level, and no inverse.
//!
//! With an *end order* `k` the first and the last `k` control points are the same on all levels, so that position
//! and derivatives below order `k` at both ends belong to the base and no wavelet moves them; `k = 0` is the
//! plain projection.
//!
//! Does not know rational or closed curves, nor what detail is good for.
//!
//! Source: Finkelstein and Salesin, Multiresolution curves (1994), for the end-interpolating hierarchy; Lyche,
//! Mørken and Quak, Theory and algorithms for non-uniform spline wavelets (2001), for arbitrary knots. The
//! end order and the rules of knots, order, sign and norm are our own: `docs/decisions/detail-transfer.md`.

mod coarsen;
mod decompose;
mod level;
mod null_vector;
mod refinement;
#[cfg(test)]
mod tests;
mod wavelets;

pub use coarsen::{Coarsened, coarsened};
pub use decompose::{Decomposition, decompose};
pub use level::Level;
pub use refinement::Refinement;

/// Why knots have no hierarchy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WaveletError {
    /// The ends are no control points.
    #[error("the knots are not clamped")]
    NotClamped,
    /// An interior knot tears the curve.
    #[error("knot {knot} occurs {multiplicity} times, which tears a curve of degree {degree}")]
    Torn {
        /// The knot.
        knot: f64,
        /// How often it occurs.
        multiplicity: usize,
        /// Degree of the curve.
        degree: usize,
    },
    /// The end order is above the degree.
    #[error("the end order {ends} is above the degree {degree}")]
    EndOrder {
        /// End order.
        ends: usize,
        /// Degree of the curve.
        degree: usize,
    },
    /// The number of control points is not that of the knots.
    #[error("{expected} control points expected, found {found}")]
    CountMismatch {
        /// Count that the knots ask for.
        expected: usize,
        /// Count given.
        found: usize,
    },
    /// Knots so uneven that double precision loses the wavelets, or corners with nothing to remove between them.
    #[error("no wavelet basis was found near the parameter {at}")]
    NoBasis {
        /// Where.
        at: f64,
    },
}
