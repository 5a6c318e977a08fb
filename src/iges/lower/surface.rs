//! Surfaces of faces: edited in place, or given to those faces that ask for another.

use std::collections::{BTreeMap, BTreeSet};

use super::super::EntryNumber;
use super::draft::Look;
use super::slot::{Slot, slot};
use super::{LowerError, Lowering};
use crate::brep::FaceId;
use crate::geometry::Surface;

impl Lowering<'_> {
    /// Decides the surfaces of all changed faces.
    pub(super) fn surfaces(&mut self) -> Result<(), LowerError> {
        let mut faces: BTreeMap<EntryNumber, Vec<FaceId>> = BTreeMap::new();
        for &face in self.changes.surfaces.keys() {
            if !self.changes.removed_faces.contains(&face) {
                let surface = self.ground(face)?.surface;
                faces.entry(surface).or_default().push(face);
            }
        }
        for (surface, faces) in faces {
            self.decide_surface(surface, &faces)?;
        }
        Ok(())
    }

    fn decide_surface(&mut self, number: EntryNumber, faces: &[FaceId]) -> Result<(), LowerError> {
        let mut wanted: Vec<(FaceId, Surface, Vec<Vec<Slot>>)> = Vec::new();
        for &face in faces {
            let ground = self.ground(face)?.clone();
            let local = self.in_own_space(&ground, &self.changes.surfaces[&face])?;
            wanted.push((face, local, self.surface_chains(&ground)?));
        }
        let natural = wanted.iter().any(|(.., chains)| chains.is_empty());
        let asked: BTreeSet<Slot> =
            wanted.iter().flat_map(|(.., chains)| chains).filter_map(|chain| chain.last().copied()).collect();
        let agree = wanted.iter().all(|(_, local, _)| *local == wanted[0].1);
        let private = wanted.iter().flat_map(|(.., chains)| chains).all(|chain| self.is_private(chain));
        let covered = private && self.draft.use_count(number) == asked.len();
        if natural && !(agree && covered) {
            return Err(LowerError::Conflict { number });
        }
        if agree && covered {
            return self.edit_surface(number, faces, &wanted[0].1);
        }
        let mut made: Vec<(Surface, FaceId, EntryNumber)> = Vec::new();
        for (face, local, chains) in wanted {
            let known = made.iter().find(|(other, ..)| *other == local).map(|(_, first, to)| (*first, *to));
            let to = match known {
                Some((first, to)) => {
                    let map_now = self.ground(first)?.map_now;
                    self.ground(face)?.map_now = map_now;
                    to
                }
                None => {
                    let to = self.own_surface(number, face, &local)?;
                    made.push((local, face, to));
                    to
                }
            };
            self.ground(face)?.surface_now = to;
            for chain in &chains {
                self.retarget(chain, to)?;
            }
        }
        Ok(())
    }

    fn edit_surface(
        &mut self,
        number: EntryNumber,
        faces: &[FaceId],
        local: &Surface,
    ) -> Result<(), LowerError> {
        let ground = self.ground(faces[0])?.clone();
        let (record, map_now) = self.surface_record(&ground, faces[0], local, Some(number))?;
        let old = self.old_surface_record(&ground);
        self.draft.put(number, record, old.as_ref())?;
        for &face in faces {
            self.ground(face)?.map_now = map_now;
            self.without_stale_pcurves(face)?;
        }
        Ok(())
    }

    fn own_surface(
        &mut self,
        old: EntryNumber,
        face: FaceId,
        local: &Surface,
    ) -> Result<EntryNumber, LowerError> {
        let ground = self.ground(face)?.clone();
        let (mut record, map_now) = self.surface_record(&ground, face, local, None)?;
        if !ground.own.is_identity() {
            record.matrix = super::record::Matrix::New(ground.own);
        }
        let entry = *self.scope.instance(old).map_err(|e| super::slot::unreadable(old, &e))?.entry();
        let to = self.draft.add(&record, Look::same(&entry), &[])?;
        self.ground(face)?.map_now = map_now;
        self.without_stale_pcurves(face)?;
        Ok(to)
    }

    /// Curves in the parameters of a surface that had none mean nothing; beside a surface that has parameters, they would.
    fn without_stale_pcurves(&mut self, face: FaceId) -> Result<(), LowerError> {
        let ground = self.ground(face)?.clone();
        let has_parameters = !matches!(self.changes.surfaces[&face], Surface::Plane(_));
        if !ground.read.parameters.is_empty() || !has_parameters {
            return Ok(());
        }
        for chain in &ground.leaves.surface {
            let Some(boundary) = chain.last().map(|slot| slot.owner) else { continue };
            let view = self.view(boundary)?;
            if let Some(pcurve) = slot(boundary, view.fields(), "pcurve") {
                self.draft.clear(&pcurve);
                if let Some(preference) = view.fields().get("preference") {
                    self.draft.set(boundary, &preference, super::record::Value::Integer(IN_SPACE));
                }
            }
        }
        Ok(())
    }

    /// A surface of the model in the space of its entity.
    pub(super) fn in_own_space(
        &self,
        ground: &super::Ground,
        surface: &Surface,
    ) -> Result<Surface, LowerError> {
        let placed = ground.placed();
        if placed.is_identity() {
            return Ok(surface.clone());
        }
        let back = placed.inverse().and_then(|back| surface.transformed(&back).ok());
        back.ok_or(LowerError::Unwritable { number: ground.surface, kind: surface.kind() })
    }

    /// Turns the last pointer of a chain for the sake of the face that it begins at; what others use too on the way is
    /// copied.
    pub(super) fn retarget(&mut self, chain: &[Slot], to: EntryNumber) -> Result<(), LowerError> {
        let Some((last, way)) = chain.split_last() else { return Ok(()) };
        let Some(top) = chain.first().map(|slot| slot.owner) else { return Ok(()) };
        // The entity that has the pointers of the original by now.
        let mut owner = None;
        for step in way {
            let copy = self.copies.get(&(top, step.target)).copied();
            let shared = owner.is_some() || self.draft.use_count(step.target) > 1;
            if shared && copy.is_none() {
                let copy = self.draft.copy(step.target)?;
                self.copies.insert((top, step.target), copy);
                match owner {
                    Some(owner) => self.draft.repoint_copy(owner, step, copy),
                    None => self.draft.repoint(step, copy),
                }
                owner = Some(copy);
            } else {
                owner = copy;
            }
        }
        match owner {
            Some(copy) => self.draft.repoint_copy(copy, last, to),
            None => self.draft.repoint(last, to),
        }
        Ok(())
    }

    /// Whether everything on the way of a chain is of one face alone.
    pub(super) fn is_private(&mut self, chain: &[Slot]) -> bool {
        let Some((_, way)) = chain.split_last() else { return true };
        way.iter().all(|step| self.draft.use_count(step.target) == 1)
    }
}

/// Preference of a boundary's curves in space.
const IN_SPACE: i64 = 2;
