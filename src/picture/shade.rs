//! The colour of a point from its place and normal: highlight bands under soft light.
//!
//! A point lies on the highlight line of a light line when its normal, prolonged, meets the light line
//! (Beier & Chen 1994). For light lines in a plane, parallel and evenly spaced, the place where the
//! prolonged normal meets the plane, measured across the lines, says which band the point belongs to.

use super::PictureOptions;
use super::camera::Camera;
use crate::math::{Point3, Vector3};
use crate::mesh::Mesh;

/// Colours as light intensities: dark band, light band.
const DARK: [f64; 3] = [0.024, 0.036, 0.068];
const LIGHT: [f64; 3] = [0.86, 0.90, 0.97];

/// Share of a band pair that is dark.
const DARK_SHARE: f64 = 0.46;

/// Least cosine between a normal and the lights' height: a steeper one meets the plane of the lights too far
/// away to mean anything, and its bands would be noise.
const STEEPEST: f64 = 0.05;

/// A plane of parallel light lines.
#[derive(Debug, Clone)]
pub(super) struct Lights {
    above: Vector3<f64>,
    across: Vector3<f64>,
    /// Coordinate of the plane along `above`.
    height: f64,
    /// Distance between lines, in file units.
    spacing: f64,
    /// Coordinate across of the middle of the view: a dark band's middle.
    start: f64,
}

impl Lights {
    /// The lights of one view; `None` when their directions are parallel or zero, or the view has no extent.
    pub(super) fn new(mesh: &Mesh, options: &PictureOptions) -> Option<Self> {
        let axes = Camera::new(options.lights_above, options.lights_along)?;
        let range = |axis: Vector3<f64>| {
            mesh.vertices.iter().map(|p| p.coords.dot(&axis)).fold(None, |range: Option<(f64, f64)>, c| {
                let (low, high) = range.unwrap_or((c, c));
                Some((low.min(c), high.max(c)))
            })
        };
        let ((low, high), (_, top)) = (range(axes.right)?, range(axes.eye)?);
        let spacing = (high - low) / options.bands;
        let height = top + options.lights_height * mesh.extents()?.diagonal();
        let good = spacing.is_finite() && spacing > 0.0 && height.is_finite();
        good.then_some(Self {
            above: axes.eye,
            across: axes.right,
            height,
            spacing,
            start: 0.5 * (low + high),
        })
    }

    /// Which band a point belongs to, as a number whose whole part counts pairs of bands; `None` when the
    /// normal is too steep.
    fn band(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> Option<f64> {
        let rise = normal.dot(&self.above);
        if rise.abs() < STEEPEST {
            return None;
        }
        let along = (self.height - point.coords.dot(&self.above)) / rise;
        Some((point.coords.dot(&self.across) + along * normal.dot(&self.across) - self.start) / self.spacing)
    }
}

/// Intensities of a point, each within [0, 1].
pub(super) fn colour(
    lights: &Lights,
    camera: &Camera,
    point: &Point3<f64>,
    normal: &Vector3<f64>,
) -> [f64; 3] {
    let Some(normal) = normal.try_normalize(0.0) else { return LIGHT };
    let facing = normal.dot(&camera.eye);
    let normal = if facing < 0.0 { -normal } else { normal };
    let dark = lights
        .band(point, &normal)
        .is_some_and(|band| (band + 0.5 * DARK_SHARE).rem_euclid(1.0) < DARK_SHARE);
    // One lamp from the upper left in front, and the sky.
    let lamp = (camera.eye + camera.up * 0.9 - camera.right * 0.7).normalize();
    let lit = normal.dot(&lamp).max(0.0);
    let shade = 0.42 + 0.40 * lit + 0.22 * facing.abs();
    let gloss = 0.06 * lit.powi(24);
    let base = if dark { DARK } else { LIGHT };
    base.map(|c| (c * shade + gloss).clamp(0.0, 1.0))
}
