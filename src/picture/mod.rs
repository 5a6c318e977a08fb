//! Pictures of surfaces as PNG: highlight lines, shading and the outlines of faces.
//!
//! Highlight lines show what a shaded picture hides: their kinks are kinks of the normal. Draws meshes with
//! the normals of their surfaces, knows no B-rep and no files. Software only, so a picture is the same on
//! every machine.

mod camera;
mod outline;
mod raster;
mod shade;

use crate::math::Vector3;
use crate::mesh::Mesh;
use camera::Camera;

/// One drawing in a row of drawings.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// What to draw; triangles of a mesh without normals are drawn flat.
    pub mesh: &'a Mesh,
}

/// How to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureOptions {
    /// Width of the whole picture in pixels; the height follows from the views.
    pub width: u32,
    /// Direction from the part to the eye.
    pub eye: Vector3<f64>,
    /// Direction that points up in the picture.
    pub up: Vector3<f64>,
    /// Normal of the plane of the light lines, from the part to the lights.
    pub lights_above: Vector3<f64>,
    /// Direction of the light lines.
    pub lights_along: Vector3<f64>,
    /// Height of the lights over the part, in diagonals of each view. The higher, the more do the
    /// lines tell of the normal and the less of the place.
    pub lights_height: f64,
    /// Pairs of a dark and a light band across each view's width, were it flat.
    pub bands: f64,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            width: 1600,
            eye: Vector3::new(0.0, -0.55, 1.0),
            up: Vector3::y(),
            lights_above: Vector3::z(),
            lights_along: Vector3::y(),
            lights_height: 1.0,
            bands: 14.0,
        }
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// No view, or none with a triangle.
    #[error("nothing to draw")]
    Empty,
    /// A view has a vertex that is not finite, or normals of another count than triangles.
    #[error("the mesh of view {view} is not sound")]
    UnsoundMesh {
        /// View, from 0.
        view: usize,
    },
    /// Two directions that must differ are parallel, or one is zero.
    #[error("{what} give no picture plane")]
    Directions {
        /// Which two.
        what: &'static str,
    },
    /// Width or height is zero or too large.
    #[error("a picture of {width} x {height} pixels is out of range")]
    Size {
        /// Width.
        width: u32,
        /// Height.
        height: u32,
    },
}

/// Longest side of a picture, so that a job cannot ask for all memory.
const LONGEST_SIDE: u32 = 8192;

/// Draws views side by side at one scale, so that a part that grew looks greater.
///
/// # Errors
/// When there is nothing to draw, a mesh is not sound, or directions or size make no sense.
pub fn highlight_lines(views: &[View], options: &PictureOptions) -> Result<Vec<u8>, PictureError> {
    let camera =
        Camera::new(options.eye, options.up).ok_or(PictureError::Directions { what: "eye and up" })?;
    for (view, View { mesh }) in views.iter().enumerate() {
        let finite = mesh.vertices.iter().all(|p| p.iter().all(|c| c.is_finite()));
        let in_range = mesh.triangles.iter().flatten().all(|&at| (at as usize) < mesh.vertices.len());
        let normals = [0, mesh.triangles.len()].contains(&mesh.normals.len());
        if !(finite && in_range && normals) {
            return Err(PictureError::UnsoundMesh { view });
        }
    }
    let layout = camera.lay_out(views, options.width).ok_or(PictureError::Empty)?;
    let (width, height) = (layout.width, layout.height);
    if !(1..=LONGEST_SIDE).contains(&width) || !(1..=LONGEST_SIDE).contains(&height) {
        return Err(PictureError::Size { width, height });
    }
    let mut pixmap = tiny_skia::Pixmap::new(width, height).ok_or(PictureError::Size { width, height })?;
    pixmap.fill(tiny_skia::Color::WHITE);
    for (View { mesh }, &place) in views.iter().zip(&layout.places) {
        if mesh.triangles.is_empty() {
            continue;
        }
        let lights = shade::Lights::new(mesh, options)
            .ok_or(PictureError::Directions { what: "lights_above and lights_along" })?;
        let projected = camera.project(mesh, &place);
        let raster = raster::Raster::draw(mesh, &projected, &place, |point, normal| {
            shade::colour(&lights, &camera, point, normal)
        });
        raster.copy_to(&mut pixmap, &place);
        outline::draw(mesh, &projected, &raster, &place, &mut pixmap);
    }
    // Encoding fails on sizes alone, and the size is known to be good.
    pixmap.encode_png().map_err(|_| PictureError::Size { width, height })
}

#[cfg(test)]
mod tests;
