//! Sheets as trimmed surfaces (IGES 5.3 sections 4.32 and 4.34), each face with curves of its own.

use super::super::lower::record::{Record, Value};
use super::super::{Entity, EntryNumber};
use super::{FromModelError, Rank, Writer};
use crate::brep::{BodyId, FaceId, LoopId};
use crate::geometry::Surface;
use crate::model::Loss;

/// A boundary whose curve in space is to be believed.
const SPACE: i64 = 2;
/// Form of a group whose members do not point back.
const GROUP: i32 = 7;

impl Writer<'_, '_> {
    /// Writes the faces of a body; several are a group with its name. What is listed for the body comes back.
    pub(super) fn trimmed(&mut self, body: BodyId, rank: Rank) -> Result<Vec<EntryNumber>, FromModelError> {
        let brep = &self.model.brep;
        let faces: Vec<FaceId> =
            brep.bodies[body].shells.iter().flat_map(|&shell| brep.shells[shell].faces.clone()).collect();
        let mut numbers = Vec::with_capacity(faces.len());
        for &face in &faces {
            numbers.push(self.trimmed_face(face, rank)?);
        }
        if numbers.len() > 1 {
            let record = Record::new(Entity::Associativity.number(), GROUP);
            let record = record.values([Value::count(numbers.len())]);
            let record = record.values(numbers.iter().map(|&number| Value::to(number)));
            let behind = self.named(&self.model.bodies[body].own.name)?;
            self.add_as(&record, &super::DirectoryEntry::default(), Rank::Own, &behind)?;
        }
        Ok(numbers)
    }

    fn trimmed_face(&mut self, face: FaceId, rank: Rank) -> Result<EntryNumber, FromModelError> {
        let of = &self.model.brep.faces[face];
        let origin = self.model.origins.faces[face];
        let read = self.model.brep.surface_of(face).read().ok_or(FromModelError::Unread { origin })?;
        let shell = self.model.brep.shells[of.shell].forward;
        // A trimmed surface has the normal of its surface.
        let turned = of.same_sense != shell;
        let (surface, along) = match read {
            Surface::Nurbs(spline) if turned => {
                (self.surface_of(face, &Surface::Nurbs(spline.reversed_u()))?, false)
            }
            _ => (self.surface_of(face, read)?, true),
        };
        let (number, map) = surface;
        let by_file = of.same_sense != (map.linear.determinant() < 0.0);
        let sense = if along { by_file } else { !by_file };
        if sense != shell {
            Loss::Side.report(origin, "which of its sides is the outer one", self.sink);
        }
        let bounds: Vec<LoopId> = of.loops.clone();
        let mut outer = None;
        let mut inner = Vec::new();
        for bound in bounds {
            if self.model.brep.loops[bound].coedges.is_empty() {
                continue;
            }
            let boundary = self.boundary(bound, sense, number)?;
            if self.model.brep.loops[bound].outer && outer.is_none() {
                outer = Some(boundary);
            } else {
                inner.push(boundary);
            }
        }
        if outer.is_none() && !inner.is_empty() {
            outer = Some(inner.remove(0));
        }
        let record = Record::new(Entity::TrimmedSurface.number(), 0).pointer(number);
        let record = record.values([Value::flag(outer.is_some()), Value::count(inner.len())]);
        let record = record.values([Value::Pointer(outer)]).values(inner.into_iter().map(Value::to));
        let (entry, behind) = self.look_of_loose_face(face)?;
        self.add_as(&record, &entry, rank, &behind)
    }

    fn boundary(
        &mut self,
        bound: LoopId,
        sense: bool,
        surface: EntryNumber,
    ) -> Result<EntryNumber, FromModelError> {
        let of = &self.model.brep.loops[bound];
        let along = of.forward == sense;
        let mut coedges = of.coedges.clone();
        if !along {
            coedges.reverse();
        }
        let mut members = Vec::with_capacity(coedges.len());
        for coedge in coedges {
            let piece = self.along(coedge)?;
            let piece = if along { piece } else { super::super::lower::compose_curve::reversed(piece) };
            let edge = self.model.brep.coedges[coedge].edge;
            members.push(self.curve(&piece, self.model.origins.edges[edge])?);
        }
        let curve = match members.as_slice() {
            [only] => *only,
            _ => {
                let record = Record::new(Entity::CompositeCurve.number(), 0);
                let record = record.values([Value::count(members.len())]);
                self.add(&record.values(members.into_iter().map(Value::to)), Rank::Part)?
            }
        };
        let record = Record::new(Entity::CurveOnSurface.number(), 0).values([Value::Integer(0)]);
        let record = record.pointer(surface).values([Value::Pointer(None)]).pointer(curve);
        self.add(&record.values([Value::Integer(SPACE)]), Rank::Part)
    }
}
