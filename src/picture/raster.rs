//! A depth-buffered rasteriser with several samples to the pixel.

use super::camera::{Place, Projected};
use crate::math::{Point3, Vector3};
use crate::mesh::Mesh;

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;

/// Samples of one view: light intensities and depths, rows downward.
pub(super) struct Raster {
    width: usize,
    height: usize,
    colours: Vec<[f32; 3]>,
    depths: Vec<f32>,
}

impl Raster {
    /// Draws all triangles, each sample coloured from the place and normal that it shows, and from the triangle and the
    /// weights of its corners.
    pub(super) fn draw(
        mesh: &Mesh,
        projected: &[Projected],
        place: &Place,
        colour: impl Fn(&Point3<f64>, &Vector3<f64>, (usize, [f64; 3])) -> [f64; 3],
    ) -> Self {
        let (width, height) = (place.width as usize * SAMPLES, place.height as usize * SAMPLES);
        let colours = vec![[1.0; 3]; width * height];
        let mut raster = Self { width, height, colours, depths: vec![f32::NEG_INFINITY; width * height] };
        for (at, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|k| mesh.vertices[k as usize]);
            let flat = (b - a).cross(&(c - a));
            let normals = mesh.normals.get(at).copied().unwrap_or([flat; 3]);
            raster.triangle(corners.map(|k| projected[k as usize]), |weights| {
                let mix = |values: [Vector3<f64>; 3]| {
                    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
                };
                colour(&Point3::from(mix([a.coords, b.coords, c.coords])), &mix(normals), (at, weights))
            });
        }
        raster
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "casts of floats saturate")]
    #[expect(clippy::cast_precision_loss, reason = "a raster has fewer than 2^52 samples a side")]
    fn triangle(&mut self, corners: [Projected; 3], colour: impl Fn([f64; 3]) -> [f64; 3]) {
        let [a, b, c] = corners.map(|[x, y, depth]| [x * SAMPLES as f64, y * SAMPLES as f64, depth]);
        let double_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if double_area == 0.0 {
            return;
        }
        let range = |axis: usize, limit: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]).floor().max(0.0) as usize;
            let high = a[axis].max(b[axis]).max(c[axis]).ceil().max(0.0) as usize;
            low..high.saturating_add(1).min(limit)
        };
        for row in range(1, self.height) {
            for column in range(0, self.width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let part = |p: Projected, q: Projected| {
                    ((p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x)) / double_area
                };
                let weights = [part(b, c), part(c, a), part(a, b)];
                if weights.iter().any(|&w| w < 0.0) {
                    continue;
                }
                let depth = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) as f32;
                let at = row * self.width + column;
                if depth > self.depths[at] {
                    self.depths[at] = depth;
                    self.colours[at] = colour(weights).map(|c| c as f32);
                }
            }
        }
    }

    /// Depth of the nearest sample around a place in pixels; the farthest of a small window, so that lines
    /// on the surface count as visible.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "casts of floats saturate")]
    pub(super) fn depth(&self, x: f64, y: f64) -> f64 {
        let reach = SAMPLES;
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let middle = [x, y].map(|c| (c * SAMPLES as f64).max(0.0) as usize);
        let rows = middle[1].saturating_sub(reach)..(middle[1] + reach + 1).min(self.height);
        let mut farthest = f32::INFINITY;
        for row in rows {
            for column in middle[0].saturating_sub(reach)..(middle[0] + reach + 1).min(self.width) {
                farthest = farthest.min(self.depths[row * self.width + column]);
            }
        }
        f64::from(farthest)
    }

    /// Averages the samples of each pixel as light, and lays the covered part over the picture.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rounded and within a byte")]
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    pub(super) fn copy_to(&self, pixmap: &mut tiny_skia::Pixmap, place: &Place) {
        let (columns, rows) = (pixmap.width(), pixmap.height());
        let pixels = pixmap.pixels_mut();
        for y in 0..place.height.min(rows.saturating_sub(place.top)) {
            for x in 0..place.width.min(columns.saturating_sub(place.left)) {
                let mut sum = [0.0f32; 3];
                for sample in 0..SAMPLES * SAMPLES {
                    let row = y as usize * SAMPLES + sample / SAMPLES;
                    let column = x as usize * SAMPLES + sample % SAMPLES;
                    let colour = self.colours[row * self.width + column];
                    sum = std::array::from_fn(|k| sum[k] + colour[k]);
                }
                let [r, g, b] = sum.map(|light| {
                    let light = light / (SAMPLES * SAMPLES) as f32;
                    (light.powf(1.0 / 2.2) * 255.0).round() as u8
                });
                let at = (y + place.top) as usize * columns as usize + (x + place.left) as usize;
                pixels[at] = tiny_skia::ColorU8::from_rgba(r, g, b, 255).premultiply();
            }
        }
    }
}
