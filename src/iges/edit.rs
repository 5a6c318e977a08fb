//! Changes of records, directory fields and the global section, as byte edits; `docs/decisions/iges-patching.md` has
//! the rules.
//!
//! Everything here gives byte edits for [`Patch`](crate::exchange::Patch) and changes nothing itself.
//!
//! INVARIANT: columns 1 to 64 of a parameter card change only where a value on it does.

use std::collections::BTreeMap;

use super::card::{self, Breaks, CARD, DATA, Line, MAX_SEQUENCE, PARAMETER_DATA, offset};
use super::compressed_edit;
use super::directory_entry::{EntryNumber, Field};
use super::exchange_structure::{ExchangeStructure, Instance};
use super::global::place;
use super::layout::{RecordChange, Relaid, relaid};
use super::parameter::{Parameter, Place};
use super::section::{Form, SectionKind};
use super::string;
use super::write::{NewEntity, ParameterText, directory_cards, laid_out, parameter_data};
use crate::exchange::Edit;
use crate::source::{LineEnding, Span};

/// A change would need greater sequence numbers than seven columns hold, or the file has no section to add to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// Seven columns hold no greater number.
    #[error("the changed file would need more than {MAX_SEQUENCE} cards in a section")]
    TooManyCards,
    /// New entities have no place to go.
    #[error("the file has no directory and parameter section for new entities")]
    NoSection,
}

/// Changes of one file, gathered before any of them is laid out.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    records: BTreeMap<u32, RecordChange>,
    fields: BTreeMap<(u32, Field), i32>,
    added: Vec<NewEntity>,
    global: BTreeMap<usize, ParameterText>,
}

impl Changes {
    /// Whether nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty() && self.fields.is_empty() && self.added.is_empty() && self.global.is_empty()
    }

    /// Puts parameters in the place of one of an entity. Has no effect on a record that changes as a whole.
    pub fn replace(&mut self, instance: Instance<'_>, old: &Parameter<'_>, new: Vec<ParameterText>) {
        self.replace_at(instance, old.start(), new);
    }

    /// Puts parameters in the place of the one that begins at a place.
    pub(super) fn replace_at(&mut self, instance: Instance<'_>, place: Place, new: Vec<ParameterText>) {
        let values = || RecordChange::Values(BTreeMap::new());
        if let RecordChange::Values(values) = self.records.entry(instance.position()).or_insert_with(values) {
            values.insert(place, new);
        }
    }

    /// Gives an entity other parameters altogether, its type first.
    pub fn rewrite(&mut self, instance: Instance<'_>, parameters: Vec<ParameterText>) {
        self.records.insert(instance.position(), RecordChange::Whole(parameters));
    }

    /// Sets a field of a directory entry; the type is set in both cards.
    pub fn set_field(&mut self, instance: Instance<'_>, field: Field, value: i32) {
        self.fields.insert((instance.position(), field), value);
        if field == Field::EntityType {
            self.fields.insert((instance.position(), Field::EntityTypeAgain), value);
        }
    }

    /// Adds an entity and gives its name.
    ///
    /// # Errors
    /// [`EditError`].
    pub fn add(
        &mut self,
        structure: &ExchangeStructure,
        entity: NewEntity,
    ) -> Result<EntryNumber, EditError> {
        let last = structure.greatest_number().ok_or(EditError::NoSection)?;
        let number = EntryNumber(last.0 + 2 * offset(self.added.len()) + 2);
        if number.0 > MAX_SEQUENCE {
            return Err(EditError::TooManyCards);
        }
        self.added.push(entity);
        Ok(number)
    }

    /// States the time and the program of the change in the global section, where the file has these parameters. The year
    /// has as many digits as before. `timestamp` is ISO 8601 without zone.
    pub fn stamp(&mut self, structure: &ExchangeStructure, timestamp: &str, preprocessor: &str) {
        let digits: String = timestamp.chars().filter(char::is_ascii_digit).collect();
        let (Some(date), Some(time)) = (digits.get(..8), digits.get(8..14)) else { return };
        let short = structure.global().written.len() == "YYMMDD.HHNNSS".len();
        let date = if short { &date[2..] } else { date };
        let written = format!("{date}.{time}");
        let values = [(place::WRITTEN, written.as_str()), (place::PREPROCESSOR_VERSION, preprocessor)];
        let count = structure.global_parameters().count();
        for (place, value) in values.into_iter().filter(|(place, _)| *place <= count) {
            self.global.insert(place, string::encode(value).into_bytes());
        }
    }

    /// The byte edits.
    ///
    /// # Errors
    /// [`EditError`].
    pub fn edits(&self, structure: &ExchangeStructure) -> Result<Vec<Edit>, EditError> {
        let mut editor = Editor::new(structure);
        editor.global(&self.global);
        match structure.form() {
            Form::Fixed => {
                let gains = editor.records(&self.records, &self.added)?;
                editor.directory(&self.fields, &gains, &self.added)?;
            }
            Form::Compressed => {
                editor.edits.extend(compressed_edit::data(
                    structure,
                    &self.records,
                    &self.fields,
                    &self.added,
                )?);
                editor.counts[DIRECTORY] = editor.counts[DIRECTORY].saturating_add(2 * self.added.len());
            }
        }
        editor.terminate();
        if editor.counts.iter().any(|count| *count > MAX_SEQUENCE as usize) {
            return Err(EditError::TooManyCards);
        }
        Ok(editor.edits)
    }
}

/// Places of the sections in the terminate card.
const GLOBAL: usize = 1;
const DIRECTORY: usize = 2;
const PARAMETER: usize = 3;

/// How many cards more stand before a card than did, by positions in the parameter section.
#[derive(Debug, Default)]
struct Gains {
    /// Positions from which on a sum holds, ascending, and the sums.
    sums: Vec<(usize, isize)>,
}

impl Gains {
    fn add(&mut self, position: usize, gain: isize) {
        if gain != 0 {
            self.sums.push((position, self.total() + gain));
        }
    }

    fn before(&self, position: usize) -> isize {
        let passed = self.sums.partition_point(|(from, _)| *from <= position);
        passed.checked_sub(1).map_or(0, |last| self.sums[last].1)
    }

    fn total(&self) -> isize {
        self.sums.last().map_or(0, |last| last.1)
    }
}

/// What becomes of one card.
#[derive(Debug, Default)]
struct Fate {
    /// New data; `None` when the data stay.
    data: Option<Vec<u8>>,
    /// Whether it goes.
    removed: bool,
    /// Data of cards that come behind it.
    behind: Vec<Vec<u8>>,
}

/// Fates of the cards of a section, by position.
type Fates = BTreeMap<usize, Fate>;

/// Notes what becomes of the cards of a record, which begin at a position of their section.
fn note_fates(fates: &mut Fates, start: usize, laid: Vec<Relaid>) {
    for unit in laid {
        let positions = start + unit.lines.start..start + unit.lines.end;
        let last = positions.end - 1;
        let mut data = unit.data.into_iter();
        for position in positions {
            let fate = fates.entry(position).or_default();
            fate.data = data.next();
            fate.removed = fate.data.is_none();
        }
        fates.entry(last).or_default().behind = data.collect();
    }
}

struct Editor<'a> {
    structure: &'a ExchangeStructure,
    edits: Vec<Edit>,
    /// Cards of the start, global, directory and parameter sections, as they will be.
    counts: [usize; 4],
}

impl<'a> Editor<'a> {
    fn new(structure: &'a ExchangeStructure) -> Self {
        let sections = structure.sections();
        let counts =
            [sections.start.len(), sections.global.len(), sections.directory.len(), sections.parameter.len()];
        Self { structure, edits: Vec::new(), counts }
    }

    fn bytes(&self) -> &'a [u8] {
        self.structure.source().bytes()
    }

    fn line(&self, card: u32) -> Line {
        self.structure.line_at(card).unwrap_or(Line { start: card, end: card, next: card })
    }

    /// Replaces bytes, unless they stay the same.
    fn replace(&mut self, span: Span, text: Vec<u8>) {
        if self.structure.source().slice(span) != text {
            self.edits.push(Edit::replace(span, text));
        }
    }

    fn global(&mut self, values: &BTreeMap<usize, ParameterText>) {
        let mut change = BTreeMap::new();
        for (at, parameter) in self.structure.global_parameters().enumerate() {
            if let Some(value) = values.get(&(at + 1)).filter(|value| **value != *parameter.text()) {
                change.insert(parameter.start(), vec![value.clone()]);
            }
        }
        if change.is_empty() {
            return;
        }
        let mut fates = Fates::new();
        note_fates(
            &mut fates,
            0,
            relaid(self.structure.global_parameters(), DATA, &RecordChange::Values(change)),
        );
        let gains = self.cards(SectionKind::Global, &fates, DATA);
        self.counts[GLOBAL] = self.counts[GLOBAL].saturating_add_signed(gains.total());
    }

    fn records(
        &mut self,
        records: &BTreeMap<u32, RecordChange>,
        added: &[NewEntity],
    ) -> Result<Gains, EditError> {
        let mut fates = Fates::new();
        for (position, change) in records {
            if let Some(instance) = self.structure.instance_at(*position).filter(|i| !i.cards().is_empty()) {
                let laid = relaid(instance.record(), PARAMETER_DATA, change);
                note_fates(&mut fates, instance.card_range().start, laid);
            }
        }
        let gains = self.cards(SectionKind::Parameter, &fates, PARAMETER_DATA);
        self.counts[PARAMETER] = self.counts[PARAMETER].saturating_add_signed(gains.total());
        self.added_records(added, &gains)?;
        Ok(gains)
    }

    /// Edits the cards of a section and numbers those behind the first that come or go.
    fn cards(&mut self, kind: SectionKind, fates: &Fates, width: usize) -> Gains {
        let cards = self.structure.sections().of(kind);
        let mut gains = Gains::default();
        let Some((&first, _)) = fates.first_key_value() else { return gains };
        for (position, &start) in cards.iter().enumerate().skip(first) {
            let fate = fates.get(&position);
            if fate.is_none() && gains.total() == 0 {
                continue;
            }
            let line = self.line(start);
            if fate.is_some_and(|fate| fate.removed) {
                self.edits.push(Edit::remove(Span::new(line.start, line.next)));
                gains.add(position + 1, -1);
                continue;
            }
            if let Some(data) = fate.and_then(|fate| fate.data.as_ref()) {
                self.replace(Span::new(start, start + offset(width)), padded(data, width));
            }
            let number = self.number(line, position).saturating_add_signed(gains.total());
            self.renumber(line, number);
            for (more, data) in fate.into_iter().flat_map(|fate| &fate.behind).enumerate() {
                self.insert_behind(line, padded(data, width), number + more + 1);
                gains.add(position + 1, 1);
            }
        }
        gains
    }

    /// The sequence number of a card.
    fn number(&self, line: Line, position: usize) -> usize {
        let text = &self.bytes()[line.start as usize..line.end as usize];
        card::sequence(text).map_or(position + 1, |number| number as usize)
    }

    /// Where the sequence number of a card stands.
    fn number_span(line: Line) -> Span {
        let start = line.start + offset(DATA + 1);
        Span::new(start, line.end.min(line.start + offset(CARD)).max(start))
    }

    fn renumber(&mut self, line: Line, number: usize) {
        let span = Self::number_span(line);
        let old = self.structure.source().slice(span);
        if card::sequence(&self.bytes()[line.start as usize..line.end as usize]) != u32::try_from(number).ok()
        {
            self.replace(span, renumbered(old, number));
        }
    }

    /// A new card behind another, in its shape.
    fn insert_behind(&mut self, line: Line, mut data: Vec<u8>, number: usize) {
        let old = &self.bytes()[line.start as usize..line.end as usize];
        let span = Self::number_span(line);
        let column = |at: u32| (at - line.start) as usize;
        data.extend_from_slice(&old[data.len()..column(span.start)]);
        data.extend(renumbered(self.structure.source().slice(span), number));
        // What others have written behind column 80 is not ours to repeat, but its width is.
        data.resize(data.len() + old.len() - column(span.end), b' ');
        self.insert_line(line, data);
    }

    /// A new line behind another, with its line end.
    fn insert_line(&mut self, behind: Line, mut text: Vec<u8>) {
        let ending = &self.bytes()[behind.end as usize..behind.next as usize];
        if ending.is_empty() && self.structure.breaks() == Breaks::Lines {
            let ending = LineEnding::of(self.bytes()).as_str().bytes();
            text.splice(0..0, ending);
        } else {
            text.extend_from_slice(ending);
        }
        self.edits.push(Edit::insert(behind.next, text));
    }

    /// Cards of new entities, behind the last parameter card.
    fn added_records(&mut self, added: &[NewEntity], gains: &Gains) -> Result<(), EditError> {
        if added.is_empty() {
            return Ok(());
        }
        let cards = &self.structure.sections().parameter;
        let last = self.line(*cards.last().ok_or(EditError::NoSection)?);
        let mut number = self.number(last, cards.len() - 1).saturating_add_signed(gains.total());
        for (at, entity) in added.iter().enumerate() {
            let name = added_number(self.structure, at)?;
            for line in laid_out(&entity.parameters, self.structure.global().delimiters, PARAMETER_DATA) {
                number += 1;
                self.counts[PARAMETER] += 1;
                self.insert_behind(last, parameter_data(&line, name), number);
            }
        }
        Ok(())
    }

    /// Fields of directory entries, pointers to moved parameters, and new entries.
    fn directory(
        &mut self,
        fields: &BTreeMap<(u32, Field), i32>,
        gains: &Gains,
        added: &[NewEntity],
    ) -> Result<(), EditError> {
        for instance in self.structure.instances() {
            let range = instance.card_range();
            if range.is_empty() || gains.total() == 0 && gains.sums.is_empty() {
                continue;
            }
            let before = gains.before(range.start);
            let entry = instance.entry();
            if before != 0 {
                let pointer = i64::from(entry.parameter_data) + before as i64;
                self.field(instance, Field::ParameterData, pointer);
            }
            // Of a record that changes itself, the sum behind its last card is another than before its first.
            let own = gains.before(range.end) - before;
            if own != 0 {
                self.field(instance, Field::ParameterCards, range.len() as i64 + own as i64);
            }
        }
        for (&(position, field), &value) in fields {
            if let Some(instance) = self.structure.instance_at(position) {
                self.field(instance, field, value.into());
            }
        }
        self.added_entries(added, gains)
    }

    fn field(&mut self, instance: Instance<'_>, field: Field, value: i64) {
        let Some(span) = instance.field_span(field) else { return };
        let old = self.structure.source().slice(span);
        if card::integer(old).map(i64::from) != Some(value) {
            self.replace(span, numbered(old, value));
        }
    }

    fn added_entries(&mut self, added: &[NewEntity], gains: &Gains) -> Result<(), EditError> {
        let Some(&last) = self.structure.sections().directory.last() else {
            return if added.is_empty() { Ok(()) } else { Err(EditError::NoSection) };
        };
        let cards = &self.structure.sections().parameter;
        let end = match cards.last() {
            Some(card) => self.number(self.line(*card), cards.len() - 1).saturating_add_signed(gains.total()),
            None => 0,
        };
        let (last, mut next) = (self.line(last), end + 1);
        for (at, entity) in added.iter().enumerate() {
            let name = added_number(self.structure, at)?;
            let count =
                laid_out(&entity.parameters, self.structure.global().delimiters, PARAMETER_DATA).len();
            let (first, n_cards) = (i32::try_from(next), i32::try_from(count));
            let (Ok(parameter_data), Ok(parameter_cards)) = (first, n_cards) else {
                return Err(EditError::TooManyCards);
            };
            let entry = super::DirectoryEntry { parameter_data, parameter_cards, ..entity.entry };
            for (card, data) in directory_cards(&entry).into_iter().enumerate() {
                self.insert_behind(last, data.into_bytes(), name.0 as usize + card);
            }
            self.counts[DIRECTORY] += 2;
            next += count;
        }
        Ok(())
    }

    /// States the counts that changed.
    fn terminate(&mut self) {
        let Some(&start) = self.structure.sections().terminate.first() else { return };
        let before = Editor::new(self.structure).counts;
        for (at, (count, was)) in self.counts.into_iter().zip(before).enumerate() {
            if count != was {
                let span = Span::new(start + offset(8 * at + 1), start + offset(8 * at + 8));
                self.replace(span, renumbered(self.structure.source().slice(span), count));
            }
        }
    }
}

/// Name of an added entity.
fn added_number(structure: &ExchangeStructure, at: usize) -> Result<EntryNumber, EditError> {
    let last = structure.greatest_number().ok_or(EditError::NoSection)?;
    Ok(EntryNumber(last.0 + 2 * offset(at) + 2))
}

fn padded(data: &[u8], width: usize) -> Vec<u8> {
    let mut data = data.to_vec();
    data.resize(width, b' ');
    data
}

/// A sequence number in the place, the width and with the padding of another.
fn renumbered(old: &[u8], number: usize) -> Vec<u8> {
    numbered(old, i64::try_from(number).unwrap_or(i64::MAX))
}

/// A number in the place, the width and with the padding of another: zeros where that begins with one, at the left where
/// blanks are behind it, else at the right.
fn numbered(old: &[u8], number: i64) -> Vec<u8> {
    let width = old.len();
    let text = match (old.first(), old.last()) {
        (Some(b'0'), _) if width > 1 && number >= 0 => format!("{number:0width$}"),
        (Some(b'1'..=b'9'), Some(b' ')) => format!("{number:<width$}"),
        _ => format!("{number:>width$}"),
    };
    text.into_bytes()
}
