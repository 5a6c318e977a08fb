//! Bounds and faces of shells that come and go, with lists of their own for the edges and vertices that come.

use std::collections::{BTreeMap, BTreeSet};

use super::super::{Entity, EntryNumber};
use super::draft::{self, Look};
use super::record::{Record, Value};
use super::slot::{missing, slot, slots, unreadable};
use super::topology::{Along, Direction, Step};
use super::{Ground, LowerError, Lowering, entry_of, member_of};
use crate::brep::{BodyId, FaceId};
use crate::model::change_set::{EdgeRef, NewBound, NewEdgeId, NewFace, NewVertexId, VertexRef};

/// Form of the lists, of loops and of faces.
const FORM: i32 = 1;

/// A member of a list.
pub(super) type Member = (EntryNumber, usize);

impl Lowering<'_> {
    /// Writes the new edges and vertices of shells, body by body.
    pub(super) fn lists(&mut self) -> Result<(), LowerError> {
        let mut of_body: BTreeMap<BodyId, (FaceId, BTreeSet<NewEdgeId>)> = BTreeMap::new();
        let old = self.changes.new_bounds.iter().map(|(face, bounds)| (*face, bounds));
        let new = self.changes.new_faces.iter().map(|face| (face.beside, &face.bounds));
        let all: Vec<(FaceId, &Vec<NewBound>)> = old.chain(new).collect();
        for (face, bounds) in all {
            if self.ground(face)?.is_solid {
                let (_, edges) = of_body.entry(self.body_of(face)).or_insert_with(|| (face, BTreeSet::new()));
                let uses = bounds.iter().flat_map(|bound| &bound.coedges);
                edges.extend(uses.filter_map(|coedge| match coedge.edge {
                    EdgeRef::New(edge) => Some(edge),
                    EdgeRef::Kept(_) => None,
                }));
            }
        }
        for (body, (face, edges)) in of_body {
            if !edges.is_empty() {
                let ground = self.ground(face)?.clone();
                let vertices = self.vertex_list(&ground, &edges)?;
                self.edge_list(body, &ground, &edges, &vertices)?;
            }
        }
        Ok(())
    }

    fn vertex_list(
        &mut self,
        ground: &Ground,
        edges: &BTreeSet<NewEdgeId>,
    ) -> Result<BTreeMap<NewVertexId, Member>, LowerError> {
        let ends = edges.iter().flat_map(|edge| {
            let edge = &self.changes.new_edges[*edge];
            [edge.start, edge.end]
        });
        let new: BTreeSet<NewVertexId> = ends
            .filter_map(|end| match end {
                VertexRef::New(vertex) => Some(vertex),
                VertexRef::Kept(_) => None,
            })
            .collect();
        if new.is_empty() {
            return Ok(BTreeMap::new());
        }
        let back = ground.within.inverse().ok_or_else(|| unreadable(ground.face, &"its matrix flattens"))?;
        let points = new.iter().map(|vertex| back.point(&self.changes.new_vertices[*vertex]));
        let record = Record::new(Entity::VertexList.number(), FORM).values([Value::count(new.len())]);
        let record = record.reals(points.flat_map(|p| [p.x, p.y, p.z]));
        let entry = self.entry(ground.face)?;
        let list = self.draft.add(&record, Look::part(&entry), &[])?;
        Ok(new.into_iter().enumerate().map(|(at, vertex)| (vertex, (list, at + 1))).collect())
    }

    fn edge_list(
        &mut self,
        body: BodyId,
        ground: &Ground,
        edges: &BTreeSet<NewEdgeId>,
        vertices: &BTreeMap<NewVertexId, Member>,
    ) -> Result<(), LowerError> {
        let mut values = vec![Value::count(edges.len())];
        for &edge in edges {
            let new = self.changes.new_edges[edge].clone();
            let own =
                crate::model::change_set::NewCoedge { edge: EdgeRef::New(edge), forward: true, pcurve: None };
            let bound = NewBound { outer: false, coedges: vec![own] };
            let step = self.steps(None, &bound, Direction::Along)?.remove(0);
            values.push(Value::to(self.add_step_curve(ground, &step, Along::Edge, &ground.within)?));
            for end in [new.start, new.end] {
                let (list, at) = match end {
                    VertexRef::New(vertex) => vertices[&vertex],
                    VertexRef::Kept(vertex) => member_of(self.model.origins.vertices[vertex])?,
                };
                values.extend([Value::to(list), Value::count(at)]);
            }
        }
        let entry = self.entry(ground.face)?;
        let record = Record::new(Entity::EdgeList.number(), FORM).values(values);
        let list = self.draft.add(&record, Look::part(&entry), &[])?;
        for (at, edge) in edges.iter().enumerate() {
            self.new_members.insert((body, *edge), (list, at + 1));
        }
        Ok(())
    }

    pub(super) fn bounds_of_shell_face(
        &mut self,
        face: FaceId,
        ground: &Ground,
        bounds: &[NewBound],
    ) -> Result<(), LowerError> {
        let number = ground.face;
        let direction = match self.model.brep.faces[face].loops.first() {
            Some(of) if !self.model.brep.loops[*of].forward => Direction::Against,
            _ => Direction::Along,
        };
        let view = self.view(number)?;
        let fields = view.fields();
        let gone = self.removed_of(face)?;
        let loops = slots(number, fields, "loops");
        let outer = loops.first().copied().filter(|slot| gone.contains(&slot.target));
        let behind = fields.list("loops").last().or_else(|| fields.get("outer_first"));
        let behind = behind.ok_or_else(|| missing(number, "loops"))?;
        for bound in bounds {
            let of = self.new_loop(face, Some(face), ground, bound, direction)?;
            match outer.filter(|outer| bound.outer && !self.replaced.contains(&outer.target)) {
                Some(outer) => {
                    self.draft.repoint(&outer, of);
                    self.replaced.insert(outer.target);
                }
                None => self.draft.list(number, &behind, &[Value::to(of)], "count"),
            }
        }
        Ok(())
    }

    fn new_loop(
        &mut self,
        beside: FaceId,
        face: Option<FaceId>,
        ground: &Ground,
        bound: &NewBound,
        direction: Direction,
    ) -> Result<EntryNumber, LowerError> {
        let steps = self.steps(face, bound, direction)?;
        let mut values = vec![Value::count(steps.len())];
        for step in &steps {
            let (list, at) = self.member(beside, step)?;
            let pcurve = self.add_step_pcurve(ground, step, Along::Bound)?;
            values.extend([Value::Integer(0), Value::to(list), Value::count(at), Value::flag(step.forward)]);
            values.push(Value::Integer(i64::from(pcurve.is_some())));
            values.extend(pcurve.into_iter().flat_map(|pcurve| [Value::Integer(0), Value::to(pcurve)]));
        }
        let entry = self.entry(ground.face)?;
        let record = Record::new(Entity::Loop.number(), FORM).values(values);
        self.draft.add(&record, Look::part(&entry), &[])
    }

    fn member(&self, beside: FaceId, step: &Step) -> Result<Member, LowerError> {
        match step.edge {
            EdgeRef::Kept(edge) => member_of(self.model.origins.edges[edge]),
            EdgeRef::New(edge) => {
                let known = self.new_members.get(&(self.body_of(beside), edge)).copied();
                known.ok_or_else(|| LowerError::ForeignOrigin { origin: "a new edge".to_owned() })
            }
        }
    }

    pub(super) fn new_shell_face(&mut self, face: &NewFace, beside: &Ground) -> Result<(), LowerError> {
        let ground = self.new_ground(face, beside)?;
        let turned = ground.map_now.linear.determinant() < 0.0;
        let sense = face.same_sense != turned;
        let direction =
            if sense || self.as_shell(face.beside) { Direction::Along } else { Direction::Against };
        let mut loops = Vec::new();
        for bound in &face.bounds {
            let of = Value::to(self.new_loop(face.beside, None, &ground, bound, direction)?);
            let at = if bound.outer { 0 } else { loops.len() };
            loops.insert(at, of);
        }
        let outer = face.bounds.iter().any(|bound| bound.outer);
        let number = beside.face;
        let record = Record::new(Entity::Face.number(), FORM).pointer(ground.surface_now);
        let record = record.values([Value::count(loops.len()), Value::flag(outer)]).values(loops);
        let entry = self.entry(number)?;
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let new = self.draft.add(&record, Look::same(&entry), &draft::behind(instance))?;
        let shell = entry_of(self.model.origins.shells[self.model.brep.faces[face.beside].shell])?;
        let view = self.view(shell)?;
        let faces = view.fields().group("faces").map_err(|error| unreadable(shell, &error))?;
        let last = faces.last().and_then(|member| member.get("sense"));
        let last = last.ok_or_else(|| missing(shell, "faces"))?;
        self.draft.list(shell, &last, &[Value::to(new), Value::flag(sense)], "count");
        Ok(())
    }

    /// Whether the loops of a face's shell run as seen from the shell, whatever their surfaces.
    fn as_shell(&self, face: FaceId) -> bool {
        let shell = self.model.brep.faces[face].shell;
        let faces = self.model.brep.shells[shell].faces.iter();
        let turned = faces.filter(|face| {
            let instance = entry_of(self.model.origins.faces[**face]).ok();
            let sense = instance.and_then(|number| self.sense_in_shell(shell, number));
            sense == Some(false)
        });
        turned
            .flat_map(|face| &self.model.brep.faces[*face].loops)
            .any(|of| self.model.brep.loops[*of].forward)
    }

    fn sense_in_shell(&self, shell: crate::brep::ShellId, face: EntryNumber) -> Option<bool> {
        let shell = entry_of(self.model.origins.shells[shell]).ok()?;
        let view = self.view(shell).ok()?;
        let faces = view.fields().group("faces").ok()?;
        let member = faces.iter().find(|member| member.optional_pointer("face") == Some(face))?;
        member.integer("sense").ok().map(|sense| sense != 0)
    }

    pub(super) fn remove_shell_face(&mut self, face: FaceId, number: EntryNumber) -> Result<(), LowerError> {
        let shell = entry_of(self.model.origins.shells[self.model.brep.faces[face].shell])?;
        let view = self.view(shell)?;
        for member in view.fields().group("faces").map_err(|error| unreadable(shell, &error))? {
            if let Some(slot) = slot(shell, &member, "face").filter(|slot| slot.target == number) {
                self.draft.unlist(&slot, 1, "count");
            }
        }
        Ok(())
    }
}
