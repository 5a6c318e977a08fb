//! The data section of the compressed form (IGES 5.3 section 2.3): each entity's directory fields, as far as they differ
//! from those of the entity before, and then its parameters on free lines.
//!
//! ```text
//! D33@1_128@9_00010001@14_12;
//! 128,1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,…;
//! ```
//!
//! Fields 2, 10, 11 and 20 follow from where things stand and are not written.

use memchr::memchr2;

use super::card::{DATA, offset};
use super::code::Code;
use super::directory_entry::{DirectoryEntry, EntryNumber, Field};
use super::index::{Cards, Entry, Numbers};
use super::parameter::{Columns, Delimiters, Parameters, Text};
use crate::diagnostic::Sink;
use crate::source::Span;

/// What the data section holds.
pub(super) struct Data {
    pub(super) entries: Vec<Entry>,
    pub(super) numbers: Numbers,
    /// From `D` to behind the record delimiter, for each entity.
    pub(super) headers: Vec<Span>,
}

/// Reads the lines of the data section. What cannot be read is reported; reading goes on at the next line that begins
/// with `D` and a number.
pub(super) fn read(bytes: &[u8], lines: &[u32], delimiters: Delimiters, sink: &mut dyn Sink) -> Data {
    let mut reader = Reader { bytes, lines, delimiters, sink, at: 0 };
    let mut data = Data { entries: Vec::new(), numbers: Numbers::Regular, headers: Vec::new() };
    let mut stated = Vec::new();
    let mut before = DirectoryEntry::default();
    while reader.at < lines.len() {
        let Some((number, directory, header)) = reader.header(&before) else { continue };
        before = directory;
        let cards = reader.parameters(number);
        stated.push(number.0);
        data.headers.push(header);
        data.entries.push(Entry { directory, cards });
    }
    data.numbers = numbers(stated, &data.headers, sink);
    data
}

/// Names of the entities: as stated, as long as these ascend.
fn numbers(stated: Vec<u32>, headers: &[Span], sink: &mut dyn Sink) -> Numbers {
    let regular = stated.iter().enumerate().all(|(at, number)| *number == 2 * offset(at) + 1);
    if regular {
        return Numbers::Regular;
    }
    if stated.windows(2).all(|pair| pair[0] < pair[1]) {
        return Numbers::Stated(stated);
    }
    let message = "the numbers of the entities do not ascend; entities are counted";
    sink.report(Code::SequenceNumber.note(headers[0], message));
    Numbers::Regular
}

struct Reader<'a, 's> {
    bytes: &'a [u8],
    lines: &'a [u32],
    delimiters: Delimiters,
    sink: &'s mut dyn Sink,
    /// Line that is read next.
    at: usize,
}

impl<'a> Reader<'a, '_> {
    fn line(&self, at: usize) -> &'a [u8] {
        let rest = &self.bytes[self.lines[at] as usize..];
        &rest[..memchr2(b'\n', b'\r', rest).unwrap_or(rest.len())]
    }

    fn bad(&mut self, at: usize, message: &str) {
        let start = self.lines[at];
        let span = Span::new(start, start + offset(self.line(at).len()));
        self.sink.report(Code::BadCompression.note(span, message));
    }

    /// The directory record at the current line; `None`, and a line passed, when there is none.
    fn header(&mut self, before: &DirectoryEntry) -> Option<(EntryNumber, DirectoryEntry, Span)> {
        let first = self.at;
        let line = self.line(first);
        self.at += 1;
        let Some((number, digits)) = entity_number(line) else {
            self.bad(first, "expected the directory fields of an entity, `D` and its number");
            return None;
        };
        let mut fields = line[1 + digits..].to_vec();
        let mut end = self.lines[first] + offset(line.len());
        // The fields may go on over more lines, each of which begins with a field.
        while !fields.contains(&self.delimiters.record) {
            if self.at >= self.lines.len() || self.line(self.at).first() != Some(&b'@') {
                self.bad(first, "the directory fields do not end with a record delimiter");
                break;
            }
            let more = self.line(self.at);
            fields.extend_from_slice(more);
            end = self.lines[self.at] + offset(more.len());
            self.at += 1;
        }
        let entry = self.fields(first, &fields, before);
        Some((number, entry, Span::new(self.lines[first], end)))
    }

    fn fields(&mut self, at: usize, text: &[u8], before: &DirectoryEntry) -> DirectoryEntry {
        let mut entry = *before;
        let text = text.split(|byte| *byte == self.delimiters.record).next().unwrap_or_default();
        for part in text.split(|byte| *byte == b'@').filter(|part| !part.iter().all(|byte| *byte == b' ')) {
            let underscore = part.iter().position(|byte| *byte == b'_');
            let number =
                underscore.and_then(|end| std::str::from_utf8(&part[..end]).ok()?.trim().parse().ok());
            let field = number.and_then(Field::from_number);
            let value = underscore.map(|end| trim(&part[end + 1..])).unwrap_or_default();
            let taken = field.is_some_and(|field| value.len() <= DATA && entry.set(field, value));
            if !taken {
                self.bad(at, &format!("`@{}` is no directory field", String::from_utf8_lossy(part)));
            }
        }
        entry
    }

    /// The lines of an entity's parameters and of the comments behind them: up to the next entity, which is the truth
    /// where the count of a text would run over it.
    fn parameters(&mut self, name: EntryNumber) -> Cards {
        let first = self.at;
        while self.at < self.lines.len() && entity_number(self.line(self.at)).is_none() {
            self.at += 1;
        }
        let (bytes, lines, delimiters) = (self.bytes, &self.lines[first..self.at], self.delimiters);
        let mut cursor = Parameters::new(Text { bytes, lines, columns: Columns::Whole, delimiters });
        cursor.by_ref().for_each(drop);
        if !cursor.is_terminated() {
            let message = format!("the parameters of {name} do not end with a record delimiter");
            self.bad(first.min(self.lines.len() - 1), &message);
        }
        Cards { first: offset(first), count: offset(self.at - first) }
    }
}

/// The number behind the `D` that a line begins with, and how many digits it has.
fn entity_number(line: &[u8]) -> Option<(EntryNumber, usize)> {
    let digits = line.strip_prefix(b"D")?;
    let count = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
    // A text may go on with such letters at the start of a line, but hardly with more than these.
    if digits.get(count).is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b' ') {
        return None;
    }
    let number = std::str::from_utf8(&digits[..count]).ok()?.parse().ok()?;
    Some((EntryNumber(number), count))
}

fn trim(text: &[u8]) -> &[u8] {
    text.trim_ascii()
}
