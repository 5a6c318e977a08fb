//! Surfaces that are written as if they were torn: an inner knot once more often than the degree, where both sides say the
//! same all the same.

use super::{KnotVector, NurbsSurface};

impl NurbsSurface {
    /// The surface with every inner knot at most as often as the degree, where rows on both sides of one that occurs once
    /// more are nowhere farther apart than `tolerance`, along both parameters. Where they are, it stays torn.
    #[must_use]
    pub fn mended(&self, tolerance: f64) -> Self {
        self.mended_u(tolerance).swapped().mended_u(tolerance).swapped()
    }

    fn mended_u(&self, tolerance: f64) -> Self {
        let knots = self.knots_u();
        let (p, (start, end)) = (knots.degree(), knots.domain());
        let columns = self.shape().1;
        let row = |i: usize| &self.net()[i * columns..(i + 1) * columns];
        let near = |a: &[f64; 4], b: &[f64; 4]| {
            let apart = (0..3).map(|k| (a[k] / a[3] - b[k] / b[3]).powi(2)).sum::<f64>().sqrt();
            apart <= tolerance && (a[3] - b[3]).abs() <= SAME_WEIGHT * a[3]
        };
        let (mut values, mut net) = (knots.knots().to_vec(), self.net().to_vec());
        let (distinct, counts) = knots.distinct();
        // From the end, so that places before stay.
        let mut last = values.len();
        for (value, count) in distinct.into_iter().zip(counts).rev() {
            let first = last - count;
            let torn = value > start && value < end && count == p + 1;
            if torn && row(first - 1).iter().zip(row(first)).all(|(a, b)| near(a, b)) {
                values.remove(first);
                net.drain(first * columns..(first + 1) * columns);
            }
            last = first;
        }
        let mended = KnotVector::new(p, values).ok();
        let mended = mended.and_then(|knots| Self::new(knots, self.knots_v().clone(), net).ok());
        mended.unwrap_or_else(|| self.clone())
    }
}

/// Relative difference of weights within which both sides say the same.
const SAME_WEIGHT: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_meet_are_joined_and_others_stay_torn() {
        let v = KnotVector::clamped_uniform(1, 1, 0.0, 1.0).unwrap();
        let u = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0]).unwrap();
        let net = |x: f64| {
            let rows = [0.0, 1.0, 1.0 + x, 3.0];
            rows.iter().flat_map(|r| [[*r, 0.0, 0.0, 1.0], [*r, 1.0, 0.0, 1.0]]).collect::<Vec<_>>()
        };
        let met = NurbsSurface::new(u.clone(), v.clone(), net(0.0)).unwrap().mended(1e-9);
        assert_eq!(met.knots_u().knots(), [0.0, 0.0, 1.0, 2.0, 2.0]);
        for x in [0.0, 0.5, 1.0, 1.5, 2.0] {
            let expected = if x <= 1.0 { x } else { 2.0 * x - 1.0 };
            assert!((met.point(x, 0.3).x - expected).abs() < 1e-15);
        }
        let torn = NurbsSurface::new(u, v, net(0.5)).unwrap();
        assert_eq!(torn.mended(1e-9), torn);
    }
}
