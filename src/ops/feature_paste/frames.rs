//! Frames of surfaces, and the linear maps that carry a feature's detail from one surface to another.

use super::PasteError;
use super::settings::Turn;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Matrix3, Vector3, minimal_rotation};

/// `|S_u x S_v|` over the product of the lengths below which a parametrisation counts as singular.
const PARALLEL: f64 = 1e-12;

/// Orthonormal columns: along `S_u`, normal times that, normal.
///
/// # Errors
/// [`PasteError::SingularParametrisation`].
pub fn frame_at(
    surface: &NurbsSurface,
    at: [f64; 2],
    side: &'static str,
) -> Result<Matrix3<f64>, PasteError> {
    let (_, du, dv) = surface.first_derivatives(at[0], at[1]);
    frame_of(&du, &dv).ok_or(PasteError::SingularParametrisation { side, at })
}

/// The frame of two tangents; `None` when they are parallel.
pub(super) fn frame_of(du: &Vector3<f64>, dv: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let cross = du.cross(dv);
    let regular = cross.norm() > PARALLEL * du.norm() * dv.norm();
    let (e, n) = (du.try_normalize(0.0)?, cross.try_normalize(0.0)?);
    regular.then(|| Matrix3::from_columns(&[e, n.cross(&e), n]))
}

/// The linear part that takes detail on the source's frame to the target's.
#[must_use]
pub fn carry(source: &Matrix3<f64>, target: &Matrix3<f64>, turn: Turn, scale: &[f64; 3]) -> Matrix3<f64> {
    match turn {
        Turn::None => Matrix3::identity(),
        Turn::Normal => {
            let normal = |f: &Matrix3<f64>| f.column(2).into_owned();
            minimal_rotation(&normal(source), &normal(target), &source.column(0).into_owned()) * scale[2]
        }
        Turn::Frame => {
            target * Matrix3::from_diagonal(&Vector3::new(scale[0], scale[1], scale[2])) * source.transpose()
        }
    }
}
