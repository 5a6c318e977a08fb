//! Names, colours and levels (IGES 5.3 sections 2.2.4.4, 4.77 and the properties of section 4.98).

use std::collections::BTreeMap;

use super::super::lower::record::{Record, Value};
use super::super::write::{NewEntity, ParameterText, RecordWriter};
use super::super::{DirectoryEntry, Entity, EntryNumber};
use super::{FromModelError, Rank, Writer};
use crate::brep::{BodyId, FaceId};
use crate::model::{Attributes, Colour};

/// Forms of the property: list of levels, function of a level, name.
const LEVELS: i32 = 1;
const LEVEL_FUNCTION: i32 = 3;
const NAME: i32 = 15;

/// What is written once and used by many.
#[derive(Default)]
pub(super) struct Looks {
    colours: BTreeMap<[u64; 3], EntryNumber>,
    levels: BTreeMap<String, i32>,
    lists: BTreeMap<Vec<i32>, EntryNumber>,
}

impl Writer<'_, '_> {
    /// Entry and name of a body.
    pub(super) fn look_of_body(
        &mut self,
        body: BodyId,
    ) -> Result<(DirectoryEntry, Vec<ParameterText>), FromModelError> {
        let of = &self.model.bodies[body];
        let product = of.product.map(|at| &self.model.products[at]);
        let inherited = product.and_then(|product| product.appearance.colour);
        self.look(&of.own, of.own.appearance.colour.or(inherited))
    }

    /// Entry and name of a face of a solid.
    pub(super) fn look_of_face(
        &mut self,
        face: FaceId,
    ) -> Result<(DirectoryEntry, Vec<ParameterText>), FromModelError> {
        let of = &self.model.faces[face];
        self.look(of, of.appearance.colour)
    }

    /// Entry and name of a face that is nothing's part: what its body says holds for it, and its body's name where it is
    /// the only one and has none.
    pub(super) fn look_of_loose_face(
        &mut self,
        face: FaceId,
    ) -> Result<(DirectoryEntry, Vec<ParameterText>), FromModelError> {
        let body = self.model.body_of(face);
        let of_body = &self.model.bodies[body].own;
        let mut own = self.model.faces[face].clone();
        let shells = &self.model.brep.bodies[body].shells;
        let alone = shells.iter().map(|&shell| self.model.brep.shells[shell].faces.len()).sum::<usize>() == 1;
        if own.name.is_empty() && alone {
            own.name.clone_from(&of_body.name);
        }
        own.layers.extend(
            of_body.layers.iter().filter(|layer| !self.model.faces[face].layers.contains(layer)).cloned(),
        );
        own.appearance.hidden |= of_body.appearance.hidden;
        self.look(&own, self.model.colour_of(face))
    }

    fn look(
        &mut self,
        of: &Attributes,
        colour: Option<Colour>,
    ) -> Result<(DirectoryEntry, Vec<ParameterText>), FromModelError> {
        let mut entry = DirectoryEntry::default();
        entry.status.blank = u8::from(of.appearance.hidden);
        if let Some(colour) = colour {
            entry.colour = -pointer(self.colour(colour)?);
        }
        entry.level = self.level(&of.layers)?;
        Ok((entry, self.named(&of.name)?))
    }

    fn colour(&mut self, colour: Colour) -> Result<EntryNumber, FromModelError> {
        let parts = [colour.red, colour.green, colour.blue];
        let key = parts.map(f64::to_bits);
        if let Some(&known) = self.looks.colours.get(&key) {
            return Ok(known);
        }
        let record = Record::new(Entity::ColourDefinition.number(), 0);
        let number = self.add(&record.reals(parts.map(|part| 100.0 * part)), Rank::Definition)?;
        self.looks.colours.insert(key, number);
        Ok(number)
    }

    /// Level of the names of layers, or a pointer to a list of them.
    fn level(&mut self, layers: &[String]) -> Result<i32, FromModelError> {
        let mut levels = Vec::with_capacity(layers.len());
        for layer in layers {
            levels.push(self.level_of(layer)?);
        }
        levels.sort_unstable();
        levels.dedup();
        match levels.as_slice() {
            [] => return Ok(0),
            [only] => return Ok(*only),
            _ => {}
        }
        if let Some(&known) = self.looks.lists.get(&levels) {
            return Ok(-pointer(known));
        }
        let record = Record::new(Entity::Property.number(), LEVELS).values([Value::count(levels.len())]);
        let record = record.values(levels.iter().map(|&level| Value::Integer(level.into())));
        let number = self.add(&record, Rank::Definition)?;
        self.looks.lists.insert(levels, number);
        Ok(-pointer(number))
    }

    /// A level for a layer: its name where that is a number, else one that is free, with the name as its function.
    fn level_of(&mut self, layer: &str) -> Result<i32, FromModelError> {
        if let Some(&known) = self.looks.levels.get(layer) {
            return Ok(known);
        }
        let number = layer.parse::<i32>().ok().filter(|number| (1..=GREATEST_LEVEL).contains(number));
        let level = number.unwrap_or_else(|| self.free_level());
        self.looks.levels.insert(layer.to_owned(), level);
        if number.is_none() {
            let mut writer = RecordWriter::of_type(Entity::Property.number());
            writer.integer(2).integer(0).text(layer);
            self.push_text(writer, LEVEL_FUNCTION, level)?;
        }
        Ok(level)
    }

    fn free_level(&self) -> i32 {
        let named = self.model.faces.iter().map(|(_, face)| &face.layers);
        let named = named.chain(self.model.bodies.iter().map(|(_, body)| &body.own.layers)).flatten();
        let numbers = named.filter_map(|layer| layer.parse::<i32>().ok());
        let taken =
            numbers.filter(|number| *number <= GREATEST_LEVEL).chain(self.looks.levels.values().copied());
        taken.max().unwrap_or(0).max(0) + 1
    }

    /// Parameters behind the fields of an entity with a name; none without.
    pub(super) fn named(&mut self, name: &str) -> Result<Vec<ParameterText>, FromModelError> {
        if name.is_empty() {
            return Ok(Vec::new());
        }
        let mut writer = RecordWriter::of_type(Entity::Property.number());
        writer.integer(1).text(name);
        let number = self.push_text(writer, NAME, 0)?;
        let mut behind = RecordWriter::part();
        behind.integer(0).integer(1).pointer(Some(number));
        Ok(behind.finish())
    }

    fn push_text(
        &mut self,
        writer: RecordWriter,
        form: i32,
        level: i32,
    ) -> Result<EntryNumber, FromModelError> {
        let entity_type = Entity::Property.number();
        let status = Rank::Definition.status();
        let entry = DirectoryEntry { entity_type, form, level, status, ..DirectoryEntry::default() };
        Ok(self.lowering.draft.push(NewEntity { entry, parameters: writer.finish() })?)
    }
}

/// Greatest number of a level that is a layer's own.
const GREATEST_LEVEL: i32 = 32_767;

fn pointer(number: EntryNumber) -> i32 {
    i32::try_from(number.0).unwrap_or(i32::MAX)
}
