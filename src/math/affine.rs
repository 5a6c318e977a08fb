//! Affine maps of space, and the small rotations that frames are carried by.

use super::{Frame, Matrix3, Point3, Vector3};

/// `x ↦ linear · x + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Linear part.
    pub linear: Matrix3<f64>,
    /// Translation, in file units.
    pub translation: Vector3<f64>,
}

/// Relative deviation of `MᵀM` from a multiple of the identity below which a map counts as a similarity.
///
/// Ten thousand rounding errors: a rotation composed of several still passes, a scale that a user can
/// write down as non-uniform does not.
const SIMILARITY: f64 = 1e-12;

impl Affine {
    /// The map that moves nothing.
    #[must_use]
    pub fn identity() -> Self {
        Self { linear: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// The map `x ↦ linear · (x - center) + center`.
    #[must_use]
    pub fn about(center: &Point3<f64>, linear: Matrix3<f64>) -> Self {
        Self { linear, translation: center.coords - linear * center.coords }
    }

    /// The map that multiplies every coordinate by one factor.
    #[must_use]
    pub fn scale(factor: f64) -> Self {
        Self { linear: Matrix3::identity() * factor, translation: Vector3::zeros() }
    }

    /// From coordinates in a frame to coordinates in the space that the frame is given in.
    #[must_use]
    pub fn from_frame(frame: &Frame) -> Self {
        Self { linear: Matrix3::from_columns(&[frame.x, frame.y, frame.z]), translation: frame.origin.coords }
    }

    /// A shift.
    #[must_use]
    pub fn translation(by: Vector3<f64>) -> Self {
        Self { linear: Matrix3::identity(), translation: by }
    }

    /// Image of a point.
    #[must_use]
    pub fn point(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.linear * point.coords + self.translation)
    }

    /// Image of a vector.
    #[must_use]
    pub fn vector(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.linear * vector
    }

    /// First `other`, then `self`.
    #[must_use]
    pub fn after(&self, other: &Self) -> Self {
        Self {
            linear: self.linear * other.linear,
            translation: self.linear * other.translation + self.translation,
        }
    }

    /// The inverse map; `None` when the linear part is singular or not finite.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        linear
            .iter()
            .all(|c| c.is_finite())
            .then(|| Self { linear, translation: -(linear * self.translation) })
    }

    /// Whether it is exactly the identity.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self::identity()
    }

    /// Whether it keeps orientation: a positive determinant.
    #[must_use]
    pub fn keeps_orientation(&self) -> bool {
        self.linear.determinant() > 0.0
    }

    /// The factor by which every length grows, if it is the same in all directions (mirrors included).
    #[must_use]
    pub fn similarity_factor(&self) -> Option<f64> {
        let gram = self.linear.transpose() * self.linear;
        let square = gram.trace() / 3.0;
        let rest = (gram - Matrix3::identity() * square).norm();
        (square.is_finite() && square > 0.0 && rest <= SIMILARITY * square).then(|| square.sqrt())
    }

    /// Whether every angle is kept.
    #[must_use]
    pub fn is_similarity(&self) -> bool {
        self.similarity_factor().is_some()
    }

    /// Whether every distance is kept.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.similarity_factor().is_some_and(|f| (f - 1.0).abs() <= SIMILARITY)
    }
}

/// Cofactor matrix `det(M) M⁻ᵀ`, defined for singular matrices too: it maps normals (`Ma × Mb = C (a × b)`).
#[must_use]
pub fn cofactor(m: &Matrix3<f64>) -> Matrix3<f64> {
    let (a, b, c) = (m.column(0), m.column(1), m.column(2));
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

/// Cosine below which two unit vectors count as opposite, where the rotation's axis is lost.
const OPPOSITE: f64 = -0.999;

/// Rotation about a unit vector (Rodrigues).
#[must_use]
pub fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let k = axis.cross_matrix();
    Matrix3::identity() + k * sine + k * k * (1.0 - cosine)
}

/// The least rotation that takes the direction of `a` to that of `b`; a half turn about `fallback` made
/// perpendicular to `a` when they are opposite. Inputs need not be unit; zero vectors give the identity.
#[must_use]
pub fn minimal_rotation(a: &Vector3<f64>, b: &Vector3<f64>, fallback: &Vector3<f64>) -> Matrix3<f64> {
    let (Some(a), Some(b)) = (a.try_normalize(0.0), b.try_normalize(0.0)) else {
        return Matrix3::identity();
    };
    let c = a.dot(&b);
    if c < OPPOSITE {
        let across = fallback - a * a.dot(fallback);
        let axis = across.try_normalize(0.0).unwrap_or_else(|| any_perpendicular(&a));
        return axis * axis.transpose() * 2.0 - Matrix3::identity();
    }
    let k = a.cross(&b).cross_matrix();
    Matrix3::identity() + k + k * k / (1.0 + c)
}

fn any_perpendicular(a: &Vector3<f64>) -> Vector3<f64> {
    let axis = if a.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    a.cross(&axis).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimal_rotation_of_x_to_y_is_a_quarter_turn_about_z() {
        let r = minimal_rotation(&(Vector3::x() * 3.0), &Vector3::y(), &Vector3::z());
        let expected = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        assert!((r - expected).norm() < 1e-15);
    }

    #[test]
    fn opposite_directions_make_a_half_turn() {
        let r = minimal_rotation(&Vector3::z(), &-Vector3::z(), &Vector3::new(2.0, 0.0, 5.0));
        assert!((r - Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))).norm() < 1e-15);
    }

    #[test]
    fn cofactor_maps_cross_products_even_of_singular_maps() {
        let m = Matrix3::new(2.0, 1.0, 0.0, 0.0, 3.0, 1.0, 2.0, 4.0, 1.0);
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-1.0, 0.5, 2.0));
        assert!(((m * a).cross(&(m * b)) - cofactor(&m) * a.cross(&b)).norm() < 1e-12);
    }

    #[test]
    fn similarity_and_rigidity_tell_scales_apart() {
        let turn =
            minimal_rotation(&Vector3::new(1.0, 2.0, 3.0), &Vector3::new(-2.0, 1.0, 0.3), &Vector3::x());
        let rigid = Affine::about(&Point3::new(5.0, 6.0, 7.0), turn);
        assert!(rigid.is_rigid() && rigid.is_similarity());
        assert!((rigid.point(&Point3::new(5.0, 6.0, 7.0)) - Point3::new(5.0, 6.0, 7.0)).norm() < 1e-14);
        let doubled = Affine::about(&Point3::origin(), turn * 2.0);
        assert!(!doubled.is_rigid());
        assert!((doubled.similarity_factor().unwrap() - 2.0).abs() < 1e-14);
        let stretched =
            Affine::about(&Point3::origin(), Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.000001)));
        assert!(!stretched.is_similarity());
        let back = doubled.inverse().unwrap().after(&doubled);
        assert!((back.linear - Matrix3::identity()).norm() < 1e-15);
    }
}
