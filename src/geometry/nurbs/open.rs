//! Surfaces that close on themselves, cut open elsewhere: the seam is where the parameters begin, and no more.

use super::{KnotVector, NurbsSurface};

/// Relative difference of weights at which both ends of a closed surface say the same.
const SAME_WEIGHT: f64 = 1e-10;

impl NurbsSurface {
    /// A clamped surface that closes along `u`, cut open at `at`: the same points from there on and round, over the
    /// domain `onto`, which must be as long as the old one; and the parameter of the old seam there.
    ///
    /// The old seam becomes an inner knot as often as the degree; where the surface is smooth there it may be removed
    /// again. `None` when `at` is no inner parameter, or the ends have other weights.
    #[must_use]
    pub fn opened_u(&self, at: f64, onto: (f64, f64)) -> Option<(Self, f64)> {
        let (start, end) = self.knots_u().domain();
        if !(at > start && at < end) {
            return None;
        }
        let p = self.knots_u().degree();
        let lacking = p.saturating_sub(self.knots_u().multiplicity(at));
        let opened = self.refined_u(&vec![at; lacking]).ok()?;
        let all = opened.knots_u().knots();
        let columns = opened.shape().1;
        let first = all.partition_point(|k| *k < at);
        // The row whose function is 1 at the cut.
        let row = first - 1;
        let net = opened.net();
        // The seam's points stand once, so that both ends must say the same.
        let last = &net[net.len() - columns..];
        if net.iter().zip(last).any(|(a, b)| (a[3] - b[3]).abs() > SAME_WEIGHT * a[3]) {
            return None;
        }
        let mut points = net[row * columns..].to_vec();
        points.extend_from_slice(&net[columns..(row + 1) * columns]);
        let seam = onto.0 + (end - at);
        let mut values = vec![onto.0; p + 1];
        values.extend(all[first + p..].iter().take_while(|k| **k < end).map(|k| onto.0 + (k - at)));
        values.extend(std::iter::repeat_n(seam, p));
        let moved = all.iter().filter(|k| **k > start && **k < at);
        values.extend(moved.map(|k| onto.1 - (at - k)));
        values.extend(std::iter::repeat_n(onto.1, p + 1));
        let knots = KnotVector::new(p, values).ok()?;
        Some((Self::new(knots, opened.knots_v().clone(), points).ok()?, seam))
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::Surface;
    use crate::math::{Frame, Point3, Vector3};
    use std::f64::consts::TAU;

    #[test]
    fn a_cylinder_cut_open_elsewhere_and_back_again_is_itself() {
        let frame = Frame { origin: Point3::origin(), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() };
        let whole = Surface::Cylinder { frame, radius: 2.0 }.to_nurbs((0.0, TAU), (0.0, 5.0)).unwrap();
        let (turned, seam) = whole.opened_u(1.0, (1.0, 1.0 + TAU)).unwrap();
        for k in 0..=20 {
            let u = TAU * f64::from(k) / 20.0;
            let on = if u < 1.0 { u + TAU } else { u };
            assert!((whole.point(u, 3.0) - turned.point(on, 3.0)).norm() < 1e-14);
        }
        let (back, _) = turned.opened_u(seam, (0.0, TAU)).unwrap();
        assert_eq!(back.domain(), whole.domain());
        for k in 0..=20 {
            let u = TAU * f64::from(k) / 20.0;
            assert!((whole.point(u, 3.0) - back.point(u, 3.0)).norm() < 1e-14);
        }
        assert!(whole.opened_u(0.0, (0.0, TAU)).is_none());
    }
}
