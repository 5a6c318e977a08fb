//! Courses without an exact form as B-splines: cubic pieces that share point and tangent with the course at both ends,
//! halved until they are near enough.

use super::error::ReadError;
use crate::geometry::nurbs::{KnotVector, NurbsCurve3};
use crate::math::{Point3, Vector3};

/// Halvings of the interval.
const MAX_HALVINGS: u32 = 10;

/// A point and the derivative there.
pub(super) type Jet = (Point3<f64>, Vector3<f64>);

/// The B-spline through `course`, which is smooth between two neighbouring `breaks` (ascending, at least two), and how
/// far the two are apart at most. `what` names the course in the error.
pub(super) fn hermite(
    course: &dyn Fn(f64) -> Jet,
    mut breaks: Vec<f64>,
    tolerance: f64,
    what: &'static str,
) -> Result<(NurbsCurve3, f64), ReadError> {
    let (from, to) = (breaks[0], breaks[breaks.len() - 1]);
    if !((to - from).is_finite() && from < to) {
        return Err(ReadError::EmptyRange { from, to });
    }
    for _ in 0..MAX_HALVINGS {
        let curve = pieces(course, &breaks)?;
        let off = distance(course, &curve, &breaks);
        if off <= tolerance {
            return Ok((curve, off));
        }
        let middles: Vec<f64> = breaks.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        breaks.extend(middles);
        breaks.sort_by(f64::total_cmp);
    }
    Err(ReadError::KindNotReadYet(what))
}

fn pieces(course: &dyn Fn(f64) -> Jet, breaks: &[f64]) -> Result<NurbsCurve3, ReadError> {
    let mut net: Vec<[f64; 4]> = Vec::with_capacity(3 * breaks.len());
    let homogeneous = |p: Point3<f64>| [p.x, p.y, p.z, 1.0];
    for pair in breaks.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let third = (b - a) / 3.0;
        // At a corner of the course each piece has its own tangent.
        let inside = (b - a) * 1e-9;
        let ((p, _), (q, _)) = (course(a), course(b));
        let (dp, dq) = (course(a + inside).1, course(b - inside).1);
        net.pop();
        net.extend([p, p + dp * third, q - dq * third, q].map(homogeneous));
    }
    let last = breaks.len() - 1;
    let multiplicities: Vec<usize> = (0..=last).map(|i| 3 + usize::from(i == 0 || i == last)).collect();
    let knots = KnotVector::from_multiplicities(3, breaks, &multiplicities)?;
    Ok(NurbsCurve3::new(knots, net)?)
}

fn distance(course: &dyn Fn(f64) -> Jet, curve: &NurbsCurve3, breaks: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for pair in breaks.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for part in [0.25, 0.5, 0.75] {
            let t = a + (b - a) * part;
            worst = worst.max((course(t).0 - curve.point_at(t)).norm());
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_helix_is_met_within_the_tolerance() {
        let helix = |t: f64| (Point3::new(t.cos(), t.sin(), t), Vector3::new(-t.sin(), t.cos(), 1.0));
        let (curve, off) = hermite(&helix, vec![0.0, 6.0], 1e-7, "a helix").expect("a curve");
        assert!(off <= 1e-7);
        for k in 0..=1000 {
            let t = 6.0 * f64::from(k) / 1000.0;
            assert!((curve.point_at(t) - helix(t).0).norm() < 2e-7);
        }
    }
}
