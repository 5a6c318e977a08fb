//! Small linear least squares by normal equations, and principal axes of points.
//!
//! For a handful of unknowns whose columns are scaled alike: the condition of the columns is squared here.

use super::{Matrix3, Point3, Vector3};
use nalgebra::{SMatrix, SVector, SymmetricEigen};

/// Sums of a weighted least squares problem with `N` unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalEquations<const N: usize> {
    matrix: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
}

/// A solution with the inverse of the matrix: times the variance of the data, it is the covariance of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution<const N: usize> {
    /// The unknowns.
    pub values: [f64; N],
    inverse: SMatrix<f64, N, N>,
}

impl<const N: usize> Default for NormalEquations<N> {
    fn default() -> Self {
        Self { matrix: SMatrix::zeros(), right: SVector::zeros() }
    }
}

/// Pivot, relative to the greatest diagonal entry, below which unknowns count as undetermined.
const UNDETERMINED: f64 = 1e-13;

impl<const N: usize> NormalEquations<N> {
    /// Adds the equation `row · x = value`.
    pub fn add(&mut self, row: &[f64; N], value: f64, weight: f64) {
        let row = SVector::<f64, N>::from(*row);
        self.matrix += (row * weight) * row.transpose();
        self.right += row * (weight * value);
    }

    /// The unknowns; `None` when the equations do not determine them.
    #[must_use]
    pub fn solved(&self) -> Option<Solution<N>> {
        let greatest = self.matrix.diagonal().max();
        let factor = self.matrix.cholesky()?;
        let least = factor.l_dirty().diagonal().min();
        let determined = least * least > UNDETERMINED * greatest;
        if !determined {
            return None;
        }
        let values: [f64; N] = factor.solve(&self.right).into();
        values.iter().all(|v| v.is_finite()).then(|| Solution { values, inverse: factor.inverse() })
    }
}

impl<const N: usize> Solution<N> {
    /// Variance of `row · x` for data of variance 1.
    #[must_use]
    pub fn variance(&self, row: &[f64; N]) -> f64 {
        let row = SVector::<f64, N>::from(*row);
        row.dot(&(self.inverse * row)).max(0.0)
    }
}

/// Centre, and axes of greatest to least spread with their variances; the axes are orthonormal and right-handed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalAxes {
    /// Mean of the points.
    pub centre: Point3<f64>,
    /// Unit axes, the one of greatest spread first.
    pub axes: [Vector3<f64>; 3],
    /// Variances along them.
    pub variances: [f64; 3],
}

impl PrincipalAxes {
    /// Of some points; `None` without points or for points that are not finite. The sign of an axis is the one that makes
    /// its greatest component positive.
    #[must_use]
    pub fn of<'a>(points: impl Iterator<Item = &'a Point3<f64>> + Clone) -> Option<Self> {
        let (sum, count) = points.clone().fold((Vector3::zeros(), 0.0), |(s, n), p| (s + p.coords, n + 1.0));
        if count == 0.0 {
            return None;
        }
        let centre = Point3::from(sum / count);
        let mut spread = Matrix3::zeros();
        for point in points {
            let d = point - centre;
            spread += d * d.transpose();
        }
        spread /= count;
        if !spread.iter().all(|v| v.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let axis = |k: usize| {
            let axis: Vector3<f64> = eigen.eigenvectors.column(order[k]).into_owned();
            if axis[axis.iamax()] < 0.0 { -axis } else { axis }
        };
        let (first, second) = (axis(0), axis(1));
        let variances = order.map(|k| eigen.eigenvalues[k].max(0.0));
        Some(Self { centre, axes: [first, second, first.cross(&second)], variances })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_found_with_the_variance_of_its_values() {
        let at = |x: f64| [1.0, x, x * x];
        let mut equations = NormalEquations::<3>::default();
        let xs = [-1.0, -0.5, 0.0, 0.25, 1.0];
        for x in xs {
            equations.add(&at(x), 2.0 - 3.0 * x + 0.5 * x * x, 2.0);
        }
        let found = equations.solved().unwrap();
        for (f, e) in found.values.iter().zip([2.0, -3.0, 0.5]) {
            assert!((f - e).abs() < 1e-13);
        }
        // The mean of n values has the variance 1 / n.
        let mut mean = NormalEquations::<1>::default();
        (0..4).for_each(|_| mean.add(&[1.0], 7.0, 1.0));
        assert!((mean.solved().unwrap().variance(&[1.0]) - 0.25).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_determined_is_not_invented() {
        let mut equations = NormalEquations::<3>::default();
        for x in [0.0, 1.0] {
            equations.add(&[1.0, x, x * x], 1.0, 1.0);
        }
        assert_eq!(equations.solved(), None);
        assert_eq!(NormalEquations::<2>::default().solved(), None);
    }

    #[test]
    fn axes_of_a_flat_box_of_points() {
        let at = |x: f64, y: f64| Point3::new(1.0 + 3.0 * x, 2.0 + y, 5.0);
        let points: Vec<_> = [-1.0, 1.0].iter().flat_map(|&x| [-1.0, 1.0].map(|y| at(x, y))).collect();
        let found = PrincipalAxes::of(points.iter()).unwrap();
        assert!((found.centre - Point3::new(1.0, 2.0, 5.0)).norm() < 1e-15);
        assert!(
            (found.axes[0] - Vector3::x()).norm() < 1e-12 && (found.axes[2] - Vector3::z()).norm() < 1e-12
        );
        assert!((found.variances[0] - 9.0).abs() < 1e-12 && found.variances[2] < 1e-12);
    }
}
