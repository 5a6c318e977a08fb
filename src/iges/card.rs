//! Cards: lines of 80 columns, with whatever line ends and slips real files have.
//!
//! [`Lines`] cuts any bytes into lines that tile them; nothing here can fail. What stands in the columns is
//! others' knowledge.

use memchr::memchr2;

use super::section::SectionKind;

/// Columns of a card.
pub const CARD: usize = 80;
/// Columns of a card before the section letter: what a global or start card says.
pub const DATA: usize = 72;
/// Columns of a parameter card that hold parameters; behind them stands the pointer back.
pub const PARAMETER_DATA: usize = 64;
/// Greatest sequence number: seven columns.
pub const MAX_SEQUENCE: u32 = 9_999_999;

/// One line of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line {
    /// First byte.
    pub start: u32,
    /// Behind the last byte before the line end.
    pub end: u32,
    /// Behind the line end.
    pub next: u32,
}

/// Whether lines have ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Breaks {
    /// LF, CR or CRLF, one or several of these.
    Lines,
    /// Nothing stands between cards: each takes 80 bytes.
    None,
}

impl Breaks {
    /// Looks at the first two cards.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let head = &bytes[..bytes.len().min(2 * CARD)];
        if memchr2(b'\n', b'\r', head).is_some() {
            return Self::Lines;
        }
        let letters = [DATA, CARD + DATA].map(|at| bytes.get(at).copied().and_then(SectionKind::from_letter));
        if letters.iter().all(Option::is_some) { Self::None } else { Self::Lines }
    }
}

/// The lines of a file.
#[derive(Debug, Clone)]
pub struct Lines<'a> {
    bytes: &'a [u8],
    breaks: Breaks,
    at: usize,
}

impl<'a> Lines<'a> {
    /// All lines.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, breaks: Breaks::of(bytes), at: 0 }
    }

    /// The lines from an offset on, which must be the start of one.
    #[must_use]
    pub fn from(bytes: &'a [u8], breaks: Breaks, start: u32) -> Self {
        Self { bytes, breaks, at: start as usize }
    }

    /// Whether lines have ends.
    #[must_use]
    pub fn breaks(&self) -> Breaks {
        self.breaks
    }
}

impl Iterator for Lines<'_> {
    type Item = Line;

    #[inline]
    fn next(&mut self) -> Option<Line> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let found = match self.breaks {
            Breaks::Lines => memchr2(b'\n', b'\r', rest),
            // The last card may have a line end though no other has.
            Breaks::None => {
                let card = &rest[..rest.len().min(CARD)];
                memchr2(b'\n', b'\r', card).or((rest.len() > CARD).then_some(CARD))
            }
        };
        let end = found.unwrap_or(rest.len());
        let ending = match (rest.get(end), rest.get(end + 1)) {
            (Some(b'\r'), Some(b'\n')) => 2,
            (Some(b'\n' | b'\r'), _) => 1,
            _ => 0,
        };
        let start = self.at;
        self.at += end + ending;
        Some(Line { start: offset(start), end: offset(start + end), next: offset(self.at) })
    }
}

/// An offset of a source, which is below 4 GiB.
#[inline]
pub(super) fn offset(at: usize) -> u32 {
    debug_assert!(u32::try_from(at).is_ok());
    at as u32
}

/// The section of a line, by column 73 and a number in columns 74 to 80; `None` for any other line.
#[inline]
#[must_use]
pub fn section_of(line: &[u8]) -> Option<SectionKind> {
    let kind = SectionKind::from_letter(*line.get(DATA)?)?;
    let number = line.get(DATA + 1..line.len().min(CARD)).unwrap_or_default();
    let mut digits = 0;
    for byte in number {
        match byte {
            b'0'..=b'9' => digits += 1,
            b' ' => {}
            _ => return None,
        }
    }
    (digits > 0).then_some(kind)
}

/// Value of a field of at most eight columns that holds an integer; `Some(0)` when it is blank, `None` when it
/// holds anything else.
#[inline]
#[must_use]
pub fn integer(field: &[u8]) -> Option<i32> {
    debug_assert!(field.len() <= 8);
    let first = field.iter().position(|byte| *byte != b' ');
    let Some(first) = first else { return Some(0) };
    let negative = field[first] == b'-';
    let digits = &field[first + usize::from(negative || field[first] == b'+')..];
    let mut value = 0;
    let mut count = 0;
    for (at, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => {
                value = 10 * value + i32::from(byte - b'0');
                count += 1;
            }
            b' ' if count > 0 && digits[at..].iter().all(|byte| *byte == b' ') => break,
            _ => return None,
        }
    }
    (count > 0).then_some(if negative { -value } else { value })
}

/// The sequence number of a card.
#[inline]
#[must_use]
pub fn sequence(card: &[u8]) -> Option<u32> {
    let field = card.get(DATA + 1..card.len().min(CARD))?;
    integer(field).and_then(|number| u32::try_from(number).ok()).filter(|number| *number > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<(u32, u32, u32)> {
        Lines::new(text.as_bytes()).map(|line| (line.start, line.end, line.next)).collect()
    }

    #[test]
    fn every_line_end_is_found_and_none_when_there_is_none() {
        assert_eq!(lines("ab\r\nc\r\rd\ne"), [(0, 2, 4), (4, 5, 6), (6, 6, 7), (7, 8, 9), (9, 10, 10)]);
        let card = |letter: char, number: usize| format!("{:72}{letter}{number:7}", "x");
        let two = card('S', 1) + &card('G', 1);
        assert_eq!(lines(&two), [(0, 80, 80), (80, 160, 160)]);
        assert_eq!(lines(&format!("{two}\n")), [(0, 80, 80), (80, 160, 161)]);
        // A first line of 160 columns without letters is a long line.
        assert_eq!(lines(&format!("{}\nx", "y".repeat(200))), [(0, 200, 201), (201, 202, 202)]);
    }

    #[test]
    fn a_card_needs_its_letter_and_a_number() {
        let card = |tail: &str| section_of(format!("{:72}{tail}", "").as_bytes());
        assert_eq!(card("P      1"), Some(SectionKind::Parameter));
        assert_eq!(card("T0000001 "), Some(SectionKind::Terminate));
        assert_eq!(card("D1"), Some(SectionKind::Directory));
        assert_eq!([card("P"), card("P      x"), card("X      1"), card("")], [None; 4]);
    }

    #[test]
    fn fields_hold_integers_blanks_or_nothing_that_counts() {
        let cases: [(&str, Option<i32>); 9] = [
            ("     126", Some(126)),
            ("        ", Some(0)),
            ("-12     ", Some(-12)),
            ("00000001", Some(1)),
            ("      +7", Some(7)),
            ("   1 2  ", None),
            ("      -", None),
            ("     1.0", None),
            ("99999999", Some(99_999_999)),
        ];
        for (text, expected) in cases {
            assert_eq!(integer(text.as_bytes()), expected, "{text:?}");
        }
    }
}
