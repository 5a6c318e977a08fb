//! Transformation matrices (IGES 5.3 section 4.21), each in the space of the one that it points to itself.

use super::error::ReadError;
use super::scope::{MAX_DEPTH, Scope};
use crate::iges::{Entity, EntryNumber};
use crate::math::{Affine, Matrix3, Vector3};

/// Greatest deviation of the axes from perpendicular ones of length one that is rounding: files have as few as four
/// decimals.
pub(super) const ROUNDED: f64 = 1e-3;

/// The map of a matrix and of those above it.
pub(super) fn chain(scope: &Scope<'_>, number: EntryNumber) -> Result<Affine, ReadError> {
    let mut map = Affine::identity();
    let mut next = Some(number);
    for _ in 0..MAX_DEPTH {
        let Some(at) = next else { return Ok(map) };
        let view = scope.view_of(at, Entity::TransformationMatrix, "TRANSFORMATION_MATRIX")?;
        map = matrix(scope, at)?.after(&map);
        next = EntryNumber::from_pointer(view.instance().entry().transformation.into());
    }
    Err(ReadError::Cycle(number))
}

fn matrix(scope: &Scope<'_>, number: EntryNumber) -> Result<Affine, ReadError> {
    let view = scope.view(number)?;
    let m: [f64; 12] = view.fields().array("matrix")?;
    let rows = [0, 4, 8].map(|row| Vector3::new(m[row], m[row + 1], m[row + 2]));
    let linear = Matrix3::from_rows(&rows.map(|row| row.transpose()));
    let translation = Vector3::new(m[3], m[7], m[11]);
    if linear.determinant().abs() < f64::EPSILON {
        return Err(ReadError::Flat(number));
    }
    Ok(Affine { linear: rigid(&linear).unwrap_or(linear), translation })
}

/// The nearest matrix of perpendicular axes of length one, where the given one is that but for its rounding: a circle
/// must stay a circle.
fn rigid(linear: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    if off_rigid(linear) > ROUNDED {
        return None;
    }
    if off_rigid(linear) == 0.0 {
        return Some(*linear);
    }
    // Newton's iteration for the polar factor: quadratic, and the start is close.
    let mut q = *linear;
    for _ in 0..8 {
        q = (q + q.try_inverse()?.transpose()) * 0.5;
    }
    Some(q)
}

/// Greatest deviation of `MᵀM` from the identity.
pub(super) fn off_rigid(linear: &Matrix3<f64>) -> f64 {
    (linear.transpose() * linear - Matrix3::identity()).abs().max()
}
