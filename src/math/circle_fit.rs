//! Circles through points of the plane that lie near one.
//!
//! Pratt's fit needs no start and no bias towards small circles; the geometric fit after it makes the distances
//! themselves least. Robust against nothing: outliers are the caller's business.

use nalgebra::{DMatrix, Matrix3, Matrix4, Vector3, Vector4};

use super::Point2;

/// A circle in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneCircle {
    /// Its centre.
    pub center: Point2<f64>,
    /// Its radius.
    pub radius: f64,
}

/// Least singular value, relative to the greatest, below which the points lie on a circle to rounding.
const EXACT: f64 = 1e-14;
/// Coefficient of the quadratic part, relative to the greatest, below which the points lie on a line.
const COLLINEAR: f64 = 1e-12;
/// Steps of the geometric fit.
const STEPS: usize = 30;

impl PlaneCircle {
    /// The fit of Pratt (Computer Graphics 21, 1987): least algebraic distance, scaled by the gradient. Invariant under
    /// motions and scale.
    ///
    /// `None` for fewer than three points, points at one place or on a line, and numbers that are not finite.
    #[must_use]
    pub fn pratt(points: &[Point2<f64>]) -> Option<Self> {
        let count = points.len() as f64;
        if points.len() < 3 {
            return None;
        }
        let mean = points.iter().fold(Point2::origin(), |sum, p| sum + p.coords / count);
        let square = points.iter().map(|p| (p - mean).norm_squared()).sum::<f64>() / count;
        let scale = square.sqrt();
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let local = |k: usize| points.get(k).map(|p| (p - mean) / scale);
        // A row of zeros makes three points a system of four rows.
        let rows = DMatrix::from_fn(points.len().max(4), 4, |i, j| {
            local(i).map_or(0.0, |p| [p.norm_squared(), p.x, p.y, 1.0][j])
        });
        let [a, b, c, d] = coefficients(rows.qr().r().fixed_view::<4, 4>(0, 0).into_owned())?.into();
        if a.abs() < COLLINEAR * [a, b, c, d].into_iter().fold(0.0, |m: f64, x| m.max(x.abs())) {
            return None;
        }
        let center = Point2::new(-b / (2.0 * a), -c / (2.0 * a));
        let radius = (b * b + c * c - 4.0 * a * d).max(0.0).sqrt() / (2.0 * a.abs());
        Some(Self { center: mean + center.coords * scale, radius: radius * scale })
    }

    /// The circle of least squared distances that is reached from this one, by damped Gauss-Newton steps. Never worse
    /// than the start.
    #[must_use]
    pub fn refined(self, points: &[Point2<f64>]) -> Self {
        let mut best = self;
        let mut cost = best.cost(points);
        let mut damping = 1e-6;
        for _ in 0..STEPS {
            let Some(step) = best.step(points, damping) else { break };
            let moved = Self {
                center: Point2::new(best.center.x + step.x, best.center.y + step.y),
                radius: best.radius + step.z,
            };
            let new = moved.cost(points);
            if new <= cost {
                let gained = cost - new;
                (best, cost) = (moved, new);
                damping = (damping / 5.0_f64).max(1e-14);
                if gained <= 1e-16 * cost {
                    break;
                }
            } else {
                damping *= 10.0;
            }
        }
        best
    }

    fn cost(&self, points: &[Point2<f64>]) -> f64 {
        points.iter().map(|p| self.off(p).powi(2)).sum()
    }

    /// Signed distance of a point from the circle, outwards positive.
    #[must_use]
    pub fn off(&self, point: &Point2<f64>) -> f64 {
        (point - self.center).norm() - self.radius
    }

    fn step(&self, points: &[Point2<f64>], damping: f64) -> Option<Vector3<f64>> {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for p in points {
            let away = p - self.center;
            let distance = away.norm();
            if distance == 0.0 {
                continue;
            }
            let slope = Vector3::new(-away.x / distance, -away.y / distance, -1.0);
            normal += slope * slope.transpose();
            right -= slope * (distance - self.radius);
        }
        for k in 0..3 {
            normal[(k, k)] *= 1.0 + damping;
        }
        normal.cholesky().map(|factor| factor.solve(&right))
    }
}

/// Coefficients of `a (x² + y²) + b x + c y + d`, from the triangle of the points' rows.
fn coefficients(rows: Matrix4<f64>) -> Option<Vector4<f64>> {
    let parts = rows.svd(false, true);
    let directions = parts.v_t?.transpose();
    let values = parts.singular_values;
    let (least, greatest) = (values.imin(), values.max());
    if !greatest.is_finite() {
        return None;
    }
    if values[least] < EXACT * greatest {
        return Some(directions.column(least).into_owned());
    }
    // Inverse of the form b² + c² - 4 a d that the algebraic distance is scaled by.
    let mut constraint = Matrix4::zeros();
    (constraint[(0, 3)], constraint[(3, 0)]) = (-0.5, -0.5);
    (constraint[(1, 1)], constraint[(2, 2)]) = (1.0, 1.0);
    let root = directions * Matrix4::from_diagonal(&values) * directions.transpose();
    let problem = (root * constraint * root).symmetric_eigen();
    let positive = (0..4).filter(|&k| problem.eigenvalues[k] > 0.0);
    let k = positive.min_by(|&i, &j| problem.eigenvalues[i].total_cmp(&problem.eigenvalues[j]))?;
    let inverse = Matrix4::from_diagonal(&values.map(|value| 1.0 / value));
    Some(directions * inverse * directions.transpose() * problem.eigenvectors.column(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(center: Point2<f64>, radius: f64, (from, to): (f64, f64), count: usize) -> Vec<Point2<f64>> {
        let angle = |k: usize| (from + (to - from) * k as f64 / (count - 1) as f64).to_radians();
        (0..count).map(|k| center + radius * nalgebra::Vector2::new(angle(k).cos(), angle(k).sin())).collect()
    }

    #[test]
    fn points_of_a_circle_give_it_wherever_it_is_and_however_short_the_arc() {
        for (center, radius, range) in [
            (Point2::new(100.0, -40.0), 5.0, (0.0, 60.0)),
            (Point2::new(-3e4, 2e4), 0.06, (10.0, 50.0)),
            (Point2::origin(), 2.0, (0.0, 345.0)),
        ] {
            let points = arc(center, radius, range, 13);
            let fit = PlaneCircle::pratt(&points).expect("a circle");
            let rounding = 1e-10 * (radius + 1e-4 * center.coords.norm());
            assert!((fit.radius - radius).abs() < rounding, "{fit:?}");
            assert!((fit.center - center).norm() < rounding, "{fit:?}");
            assert!((fit.refined(&points).radius - radius).abs() < rounding);
        }
        let three = arc(Point2::new(1.0, 2.0), 3.0, (0.0, 200.0), 3);
        assert!((PlaneCircle::pratt(&three).expect("through three").radius - 3.0).abs() < 1e-12);
    }

    #[test]
    fn lines_points_and_nothing_have_no_circle() {
        let line: Vec<_> = (0..10).map(|k| Point2::new(f64::from(k), 2.0 * f64::from(k) + 1.0)).collect();
        assert_eq!(PlaneCircle::pratt(&line), None);
        assert_eq!(PlaneCircle::pratt(&line[..2]), None);
        assert_eq!(PlaneCircle::pratt(&[Point2::new(1.0, 1.0); 5]), None);
        assert_eq!(PlaneCircle::pratt(&[Point2::new(f64::NAN, 0.0), line[1], line[2]]), None);
    }

    #[test]
    fn the_geometric_fit_is_a_minimum_of_the_distances() {
        let mut points = arc(Point2::new(3.0, 7.0), 5.0, (10.0, 55.0), 20);
        for (k, p) in points.iter_mut().enumerate() {
            p.x += 0.05 * (37.0 * k as f64).sin();
        }
        let fit = PlaneCircle::pratt(&points).expect("a circle").refined(&points);
        for (dx, dy, dr) in [(1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4)] {
            for sign in [-1.0, 1.0] {
                let center = Point2::new(fit.center.x + sign * dx, fit.center.y + sign * dy);
                let other = PlaneCircle { center, radius: fit.radius + sign * dr };
                assert!(other.cost(&points) > fit.cost(&points));
            }
        }
    }
}
