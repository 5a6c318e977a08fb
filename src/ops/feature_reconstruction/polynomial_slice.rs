//! Where the height above the primary vanishes at the edge of a cloud: one crossing of the limiting line.
//!
//! Points of a slab across a guide line, each by its place across, along and its height, give a polynomial of the height
//! near the edge; its zero beyond the edge is where the surface under the cloud meets the primary. Foot and height take
//! the primary's own bend out of it.

use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::math::NormalEquations;

/// A point of a slab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlabPoint {
    /// Place across the guide, inwards.
    pub across: f64,
    /// Place along the guide.
    pub along: f64,
    /// Height above the primary.
    pub height: f64,
}

/// A zero of the height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Its place across the guide.
    pub across: f64,
    /// Its deviation, as the scatter of the points predicts it.
    pub deviation: f64,
    /// Slope of the height there.
    pub slope: f64,
    /// Deviation of the points from the polynomial.
    pub scatter: f64,
    /// Where the cloud begins.
    pub start: f64,
    /// Points that were used.
    pub used: usize,
}

/// Rounds of re-weighting, and constant of Huber's weights: 95 % of the efficiency of least squares.
const ROUNDS: usize = 6;
const HUBER: f64 = 1.345;
/// Points at least, for a polynomial at all, of degree 2, of degree 3, and of higher ones.
const LEAST: [usize; 4] = [8, 14, 30, 36];
/// Range in windows in which a zero is looked for; those up to the bound between count first.
const RANGE: [f64; 3] = [-1.5, 0.1, 0.3];
/// Steps in which it is looked for.
const SCAN: usize = 90;
/// Deviation of exact data.
const ROUNDING: f64 = 1e-9;
/// Highest degree.
pub const HIGHEST: usize = 5;

/// Terms beside the powers: along, along times across, along squared.
const BESIDE: usize = 3;

/// The crossing by the points of a slab of half width `half` that lie within a window behind the edge, by a polynomial of
/// a degree up to [`HIGHEST`], or less when there are few points. `None` for too few points or no zero.
#[must_use]
pub fn crossing(points: &[SlabPoint], half: f64, window: f64, degree: usize) -> Option<Crossing> {
    let start = edge(points)?;
    let scaled: Vec<SlabPoint> = points
        .iter()
        .filter(|p| p.across <= start + window)
        .map(|p| SlabPoint { across: (p.across - start) / window, along: p.along / half, ..*p })
        .collect();
    let found = match degree.min(highest(scaled.len())?) {
        1 => solved::<{ 2 + BESIDE }>(&scaled),
        2 => solved::<{ 3 + BESIDE }>(&scaled),
        3 => solved::<{ 4 + BESIDE }>(&scaled),
        4 => solved::<{ 5 + BESIDE }>(&scaled),
        _ => solved::<{ 6 + BESIDE }>(&scaled),
    }?;
    let [zero, deviation, slope, scatter] = found;
    let used = scaled.len();
    let (across, deviation, slope) = (start + zero * window, deviation * window, slope / window);
    Some(Crossing { across, deviation, slope, scatter, start, used })
}

/// Where the cloud begins: the mean of a few of the first points.
fn edge(points: &[SlabPoint]) -> Option<f64> {
    if points.len() < LEAST[0] {
        return None;
    }
    let few = (points.len() / 60).max(2);
    let mut all: Vec<f64> = points.iter().map(|p| p.across).collect();
    let (first, last, _) = all.select_nth_unstable_by(few - 1, f64::total_cmp);
    Some((first.iter().sum::<f64>() + *last) / few as f64)
}

fn highest(count: usize) -> Option<usize> {
    match count {
        n if n < LEAST[0] => None,
        n if n < LEAST[1] => Some(1),
        n if n < LEAST[2] => Some(2),
        n if n < LEAST[3] => Some(3),
        _ => Some(HIGHEST),
    }
}

/// The row of a place: Legendre polynomials over the window, then the terms beside them.
fn row<const N: usize>(across: f64, along: f64) -> [f64; N] {
    let mut row = [0.0; N];
    legendre(2.0 * across - 1.0, &mut row[..N - BESIDE]);
    row[N - BESIDE..].copy_from_slice(&[along, along * across, along * along]);
    row
}

fn legendre(x: f64, out: &mut [f64]) {
    out[0] = 1.0;
    if out.len() > 1 {
        out[1] = x;
    }
    for k in 2..out.len() {
        let n = k as f64;
        out[k] = ((2.0 * n - 1.0) * x * out[k - 1] - (n - 1.0) * out[k - 2]) / n;
    }
}

/// Zero, its deviation and the slope, all in windows; and the deviation of the points.
fn solved<const N: usize>(points: &[SlabPoint]) -> Option<[f64; 4]> {
    let rows: Vec<[f64; N]> = points.iter().map(|p| row(p.across, p.along)).collect();
    let mut weights = vec![1.0; points.len()];
    let mut found = None;
    for _ in 0..ROUNDS {
        let mut equations = NormalEquations::<N>::default();
        for ((row, point), weight) in rows.iter().zip(points).zip(&weights) {
            equations.add(row, point.height, *weight);
        }
        let solution = equations.solved()?;
        let off = |(row, point): (&[f64; N], &SlabPoint)| {
            (point.height - row.iter().zip(&solution.values).map(|(a, x)| a * x).sum::<f64>()).abs()
        };
        let off: Vec<f64> = rows.iter().zip(points).map(off).collect();
        let deviation = (MEDIAN_TO_DEVIATION * median(off.clone())).max(ROUNDING);
        for (weight, off) in weights.iter_mut().zip(&off) {
            *weight = (HUBER * deviation / off.max(f64::MIN_POSITIVE)).min(1.0);
        }
        found = Some((solution, deviation));
    }
    let (solution, deviation) = found?;
    let value = |z: f64| -> f64 { row::<N>(z, 0.0).iter().zip(&solution.values).map(|(a, x)| a * x).sum() };
    let zero = zero(&value)?;
    let step = 1e-4;
    let slope = (value(zero + step) - value(zero - step)) / (2.0 * step);
    let spread = solution.variance(&row::<N>(zero, 0.0)).sqrt();
    Some([zero, deviation * spread / slope.abs().max(f64::MIN_POSITIVE), slope, deviation])
}

/// The zero that is met first on the way out of the cloud, or else the first one inside.
fn zero(value: &impl Fn(f64) -> f64) -> Option<f64> {
    let place = |k: usize| RANGE[0] + (RANGE[2] - RANGE[0]) * k as f64 / SCAN as f64;
    let mut zeros = (0..SCAN).filter_map(|k| {
        let (a, b) = (place(k), place(k + 1));
        (value(a) * value(b) <= 0.0).then(|| bisected(value, a, b))
    });
    let mut best = None;
    for zero in zeros.by_ref() {
        if zero > RANGE[1] {
            return best.or(Some(zero));
        }
        best = Some(zero);
    }
    best
}

fn bisected(value: &impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let sign = value(a).signum();
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if value(middle).signum() == sign { a = middle } else { b = middle }
    }
    0.5 * (a + b)
}
