//! Pictures of surfaces as PNG: highlight lines, shading and the outlines of faces.
//!
//! Highlight lines show what a shaded picture hides: their kinks are kinks of the normal. Draws meshes with
//! the normals of their surfaces, knows no B-rep and no files. Software only, so a picture is the same on
//! every machine.

mod camera;
mod field;
mod outline;
mod raster;
mod shade;

use crate::math::{BoundingBox, Point3, Vector3};
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
    /// The part of space to draw; `None` for all of every mesh.
    pub focus: Option<BoundingBox>,
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
            focus: None,
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

/// A drawing of a number over a surface: mean curvature, deviation.
#[derive(Debug, Clone, Copy)]
pub struct FieldView<'a> {
    /// What to draw.
    pub mesh: &'a Mesh,
    /// The number at each vertex.
    pub values: &'a [f64],
    /// The number that gets the full colour, positive; the same below zero the other one.
    pub full: f64,
}

/// Draws views side by side at one scale, so that a part that grew looks greater.
///
/// # Errors
/// When there is nothing to draw, a mesh is not sound, or directions or size make no sense.
pub fn highlight_lines(views: &[View], options: &PictureOptions) -> Result<Vec<u8>, PictureError> {
    let mut canvas = Canvas::new(views, options)?;
    for (at, View { mesh }) in views.iter().enumerate() {
        if mesh.triangles.is_empty() {
            continue;
        }
        let lights = shade::Lights::new(mesh, options)
            .ok_or(PictureError::Directions { what: "lights_above and lights_along" })?;
        canvas.draw(at, mesh, |camera, point, normal, _| shade::colour(&lights, camera, point, normal));
    }
    canvas.png()
}

/// Draws numbers over surfaces as colours, side by side at one scale: blue below zero, red above.
///
/// # Errors
/// As [`highlight_lines`]; [`PictureError::UnsoundMesh`] also for values of another count than vertices.
pub fn field(views: &[FieldView], options: &PictureOptions) -> Result<Vec<u8>, PictureError> {
    let plain: Vec<View> = views.iter().map(|view| View { mesh: view.mesh }).collect();
    let unsound = |v: &FieldView| v.values.len() != v.mesh.vertices.len() || v.full.is_nan() || v.full <= 0.0;
    if let Some(view) = views.iter().position(unsound) {
        return Err(PictureError::UnsoundMesh { view });
    }
    let mut canvas = Canvas::new(&plain, options)?;
    for (at, view) in views.iter().enumerate() {
        canvas.draw(at, view.mesh, |camera, _, normal, (triangle, weights)| {
            let corners = view.mesh.triangles[triangle];
            let value: f64 = corners.iter().zip(weights).map(|(&k, w)| view.values[k as usize] * w).sum();
            field::colour(value / view.full, camera, normal)
        });
    }
    canvas.png()
}

/// A picture in the making.
struct Canvas {
    camera: Camera,
    layout: camera::Layout,
    pixmap: tiny_skia::Pixmap,
}

impl Canvas {
    fn new(views: &[View], options: &PictureOptions) -> Result<Self, PictureError> {
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
        let layout =
            camera.lay_out(views, options.width, options.focus.as_ref()).ok_or(PictureError::Empty)?;
        let (width, height) = (layout.width, layout.height);
        if !(1..=LONGEST_SIDE).contains(&width) || !(1..=LONGEST_SIDE).contains(&height) {
            return Err(PictureError::Size { width, height });
        }
        let mut pixmap = tiny_skia::Pixmap::new(width, height).ok_or(PictureError::Size { width, height })?;
        pixmap.fill(tiny_skia::Color::WHITE);
        Ok(Self { camera, layout, pixmap })
    }

    /// Draws one view at its place.
    fn draw(
        &mut self,
        view: usize,
        mesh: &Mesh,
        colour: impl Fn(&Camera, &Point3<f64>, &Vector3<f64>, (usize, [f64; 3])) -> [f64; 3],
    ) {
        let place = self.layout.places[view];
        let projected = self.camera.project(mesh, &place);
        let camera = &self.camera;
        let raster = raster::Raster::draw(mesh, &projected, &place, |point, normal, at| {
            colour(camera, point, normal, at)
        });
        raster.copy_to(&mut self.pixmap, &place);
        outline::draw(mesh, &projected, &raster, &place, &mut self.pixmap);
    }

    fn png(self) -> Result<Vec<u8>, PictureError> {
        let (width, height) = (self.layout.width, self.layout.height);
        // Encoding fails on sizes alone, and the size is known to be good.
        self.pixmap.encode_png().map_err(|_| PictureError::Size { width, height })
    }
}

#[cfg(test)]
mod tests;
