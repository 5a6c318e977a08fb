//! How a change set alters the counts of a model: what a reader of the written file must find.

use std::collections::BTreeSet;

use super::change_set::{EdgeRef, VertexRef};
use super::{ChangeSet, Model};
use crate::brep::{Brep, EdgeId, LoopId, VertexId};

/// Differences of counts, after less before.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Balance {
    /// Faces.
    pub faces: isize,
    /// Edges that a loop uses.
    pub edges: isize,
    /// Vertices that a used edge has.
    pub vertices: isize,
}

impl Balance {
    /// What a change set does to the counts of a model.
    #[must_use]
    pub fn of(model: &Model, changes: &ChangeSet) -> Self {
        let lost = LostElements::of(&model.brep, changes);
        Self {
            faces: difference(changes.new_faces.len(), changes.removed_faces.len()),
            edges: difference(changes.new_edges.len(), lost.edges.len()),
            vertices: difference(changes.new_vertices.len(), lost.vertices.len()),
        }
    }

    /// Adds what a later change set does.
    pub fn add(&mut self, later: Self) {
        self.faces += later.faces;
        self.edges += later.edges;
        self.vertices += later.vertices;
    }

    /// The difference of a count by its name in reports; 0 for counts that no change set alters.
    #[must_use]
    pub fn count(&self, name: &str) -> isize {
        match name {
            "faces" => self.faces,
            "edges" => self.edges,
            "vertices" => self.vertices,
            _ => 0,
        }
    }
}

fn difference(new: usize, gone: usize) -> isize {
    isize::try_from(new).unwrap_or(isize::MAX) - isize::try_from(gone).unwrap_or(isize::MAX)
}

/// Elements of a model that no loop uses any more.
struct LostElements {
    edges: BTreeSet<EdgeId>,
    vertices: BTreeSet<VertexId>,
}

impl LostElements {
    fn of(brep: &Brep, changes: &ChangeSet) -> Self {
        let goes = |bound: LoopId| {
            changes.removed_bounds.contains(&bound) || changes.removed_faces.contains(&brep.loops[bound].face)
        };
        let (mut before, mut after) = (BTreeSet::new(), kept_edges(changes));
        for (_, coedge) in brep.coedges.iter() {
            before.insert(coedge.edge);
            if !goes(coedge.in_loop) {
                after.insert(coedge.edge);
            }
        }
        let ends = |edges: &BTreeSet<EdgeId>| -> BTreeSet<VertexId> {
            edges.iter().flat_map(|&edge| [brep.edges[edge].start, brep.edges[edge].end]).collect()
        };
        let (mut vertices, mut staying) = (ends(&before), ends(&after));
        for (id, bound) in brep.loops.iter() {
            vertices.extend(bound.vertex);
            staying.extend(bound.vertex.filter(|_| !goes(id)));
        }
        staying.extend(kept_vertices(changes));
        let edges = before.difference(&after).copied().collect();
        Self { edges, vertices: vertices.difference(&staying).copied().collect() }
    }
}

fn kept_edges(changes: &ChangeSet) -> BTreeSet<EdgeId> {
    let coedges = changes.all_new_bounds().flat_map(|bound| &bound.coedges);
    let kept = |edge: EdgeRef| if let EdgeRef::Kept(edge) = edge { Some(edge) } else { None };
    coedges.filter_map(|coedge| kept(coedge.edge)).collect()
}

fn kept_vertices(changes: &ChangeSet) -> impl Iterator<Item = VertexId> + '_ {
    let ends = changes.new_edges.iter().flat_map(|(_, edge)| [edge.start, edge.end]);
    ends.filter_map(|end| if let VertexRef::Kept(vertex) = end { Some(vertex) } else { None })
}
