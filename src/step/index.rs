//! One pass over a file that finds its sections and records.
//!
//! The pass looks only at what may end a record: semicolons, quotes and comments. Parameters are not looked at.
//! Damage is diagnosed and the pass goes on at the next record; it takes linear time and does not recurse.

use std::collections::{BTreeMap, BTreeSet};

use memchr::{memchr, memchr_iter, memchr3, memmem};

use super::code::Code;
use super::name_table::{DenseBuilder, Insertion, NameTable};
use super::parameter::{self, Comments};
use super::section::{Entry, Section, SectionKind};
use super::syntax::{self, TokenKind};
use crate::diagnostic::Sink;
use crate::source::Span;

/// Extent of a record, from `#` to behind `;`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RecordSpan {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// Where everything stands.
#[derive(Debug, Clone)]
pub(super) struct Index {
    pub(super) sections: Vec<Section>,
    pub(super) header: Vec<Span>,
    pub(super) records: Vec<RecordSpan>,
    pub(super) names: NameTable,
    /// For each record with a scope, by its start: what stands behind the scope.
    pub(super) scope_bodies: BTreeMap<u32, u32>,
    /// Whether comments stand inside records.
    pub(super) comments: Comments,
    pub(super) anchors: Vec<Entry>,
    pub(super) references: Vec<Entry>,
}

/// Reads the whole file.
pub(super) fn build(bytes: &[u8], sink: &mut dyn Sink) -> Index {
    let mut indexer = Indexer {
        bytes,
        at: 0,
        sink,
        sections: Vec::new(),
        header: Vec::new(),
        records: Vec::new(),
        dense: DenseBuilder::default(),
        anchors: Vec::new(),
        references: Vec::new(),
        scopes: Vec::new(),
        scope_bodies: BTreeMap::new(),
        comments: Comments::Absent,
        lower_case_seen: false,
        truncated: false,
        duplicates: BTreeSet::new(),
    };
    if indexer.opening() {
        indexer.sections();
    }
    indexer.finish()
}

/// How a record begins.
struct Head {
    /// `None` when it exceeds 64 bits.
    name: Option<u64>,
    /// First byte behind `=` and white space.
    body: usize,
}

/// Reads `#12 =` at `at`; `None` when something else stands there.
fn record_head(bytes: &[u8], at: usize) -> Option<Head> {
    let (name, end) = crate::number::number_at(bytes, at + 1);
    let body = behind_equals(bytes, end).filter(|_| end > at + 1)?;
    Some(Head { name, body })
}

/// First byte behind the `#12 =` at `at` and white space; `None` when something else stands there.
#[inline]
pub(super) fn body_start(bytes: &[u8], at: usize) -> Option<usize> {
    let end = crate::number::digits_end(bytes, at + 1);
    behind_equals(bytes, end).filter(|_| end > at + 1)
}

/// Behind the equals sign at or behind `at`, and white space.
#[inline]
fn behind_equals(bytes: &[u8], at: usize) -> Option<usize> {
    let equals = syntax::trivia_end(bytes, at);
    (bytes.get(equals) == Some(&b'=')).then(|| syntax::trivia_end(bytes, equals + 1))
}

/// Whether `#12 =` stands at `at`. Comments are not looked for, so that searching with this takes linear time
/// whatever the bytes.
fn begins_record(bytes: &[u8], at: usize) -> bool {
    let digits = crate::number::digits_end(bytes, at + 1);
    bytes.get(at) == Some(&b'#')
        && digits > at + 1
        && bytes.get(syntax::whitespace_end(bytes, digits)) == Some(&b'=')
}

/// Behind `/#1,#2/` and white space.
fn export_list_end(bytes: &[u8], at: usize) -> usize {
    let start = syntax::trivia_end(bytes, at);
    if bytes.get(start) != Some(&b'/') {
        return start;
    }
    match memchr(b'/', &bytes[start + 1..]) {
        Some(found) => syntax::trivia_end(bytes, start + 1 + found + 1),
        None => start,
    }
}

/// How a statement ends.
enum End {
    /// Behind its semicolon.
    At(usize),
    /// A string is not closed; the statement is taken to end here, and the next record to follow.
    OpenString(usize),
    /// The file ends first.
    Missing,
}

/// Finds the semicolon that ends the statement whose inside contains `at`.
fn statement_end(bytes: &[u8], mut at: usize, comments: &mut Comments) -> End {
    while let Some(found) = bytes.get(at..).and_then(|rest| memchr3(b';', b'\'', b'/', rest)) {
        at += found;
        match bytes[at] {
            b';' => return End::At(at + 1),
            b'\'' => match string_end_or_damage(bytes, at) {
                Ok(end) => at = end,
                Err(end) => return end,
            },
            _ => match syntax::comment_end(bytes, at) {
                Some(end) => {
                    *comments = Comments::Possible;
                    at = end;
                }
                None => at += 1,
            },
        }
    }
    End::Missing
}

/// End of the string at `at`. A quote too few makes a string swallow the records behind it: when what follows
/// the closing quote cannot follow a string, and a record begins inside, the record is the truth.
fn string_end_or_damage(bytes: &[u8], at: usize) -> Result<usize, End> {
    let end = syntax::string_end(bytes, at);
    let plausible = end.and_then(|end| bytes.get(end));
    if plausible.is_some_and(|&next| matches!(next, b',' | b')' | b'/' | b';') || syntax::is_whitespace(next))
    {
        return end.ok_or(End::Missing);
    }
    let inside = &bytes[..end.unwrap_or(bytes.len())];
    match record_behind_semicolon(inside, at) {
        Some(semicolon) => Err(End::OpenString(semicolon + 1)),
        None => end.ok_or(End::Missing),
    }
}

/// The first semicolon from `at` on that a line end and then a record or `ENDSEC` follow.
fn record_behind_semicolon(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        let semicolon = at + memchr(b';', bytes.get(at..)?)?;
        let next = syntax::whitespace_end(bytes, semicolon + 1);
        let broken = bytes[semicolon + 1..next].iter().any(|byte| matches!(byte, b'\r' | b'\n'));
        if broken && (begins_record(bytes, next) || bytes[next..].starts_with(b"ENDSEC")) {
            return Some(semicolon);
        }
        at = semicolon + 1;
    }
}

struct Indexer<'a, 's> {
    bytes: &'a [u8],
    at: usize,
    sink: &'s mut dyn Sink,
    sections: Vec<Section>,
    header: Vec<Span>,
    records: Vec<RecordSpan>,
    dense: DenseBuilder,
    anchors: Vec<Entry>,
    references: Vec<Entry>,
    /// Records whose scope is open.
    scopes: Vec<usize>,
    scope_bodies: BTreeMap<u32, u32>,
    comments: Comments,
    lower_case_seen: bool,
    truncated: bool,
    /// Where the records begin whose name came before, once reported.
    duplicates: BTreeSet<u32>,
}

impl Indexer<'_, '_> {
    fn note(&mut self, code: Code, start: usize, end: usize, message: impl Into<String>) {
        self.sink.report(code.note(syntax::span(start, end), message));
    }

    /// Finds `ISO-10303-21;`. Returns whether reading makes sense.
    fn opening(&mut self) -> bool {
        const MARK: &[u8] = b"ISO-10303-21";
        let compressed = match self.bytes {
            [0x1f, 0x8b, ..] => Some("gzip"),
            [b'P', b'K', 3, 4, ..] => Some("zip"),
            _ => None,
        };
        if let Some(container) = compressed {
            self.note(Code::Compressed, 0, 2, format!("the file is a {container} container, not clear text"));
            return false;
        }
        let start = syntax::trivia_end(self.bytes, 0);
        let found = if self.word_at(start).eq_ignore_ascii_case(MARK) {
            Some(start)
        } else {
            memmem::find(self.bytes, b"ISO-10303-21;")
        };
        let Some(mark) = found else {
            let message = "expected ISO-10303-21; at the beginning, found none";
            self.note(Code::NotExchangeStructure, 0, self.bytes.len().min(1), message);
            return memmem::find(self.bytes, b"DATA").is_some();
        };
        if mark > start {
            self.note(Code::LeadingJunk, start, mark, format!("{} bytes before ISO-10303-21;", mark - start));
        }
        self.at = mark + MARK.len();
        self.semicolon();
        true
    }

    /// The keyword at an offset; empty when there is none.
    fn word_at(&self, at: usize) -> &[u8] {
        &self.bytes[at..syntax::keyword_end(self.bytes, at)]
    }

    /// Skips white space and one semicolon.
    fn semicolon(&mut self) {
        let at = syntax::trivia_end(self.bytes, self.at);
        if self.bytes.get(at) == Some(&b';') {
            self.at = at + 1;
        }
    }

    fn sections(&mut self) {
        let mut ended = false;
        loop {
            self.at = syntax::trivia_end(self.bytes, self.at);
            if self.at >= self.bytes.len() {
                break;
            }
            let word = self.word_at(self.at);
            if let Some(kind) = SectionKind::from_keyword(word) {
                self.section(kind);
            } else if word.eq_ignore_ascii_case(b"END-ISO-10303-21") {
                self.at += word.len();
                self.semicolon();
                ended = true;
            } else if ended {
                let message = "text behind END-ISO-10303-21;";
                self.note(Code::TrailingData, self.at, self.bytes.len(), message);
                break;
            } else {
                self.stray_text();
            }
        }
        if !ended && !self.truncated {
            let end = self.bytes.len();
            self.note(Code::MissingEnd, end, end, "the file ends without END-ISO-10303-21;");
        }
    }

    /// Text between sections: records are read as a data section without opening, the rest is skipped.
    fn stray_text(&mut self) {
        let start = self.at;
        if begins_record(self.bytes, start) {
            self.note(Code::UnexpectedText, start, start + 1, "records outside a data section");
            self.body(SectionKind::Data, start, None);
            return;
        }
        let end = memchr(b';', &self.bytes[start..]).map_or(self.bytes.len(), |found| start + found + 1);
        self.note(Code::UnexpectedText, start, end, "expected a section, found other text");
        self.at = end;
    }

    /// A section from its keyword on.
    fn section(&mut self, kind: SectionKind) {
        let start = self.at;
        self.at += self.word_at(start).len();
        self.lower_case(start);
        let open = syntax::trivia_end(self.bytes, self.at);
        let mut parameters = None;
        if self.bytes.get(open) == Some(&b'(')
            && let Some(close) = parameter::list_end(self.bytes, open, Comments::Possible)
        {
            parameters = Some(syntax::span(open + 1, close - 1));
            self.at = close;
        }
        self.semicolon();
        self.body(kind, start, parameters);
    }

    /// The inside of a section and its `ENDSEC;`.
    fn body(&mut self, kind: SectionKind, start: usize, parameters: Option<Span>) {
        let body_start = self.at;
        match kind {
            SectionKind::Data => self.data(),
            SectionKind::Header => self.header(),
            SectionKind::Anchor | SectionKind::Reference => self.entries(kind),
            SectionKind::Signature => {
                let rest = &self.bytes[self.at..];
                self.at = memmem::find(rest, b"ENDSEC").map_or(self.bytes.len(), |found| self.at + found);
            }
        }
        if kind == SectionKind::Data {
            self.release_endsec(body_start);
        }
        let body_end = self.at;
        if self.word_at(self.at).eq_ignore_ascii_case(b"ENDSEC") {
            self.at += b"ENDSEC".len();
            self.semicolon();
        } else if self.at >= self.bytes.len() {
            self.truncate("the file ends inside a section");
        } else {
            self.note(Code::MissingEndsec, body_end, body_end, "expected ENDSEC; before this");
        }
        let span = syntax::span(start, self.at);
        self.sections.push(Section { kind, span, body: syntax::span(body_start, body_end), parameters });
    }

    /// When the last record of a section that begins at `body_start` lost its semicolon, it ends in `ENDSEC;`: goes
    /// back to before that word.
    fn release_endsec(&mut self, body_start: usize) {
        const WORD: &[u8] = b"ENDSEC";
        if self.word_at(self.at).eq_ignore_ascii_case(WORD) {
            return;
        }
        // A record of an earlier section is not this one's to shorten.
        let Some(last) = self.records.last_mut().filter(|last| last.start as usize >= body_start) else {
            return;
        };
        let (start, end) = (last.start as usize, last.end as usize);
        let Some(text) = self.bytes[start..end].strip_suffix(b";") else { return };
        let text = text.trim_ascii_end();
        let Some((record, word)) = text.split_last_chunk::<6>() else { return };
        if word.eq_ignore_ascii_case(WORD)
            && !record.last().is_some_and(|&byte| syntax::is_keyword_byte(byte))
        {
            let record_end = start + record.trim_ascii_end().len();
            last.end = syntax::span(start, record_end).end;
            self.at = start + record.len();
            self.note(Code::MissingSemicolon, start, record_end, "expected a semicolon behind this record");
        }
    }

    fn truncate(&mut self, message: &str) {
        if !self.truncated {
            let end = self.bytes.len();
            self.note(Code::Truncated, end, end, message);
        }
        self.truncated = true;
        self.at = self.bytes.len();
    }

    fn lower_case(&mut self, at: usize) {
        if !self.lower_case_seen && self.bytes.get(at).is_some_and(u8::is_ascii_lowercase) {
            self.lower_case_seen = true;
            let end = syntax::keyword_end(self.bytes, at);
            self.note(Code::LowerCaseKeyword, at, end, "keyword in lower case; this is said once for a file");
        }
    }

    /// Whether a word that closes or opens a section stands at `at`.
    fn at_section_border(&self, at: usize) -> bool {
        let word = self.word_at(at);
        word.eq_ignore_ascii_case(b"ENDSEC")
            || word.eq_ignore_ascii_case(b"END-ISO-10303-21")
            || SectionKind::from_keyword(word).is_some()
    }

    fn header(&mut self) {
        loop {
            let start = syntax::trivia_end(self.bytes, self.at);
            self.at = start;
            if start >= self.bytes.len() || self.at_section_border(start) {
                return;
            }
            self.lower_case(start);
            match statement_end(self.bytes, start, &mut Comments::Possible) {
                End::At(end) => {
                    self.header.push(syntax::span(start, end));
                    self.at = end;
                }
                End::OpenString(end) => {
                    self.note(Code::DamagedRecord, start, end, "a string in the header is not closed");
                    self.at = end;
                }
                End::Missing => return self.truncate("the file ends inside the header"),
            }
        }
    }

    /// The lines of an anchor or reference section.
    fn entries(&mut self, kind: SectionKind) {
        loop {
            let start = syntax::trivia_end(self.bytes, self.at);
            self.at = start;
            if start >= self.bytes.len() || self.at_section_border(start) {
                return;
            }
            let Some((entry, end)) = self.entry(start) else {
                return self.truncate("the file ends inside a line of the anchor or reference section");
            };
            match entry {
                Some(entry) if kind == SectionKind::Anchor => self.anchors.push(entry),
                Some(entry) => self.references.push(entry),
                None => self.note(Code::DamagedRecord, start, end, "expected name = item, found other text"),
            }
            self.at = end;
        }
    }

    /// One `name = item;` and its end.
    fn entry(&self, start: usize) -> Option<(Option<Entry>, usize)> {
        let mut equals = None;
        for (kind, span) in syntax::Tokens::starting_at(self.bytes, start) {
            match kind {
                TokenKind::Equals if equals.is_none() => equals = Some(span),
                TokenKind::Semicolon => {
                    let entry = equals.map(|equals| Entry {
                        name: self.trimmed(start, equals.start as usize),
                        item: self.trimmed(equals.end as usize, span.start as usize),
                    });
                    return Some((entry, span.end as usize));
                }
                _ => {}
            }
        }
        None
    }

    fn trimmed(&self, start: usize, end: usize) -> Span {
        let text = &self.bytes[start..end];
        let blank = |byte: &&u8| syntax::is_whitespace(**byte);
        let front = text.iter().take_while(blank).count();
        let back = text[front..].iter().rev().take_while(blank).count();
        syntax::span(start + front, end - back)
    }

    /// The records of a data section, up to its `ENDSEC`.
    fn data(&mut self) {
        loop {
            let start = syntax::trivia_end(self.bytes, self.at);
            self.at = start;
            match self.bytes.get(start) {
                None => break,
                Some(b'#') => {
                    if let Some(head) = record_head(self.bytes, start) {
                        self.record(start, &head);
                        continue;
                    }
                }
                Some(_) if self.at_section_border(start) => break,
                Some(_)
                    if !self.scopes.is_empty() && self.word_at(start).eq_ignore_ascii_case(b"ENDSCOPE") =>
                {
                    self.close_scope(start);
                    continue;
                }
                Some(_) => {}
            }
            self.at = self.resume(start);
            self.note(Code::UnexpectedText, start, self.at, "expected a record, found other text");
        }
        for position in std::mem::take(&mut self.scopes) {
            let start = self.records[position].start as usize;
            self.note(Code::DamagedRecord, start, start + 1, "the scope of this record is not closed");
        }
    }

    /// Where reading goes on behind text that is no record: at the next record or section border.
    fn resume(&self, at: usize) -> usize {
        let mut from = at + 1;
        while let Some(found) = self.bytes.get(from..).and_then(|rest| memchr3(b'#', b'E', b'e', rest)) {
            from += found;
            let border = self.bytes[from] != b'#'
                && !syntax::is_keyword_byte(self.bytes[from - 1])
                && self.at_section_border(from);
            if border || begins_record(self.bytes, from) {
                return from;
            }
            from += 1;
        }
        self.bytes.len()
    }

    fn record(&mut self, start: usize, head: &Head) {
        match self.bytes.get(head.body) {
            Some(b'&')
                if self.bytes[head.body + 1..].get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"SCOPE")) =>
            {
                return self.open_scope(start, head);
            }
            Some(b'A'..=b'Z' | b'(' | b'!' | b'_') | None => {}
            Some(b'a'..=b'z') => self.lower_case(head.body),
            Some(_) => {
                self.note(
                    Code::DamagedRecord,
                    start,
                    head.body,
                    "expected an entity keyword or a parenthesis",
                );
            }
        }
        match statement_end(self.bytes, head.body, &mut self.comments) {
            End::At(end) => self.push(start, end, head),
            End::OpenString(end) => {
                self.note(Code::DamagedRecord, start, end, "a string of this record is not closed");
                self.push(start, end, head);
            }
            End::Missing => self.truncate("the file ends inside a record"),
        }
    }

    fn push(&mut self, start: usize, end: usize, head: &Head) {
        self.at = end;
        let Some(name) = head.name else {
            let message =
                "the instance name exceeds 64 bits; the record is carried, but nothing can refer to it";
            return self.note(Code::InstanceNameTooLarge, start, end, message);
        };
        let position = u32::try_from(self.records.len()).expect("fewer records than bytes");
        if self.dense.insert(name, position) == Insertion::Duplicate {
            self.duplicate(name, start, end);
        }
        let Span { start, end } = syntax::span(start, end);
        self.records.push(RecordSpan { start, end });
    }

    fn duplicate(&mut self, name: u64, start: usize, end: usize) {
        let span = syntax::span(start, end);
        if self.duplicates.insert(span.start) {
            let message = format!("#{name} is defined again; the first definition is used");
            self.sink.report(Code::DuplicateInstance.note_on(format_args!("#{name}"), span, message));
        }
    }

    fn open_scope(&mut self, start: usize, head: &Head) {
        let behind = head.body + b"&SCOPE".len();
        self.note(
            Code::ScopeStructure,
            head.body,
            behind,
            "a scope, withdrawn from the standard since edition 2",
        );
        let position = self.records.len();
        self.push(start, behind, head);
        if self.records.len() > position {
            self.scopes.push(position);
        }
    }

    fn close_scope(&mut self, start: usize) {
        let body = export_list_end(self.bytes, start + b"ENDSCOPE".len());
        match statement_end(self.bytes, body, &mut self.comments) {
            End::At(end) | End::OpenString(end) => {
                self.at = end;
                if let Some(position) = self.scopes.pop() {
                    let record = &mut self.records[position];
                    record.end = syntax::span(start, end).end;
                    self.scope_bodies.insert(record.start, syntax::span(body, end).start);
                }
            }
            End::Missing => self.truncate("the file ends inside a record"),
        }
    }

    fn finish(mut self) -> Index {
        let dense = std::mem::take(&mut self.dense).finish();
        let names = match dense {
            Some(names) if !self.split_records() => names,
            _ => self.names(),
        };
        self.records.shrink_to_fit();
        Index {
            sections: self.sections,
            header: self.header,
            records: self.records,
            names,
            scope_bodies: self.scope_bodies,
            comments: self.comments,
            anchors: self.anchors,
            references: self.references,
        }
    }

    /// Parts records that lost their semicolon from those they swallowed; returns whether there was any.
    fn split_records(&mut self) -> bool {
        // Every whole record has one equals sign outside strings and comments. Counting all of them is far
        // cheaper than looking for them in each record, and most files have no others.
        let bodies = self.sections.iter().filter(|section| section.kind == SectionKind::Data);
        let equals: usize =
            bodies.map(|section| memchr_iter(b'=', &self.bytes[section.body.range()]).count()).sum();
        if equals <= self.records.len() {
            return false;
        }
        let records = std::mem::take(&mut self.records);
        let before = records.len();
        for record in records {
            self.split(record);
        }
        self.records.len() > before
    }

    /// Puts a record back, or the several that it holds.
    fn split(&mut self, record: RecordSpan) {
        let (start, end) = (record.start as usize, record.end as usize);
        let bytes = &self.bytes[..end];
        let Some(head) = record_head(bytes, start) else { return };
        let in_scope = bytes.get(head.body) == Some(&b'&');
        if in_scope || memchr(b'=', &bytes[head.body.min(end)..]).is_none() {
            return self.records.push(record);
        }
        let (mut part_start, mut part_end) = (start, head.body);
        for (kind, span) in syntax::Tokens::starting_at(bytes, head.body) {
            if matches!(kind, TokenKind::Whitespace | TokenKind::Comment) {
                continue;
            }
            let begin = span.start as usize;
            if kind == TokenKind::InstanceName
                && record_head(bytes, begin).is_some_and(|head| head.name.is_some())
            {
                self.note(
                    Code::MissingSemicolon,
                    part_start,
                    part_end,
                    "expected a semicolon behind this record",
                );
                let Span { start, end } = syntax::span(part_start, part_end);
                self.records.push(RecordSpan { start, end });
                part_start = begin;
            }
            part_end = span.end as usize;
        }
        let Span { start, end } = syntax::span(part_start, end);
        self.records.push(RecordSpan { start, end });
    }

    /// The table of names from the records as they are.
    fn names(&mut self) -> NameTable {
        let bytes = self.bytes;
        let name = |record: &RecordSpan| record_head(bytes, record.start as usize).and_then(|head| head.name);
        let named =
            (0_u32..).zip(&self.records).filter_map(|(position, record)| Some((name(record)?, position)));
        let mut duplicates = Vec::new();
        let mut dense = DenseBuilder::default();
        for (name, position) in named.clone() {
            if dense.insert(name, position) == Insertion::Duplicate {
                duplicates.push((name, position));
            }
        }
        let table = dense.finish().unwrap_or_else(|| {
            duplicates.clear();
            NameTable::sorted(named.collect(), |name, position| duplicates.push((name, position)))
        });
        duplicates.sort_unstable_by_key(|&(_, position)| position);
        for (name, position) in duplicates {
            let RecordSpan { start, end } = self.records[position as usize];
            self.duplicate(name, start as usize, end as usize);
        }
        table
    }
}
