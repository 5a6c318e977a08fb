//! Loops of a face as polygons in the parameter plane, over the shared points of the edges.

use super::region::Corner;
use super::{TessellateError, Tolerances};
use crate::brep::{
    Brep, EdgeId, EdgePoint, FaceId, LoopPoint, LoopSampling, ParameterLoop, parameter_loops_with,
};
use std::collections::BTreeMap;

/// Samples of an edge from its start to its end, and their vertices in the mesh.
#[derive(Debug, Clone)]
pub(super) struct SharedEdge {
    pub samples: Vec<EdgePoint>,
    pub vertices: Vec<u32>,
}

/// Share of the chord tolerance within which a pcurve must agree with its edge to be followed, and a
/// parameter line counts as a pole.
const AGREEMENT: f64 = 0.1;

/// Loops of a face in one sheet of the parameter plane; a loop that is a vertex alone has no corner.
pub(super) fn loops(
    brep: &Brep,
    face: FaceId,
    tolerances: &Tolerances,
    edges: &BTreeMap<EdgeId, SharedEdge>,
) -> Result<Vec<Vec<Corner>>, TessellateError> {
    let sampling = LoopSampling::of_tolerance(AGREEMENT * tolerances.chord);
    let samples = |edge: EdgeId| edges.get(&edge).map(|shared| shared.samples.clone());
    let found = parameter_loops_with(brep, face, &sampling, &samples)
        .map_err(|source| TessellateError::Bounds { face, source })?;
    let corners =
        |l: &ParameterLoop| l.points.iter().map(|p| corner(brep, p, edges)).collect::<Option<Vec<_>>>();
    let mut loops = Vec::with_capacity(found.len());
    let mut winding = Vec::new();
    for parameter_loop in &found {
        let corners = corners(parameter_loop).expect("the points are samples of the edges that were given");
        let turns = [parameter_loop.winding.0, parameter_loop.winding.1];
        if turns == [0.0; 2] {
            loops.push(corners);
        } else {
            winding.push((corners, turns));
        }
    }
    loops.retain(|corners| !corners.is_empty());
    if !winding.is_empty() {
        loops.push(band(winding).ok_or(TessellateError::WindingBounds { face })?);
    }
    Ok(loops)
}

/// The corner of a loop's point: the sample of its edge with the same parameter knows the vertex.
fn corner(brep: &Brep, at: &LoopPoint, edges: &BTreeMap<EdgeId, SharedEdge>) -> Option<Corner> {
    let shared = edges.get(&brep.coedges[at.coedge].edge)?;
    let index = shared.samples.iter().position(|sample| sample.t.to_bits() == at.t.to_bits())?;
    Some(Corner { uv: [at.u, at.v], vertex: shared.vertices[index], point: shared.samples[index].point })
}

/// The region between two loops that wind once around in opposite senses, as one polygon cut open along a
/// straight line of the parameter plane between two of their vertices.
///
/// The cut's chord lies in both its sides, so it needs no points of its own where the surface is straight
/// along it; it is left to lie off a surface that bends.
fn band(mut winding: Vec<(Vec<Corner>, [f64; 2])>) -> Option<Vec<Corner>> {
    let ((second, back), (first, turns)) = (winding.pop()?, winding.pop()?);
    let opposite = (0..2).all(|k| (turns[k] + back[k]).abs() <= 1e-9 * turns[k].abs());
    if !winding.is_empty() || !opposite {
        return None;
    }
    let moved = |corner: &Corner, by: [f64; 2]| Corner {
        uv: [corner.uv[0] + by[0], corner.uv[1] + by[1]],
        ..*corner
    };
    let end = moved(first.first()?, turns);
    // The second loop starts at the corner that is closest to the first one's end, whole turns aside.
    let along = usize::from(turns[1].abs() > turns[0].abs());
    let turn = turns[along];
    let offset = |corner: &Corner| {
        let away = (corner.uv[along] - end.uv[along]) / turn;
        (away - away.round()).abs()
    };
    let start = (0..second.len()).min_by(|&a, &b| offset(&second[a]).total_cmp(&offset(&second[b])))?;
    let shift = ((end.uv[along] - second[start].uv[along]) / turn).round();
    let by = |turns_more: f64| turns.map(|t| t * turns_more);
    let mut polygon = first;
    polygon.push(end);
    polygon.extend(second[start..].iter().map(|corner| moved(corner, by(shift))));
    polygon.extend(second[..=start].iter().map(|corner| moved(corner, by(shift - 1.0))));
    Some(polygon)
}
