//! The displacement field that a feature asks for, over the parameters of the target.

use super::NEEDED;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Matrix3, Vector3};
use crate::ops::feature_paste::PasteError;
use crate::ops::feature_paste::frames::frame_of;
use crate::ops::feature_paste::settings::{Mirror, ParameterMap, Settings};
use crate::ops::net::Mask;

/// The displacement that the feature asks for, as a function of the target's parameters.
pub(super) struct Field<'a> {
    pub source: &'a NurbsSurface,
    base: &'a NurbsSurface,
    /// Rectangle of source parameters outside which there is none.
    pub window: [(f64, f64); 2],
    pub map: ParameterMap,
    inverse: ParameterMap,
    scale: [f64; 3],
    /// -1 for a mirrored feature.
    side: f64,
}

impl<'a> Field<'a> {
    pub fn new(
        source: &'a NurbsSurface,
        base: &'a NurbsSurface,
        own: &Mask,
        map: ParameterMap,
        settings: &Settings,
    ) -> Result<Self, PasteError> {
        let small = PasteError::RegionTooSmall { rows: 0, columns: 0, needed: NEEDED };
        let window = own.support([source.knots_u(), source.knots_v()]).ok_or(small)?;
        let singular = PasteError::SingularParametrisation { side: "target", at: map.to };
        let inverse = map.inverse().ok_or(singular)?;
        let side = if settings.mirror == Mirror::None { 1.0 } else { -1.0 };
        Ok(Self { source, base, window, map, inverse, scale: settings.scale, side })
    }

    /// Images of the window's corners.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let [u, v] = self.window;
        [[u.0, v.0], [u.1, v.0], [u.1, v.1], [u.0, v.1]].map(|x| self.map.apply(x))
    }

    /// The displacement at target parameters with the target's derivatives there.
    pub fn at(&self, y: [f64; 2], (tu, tv): (&Vector3<f64>, &Vector3<f64>)) -> Vector3<f64> {
        let x = self.inverse.apply(y);
        let outside = (0..2).any(|k| x[k] < self.window[k].0 || x[k] > self.window[k].1);
        if outside {
            return Vector3::zeros();
        }
        let (point, bu, bv) = self.base.first_derivatives(x[0], x[1]);
        let detail = self.source.point(x[0], x[1]) - point;
        let along = tu * self.map.linear[0][0] + tv * self.map.linear[1][0];
        let (Some(from), Some(e)) = (frame_of(&bu, &bv), along.try_normalize(0.0)) else {
            return Vector3::zeros();
        };
        let Some(n) = tu.cross(tv).try_normalize(0.0) else { return Vector3::zeros() };
        let to = Matrix3::from_columns(&[e, n.cross(&e) * self.side, n]);
        let local = from.transpose() * detail;
        to * Vector3::new(local.x * self.scale[0], local.y * self.scale[1], local.z * self.scale[2])
    }
}
