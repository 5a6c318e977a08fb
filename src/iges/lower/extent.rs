//! The rectangle of a surface's parameters that a face takes, by its edges.

use std::f64::consts::{PI, TAU};

use super::Lowering;
use crate::brep::FaceId;
use crate::geometry::Surface;
use crate::iges::to_model::spline::Rectangle;
use crate::math::Affine;

/// Points of an edge that are looked at.
const SAMPLES: u32 = 24;
/// Part of a period by which a range may fall short and is all of it.
const WHOLE: f64 = 1e-6;

impl Lowering<'_> {
    /// The rectangle, for a surface in a space from which `placed` leads to that of the model; `None` where an edge cannot
    /// be read.
    pub(super) fn extent(&self, face: FaceId, surface: &Surface, placed: &Affine) -> Option<Rectangle> {
        let back = placed.inverse()?;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let periods = surface.periods();
        let mut seed = None;
        for coedge in self.model.brep.coedges_of(face) {
            let piece = self.piece_now(self.model.brep.coedges[coedge].edge)?;
            for k in 0..=SAMPLES {
                let t = piece.range.0 + (piece.range.1 - piece.range.0) * f64::from(k) / f64::from(SAMPLES);
                let point = back.point(&piece.curve.point_wrapped(t));
                let (u, v) = surface.parameters_of(&point, seed);
                seed = Some((u, v));
                for (axis, value) in [u, v].into_iter().enumerate() {
                    low[axis] = low[axis].min(value);
                    high[axis] = high[axis].max(value);
                }
            }
        }
        let range = |axis: usize, period: Option<f64>| {
            let (low, high) = (low[axis], high[axis]);
            match period {
                Some(period) if high - low > (1.0 - WHOLE) * period => (low, low + period),
                _ => (low, high),
            }
        };
        let (u, v) = (range(0, periods.0), range(1, periods.1));
        (u.0 < u.1 && v.0 < v.1).then_some((u, v))
    }
    /// The surface turned about its axis so that its seam is opposite to a face which reaches or crosses it: a reader that
    /// finds the face's edges on the surface anew cannot tell on which side of the seam they lie. Others stay.
    pub(super) fn seam_away(&self, face: FaceId, surface: &Surface) -> Surface {
        let mut turned = surface.clone();
        let frame = match &mut turned {
            Surface::Cylinder { frame, .. }
            | Surface::Cone { frame, .. }
            | Surface::Sphere { frame, .. }
            | Surface::Torus { frame, .. } => frame,
            _ => return turned,
        };
        let Some(((from, to), _)) = self.extent(face, surface, &Affine::identity()) else { return turned };
        let start = from.rem_euclid(TAU);
        let end = start + (to - from);
        let is_clear = start > WHOLE && end < TAU - WHOLE;
        if is_clear || to - from > (1.0 - WHOLE) * TAU {
            return turned;
        }
        let (sine, cosine) = (0.5 * (start + end) - PI).sin_cos();
        (frame.x, frame.y) = (frame.x * cosine + frame.y * sine, frame.y * cosine - frame.x * sine);
        turned
    }
}
