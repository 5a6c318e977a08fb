//! Means of a surface's derivatives, and the closest point from a near start: what several steps measure with.

use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Point3, Vector3};

/// Point and first derivatives of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Tangents {
    /// Point.
    pub point: Point3<f64>,
    /// Derivative by `u`.
    pub du: Vector3<f64>,
    /// Derivative by `v`.
    pub dv: Vector3<f64>,
}

impl Tangents {
    /// At parameters within the domain.
    #[must_use]
    pub fn of(surface: &NurbsSurface, u: f64, v: f64) -> Self {
        let (point, du, dv) = surface.first_derivatives(u, v);
        Self { point, du, dv }
    }

    /// `S_u x S_v`, not normalised.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        self.du.cross(&self.dv)
    }
}

/// `count` equal steps from `a` to `b`, both included.
pub fn steps(a: f64, b: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let last = (count - 1) as f64;
    (0..count).map(move |k| if k + 1 == count { b } else { a + (b - a) * (k as f64 / last) })
}

/// Mean lengths of the parameter lines of a surface: mean `|S_u|` times the range of `u`, and likewise for `v`,
/// over `count` x `count` points with the borders.
#[must_use]
pub fn mean_lengths(surface: &NurbsSurface, count: usize) -> [f64; 2] {
    let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let mut sum = [0.0; 2];
    for u in steps(u0, u1, count) {
        for v in steps(v0, v1, count) {
            let t = Tangents::of(surface, u, v);
            sum[0] += t.du.norm();
            sum[1] += t.dv.norm();
        }
    }
    let samples = (count * count) as f64;
    [sum[0] / samples * (u1 - u0), sum[1] / samples * (v1 - v0)]
}

/// Iterations after which the closest point is taken as it is; convergence takes 3 to 6.
const CLOSEST_ITERATIONS: usize = 15;
/// Longest step as a part of the parameter range: longer ones jump to other sheets.
const LONGEST_STEP: f64 = 0.2;
/// Step, as a part of the range, below which the next one would be rounding.
const CONVERGED: f64 = 1e-16;

/// Parameters of the point of a surface that is closest to `target`, by Gauss-Newton from a near start.
///
/// Steps are clamped and parameters kept within the domain; where the derivatives are parallel the search stops.
#[must_use]
pub fn closest(surface: &NurbsSurface, target: &Point3<f64>, start: [f64; 2]) -> [f64; 2] {
    let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
    let mut at = start;
    for _ in 0..CLOSEST_ITERATIONS {
        let t = Tangents::of(surface, at[0], at[1]);
        let rest = target - t.point;
        let (e, f, g) = (t.du.norm_squared(), t.du.dot(&t.dv), t.dv.norm_squared());
        let (a, b) = (rest.dot(&t.du), rest.dot(&t.dv));
        let determinant = e * g - f * f;
        let step = [(g * a - f * b) / determinant, (e * b - f * a) / determinant];
        if !step.iter().all(|s| s.is_finite()) {
            return at;
        }
        let mut moved = 0.0_f64;
        for k in 0..2 {
            let range = domain[k].1 - domain[k].0;
            let step = step[k].clamp(-LONGEST_STEP * range, LONGEST_STEP * range);
            let next = (at[k] + step).clamp(domain[k].0, domain[k].1);
            moved = moved.max((next - at[k]).abs() / range);
            at[k] = next;
        }
        if moved <= CONVERGED {
            return at;
        }
    }
    at
}
