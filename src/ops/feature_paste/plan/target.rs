//! The target face made ready: its surface as NURBS over the same parameters, and its loops there.

use std::collections::BTreeMap;

use super::super::error::PasteError;
use super::super::settings::{Method, Settings};
use super::Place;
use super::exact::{Exact, SeamUse};
use crate::brep::parameter_loop::{LoopPoint, LoopSampling, ParameterLoop, parameter_loops};
use crate::brep::{CoedgeId, EdgeId, FaceId, LoopId};
use crate::geometry::nurbs::{KnotVector, NurbsSurface, SurfaceLocator, Wrap};
use crate::geometry::{Carried, Curve2d, Surface};
use crate::math::Frame;
use crate::model::{ChangeSet, Model};
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
    /// Its loops.
    loops: Vec<Bound>,
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

/// A loop of the target in the parameters of its B-spline.
#[derive(Debug, Clone)]
struct Bound {
    name: String,
    contour: Contour,
    outer: bool,
    /// What the last point lacks to the first: whole periods.
    winding: [f64; 2],
}

impl Target {
    pub fn of(model: &Model, face: FaceId) -> Result<Self, OperationError> {
        let name = face_name(model, face);
        let fault = |reason: String| OperationError::NoParameterLoops { face: name.clone(), reason };
        let read = match model.brep.surface_of(face) {
            Carried::Read(surface) => surface,
            Carried::Unread { entity, .. } => return Err(unfit(name, entity).into()),
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
        let loops: Vec<Bound> = shapes
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
                || loops.iter().any(|l| l.winding[k] != 0.0);
            periods[k].is_some() && goes
        });
        let converted = exact.is_some().then(|| read.kind());
        Ok(Self { name, surface, loops, round, seams, pcurves, pcurve_error, converted })
    }

    /// What becomes of the face: its surface, its seams where they moved, its curves in parameters where these count
    /// otherwise now.
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

    /// Whether two regions, each in the covering plane, share a point of the surface.
    pub fn overlap(&self, a: &[(f64, f64); 2], b: &[(f64, f64); 2]) -> bool {
        let (u, v) = self.surface.domain();
        (0..2).all(|k| {
            let domain = [u, v][k];
            let ways = if self.round[k] { vec![-1.0, 0.0, 1.0] } else { vec![0.0] };
            let period = domain.1 - domain.0;
            ways.into_iter().any(|way| a[k].0 < b[k].1 + way * period && b[k].0 + way * period < a[k].1)
        })
    }

    /// Engines that smooth the target want one that is smooth inside: an exact quadric's quarters meet at knots of full
    /// multiplicity.
    ///
    /// # Errors
    /// [`PasteError::MethodCannot`].
    pub fn refuse_method(&self, settings: &Settings) -> Result<(), PasteError> {
        let method = settings.chosen_method()?;
        if self.converted.is_some() && matches!(method, Method::Poisson | Method::Biharmonic) {
            let reason = "smooths the target, whose quarters meet in knots of full multiplicity; expected \
                          `displacement` or `fit`";
            return Err(PasteError::MethodCannot { method: method.as_str(), reason });
        }
        Ok(())
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
        // A seam is a bound on paper only.
        let inside = [0, 1].map(|k| {
            let (low, high) = [u, v][k];
            let inset = if self.round[k] { 2.0 * ON_BORDER * (high - low) } else { 0.0 };
            at[k].clamp(low + inset, high - inset)
        });
        for Bound { name, contour, outer, .. } in &self.loops {
            let Ok(polygon) = Polygon::new(&contour.points, contour.margin, [u, v]) else { continue };
            if polygon.contains(inside) != *outer {
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
        let periods = closed_directions(&self.surface);
        let one = |bound: &Bound| {
            let contour = &bound.contour;
            let mut points = contour.points.clone();
            points.extend(points.first().map(|p| [p[0] + bound.winding[0], p[1] + bound.winding[1]]));
            let sides = points.windows(2).map(|w| (w[0], w[1]));
            let inner = sides
                .flat_map(|side| copies(side, periods, border))
                .filter(|(a, b)| !on_border(*a, *b, border, contour.margin));
            let cells = grid.met_by_sides(inner, contour.margin);
            (bound.name.clone(), grid.control_points(&cells))
        };
        self.loops.iter().map(one).collect()
    }
}

/// By how much a parameter of an exact surface is stretched at most: 1.11 for a quarter turn.
const STRETCH: f64 = 1.2;
/// Distance of opposite borders that meet, as a part of the surface's size.
const MEETS: f64 = 1e-7;

/// Periods of a surface that closes on itself.
fn closed_directions(surface: &NurbsSurface) -> [Option<f64>; 2] {
    let tolerance = MEETS * surface.bounding_box().diagonal();
    let ((u0, u1), (v0, v1)) = surface.domain();
    [surface.is_closed_u(tolerance).then_some(u1 - u0), surface.is_closed_v(tolerance).then_some(v1 - v0)]
}

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

fn winding(contour: &Contour, periods: [Option<f64>; 2]) -> [f64; 2] {
    let (Some(first), Some(last)) = (contour.points.first(), contour.points.last()) else { return [0.0; 2] };
    [0, 1].map(|k| periods[k].map_or(0.0, |p| p * ((last[k] - first[k]) / p).round()))
}

type Side = ([f64; 2], [f64; 2]);

/// The parts of a side, moved by whole periods, that lie within the domain.
fn copies(side: Side, periods: [Option<f64>; 2], domain: [(f64, f64); 2]) -> Vec<Side> {
    let mut found = vec![side];
    for (k, period) in periods.into_iter().enumerate() {
        let Some(period) = period else { continue };
        let moved = |&(a, b): &Side, way: f64| {
            let (mut a, mut b) = (a, b);
            a[k] += way;
            b[k] += way;
            clipped((a, b), k, domain[k])
        };
        found =
            found.iter().flat_map(|s| [-period, 0.0, period].map(|way| moved(s, way))).flatten().collect();
    }
    found
}

/// The part of a side between two lines of one coordinate.
fn clipped((a, b): Side, k: usize, (low, high): (f64, f64)) -> Option<Side> {
    let slack = ON_BORDER * (high - low);
    let (low, high) = (low - slack, high + slack);
    if a[k].max(b[k]) < low || a[k].min(b[k]) > high {
        return None;
    }
    let way = b[k] - a[k];
    let cut = |at: [f64; 2]| {
        let to = at[k].clamp(low, high);
        if to == at[k] {
            return at;
        }
        let share = (to - a[k]) / way;
        let mut on = [0, 1].map(|m| a[m] + share * (b[m] - a[m]));
        on[k] = to;
        on
    };
    Some((cut(a), cut(b)))
}

/// Uses of edges that lie on a border where the surface meets itself.
fn seams(
    model: &Model,
    traced: &[ParameterLoop],
    surface: &NurbsSurface,
    periods: [Option<f64>; 2],
    image: &dyn Fn([f64; 2]) -> [f64; 2],
) -> Vec<SeamUse> {
    let mut uses: BTreeMap<EdgeId, usize> = BTreeMap::new();
    let mut found = Vec::new();
    let edge_of = |p: &LoopPoint| model.brep.coedges[p.coedge].edge;
    let (u, v) = surface.domain();
    for l in traced {
        let count = l.points.len();
        let runs = l.points.chunk_by(|a, b| a.coedge == b.coedge);
        let mut at = 0;
        let polygon: Vec<[f64; 2]> = l.points.iter().map(|p| image([p.u, p.v])).collect();
        let shift = home(&polygon, periods, [u, v]);
        for run in runs {
            at += run.len();
            *uses.entry(edge_of(&run[0])).or_insert(0) += 1;
            let mut along: Vec<[f64; 2]> = run.iter().map(|p| image([p.u, p.v])).collect();
            // A run ends where the next one begins, unless it has its own end at a pole.
            let (next, turn) = if at < count { (l.points[at], (0.0, 0.0)) } else { (l.points[0], l.winding) };
            if next.point != run[run.len() - 1].point {
                along.push(image([next.u + turn.0, next.v + turn.1]));
            }
            along.iter_mut().for_each(|p| *p = [p[0] + shift[0], p[1] + shift[1]]);
            let grows = |f: &dyn Fn(usize) -> f64, n: usize| n > 1 && f(n - 1) > f(0);
            for (k, (low, high)) in [u, v].into_iter().enumerate().filter(|(k, _)| periods[*k].is_some()) {
                let slack = ON_BORDER * (high - low);
                let on = |x: f64| along.iter().all(|p| (p[k] - x).abs() <= slack);
                if run.len() < 2 || !(on(low) || on(high)) {
                    continue;
                }
                let other = |i: usize| along[i][1 - k];
                let t_grows = grows(&|i| run[i].t, run.len());
                let forward = t_grows == grows(&other, run.len());
                let range = (0..along.len())
                    .map(other)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                found.push(SeamUse {
                    coedge: run[0].coedge,
                    closed: k,
                    at_end: on(high),
                    along: range,
                    forward,
                });
            }
        }
    }
    found.retain(|s| uses.get(&model.brep.coedges[s.coedge].edge) == Some(&2));
    found
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
    let expected = "a feature goes onto a B-spline, a plane, a cylinder, a cone, a sphere, a torus, or a surface of extrusion or revolution";
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
