//! Parallel projection and the places of the views in the picture.

use super::View;
use crate::math::{BoundingBox, Point3, Vector3};
use crate::mesh::Mesh;

/// White space around every view, as a share of the picture's width.
const MARGIN: f64 = 0.022;

/// Sines below this count as parallel directions.
const PARALLEL: f64 = 1e-9;

/// Axes of the picture in space: right, up, and towards the eye.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Camera {
    pub right: Vector3<f64>,
    pub up: Vector3<f64>,
    pub eye: Vector3<f64>,
}

/// Where a view stands: a rectangle of pixels, and what maps the picture plane to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Left column of the rectangle.
    pub left: u32,
    /// Upper row of the rectangle.
    pub top: u32,
    pub width: u32,
    pub height: u32,
    /// Pixels for a file unit.
    scale: f64,
    /// Coordinates on the picture plane of the rectangle's left upper corner.
    corner: [f64; 2],
}

/// Size of the picture, and the place of each view.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub width: u32,
    pub height: u32,
    pub places: Vec<Place>,
}

/// A vertex in pixels from the left upper corner of its place, rows downward, and its depth: greater is nearer.
pub(super) type Projected = [f64; 3];

impl Camera {
    /// `None` when the directions are parallel or zero.
    pub(super) fn new(eye: Vector3<f64>, up: Vector3<f64>) -> Option<Self> {
        let eye = eye.try_normalize(0.0)?;
        let right = up.try_normalize(0.0)?.cross(&eye).try_normalize(PARALLEL)?;
        Some(Self { right, up: eye.cross(&right), eye })
    }

    fn plane(&self, point: &Point3<f64>) -> [f64; 3] {
        [point.coords.dot(&self.right), point.coords.dot(&self.up), point.coords.dot(&self.eye)]
    }

    /// Least and greatest coordinates on the picture plane of what the triangles use, as far as it is to be drawn.
    fn bounds(&self, mesh: &Mesh, focus: Option<&BoundingBox>) -> Option<[[f64; 2]; 2]> {
        let drawn = |p: &Point3<f64>| focus.is_none_or(|focus| focus.contains(p));
        mesh.corners().flatten().filter(drawn).map(|p| self.plane(&p)).fold(None, |bounds, [x, y, _]| {
            let [[x0, y0], [x1, y1]] = bounds.unwrap_or([[x, y]; 2]);
            Some([[x0.min(x), y0.min(y)], [x1.max(x), y1.max(y)]])
        })
    }

    /// Places views in one row at one scale, centred on one line; `None` when no view has an extent.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "casts of floats saturate")]
    pub(super) fn lay_out(&self, views: &[View], width: u32, focus: Option<&BoundingBox>) -> Option<Layout> {
        let bounds: Vec<_> = views.iter().map(|v| self.bounds(v.mesh, focus).unwrap_or_default()).collect();
        let sizes: Vec<_> = bounds.iter().map(|[low, high]| [high[0] - low[0], high[1] - low[1]]).collect();
        let total: f64 = sizes.iter().map(|s| s[0]).sum();
        let tallest = sizes.iter().map(|s| s[1]).fold(0.0, f64::max);
        let margin = MARGIN * f64::from(width);
        #[expect(clippy::cast_precision_loss, reason = "nobody draws 2^52 views")]
        let free = f64::from(width) - margin * (views.len() as f64 + 1.0);
        // A part that is much taller than wide must not give a picture that is much taller than wide.
        let scale = (free / total).min(2.0 * f64::from(width) / tallest);
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let height = (tallest * scale + 2.0 * margin).ceil() as u32;
        let row = total * scale + margin * (views.len() as f64 - 1.0);
        let mut left = 0.5 * (f64::from(width) - row);
        let mut places = Vec::with_capacity(views.len());
        for ([low, high], size) in bounds.iter().zip(&sizes) {
            let top = 0.5 * (f64::from(height) - size[1] * scale);
            // Two pixels around for outlines.
            let (column, line) = ((left - 2.0).floor().max(0.0), (top - 2.0).floor().max(0.0));
            places.push(Place {
                left: column as u32,
                top: line as u32,
                width: (size[0] * scale + 6.0).ceil() as u32,
                height: (size[1] * scale + 6.0).ceil() as u32,
                scale,
                corner: [low[0] - (left - column) / scale, high[1] + (top - line) / scale],
            });
            left += size[0] * scale + margin;
        }
        Some(Layout { width, height, places })
    }

    /// All vertices of a mesh at its place.
    pub(super) fn project(&self, mesh: &Mesh, place: &Place) -> Vec<Projected> {
        let to_pixels = |point: &Point3<f64>| {
            let [x, y, depth] = self.plane(point);
            [(x - place.corner[0]) * place.scale, (place.corner[1] - y) * place.scale, depth * place.scale]
        };
        mesh.vertices.iter().map(to_pixels).collect()
    }
}
