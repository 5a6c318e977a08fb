//! The source face made ready: its surface in the units and the sense of the target, the contour in its parameters.

use super::super::contour::{Plane, project_contour};
use super::super::error::PasteError;
use super::holes::{Hole, hole_of};
use super::target::natural_sense;
use super::{FaceSource, Region};
use crate::brep::parameter_loop::{LoopSampling, parameter_loops};
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsCurve2, NurbsSurface, SurfaceLocator, Wrap};
use crate::math::{Affine, BoundingBox, Matrix3, Vector3};
use crate::model::Context;
use crate::ops::OperationError;
use crate::ops::net::layout::{face_name, lay_out, spline_of};
use crate::ops::net::{Contour, Domain, Polygon};

/// A feature taken off its face: all that a paste needs of it, in its own units.
#[derive(Debug, Clone)]
pub struct Extracted {
    /// The surface that the face lies on.
    pub surface: NurbsSurface,
    /// Closed polygon round the feature in its parameters.
    pub contour: Vec<[f64; 2]>,
    /// Parameters that go to the place on the target.
    pub anchor: [f64; 2],
    /// Length of its unit, in metres.
    pub metres: f64,
    /// Whether the surface's normal is the outward one of its face.
    pub natural: bool,
    /// Loops of the face inside the contour.
    pub holes: Vec<Hole>,
}

/// Takes a feature off its face.
///
/// # Errors
/// [`PasteError::SurfaceKind`], [`PasteError::NoSuchLoop`], and the contour errors.
pub fn extract(source: &FaceSource<'_>) -> Result<Extracted, OperationError> {
    let model = source.model;
    let surface = spline_of(model, source.face).ok_or_else(|| {
        let found = model.brep.surface_of(source.face).read().map_or("not read", Surface::kind);
        PasteError::SurfaceKind {
            side: "source",
            face: face_name(model, source.face),
            kind: found.to_owned(),
            expected: "a feature is taken from a B-spline surface",
        }
    })?;
    let (contour, holes) = contour(source, surface)?;
    Ok(Extracted {
        anchor: anchor(source, surface, &contour),
        surface: surface.clone(),
        contour,
        metres: model.context_of(source.face).length.metres,
        natural: natural_sense(model, source.face),
        holes,
    })
}

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
    /// Its holes.
    pub holes: Vec<Hole>,
}

/// Ratio of two units that counts as one: the same unit written differently.
const SAME_UNIT: f64 = 1e-12;

impl Prepared {
    /// `sense` tells whether the target's surface normal is its face's.
    pub fn of(feature: &Extracted, target: &Context, sense: bool) -> Result<Self, PasteError> {
        let factor = feature.metres / target.length.metres;
        let mut surface = feature.surface.clone();
        if (factor - 1.0).abs() > SAME_UNIT {
            let map = Affine { linear: Matrix3::identity() * factor, translation: Vector3::zeros() };
            surface = surface.transformed(&map);
        }
        let contour = feature.contour.clone();
        let points: Vec<_> = contour.iter().map(|p| surface.point(p[0], p[1])).collect();
        let size = BoundingBox::of(&points).diagonal();
        let mut prepared =
            Self { surface, contour, anchor: feature.anchor, size, holes: feature.holes.clone() };
        if feature.natural != sense {
            prepared.reverse()?;
        }
        Ok(prepared)
    }

    /// Lets `v` run the other way, so that the surface's normal turns to the other side.
    fn reverse(&mut self) -> Result<(), PasteError> {
        let (_, (start, end)) = self.surface.domain();
        self.surface = self.surface.reversed_v();
        let mirror = |p: [f64; 2]| [p[0], start + (end - p[1])];
        self.contour.iter_mut().for_each(|p| *p = mirror(*p));
        self.anchor = mirror(self.anchor);
        for curve in self.holes.iter_mut().flatten() {
            let image = |p: &[f64; 3]| [p[0], (start + end) * p[2] - p[1], p[2]];
            let net = curve.points().iter().map(image).collect();
            *curve =
                NurbsCurve2::new(curve.knots().clone(), net).map_err(|_| PasteError::HoleOutsideTarget)?;
        }
        Ok(())
    }
}

/// The contour in the parameters of the source, and the holes inside it.
fn contour(
    source: &FaceSource<'_>,
    surface: &NurbsSurface,
) -> Result<(Vec<[f64; 2]>, Vec<Hole>), OperationError> {
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
    // What is no polygon of the surface, the paste itself refuses.
    let Ok(polygon) = Polygon::new(&points, [0.0; 2], [u, v]) else { return Ok((points, Vec::new())) };
    if chosen.is_none() {
        let outer = layout.outer.and_then(|k| layout.loops[k].as_ref()).map(|shape| &shape.contour);
        inside_border(&polygon, outer, [u, v])?;
    }
    let inside = |k: &usize| {
        let shape = layout.loops[*k].as_ref().filter(|_| layout.is_inner(*k) && Some(*k) != chosen);
        shape.is_some_and(|l| l.contour.points.first().is_some_and(|&p| polygon.contains(p)))
    };
    let within: Vec<usize> = (0..layout.loops.len()).filter(inside).collect();
    if within.is_empty() {
        return Ok((points, Vec::new()));
    }
    let traced =
        parameter_loops(&model.brep, face, &LoopSampling::of_tolerance(f64::INFINITY)).map_err(|e| {
            OperationError::NoParameterLoops { face: face_name(model, face), reason: e.to_string() }
        })?;
    let holes = within.into_iter().map(|k| hole_of(&model.brep, &traced[k], surface)).collect();
    Ok((points, holes))
}

/// Part of the domain within which a contour touches the border.
const TOUCHES: f64 = 1e-6;

/// Whether a contour stays within the outer bound of its face; within the domain where it has none.
fn inside_border(contour: &Polygon, outer: Option<&Contour>, domain: Domain) -> Result<(), PasteError> {
    let [u, v] = domain;
    let whole = Contour { points: vec![[u.0, v.0], [u.1, v.0], [u.1, v.1], [u.0, v.1]], margin: [0.0; 2] };
    let outer = outer.unwrap_or(&whole);
    let Ok(border) = Polygon::new(&outer.points, outer.margin, domain) else { return Ok(()) };
    let slack = [0, 1].map(|k| outer.margin[k].max(TOUCHES * (domain[k].1 - domain[k].0)));
    let near = |p: &&[f64; 2], of: &Polygon| of.sides().any(|side| touches(**p, side, slack));
    let touching = contour.points().iter().find(|p| near(p, &border));
    let touching = touching.or_else(|| border.points().iter().find(|p| near(p, contour)));
    if let Some(&at) = touching {
        return Err(PasteError::ContourTouchesBorder { at });
    }
    match contour.points().iter().find(|p| !border.contains(**p)) {
        Some(_) if contour.points().iter().all(|p| !border.contains(*p)) => {
            let round = contour.contains(border.points()[0]);
            Err(if round { PasteError::ContourLargerThanFace } else { PasteError::ContourOffFace })
        }
        Some(&at) => Err(PasteError::ContourOutside { at }),
        None => match contour.crosses(&border) {
            Some(at) => Err(PasteError::ContourOutside { at }),
            None => Ok(()),
        },
    }
}

/// Whether a point is nearer to a side than the slack of each coordinate.
fn touches(p: [f64; 2], (a, b): ([f64; 2], [f64; 2]), slack: [f64; 2]) -> bool {
    let scaled = |q: [f64; 2]| [0, 1].map(|k| (q[k] - a[k]) / slack[k]);
    let (way, to) = (scaled(b), scaled(p));
    let length = way[0] * way[0] + way[1] * way[1];
    let share = if length > 0.0 { ((to[0] * way[0] + to[1] * way[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - share * way[0]).hypot(to[1] - share * way[1]) <= 1.0
}

/// Parameters of the anchor: nearest to the given point, or the middle of the contour's box.
fn anchor(source: &FaceSource<'_>, surface: &NurbsSurface, contour: &[[f64; 2]]) -> [f64; 2] {
    if let Some(point) = &source.anchor {
        let found = SurfaceLocator::new(surface, Wrap::default()).closest(point);
        return [found.u, found.v];
    }
    [0, 1].map(|k| {
        let at = || contour.iter().map(|p| p[k]);
        0.5 * (at().fold(f64::INFINITY, f64::min) + at().fold(f64::NEG_INFINITY, f64::max))
    })
}
