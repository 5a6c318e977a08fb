//! The changed file while it grows: parameters that change, lists whose members come and go, entities that are rewritten,
//! added or become null; and how often each entity is pointed to.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::edit::Changes;
use super::super::parameter::Place;
use super::super::reverse_index::ReverseIndex;
use super::super::write::{NewEntity, ParameterText, RecordWriter};
use super::super::{
    DirectoryEntry, Entity, EntityView, EntryNumber, ExchangeStructure, Field, Instance, Parameter, Status,
};
use super::LowerError;
use super::record::{Matrix, Record, Value};
use super::slot::Slot;
use crate::math::Affine;

/// What becomes of one parameter.
#[derive(Debug, Clone, Default)]
struct Spot {
    /// What stands in its place; `None` when it goes.
    own: Option<ParameterText>,
    /// What comes behind it.
    behind: Vec<ParameterText>,
}

/// The look that a new entity gets from an old one, and what it is.
#[derive(Debug, Clone, Copy)]
pub(in crate::iges) struct Look<'a> {
    /// Level, colour, line font and the like.
    pub(in crate::iges) from: &'a DirectoryEntry,
    pub(in crate::iges) status: Status,
}

impl<'a> Look<'a> {
    /// A part of something else, in space.
    pub(super) fn part(from: &'a DirectoryEntry) -> Self {
        Self { from, status: Status { subordinate: 1, ..Status::default() } }
    }

    /// A curve in the parameters of a surface.
    pub(in crate::iges) fn in_parameters(from: &'a DirectoryEntry) -> Self {
        Self { from, status: Status { subordinate: 1, usage: 5, ..Status::default() } }
    }

    /// What the old one is.
    pub(super) fn same(from: &'a DirectoryEntry) -> Self {
        Self { from, status: from.status }
    }
}

/// The growing changes.
pub(in crate::iges) struct Draft<'a> {
    structure: &'a ExchangeStructure,
    users: ReverseIndex,
    spots: BTreeMap<(EntryNumber, Place), Spot>,
    counts: BTreeMap<(EntryNumber, &'static str), i64>,
    whole: BTreeMap<EntryNumber, Record>,
    nulls: BTreeSet<EntryNumber>,
    fields: BTreeMap<(EntryNumber, Field), i32>,
    added: Vec<NewEntity>,
    first: u32,
    /// How often an owner points to others among its fields; looked up once.
    uses: HashMap<EntryNumber, HashMap<EntryNumber, usize>>,
    /// Pointers that went away, by what they pointed to.
    lost: BTreeMap<EntryNumber, usize>,
    /// Pointers that came.
    gained: BTreeMap<EntryNumber, usize>,
}

impl<'a> Draft<'a> {
    pub(super) fn new(structure: &'a ExchangeStructure) -> Self {
        Self {
            structure,
            users: ReverseIndex::build(structure),
            spots: BTreeMap::new(),
            counts: BTreeMap::new(),
            whole: BTreeMap::new(),
            nulls: BTreeSet::new(),
            fields: BTreeMap::new(),
            added: Vec::new(),
            first: structure.greatest_number().map_or(1, |last| last.0 + 2),
            uses: HashMap::new(),
            lost: BTreeMap::new(),
            gained: BTreeMap::new(),
        }
    }

    fn instance(&self, number: EntryNumber) -> Option<Instance<'a>> {
        self.structure.instance(number)
    }

    /// Entities whose geometry is made of this one.
    pub(super) fn geometric_users(&self, number: EntryNumber) -> Vec<EntryNumber> {
        self.users_that(number, is_geometric)
    }

    /// Entities that gather this one: groups, subfigures, drawings.
    pub(super) fn gatherers(&self, number: EntryNumber) -> Vec<EntryNumber> {
        self.users_that(number, |entity_type| !is_geometric(entity_type))
    }

    fn users_that(&self, number: EntryNumber, wanted: impl Fn(i32) -> bool) -> Vec<EntryNumber> {
        let users = self.users.users(self.structure, number).iter();
        let users = users.filter_map(|user| self.structure.instance_at(*user));
        users.filter(|user| wanted(user.entry().entity_type)).map(|user| user.number()).collect()
    }

    /// How often geometry points to an entity in the file.
    pub(super) fn use_count(&mut self, number: EntryNumber) -> usize {
        let users = self.geometric_users(number);
        users.into_iter().map(|user| self.uses_by(user).get(&number).copied().unwrap_or(0)).sum()
    }

    fn uses_by(&mut self, owner: EntryNumber) -> &HashMap<EntryNumber, usize> {
        let structure = self.structure;
        self.uses.entry(owner).or_insert_with(|| {
            let mut counts = HashMap::new();
            let view = structure.instance(owner).and_then(EntityView::of);
            for (target, _) in view.iter().flat_map(EntityView::parts) {
                *counts.entry(target).or_insert(0) += 1;
            }
            counts
        })
    }

    fn lose(&mut self, number: EntryNumber) {
        *self.lost.entry(number).or_insert(0) += 1;
    }

    fn gain(&mut self, number: EntryNumber) {
        *self.gained.entry(number).or_insert(0) += 1;
    }

    fn spot(&mut self, owner: EntryNumber, parameter: &Parameter<'_>) -> &mut Spot {
        let own = || Spot { own: Some(parameter.text().into_owned()), behind: Vec::new() };
        self.spots.entry((owner, parameter.start())).or_insert_with(own)
    }

    /// Puts a value in the place of a parameter.
    pub(super) fn set(&mut self, owner: EntryNumber, parameter: &Parameter<'_>, value: Value) {
        if !value.stands(parameter) {
            self.spot(owner, parameter).own = Some(value.text());
        }
    }

    /// Turns a pointer to another entity.
    pub(super) fn repoint(&mut self, slot: &Slot, to: EntryNumber) {
        self.lose(slot.target);
        self.gain(to);
        let spot = self.spots.entry((slot.owner, slot.place)).or_default();
        spot.own = Some(Value::to(to).text());
    }

    /// Clears a pointer.
    pub(super) fn clear(&mut self, slot: &Slot) {
        self.lose(slot.target);
        self.spots.entry((slot.owner, slot.place)).or_default().own = Some(Value::Pointer(None).text());
    }

    /// Takes a pointer out of a list whose count has a name, and the `more` parameters behind it.
    pub(super) fn unlist(&mut self, slot: &Slot, more: usize, count: &'static str) {
        self.lose(slot.target);
        let Some(instance) = self.instance(slot.owner) else { return };
        let members = instance.record().skip_while(|parameter| parameter.start() != slot.place);
        for parameter in members.take(more + 1) {
            self.spot(slot.owner, &parameter).own = None;
        }
        *self.counts.entry((slot.owner, count)).or_insert(0) -= 1;
    }

    /// Adds parameters behind one, which begin a member of a list whose count has a name.
    pub(super) fn list(
        &mut self,
        owner: EntryNumber,
        behind: &Parameter<'_>,
        member: &[Value],
        count: &'static str,
    ) {
        member.iter().filter_map(|value| value.target()).for_each(|target| self.gain(target));
        let texts = member.iter().map(|value| value.text());
        self.spot(owner, behind).behind.extend(texts);
        *self.counts.entry((owner, count)).or_insert(0) += 1;
    }

    /// Sets a field of a directory entry.
    pub(super) fn set_field(&mut self, number: EntryNumber, field: Field, value: i32) {
        self.fields.insert((number, field), value);
    }

    /// Sets the status number of a directory entry.
    pub(super) fn set_status(&mut self, number: EntryNumber, status: Status) {
        self.fields.insert((number, Field::Status), status.number());
    }

    /// Gives an entity another content. Values that are those of `old`, the content that it has, keep their text.
    pub(super) fn put(
        &mut self,
        number: EntryNumber,
        new: Record,
        old: Option<&Record>,
    ) -> Result<(), LowerError> {
        if !new.is_finite() {
            return Err(LowerError::NotFinite);
        }
        let Some(view) = self.instance(number).and_then(EntityView::of) else { return Ok(()) };
        let entry = view.instance().entry();
        self.set_matrix(number, new.matrix, entry)?;
        let before: Vec<EntryNumber> = view.parts().into_iter().map(|(target, _)| target).collect();
        before.into_iter().for_each(|target| self.lose(target));
        new.values.iter().filter_map(|value| value.target()).for_each(|target| self.gain(target));
        let count = own_count(&view);
        let same_layout = (entry.entity_type, entry.form) == (new.entity_type, new.form);
        if !same_layout || count != new.values.len() {
            self.whole.insert(number, new);
            return Ok(());
        }
        let old = old.filter(|old| old.values.len() == count && old.entity_type == new.entity_type);
        for (at, parameter) in view.instance().parameters().take(count).enumerate() {
            if old.is_none_or(|old| old.values[at] != new.values[at]) {
                self.set(number, &parameter, new.values[at]);
            }
        }
        Ok(())
    }

    fn set_matrix(
        &mut self,
        number: EntryNumber,
        matrix: Matrix,
        entry: &DirectoryEntry,
    ) -> Result<(), LowerError> {
        if let Matrix::New(map) = matrix {
            let pointer = self.matrix(&map, entry)?;
            self.set_field(number, Field::Transformation, pointer);
        }
        Ok(())
    }

    /// A new transformation matrix, as a pointer of directory entries.
    fn matrix(&mut self, map: &Affine, entry: &DirectoryEntry) -> Result<i32, LowerError> {
        let rows = (0..3).flat_map(|i| {
            let row = map.linear.row(i);
            [row[0], row[1], row[2], map.translation[i]]
        });
        let record = Record::new(Entity::TransformationMatrix.number(), 0).reals(rows);
        let number = self.add(&record, Look::part(entry), &[])?;
        Ok(i32::try_from(number.0).unwrap_or(i32::MAX))
    }

    /// A new entity, with pointers to associativities and properties behind its fields.
    pub(in crate::iges) fn add(
        &mut self,
        record: &Record,
        look: Look<'_>,
        behind: &[ParameterText],
    ) -> Result<EntryNumber, LowerError> {
        if !record.is_finite() {
            return Err(LowerError::NotFinite);
        }
        let transformation = match record.matrix {
            Matrix::Same => 0,
            Matrix::New(map) => self.matrix(&map, look.from)?,
        };
        record.values.iter().filter_map(|value| value.target()).for_each(|target| self.gain(target));
        let entry = DirectoryEntry {
            entity_type: record.entity_type,
            form: record.form,
            status: look.status,
            transformation,
            ..*look.from
        };
        let parameters = record.texts().into_iter().chain(behind.iter().cloned()).collect();
        self.push(NewEntity { entry, parameters })
    }

    pub(in crate::iges) fn push(&mut self, entity: NewEntity) -> Result<EntryNumber, LowerError> {
        let number = EntryNumber(self.first + 2 * super::super::card::offset(self.added.len()));
        self.added.push(entity);
        Ok(number)
    }

    /// The new entities alone.
    pub(in crate::iges) fn into_added(self) -> Vec<NewEntity> {
        self.added
    }

    /// A copy of an entity, and where its parameters are in it.
    pub(super) fn copy(&mut self, number: EntryNumber) -> Result<EntryNumber, LowerError> {
        let Some(instance) = self.instance(number) else {
            return Err(LowerError::Unreadable { number, reason: "it is not in the file".to_owned() });
        };
        let targets = EntityView::of(instance).map(|view| view.parts()).unwrap_or_default();
        targets.into_iter().for_each(|(target, _)| self.gain(target));
        let parameters = instance.record().map(|parameter| parameter.text().into_owned()).collect();
        self.push(NewEntity { entry: *instance.entry(), parameters })
    }

    /// Turns a pointer of a copy, which stands in the original at a slot.
    pub(super) fn repoint_copy(&mut self, copy: EntryNumber, slot: &Slot, to: EntryNumber) {
        let Some(original) = self.instance(slot.owner) else { return };
        let Some(at) = original.record().position(|parameter| parameter.start() == slot.place) else {
            return;
        };
        self.lose(slot.target);
        self.gain(to);
        let index = (copy.0.saturating_sub(self.first) / 2) as usize;
        if let Some(parameter) = self.added.get_mut(index).and_then(|entity| entity.parameters.get_mut(at)) {
            *parameter = Value::to(to).text();
        }
    }

    /// Makes an entity null, and gives what it pointed to.
    pub(super) fn remove(&mut self, number: EntryNumber) -> Vec<EntryNumber> {
        if !self.nulls.insert(number) {
            return Vec::new();
        }
        let left: Vec<EntryNumber> = match self.whole.remove(&number) {
            // What was rewritten has lost its old pointers already.
            Some(record) => record.values.into_iter().filter_map(Value::target).collect(),
            None => self.pointed_to(number),
        };
        left.iter().for_each(|target| self.lose(*target));
        left
    }

    /// What an entity of the file points to by now.
    fn pointed_to(&self, number: EntryNumber) -> Vec<EntryNumber> {
        let view = self.instance(number).and_then(EntityView::of);
        let parts = view.iter().flat_map(EntityView::parts);
        let now =
            parts.filter_map(|(target, parameter)| match self.spots.get(&(number, parameter.start())) {
                Some(spot) => spot.own.as_deref().and_then(pointer),
                None => Some(target),
            });
        now.collect()
    }

    pub(super) fn is_removed(&self, number: EntryNumber) -> bool {
        self.nulls.contains(&number)
    }

    /// Entities that some pointer left.
    pub(super) fn left(&self) -> Vec<EntryNumber> {
        self.lost.keys().copied().collect()
    }

    /// Whether geometry pointed to an entity and does no more.
    pub(super) fn is_orphan(&mut self, number: EntryNumber) -> bool {
        let before = self.use_count(number);
        let count = |map: &BTreeMap<EntryNumber, usize>| map.get(&number).copied().unwrap_or(0);
        before > 0 && before + count(&self.gained) <= count(&self.lost)
    }

    /// The changes.
    pub(super) fn finish(mut self, structure: &ExchangeStructure) -> Result<Changes, LowerError> {
        self.counts()?;
        let mut changes = Changes::default();
        for ((owner, place), spot) in self.spots {
            let Some(instance) = structure.instance(owner) else { continue };
            if self.whole.contains_key(&owner) || self.nulls.contains(&owner) {
                continue;
            }
            changes.replace_at(instance, place, spot.own.into_iter().chain(spot.behind).collect());
        }
        for (number, record) in self.whole {
            let Some(instance) = structure.instance(number) else { continue };
            let behind = behind(instance);
            changes.rewrite(instance, record.texts().into_iter().chain(behind).collect());
            changes.set_field(instance, Field::EntityType, record.entity_type);
            changes.set_field(instance, Field::Form, record.form);
        }
        for ((number, field), value) in self.fields {
            if let Some(instance) = structure.instance(number) {
                changes.set_field(instance, field, value);
            }
        }
        for number in self.nulls {
            if let Some(instance) = structure.instance(number) {
                changes.rewrite(instance, RecordWriter::of_type(Entity::Null.number()).finish());
                changes.set_field(instance, Field::EntityType, Entity::Null.number());
                changes.set_field(instance, Field::Form, 0);
            }
        }
        for entity in self.added {
            changes.add(structure, entity)?;
        }
        Ok(changes)
    }

    /// States the counts of lists that grew or shrank.
    fn counts(&mut self) -> Result<(), LowerError> {
        for ((owner, field), change) in std::mem::take(&mut self.counts) {
            let view = self.instance(owner).and_then(EntityView::of);
            let parameter = view.and_then(|view| view.fields().get(field));
            let parameter = parameter.ok_or_else(|| super::slot::missing(owner, field))?;
            let count = parameter.as_i64().unwrap_or(0) + change;
            self.set(owner, &parameter, Value::Integer(count));
        }
        Ok(())
    }
}

fn pointer(text: &[u8]) -> Option<EntryNumber> {
    EntryNumber::from_pointer(std::str::from_utf8(text).ok()?.trim().parse().ok()?)
}

/// Count of the parameters that are an entity's fields.
fn own_count(view: &EntityView<'_>) -> usize {
    let all = view.instance().parameters().count();
    all - view.behind().count().min(all)
}

/// Parameters behind an entity's fields.
pub(super) fn behind(instance: Instance<'_>) -> Vec<ParameterText> {
    let view = EntityView::of(instance);
    let behind = view.iter().flat_map(EntityView::behind);
    behind.map(|parameter| parameter.text().into_owned()).collect()
}

/// Whether an entity type is geometry or topology, which is made of what it points to.
fn is_geometric(entity_type: i32) -> bool {
    (100..200).contains(&entity_type) || (500..600).contains(&entity_type)
}
