//! Figures of a transfer, by sampling.

use super::transfer::Transferred;

/// Points of a span at which detail is measured.
const PROBES: usize = 8;

/// What a transfer did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Greatest length of what was added.
    pub greatest: f64,
    /// Greatest length of what was added times the curvature of the coarse target there: above 1 the new curve
    /// may fold over.
    pub fold: f64,
    /// How far the first and the last point moved.
    pub ends: [f64; 2],
}

pub(super) fn extent(made: &Transferred) -> Extent {
    let detail = &made.detail;
    let (mut greatest, mut fold): (f64, f64) = (0.0, 0.0);
    for span in detail.knots.spans() {
        let (low, high) = (detail.knots.knots()[span], detail.knots.knots()[span + 1]);
        for probe in 0..=PROBES {
            let t = low + (high - low) * probe as f64 / PROBES as f64;
            let size = detail.at(t)[0].norm();
            greatest = greatest.max(size);
            fold = fold.max(size * curvature(made, t, 1e-3 * (high - low)));
        }
    }
    let (start, end) = detail.domain();
    Extent { greatest, fold, ends: [start, end].map(|t| detail.at(t)[0].norm()) }
}

/// Curvature of the coarse target, by a difference of its tangents.
fn curvature(made: &Transferred, t: f64, step: f64) -> f64 {
    let base = &made.target_base;
    let (start, end) = base.domain();
    let [low, high] = [(t - step).max(start), (t + step).min(end)].map(|t| base.at(t)[1]);
    let speed = 0.5 * (low.norm() + high.norm());
    let (Some(a), Some(b)) = (low.try_normalize(0.0), high.try_normalize(0.0)) else { return 0.0 };
    let width = (t + step).min(end) - (t - step).max(start);
    if speed > 0.0 && width > 0.0 { (b - a).norm() / (width * speed) } else { 0.0 }
}
