//! The colour of a number: blue below zero, white at zero, red above, under the light of all pictures.

use super::camera::Camera;
use crate::math::Vector3;

/// Light intensities far below zero, at zero, far above.
const BELOW: [f64; 3] = [0.03, 0.12, 0.55];
const ZERO: [f64; 3] = [0.86, 0.87, 0.88];
const ABOVE: [f64; 3] = [0.60, 0.04, 0.03];

/// Colour of a share of the scale, from -1 to 1, where the surface has this normal.
pub(super) fn colour(share: f64, camera: &Camera, normal: &Vector3<f64>) -> [f64; 3] {
    let share = if share.is_finite() { share.clamp(-1.0, 1.0) } else { 0.0 };
    let end = if share < 0.0 { BELOW } else { ABOVE };
    let facing = normal.try_normalize(0.0).map_or(1.0, |n| n.dot(&camera.eye).abs());
    let light = 0.55 + 0.45 * facing;
    std::array::from_fn(|k| (ZERO[k] + (end[k] - ZERO[k]) * share.abs()) * light)
}
