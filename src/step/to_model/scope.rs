//! What reading of one record needs: the file, and the angle unit of its context.
//!
//! Reports nothing and keeps nothing.

use std::cell::Cell;

use super::code::ModelCode;
use super::error::ReadError;
use crate::diagnostic::Sink;
use crate::step::entity::Entity;
use crate::step::schema;
use crate::step::view::EntityView;
use crate::step::{ExchangeStructure, Instance, InstanceName};

/// Habits of the file that are worth one warning, with the first record that shows each.
#[derive(Default)]
pub(super) struct Habits {
    /// Coordinates without a point.
    pub(super) integer: Cell<Option<InstanceName>>,
    /// Coordinates with a lower-case exponent.
    pub(super) exponent: Cell<Option<InstanceName>>,
}

impl Habits {
    /// Reports what was seen.
    pub(super) fn report(&self, file: &ExchangeStructure, sink: &mut dyn Sink) {
        if let Some(name) = self.integer.get() {
            let message = "an integer where a real is required; this is said once for a file".to_owned();
            sink.report(ModelCode::IntegerForReal.at(file, name, message));
        }
        if let Some(name) = self.exponent.get() {
            let message = "a real with a lower-case exponent; this is said once for a file".to_owned();
            sink.report(ModelCode::LowerCaseExponent.at(file, name, message));
        }
    }
}

/// The file and the angle unit that its numbers are in.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// Where unusual spelling is noted.
    pub(super) habits: &'a Habits,
    /// The file.
    pub(super) file: &'a ExchangeStructure,
    /// Radians per angle unit of the context.
    pub(super) radians: f64,
}

impl<'a> Scope<'a> {
    /// The record of a name.
    pub(super) fn instance(&self, name: InstanceName) -> Result<Instance<'a>, ReadError> {
        self.file.instance(name).ok_or(ReadError::Dangling(name))
    }

    /// The view of a name, whatever its entity.
    pub(super) fn view(&self, name: InstanceName) -> Result<EntityView<'a>, ReadError> {
        let instance = self.instance(name)?;
        EntityView::of(instance).ok_or(ReadError::NotReadYet)
    }

    /// The view of a name that must be of an entity or one of its subtypes.
    pub(super) fn view_of(&self, name: InstanceName, expected: Entity) -> Result<EntityView<'a>, ReadError> {
        let instance = self.instance(name)?;
        match EntityView::of(instance).filter(|view| view.is(expected)) {
            Some(view) => Ok(view),
            None => {
                Err(ReadError::WrongEntity { name, found: entity_name(instance), expected: expected.name() })
            }
        }
    }
}

/// The keyword of an instance in upper case; for a complex one its deepest known partial type, or else its
/// first.
pub(super) fn entity_name(instance: Instance<'_>) -> String {
    let keyword = match EntityView::of(instance) {
        Some(view) => return view.entity().name().to_owned(),
        None => instance.records().next().map(|record| record.keyword()).unwrap_or_default(),
    };
    debug_assert!(schema::classify(keyword).is_none());
    String::from_utf8_lossy(keyword).to_ascii_uppercase()
}
