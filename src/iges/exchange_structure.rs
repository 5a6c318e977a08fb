//! The exchange structure: one IGES file's bytes and where its sections and entities stand.
//!
//! Owns the [`Source`] and an index over it; every view borrows from these and decodes on demand. Reading never fails on
//! data: [`ExchangeStructure::parse`] gives whatever could be found, and diagnostics. It does not know what an entity
//! means, resolve pointers, or change anything.
//!
//! INVARIANT: a card belongs to one section, and a parameter card to one entity at most.

use super::card::{self, Breaks, DATA, Line, Lines, offset};
use super::code::Code;
use super::directory_entry::{DirectoryEntry, EntryNumber, Field};
use super::global::Global;
use super::index::{self, Index};
use super::parameter::{Columns, Parameters, Text};
use super::section::{Form, Sections};
use crate::diagnostic::Sink;
use crate::source::{Source, Span};

/// One file: its bytes and an index over them.
#[derive(Debug, Clone)]
pub struct ExchangeStructure {
    source: Source,
    index: Index,
}

impl ExchangeStructure {
    /// Reads a file of IGES up to 5.3 in the fixed or the compressed form. Whatever is wrong goes to the sink.
    pub fn parse(source: Source, sink: &mut dyn Sink) -> Self {
        let index = index::build(source.bytes(), sink);
        Self { source, index }
    }

    /// The bytes.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// How directory and parameters are written.
    #[must_use]
    pub fn form(&self) -> Form {
        self.index.form
    }

    /// The cards of each section.
    #[must_use]
    pub fn sections(&self) -> &Sections {
        &self.index.sections
    }

    /// The lines of the file in its order: they tile it, but for a byte-order mark.
    #[must_use]
    pub fn lines(&self) -> Lines<'_> {
        self.lines_from(0)
    }

    /// The line that begins at an offset.
    #[must_use]
    pub fn line_at(&self, start: u32) -> Option<Line> {
        self.lines_from(start).next()
    }

    pub(super) fn lines_from(&self, start: u32) -> Lines<'_> {
        Lines::from(self.source.bytes(), self.index.breaks, start)
    }

    /// Whether lines have ends.
    #[must_use]
    pub fn breaks(&self) -> Breaks {
        self.index.breaks
    }

    /// What the global section says.
    #[must_use]
    pub fn global(&self) -> &Global {
        &self.index.global
    }

    /// The parameters of the global section, the delimiters included.
    #[must_use]
    pub fn global_parameters(&self) -> Parameters<'_> {
        let lines = &self.index.sections.global;
        let (bytes, delimiters) = (self.source.bytes(), self.index.global.delimiters);
        Parameters::new(Text { bytes, lines, columns: Columns::First(DATA), delimiters })
    }

    /// The entities in the order of their directory entries.
    pub fn instances(&self) -> impl ExactSizeIterator<Item = Instance<'_>> + DoubleEndedIterator {
        (0..self.len()).map(|position| Instance { structure: self, position })
    }

    /// How many entities there are. Positions run from 0 to below this.
    #[must_use]
    pub fn len(&self) -> u32 {
        offset(self.index.entries.len())
    }

    /// Whether there is no entity.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.entries.is_empty()
    }

    /// The entity of a name.
    #[must_use]
    pub fn instance(&self, number: EntryNumber) -> Option<Instance<'_>> {
        self.position(number).map(|position| Instance { structure: self, position })
    }

    /// The entity at a position.
    #[must_use]
    pub fn instance_at(&self, position: u32) -> Option<Instance<'_>> {
        (position < self.len()).then_some(Instance { structure: self, position })
    }

    /// Position of the entity of a name.
    #[must_use]
    pub fn position(&self, number: EntryNumber) -> Option<u32> {
        self.index.position(number)
    }

    /// The greatest name in the file: new names must lie above.
    #[must_use]
    pub fn greatest_number(&self) -> Option<EntryNumber> {
        self.instances().next_back().map(|instance| instance.number())
    }

    /// Reports every pointer to an entry that the file does not have.
    pub fn unresolved_pointers(&self, sink: &mut dyn Sink) {
        super::reverse_index::unresolved_pointers(self, sink);
    }

    /// Reports every record without record delimiter, and every record whose first parameter is not its entity type. The
    /// index does not look at parameters, so this is a pass of its own.
    pub fn damaged_records(&self, sink: &mut dyn Sink) {
        for instance in self.instances() {
            instance.damage(sink);
        }
    }
}

/// One entity of a file: a directory entry and a parameter record.
#[derive(Debug, Clone, Copy)]
pub struct Instance<'a> {
    structure: &'a ExchangeStructure,
    position: u32,
}

impl<'a> Instance<'a> {
    fn index_entry(&self) -> &'a index::Entry {
        &self.structure.index.entries[self.position as usize]
    }

    /// The file that it is of.
    #[must_use]
    pub fn structure(&self) -> &'a ExchangeStructure {
        self.structure
    }

    /// Position in the directory section.
    #[must_use]
    pub fn position(&self) -> u32 {
        self.position
    }

    /// Its name.
    #[must_use]
    pub fn number(&self) -> EntryNumber {
        self.structure.index.number_at(self.position as usize)
    }

    /// Its directory entry.
    #[must_use]
    pub fn entry(&self) -> &'a DirectoryEntry {
        &self.index_entry().directory
    }

    /// Offsets of its parameter cards, or lines in the compressed form.
    #[must_use]
    pub fn cards(&self) -> &'a [u32] {
        &self.structure.index.sections.parameter[self.index_entry().cards.range()]
    }

    /// Positions of its parameter cards in their section.
    #[must_use]
    pub fn card_range(&self) -> std::ops::Range<usize> {
        self.index_entry().cards.range()
    }

    /// The first card of its directory entry; the directory record in the compressed form.
    #[must_use]
    pub fn span(&self) -> Span {
        match self.structure.form() {
            Form::Fixed => {
                let start = self.structure.index.sections_start(self.position as usize);
                Span::new(start, start + offset(DATA))
            }
            Form::Compressed => self.structure.index.headers[self.position as usize],
        }
    }

    /// Where a field of the directory entry stands; `None` in the compressed form.
    #[must_use]
    pub fn field_span(&self, field: Field) -> Option<Span> {
        let (card, columns) = field.place();
        let at = *self.structure.index.sections.directory.get(2 * self.position as usize + card)?;
        Some(Span::new(at + offset(columns.start), at + offset(columns.end)))
    }

    /// All parameters, the entity type first.
    #[inline]
    #[must_use]
    pub fn record(&self) -> Parameters<'a> {
        Parameters::new(self.text())
    }

    pub(super) fn text(&self) -> Text<'a> {
        let columns = match self.structure.form() {
            Form::Fixed => Columns::First(card::PARAMETER_DATA),
            Form::Compressed => Columns::Whole,
        };
        let delimiters = self.structure.index.global.delimiters;
        Text { bytes: self.structure.source.bytes(), lines: self.cards(), columns, delimiters }
    }

    /// The parameters behind the entity type.
    #[inline]
    #[must_use]
    pub fn parameters(&self) -> Parameters<'a> {
        let mut parameters = self.record();
        parameters.next();
        parameters
    }

    fn damage(&self, sink: &mut dyn Sink) {
        // Without a card the index has said so.
        let Some(&first) = self.cards().first() else { return };
        let mut parameters = self.record();
        let stated = parameters.next().and_then(|parameter| parameter.as_i64());
        let span = Span::new(first, first + offset(card::PARAMETER_DATA.min(self.text().line(0).len())));
        if stated != Some(self.entry().entity_type.into()) {
            let message = format!(
                "the directory entry is of type {}, the parameters of {}",
                self.entry().entity_type,
                stated.map_or_else(|| "none".to_owned(), |stated| stated.to_string()),
            );
            sink.report(Code::TypeMismatch.note_on(self.number(), span, message));
        }
        parameters.by_ref().for_each(drop);
        if !parameters.is_terminated() && self.structure.form() == Form::Fixed {
            let message = "its parameters do not end with a record delimiter";
            sink.report(Code::MissingDelimiter.note_on(self.number(), span, message));
        }
    }
}
