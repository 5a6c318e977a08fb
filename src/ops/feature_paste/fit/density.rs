//! How dense the target's net must be under a feature: as the source's is there, doubled with each attempt.

use super::extent;
use super::field::Field;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::ops::feature_paste::PasteError;

/// Slack of a count of parts: a span that fits in by rounding is not cut.
const WHOLE: f64 = 1e-6;

impl Field<'_> {
    /// The target with spans under the feature so short that none of them passes more than one span of the source.
    ///
    /// # Errors
    /// [`PasteError::NetTooLarge`] before anything is refined.
    pub fn densified(
        &self,
        target: &NurbsSurface,
        corners: &[[f64; 2]; 4],
        level: u32,
        limit: usize,
    ) -> Result<NurbsSurface, PasteError> {
        let spacing = [(self.source.knots_u(), 0), (self.source.knots_v(), 1)]
            .map(|(knots, k)| median_span(knots, self.window[k]));
        let knots = [target.knots_u(), target.knots_v()];
        let rates = inverse(&self.map.linear);
        let [u, v] = [0, 1].map(|k| {
            let steps = (0..2).map(|m| spacing[m] / rates[m][k].abs());
            let step = steps.fold(f64::INFINITY, f64::min);
            new_knots(knots[k], extent(corners, k), step / f64::from(1 << level))
        });
        let points = (target.shape().0 + u.len()).saturating_mul(target.shape().1 + v.len());
        if points > limit {
            return Err(PasteError::NetTooLarge { points, limit });
        }
        Ok(target.refined_u(&u)?.refined_v(&v)?)
    }
}

/// How fast the source's parameters run with the target's: rows are the source's.
fn inverse([[a, b], [c, d]]: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = a * d - b * c;
    [[*d, -b], [-c, *a]].map(|row| row.map(|x| x / determinant))
}

/// Knots that leave no span within a range longer than `step`, ascending.
fn new_knots(knots: &KnotVector, range: (f64, f64), step: f64) -> Vec<f64> {
    let ends = new_ends(knots, range, step);
    let mut distinct = knots.distinct().0;
    distinct.extend(&ends);
    distinct.sort_by(f64::total_cmp);
    let mut more = subdivisions(&distinct, range, step);
    more.extend(ends);
    more.sort_by(f64::total_cmp);
    more
}

/// Median length of the spans within a range.
fn median_span(knots: &KnotVector, (start, end): (f64, f64)) -> f64 {
    let (distinct, _) = knots.distinct();
    let inside = distinct.windows(2).filter(|w| w[1] > start && w[0] < end);
    let mut lengths: Vec<f64> = inside.map(|w| w[1] - w[0]).collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths.len() / 2;
    match lengths.len() {
        0 => end - start,
        n if n % 2 == 1 => lengths[middle],
        _ => 0.5 * (lengths[middle - 1] + lengths[middle]),
    }
}

/// Ends of a range that become knots, so that a long span is not refined beyond it: those farther than a step from
/// every knot.
fn new_ends(knots: &KnotVector, (start, end): (f64, f64), step: f64) -> Vec<f64> {
    let far = |x: &f64| knots.knots().iter().all(|k| (k - x).abs() > step);
    [start, end].into_iter().filter(far).collect()
}

/// Knots that cut every span that meets the range into equal parts no longer than `step`.
fn subdivisions(distinct: &[f64], (start, end): (f64, f64), step: f64) -> Vec<f64> {
    let mut more = Vec::new();
    let slack = WHOLE * (end - start);
    for w in distinct.windows(2).filter(|w| w[1] > start + slack && w[0] < end - slack) {
        let length = w[1] - w[0];
        let parts = (length / step - WHOLE).ceil();
        // The caller refuses nets beyond its limit; a span is never cut into more than a million parts.
        let parts = if parts.is_finite() { parts.clamp(1.0, 1e6) as usize } else { 1 };
        more.extend((1..parts).map(|m| w[0] + length * (m as f64 / parts as f64)));
    }
    more
}
