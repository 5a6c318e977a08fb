//! Pointers in the file: where each stands, and what leads to a curve from the entity that a face is.

use super::super::parameter::Place;
use super::super::{Entity, EntityView, EntryNumber, Fields};
use super::{LowerError, Lowering};
use crate::iges::to_model::scope::{MAX_DEPTH, kind};
use crate::math::Affine;

/// A parameter that is a pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Slot {
    /// Entity whose parameter it is.
    pub(super) owner: EntryNumber,
    pub(super) place: Place,
    /// Entity that it points to.
    pub(super) target: EntryNumber,
}

/// A curve of a face's boundary, and the pointers that lead there from the face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaf {
    pub(super) chain: Vec<Slot>,
    pub(super) number: EntryNumber,
    /// From the space in which the curve's entity stands, by its own matrix, to that of the model.
    pub(super) within: Affine,
}

/// The curves of a loose face's boundaries.
#[derive(Debug, Clone, Default)]
pub(super) struct Leaves {
    /// In space.
    pub(super) space: Vec<Leaf>,
    /// In the parameters of the surface.
    pub(super) plane: Vec<Leaf>,
    /// Chains to the surface, from the boundaries.
    pub(super) surface: Vec<Vec<Slot>>,
}

/// The pointer of a field, if it is set.
pub(super) fn slot(owner: EntryNumber, fields: &Fields<'_>, field: &str) -> Option<Slot> {
    let parameter = fields.get(field)?;
    Some(Slot { owner, place: parameter.start(), target: parameter.as_pointer()? })
}

/// The pointers of a list.
pub(super) fn slots(owner: EntryNumber, fields: &Fields<'_>, field: &str) -> Vec<Slot> {
    let pointer = |parameter: super::super::Parameter<'_>| {
        Some(Slot { owner, place: parameter.start(), target: parameter.as_pointer()? })
    };
    fields.list(field).filter_map(pointer).collect()
}

impl<'a> Lowering<'a> {
    pub(super) fn view(&self, number: EntryNumber) -> Result<EntityView<'a>, LowerError> {
        self.scope.view(number).map_err(|error| unreadable(number, &error))
    }

    /// The slot of a field that must be set.
    pub(super) fn slot(&self, number: EntryNumber, field: &'static str) -> Result<Slot, LowerError> {
        let view = self.view(number)?;
        slot(number, view.fields(), field).ok_or_else(|| missing(number, field))
    }

    /// The boundaries of a loose face, the outer one first.
    pub(super) fn boundaries(&self, face: EntryNumber) -> Result<Vec<Slot>, LowerError> {
        let view = self.view(face)?;
        let fields = view.fields();
        Ok(match Entity::from_type(view.instance().entry().entity_type) {
            Some(Entity::TrimmedSurface) => {
                let outer = fields.integer("outer_given").unwrap_or(0) != 0;
                let outer = if outer { slot(face, fields, "outer") } else { None };
                outer.into_iter().chain(slots(face, fields, "inner")).collect()
            }
            Some(Entity::BoundedSurface) => slots(face, fields, "boundaries"),
            Some(Entity::Plane) => slot(face, fields, "boundary").into_iter().collect(),
            _ => Vec::new(),
        })
    }

    /// Everything that the boundaries of a loose face consist of.
    pub(super) fn leaves(&self, face: EntryNumber, within: &Affine) -> Result<Leaves, LowerError> {
        let mut found = Leaves::default();
        for boundary in self.boundaries(face)? {
            self.leaves_of_boundary(&[boundary], within, &mut found)?;
        }
        Ok(found)
    }

    fn leaves_of_boundary(
        &self,
        chain: &[Slot],
        within: &Affine,
        found: &mut Leaves,
    ) -> Result<(), LowerError> {
        let Some(number) = chain.last().map(|slot| slot.target) else { return Ok(()) };
        let view = self.view(number)?;
        let fields = view.fields();
        let placed =
            self.scope.placed(view.instance(), within).map_err(|error| unreadable(number, &error))?;
        let longer = |slot: Slot| [chain, &[slot]].concat();
        match kind(view.instance()) {
            Some(Entity::CurveOnSurface) => {
                found.surface.extend(slot(number, fields, "surface").map(longer));
                if let Some(curve) = slot(number, fields, "curve") {
                    self.walk(longer(curve), &placed, &mut found.space)?;
                }
                if let Some(curve) = slot(number, fields, "pcurve") {
                    self.walk(longer(curve), &Affine::identity(), &mut found.plane)?;
                }
            }
            Some(Entity::Boundary) => {
                found.surface.extend(slot(number, fields, "surface").map(longer));
                for curve in fields.group("curves").unwrap_or_default() {
                    if let Some(space) = slot(number, &curve, "curve") {
                        self.walk(longer(space), &placed, &mut found.space)?;
                    }
                    for flat in slots(number, &curve, "pcurves") {
                        self.walk(longer(flat), &Affine::identity(), &mut found.plane)?;
                    }
                }
            }
            // A plane is bounded by a curve alone; its own matrix is the leaf's business.
            _ => self.walk(chain.to_vec(), within, &mut found.space)?,
        }
        Ok(())
    }

    /// Goes down through composites to the curves that are none.
    fn walk(&self, chain: Vec<Slot>, within: &Affine, found: &mut Vec<Leaf>) -> Result<(), LowerError> {
        let Some(number) = chain.last().map(|slot| slot.target) else { return Ok(()) };
        let Ok(instance) = self.scope.instance(number) else { return Ok(()) };
        if kind(instance) != Some(Entity::CompositeCurve) || chain.len() > MAX_DEPTH {
            found.push(Leaf { chain, number, within: *within });
            return Ok(());
        }
        let placed = self.scope.placed(instance, within).map_err(|error| unreadable(number, &error))?;
        let view = self.view(number)?;
        for member in slots(number, view.fields(), "curves") {
            self.walk([chain.as_slice(), &[member]].concat(), &placed, found)?;
        }
        Ok(())
    }
}

pub(super) fn unreadable(number: EntryNumber, reason: &impl ToString) -> LowerError {
    LowerError::Unreadable { number, reason: reason.to_string() }
}

pub(super) fn missing(number: EntryNumber, field: &'static str) -> LowerError {
    LowerError::Unreadable { number, reason: format!("{field} is missing") }
}
