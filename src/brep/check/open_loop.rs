//! Fact: every coedge of a loop starts where the one before ends.

use super::Finding;
use crate::brep::{Brep, CoedgeId, FaceId, LoopId, VertexId};
use crate::math::Point3;

/// A coedge does not start where the one before ends.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenLoop {
    /// The loop.
    pub bound: LoopId,
    /// The coedge that ends.
    pub from: CoedgeId,
    /// The coedge that should start there.
    pub to: CoedgeId,
    /// Distance between them, in file units.
    pub gap: f64,
    /// Where the first one ends.
    pub place: Point3<f64>,
}

/// Looks at the loops of a face.
pub(super) fn check(brep: &Brep, face: FaceId, tolerance: f64, findings: &mut Vec<Finding>) {
    for &bound in &brep.faces[face].loops {
        let coedges = &brep.loops[bound].coedges;
        for (i, &from) in coedges.iter().enumerate() {
            let to = coedges[(i + 1) % coedges.len()];
            let (end, start) = (ends(brep, from).1, ends(brep, to).0);
            let place = brep.vertices[end].point;
            let gap = (brep.vertices[start].point - place).norm();
            if end != start && gap > tolerance {
                findings.push(Finding::OpenLoop(OpenLoop { bound, from, to, gap, place }));
            }
        }
    }
}

/// First and last vertex in the direction of a coedge.
fn ends(brep: &Brep, coedge: CoedgeId) -> (VertexId, VertexId) {
    let coedge = &brep.coedges[coedge];
    let edge = &brep.edges[coedge.edge];
    if coedge.forward { (edge.start, edge.end) } else { (edge.end, edge.start) }
}
