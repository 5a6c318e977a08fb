//! Faces and bounds that come and go, in loose faces and in shells.

use super::super::EntryNumber;
use super::curve::{between, in_space};
use super::draft::Look;
use super::record::Record;
use super::slot::{slots, unreadable};
use super::{Ground, LowerError, Lowering, entry_of};
use crate::brep::{BodyId, EdgeId, FaceId, LoopId};
use crate::geometry::Curve2d;
use crate::iges::to_model::curve::Piece;
use crate::iges::to_model::curve2d::Piece2d;
use crate::iges::to_model::pcurve;
use crate::math::{Affine, Point3};
use crate::model::change_set::{EdgeCurve, EdgeRef, NewBound, NewCoedge, NewFace, VertexRef};

/// A use of an edge by a new bound, in the order and the direction in which the file has it.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) edge: EdgeRef,
    pub(super) forward: bool,
    /// The piece of its curve that the edge is, run as the edge does.
    pub(super) piece: Piece,
    /// Its curve in the parameters of the model, over those of the piece.
    pub(super) pcurve: Option<Curve2d>,
}

impl Lowering<'_> {
    /// Writes everything that comes and takes out everything that goes.
    pub(super) fn topology(&mut self) -> Result<(), LowerError> {
        let changes = self.changes;
        self.lists()?;
        for (&face, bounds) in &changes.new_bounds {
            let ground = self.ground(face)?.clone();
            if ground.is_solid {
                self.bounds_of_shell_face(face, &ground, bounds)?;
            } else {
                self.bounds_of_loose_face(face, &ground, bounds)?;
            }
        }
        for face in &changes.new_faces {
            let beside = self.ground(face.beside)?.clone();
            if beside.is_solid {
                self.new_shell_face(face, &beside)?;
            } else {
                self.new_loose_face(face, &beside)?;
            }
        }
        for &of in &changes.removed_bounds {
            self.remove_bound(of)?;
        }
        for &face in &changes.removed_faces {
            self.remove_face(face)?;
        }
        Ok(())
    }

    fn remove_bound(&mut self, of: LoopId) -> Result<(), LowerError> {
        let face = self.model.brep.loops[of].face;
        if self.changes.removed_faces.contains(&face) {
            return Ok(());
        }
        let number = entry_of(self.model.origins.loops[of])?;
        let ground = self.ground(face)?.clone();
        if number == ground.surface || number == ground.face {
            return Err(LowerError::NaturalBounds { number: ground.face, change: "taken away" });
        }
        if self.replaced.contains(&number) {
            return Ok(());
        }
        let view = self.view(ground.face)?;
        // A face of a solid lists loops; a loose one is a trimmed surface or a bounded one.
        for (list, count) in [("loops", "count"), ("inner", "inner_count"), ("boundaries", "count")] {
            let found =
                slots(ground.face, view.fields(), list).into_iter().find(|slot| slot.target == number);
            if let Some(slot) = found {
                self.draft.unlist(&slot, 0, count);
                return Ok(());
            }
        }
        Err(LowerError::Unwritable { number: ground.face, kind: "face without an outer bound" })
    }

    fn remove_face(&mut self, face: FaceId) -> Result<(), LowerError> {
        let number = entry_of(self.model.origins.faces[face])?;
        if self.ground(face)?.is_solid {
            return self.remove_shell_face(face, number);
        }
        for gatherer in self.draft.gatherers(number) {
            self.remove_from_gatherer(gatherer, number)?;
        }
        self.draft.remove(number);
        Ok(())
    }

    /// The uses of a bound as the file has them: `as_surface` when the file counts the bound as seen against the normal of
    /// the face in the model, else the other way round.
    pub(super) fn steps(
        &mut self,
        face: Option<FaceId>,
        bound: &NewBound,
        as_face: Direction,
    ) -> Result<Vec<Step>, LowerError> {
        let mut steps = Vec::with_capacity(bound.coedges.len());
        for coedge in &bound.coedges {
            steps.push(self.step(face, coedge)?);
        }
        if as_face == Direction::Against {
            steps.reverse();
            for step in &mut steps {
                step.forward = !step.forward;
            }
        }
        Ok(steps)
    }

    fn step(&self, face: Option<FaceId>, coedge: &NewCoedge) -> Result<Step, LowerError> {
        let (piece, source) = match coedge.edge {
            EdgeRef::Kept(edge) => (self.piece_now(edge), Some(edge)),
            EdgeRef::New(edge) => {
                let new = &self.changes.new_edges[edge];
                let (curve, source) = match &new.curve {
                    EdgeCurve::Own(curve) => (Some(curve.clone()), None),
                    EdgeCurve::Of(old) => (self.piece_now(*old).map(|piece| piece.curve), Some(*old)),
                };
                let end = (new.start != new.end).then(|| self.point_of(new.end));
                (curve.and_then(|curve| between(&curve, self.point_of(new.start), end)), source)
            }
        };
        let piece = piece.ok_or_else(|| LowerError::ForeignOrigin { origin: "a new edge".to_owned() })?;
        let of_old = || face.zip(source).and_then(|(face, edge)| self.pcurve_of(face, edge));
        let pcurve = coedge.pcurve.clone().or_else(of_old);
        Ok(Step { edge: coedge.edge, forward: coedge.forward, piece, pcurve })
    }

    /// The curve that an edge of the model has in the parameters of a face.
    fn pcurve_of(&self, face: FaceId, edge: EdgeId) -> Option<Curve2d> {
        let mut uses = self.model.brep.coedges_of(face);
        let found = uses.find(|coedge| self.model.brep.coedges[*coedge].edge == edge);
        found.and_then(|coedge| self.pcurve_now(coedge))
    }

    pub(super) fn point_of(&self, vertex: VertexRef) -> Point3<f64> {
        match vertex {
            VertexRef::New(vertex) => self.changes.new_vertices[vertex],
            VertexRef::Kept(vertex) => {
                let old = || self.model.brep.vertices[vertex].point;
                self.changes.points.get(&vertex).copied().unwrap_or_else(old)
            }
        }
    }

    /// A new curve of a step, run as the file has the bound when `along` is the bound's, else as the edge.
    pub(super) fn add_step_curve(
        &mut self,
        ground: &Ground,
        step: &Step,
        along: Along,
        within: &Affine,
    ) -> Result<EntryNumber, LowerError> {
        let entry = self.entry(ground.face)?;
        let turned = along == Along::Bound && !step.forward;
        let piece =
            if turned { super::compose_curve::reversed(step.piece.clone()) } else { step.piece.clone() };
        let kind = piece.curve.kind();
        let piece = in_space(piece, within).ok_or(LowerError::Unwritable { number: ground.face, kind })?;
        self.add_curve(ground.face, &piece, Look::part(&entry))
    }

    /// The same in the parameters of the surface; `None` where the step has no such curve.
    pub(super) fn add_step_pcurve(
        &mut self,
        ground: &Ground,
        step: &Step,
        along: Along,
    ) -> Result<Option<EntryNumber>, LowerError> {
        let Some(curve) = step.pcurve.clone() else { return Ok(None) };
        let unwritable = LowerError::Unwritable { number: ground.face, kind: curve.kind() };
        let own = super::lift::in_file(&Piece2d { curve, range: step.piece.range }, &ground.map_now);
        let turned = along == Along::Bound && !step.forward;
        let own = own.and_then(|own| if turned { pcurve::reversed(&own) } else { Some(own) });
        let Some(piece) = own.and_then(|own| super::lift::lifted(&own)) else { return Err(unwritable) };
        let entry = self.entry(ground.face)?;
        self.add_curve(ground.face, &piece, Look::in_parameters(&entry)).map(Some)
    }

    pub(super) fn entry(&self, number: EntryNumber) -> Result<super::super::DirectoryEntry, LowerError> {
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        Ok(*instance.entry())
    }

    /// The ground of a new face: its surface is new, in the space of the face that it stands beside.
    pub(super) fn new_ground(&mut self, face: &NewFace, beside: &Ground) -> Result<Ground, LowerError> {
        let entry = self.entry(beside.face)?;
        let (record, map) = self.new_surface_record(face, beside)?;
        let surface = self.draft.add(&record, Look::part(&entry), &[])?;
        Ok(Ground { surface, surface_now: surface, map, map_now: map, ..beside.clone() })
    }

    pub(super) fn body_of(&self, face: FaceId) -> BodyId {
        self.model.brep.shells[self.model.brep.faces[face].shell].body
    }

    /// Several curves as one.
    pub(super) fn composite(
        &mut self,
        ground: &Ground,
        members: &[EntryNumber],
        look: Look<'_>,
    ) -> Result<EntryNumber, LowerError> {
        use super::record::Value;
        if let [only] = members {
            return Ok(*only);
        }
        if members.is_empty() {
            return Err(LowerError::Unreadable { number: ground.face, reason: "a bound is empty".into() });
        }
        let record = Record::new(super::super::Entity::CompositeCurve.number(), 0);
        let record = record.values([Value::count(members.len())]);
        let record = record.values(members.iter().map(|number| Value::to(*number)));
        self.draft.add(&record, look, &[])
    }
}

/// Whether the file has a bound in the direction of the model's, or against it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    Along,
    Against,
}

/// What the curve of a step runs along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    Bound,
    Edge,
}
