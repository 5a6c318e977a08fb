//! Who points to whom, the other way round.
//!
//! One compressed table over the whole file, built on demand. Of an entity whose parameters the schema does not know, every
//! number that could be a pointer counts as one: what it may use is not to be taken away.

use super::directory_entry::EntryNumber;
use super::exchange_structure::{ExchangeStructure, Instance};
use super::view::EntityView;
use super::{Code, Entity};
use crate::diagnostic::Sink;
use crate::exchange::Users;

/// Users of each entity, by position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReverseIndex(Users);

impl ReverseIndex {
    /// Builds the table. Linear in the file.
    #[must_use]
    pub fn build(structure: &ExchangeStructure) -> Self {
        let mut uses: Vec<(u32, u32)> = Vec::new();
        for instance in structure.instances() {
            let targets = pointers(instance).into_iter().filter_map(|number| structure.position(number));
            uses.extend(targets.map(|target| (target, instance.position())));
        }
        Self(Users::of(structure.len(), |found| uses.iter().for_each(|&(target, user)| found(target, user))))
    }

    /// Positions of the entities that point to the one at a position, ascending, each once.
    #[must_use]
    pub fn users_at(&self, position: u32) -> &[u32] {
        self.0.at(position)
    }

    /// Positions of the entities that point to an entity, ascending, each once.
    #[must_use]
    pub fn users(&self, structure: &ExchangeStructure, number: EntryNumber) -> &[u32] {
        structure.position(number).map_or(&[], |position| self.users_at(position))
    }
}

/// Pointers of a directory entry: fields that are one when positive, and fields that are one when negative.
fn of_directory(instance: Instance<'_>) -> impl Iterator<Item = EntryNumber> {
    let entry = instance.entry();
    let positive = [entry.view, entry.transformation, entry.label_display];
    let negated = [entry.structure, entry.line_font, entry.level, entry.colour];
    let all = positive.into_iter().chain(negated.into_iter().map(|pointer| pointer.saturating_neg()));
    all.filter_map(|pointer| EntryNumber::from_pointer(pointer.into()))
}

/// Everything that an entity may point to.
#[must_use]
pub fn pointers(instance: Instance<'_>) -> Vec<EntryNumber> {
    let mut found: Vec<EntryNumber> = of_directory(instance).collect();
    if instance.entry().entity_type == Entity::Null.number() {
        return Vec::new();
    }
    match EntityView::of(instance) {
        Some(view) => found.extend(view.pointers().into_iter().map(|(number, _)| number)),
        None => found.extend(instance.parameters().filter_map(|parameter| {
            let pointer = parameter.as_i64()?;
            // Some entities write pointers negated, to tell them from numbers.
            EntryNumber::from_pointer(pointer.saturating_abs())
        })),
    }
    found
}

/// Reports every pointer of a known entity to an entry that the file does not have.
pub fn unresolved_pointers(structure: &ExchangeStructure, sink: &mut dyn Sink) {
    for instance in structure.instances() {
        let missing = |number: &EntryNumber| structure.position(*number).is_none();
        for number in of_directory(instance).filter(missing) {
            let message = format!("its directory entry points to {number}, which the file does not have");
            sink.report(Code::UnresolvedPointer.note_on(instance.number(), instance.span(), message));
        }
        let Some(view) = EntityView::of(instance) else { continue };
        for (number, parameter) in view.pointers().into_iter().filter(|(number, _)| missing(number)) {
            let message = format!("points to {number}, which the file does not have");
            sink.report(Code::UnresolvedPointer.note_on(instance.number(), parameter.span(), message));
        }
    }
}
