//! Changes of a file of the compressed form: values on their lines, and the fields of directory records, which the
//! entities behind inherit.

use std::collections::BTreeMap;

use super::card::DATA;
use super::directory_entry::{DirectoryEntry, Field};
use super::edit::EditError;
use super::exchange_structure::{ExchangeStructure, Instance};
use super::layout::{RecordChange, relaid};
use super::write::{NewEntity, laid_out};
use crate::exchange::Edit;
use crate::source::{LineEnding, Span};

/// Fields that are written in this form, and so inherited.
const WRITTEN: [Field; 13] = [
    Field::EntityType,
    Field::Structure,
    Field::LineFont,
    Field::Level,
    Field::View,
    Field::Transformation,
    Field::LabelDisplay,
    Field::Status,
    Field::LineWeight,
    Field::Colour,
    Field::ParameterCards,
    Field::Form,
    Field::Subscript,
];

/// Edits of the data section.
pub(super) fn data(
    structure: &ExchangeStructure,
    records: &BTreeMap<u32, RecordChange>,
    fields: &BTreeMap<(u32, Field), i32>,
    added: &[NewEntity],
) -> Result<Vec<Edit>, EditError> {
    let mut editor = Editor {
        structure,
        ending: LineEnding::of(structure.source().bytes()).as_str().as_bytes().to_vec(),
        edits: Vec::new(),
        wanted: BTreeMap::new(),
    };
    for (&(position, field), &value) in fields.iter().filter(|((_, field), _)| WRITTEN.contains(field)) {
        editor.wanted.entry(position).or_default().insert(field, value);
    }
    for (&position, change) in records {
        if let Some(instance) = structure.instance_at(position) {
            editor.record(instance, change);
        }
    }
    editor.headers();
    editor.added(added)?;
    Ok(editor.edits)
}

struct Editor<'a> {
    structure: &'a ExchangeStructure,
    ending: Vec<u8>,
    edits: Vec<Edit>,
    /// Fields that change, by position.
    wanted: BTreeMap<u32, BTreeMap<Field, i32>>,
}

impl Editor<'_> {
    fn record(&mut self, instance: Instance<'_>, change: &RecordChange) {
        let lines = instance.cards();
        let (mut count, old) = (lines.len(), lines.len());
        for unit in relaid(instance.record(), DATA, change) {
            let line = |at: usize| self.structure.line_at(lines[at]);
            let (Some(first), Some(last)) = (line(unit.lines.start), line(unit.lines.end - 1)) else {
                continue;
            };
            count = count + unit.data.len() - unit.lines.len();
            self.edits
                .push(Edit::replace(Span::new(first.start, last.end), unit.data.join(&self.ending[..])));
        }
        // The count of lines is that of the fixed form, which this file need not have: it moves by as much.
        if count != old {
            let stated = i64::from(instance.entry().parameter_cards) + count as i64 - old as i64;
            let wanted = self.wanted.entry(instance.position()).or_default();
            wanted.insert(Field::ParameterCards, i32::try_from(stated).unwrap_or(i32::MAX));
        }
    }

    /// Directory records that change, and those that would inherit what changed.
    fn headers(&mut self) {
        let mut more: BTreeMap<u32, BTreeMap<Field, i32>> = self.wanted.clone();
        for (&position, fields) in &self.wanted {
            let Some(next) = self.structure.instance_at(position + 1) else { continue };
            for &field in fields.keys() {
                let inherited = value(next.entry(), field);
                more.entry(position + 1).or_default().entry(field).or_insert(inherited);
            }
        }
        for (position, fields) in more {
            if let Some(instance) = self.structure.instance_at(position) {
                self.header(instance, &fields);
            }
        }
    }

    fn header(&mut self, instance: Instance<'_>, fields: &BTreeMap<Field, i32>) {
        let span = instance.span();
        let text = String::from_utf8_lossy(self.structure.source().slice(span)).replace(['\r', '\n'], "");
        let text = text.trim_end().trim_end_matches(char::from(self.structure.global().delimiters.record));
        let mut parts = text.split('@');
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let number = part.split('_').next().and_then(|number| number.trim().parse().ok());
            let replaced =
                number.and_then(Field::from_number).is_some_and(|field| fields.contains_key(&field));
            if !replaced {
                out += &format!("@{part}");
            }
        }
        for (&field, value) in fields {
            out += &format!("@{}_{}", field as usize, text_of(field, *value));
        }
        out.push(char::from(self.structure.global().delimiters.record));
        self.edits.push(Edit::replace(span, out));
    }

    fn added(&mut self, added: &[NewEntity]) -> Result<(), EditError> {
        let lines = &self.structure.sections().parameter;
        let last = lines.last().and_then(|line| self.structure.line_at(*line));
        let (Some(last), Some(number)) = (last, self.structure.greatest_number()) else {
            return if added.is_empty() { Ok(()) } else { Err(EditError::NoSection) };
        };
        let record = self.structure.global().delimiters.record;
        for (at, entity) in added.iter().enumerate() {
            let lines = laid_out(&entity.parameters, self.structure.global().delimiters, DATA);
            let entry = DirectoryEntry {
                parameter_cards: i32::try_from(lines.len()).unwrap_or(i32::MAX),
                ..entity.entry
            };
            let mut header = format!("D{}", number.0 as usize + 2 * at + 2).into_bytes();
            for field in WRITTEN {
                let part = format!("@{}_{}", field as usize, text_of(field, value(&entry, field)));
                header.extend(part.into_bytes());
            }
            header.extend(format!("@18_{}", String::from_utf8_lossy(&entry.label.0)).into_bytes());
            header.push(record);
            let mut text = Vec::new();
            for line in [header].into_iter().chain(lines) {
                text.extend_from_slice(&line);
                text.extend_from_slice(&self.ending);
            }
            self.edits.push(Edit::insert(last.next, text));
        }
        Ok(())
    }
}

/// A field of an entry as a number.
fn value(entry: &DirectoryEntry, field: Field) -> i32 {
    match field {
        Field::EntityType => entry.entity_type,
        Field::Structure => entry.structure,
        Field::LineFont => entry.line_font,
        Field::Level => entry.level,
        Field::View => entry.view,
        Field::Transformation => entry.transformation,
        Field::LabelDisplay => entry.label_display,
        Field::Status => entry.status.text().parse().unwrap_or(0),
        Field::LineWeight => entry.line_weight,
        Field::Colour => entry.colour,
        Field::ParameterCards => entry.parameter_cards,
        Field::Form => entry.form,
        Field::Subscript => entry.subscript,
        Field::ParameterData
        | Field::EntityTypeAgain
        | Field::ReservedFirst
        | Field::ReservedSecond
        | Field::Label => 0,
    }
}

fn text_of(field: Field, value: i32) -> String {
    if field == Field::Status { format!("{value:08}") } else { value.to_string() }
}
