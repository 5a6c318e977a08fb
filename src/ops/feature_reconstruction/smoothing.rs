//! Smoothing of lines of points: a discrete curve as a network of bars under forces, and weighted values along a line.
//!
//! Second differences of neighbours are what is made small. The force form keeps what its weights hold and lets a curve of
//! even bars shrink a little; the weighted form of offsets from a smooth line does not.

use super::Closure;
use crate::math::TriMat;
use crate::math::sparse::{SingularSystem, SymmetricFactor};

/// Second difference at each place, as `(place, factor)`.
fn differences(n: usize, closure: Closure) -> Vec<Vec<(usize, f64)>> {
    let row = |i: usize| match closure {
        Closure::Closed => vec![((i + n - 1) % n, -1.0), (i, 2.0), ((i + 1) % n, -1.0)],
        Closure::Open => {
            let mut row = vec![(i, 2.0)];
            row.extend((i > 0).then(|| (i - 1, -1.0)));
            row.extend((i + 1 < n).then_some((i + 1, -1.0)));
            row
        }
    };
    (0..n).map(row).collect()
}

/// `alpha Dᵀ D + diag(weights)` for the rows of `D`.
fn factor(
    rows: &[Vec<(usize, f64)>],
    alpha: f64,
    weights: &[f64],
) -> Result<SymmetricFactor, SingularSystem> {
    let n = weights.len();
    let mut matrix = TriMat::new((n, n));
    for row in rows {
        for &(i, a) in row {
            row.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, alpha * a * b));
        }
    }
    weights.iter().enumerate().for_each(|(i, &w)| matrix.add_triplet(i, i, w));
    SymmetricFactor::new(&matrix.to_csr())
}

/// Moves points so that the forces of a network of equal bars between neighbours become small against the weights that
/// hold the points. At the ends of an open line fixed nodes stand where the line would go on straight.
///
/// On a closed line of even steps a wave of length `l` is kept by `1 / (1 + (stiffness / weight) (2 - 2 cos(2 pi step /
/// l))²)`.
///
/// # Errors
/// [`SingularSystem`] when no weight is positive.
///
/// # Panics
/// When there are not as many weights as points.
pub fn smoothed<const K: usize>(
    points: &[[f64; K]],
    stiffness: f64,
    weights: &[f64],
    closure: Closure,
) -> Result<Vec<[f64; K]>, SingularSystem> {
    assert_eq!(points.len(), weights.len(), "a weight for each point");
    let n = points.len();
    let rows = differences(n, closure);
    let factor = factor(&rows, stiffness, weights)?;
    let mut right = vec![0.0; K * n];
    for (i, row) in rows.iter().enumerate() {
        // The fixed nodes take up the force at the ends.
        if closure == Closure::Open && (i == 0 || i + 1 == n) {
            continue;
        }
        for k in 0..K {
            let force: f64 = row.iter().map(|&(j, a)| a * points[j][k]).sum();
            row.iter().for_each(|&(j, a)| right[k * n + j] -= stiffness * a * force);
        }
    }
    factor.solve(&mut right);
    Ok((0..n).map(|i| std::array::from_fn(|k| points[i][k] + right[k * n + i])).collect())
}

/// Rounds of re-weighting against outliers.
const ROUNDS: usize = 8;
/// Median of absolute values to the deviation of a normal distribution.
pub(super) const MEDIAN_TO_DEVIATION: f64 = 1.4826;

/// Differences that are made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Of second order: straight lines cost nothing.
    Second,
    /// Of third order: parabolas cost nothing, and circles hardly anything.
    Third,
}

impl Order {
    /// Differences between the places of a line; those of an open one that reach beyond its ends are left out.
    fn rows(self, n: usize, closure: Closure) -> Vec<Vec<(usize, f64)>> {
        let factors: &[f64] = match self {
            Self::Second => &[-1.0, 2.0, -1.0],
            Self::Third => &[-1.0, 3.0, -3.0, 1.0],
        };
        let count = match closure {
            Closure::Closed => n,
            Closure::Open => (n + 1).saturating_sub(factors.len()),
        };
        let row = |i: usize| factors.iter().enumerate().map(|(k, a)| ((i + k) % n, *a)).collect();
        (0..count).map(row).collect()
    }

    /// The weight of the differences at which a wave of this length is halved where the weight of the points is 1, for
    /// points at even steps.
    #[must_use]
    pub fn stiffness(self, wavelength: f64, step: f64) -> f64 {
        let twice = 2.0 - 2.0 * (std::f64::consts::TAU * step / wavelength).cos();
        match self {
            Self::Second => twice.powi(-2),
            Self::Third => twice.powi(-3),
        }
    }
}

/// Points along a line of even steps, smoothed: `stiffness |Dᵏ z|² + Σ w |z - point|²` is made least, with weights that
/// fall with the square of the distance for points beyond two deviations. Points of weight 0 may be anything finite.
/// `floor` is the least deviation that counts as one.
///
/// # Errors
/// [`SingularSystem`] for fewer positive weights than the order of the differences.
///
/// # Panics
/// When there are not as many weights as points.
pub fn smoothed_against_outliers<const K: usize>(
    points: &[[f64; K]],
    (order, stiffness): (Order, f64),
    weights: &[f64],
    floor: f64,
    closure: Closure,
) -> Result<Vec<[f64; K]>, SingularSystem> {
    assert_eq!(points.len(), weights.len(), "a weight for each point");
    let n = points.len();
    let rows = order.rows(n, closure);
    let mut now = weights.to_vec();
    let mut smooth = points.to_vec();
    for _ in 0..ROUNDS {
        let mut right: Vec<f64> = (0..K * n).map(|at| now[at % n] * points[at % n][at / n]).collect();
        factor(&rows, stiffness, &now)?.solve(&mut right);
        smooth = (0..n).map(|i| std::array::from_fn(|k| right[k * n + i])).collect();
        let off = |i: usize| (0..K).map(|k| (smooth[i][k] - points[i][k]).powi(2)).sum::<f64>().sqrt();
        let off: Vec<f64> = (0..n).map(off).collect();
        let counted = (0..n).filter(|&i| weights[i] > 0.0).map(|i| off[i]).collect();
        let deviation = (MEDIAN_TO_DEVIATION * median(counted)).max(floor);
        for i in 0..n {
            now[i] = weights[i] * (2.0 * deviation / off[i].max(f64::MIN_POSITIVE)).min(1.0).powi(2);
        }
    }
    Ok(smooth)
}

/// The middle value, or the mean of the two middle ones; 0 without values.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let n = values.len();
    if n == 0 {
        return 0.0;
    }
    values.sort_by(f64::total_cmp);
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
