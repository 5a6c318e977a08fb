//! All levels of a spline.

use super::{Level, WaveletError};
use crate::geometry::nurbs::KnotVector;

/// A spline split into a base and levels of detail.
#[derive(Debug, Clone)]
pub struct Decomposition<const D: usize> {
    /// The filters, finest first.
    pub levels: Vec<Level>,
    /// The detail of each level: one row for each wavelet.
    pub details: Vec<Vec<[f64; D]>>,
    /// Knots of the base.
    pub base_knots: KnotVector,
    /// Control points of the base.
    pub base: Vec<[f64; D]>,
}

/// Splits a spline `depth` times, or as often as knots can go when that is less often.
///
/// # Errors
/// [`WaveletError`].
pub fn decompose<const D: usize>(
    knots: &KnotVector,
    controls: &[[f64; D]],
    depth: usize,
    ends: usize,
) -> Result<Decomposition<D>, WaveletError> {
    if controls.len() != knots.n_basis() {
        return Err(WaveletError::CountMismatch { expected: knots.n_basis(), found: controls.len() });
    }
    let mut found = Decomposition {
        levels: Vec::new(),
        details: Vec::new(),
        base_knots: knots.clone(),
        base: controls.to_vec(),
    };
    while found.levels.len() < depth {
        let Some(level) = Level::new(&found.base_knots, ends)? else { break };
        let (base, detail) = level.split(&found.base)?;
        found.base_knots = level.coarse().clone();
        found.base = base;
        found.details.push(detail);
        found.levels.push(level);
    }
    Ok(found)
}

impl<const D: usize> Decomposition<D> {
    /// The control points that were split, from base and details.
    #[must_use]
    pub fn joined(&self) -> Vec<[f64; D]> {
        let coarsest_first = self.levels.iter().zip(&self.details).rev();
        coarsest_first.fold(self.base.clone(), |base, (level, detail)| level.join(&base, detail))
    }

    /// The sum of all levels of detail, each times its gain, over the finest knots: a spline of differences.
    ///
    /// Levels beyond the gains count nothing. Without a level it is zero.
    #[must_use]
    pub fn detail(&self, gains: &[f64]) -> Vec<[f64; D]> {
        self.detail_of(&self.details, gains)
    }

    /// The same with other rows for the same wavelets.
    #[must_use]
    pub fn detail_of(&self, details: &[Vec<[f64; D]>], gains: &[f64]) -> Vec<[f64; D]> {
        let mut sum = vec![[0.0; D]; self.base.len()];
        for (at, (level, detail)) in self.levels.iter().zip(details).enumerate().rev() {
            let gain = gains.get(at).copied().unwrap_or(0.0);
            let scaled: Vec<[f64; D]> = detail.iter().map(|row| row.map(|c| gain * c)).collect();
            sum = level.join(&sum, &scaled);
        }
        sum
    }
}
