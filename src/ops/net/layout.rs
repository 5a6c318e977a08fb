//! The loops of a B-spline face as polygons in its parameters: which is the outer one, which are inner.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::polygon::Contour;
use super::sampling::mean_lengths;
use crate::brep::parameter_loop::{LoopSampling, ParameterLoop, parameter_loops};
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
    fn new(loops: Vec<Option<LoopShape>>) -> Self {
        let winds = loops.iter().flatten().any(|l| !l.closed);
        let areas =
            loops.iter().enumerate().filter_map(|(k, l)| Some((k, area(&l.as_ref()?.contour.points))));
        let largest = areas.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        Self { loops, outer: if winds { None } else { largest } }
    }

    /// Whether a loop bounds a hole: not the outer one, and closed in the parameter plane.
    #[must_use]
    pub fn is_inner(&self, at: usize) -> bool {
        let closed = self.loops.get(at).and_then(Option::as_ref).is_some_and(|l| l.closed);
        closed && self.outer != Some(at)
    }
}

/// The B-spline surface of a face, if it has one.
#[must_use]
pub fn spline_of(model: &Model, face: FaceId) -> Option<&NurbsSurface> {
    match model.brep.surface_of(face).read() {
        Some(Surface::Nurbs(surface)) => Some(surface),
        _ => None,
    }
}

/// The loops of a face that bound holes, in the face's order; none for a face whose loops cannot be traced in its
/// parameters.
#[must_use]
pub fn inner_loops(model: &Model, face: FaceId) -> Vec<LoopId> {
    let loops = &model.brep.faces[face].loops;
    if loops.len() < 2 {
        return Vec::new();
    }
    let Ok(layout) = outline(model, face) else { return Vec::new() };
    loops.iter().enumerate().filter(|&(at, _)| layout.is_inner(at)).map(|(_, &bound)| bound).collect()
}

/// Layouts that were asked for, each computed once.
#[derive(Debug, Default)]
pub struct Layouts {
    known: BTreeMap<FaceId, Layout>,
}

impl Layouts {
    /// The layout of a face of any kind, see [`outline`].
    ///
    /// # Errors
    /// [`OperationError::NoParameterLoops`].
    pub fn of(&mut self, model: &Model, face: FaceId) -> Result<&Layout, OperationError> {
        Ok(match self.known.entry(face) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(free) => free.insert(outline(model, face)?),
        })
    }
}

/// A loop that winds by less than this part of the parameter range closes; others wind by whole periods.
const CLOSED: f64 = 0.25;
/// Chord error of a loop's polygon as a part of a mean span: a fiftieth after five bisections.
const CHORD: f64 = 1.0 / 160_000.0;
/// Uncertainty of a file that states none, as a part of the face's size.
const UNCERTAINTY: f64 = 1e-6;
/// Samples in each direction to turn a distance into a distance of parameters.
const LENGTH_SAMPLES: usize = 9;

/// The loops of a face of any kind in its parameters: finely on a B-spline, else with the samples of its edges alone,
/// which tell inner loops from outer ones and how far they reach.
///
/// # Errors
/// [`OperationError::NoParameterLoops`].
pub fn outline(model: &Model, face: FaceId) -> Result<Layout, OperationError> {
    if let Some(surface) = spline_of(model, face) {
        return lay_out_on(model, face, surface);
    }
    let sampling = LoopSampling::of_tolerance(model.context_of(face).uncertainty.map_or(0.0, |t| t.0));
    let found = traced(model, face, &sampling)?;
    let loops = found.iter().map(|l| shape(l, [0.0; 2], l.winding == (0.0, 0.0))).collect();
    Ok(Layout::new(loops))
}

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
    let (du, dv) = surface.domain();
    let range = [du.1 - du.0, dv.1 - dv.0];
    let spans = [surface.knots_u(), surface.knots_v()].map(|k| k.distinct().0.len() - 1);
    let chord = [0, 1].map(|k| CHORD * range[k] / spans[k] as f64);
    let parameter_chord = (chord[0], chord[1]);
    let tolerance = model.context_of(face).uncertainty.map_or(UNCERTAINTY * size(surface), |t| t.0);
    let sampling = LoopSampling { parameter_chord, ..LoopSampling::of_tolerance(tolerance) };
    let found = traced(model, face, &sampling)?;
    let lengths = mean_lengths(surface, LENGTH_SAMPLES);
    let per_length = [0, 1].map(|k| if lengths[k] > 0.0 { range[k] / lengths[k] } else { 0.0 });
    let loops = found.iter().map(|l| {
        let closed = l.winding.0.abs() <= CLOSED * range[0] && l.winding.1.abs() <= CLOSED * range[1];
        shape(l, [0, 1].map(|k| per_length[k] * l.gap + chord[k]), closed)
    });
    Ok(Layout::new(loops.collect()))
}

fn traced(
    model: &Model,
    face: FaceId,
    sampling: &LoopSampling,
) -> Result<Vec<ParameterLoop>, OperationError> {
    let fault = |reason: String| OperationError::NoParameterLoops { face: face_name(model, face), reason };
    parameter_loops(&model.brep, face, sampling).map_err(|e| fault(e.to_string()))
}

/// A loop as a contour; none for a loop that is a single vertex.
fn shape(found: &ParameterLoop, margin: [f64; 2], closed: bool) -> Option<LoopShape> {
    let points: Vec<[f64; 2]> = found.points.iter().map(|p| [p.u, p.v]).collect();
    (!points.is_empty()).then_some(LoopShape { contour: Contour { points, margin }, closed })
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
