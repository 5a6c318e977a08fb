//! The target face made ready: its surface as NURBS over the same parameters, and its loops there.

use super::super::error::PasteError;
use super::Place;
use crate::brep::parameter_loop::{LoopSampling, parameter_loops};
use crate::brep::{FaceId, LoopId};
use crate::geometry::nurbs::{KnotVector, NurbsSurface, SurfaceLocator, Wrap};
use crate::geometry::{Carried, Surface};
use crate::math::Frame;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::net::layout::{face_name, lay_out_on};
use crate::ops::net::{CellGrid, Contour, Mask, Polygon};

/// Whether the surface's own normal is the outward one of its face.
pub(super) fn natural_sense(model: &Model, face: FaceId) -> bool {
    let face = &model.brep.faces[face];
    face.same_sense == model.brep.shells[face.shell].forward
}

/// A face that can take a feature.
#[derive(Debug, Clone)]
pub(super) struct Target {
    name: String,
    /// Its surface, over the parameters of the file.
    pub surface: NurbsSurface,
    /// Its loops with their names; the outer one is marked.
    loops: Vec<(String, Contour, bool)>,
}

impl Target {
    pub fn of(model: &Model, face: FaceId) -> Result<Self, OperationError> {
        let name = face_name(model, face);
        let surface = match model.brep.surface_of(face) {
            Carried::Read(Surface::Nurbs(surface)) => surface.clone(),
            Carried::Read(Surface::Plane(frame)) => plane(model, face, frame)?,
            Carried::Read(other) => return Err(unfit(name, other.kind()).into()),
            Carried::Unread { entity, .. } => return Err(unfit(name, entity).into()),
        };
        let layout = lay_out_on(model, face, &surface)?;
        let ids: &[LoopId] = &model.brep.faces[face].loops;
        let loops = layout.loops.iter().zip(ids).enumerate().filter_map(|(k, (shape, id))| {
            let contour = shape.as_ref()?.contour.clone();
            Some((model.origins.loops[*id].to_string(), contour, layout.outer == Some(k)))
        });
        Ok(Self { loops: loops.collect(), name, surface })
    }

    /// Parameters of a place; it must lie within the face's loops.
    pub fn locate(&self, surface: &NurbsSurface, place: &Place) -> Result<[f64; 2], PasteError> {
        let off = |reason: String| PasteError::PlaceOffFace {
            face: self.name.clone(),
            place: place.at.coords.into(),
            reason,
        };
        let found = SurfaceLocator::new(surface, Wrap::default()).closest(&place.at);
        let size = surface.bounding_box().diagonal();
        if found.distance > FAR * size {
            return Err(off(format!("the surface is {:.6} away", found.distance)));
        }
        let at = [found.u, found.v];
        let (u, v) = surface.domain();
        for (name, contour, outer) in &self.loops {
            let Ok(polygon) = Polygon::new(&contour.points, contour.margin, [u, v]) else { continue };
            if polygon.contains(at) != *outer {
                let side = if *outer { "outside" } else { "inside" };
                return Err(off(format!("it is {side} loop {name}")));
            }
        }
        Ok(at)
    }

    /// For each loop the control points that act on it. Pieces on the border of the domain do not count: there only
    /// the outermost rows act, which stay anyway.
    pub fn acting_on_loops(&self, refined: &NurbsSurface) -> Vec<(String, Mask)> {
        let grid = CellGrid::new(refined.knots_u(), refined.knots_v());
        let (u, v) = refined.domain();
        let border = [u, v];
        let one = |(name, contour, _): &(String, Contour, bool)| {
            let next = contour.points.iter().cycle().skip(1);
            let sides = contour.points.iter().copied().zip(next.copied());
            let inner = sides.filter(|(a, b)| !on_border(*a, *b, border, contour.margin));
            let cells = grid.met_by_sides(inner, contour.margin);
            (name.clone(), grid.control_points(&cells))
        };
        self.loops.iter().map(one).collect()
    }
}

/// A place farther from the surface than this part of its size is a mistake, not a point beside it.
const FAR: f64 = 0.05;
/// Part of the domain within which a side lies on its border.
const ON_BORDER: f64 = 1e-7;

fn on_border(a: [f64; 2], b: [f64; 2], border: [(f64, f64); 2], margin: [f64; 2]) -> bool {
    (0..2).any(|k| {
        let slack = (ON_BORDER * (border[k].1 - border[k].0)).max(margin[k]);
        [border[k].0, border[k].1].iter().any(|x| (a[k] - x).abs() <= slack && (b[k] - x).abs() <= slack)
    })
}

fn unfit(face: String, kind: &str) -> PasteError {
    let expected = "a feature goes onto a B-spline surface or a plane";
    PasteError::SurfaceKind { side: "target", face, kind: kind.to_owned(), expected }
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
