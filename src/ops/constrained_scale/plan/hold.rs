//! What is held: the loops that were named, the faces that hang on them, and the loops at which those end.
//!
//! The hold floods over the far side of each held loop. It stops where it runs into an inner loop of another
//! B-spline face; that loop is then held too, and both move as one. Nothing else stops it: a flood that comes back
//! to the face it started from is refused.

use std::collections::{BTreeMap, BTreeSet};

use super::layout::{Layouts, spline_of};
use super::scope::face_name;
use super::{HoldTarget, Params};
use crate::brep::id::Id;
use crate::brep::{CoedgeId, EdgeId, FaceId, LoopId, VertexId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::nurbs::NurbsSurface;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::task::Contour;

/// A face with held loops, in its parameters.
#[derive(Debug, Clone)]
pub(super) struct Base {
    /// Held loops: the loop, its polygon, its group.
    pub held: Vec<(LoopId, Contour, usize)>,
    /// The outer loop, where it is not the natural border.
    pub outer: Option<Contour>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Contour>,
}

/// Everything that moves with a group.
#[derive(Debug, Clone, Default)]
pub(super) struct Held {
    /// Faces with held loops.
    pub bases: BTreeMap<FaceId, Base>,
    /// Faces that move rigidly, with their groups.
    pub hanging: BTreeMap<FaceId, usize>,
    /// Edges that move rigidly, with their groups.
    pub edges: BTreeMap<EdgeId, usize>,
    /// Count of groups.
    pub groups: usize,
}

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
    if seeds.is_empty() {
        let faces = scope.iter().map(|&f| face_name(model, f)).collect();
        return Err(OperationError::NothingToHold { faces });
    }
    let mut flood = Flood::new(model, layouts);
    for (face, at) in seeds {
        flood.hold(face, at);
    }
    flood.run(notes)?;
    flood.join_at_vertices();
    flood.finish()
}

/// The loops that the targets name, as faces and indices of their loops.
fn seeds(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    targets: &[HoldTarget],
    layouts: &mut Layouts,
) -> Result<BTreeSet<(FaceId, usize)>, OperationError> {
    let mut seeds = BTreeSet::new();
    for target in targets {
        match *target {
            HoldTarget::InnerLoops => {
                for &face in scope.iter().filter(|&&f| spline_of(model, f).is_some()) {
                    let loops = model.brep.faces[face].loops.len();
                    if loops > 1 {
                        let layout = layouts.of(model, face)?;
                        seeds.extend((0..loops).filter(|&k| layout.is_inner(k)).map(|k| (face, k)));
                    }
                }
            }
            HoldTarget::Loop(id) => {
                let name = model.origins.loops[id].to_string();
                seeds.insert(holdable(model, scope, id, layouts, &name)?);
            }
            HoldTarget::Edge(edge) => {
                let name = model.origins.edges[edge].to_string();
                seeds.extend(seeds_at(model, scope, edge, layouts, &name)?);
            }
        }
    }
    Ok(seeds)
}

/// A loop that can be held, or why it cannot.
fn holdable(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    id: LoopId,
    layouts: &mut Layouts,
    name: &str,
) -> Result<(FaceId, usize), OperationError> {
    let refuse = |reason: String| Err(OperationError::NotHoldable { entity: name.to_owned(), reason });
    let face = model.brep.loops[id].face;
    if !scope.contains(&face) {
        return refuse(format!("its face {} is not selected", face_name(model, face)));
    }
    if spline_of(model, face).is_none() {
        return refuse(format!("its face {} is no B-spline surface", face_name(model, face)));
    }
    let at = model.brep.faces[face].loops.iter().position(|&l| l == id);
    match at {
        Some(at) if layouts.of(model, face)?.is_inner(at) => Ok((face, at)),
        _ => refuse(format!("it is no inner loop of its face {}", face_name(model, face))),
    }
}

/// The holdable loops that an edge belongs to.
fn seeds_at(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    edge: EdgeId,
    layouts: &mut Layouts,
    name: &str,
) -> Result<Vec<(FaceId, usize)>, OperationError> {
    let loops: BTreeSet<LoopId> =
        model.brep.coedges.iter().filter(|(_, c)| c.edge == edge).map(|(_, c)| c.in_loop).collect();
    let mut found = Vec::new();
    let mut refused = None;
    for id in loops {
        match holdable(model, scope, id, layouts, name) {
            Ok(seed) => found.push(seed),
            Err(error) => refused = Some(error),
        }
    }
    let reason = "no loop uses it".to_owned();
    match refused {
        _ if !found.is_empty() => Ok(found),
        Some(error) => Err(error),
        None => Err(OperationError::NotHoldable { entity: name.to_owned(), reason }),
    }
}

/// The state of the flood. Loops are counted in the order in which they were held.
struct Flood<'a> {
    model: &'a Model,
    layouts: Layouts,
    uses: Vec<Vec<CoedgeId>>,
    loops: Vec<(FaceId, usize)>,
    number: BTreeMap<(FaceId, usize), usize>,
    named: usize,
    /// Union of loops: each points towards the first of its group.
    parent: Vec<usize>,
    hanging: BTreeMap<FaceId, usize>,
    edges: BTreeMap<EdgeId, usize>,
}

impl<'a> Flood<'a> {
    fn new(model: &'a Model, layouts: Layouts) -> Self {
        let mut uses = vec![Vec::new(); model.brep.edges.len()];
        for (id, coedge) in model.brep.coedges.iter() {
            uses[coedge.edge.index()].push(id);
        }
        Self {
            model,
            layouts,
            uses,
            loops: Vec::new(),
            number: BTreeMap::new(),
            named: 0,
            parent: Vec::new(),
            hanging: BTreeMap::new(),
            edges: BTreeMap::new(),
        }
    }

    /// Holds a loop, and gives its number.
    fn hold(&mut self, face: FaceId, at: usize) -> usize {
        if let Some(&number) = self.number.get(&(face, at)) {
            return number;
        }
        let number = self.loops.len();
        self.loops.push((face, at));
        self.number.insert((face, at), number);
        self.parent.push(number);
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

    fn loop_id(&self, k: usize) -> LoopId {
        let (face, at) = self.loops[k];
        self.model.brep.faces[face].loops[at]
    }

    fn run(&mut self, notes: &mut Vec<Diagnostic>) -> Result<(), OperationError> {
        self.named = self.loops.len();
        let mut next = 0;
        while next < self.loops.len() {
            let coedges = self.model.brep.loops[self.loop_id(next)].coedges.clone();
            for coedge in coedges {
                self.cross(coedge, next)?;
            }
            next += 1;
        }
        for k in self.named..self.loops.len() {
            notes.push(Diagnostic {
                code: "scale.held-by-propagation",
                severity: Severity::Warning,
                entity: Some(self.model.origins.loops[self.loop_id(k)].to_string()),
                span: None,
                message: format!(
                    "loop of face {} is held too: what hangs on {} ends there",
                    face_name(self.model, self.loops[k].0),
                    self.model.origins.loops[self.loop_id(self.root(k))],
                ),
            });
        }
        Ok(())
    }

    /// Holds the edge of a coedge and floods over all faces on its far side.
    fn cross(&mut self, coedge: CoedgeId, group: usize) -> Result<(), OperationError> {
        let mut work = vec![coedge];
        while let Some(coedge) = work.pop() {
            let edge = self.model.brep.coedges[coedge].edge;
            if let Some(&other) = self.edges.get(&edge) {
                self.join(group, other);
            }
            self.edges.insert(edge, group);
            for &other in &self.uses[edge.index()].clone() {
                if other != coedge {
                    self.enter(other, group, &mut work)?;
                }
            }
        }
        Ok(())
    }

    /// Comes into a face through one of its coedges: stops at an inner loop, or takes the face along.
    fn enter(&mut self, via: CoedgeId, group: usize, work: &mut Vec<CoedgeId>) -> Result<(), OperationError> {
        let brep = &self.model.brep;
        let id = brep.coedges[via].in_loop;
        let face = brep.loops[id].face;
        let at = brep.faces[face].loops.iter().position(|&l| l == id).unwrap_or(0);
        if let Some(&other) = self.hanging.get(&face) {
            self.join(group, other);
            return Ok(());
        }
        if let Some(&number) = self.number.get(&(face, at)) {
            self.join(group, number);
            return Ok(());
        }
        let spline = spline_of(self.model, face).is_some() && brep.faces[face].loops.len() > 1;
        if spline && self.layouts.of(self.model, face)?.is_inner(at) {
            let number = self.hold(face, at);
            self.join(group, number);
            return Ok(());
        }
        if face == self.loops[group].0 {
            return Err(OperationError::PartlyHeld {
                face: face_name(self.model, face),
                held: self.model.origins.loops[self.loop_id(group)].to_string(),
                scaled: self.model.origins.loops[id].to_string(),
            });
        }
        self.hanging.insert(face, group);
        work.extend(brep.coedges_of(face).filter(|&c| c != via));
        Ok(())
    }

    /// Groups that share a vertex move as one.
    fn join_at_vertices(&mut self) {
        let mut at: BTreeMap<VertexId, usize> = BTreeMap::new();
        for (edge, group) in self.edges.clone() {
            let edge = &self.model.brep.edges[edge];
            for vertex in [edge.start, edge.end] {
                let other = *at.entry(vertex).or_insert(group);
                self.join(group, other);
            }
        }
    }

    /// Numbers the groups in order of their first loops and lays out the bases.
    fn finish(mut self) -> Result<Held, OperationError> {
        // A loop on a face that hangs itself, as a hole in the cap of a boss does, moves with that face.
        for k in 0..self.loops.len() {
            if let Some(&other) = self.hanging.get(&self.loops[k].0) {
                self.join(k, other);
            }
        }
        let mut roots: Vec<usize> = (0..self.loops.len()).map(|k| self.root(k)).collect();
        roots.sort_unstable();
        roots.dedup();
        let group = |flood: &Self, k: usize| {
            roots.binary_search(&flood.root(k)).expect("every root is in the list of roots")
        };
        let mut held = Held { groups: roots.len(), ..Held::default() };
        held.hanging = self.hanging.iter().map(|(&f, &k)| (f, group(&self, k))).collect();
        held.edges = self.edges.iter().map(|(&e, &k)| (e, group(&self, k))).collect();
        let faces: BTreeSet<FaceId> =
            self.loops.iter().map(|l| l.0).filter(|f| !self.hanging.contains_key(f)).collect();
        for face in faces {
            let numbers: BTreeMap<usize, usize> = (0..self.loops.len())
                .filter(|&k| self.loops[k].0 == face)
                .map(|k| (self.loops[k].1, group(&self, k)))
                .collect();
            let base = self.base(face, &numbers)?;
            held.bases.insert(face, base);
        }
        Ok(held)
    }

    /// Lays out a face of which the loops in `groups` are held.
    fn base(&mut self, face: FaceId, groups: &BTreeMap<usize, usize>) -> Result<Base, OperationError> {
        let model = self.model;
        let fault = |reason: &str| {
            let reason = reason.to_owned();
            OperationError::NoParameterLoops { face: face_name(model, face), reason }
        };
        let surface = spline_of(model, face).ok_or_else(|| fault("it is no B-spline surface"))?;
        let layout = self.layouts.of(model, face)?;
        let mut base = Base { held: Vec::new(), outer: None, scaled: Vec::new() };
        for (k, shape) in layout.loops.iter().enumerate() {
            let Some(shape) = shape else { continue };
            let contour = shape.contour.clone();
            if let Some(&group) = groups.get(&k) {
                base.held.push((model.brep.faces[face].loops[k], contour, group));
            } else if layout.is_inner(k) {
                base.scaled.push(contour);
            } else if !on_border(surface, &contour) {
                if !shape.closed {
                    return Err(fault("a loop winds round the closed surface away from its border"));
                }
                base.outer = Some(contour);
            }
        }
        Ok(base)
    }
}

/// Distance from a side of the domain, as a part of its range, within which a loop runs on the natural border.
const ON_BORDER: f64 = 1e-7;

/// Whether every point of a loop lies on the natural border of a surface.
fn on_border(surface: &NurbsSurface, contour: &Contour) -> bool {
    let (u, v) = surface.domain();
    let near = |x: f64, (start, end): (f64, f64)| {
        let room = ON_BORDER * (end - start);
        (x - start).abs() <= room || (x - end).abs() <= room
    };
    contour.points.iter().all(|p| near(p[0], u) || near(p[1], v))
}
