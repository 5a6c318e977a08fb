//! Loops of a face as polygons in the parameter plane, over the shared points of the edges.

use super::TessellateError;
use super::edges::Sample;
use super::region::Corner;
use crate::brep::{Brep, EdgeId, FaceId, LoopId};
use crate::geometry::Surface;
use std::collections::BTreeMap;

/// Samples of an edge with their vertices in the mesh, from the edge's start to its end.
pub(super) type SharedEdge = Vec<(Sample, u32)>;

/// Share of a period by which a loop may fail to close in the parameter plane and still count as closed.
const CLOSING: f64 = 1e-3;

/// Loops of a face in one sheet of the parameter plane.
pub(super) fn loops(
    brep: &Brep,
    face: FaceId,
    surface: &Surface,
    edges: &BTreeMap<EdgeId, SharedEdge>,
) -> Result<Vec<Vec<Corner>>, TessellateError> {
    let mut loops = Vec::new();
    for &bound in &brep.faces[face].loops {
        let corners = corners(brep, bound, surface, edges);
        if !corners.is_empty() {
            loops.push(close(corners, surface).ok_or(TessellateError::WindingLoop { face })?);
        }
    }
    gather(&mut loops, surface);
    Ok(loops)
}

/// Points of a loop in order, each parameter near the one before; the last is the first again, perhaps some
/// periods further.
fn corners(brep: &Brep, bound: LoopId, surface: &Surface, edges: &BTreeMap<EdgeId, SharedEdge>) -> Vec<Corner> {
    let mut points = Vec::new();
    for &coedge in &brep.loops[bound].coedges {
        let coedge = &brep.coedges[coedge];
        let Some(shared) = edges.get(&coedge.edge) else { continue };
        let kept = points.len();
        if coedge.forward {
            points.extend(shared.iter().map(|((_, point), vertex)| (*point, *vertex)));
        } else {
            points.extend(shared.iter().rev().map(|((_, point), vertex)| (*point, *vertex)));
        }
        // The end of each edge is the start of the next.
        if points.len() > kept + 1 || kept > 0 {
            points.pop();
        }
    }
    points.extend(points.first().copied());
    let mut seed = None;
    let mut corners = Vec::with_capacity(points.len());
    for (point, vertex) in points {
        let near = surface.parameters_of(&point, seed);
        let uv = seed.map_or(near, |seed| near_seed(near, seed, surface));
        seed = Some(uv);
        corners.push(Corner { uv: [uv.0, uv.1], vertex, point });
    }
    corners
}

/// Parameters moved by whole periods to those closest to a seed.
fn near_seed(at: (f64, f64), seed: (f64, f64), surface: &Surface) -> (f64, f64) {
    let moved = |at: f64, seed: f64, period: Option<f64>| {
        period.map_or(at, |period| at + ((seed - at) / period).round() * period)
    };
    let (u, v) = surface.periods();
    (moved(at.0, seed.0, u), moved(at.1, seed.1, v))
}

/// Drops the repeated last point; `None` when the loop winds around the surface and so encloses no region of
/// the plane.
fn close(mut corners: Vec<Corner>, surface: &Surface) -> Option<Vec<Corner>> {
    let (first, last) = (*corners.first()?, corners.pop()?);
    let periods = [surface.periods().0, surface.periods().1];
    let winds = (0..2).any(|k| periods[k].is_some_and(|p| (last.uv[k] - first.uv[k]).abs() > CLOSING * p));
    (!winds).then_some(corners)
}

/// Moves inner loops by whole periods into the box of the greatest one.
fn gather(loops: &mut [Vec<Corner>], surface: &Surface) {
    let bounds = |corners: &[Corner], k: usize| {
        let all = corners.iter().map(|c| c.uv[k]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
    };
    let size = |corners: &[Corner]| {
        let [u, v] = [bounds(corners, 0), bounds(corners, 1)];
        (u.1 - u.0) * (v.1 - v.0)
    };
    let greatest = (0..loops.len()).max_by(|&a, &b| size(&loops[a]).total_cmp(&size(&loops[b])));
    let Some(greatest) = greatest else { return };
    for (k, period) in [surface.periods().0, surface.periods().1].into_iter().enumerate() {
        let Some(period) = period else { continue };
        let (low, high) = bounds(&loops[greatest], k);
        for corners in loops.iter_mut() {
            let (own_low, own_high) = bounds(corners, k);
            let turns = (0.5 * (low + high) - 0.5 * (own_low + own_high)) / period;
            for corner in corners {
                corner.uv[k] += turns.round() * period;
            }
        }
    }
}
