//! One pass over a file that finds its cards, then its directory entries and the cards of each record.
//!
//! Parameters are not looked at. Damage is diagnosed and the pass goes on; it takes linear time and does not recurse.
//!
//! INVARIANT: a parameter card belongs to one record at most.

use super::card::{self, Breaks, CARD, DATA, Line, Lines, PARAMETER_DATA, offset};
use super::code::Code;
use super::compressed;
use super::directory_entry::{DirectoryEntry, EntryNumber, Field};
use super::global::{self, Global};
use super::parameter::{self, Columns, Delimiters, Parameters, Text};
use super::section::{Form, SectionKind, Sections};
use crate::diagnostic::Sink;
use crate::source::Span;

/// Cards of one record: a range of the parameter section.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Cards {
    pub(super) first: u32,
    pub(super) count: u32,
}

impl Cards {
    pub(super) fn range(self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// One entity: its directory entry, and where its parameters stand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) directory: DirectoryEntry,
    pub(super) cards: Cards,
}

/// Names of the entries, by position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Numbers {
    /// 1, 3, 5, …
    Regular,
    /// As the cards state them, ascending.
    Stated(Vec<u32>),
}

/// Where everything stands.
#[derive(Debug, Clone)]
pub(super) struct Index {
    pub(super) form: Form,
    pub(super) breaks: Breaks,
    pub(super) sections: Sections,
    pub(super) global: Global,
    pub(super) entries: Vec<Entry>,
    pub(super) numbers: Numbers,
    /// Spans of the directory records of the compressed form, by position; empty in the fixed form.
    pub(super) headers: Vec<Span>,
}

/// Byte-order mark that some editors put before the first card.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads the whole file.
pub(super) fn build(bytes: &[u8], sink: &mut dyn Sink) -> Index {
    let start = if bytes.starts_with(MARK) { offset(MARK.len()) } else { 0 };
    let breaks = Breaks::of(&bytes[start as usize..]);
    let mut indexer = Indexer {
        bytes,
        sink,
        index: Index {
            form: Form::Fixed,
            breaks,
            sections: Sections::default(),
            global: Global::default(),
            entries: Vec::new(),
            numbers: Numbers::Regular,
            headers: Vec::new(),
        },
        long: None,
        at: SectionKind::Flag,
    };
    indexer.lines(start);
    if indexer.is_iges() {
        indexer.global();
        match indexer.index.form {
            Form::Fixed => indexer.fixed(),
            Form::Compressed => indexer.compressed(),
        }
        indexer.terminate();
    }
    indexer.index
}

struct Indexer<'a, 's> {
    bytes: &'a [u8],
    sink: &'s mut dyn Sink,
    index: Index,
    /// First card with bytes behind column 80, and how many there are.
    long: Option<(Line, usize)>,
    /// Section that is being read.
    at: SectionKind,
}

impl<'a> Indexer<'a, '_> {
    fn note(&mut self, code: Code, span: Span, message: impl Into<String>) {
        self.sink.report(code.note(span, message));
    }

    fn text(&self, line: Line) -> &'a [u8] {
        &self.bytes[line.start as usize..line.end as usize]
    }

    fn lines(&mut self, start: u32) {
        for line in Lines::from(self.bytes, self.index.breaks, start) {
            let text = self.text(line);
            match card::section_of(text) {
                Some(kind) => self.card(kind, line),
                None if text.iter().all(|byte| matches!(byte, b' ' | b'\t' | 0 | 0x1a)) => {}
                None => self.other(line),
            }
        }
        if let Some((line, count)) = self.long {
            let message = format!(
                "{count} cards have bytes behind column {CARD}, the first of them this; they are kept"
            );
            self.note(Code::LongCard, Span::new(line.start, line.end), message);
        }
    }

    #[inline]
    fn card(&mut self, kind: SectionKind, line: Line) {
        if self.at == SectionKind::Terminate {
            let span = Span::new(line.start, line.end);
            return self.note(Code::TrailingData, span, "a card behind the terminate card");
        }
        let in_cards = matches!(kind, SectionKind::Start | SectionKind::Global | SectionKind::Terminate);
        if self.index.form == Form::Compressed && !in_cards {
            return self.other(line);
        }
        if kind < self.at {
            self.late(kind, line);
        } else {
            self.at = kind;
        }
        if kind == SectionKind::Flag {
            if self.bytes[line.start as usize + DATA] == b'B' {
                self.note(
                    Code::BinaryForm,
                    Span::new(line.start, line.end),
                    "the file is in the binary form",
                );
                return;
            }
            self.index.form = Form::Compressed;
        }
        if (line.end - line.start) as usize > CARD {
            self.long.get_or_insert((line, 0)).1 += 1;
        }
        self.index.sections.push(kind, line.start);
    }

    /// A card behind the end of its section: its letter counts.
    #[cold]
    fn late(&mut self, kind: SectionKind, line: Line) {
        let message =
            format!("a card of the {} section within the {} section", kind.as_str(), self.at.as_str());
        self.note(Code::SectionOrder, Span::new(line.start, line.end), message);
    }

    /// A line without a section.
    fn other(&mut self, line: Line) {
        let data = self.index.form == Form::Compressed
            && matches!(self.at, SectionKind::Global | SectionKind::Parameter);
        if data {
            self.at = SectionKind::Parameter;
            return self.index.sections.push(SectionKind::Parameter, line.start);
        }
        let span = Span::new(line.start, line.end);
        if self.at == SectionKind::Terminate {
            return self.note(Code::TrailingData, span, "text behind the terminate card");
        }
        let length = line.end - line.start;
        let message =
            format!("a line of {length} columns without section letter and number in columns 73 to 80");
        self.note(Code::StrayLine, span, message);
    }

    /// Whether anything of the file is IGES.
    fn is_iges(&mut self) -> bool {
        let sections = &self.index.sections;
        let any = [&sections.start, &sections.global, &sections.directory, &sections.parameter];
        if any.iter().all(|cards| cards.is_empty()) {
            let end = offset(self.bytes.len().min(1));
            self.note(Code::NotIges, Span::new(0, end), "no line is a card of an IGES section");
            return false;
        }
        true
    }

    fn end(&self) -> Span {
        let end = offset(self.bytes.len());
        Span::new(end, end)
    }

    fn global(&mut self) {
        let end = self.end();
        let lines = std::mem::take(&mut self.index.sections.global);
        if lines.is_empty() {
            return global::missing(SectionKind::Global, end, self.sink);
        }
        let columns = Columns::First(DATA);
        let text = Text { bytes: self.bytes, lines: &lines, columns, delimiters: Delimiters::default() };
        let delimiters = parameter::delimiters(text);
        if delimiters.is_none() {
            let span = Span::new(lines[0], lines[0] + offset(DATA));
            let message =
                "the global section does not begin with two delimiters; comma and semicolon are taken";
            self.note(Code::BadDelimiters, span, message);
        }
        let delimiters = delimiters.unwrap_or_default();
        let mut parameters = Parameters::new(Text { delimiters, ..text });
        self.index.global = Global::decode(parameters.clone(), delimiters, self.sink);
        parameters.by_ref().for_each(drop);
        if !parameters.is_terminated() {
            let last = lines[lines.len() - 1];
            let message = "the global section has no record delimiter at its end";
            self.note(Code::BadGlobal, Span::new(last, last + offset(DATA)), message);
        }
        self.index.sections.global = lines;
    }

    fn fixed(&mut self) {
        for kind in [SectionKind::Directory, SectionKind::Parameter] {
            if self.index.sections.of(kind).is_empty() {
                let end = self.end();
                global::missing(kind, end, self.sink);
            }
        }
        self.directory();
        self.records();
        self.cut_off();
    }

    fn compressed(&mut self) {
        let delimiters = self.index.global.delimiters;
        let data = compressed::read(self.bytes, &self.index.sections.parameter, delimiters, self.sink);
        self.index.entries = data.entries;
        self.index.numbers = data.numbers;
        self.index.headers = data.headers;
        if self.index.entries.is_empty() {
            let end = self.end();
            global::missing(SectionKind::Parameter, end, self.sink);
        }
    }

    /// The file ends where a section was not yet through.
    fn cut_off(&mut self) {
        let sections = &self.index.sections;
        let half = sections.directory.len() % 2 == 1;
        let early = sections.terminate.is_empty()
            && (sections.parameter.is_empty() || sections.directory.is_empty() || self.last_record_is_open());
        if half || early {
            let end = self.end();
            let message =
                if half { "the last directory entry has one card" } else { "the file ends too early" };
            self.note(Code::Truncated, end, message);
        }
    }

    fn last_record_is_open(&self) -> bool {
        let last = self.index.entries.iter().max_by_key(|entry| entry.cards.first);
        last.is_some_and(|last| {
            let lines = &self.index.sections.parameter[last.cards.range()];
            let mut parameters =
                Parameters::new(Text::of_cards(self.bytes, lines, self.index.global.delimiters));
            parameters.by_ref().for_each(drop);
            !parameters.is_terminated()
        })
    }

    fn card_at(&self, offset: u32) -> &'a [u8] {
        // Columns 74 to 80 may be cut short by the line end.
        let rest = &self.bytes[offset as usize..];
        let card = &rest[..rest.len().min(CARD)];
        let end = card[DATA..].iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        &card[..end.map_or(card.len(), |end| DATA + end)]
    }

    fn directory(&mut self) {
        let cards = std::mem::take(&mut self.index.sections.directory);
        let mut entries = Vec::with_capacity(cards.len() / 2);
        let mut stated = Vec::new();
        let mut regular = true;
        for (position, pair) in cards.chunks_exact(2).enumerate() {
            let (first, second) = (self.card_at(pair[0]), self.card_at(pair[1]));
            let expected = 2 * offset(position) + 1;
            let number = card::sequence(first).unwrap_or(0);
            regular &= number == expected && card::sequence(second) == Some(expected + 1);
            stated.push(number);
            let name = EntryNumber(expected);
            let directory = DirectoryEntry::decode(first, second, |field| {
                self.sink.report(bad_field(name, field, pair));
            });
            entries.push(Entry { directory, cards: Cards::default() });
        }
        if !regular {
            self.index.numbers = self.numbers(stated, cards[0]);
        }
        self.index.entries = entries;
        self.index.sections.directory = cards;
    }

    /// Numbers of the entries where they do not count from one.
    fn numbers(&mut self, stated: Vec<u32>, first: u32) -> Numbers {
        let span = Span::new(first + offset(DATA), first + offset(DATA) + 1);
        let usable =
            stated.windows(2).all(|pair| pair[0] < pair[1]) && stated.iter().all(|number| number % 2 == 1);
        let message = if usable {
            "the directory entries do not count from one; their own numbers are taken"
        } else {
            "the numbers of the directory entries do not ascend; entries are counted"
        };
        self.note(Code::SequenceNumber, span, message);
        if usable { Numbers::Stated(stated) } else { Numbers::Regular }
    }

    fn records(&mut self) {
        let cards = std::mem::take(&mut self.index.sections.parameter);
        let sequences = self.sequences(&cards);
        let mut entries = std::mem::take(&mut self.index.entries);
        let mut claims = Claims { free: vec![true; cards.len()] };
        for (position, entry) in entries.iter_mut().enumerate() {
            let name = self.index.number_at(position);
            entry.cards = self.cards_of(name, position, &entry.directory, &cards, &sequences, &mut claims);
        }
        self.unowned(&entries, &cards);
        self.index.entries = entries;
        self.index.sections.parameter = cards;
    }

    /// How the cards of the parameter section are numbered.
    fn sequences(&mut self, cards: &[u32]) -> Sequences {
        let number = |at: usize| card::sequence(self.card_at(cards[at])).unwrap_or(0);
        let Some(wrong) = (0..cards.len()).find(|&at| number(at) != offset(at) + 1) else {
            return Sequences::Regular;
        };
        let stated: Vec<u32> = (0..cards.len()).map(number).collect();
        let ascending = stated.windows(2).all(|pair| pair[0] < pair[1]);
        let message = if ascending {
            "the parameter cards do not count from one; their own numbers are taken"
        } else {
            "the numbers of the parameter cards do not ascend; cards are counted"
        };
        self.note(Code::SequenceNumber, span_of(cards[wrong]), message);
        if ascending { Sequences::Stated(stated) } else { Sequences::Regular }
    }

    fn back_pointer(&self, card: u32) -> Option<EntryNumber> {
        let card = self.card_at(card);
        card::integer(&card[PARAMETER_DATA..DATA]).and_then(|number| EntryNumber::from_pointer(number.into()))
    }

    /// The cards of an entry: as many as point back to it, or as many as it states.
    fn cards_of(
        &mut self,
        name: EntryNumber,
        position: usize,
        directory: &DirectoryEntry,
        cards: &[u32],
        sequences: &Sequences,
        claims: &mut Claims,
    ) -> Cards {
        let place = Span::new(
            self.index.sections_start(position),
            self.index.sections_start(position) + offset(DATA),
        );
        let Some(first) = sequences.position(directory.parameter_data, cards.len()) else {
            let message =
                format!("its parameters begin at card {} of {}", directory.parameter_data, cards.len());
            self.sink.report(Code::ParameterPointer.note_on(name, place, message));
            return Cards::default();
        };
        let stated = usize::try_from(directory.parameter_cards).unwrap_or(0);
        let own = |card: &u32| self.back_pointer(*card) == Some(name);
        let rest = &cards[first..];
        let exact = (1..=rest.len()).contains(&stated)
            && own(&rest[0])
            && own(&rest[stated - 1])
            && rest.get(stated).is_none_or(|card| !own(card));
        if exact {
            return claims.take(first, stated);
        }
        let owned = rest.iter().take_while(|card| own(card)).count();
        if owned > 0 {
            let message = format!("states {stated} parameter cards, and {owned} point back to it");
            self.sink.report(Code::ParameterCount.note_on(name, place, message));
            return claims.take(first, owned);
        }
        let message = "its first parameter card points back to another entry";
        self.sink.report(Code::BackPointer.note_on(name, span_of(rest[0]), message));
        let found = claims.take(first, stated.clamp(1, rest.len()));
        if found.count == 0 {
            let message = "its parameter cards belong to another entry";
            self.sink.report(Code::ParameterPointer.note_on(name, place, message));
        }
        found
    }

    /// Cards that no entry leads to.
    fn unowned(&mut self, entries: &[Entry], cards: &[u32]) {
        let owned: u64 = entries.iter().map(|entry| u64::from(entry.cards.count)).sum();
        if owned == cards.len() as u64 {
            return;
        }
        let mut free = vec![true; cards.len()];
        for entry in entries {
            free[entry.cards.range()].fill(false);
        }
        if let Some(at) = free.iter().position(|free| *free) {
            let count = free.iter().filter(|free| **free).count();
            let message = format!("{count} parameter cards belong to no entry, the first of them this");
            self.note(Code::UnownedCards, span_of(cards[at]), message);
        }
    }

    fn terminate(&mut self) {
        let sections = &self.index.sections;
        let Some(&start) = sections.terminate.first() else {
            let end = self.end();
            return self.note(Code::MissingTerminate, end, "the file ends without a terminate card");
        };
        if self.index.form == Form::Compressed {
            // It states the counts of the fixed form that the file was made from.
            return;
        }
        let card = self.card_at(start);
        let counts = [
            (b'S', sections.start.len()),
            (b'G', sections.global.len()),
            (b'D', sections.directory.len()),
            (b'P', sections.parameter.len()),
        ];
        let wrong = counts.iter().enumerate().find(|(at, (letter, count))| {
            let field = &card[8 * at..8 * at + 8];
            let stated = card::integer(&field[1..]).and_then(|number| usize::try_from(number).ok());
            field[0] != *letter || stated != Some(*count)
        });
        if let Some((at, (letter, count))) = wrong {
            let stated = String::from_utf8_lossy(&card[8 * at..8 * at + 8]).into_owned();
            let message =
                format!("states `{stated}`, and the {} section has {count} cards", char::from(*letter));
            self.note(Code::TerminateCounts, span_of(start), message);
        }
    }
}

fn span_of(card: u32) -> Span {
    Span::new(card, card + offset(DATA))
}

fn bad_field(name: EntryNumber, field: Field, cards: &[u32]) -> crate::diagnostic::Diagnostic {
    let (card, columns) = field.place();
    let start = cards[card] + offset(columns.start);
    let span = Span::new(start, start + 8);
    if field == Field::EntityTypeAgain {
        let message = "the two cards of the entry state different entity types";
        return Code::TypeMismatch.note_on(name, span, message);
    }
    let message = format!("field {} of the directory entry is no number", field as usize);
    Code::BadDirectoryField.note_on(name, span, message)
}

/// How the cards of the parameter section are numbered.
enum Sequences {
    Regular,
    Stated(Vec<u32>),
}

impl Sequences {
    /// Position of the card that a directory entry points to.
    fn position(&self, pointer: i32, count: usize) -> Option<usize> {
        let pointer = u32::try_from(pointer).ok()?;
        match self {
            Self::Regular => (pointer as usize).checked_sub(1).filter(|at| *at < count),
            Self::Stated(numbers) => numbers.binary_search(&pointer).ok(),
        }
    }
}

/// Cards that entries have taken, so that none is read as two entities' own: what many claim would be read as often.
struct Claims {
    free: Vec<bool>,
}

impl Claims {
    /// Takes as many cards from `first` on as are free.
    fn take(&mut self, first: usize, count: usize) -> Cards {
        let wanted = &mut self.free[first..first + count];
        let free = wanted.iter().take_while(|free| **free).count();
        wanted[..free].fill(false);
        Cards { first: offset(first), count: offset(free) }
    }
}

impl Index {
    /// Name of the entry at a position.
    pub(super) fn number_at(&self, position: usize) -> EntryNumber {
        match &self.numbers {
            Numbers::Regular => EntryNumber(2 * offset(position) + 1),
            Numbers::Stated(numbers) => EntryNumber(numbers[position]),
        }
    }

    /// Position of the entry of a name.
    pub(super) fn position(&self, number: EntryNumber) -> Option<u32> {
        match &self.numbers {
            Numbers::Regular => {
                let position = number.0 / 2;
                (number.0 % 2 == 1 && (position as usize) < self.entries.len()).then_some(position)
            }
            Numbers::Stated(numbers) => numbers.binary_search(&number.0).ok().map(offset),
        }
    }

    /// Offset of the directory entry at a position.
    pub(super) fn sections_start(&self, position: usize) -> u32 {
        match self.form {
            Form::Fixed => self.sections.directory[2 * position],
            Form::Compressed => self.headers[position].start,
        }
    }
}
