//! Facts: an edge of a closed shell has two faces, no shell has an edge with more, and two faces use their
//! edge in opposite directions.

use super::Finding;
use crate::brep::{Brep, CoedgeId, EdgeId, FaceId, ShellId};
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

/// A shell that is said to be closed has edges with a face on one side only.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenShell {
    /// The shell.
    pub shell: ShellId,
    /// Count of such edges.
    pub free_edges: usize,
    /// The start of one.
    pub place: Point3<f64>,
}

/// Every neighbour of a face runs along the common edge as the face does: the face is turned over.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnedFace {
    /// The face.
    pub face: FaceId,
    /// The start of one of its edges.
    pub place: Point3<f64>,
}

/// Looks at the edges of one shell. A seam counts as two uses by one face.
pub(super) fn check(brep: &Brep, shell: ShellId, findings: &mut Vec<Finding>) {
    let mut uses: BTreeMap<EdgeId, Vec<bool>> = BTreeMap::new();
    let mut faces: BTreeMap<EdgeId, Vec<FaceId>> = BTreeMap::new();
    let mut free: Option<OpenShell> = None;
    for &face in &brep.shells[shell].faces {
        for coedge in brep.coedges_of(face) {
            let edge = brep.coedges[coedge].edge;
            uses.entry(edge).or_default().push(along_edge(brep, coedge));
            faces.entry(edge).or_default().push(face);
        }
    }
    turned_faces(brep, shell, &uses, &faces, findings);
    for (edge, ways) in uses {
        let place = brep.vertices[brep.edges[edge].start].point;
        match ways[..] {
            [_] if brep.shells[shell].closed => {
                findings.push(Finding::FreeEdge(FreeEdge { shell, edge, place }));
                free.get_or_insert(OpenShell { shell, free_edges: 0, place }).free_edges += 1;
            }
            [a, b] if a == b => findings.push(Finding::OneWayEdge(OneWayEdge { shell, edge, place })),
            [_, _, _, ..] => {
                let uses = ways.len();
                findings.push(Finding::CrowdedEdge(CrowdedEdge { shell, edge, uses, place }));
            }
            _ => {}
        }
    }
    findings.extend(free.map(Finding::OpenShell));
}

/// Faces of which every edge is used the same way by one other face, where that face has edges that are used well.
fn turned_faces(
    brep: &Brep,
    shell: ShellId,
    uses: &BTreeMap<EdgeId, Vec<bool>>,
    faces: &BTreeMap<EdgeId, Vec<FaceId>>,
    findings: &mut Vec<Finding>,
) {
    for &face in &brep.shells[shell].faces {
        let edges = || brep.coedges_of(face).map(|coedge| brep.coedges[coedge].edge);
        let shared = || edges().filter(|e| faces[e].len() == 2 && faces[e][0] != faces[e][1]);
        let one_way = |edge: &EdgeId| uses[edge][0] == uses[edge][1];
        let turned = shared().next().is_some() && shared().all(|edge| one_way(&edge));
        // Its neighbours are at peace with others: it is this face that is turned.
        let sound = |other: FaceId| {
            brep.coedges_of(other).map(|c| brep.coedges[c].edge).any(|e| uses[&e].len() == 2 && !one_way(&e))
        };
        let others = shared().flat_map(|edge| faces[&edge].iter().copied()).filter(|&f| f != face);
        if let Some(edge) = shared().next().filter(|_| turned && others.into_iter().all(sound)) {
            let place = brep.vertices[brep.edges[edge].start].point;
            findings.push(Finding::TurnedFace(TurnedFace { face, place }));
        }
    }
}

/// Whether the bound, with its own orientation, runs along the edge from start to end. Both bound and edge
/// are seen against the face's normal, so that the surface's sense has no part in it.
fn along_edge(brep: &Brep, coedge: CoedgeId) -> bool {
    let coedge = &brep.coedges[coedge];
    coedge.forward == brep.loops[coedge.in_loop].forward
}
