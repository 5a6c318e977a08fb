//! What every reader of the model needs: the file, its resolution, and the matrices of its entities.

use std::cell::RefCell;
use std::collections::HashMap;

use super::error::ReadError;
use super::transformation;
use crate::iges::view::{EntityView, FieldError};
use crate::iges::{Entity, EntryNumber, ExchangeStructure, Fields, Instance, schema};
use crate::math::Affine;

/// Entities within entities that are followed before the chain counts as a cycle.
pub(in crate::iges) const MAX_DEPTH: usize = 32;
/// Parts that one piece of geometry may be made of.
pub(in crate::iges) const MAX_PARTS: usize = 100_000;

/// The file and what is known of all of it.
pub(in crate::iges) struct Scope<'a> {
    pub(in crate::iges) file: &'a ExchangeStructure,
    /// Distance below which points are one, in file units.
    pub(in crate::iges) resolution: f64,
    matrices: RefCell<HashMap<EntryNumber, Result<Affine, ReadError>>>,
}

impl<'a> Scope<'a> {
    pub(in crate::iges) fn new(file: &'a ExchangeStructure, resolution: f64) -> Self {
        Self { file, resolution, matrices: RefCell::default() }
    }

    pub(in crate::iges) fn instance(&self, number: EntryNumber) -> Result<Instance<'a>, ReadError> {
        self.file.instance(number).ok_or(ReadError::Dangling(number))
    }

    /// The view of an entity.
    pub(in crate::iges) fn view(&self, number: EntryNumber) -> Result<EntityView<'a>, ReadError> {
        EntityView::of(self.instance(number)?).ok_or(ReadError::NotReadYet)
    }

    /// The view of an entity that must be of a type.
    pub(in crate::iges) fn view_of(
        &self,
        number: EntryNumber,
        entity: Entity,
        expected: &'static str,
    ) -> Result<EntityView<'a>, ReadError> {
        let instance = self.instance(number)?;
        if kind(instance) != Some(entity) {
            return Err(ReadError::WrongEntity { number, found: name(instance), expected });
        }
        self.view(number)
    }

    /// Name of an entity's type; empty when the file does not have it.
    pub(in crate::iges) fn name(&self, number: EntryNumber) -> &'static str {
        self.file.instance(number).map(name).unwrap_or_default()
    }

    /// The matrix of an entity's own directory entry.
    pub(in crate::iges) fn matrix(&self, instance: Instance<'a>) -> Result<Affine, ReadError> {
        let pointer = instance.entry().transformation;
        let Some(number) = EntryNumber::from_pointer(pointer.into()) else { return Ok(Affine::identity()) };
        if let Some(known) = self.matrices.borrow().get(&number) {
            return known.clone();
        }
        let matrix = transformation::chain(self, number);
        self.matrices.borrow_mut().insert(number, matrix.clone());
        matrix
    }

    /// The matrix of an entity within those of what it is a part of.
    pub(in crate::iges) fn placed(
        &self,
        instance: Instance<'a>,
        within: &Affine,
    ) -> Result<Affine, ReadError> {
        let own = self.matrix(instance)?;
        Ok(if own.is_identity() { *within } else { within.after(&own) })
    }
}

/// Type of an entity.
pub(in crate::iges) fn kind(instance: Instance<'_>) -> Option<Entity> {
    Entity::from_type(instance.entry().entity_type)
}

/// Name of an entity's type, or `entity` for one that the table does not have.
pub(in crate::iges) fn name(instance: Instance<'_>) -> &'static str {
    let entry = instance.entry();
    schema::row(entry.entity_type, entry.form).map_or("entity", |row| row.name)
}

/// A field as a count of things that a file may have.
pub(in crate::iges) fn small(
    fields: &Fields<'_>,
    field: &'static str,
    most: usize,
) -> Result<usize, ReadError> {
    let count = fields.count(field)?;
    if count > most {
        let expected = format!("at most {most}");
        return Err(FieldError { field, found: count.to_string(), expected }.into());
    }
    Ok(count)
}
