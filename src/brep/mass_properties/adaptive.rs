//! Adaptive quadrature of many integrands at once along a path.

use super::moments::Sums;
use crate::math::quadrature::KRONROD_7;

/// Halvings of one interval at most.
const MAX_DEPTH: u32 = 12;
/// Intervals between two breaks at most: where projections jump, no number of them helps.
const MAX_INTERVALS: usize = 96;

/// What counts as exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accuracy {
    /// Size of the piece.
    pub(super) size: f64,
    /// Greatest distance of the piece from the reference.
    pub(super) reach: f64,
    /// Error of one interval, relative to what these make.
    pub(super) target: f64,
}

/// What an integration along a path finds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) sum: Sums,
    pub(super) errors: Sums,
    /// How far the path moves across the columns, by its speed at the same places.
    pub(super) advance: f64,
}

/// Integral of `value`, what is summed up and how fast the path moves across, over an interval.
pub(super) fn integrate(
    value: &dyn Fn(f64) -> (Sums, f64),
    from: f64,
    to: f64,
    accuracy: &Accuracy,
) -> Found {
    let mut found = Found { sum: Sums::ZERO, errors: Sums::ZERO, advance: 0.0 };
    let mut open = vec![(from, to, 0)];
    let mut count = 0;
    while let Some((from, to, depth)) = open.pop() {
        let one = once(value, from, to);
        count += 1;
        let good = one.errors.relative(accuracy.size, accuracy.reach) <= accuracy.target;
        if good || depth == MAX_DEPTH || count > MAX_INTERVALS {
            found.sum += one.sum;
            found.errors += one.errors;
            found.advance += one.advance;
        } else {
            let middle = 0.5 * (from + to);
            open.push((middle, to, depth + 1));
            open.push((from, middle, depth + 1));
        }
    }
    found
}

fn once(value: &dyn Fn(f64) -> (Sums, f64), from: f64, to: f64) -> Found {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut fine, mut coarse, mut size) = (Sums::ZERO, Sums::ZERO, Sums::ZERO);
    let mut advance = 0.0;
    for &(x, kronrod, gauss) in &KRONROD_7 {
        let (at, speed) = value(middle + half * x);
        fine += at * (kronrod * half);
        coarse += at * (gauss * half);
        size += at.abs() * (kronrod * half.abs());
        advance += speed * (kronrod * half);
    }
    Found { sum: fine, errors: fine.error_against(&coarse, &size), advance }
}
