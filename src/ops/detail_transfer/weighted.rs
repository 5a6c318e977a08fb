//! Differences added to a rational curve, exactly.
//!
//! With `S = N / w` and differences `d`, the sum `(N + w d) / w` is a rational curve of the degrees' sum. Its control
//! points are those of the polynomials `N + w d` and `w` in one space that holds both, found by interpolation.

use super::embed::snapped;
use super::error::TransferError;
use super::spline::Spline;
use crate::geometry::Curve;
use crate::geometry::nurbs::{GrevilleCollocation, KnotVector, NurbsCurve3};

/// Degree up to which a sum is made exactly: what other systems read.
pub(super) const MOST_DEGREE: usize = 9;

/// The rational form of a curve that has no exact one without weights; `None` for every other.
///
/// That of a conic runs otherwise than the conic, over the same domain.
pub(super) fn rational_form(curve: &Curve) -> Option<NurbsCurve3> {
    if matches!(curve, Curve::Composite(_)) {
        return None;
    }
    let exact = curve.to_nurbs(curve.domain()).ok()?;
    exact.is_rational().then(|| exact.clamped())
}

/// The sum of a rational curve and differences over the same domain; `None` when its degree would be above
/// [`MOST_DEGREE`].
///
/// # Errors
/// [`TransferError::NotFinite`].
pub(super) fn sum(target: &NurbsCurve3, detail: &Spline) -> Result<Option<NurbsCurve3>, TransferError> {
    let degree = target.knots().degree() + detail.knots.degree();
    if degree > MOST_DEGREE {
        return Ok(None);
    }
    let made =
        KnotVector::new(detail.knots.degree(), snapped(target.knots(), &detail.knots)).ok().and_then(|own| {
            let knots = product_knots(target.knots(), &own)?;
            let collocation = GrevilleCollocation::new(&knots).ok()?;
            let mut rows: Vec<f64> =
                collocation.abscissae().iter().flat_map(|&t| homogeneous_sum(target, detail, t)).collect();
            collocation.solve_rows(&mut rows, 4);
            NurbsCurve3::new(knots, rows.as_chunks::<4>().0.to_vec()).ok()
        });
    made.map(Some).ok_or(TransferError::NotFinite)
}

/// `(N + w d, w)` at a parameter.
fn homogeneous_sum(target: &NurbsCurve3, detail: &Spline, t: f64) -> [f64; 4] {
    let [mut x, mut y, mut z, w] = target.homogeneous_point(t);
    let d = detail.at(t)[0];
    x += w * d.x;
    y += w * d.y;
    z += w * d.z;
    [x, y, z, w]
}

/// Knots of the products of two spline spaces: each knot with the greater of its multiplicities, raised by the degree
/// of the other space where it occurs.
pub(super) fn product_knots(a: &KnotVector, b: &KnotVector) -> Option<KnotVector> {
    let degree = a.degree() + b.degree();
    let mut values: Vec<f64> = a.knots().iter().chain(b.knots()).copied().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let raised = |knots: &KnotVector, value: f64, by: usize| match knots.multiplicity(value) {
        0 => 0,
        multiplicity => multiplicity + by,
    };
    let count = |value: f64| raised(a, value, b.degree()).max(raised(b, value, a.degree()));
    let knots = values.into_iter().flat_map(|value| std::iter::repeat_n(value, count(value)));
    KnotVector::new(degree, knots.collect()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, Point3, Vector3};

    #[test]
    fn a_circle_carries_a_cubic_exactly() {
        let frame = Frame::from_axis(Point3::new(1.0, -2.0, 3.0), Vector3::new(0.2, -0.1, 1.0), None);
        let circle = Curve::Circle { frame: frame.expect("a frame"), radius: 25.0 };
        let exact = rational_form(&circle).expect("a circle needs weights");
        let (start, end) = exact.domain();
        let knots = KnotVector::clamped_uniform(3, 13, start, end).expect("good knots");
        let points = (0..16).map(|i| [f64::from(i).sin(), f64::from(i * i).cos(), 0.3]).collect();
        let detail = Spline { knots, points };
        let made = sum(&exact, &detail).expect("finite").expect("a degree that is read");
        assert_eq!(made.knots().degree(), 5);
        for i in 0..=400 {
            let t = start + (end - start) * f64::from(i) / 400.0;
            let wanted = exact.point_at(t) + detail.at(t)[0];
            assert!((made.point_at(t) - wanted).norm() <= 1e-12 * 50.0, "at {t}");
        }
    }

    #[test]
    fn only_curves_with_weights_have_a_rational_form() {
        let line = Curve::Line { origin: Point3::origin(), direction: Vector3::x() };
        assert!(rational_form(&line).is_none());
    }
}
