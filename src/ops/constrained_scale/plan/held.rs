//! What is held, as data: loops with their groups, faces and edges that hang on them, and the faces that bear them.

use std::collections::BTreeMap;

use super::base::Base;
use super::contour::SpaceLoop;
use crate::brep::{EdgeId, FaceId, LoopId};

/// A held loop on a face that does not hang itself.
#[derive(Debug, Clone)]
pub(super) struct HeldLoop {
    /// Face that bears it.
    pub face: FaceId,
    /// Its index among the loops of the face.
    pub at: usize,
    /// The loop.
    pub id: LoopId,
    /// Its group.
    pub group: usize,
    /// Its shape in space.
    pub shape: SpaceLoop,
}

/// Everything that moves with a group.
#[derive(Debug, Clone, Default)]
pub(super) struct Held {
    /// Held loops: those that were named, in order, then those that the hold spread to.
    pub loops: Vec<HeldLoop>,
    /// Faces with held loops.
    pub bases: BTreeMap<FaceId, Base>,
    /// Faces that move rigidly, with their groups.
    pub hanging: BTreeMap<FaceId, usize>,
    /// Edges that move rigidly, with their groups.
    pub edges: BTreeMap<EdgeId, usize>,
    /// Count of groups.
    pub groups: usize,
}

impl Held {
    /// Numbers of the held loops of a face.
    pub fn loops_of(&self, face: FaceId) -> impl Iterator<Item = usize> + '_ {
        (0..self.loops.len()).filter(move |&k| self.loops[k].face == face)
    }
}
