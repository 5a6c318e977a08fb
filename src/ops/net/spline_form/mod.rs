//! A face of any kind as a B-spline over its own parameters, and its loops there: what an operation on nets starts
//! from.
//!
//! Planes become bilinear, quadrics and swept surfaces rational; all points stay. Knows no operation.

mod exact;
mod hermite;
mod seams;

pub use exact::carry_tolerance;
pub use hermite::{Cubic, Evaluate, followed};
pub use seams::SeamUse;

use std::collections::BTreeMap;

use self::exact::Exact;
use self::seams::seams;
use super::acting::{MEETS, acting_on, closed_directions, winding};
use super::layout::{face_name, lay_out_on};
use super::{Contour, Mask};
use crate::brep::parameter_loop::{LoopSampling, parameter_loops};
use crate::brep::{CoedgeId, FaceId, LoopId};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::geometry::{Carried, Curve2d, Surface};
use crate::math::Frame;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;

/// A face as a B-spline.
#[derive(Debug, Clone)]
pub struct SplineForm {
    /// Name of the face.
    pub name: String,
    /// Its surface.
    pub surface: NurbsSurface,
    /// Its loops.
    pub bounds: Vec<Bound>,
    /// The directions in which the face goes all round: 0 for `u`.
    pub round: [bool; 2],
    /// Uses of its seams.
    pub seams: Vec<SeamUse>,
    /// Curves in parameters that another surface under the same face needs.
    pub pcurves: BTreeMap<CoedgeId, Curve2d>,
    /// Greatest distance in space by which these miss the old ones.
    pub pcurve_error: f64,
    /// Kind of surface that was made a B-spline.
    pub converted: Option<&'static str>,
}

/// A loop of the face in the parameters of its B-spline.
#[derive(Debug, Clone)]
pub struct Bound {
    /// Name of the loop.
    pub name: String,
    /// Its polygon.
    pub contour: Contour,
    /// Whether it encloses the face.
    pub outer: bool,
    /// What the last point lacks to the first: whole periods.
    pub winding: [f64; 2],
}

impl SplineForm {
    /// The B-spline form of a face; `unfit` makes the error for a kind of surface that has none.
    ///
    /// # Errors
    /// [`OperationError::NoParameterLoops`], and what `unfit` makes.
    pub fn of(
        model: &Model,
        face: FaceId,
        unfit: impl Fn(String, &str) -> OperationError,
    ) -> Result<Self, OperationError> {
        let name = face_name(model, face);
        let fault = |reason: String| OperationError::NoParameterLoops { face: name.clone(), reason };
        let read = match model.brep.surface_of(face) {
            Carried::Read(surface) => surface,
            Carried::Unread { entity, .. } => return Err(unfit(name, entity)),
        };
        let tolerance = model.context_of(face).uncertainty.map_or(f64::INFINITY, |t| t.0);
        let traced = parameter_loops(&model.brep, face, &LoopSampling::of_tolerance(tolerance))
            .map_err(|e| fault(e.to_string()))?;
        let (surface, exact) = match read {
            Surface::Nurbs(surface) => (surface.clone(), None),
            Surface::Plane(frame) => (plane(model, face, frame)?, None),
            other => {
                let exact = Exact::of(other, &traced).map_err(|_| unfit(name.clone(), other.kind()))?;
                (exact.surface.clone(), Some(exact))
            }
        };
        let (pcurves, pcurve_error) =
            exact.as_ref().map_or_else(Default::default, |exact| exact.carried(model, face));
        let layout = lay_out_on(model, face, &surface)?;
        let periods = closed_directions(&surface);
        let ids: &[LoopId] = &model.brep.faces[face].loops;
        let shapes = layout.loops.iter().zip(ids).enumerate();
        let bounds: Vec<Bound> = shapes
            .filter_map(|(k, (shape, id))| {
                let mut contour = shape.as_ref()?.contour.clone();
                if let Some(exact) = &exact {
                    contour.points.iter_mut().for_each(|p| *p = exact.image(*p));
                    contour.margin = contour.margin.map(|m| STRETCH * m);
                }
                let winding = winding(&contour, periods);
                let (u, v) = surface.domain();
                let shift = home(&contour.points, periods, [u, v]);
                contour.points.iter_mut().for_each(|p| *p = [p[0] + shift[0], p[1] + shift[1]]);
                let name = model.origins.loops[*id].to_string();
                Some(Bound { name, contour, outer: layout.outer == Some(k), winding })
            })
            .collect();
        let image = |at: [f64; 2]| exact.as_ref().map_or(at, |exact| exact.image(at));
        let seams = seams(model, &traced, &surface, periods, &image);
        let round = [0, 1].map(|k| {
            let goes = traced.iter().all(|l| l.points.is_empty())
                || seams.iter().any(|s| s.closed == k)
                || bounds.iter().any(|l| l.winding[k] != 0.0);
            periods[k].is_some() && goes
        });
        let converted = exact.is_some().then(|| read.kind());
        Ok(Self { name, surface, bounds, round, seams, pcurves, pcurve_error, converted })
    }

    /// What becomes of the face: its surface, its seams where they moved, its curves in parameters where these count
    /// otherwise now.
    #[must_use]
    pub fn changes(
        &self,
        model: &Model,
        face: FaceId,
        surface: NurbsSurface,
        seam_moved: [bool; 2],
    ) -> ChangeSet {
        let mut changes = ChangeSet { pcurves: self.pcurves.clone(), ..ChangeSet::default() };
        for seam in self.seams.iter().filter(|s| seam_moved[s.closed]) {
            let coedge = &model.brep.coedges[seam.coedge];
            let Some((curve, pcurve)) = seam.curves(&surface) else { continue };
            changes.curves.insert(coedge.edge, curve);
            if coedge.pcurve.is_some() {
                changes.pcurves.insert(seam.coedge, pcurve);
            }
        }
        // Where two seams cross, their vertex goes with them.
        if seam_moved == [true; 2] {
            let ((u, _), (v, _)) = surface.domain();
            let (old, new) = (self.surface.point(u, v), surface.point(u, v));
            let slack = MEETS * surface.bounding_box().diagonal();
            for seam in &self.seams {
                let edge = &model.brep.edges[model.brep.coedges[seam.coedge].edge];
                for vertex in [edge.start, edge.end] {
                    let there = (model.brep.vertices[vertex].point - old).norm() <= slack;
                    if there && new != old {
                        changes.points.insert(vertex, new);
                    }
                }
            }
        }
        changes.surfaces.insert(face, Surface::Nurbs(surface));
        changes
    }

    /// For each loop the control points that act on it. Pieces on the border of the domain do not count: there only
    /// the outermost rows act, which stay anyway.
    #[must_use]
    pub fn acting_on_loops(&self, refined: &NurbsSurface) -> Vec<(String, Mask)> {
        let periods = closed_directions(&self.surface);
        let one = |bound: &Bound| (bound.name.clone(), acting_on(&bound.contour, refined, periods));
        self.bounds.iter().map(one).collect()
    }
}

/// By how much a parameter of an exact surface is stretched at most: 1.11 for a quarter turn.
const STRETCH: f64 = 1.2;

/// Whole periods that bring the middle of a polygon into the domain.
fn home(points: &[[f64; 2]], periods: [Option<f64>; 2], domain: [(f64, f64); 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let (Some(period), false) = (periods[k], points.is_empty()) else { return 0.0 };
        let at = || points.iter().map(|p| p[k]);
        let (low, high) = (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max));
        let centre = 0.5 * (domain[k].0 + domain[k].1);
        // Half a period off is a tie, which stays.
        let away = (centre - 0.5 * (low + high)) / period;
        if away.abs() > 0.5 + MEETS { period * away.round() } else { 0.0 }
    })
}

/// Part of a planar face's size by which its surface reaches beyond the bounds.
const MARGIN: f64 = 0.02;

/// A plane as a bilinear surface over its own parameters, a little larger than the face: curves in parameters stay as
/// they are.
fn plane(model: &Model, face: FaceId, frame: &Frame) -> Result<NurbsSurface, OperationError> {
    let fault = |reason: String| OperationError::NoParameterLoops { face: face_name(model, face), reason };
    let sampling = LoopSampling::of_tolerance(f64::INFINITY);
    let loops = parameter_loops(&model.brep, face, &sampling).map_err(|e| fault(e.to_string()))?;
    let points: Vec<[f64; 2]> = loops.iter().flat_map(|l| &l.points).map(|p| [p.u, p.v]).collect();
    let range = [0, 1].map(|k| {
        let at = || points.iter().map(|p| p[k]);
        (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max))
    });
    let beyond = MARGIN * (range[0].1 - range[0].0).max(range[1].1 - range[1].0);
    let knots = range.map(|(low, high)| KnotVector::clamped_uniform(1, 1, low - beyond, high + beyond));
    let [Ok(u), Ok(v)] = knots else { return Err(fault("its loops enclose no area".to_owned())) };
    let corner = |x: f64, y: f64| {
        let p = frame.origin + frame.x * x + frame.y * y;
        [p.x, p.y, p.z, 1.0]
    };
    let ends = |k: &KnotVector| [k.domain().0, k.domain().1];
    let net = ends(&u).iter().flat_map(|&x| ends(&v).map(|y| corner(x, y))).collect();
    NurbsSurface::new(u, v, net).map_err(|e| fault(e.to_string()))
}
