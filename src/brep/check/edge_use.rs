//! Which faces of a shell use each edge, and in which direction: what several facts are about.

use crate::brep::{Brep, CoedgeId, EdgeId, FaceId, ShellId};
use crate::math::Point3;

/// The use of an edge by a face of a shell. A seam counts as two uses by one face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Use {
    pub(super) edge: EdgeId,
    pub(super) face: FaceId,
    /// Whether the bound runs along the edge from start to end.
    pub(super) along: bool,
}

/// All uses of edges in one shell.
pub(super) struct Uses<'a> {
    pub(super) brep: &'a Brep,
    pub(super) shell: ShellId,
    /// Those of one edge together, in file order.
    sorted: Vec<Use>,
}

impl<'a> Uses<'a> {
    pub(super) fn of(brep: &'a Brep, shell: ShellId) -> Self {
        let mut sorted = Vec::new();
        for &face in &brep.shells[shell].faces {
            let uses = brep.coedges_of(face);
            sorted.extend(uses.map(|c| Use { edge: brep.coedges[c].edge, face, along: along(brep, c) }));
        }
        sorted.sort_by_key(|of| of.edge);
        Self { brep, shell, sorted }
    }

    /// Uses edge by edge.
    pub(super) fn by_edge(&self) -> impl Iterator<Item = (EdgeId, &[Use])> {
        self.sorted.chunk_by(|a, b| a.edge == b.edge).map(|uses| (uses[0].edge, uses))
    }

    /// Uses of one edge.
    pub(super) fn of_edge(&self, edge: EdgeId) -> &[Use] {
        let start = self.sorted.partition_point(|of| of.edge < edge);
        let count = self.sorted[start..].partition_point(|of| of.edge == edge);
        &self.sorted[start..start + count]
    }

    /// Edges of a face, loop by loop.
    pub(super) fn edges_of(&self, face: FaceId) -> impl Iterator<Item = EdgeId> {
        self.brep.coedges_of(face).map(|coedge| self.brep.coedges[coedge].edge)
    }

    /// Where an edge starts.
    pub(super) fn start(&self, edge: EdgeId) -> Point3<f64> {
        self.brep.vertices[self.brep.edges[edge].start].point
    }
}

/// Whether the bound, with its own orientation, runs along the edge from start to end. Both bound and edge
/// are seen against the face's normal, so that the surface's sense has no part in it.
fn along(brep: &Brep, coedge: CoedgeId) -> bool {
    let coedge = &brep.coedges[coedge];
    coedge.forward == brep.loops[coedge.in_loop].forward
}
