//! The loops of a B-spline face as polygons in its parameters: which is the outer one, which are inner.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::cells::{CellGrid, Mask};
use super::polygon::Contour;
use super::sampling::mean_lengths;
use crate::brep::parameter_loop::{LoopSampling, parameter_loops};
use crate::brep::{FaceId, LoopId};
use crate::geometry::Surface;
use crate::geometry::nurbs::NurbsSurface;
use crate::model::Model;
use crate::ops::OperationError;

/// Name of a face in messages: its origin.
#[must_use]
pub fn face_name(model: &Model, face: FaceId) -> String {
    model.origins.faces[face].to_string()
}

/// A loop of the face in its parameters.
#[derive(Debug, Clone)]
pub struct LoopShape {
    /// Its polygon.
    pub contour: Contour,
    /// Whether it closes in the parameter plane; a loop round a closed surface does not.
    pub closed: bool,
}

/// The loops of one face.
#[derive(Debug, Clone)]
pub struct Layout {
    /// In the face's order; none for a loop that is a single vertex.
    pub loops: Vec<Option<LoopShape>>,
    /// The outer loop: the one that encloses most. None where loops wind round a closed surface.
    pub outer: Option<usize>,
}

impl Layout {
    /// Whether a loop bounds a hole: not the outer one, and closed in the parameter plane.
    #[must_use]
    pub fn is_inner(&self, at: usize) -> bool {
        let closed = self.loops.get(at).and_then(Option::as_ref).is_some_and(|l| l.closed);
        closed && self.outer != Some(at)
    }

    /// For each loop the control points of a surface, over the face's parameters, that act on it. Pieces on the border
    /// of the domain do not count: there only the outermost rows act.
    #[must_use]
    pub fn acting_on_bounds(&self, surface: &NurbsSurface) -> Vec<Mask> {
        let grid = CellGrid::new(surface.knots_u(), surface.knots_v());
        let border = [surface.knots_u().domain(), surface.knots_v().domain()];
        let one = |shape: &LoopShape| {
            let Contour { points, margin } = &shape.contour;
            let sides = points.iter().copied().zip(points.iter().copied().cycle().skip(1));
            let inner = sides.filter(|(a, b)| !on_border(*a, *b, border, *margin));
            grid.control_points(&grid.met_by_sides(inner, *margin))
        };
        self.loops.iter().flatten().map(one).collect()
    }
}

/// Part of the domain within which a side lies on its border.
const ON_BORDER: f64 = 1e-7;

fn on_border(a: [f64; 2], b: [f64; 2], border: [(f64, f64); 2], margin: [f64; 2]) -> bool {
    (0..2).any(|k| {
        let slack = (ON_BORDER * (border[k].1 - border[k].0)).max(margin[k]);
        [border[k].0, border[k].1].iter().any(|x| (a[k] - x).abs() <= slack && (b[k] - x).abs() <= slack)
    })
}

/// The B-spline surface of a face, if it has one.
#[must_use]
pub fn spline_of(model: &Model, face: FaceId) -> Option<&NurbsSurface> {
    match model.brep.surface_of(face).read() {
        Some(Surface::Nurbs(surface)) => Some(surface),
        _ => None,
    }
}

/// The loops of a B-spline face that can be held as holes, in the face's order; none for other faces, and
/// for one whose loops cannot be traced in its parameters.
#[must_use]
pub fn inner_loops(model: &Model, face: FaceId) -> Vec<LoopId> {
    let Some(layout) = spline_of(model, face).and_then(|_| lay_out(model, face).ok()) else {
        return Vec::new();
    };
    let loops = model.brep.faces[face].loops.iter().enumerate();
    loops.filter(|&(at, _)| layout.is_inner(at)).map(|(_, &bound)| bound).collect()
}

/// Layouts that were asked for, each computed once.
#[derive(Debug, Default)]
pub struct Layouts {
    known: BTreeMap<FaceId, Layout>,
}

impl Layouts {
    /// The layout of a B-spline face.
    ///
    /// # Errors
    /// [`OperationError::NoParameterLoops`].
    pub fn of(&mut self, model: &Model, face: FaceId) -> Result<&Layout, OperationError> {
        Ok(match self.known.entry(face) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(free) => free.insert(lay_out(model, face)?),
        })
    }
}

/// A loop that winds by less than this part of the parameter range closes; others wind by whole periods.
const CLOSED: f64 = 0.25;
/// Chord error of a loop's polygon as a part of a mean span: a fiftieth after five bisections.
const CHORD: f64 = 1.0 / 1600.0;
/// Uncertainty of a file that states none, as a part of the face's size.
const UNCERTAINTY: f64 = 1e-6;
/// Samples in each direction to turn a distance into a distance of parameters.
const LENGTH_SAMPLES: usize = 9;

/// The loops of a B-spline face in its parameters.
///
/// # Errors
/// [`OperationError::NoParameterLoops`].
pub fn lay_out(model: &Model, face: FaceId) -> Result<Layout, OperationError> {
    let reason = || "it is no B-spline surface".to_owned();
    let fault = || OperationError::NoParameterLoops { face: face_name(model, face), reason: reason() };
    lay_out_on(model, face, spline_of(model, face).ok_or_else(fault)?)
}

/// The loops of a face in the parameters of a B-spline surface that has the same parameters as the face's own.
///
/// # Errors
/// [`OperationError::NoParameterLoops`].
pub fn lay_out_on(model: &Model, face: FaceId, surface: &NurbsSurface) -> Result<Layout, OperationError> {
    let fault = |reason: String| OperationError::NoParameterLoops { face: face_name(model, face), reason };
    let (du, dv) = surface.domain();
    let range = [du.1 - du.0, dv.1 - dv.0];
    let spans = [surface.knots_u(), surface.knots_v()].map(|k| k.distinct().0.len() - 1);
    let chord = [0, 1].map(|k| CHORD * range[k] / spans[k] as f64);
    let parameter_chord = (chord[0], chord[1]);
    let tolerance = model.context_of(face).uncertainty.map_or(UNCERTAINTY * size(surface), |t| t.0);
    let sampling = LoopSampling { parameter_chord, ..LoopSampling::of_tolerance(tolerance) };
    let found = parameter_loops(&model.brep, face, &sampling).map_err(|e| fault(e.to_string()))?;
    let lengths = mean_lengths(surface, LENGTH_SAMPLES);
    let per_length = [0, 1].map(|k| if lengths[k] > 0.0 { range[k] / lengths[k] } else { 0.0 });
    let loops: Vec<Option<LoopShape>> = found
        .into_iter()
        .map(|l| {
            let points: Vec<[f64; 2]> = l.points.iter().map(|p| [p.u, p.v]).collect();
            let closed = l.winding.0.abs() <= CLOSED * range[0] && l.winding.1.abs() <= CLOSED * range[1];
            let margin = [0, 1].map(|k| per_length[k] * l.gap + chord[k]);
            (!points.is_empty()).then_some(LoopShape { contour: Contour { points, margin }, closed })
        })
        .collect();
    let winds = loops.iter().flatten().any(|l| !l.closed);
    let areas = loops.iter().enumerate().filter_map(|(k, l)| Some((k, area(&l.as_ref()?.contour.points))));
    let largest = areas.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
    Ok(Layout { loops, outer: if winds { None } else { largest } })
}

/// Diagonal of the box round the control points.
fn size(surface: &NurbsSurface) -> f64 {
    let bounds = surface.bounding_box();
    (bounds.max - bounds.min).norm()
}

/// Area that a closed polygon encloses.
fn area(points: &[[f64; 2]]) -> f64 {
    let Some(origin) = points.first() else { return 0.0 };
    let next = points.iter().cycle().skip(1);
    let off = |p: &[f64; 2]| [p[0] - origin[0], p[1] - origin[1]];
    let sum: f64 =
        points.iter().zip(next).map(|(a, b)| (off(a), off(b))).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    (0.5 * sum).abs()
}
