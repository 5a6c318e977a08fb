//! Parameters of a record: a cursor over the text that decodes nothing before it is asked for.
//!
//! A record's text is the data columns of its cards, one behind the other: a Hollerith text may run over the end of a
//! card, and in real files a number may too. [`Parameters`] allocates nothing and never recurses. What cannot be read is
//! a [`ParameterKind::Malformed`]; the next parameter is found all the same. Values are not checked against any
//! schema here.

use std::borrow::Cow;

use memchr::memchr2;

use super::card::{PARAMETER_DATA, offset};
use super::directory_entry::EntryNumber;
use super::string;
use crate::number::{digits_end, parse_integer, parse_real, real_at};
use crate::source::Span;

/// The two delimiters of a file (IGES 5.3 section 2.2.4.3, parameters 1 and 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delimiters {
    /// Between parameters.
    pub parameter: u8,
    /// Behind the last.
    pub record: u8,
}

impl Default for Delimiters {
    fn default() -> Self {
        Self { parameter: b',', record: b';' }
    }
}

impl Delimiters {
    fn any(self, byte: u8) -> bool {
        byte == self.parameter || byte == self.record
    }
}

/// Which columns of a line belong to the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Columns {
    /// So many from the first on; every line has them.
    First(usize),
    /// All.
    Whole,
}

/// The text of a record: the data columns of its lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Text<'a> {
    pub(super) bytes: &'a [u8],
    /// Offsets of the lines.
    pub(super) lines: &'a [u32],
    pub(super) columns: Columns,
    pub(super) delimiters: Delimiters,
}

impl<'a> Text<'a> {
    /// The text of parameter cards of the fixed form.
    pub(super) fn of_cards(bytes: &'a [u8], lines: &'a [u32], delimiters: Delimiters) -> Self {
        Self { bytes, lines, columns: Columns::First(PARAMETER_DATA), delimiters }
    }

    /// The data columns of a line; empty behind the last.
    #[inline]
    pub(super) fn line(&self, index: usize) -> &'a [u8] {
        let Some(&start) = self.lines.get(index) else { return &[] };
        let rest = self.bytes.get(start as usize..).unwrap_or_default();
        match self.columns {
            Columns::First(count) => &rest[..rest.len().min(count)],
            Columns::Whole => &rest[..memchr2(b'\n', b'\r', rest).unwrap_or(rest.len())],
        }
    }

    /// Offset in the file of a place.
    #[inline]
    fn offset(&self, place: Place) -> u32 {
        self.lines[place.line as usize] + place.column
    }
}

/// A byte of a text by line and column, both from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Place {
    pub(super) line: u32,
    pub(super) column: u32,
}

/// What a parameter is (IGES 5.3 section 2.2.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// Nothing between two delimiters: the default of the parameter.
    Default,
    /// A number without point and exponent: an integer, a logical value or a pointer.
    Integer,
    /// A number with point or exponent.
    Real,
    /// A Hollerith text.
    String,
    /// Text that is no parameter.
    Malformed,
}

/// How a parameter was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lexed {
    Plain,
    /// A Hollerith text whose content starts here.
    Hollerith(Place),
    Malformed,
}

/// One parameter: where it stands, decoded when asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter<'a> {
    text: Text<'a>,
    start: Place,
    end: Place,
    lexed: Lexed,
}

impl<'a> Parameter<'a> {
    /// What it is.
    #[must_use]
    pub fn kind(&self) -> ParameterKind {
        match self.lexed {
            Lexed::Hollerith(_) => ParameterKind::String,
            Lexed::Malformed => ParameterKind::Malformed,
            Lexed::Plain => {
                let text = self.text();
                if text.is_empty() {
                    ParameterKind::Default
                } else if parse_integer(&text).is_some() {
                    ParameterKind::Integer
                } else if number(&text).is_some() {
                    ParameterKind::Real
                } else {
                    ParameterKind::Malformed
                }
            }
        }
    }

    /// The bytes as they stand in the file, without the blanks around them; over the end of a card joined.
    #[must_use]
    pub fn text(&self) -> Cow<'a, [u8]> {
        self.between(self.start)
    }

    /// Where it stands in the file, piece by piece: one, but for a value that runs over the end of a card.
    pub fn pieces(&self) -> impl Iterator<Item = Span> + use<'a> {
        let Self { text, start, end, .. } = *self;
        (start.line..=end.line).map(move |line| {
            let from = if line == start.line { start.column } else { 0 };
            let to = if line == end.line { end.column } else { offset(text.line(line as usize).len()) };
            let at = text.lines[line as usize];
            Span::new(at + from, at + to.max(from))
        })
    }

    /// Where its first piece stands in the file.
    #[must_use]
    pub fn span(&self) -> Span {
        let end = if self.end.line == self.start.line {
            self.end.column
        } else {
            offset(self.text.line(self.start.line as usize).len())
        };
        let at = self.text.offset(self.start);
        Span::new(at, at + end.saturating_sub(self.start.column))
    }

    /// Where it begins in its record.
    pub(super) fn start(&self) -> Place {
        self.start
    }

    /// Where it ends in its record.
    pub(super) fn end(&self) -> Place {
        self.end
    }

    #[inline]
    fn between(&self, from: Place) -> Cow<'a, [u8]> {
        if from.line == self.end.line {
            let line = self.text.line(from.line as usize);
            return Cow::Borrowed(&line[from.column as usize..self.end.column as usize]);
        }
        Cow::Owned(self.joined(from))
    }

    #[cold]
    fn joined(&self, from: Place) -> Vec<u8> {
        let mut joined = Vec::new();
        for line in from.line..=self.end.line {
            let all = self.text.line(line as usize);
            let start = if line == from.line { from.column as usize } else { 0 };
            let end = if line == self.end.line { self.end.column as usize } else { all.len() };
            joined.extend_from_slice(all.get(start..end).unwrap_or_default());
        }
        joined
    }

    /// Value of a number. Accepts integers, `.5`, and Fortran's `1.5D+03`; `None` for anything else, for a default
    /// and for a number beyond the range of `f64`, so the value is always finite.
    #[inline]
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        if self.lexed != Lexed::Plain {
            return None;
        }
        number(&self.text())
    }

    /// Value of an integer that 64 bits hold. A real without decimals counts, as some files have it.
    #[must_use]
    pub fn as_i64(&self) -> Option<i64> {
        if self.lexed != Lexed::Plain {
            return None;
        }
        let text = self.text();
        parse_integer(&text).or_else(|| {
            let value = number(&text)?;
            // 2^53: integers of an `f64` are exact up to here.
            (value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0).then_some(value as i64)
        })
    }

    /// The entry that it points to; `None` for zero and for what is no pointer.
    #[must_use]
    pub fn as_pointer(&self) -> Option<EntryNumber> {
        self.as_i64().and_then(EntryNumber::from_pointer)
    }

    /// Decoded content of a Hollerith text, blanks at both ends included.
    #[must_use]
    pub fn as_str(&self) -> Option<Cow<'a, str>> {
        self.as_bytes().map(string::decode)
    }

    /// Content of a Hollerith text.
    #[must_use]
    pub fn as_bytes(&self) -> Option<Cow<'a, [u8]>> {
        match self.lexed {
            Lexed::Hollerith(content) => Some(self.between(content)),
            _ => None,
        }
    }

    /// Whether nothing stands there.
    #[must_use]
    pub fn is_default(&self) -> bool {
        self.lexed == Lexed::Plain && self.start == self.end
    }
}

/// Value of a number as IGES and Fortran spell it.
#[inline]
fn number(text: &[u8]) -> Option<f64> {
    match real_at(text, 0) {
        Some((value, end)) if end == text.len() => Some(value),
        _ => unusual_number(text),
    }
}

/// Characters of a number at most: beyond, no file means one.
const NUMBER_LENGTH: usize = 400;

#[cold]
fn unusual_number(text: &[u8]) -> Option<f64> {
    let value = parse_real(text);
    if value.is_some() || text.len() > NUMBER_LENGTH {
        return value;
    }
    let exponent = memchr2(b'D', b'd', text)?;
    let mut spelled = text.to_vec();
    spelled[exponent] = b'E';
    parse_real(&spelled)
}

/// How far a cursor is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Open,
    /// Behind the record delimiter.
    Ended,
    /// Behind the last line, without a record delimiter.
    Unterminated,
}

/// A cursor over the parameters of a record, the first of them its entity type. Copies are cheap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameters<'a> {
    text: Text<'a>,
    /// Data columns of the line that is read.
    line: &'a [u8],
    index: usize,
    column: usize,
    state: State,
}

impl<'a> Parameters<'a> {
    pub(super) fn new(text: Text<'a>) -> Self {
        let state = if text.lines.is_empty() { State::Unterminated } else { State::Open };
        Self { text, line: text.line(0), index: 0, column: 0, state }
    }

    /// The text that it reads.
    pub(super) fn text(&self) -> Text<'a> {
        self.text
    }

    /// The delimiter that was read last; `None` when the text ended without one.
    pub(super) fn passed_delimiter(&self) -> Option<u8> {
        match self.state {
            State::Open => Some(self.text.delimiters.parameter),
            State::Ended => Some(self.text.delimiters.record),
            State::Unterminated => None,
        }
    }

    /// Whether the record delimiter was read: known when the cursor is through.
    #[must_use]
    pub fn is_terminated(&self) -> bool {
        self.state == State::Ended
    }

    /// Whether the text ended without a record delimiter.
    pub(super) fn is_unterminated(&self) -> bool {
        self.state == State::Unterminated
    }

    /// Where the cursor is in the file.
    pub(super) fn offset(&self) -> u32 {
        self.text.offset(self.place())
    }

    /// Where the cursor is.
    pub(super) fn place(&self) -> Place {
        Place { line: offset(self.index), column: offset(self.column) }
    }

    /// Whether nothing is left to be read.
    pub(super) fn is_through(&self) -> bool {
        self.state != State::Open
    }

    /// Reads on over `count` parameters; how many there were.
    pub(super) fn skip_over(&mut self, count: usize) -> usize {
        (0..count).take_while(|_| self.next().is_some()).count()
    }

    /// The next parameter as a number, defaults counting as zero; `None` behind the last, the parameter itself when
    /// it is something else.
    #[inline]
    pub(super) fn next_real(&mut self) -> Option<Result<f64, Parameter<'a>>> {
        if self.state == State::Open {
            let rest = self.line.get(self.column..).unwrap_or_default();
            if let Some((value, end)) = real_at(rest, 0)
                && rest.get(end) == Some(&self.text.delimiters.parameter)
            {
                self.column += end + 1;
                return Some(Ok(value));
            }
        }
        self.next_real_carefully()
    }

    fn next_real_carefully(&mut self) -> Option<Result<f64, Parameter<'a>>> {
        let parameter = self.next()?;
        let value = if parameter.is_default() { Some(0.0) } else { parameter.as_f64() };
        Some(value.ok_or(parameter))
    }

    /// Goes to the first byte that is no blank; false when the text ends before one.
    #[inline]
    fn skip_blanks(&mut self) -> bool {
        loop {
            while let Some(byte) = self.line.get(self.column) {
                if *byte != b' ' {
                    return true;
                }
                self.column += 1;
            }
            if !self.next_line() {
                return false;
            }
        }
    }

    fn next_line(&mut self) -> bool {
        if self.index + 1 >= self.text.lines.len() {
            return false;
        }
        self.index += 1;
        self.line = self.text.line(self.index);
        self.column = 0;
        true
    }

    /// Passes the delimiter at the cursor.
    #[inline]
    fn pass_delimiter(&mut self) {
        if self.line.get(self.column) == Some(&self.text.delimiters.record) {
            self.state = State::Ended;
        }
        self.column += 1;
    }

    /// A value that goes on over the end of its line, up to a delimiter or the end of the text.
    #[cold]
    fn crossing(&mut self, start: Place, lexed: Lexed) -> Parameter<'a> {
        let mut end = self.trimmed(self.line.len());
        loop {
            if !self.next_line() {
                self.column = self.line.len();
                self.state = State::Unterminated;
                break;
            }
            let found = memchr2(self.text.delimiters.parameter, self.text.delimiters.record, self.line);
            let here = self.trimmed(found.unwrap_or(self.line.len()));
            if here.column > 0 {
                end = here;
            }
            if let Some(found) = found {
                self.column = found;
                self.pass_delimiter();
                break;
            }
        }
        Parameter { text: self.text, start, end: end.max(start), lexed }
    }

    /// The place behind the last byte before a column that is no blank.
    fn trimmed(&self, column: usize) -> Place {
        let blank = self.line[..column].iter().rev().take_while(|byte| **byte == b' ').count();
        Place { line: offset(self.index), column: offset(column - blank) }
    }

    /// A Hollerith text at the cursor, if one stands there.
    fn hollerith(&mut self) -> Option<Parameter<'a>> {
        let start = self.place();
        let mut ahead = self.clone();
        let count = ahead.hollerith_count()?;
        let content = ahead.place();
        let Some(end) = ahead.passed(count) else {
            // The count reaches over the end of the record.
            let (found, column) = self.plain_end();
            return Some(self.plain(start, found, column, Lexed::Malformed));
        };
        *self = ahead;
        let lexed = Lexed::Hollerith(content);
        let parameter = Parameter { text: self.text, start, end, lexed };
        if !self.skip_blanks() {
            self.state = State::Unterminated;
            return Some(parameter);
        }
        if self.text.delimiters.any(self.line[self.column]) {
            self.pass_delimiter();
            return Some(parameter);
        }
        let (found, column) = self.plain_end();
        Some(self.plain(start, found, column, Lexed::Malformed))
    }

    /// Reads digits and an `H`.
    fn hollerith_count(&mut self) -> Option<usize> {
        let mut count = 0_usize;
        let mut digits = 0;
        loop {
            let end = digits_end(self.line, self.column);
            for digit in &self.line[self.column..end] {
                count = count.checked_mul(10)?.checked_add(usize::from(digit - b'0'))?;
                digits += 1;
            }
            self.column = end;
            if end < self.line.len() || !self.next_line() {
                break;
            }
        }
        let found = matches!(self.line.get(self.column), Some(b'H' | b'h')) && digits > 0;
        self.column += 1;
        found.then_some(count)
    }

    /// Goes on over so many bytes; the place behind them, `None` when the text is shorter.
    fn passed(&mut self, mut count: usize) -> Option<Place> {
        loop {
            let left = self.line.len() - self.column.min(self.line.len());
            if count <= left {
                self.column += count;
                return Some(self.place());
            }
            count -= left;
            if !self.next_line() {
                return None;
            }
        }
    }

    /// Where a plain value at the cursor ends: whether a delimiter stands there, and the column.
    #[inline]
    fn plain_end(&self) -> (bool, usize) {
        let rest = &self.line[self.column.min(self.line.len())..];
        match memchr2(self.text.delimiters.parameter, self.text.delimiters.record, rest) {
            Some(found) => (true, self.column + found),
            None => (false, self.line.len()),
        }
    }

    #[inline]
    fn plain(&mut self, start: Place, found: bool, column: usize, lexed: Lexed) -> Parameter<'a> {
        if !found {
            return self.crossing(start, lexed);
        }
        let end = self.trimmed(column).max(start);
        self.column = column;
        self.pass_delimiter();
        Parameter { text: self.text, start, end, lexed }
    }

    /// Whether the digits at the cursor may be the count of a text.
    #[inline]
    fn may_be_count(&self) -> bool {
        let end = digits_end(self.line, self.column);
        end > self.column && matches!(self.line.get(end), None | Some(b'H' | b'h'))
    }
}

impl<'a> Iterator for Parameters<'a> {
    type Item = Parameter<'a>;

    #[inline]
    fn next(&mut self) -> Option<Parameter<'a>> {
        if self.state != State::Open {
            return None;
        }
        if !self.skip_blanks() {
            self.state = State::Unterminated;
            return None;
        }
        if self.may_be_count()
            && let Some(parameter) = self.hollerith()
        {
            return Some(parameter);
        }
        let start = self.place();
        let (found, column) = self.plain_end();
        Some(self.plain(start, found, column, Lexed::Plain))
    }
}

/// Whether a byte may be a delimiter: no blank, digit, sign, point or letter of a number or a text (IGES 5.3 section
/// 2.2.2).
#[must_use]
pub fn may_delimit(byte: u8) -> bool {
    byte.is_ascii_graphic()
        && !byte.is_ascii_digit()
        && !matches!(byte, b'+' | b'-' | b'.' | b'D' | b'E' | b'H')
}

/// The delimiters that the global section begins with; `None` when it begins otherwise.
#[must_use]
pub(super) fn delimiters(text: Text<'_>) -> Option<Delimiters> {
    let line = text.line(0);
    let mut at = line.iter().position(|byte| *byte != b' ')?;
    let mut found = Delimiters::default();
    // `,` alone, or `1Hx` and then the delimiter that it names.
    if line[at] == found.parameter {
        at += 1;
    } else {
        found.parameter = one_character(line, at).filter(|byte| line.get(at + 3) == Some(byte))?;
        at += 4;
    }
    at += line.get(at..)?.iter().position(|byte| *byte != b' ')?;
    if line[at] != found.parameter {
        found.record = one_character(line, at)?;
        let behind = line.get(at + 3..)?.iter().find(|byte| **byte != b' ')?;
        if !found.any(*behind) {
            return None;
        }
    }
    let legal = [found.parameter, found.record].into_iter().all(may_delimit);
    (legal && found.parameter != found.record).then_some(found)
}

fn one_character(line: &[u8], at: usize) -> Option<u8> {
    match line.get(at..at + 3)? {
        [b'1', b'H' | b'h', byte] => Some(*byte),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cards of 64 columns with the given data, and their offsets.
    fn cards(data: &[&str]) -> (Vec<u8>, Vec<u32>) {
        let bytes: String = data.iter().map(|line| format!("{line:64}       1P      1\n")).collect();
        let lines = (0..data.len()).map(|at| offset(81 * at)).collect();
        (bytes.into_bytes(), lines)
    }

    fn read(data: &[&str], check: impl FnOnce(Vec<Parameter<'_>>, Parameters<'_>)) {
        let (bytes, lines) = cards(data);
        let mut cursor = Parameters::new(Text::of_cards(&bytes, &lines, Delimiters::default()));
        let all: Vec<_> = cursor.by_ref().collect();
        check(all, cursor);
    }

    #[test]
    fn every_kind_is_recognised() {
        read(&["126, 1 ,-2.5D+01,,3Ha,;,1.,x,  ;comment"], |all, cursor| {
            use ParameterKind::*;
            let kinds: Vec<_> = all.iter().map(Parameter::kind).collect();
            assert_eq!(kinds, [Integer, Integer, Real, Default, String, Real, Malformed, Default]);
            assert_eq!(all[2].as_f64(), Some(-25.0));
            assert_eq!(all[4].as_str().as_deref(), Some("a,;"));
            assert!(cursor.is_terminated());
        });
    }

    #[test]
    fn texts_and_numbers_run_over_the_end_of_a_card() {
        let first = format!("{:>55},12Habcde", 406);
        let second = format!("fghijkl,{:>54}12", "");
        read(&[&first, &second, "34.5;"], |all, cursor| {
            assert_eq!(all[0].as_i64(), Some(406));
            assert_eq!(all[1].as_str().as_deref(), Some("abcdefghijkl"));
            assert_eq!(all[1].pieces().count(), 2);
            assert_eq!(all[2].as_f64(), Some(1234.5));
            assert!(cursor.is_terminated() && all.len() == 3);
        });
    }

    #[test]
    fn blanks_before_the_end_of_a_card_belong_to_no_number() {
        read(&["1,2.5", ",3.5  ", "  ;"], |all, _| {
            let values: Vec<_> = all.iter().map(Parameter::as_f64).collect();
            assert_eq!(values, [Some(1.0), Some(2.5), Some(3.5)]);
        });
    }

    #[test]
    fn counts_beyond_the_record_and_missing_ends_are_survived() {
        read(&["406,9999999999999Hab,5;"], |all, cursor| {
            let kinds: Vec<_> = all.iter().map(Parameter::kind).collect();
            assert_eq!(kinds, [ParameterKind::Integer, ParameterKind::Malformed, ParameterKind::Integer]);
            assert!(cursor.is_terminated());
        });
        read(&["116,1.,2."], |all, cursor| {
            assert_eq!(all.len(), 3);
            assert!(!cursor.is_terminated());
        });
        read(&["3Habcx,1;"], |all, _| assert_eq!(all[0].kind(), ParameterKind::Malformed));
    }

    #[test]
    fn numbers_are_read_in_bulk_as_one_by_one() {
        let (bytes, lines) = cards(&["1.5,-2.,,7,1D2 , .5,", "4.;"]);
        let mut cursor = Parameters::new(Text::of_cards(&bytes, &lines, Delimiters::default()));
        let values: Vec<_> = std::iter::from_fn(|| cursor.next_real()).map(|value| value.ok()).collect();
        assert_eq!(values, [1.5, -2.0, 0.0, 7.0, 100.0, 0.5, 4.0].map(Some));
    }

    #[test]
    fn delimiters_are_those_that_the_global_section_names() {
        let of = |line: &str| {
            let bytes = format!("{line:72}G      1");
            let columns = Columns::First(72);
            delimiters(Text {
                bytes: bytes.as_bytes(),
                lines: &[0],
                columns,
                delimiters: Delimiters::default(),
            })
            .map(|found| (char::from(found.parameter), char::from(found.record)))
        };
        assert_eq!(of("1H,,1H;,4Hname"), Some((',', ';')));
        assert_eq!(of(",,4Hname"), Some((',', ';')));
        assert_eq!(of("1H//1H#/4Hname"), Some(('/', '#')));
        assert_eq!(of(",1H$,4Hname"), Some((',', '$')));
        assert_eq!(of("1H;,1H;,"), None);
        assert_eq!(of("1H5,1H;5"), None);
        assert_eq!(of("name"), None);
    }
}
