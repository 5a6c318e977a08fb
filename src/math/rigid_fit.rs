//! The rigid motion that takes some points nearest to others.

use super::{Affine, Matrix3, Point3, Vector3};

/// The rotation and shift that bring the first points of the pairs nearest to the second ones, by the sum of the
/// squared distances (Kabsch, Acta Crystallographica A32, 1976). Never a reflection.
///
/// `None` without pairs, or when their products are not finite. Points on a line or at one place leave the rotation
/// about it open; one of the best is given.
#[must_use]
pub fn rigid_fit(pairs: &[(Point3<f64>, Point3<f64>)]) -> Option<Affine> {
    let count = pairs.len() as f64;
    // Means from the first points on: a small figure far from the origin would lose digits otherwise.
    let (first, onto) = pairs.first()?;
    let mean = |offsets: Vector3<f64>, base: &Point3<f64>| base.coords + offsets / count;
    let from = mean(pairs.iter().map(|(p, _)| p - first).sum(), first);
    let to = mean(pairs.iter().map(|(_, q)| q - onto).sum(), onto);
    let products: Matrix3<f64> =
        pairs.iter().map(|(p, q)| (q.coords - to) * (p.coords - from).transpose()).sum();
    let linear = nearest_rotation(&products)?;
    Some(Affine { linear, translation: to - linear * from })
}

/// The rotation `R` for which the trace of `Rᵀ products` is greatest; `None` when an entry is not finite.
#[must_use]
pub fn nearest_rotation(products: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    if !products.iter().all(|c| c.is_finite()) {
        return None;
    }
    let parts = products.svd(true, true);
    let (u, v) = (parts.u?, parts.v_t?);
    let mut sides = Vector3::repeat(1.0);
    // The last singular value is the least: turning its side round costs least.
    sides.z = (u * v).determinant().signum();
    Some(u * Matrix3::from_diagonal(&sides) * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(pairs: &[(Point3<f64>, Point3<f64>)]) -> f64 {
        let fit = rigid_fit(pairs).expect("finite points");
        assert!((fit.linear.transpose() * fit.linear - Matrix3::identity()).amax() < 1e-14);
        assert!((fit.linear.determinant() - 1.0).abs() < 1e-14);
        pairs.iter().map(|(p, q)| (fit.point(p) - q).amax()).fold(0.0, f64::max)
    }

    fn circle() -> impl Iterator<Item = Point3<f64>> {
        (0..360).map(|degree| f64::from(degree).to_radians()).map(|t| Point3::new(t.cos(), t.sin(), 0.0))
    }

    #[test]
    fn a_moved_loop_fits_and_a_mirrored_one_does_only_in_its_plane() {
        let turn = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
        let motion = Affine { linear: turn, translation: Vector3::new(100.0, -3.0, 7.0) };
        let moved: Vec<_> = circle().map(|p| (p, motion.point(&p))).collect();
        assert!(worst(&moved) < 1e-13);
        let corners = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 2.0, 0.0)];
        let solid = corners.into_iter().chain([Point3::new(0.0, 0.0, 3.0)]);
        let mirrored: Vec<_> = solid.map(|p| (p, Point3::new(-p.x, p.y, p.z))).collect();
        assert!(worst(&mirrored) > 0.1);
    }

    #[test]
    fn a_circle_stretched_by_a_tenth_is_a_tenth_of_its_radius_off() {
        // By symmetry the best motion is none: (1.1 cos t, sin t) is off (cos t, sin t) by 0.1 at t = 0.
        let pairs: Vec<_> = circle().map(|p| (p, Point3::new(1.1 * p.x, p.y, 0.0))).collect();
        assert!((worst(&pairs) - 0.1).abs() < 1e-12);
        assert_eq!(rigid_fit(&[]), None);
    }
}
