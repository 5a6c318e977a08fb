//! The source face made ready: its surface in the units and the sense of the target, the contour in its parameters.

use super::super::contour::{Plane, project_contour};
use super::super::error::PasteError;
use super::target::natural_sense;
use super::{Region, Source, note};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use crate::math::{Affine, BoundingBox, Matrix3, Vector3};
use crate::model::Context;
use crate::ops::OperationError;
use crate::ops::net::Polygon;
use crate::ops::net::layout::{face_name, lay_out, spline_of};

/// A source that the numeric core can take.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    /// The surface.
    pub surface: NurbsSurface,
    /// The contour.
    pub contour: Vec<[f64; 2]>,
    /// The anchor.
    pub anchor: [f64; 2],
    /// Size of the feature in space.
    pub size: f64,
    /// What is worth telling.
    pub notes: Vec<Diagnostic>,
}

/// Ratio of two units that counts as one: the same unit written differently.
const SAME_UNIT: f64 = 1e-12;

impl Prepared {
    /// `sense` tells whether the target's surface normal is its face's.
    pub fn of(source: &Source<'_>, target: &Context, sense: bool) -> Result<Self, OperationError> {
        let model = source.model;
        let raw = spline_of(model, source.face).ok_or_else(|| {
            let found = model.brep.surface_of(source.face).read().map_or("not read", Surface::kind);
            PasteError::SurfaceKind {
                side: "source",
                face: face_name(model, source.face),
                kind: found.to_owned(),
                expected: "a feature is taken from a B-spline surface",
            }
        })?;
        let (contour, notes) = contour(source, raw)?;
        let anchor = anchor(source, raw, &contour);
        let factor = model.context_of(source.face).length.metres / target.length.metres;
        let mut surface = raw.clone();
        if (factor - 1.0).abs() > SAME_UNIT {
            let map = Affine { linear: Matrix3::identity() * factor, translation: Vector3::zeros() };
            surface = surface.transformed(&map);
        }
        let points: Vec<_> = contour.iter().map(|p| surface.point(p[0], p[1])).collect();
        let size = BoundingBox::of(&points).diagonal();
        let mut prepared = Self { surface, contour, anchor, size, notes };
        if natural_sense(model, source.face) != sense {
            prepared.reverse();
        }
        Ok(prepared)
    }

    /// Lets `v` run the other way, so that the surface's normal turns to the other side.
    fn reverse(&mut self) {
        let (_, (start, end)) = self.surface.domain();
        self.surface = self.surface.reversed_v();
        let mirror = |p: [f64; 2]| [p[0], start + (end - p[1])];
        self.contour.iter_mut().for_each(|p| *p = mirror(*p));
        self.anchor = mirror(self.anchor);
    }
}

/// The contour in the parameters of the source, with a note when it holds holes.
fn contour(
    source: &Source<'_>,
    surface: &NurbsSurface,
) -> Result<(Vec<[f64; 2]>, Vec<Diagnostic>), OperationError> {
    let (model, face) = (source.model, source.face);
    let no_loop = |wanted: String| PasteError::NoSuchLoop { face: face_name(model, face), wanted };
    let layout = lay_out(model, face)?;
    let chosen = match &source.region {
        Region::Outer => Some(layout.outer.ok_or_else(|| no_loop("closed outer loop".to_owned()))?),
        Region::Inner(wanted) => {
            let mut inner = (0..layout.loops.len()).filter(|&k| layout.is_inner(k));
            let found = inner.nth(*wanted);
            Some(found.ok_or_else(|| no_loop(format!("inner loop {wanted}, counted from 0")))?)
        }
        Region::Parameters(_) | Region::Contour(..) => None,
    };
    let points = match &source.region {
        Region::Parameters(points) => points.clone(),
        Region::Contour(points, plane) => {
            let plane = plane.or_else(|| Plane::of_contour(points)).ok_or(PasteError::ContourDegenerate)?;
            project_contour(surface, points, plane)?
        }
        Region::Outer | Region::Inner(_) => {
            let shape = chosen.and_then(|k| layout.loops[k].as_ref());
            shape.map(|l| l.contour.points.clone()).unwrap_or_default()
        }
    };
    let (u, v) = surface.domain();
    let mut notes = Vec::new();
    if let Ok(polygon) = Polygon::new(&points, [0.0; 2], [u, v]) {
        let inside = |k: usize| {
            let shape = layout.loops[k].as_ref().filter(|_| layout.is_inner(k) && Some(k) != chosen);
            shape.is_some_and(|l| l.contour.points.first().is_some_and(|&p| polygon.contains(p)))
        };
        let holes = (0..layout.loops.len()).filter(|&k| inside(k)).count();
        if holes > 0 {
            let message =
                format!("{holes} holes of the feature are not carried: the surface is pasted across them");
            notes.push(note("paste.holes-closed", Severity::Warning, message));
        }
    }
    Ok((points, notes))
}

/// Parameters of the anchor: nearest to the given point, or the middle of the contour's box.
fn anchor(source: &Source<'_>, surface: &NurbsSurface, contour: &[[f64; 2]]) -> [f64; 2] {
    if let Some(point) = &source.anchor {
        let found = SurfaceLocator::new(surface, Wrap::default()).closest(point);
        return [found.u, found.v];
    }
    [0, 1].map(|k| {
        let at = || contour.iter().map(|p| p[k]);
        0.5 * (at().fold(f64::INFINITY, f64::min) + at().fold(f64::NEG_INFINITY, f64::max))
    })
}
