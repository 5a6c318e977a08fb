//! The radius along a line from the radii of single slices, against gross outliers.
//!
//! Tukey's biweight, started from the weighted median without slope. Radii of short arcs scatter far and skew, their
//! curvatures hardly do: the law is fitted to the curvatures, linearised about itself.

use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::math::{Matrix2, Vector2};

/// The radius of one slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SliceRadius {
    /// Length along the line.
    pub at: f64,
    /// Radius.
    pub radius: f64,
    /// Deviation of the radius for points of deviation 1, from the arc's angle and the count of points alone: the
    /// scatter of the points themselves would favour small radii.
    pub deviation: f64,
}

/// A law `mean + slope (s - middle)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearLaw {
    /// Value at the middle.
    pub mean: f64,
    /// Change per length.
    pub slope: f64,
    /// Middle of the lengths that it was made from.
    pub middle: f64,
    /// Standard errors of mean and slope.
    pub errors: [f64; 2],
    /// Values that were not outliers.
    pub kept: usize,
}

/// Constant of the biweight: 95 % of the efficiency of least squares.
const BIWEIGHT: f64 = 4.685;
/// Rounds of re-weighting, and of the linearisation about the law.
const ROUNDS: (usize, usize) = (30, 12);
/// Range of a law, in medians.
const RANGE: [f64; 2] = [0.2, 5.0];

impl LinearLaw {
    /// The value at a length.
    #[must_use]
    pub fn at(&self, s: f64) -> f64 {
        self.mean + self.slope * (s - self.middle)
    }

    /// A robust line through `(s, value, deviation)`; `None` for fewer than three, or when all lie at one length.
    #[must_use]
    pub fn through(values: &[(f64, f64, f64)]) -> Option<Self> {
        let n = values.len();
        if n < 3 {
            return None;
        }
        let middle = values.iter().map(|(s, ..)| s).sum::<f64>() / n as f64;
        let scale = median(values.iter().map(|(.., d)| d.powi(-2)).collect());
        let weights: Vec<f64> = values.iter().map(|(.., d)| d.powi(-2) / scale).collect();
        let mut law = [weighted_median(values, &weights), 0.0];
        let mut tukey = vec![1.0; n];
        let off = |law: [f64; 2], (s, value, _): &(f64, f64, f64)| value - law[0] - law[1] * (s - middle);
        let mut inverse = Matrix2::zeros();
        for _ in 0..ROUNDS.0 {
            let scaled = |k: usize| off(law, &values[k]).abs() * weights[k].sqrt();
            let deviation = MEDIAN_TO_DEVIATION * median((0..n).map(scaled).collect());
            let deviation = deviation.max(1e-9 * law[0].abs().max(1e-9));
            for (k, weight) in tukey.iter_mut().enumerate() {
                let t = (scaled(k) / (BIWEIGHT * deviation)).min(1.0);
                *weight = (1.0 - t * t).powi(2);
            }
            let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
            for (k, (s, value, _)) in values.iter().enumerate() {
                let row = Vector2::new(1.0, s - middle);
                normal += row * row.transpose() * (weights[k] * tukey[k]);
                right += row * (weights[k] * tukey[k] * value);
            }
            inverse = normal.try_inverse()?;
            let next: [f64; 2] = (inverse * right).into();
            let moved = (next[0] - law[0]).abs().max((next[1] - law[1]).abs());
            law = next;
            if moved < 1e-13 {
                break;
            }
        }
        let kept = tukey.iter().filter(|t| **t > 0.0).count();
        let sums = (0..n).map(|k| (weights[k] * tukey[k], off(law, &values[k]).powi(2)));
        let (weight, square) = sums.fold((0.0, 0.0), |(w, s), (a, b)| (w + a, s + a * b));
        let variance =
            square / weight.max(f64::MIN_POSITIVE) * kept as f64 / kept.saturating_sub(2).max(1) as f64;
        let spread = variance * median(weights);
        let error = |k: usize| (inverse[(k, k)] * spread).max(0.0).sqrt();
        let found = Self { mean: law[0], slope: law[1], middle, errors: [error(0), error(1)], kept };
        (found.mean.is_finite() && found.slope.is_finite()).then_some(found)
    }

    /// The law of the radii of slices, by their curvatures. `None` as for [`through`](Self::through).
    #[must_use]
    pub fn of_radii(slices: &[SliceRadius]) -> Option<Self> {
        let typical = 1.0 / median(slices.iter().map(|slice| 1.0 / slice.radius).collect());
        let mut now = vec![typical; slices.len()];
        let mut law = None;
        for _ in 0..ROUNDS.1 {
            let linear = |(slice, r): (&SliceRadius, &f64)| {
                (slice.at, r - r * r * (1.0 / slice.radius - 1.0 / r), slice.deviation)
            };
            let values: Vec<_> = slices.iter().zip(&now).map(linear).collect();
            let found = Self::through(&values)?;
            let next = slices.iter().map(|s| found.at(s.at).clamp(RANGE[0] * typical, RANGE[1] * typical));
            let next: Vec<f64> = next.collect();
            let moved = next.iter().zip(&now).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            (law, now) = (Some(found), next);
            if moved < 1e-12 {
                break;
            }
        }
        law
    }
}

fn weighted_median(values: &[(f64, f64, f64)], weights: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].1.total_cmp(&values[b].1));
    let half = 0.5 * weights.iter().sum::<f64>();
    let mut sum = 0.0;
    for k in order {
        sum += weights[k];
        if sum >= half {
            return values[k].1;
        }
    }
    0.0
}
