//! The loops of a face as polygons in the parameter plane of its surface, tied to their coedges.
//!
//! From pcurves where they agree with their edges, else by projecting points of the edges onto the surface,
//! each seeded by the one before. On closed surfaces the walk goes on across the seam, so that a loop is
//! continuous in the covering plane: parameters may leave the domain by whole periods, and a loop that runs
//! once round ends a period from its start.
//!
//! Repairs nothing: the greatest distance of an edge from the surface is reported, not removed.

mod pole;
mod walk;

use super::edge_samples::{EdgePoint, EdgeSampling, sample_edge};
use super::{Brep, CoedgeId, EdgeId, FaceId, LoopId};
use crate::geometry::Surface;
use crate::geometry::parameters::unwrapped;
use crate::math::{Point2, Point3};
use std::borrow::Cow;
use walk::Walk;

/// How loops are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSampling {
    /// Sampling of the edges in space.
    pub edge: EdgeSampling,
    /// Greatest distance of the true loop from the polygon's chords in the parameter plane, along `u` and
    /// along `v`; infinite for no bound.
    pub parameter_chord: (f64, f64),
    /// Distance within which a pcurve agrees with its edge, and below which a parameter line counts as
    /// shrunk to a pole; in file units: the file's uncertainty.
    pub tolerance: f64,
}

impl LoopSampling {
    /// Eight chords a span and no bound on chords, for a file of the given uncertainty.
    #[must_use]
    pub fn of_tolerance(tolerance: f64) -> Self {
        Self { edge: EdgeSampling::default(), parameter_chord: (f64::INFINITY, f64::INFINITY), tolerance }
    }
}

/// A vertex of a loop's polygon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopPoint {
    /// First parameter on the surface.
    pub u: f64,
    /// Second parameter on the surface.
    pub v: f64,
    /// The coedge that leaves from here, or that passes here.
    pub coedge: CoedgeId,
    /// Parameter on the coedge's curve in space.
    pub t: f64,
    /// Point of the edge's curve.
    pub point: Point3<f64>,
    /// Its distance from the surface at the parameters, in file units.
    pub gap: f64,
}

/// A loop in the parameter plane.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterLoop {
    /// The loop.
    pub of: LoopId,
    /// Vertices of the closed polygon, the first not repeated at the end. They run so that the face is to
    /// the left as seen against the face's normal: a face of the surface's own sense has its outer loop
    /// counter-clockwise. At a pole the vertex stands twice, with the parameters of the way in and of the way
    /// out. Where an edge turns quickly beside a pole, or passes through it, there are points between the given
    /// samples. Empty for a vertex loop.
    pub points: Vec<LoopPoint>,
    /// End minus start in the covering plane: whole periods, or zero.
    pub winding: (f64, f64),
    /// Greatest distance of a sampled point of an edge from the surface, in file units.
    pub gap: f64,
}

/// Why a face has no loops in the parameter plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterLoopError {
    /// The surface is carried unread.
    #[error("surface {entity} of the face is not read")]
    UnreadSurface {
        /// Entity name in the file.
        entity: String,
    },
    /// The curve of an edge is carried unread, or its ends have no parameters.
    #[error("the curve of an edge is not read")]
    UnreadCurve {
        /// The edge.
        edge: EdgeId,
    },
    /// A point has no finite parameters.
    #[error("an edge has no finite parameters on the surface")]
    NotFinite {
        /// The coedge.
        coedge: CoedgeId,
    },
}

/// The loops of a face in file order.
///
/// # Errors
/// See [`ParameterLoopError`].
pub fn parameter_loops(
    brep: &Brep,
    face: FaceId,
    sampling: &LoopSampling,
) -> Result<Vec<ParameterLoop>, ParameterLoopError> {
    parameter_loops_with(brep, face, sampling, &|edge| {
        sample_edge(brep, edge, &sampling.edge).map(Cow::Owned)
    })
}

/// Points of an edge from its start to its end, where they are known.
pub type Samples<'f, 's> = dyn Fn(EdgeId) -> Option<Cow<'s, [EdgePoint]>> + 'f;

/// As [`parameter_loops`], with the points of each edge, from its start to its end, given by the caller.
///
/// # Errors
/// See [`ParameterLoopError`].
pub fn parameter_loops_with<'s>(
    brep: &Brep,
    face: FaceId,
    sampling: &LoopSampling,
    samples: &Samples<'_, 's>,
) -> Result<Vec<ParameterLoop>, ParameterLoopError> {
    let surface = match brep.surface_of(face) {
        crate::geometry::Carried::Read(surface) => surface,
        crate::geometry::Carried::Unread { entity, .. } => {
            return Err(ParameterLoopError::UnreadSurface { entity: entity.clone() });
        }
    };
    let walk = Walk::new(surface, sampling, brep.faces[face].same_sense);
    let mut loops = Vec::new();
    for &id in &brep.faces[face].loops {
        loops.push(walk.around(brep, id, samples)?);
    }
    gather(&mut loops, brep, surface);
    Ok(loops)
}

impl ParameterLoop {
    /// Area enclosed in the parameter plane, positive when the polygon runs counter-clockwise; `None` for a
    /// loop without an inside: one that runs round the surface, or has no points.
    #[must_use]
    pub fn signed_area(&self) -> Option<f64> {
        if self.points.is_empty() || self.winding != (0.0, 0.0) {
            return None;
        }
        let first = &self.points[0];
        let cross = |a: &LoopPoint, b: &LoopPoint| {
            (a.u - first.u) * (b.v - first.v) - (b.u - first.u) * (a.v - first.v)
        };
        Some(0.5 * self.points.windows(2).map(|w| cross(&w[0], &w[1])).sum::<f64>())
    }
}

/// Moves the loops of a face by whole periods: the outer one to the domain, the others to the outer one.
fn gather(loops: &mut [ParameterLoop], brep: &Brep, surface: &Surface) {
    let periods = surface.periods();
    let ((u0, u1), (v0, v1)) = surface.domain();
    let Some(outer) = (0..loops.len())
        .find(|&i| brep.loops[loops[i].of].outer && !loops[i].points.is_empty())
        .or_else(|| (0..loops.len()).find(|&i| !loops[i].points.is_empty()))
    else {
        return;
    };
    let into = |middle: f64, start: f64, end: f64, period: Option<f64>| {
        period.map_or(0.0, |p| {
            // The middle of a loop that fills the period lies in the middle of the domain, but for rounding.
            unwrapped(middle, 0.5 * (start + end), p) - middle
        })
    };
    let middle = middle_of(&loops[outer]);
    shift(&mut loops[outer], into(middle.x, u0, u1, periods.0), into(middle.y, v0, v1, periods.1));
    let home = middle_of(&loops[outer]);
    for (i, other) in loops.iter_mut().enumerate() {
        if i != outer && !other.points.is_empty() {
            let middle = middle_of(other);
            let to =
                |x: f64, home: f64, period: Option<f64>| period.map_or(0.0, |p| unwrapped(x, home, p) - x);
            shift(other, to(middle.x, home.x, periods.0), to(middle.y, home.y, periods.1));
        }
    }
}

fn middle_of(of: &ParameterLoop) -> Point2<f64> {
    let ends = |value: &dyn Fn(&LoopPoint) -> f64| {
        let (low, high) = of
            .points
            .iter()
            .map(value)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        0.5 * (low + high)
    };
    Point2::new(ends(&|p| p.u), ends(&|p| p.v))
}

fn shift(of: &mut ParameterLoop, du: f64, dv: f64) {
    for point in &mut of.points {
        point.u += du;
        point.v += dv;
    }
}
