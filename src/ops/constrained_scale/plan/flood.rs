//! What hangs on a hold: the faces on the far side of the held loops, and the loops at which those end.
//!
//! The hold floods over the far side of each held loop, or from a named face. It stops where it runs into an inner
//! loop of another face; that loop is then held too, and both move as one. Nothing else stops it, no size and no angle:
//! a flood that comes back to the face it started from, or takes a whole body, is refused.

use std::collections::{BTreeMap, BTreeSet};

use super::Params;
use super::contour::SpaceLoop;
use super::held::{Held, HeldLoop};
use super::layout::Layouts;
use super::scope::face_name;
use super::target::{Seeds, seeds};
use crate::brep::id::Id;
use crate::brep::{CoedgeId, EdgeId, FaceId, LoopId, VertexId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::Model;
use crate::ops::OperationError;

/// Finds what is held; empty when nothing is to be.
pub(super) fn find(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    params: &Params,
    notes: &mut Vec<Diagnostic>,
) -> Result<Held, OperationError> {
    if params.hold.is_empty() {
        return Ok(Held::default());
    }
    let mut layouts = Layouts::default();
    let seeds = seeds(model, scope, &params.hold, &mut layouts)?;
    let mut flood = Flood::new(model, layouts, &params.stop);
    flood.start(&seeds)?;
    flood.run(notes)?;
    flood.join_at_vertices();
    flood.finish()
}

/// The state of the flood. What it starts from and every loop that it holds is a source, counted in that order.
struct Flood<'a> {
    model: &'a Model,
    layouts: Layouts,
    stop: BTreeSet<FaceId>,
    uses: Vec<Vec<CoedgeId>>,
    sources: Vec<Source>,
    number: BTreeMap<(FaceId, usize), usize>,
    named: usize,
    /// Union of sources: each points towards the first of its group.
    parent: Vec<usize>,
    hanging: BTreeMap<FaceId, usize>,
    edges: BTreeMap<EdgeId, usize>,
}

/// What a flood comes from.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// A held loop: its face and its index there.
    Loop(FaceId, usize),
    /// A named face.
    Face(FaceId),
}

impl<'a> Flood<'a> {
    fn new(model: &'a Model, layouts: Layouts, stop: &[FaceId]) -> Self {
        let mut uses = vec![Vec::new(); model.brep.edges.len()];
        for (id, coedge) in model.brep.coedges.iter() {
            uses[coedge.edge.index()].push(id);
        }
        Self {
            model,
            layouts,
            stop: stop.iter().copied().collect(),
            uses,
            sources: Vec::new(),
            number: BTreeMap::new(),
            named: 0,
            parent: Vec::new(),
            hanging: BTreeMap::new(),
            edges: BTreeMap::new(),
        }
    }

    /// Holds the seeds and floods from the named faces.
    fn start(&mut self, seeds: &Seeds) -> Result<(), OperationError> {
        for &(face, at) in &seeds.loops {
            self.hold(face, at);
        }
        self.named = self.sources.len();
        for &face in &seeds.faces {
            let source = self.source(Source::Face(face));
            match self.hanging.get(&face) {
                Some(&other) => self.join(source, other),
                None => {
                    self.hanging.insert(face, source);
                    let all: Vec<CoedgeId> = self.model.brep.coedges_of(face).collect();
                    self.spread(all, source)?;
                }
            }
        }
        Ok(())
    }

    fn source(&mut self, source: Source) -> usize {
        let number = self.sources.len();
        self.sources.push(source);
        self.parent.push(number);
        number
    }

    /// Holds a loop, and gives its number.
    fn hold(&mut self, face: FaceId, at: usize) -> usize {
        if let Some(&number) = self.number.get(&(face, at)) {
            return number;
        }
        let number = self.source(Source::Loop(face, at));
        self.number.insert((face, at), number);
        number
    }

    fn root(&self, mut k: usize) -> usize {
        while self.parent[k] != k {
            k = self.parent[k];
        }
        k
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    fn loop_id(&self, face: FaceId, at: usize) -> LoopId {
        self.model.brep.faces[face].loops[at]
    }

    fn source_name(&self, k: usize) -> String {
        match self.sources[k] {
            Source::Loop(face, at) => self.model.origins.loops[self.loop_id(face, at)].to_string(),
            Source::Face(face) => face_name(self.model, face),
        }
    }

    fn run(&mut self, notes: &mut Vec<Diagnostic>) -> Result<(), OperationError> {
        let mut next = 0;
        while next < self.sources.len() {
            if let Source::Loop(face, at) = self.sources[next] {
                // A loop of a face that hangs itself was flooded with it.
                if !self.hanging.contains_key(&face) {
                    let coedges = self.model.brep.loops[self.loop_id(face, at)].coedges.clone();
                    self.spread(coedges, next)?;
                }
            }
            next += 1;
        }
        for k in self.named..self.sources.len() {
            let Source::Loop(face, _) = self.sources[k] else { continue };
            notes.push(Diagnostic {
                code: "scale.held-by-propagation",
                severity: Severity::Warning,
                entity: Some(self.source_name(k)),
                span: None,
                message: format!(
                    "loop of face {} is held too: what hangs on {} ends there",
                    face_name(self.model, face),
                    self.source_name(self.root(k)),
                ),
            });
        }
        Ok(())
    }

    /// Holds the edges of coedges and floods over all faces on their far sides.
    fn spread(&mut self, mut work: Vec<CoedgeId>, source: usize) -> Result<(), OperationError> {
        while let Some(coedge) = work.pop() {
            let edge = self.model.brep.coedges[coedge].edge;
            if let Some(&other) = self.edges.get(&edge) {
                self.join(source, other);
            }
            self.edges.insert(edge, source);
            for &other in &self.uses[edge.index()].clone() {
                if other != coedge {
                    self.enter(other, source, &mut work)?;
                }
            }
        }
        Ok(())
    }

    /// Comes into a face through one of its coedges: stops at an inner loop, or takes the face along.
    fn enter(
        &mut self,
        via: CoedgeId,
        source: usize,
        work: &mut Vec<CoedgeId>,
    ) -> Result<(), OperationError> {
        let brep = &self.model.brep;
        let id = brep.coedges[via].in_loop;
        let face = brep.loops[id].face;
        let at = brep.faces[face].loops.iter().position(|&l| l == id).unwrap_or(0);
        if let Some(&other) = self.hanging.get(&face) {
            self.join(source, other);
            return Ok(());
        }
        if let Some(&number) = self.number.get(&(face, at)) {
            self.join(source, number);
            return Ok(());
        }
        if brep.faces[face].loops.len() > 1 && self.layouts.of(self.model, face)?.is_inner(at) {
            let number = self.hold(face, at);
            self.join(source, number);
            return Ok(());
        }
        let home = match self.sources[source] {
            Source::Loop(home, _) => Some(home),
            Source::Face(_) => None,
        };
        if home == Some(face) || self.stop.contains(&face) {
            let edge = self.model.origins.edges[brep.coedges[via].edge];
            return Err(OperationError::HoldNotSeparated {
                held: self.source_name(source),
                reason: format!("it comes to face {} through edge {edge}", face_name(self.model, face)),
            });
        }
        self.hanging.insert(face, source);
        work.extend(brep.coedges_of(face).filter(|&c| c != via));
        Ok(())
    }

    /// Groups that share a vertex move as one.
    fn join_at_vertices(&mut self) {
        let mut at: BTreeMap<VertexId, usize> = BTreeMap::new();
        for (edge, source) in self.edges.clone() {
            let edge = &self.model.brep.edges[edge];
            for vertex in [edge.start, edge.end] {
                let other = *at.entry(vertex).or_insert(source);
                self.join(source, other);
            }
        }
    }

    /// Numbers the groups in order of their first sources.
    fn finish(mut self) -> Result<Held, OperationError> {
        // A loop on a face that hangs itself, as a hole in the cap of a boss does, moves with that face.
        let mut based = BTreeSet::new();
        for k in 0..self.sources.len() {
            match self.sources[k] {
                Source::Loop(face, _) => match self.hanging.get(&face) {
                    Some(&other) => self.join(k, other),
                    None => _ = based.insert(k),
                },
                Source::Face(_) => {}
            }
        }
        let roots: BTreeSet<usize> = (0..self.sources.len()).map(|k| self.root(k)).collect();
        let with_base: BTreeSet<usize> = based.iter().map(|&k| self.root(k)).collect();
        if let Some(&lost) = roots.difference(&with_base).next() {
            let reason = "no inner loop of another face bounds it".to_owned();
            return Err(OperationError::HoldNotSeparated { held: self.source_name(lost), reason });
        }
        let order: Vec<usize> = roots.into_iter().collect();
        let group = |k: usize| order.partition_point(|&root| root < self.root(k));
        let mut held = Held { groups: order.len(), ..Held::default() };
        held.hanging = self.hanging.iter().map(|(&face, &k)| (face, group(k))).collect();
        held.edges = self.edges.iter().map(|(&edge, &k)| (edge, group(k))).collect();
        for &k in &based {
            let Source::Loop(face, at) = self.sources[k] else { continue };
            let id = self.loop_id(face, at);
            held.loops.push(HeldLoop {
                face,
                at,
                id,
                group: group(k),
                shape: SpaceLoop::of(self.model, id)?,
            });
        }
        super::base::lay_out(self.model, &mut held, &mut self.layouts)?;
        Ok(held)
    }
}
