//! Bounds and faces of trimmed and bounded surfaces that come and go.

use std::collections::BTreeSet;

use super::super::{Entity, EntryNumber};
use super::draft::{self, Look};
use super::record::{Matrix, Record, Value};
use super::slot::{missing, slot, slots, unreadable};
use super::topology::{Along, Direction};
use super::{Ground, LowerError, Lowering, entry_of};
use crate::brep::FaceId;
use crate::iges::to_model::scope::kind;
use crate::model::change_set::{NewBound, NewFace};

/// Preference of a boundary whose curves in both spaces are equal.
const BOTH: i64 = 3;
/// Preference of a boundary's curves in space.
const IN_SPACE: i64 = 2;

impl Lowering<'_> {
    /// Numbers of the bounds of a face that go.
    pub(super) fn removed_of(&self, face: FaceId) -> Result<BTreeSet<EntryNumber>, LowerError> {
        let loops = self.model.brep.faces[face].loops.iter();
        let gone = loops.filter(|of| self.changes.removed_bounds.contains(of));
        gone.map(|of| entry_of(self.model.origins.loops[*of])).collect()
    }

    pub(super) fn bounds_of_loose_face(
        &mut self,
        face: FaceId,
        ground: &Ground,
        bounds: &[NewBound],
    ) -> Result<(), LowerError> {
        let number = ground.face;
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        match kind(instance) {
            Some(Entity::TrimmedSurface) => self.bounds_of_trimmed(face, ground, bounds),
            Some(Entity::BoundedSurface) => self.bounds_of_bounded(face, ground, bounds),
            Some(Entity::Plane) => {
                Err(LowerError::Unwritable { number, kind: "bounded plane with another bound" })
            }
            _ => self.trim(face, ground, bounds),
        }
    }

    fn bounds_of_trimmed(
        &mut self,
        face: FaceId,
        ground: &Ground,
        bounds: &[NewBound],
    ) -> Result<(), LowerError> {
        let number = ground.face;
        let view = self.view(number)?;
        let fields = view.fields();
        let gone = self.removed_of(face)?;
        let outer = slot(number, fields, "outer").filter(|slot| gone.contains(&slot.target));
        let behind = fields.list("inner").last().or_else(|| fields.get("outer"));
        let behind = behind.ok_or_else(|| missing(number, "outer"))?;
        for bound in bounds {
            let boundary = self.curve_on_surface(Some(face), ground, bound)?;
            match outer.filter(|_| bound.outer) {
                Some(outer) => {
                    self.draft.repoint(&outer, boundary);
                    self.replaced.insert(outer.target);
                }
                None if bound.outer => {
                    return Err(LowerError::NaturalBounds { number, change: "replaced" });
                }
                None => self.draft.list(number, &behind, &[Value::to(boundary)], "inner_count"),
            }
        }
        Ok(())
    }

    fn bounds_of_bounded(
        &mut self,
        face: FaceId,
        ground: &Ground,
        bounds: &[NewBound],
    ) -> Result<(), LowerError> {
        let number = ground.face;
        let view = self.view(number)?;
        let fields = view.fields();
        let last = fields.list("boundaries").last().ok_or_else(|| missing(number, "boundaries"))?;
        let kind = fields.integer("kind").unwrap_or(0);
        for bound in bounds {
            let boundary = self.boundary_of(Some(face), ground, bound, kind)?;
            self.draft.list(number, &last, &[Value::to(boundary)], "count");
        }
        Ok(())
    }

    /// Makes a surface within its own bounds the ground of a trimmed one.
    fn trim(&mut self, face: FaceId, ground: &Ground, bounds: &[NewBound]) -> Result<(), LowerError> {
        let number = ground.face;
        if bounds.iter().any(|bound| bound.outer) {
            return Err(LowerError::NaturalBounds { number, change: "replaced" });
        }
        let mut inner = Vec::new();
        for bound in bounds {
            inner.push(Value::to(self.curve_on_surface(Some(face), ground, bound)?));
        }
        let entry = self.entry(number)?;
        let record = Record::new(Entity::TrimmedSurface.number(), 0).pointer(ground.surface_now);
        let record = record.values([Value::Integer(0), Value::count(inner.len()), Value::Pointer(None)]);
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let trimmed = self.draft.add(&record.values(inner), Look::same(&entry), &draft::behind(instance))?;
        let status = super::super::Status { subordinate: 1, ..entry.status };
        self.draft.set_status(number, status);
        for gatherer in self.draft.gatherers(number) {
            let view = self.view(gatherer)?;
            for slot in slots(gatherer, view.fields(), "members") {
                if slot.target == number {
                    self.draft.repoint(&slot, trimmed);
                }
            }
        }
        Ok(())
    }

    /// A new curve on a parametric surface: its curves run along the bound.
    fn curve_on_surface(
        &mut self,
        face: Option<FaceId>,
        ground: &Ground,
        bound: &NewBound,
    ) -> Result<EntryNumber, LowerError> {
        let (space, plane) = self.bound_curves(face, ground, bound)?;
        let entry = self.entry(ground.face)?;
        let curve = self.composite(ground, &space, Look::part(&entry))?;
        let pcurve = match plane.is_empty() {
            true => None,
            false => Some(self.composite(ground, &plane, Look::in_parameters(&entry))?),
        };
        let preference = if pcurve.is_some() { BOTH } else { IN_SPACE };
        let record = Record::new(Entity::CurveOnSurface.number(), 0).values([
            Value::Integer(0),
            Value::to(ground.surface_now),
            Value::Pointer(pcurve),
            Value::to(curve),
            Value::Integer(preference),
        ]);
        self.draft.add(&record, Look::part(&entry), &[])
    }

    /// Curves of a bound in space, and in parameters where each has one there.
    fn bound_curves(
        &mut self,
        face: Option<FaceId>,
        ground: &Ground,
        bound: &NewBound,
    ) -> Result<(Vec<EntryNumber>, Vec<EntryNumber>), LowerError> {
        let steps = self.steps(face, bound, Direction::Along)?;
        let has_parameters = !ground.read.parameters.is_empty() || face.is_none();
        let all_flat = has_parameters && steps.iter().all(|step| step.pcurve.is_some());
        let (mut space, mut plane) = (Vec::new(), Vec::new());
        for step in &steps {
            space.push(self.add_step_curve(ground, step, Along::Bound, &ground.within)?);
            if all_flat {
                plane.extend(self.add_step_pcurve(ground, step, Along::Bound)?);
            }
        }
        Ok((space, plane))
    }

    /// A new boundary of a bounded surface.
    fn boundary_of(
        &mut self,
        face: Option<FaceId>,
        ground: &Ground,
        bound: &NewBound,
        kind: i64,
    ) -> Result<EntryNumber, LowerError> {
        let (space, plane) = self.bound_curves(face, ground, bound)?;
        if kind != 0 && plane.is_empty() {
            let kind = "bound without curves in the parameters of its surface";
            return Err(LowerError::Unwritable { number: ground.face, kind });
        }
        let plane = if kind == 0 { Vec::new() } else { plane };
        let preference = if plane.is_empty() { 1 } else { BOTH };
        let record = Record::new(Entity::Boundary.number(), 0).values([
            Value::Integer(kind),
            Value::Integer(preference),
            Value::to(ground.surface_now),
            Value::count(space.len()),
        ]);
        let member = |at: usize| {
            let flat = plane.get(at).map(|number| Value::to(*number));
            let head = [Value::to(space[at]), Value::Integer(1), Value::Integer(i64::from(flat.is_some()))];
            head.into_iter().chain(flat)
        };
        let record = record.values((0..space.len()).flat_map(member).collect::<Vec<_>>());
        let entry = self.entry(ground.face)?;
        self.draft.add(&record, Look::part(&entry), &[])
    }

    pub(super) fn new_loose_face(&mut self, face: &NewFace, beside: &Ground) -> Result<(), LowerError> {
        let ground = self.new_ground(face, beside)?;
        let mut boundaries = Vec::new();
        for bound in &face.bounds {
            let boundary = Value::to(self.curve_on_surface(None, &ground, bound)?);
            let at = if bound.outer { 0 } else { boundaries.len() };
            boundaries.insert(at, boundary);
        }
        let number = beside.face;
        let entry = self.entry(number)?;
        let inner = boundaries.len().saturating_sub(1);
        let record = Record::new(Entity::TrimmedSurface.number(), 0).pointer(ground.surface_now);
        let mut record = record.values([Value::Integer(1), Value::count(inner)]).values(boundaries);
        if !beside.within.is_identity() {
            record.matrix = Matrix::New(beside.within);
        }
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let new = self.draft.add(&record, Look::same(&entry), &draft::behind(instance))?;
        for gatherer in self.draft.gatherers(number) {
            let view = self.view(gatherer)?;
            if let Some(last) = view.fields().list("members").last() {
                self.draft.list(gatherer, &last, &[Value::to(new)], "count");
            }
        }
        Ok(())
    }

    pub(super) fn remove_from_gatherer(
        &mut self,
        gatherer: EntryNumber,
        number: EntryNumber,
    ) -> Result<(), LowerError> {
        let view = self.view(gatherer)?;
        for slot in slots(gatherer, view.fields(), "members") {
            if slot.target == number {
                self.draft.unlist(&slot, 0, "count");
            }
        }
        Ok(())
    }
}
