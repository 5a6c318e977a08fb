//! Which records a job held, and by which motion in all: its operations follow each other, and what one holds another may
//! change.

use std::collections::{BTreeMap, BTreeSet};

use crate::job::own_check::changed_faces;
use crate::job::side::proof::Held;
use crate::math::Affine;
use crate::model::{ChangeSet, Model, Origin};
use crate::ops::constrained_scale::plan::HeldPiece;

/// Records held so far.
#[derive(Debug, Clone, Default)]
pub struct HeldRecords {
    motions: BTreeMap<Origin, Affine>,
    /// Records that some operation changed without holding them.
    changed: BTreeSet<Origin>,
}

impl HeldRecords {
    /// Takes in what an operation holds and changes.
    pub fn follow(&mut self, model: &Model, changes: &ChangeSet, pieces: &[HeldPiece]) {
        let mut held: BTreeMap<Origin, Affine> = BTreeMap::new();
        for piece in pieces {
            let faces = piece.faces.iter().map(|&face| model.origins.faces[face]);
            let edges = piece.edges.iter().map(|&edge| model.origins.edges[edge]);
            let vertices = piece.vertices.iter().map(|&vertex| model.origins.vertices[vertex]);
            held.extend(faces.chain(edges).chain(vertices).map(|record| (record, piece.motion)));
        }
        self.changed.extend(touched(model, changes).into_iter().filter(|record| !held.contains_key(record)));
        for (record, motion) in held {
            let whole = self.motions.get(&record).map_or(motion, |before| motion.after(before));
            self.motions.insert(record, whole);
        }
        self.motions.retain(|record, _| !self.changed.contains(record));
    }

    /// The records in groups of one motion, in the order of their first records.
    #[must_use]
    pub fn groups(&self) -> Vec<Held> {
        let mut groups: Vec<Held> = Vec::new();
        for (&record, motion) in &self.motions {
            match groups.iter_mut().find(|group| group.motion == *motion) {
                Some(group) => group.records.push(record),
                None => groups.push(Held { motion: *motion, records: vec![record] }),
            }
        }
        groups
    }
}

/// Records of faces, edges and vertices whose geometry a change set touches.
fn touched(model: &Model, changes: &ChangeSet) -> BTreeSet<Origin> {
    let brep = &model.brep;
    let faces = changed_faces(model, changes).into_iter().map(|face| model.origins.faces[face]);
    let moved = |edge: &crate::brep::Edge| {
        changes.points.contains_key(&edge.start) || changes.points.contains_key(&edge.end)
    };
    let edges = brep.edges.iter().filter(|(id, edge)| changes.curves.contains_key(id) || moved(edge));
    let edges = edges.map(|(edge, _)| model.origins.edges[edge]);
    let vertices = changes.points.keys().map(|&vertex| model.origins.vertices[vertex]);
    faces.chain(edges).chain(vertices).collect()
}
