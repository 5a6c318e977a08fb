//! Facts: an edge of a closed shell has two faces, no shell has an edge with more, and two faces use their
//! edge in opposite directions.

use super::Finding;
use crate::brep::{Brep, CoedgeId, EdgeId, ShellId};
use crate::math::Point3;
use std::collections::BTreeMap;

/// An edge of a shell that is said to be closed has a face on one side only.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// Two faces use an edge in the same direction.
#[derive(Debug, Clone, PartialEq)]
pub struct OneWayEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// More than two faces of a shell meet at an edge.
#[derive(Debug, Clone, PartialEq)]
pub struct CrowdedEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// Count of uses.
    pub uses: usize,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// Looks at the edges of one shell. A seam counts as two uses by one face.
pub(super) fn check(brep: &Brep, shell: ShellId, findings: &mut Vec<Finding>) {
    let mut uses: BTreeMap<EdgeId, Vec<bool>> = BTreeMap::new();
    for &face in &brep.shells[shell].faces {
        for coedge in brep.coedges_of(face) {
            uses.entry(brep.coedges[coedge].edge).or_default().push(along_edge(brep, coedge));
        }
    }
    for (edge, ways) in uses {
        let place = brep.vertices[brep.edges[edge].start].point;
        match ways[..] {
            [_] if brep.shells[shell].closed => {
                findings.push(Finding::FreeEdge(FreeEdge { shell, edge, place }));
            }
            [a, b] if a == b => findings.push(Finding::OneWayEdge(OneWayEdge { shell, edge, place })),
            [_, _, _, ..] => {
                let uses = ways.len();
                findings.push(Finding::CrowdedEdge(CrowdedEdge { shell, edge, uses, place }));
            }
            _ => {}
        }
    }
}

/// Whether the bound, with its own orientation, runs along the edge from start to end. Both bound and edge
/// are seen against the face's normal, so that the surface's sense has no part in it.
fn along_edge(brep: &Brep, coedge: CoedgeId) -> bool {
    let coedge = &brep.coedges[coedge];
    coedge.forward == brep.loops[coedge.in_loop].forward
}
