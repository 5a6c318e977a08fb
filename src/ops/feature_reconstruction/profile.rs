//! The height of a cloud along a path: a smooth function through the points of a slab.
//!
//! A cubic spline of the place along, and, so that a slab of some width may be used where the surface leans and bends across
//! it, the place across and its square times coarser ones.

use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::geometry::nurbs::KnotVector;
use crate::math::TriMat;
use crate::math::sparse::SymmetricFactor;

/// A point of a slab along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlabPlace {
    /// Length along the path.
    pub along: f64,
    /// Distance beside the path, in half widths of the slab.
    pub across: f64,
    /// Height above the primary.
    pub height: f64,
}

/// A height that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Length along the path.
    pub along: f64,
    /// The height.
    pub height: f64,
    /// Its weight, as a number of points.
    pub weight: f64,
}

/// The height along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    knots: KnotVector,
    coefficients: Vec<f64>,
    /// Deviation of the points from it.
    pub scatter: f64,
    /// Points that it was made from.
    pub points: usize,
}

/// Least count of points.
pub const LEAST: usize = 20;
/// Length of a span in spacings.
const SPAN: f64 = 8.0;
/// Weight of the third derivative (times the cube of a span) as a part of the mean diagonal, and a small part of that for
/// every unknown.
const STIFF: [f64; 2] = [1e-5, 1e-7];

impl Profile {
    /// The height over `range` from points within it; `None` with fewer than [`LEAST`], or for an empty range.
    #[must_use]
    pub fn fitted(points: &[SlabPlace], range: [f64; 2], spacing: f64, pins: &[Pin]) -> Option<Self> {
        let [low, high] = range;
        let used: Vec<&SlabPlace> = points.iter().filter(|p| p.along >= low && p.along <= high).collect();
        if used.len() < LEAST || high.is_nan() || high <= low {
            return None;
        }
        let spans = (((high - low) / (SPAN * spacing)).ceil() as usize).max(3);
        let knots = KnotVector::clamped_uniform(3, spans, low, high).ok()?;
        let beside = KnotVector::clamped_uniform(3, (spans / 2).max(1), low, high).ok()?;
        let (n, m) = (knots.n_basis(), beside.n_basis());
        let row = |point: &SlabPlace| {
            let mut row = entries(&knots, point.along, 0, 1.0);
            row.extend(entries(&beside, point.along, n, point.across));
            row.extend(entries(&beside, point.along, n + m, point.across.powi(2)));
            row
        };
        let mut equations = Equations::new(n + 2 * m);
        used.iter().for_each(|point| equations.add(&row(point), point.height, 1.0));
        for pin in pins {
            equations.add(&entries(&knots, pin.along.clamp(low, high), 0, 1.0), pin.height, pin.weight);
        }
        equations.stiffen(&knots);
        let solved = equations.solved()?;
        let off = |point: &&SlabPlace| {
            let height: f64 = row(point).iter().map(|&(k, x)| x * solved[k]).sum();
            (height - point.height).abs()
        };
        let scatter = MEDIAN_TO_DEVIATION * median(used.iter().map(off).collect());
        let coefficients = solved[..n].to_vec();
        Some(Self { knots, coefficients, scatter, points: used.len() })
    }

    /// Where it is known.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.knots.domain().into()
    }

    /// The height, or a derivative of it, at a length within the range.
    #[must_use]
    pub fn value(&self, along: f64, order: usize) -> f64 {
        let [low, high] = self.range();
        let basis = self.knots.basis_derivatives(along.clamp(low, high), order);
        let first = basis.first();
        basis.derivatives(order).iter().enumerate().map(|(k, x)| x * self.coefficients[first + k]).sum()
    }
}

/// Functions at a place with their numbers from `offset` on, times a factor.
fn entries(knots: &KnotVector, at: f64, offset: usize, factor: f64) -> Vec<(usize, f64)> {
    let basis = knots.basis_derivatives(at, 0);
    let first = offset + basis.first();
    basis.values().iter().enumerate().map(|(k, x)| (first + k, factor * x)).collect()
}

struct Equations {
    matrix: TriMat<f64>,
    right: Vec<f64>,
    /// Sum of the squares of all entries.
    squares: f64,
}

impl Equations {
    fn new(size: usize) -> Self {
        Self { matrix: TriMat::new((size, size)), right: vec![0.0; size], squares: 0.0 }
    }

    fn add(&mut self, row: &[(usize, f64)], value: f64, weight: f64) {
        for &(i, a) in row {
            self.right[i] += weight * a * value;
            row.iter().for_each(|&(j, b)| self.matrix.add_triplet(i, j, weight * a * b));
            self.squares += weight * a * a;
        }
    }

    /// The third derivative along the path is made small, and a little all unknowns. A parabola is left as it is, also at
    /// the ends, where third differences of its coefficients would not vanish.
    fn stiffen(&mut self, knots: &KnotVector) {
        let size = self.right.len();
        let mean = self.squares / size as f64;
        for span in knots.spans() {
            let [start, end] = [knots.knots()[span], knots.knots()[span + 1]];
            let [a, b] = [start, end].map(|u| knots.basis_of_span(span, u, 2));
            // The second derivative of a cubic is linear over a span.
            let growth =
                a.derivatives(2).iter().zip(b.derivatives(2)).map(|(a, b)| (b - a) * (end - start).powi(2));
            let row: Vec<(usize, f64)> = growth.enumerate().map(|(k, x)| (a.first() + k, x)).collect();
            for &(i, x) in &row {
                row.iter().for_each(|&(j, y)| self.matrix.add_triplet(i, j, STIFF[0] * mean * x * y));
            }
        }
        (0..size).for_each(|i| self.matrix.add_triplet(i, i, STIFF[1] * mean));
    }

    fn solved(mut self) -> Option<Vec<f64>> {
        SymmetricFactor::new(&self.matrix.to_csr()).ok()?.solve(&mut self.right);
        self.right.iter().all(|x| x.is_finite()).then_some(self.right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights that the function can express come back, but for the small stiffness.
    #[test]
    fn a_leaning_parabola_is_found() {
        let height = |x: f64| 3.0 + 0.2 * x - 0.05 * x * x;
        let slab: Vec<SlabPlace> = (0..900)
            .map(|k| (f64::from(k % 300) / 10.0, f64::from(k / 300) - 1.0))
            .map(|(along, across)| SlabPlace {
                along,
                across,
                height: height(along) + across * (0.3 - 0.01 * along) - 0.02 * across * across,
            })
            .collect();
        let found = Profile::fitted(&slab, [0.0, 29.9], 0.2, &[]).unwrap();
        for k in 0..=100 {
            let x = 0.299 * f64::from(k);
            assert!((found.value(x, 0) - height(x)).abs() < 1e-4, "{x}: {}", found.value(x, 0) - height(x));
            assert!((found.value(x, 2) + 0.1).abs() < 2e-3, "{x}: {}", found.value(x, 2));
        }
        assert!(found.scatter < 1e-4 && found.points == 900, "{} of {}", found.scatter, found.points);
    }

    #[test]
    fn a_pin_is_met_beyond_the_points() {
        let slab: Vec<SlabPlace> = (0..200)
            .map(|k| 2.0 + 0.1 * f64::from(k))
            .map(|along| SlabPlace { along, across: 0.0, height: along })
            .collect();
        let pin = Pin { along: 0.0, height: 0.5, weight: 30.0 };
        let found = Profile::fitted(&slab, [0.0, 21.9], 0.2, &[pin]).unwrap();
        assert!((found.value(0.0, 0) - 0.5).abs() < 0.02);
        assert!((found.value(10.0, 0) - 10.0).abs() < 1e-3);
    }

    #[test]
    fn too_few_points_and_no_range_give_none() {
        let point = SlabPlace { along: 1.0, across: 0.0, height: 1.0 };
        assert_eq!(Profile::fitted(&[point; 19], [0.0, 2.0], 0.1, &[]), None);
        assert_eq!(Profile::fitted(&[point; 30], [1.0, 1.0], 0.1, &[]), None);
    }
}
