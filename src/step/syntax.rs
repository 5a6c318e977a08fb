//! Tokens of ISO 10303-21 clear text: kind and extent, nothing decoded.
//!
//! [`Tokens`] cuts any bytes into tokens that tile them: each byte, white space and comments included,
//! belongs to exactly one token. Nothing here can fail; bytes that begin no token of the standard are
//! [`TokenKind::Junk`]. Structure (records, nesting) is not looked at: see
//! [`exchange_structure`](super::exchange_structure) and [`parameter`](super::parameter).

use memchr::{memchr, memchr3, memmem};

use crate::number::digits_end;
use crate::source::Span;

/// What a token is (ISO 10303-21:2016 clauses 6.3 and 6.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TokenKind {
    /// Blanks, line ends, other control characters, a byte-order mark, print control directives.
    Whitespace,
    /// `/* … */`; runs to the end when it is not closed.
    Comment,
    /// Keyword, user-defined keyword (`!X`), section keyword, `ISO-10303-21`, `&SCOPE`.
    Keyword,
    /// `#12`, or a constant entity name `#NAME`.
    InstanceName,
    /// `@12`, or a constant value name `@NAME`.
    ValueName,
    /// `<…>`: anchor name or resource.
    Resource,
    /// Number without a point or an exponent.
    Integer,
    /// Number with a point or an exponent.
    Real,
    /// `'…'`, with both quotes.
    String,
    /// `.NAME.`, with both points.
    Enumeration,
    /// `"…"`, with both quotes.
    Binary,
    /// `$`.
    Omitted,
    /// `*`.
    Derived,
    /// `(`.
    Open,
    /// `)`.
    Close,
    /// `,`.
    Comma,
    /// `;`.
    Semicolon,
    /// `=`.
    Equals,
    /// Bytes that begin no token, or a token that is not closed.
    Junk,
}

/// Cuts bytes into tokens that tile them.
#[derive(Debug, Clone)]
pub struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    /// Tokens of all `bytes` (at most 4 GiB - 1).
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Tokens of `bytes` from an offset on.
    #[must_use]
    pub(crate) fn starting_at(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }
}

impl Iterator for Tokens<'_> {
    type Item = (TokenKind, Span);

    fn next(&mut self) -> Option<Self::Item> {
        let start = self.at;
        if start >= self.bytes.len() {
            return None;
        }
        let (kind, end) = token_at(self.bytes, start);
        self.at = end;
        Some((kind, span(start, end)))
    }
}

/// A span from offsets into a [`Source`](crate::source::Source), which is smaller than 4 GiB.
#[inline]
pub(crate) fn span(start: usize, end: usize) -> Span {
    let narrow = |at: usize| {
        debug_assert!(u32::try_from(at).is_ok(), "{at} lies behind every source");
        at as u32
    };
    Span::new(narrow(start), narrow(end))
}

/// The token that begins at `at < bytes.len()` and its end, which lies behind `at`.
pub(crate) fn token_at(bytes: &[u8], at: usize) -> (TokenKind, usize) {
    let trivia = whitespace_end(bytes, at);
    if trivia > at { (TokenKind::Whitespace, trivia) } else { solid_token_at(bytes, at) }
}

/// Like [`token_at`], where no white space begins at `at`.
#[inline]
pub(crate) fn solid_token_at(bytes: &[u8], at: usize) -> (TokenKind, usize) {
    match bytes[at] {
        b'/' => comment_end(bytes, at).map_or((TokenKind::Junk, at + 1), |end| (TokenKind::Comment, end)),
        b'(' => (TokenKind::Open, at + 1),
        b')' => (TokenKind::Close, at + 1),
        b',' => (TokenKind::Comma, at + 1),
        b';' => (TokenKind::Semicolon, at + 1),
        b'=' => (TokenKind::Equals, at + 1),
        b'$' => (TokenKind::Omitted, at + 1),
        b'*' => (TokenKind::Derived, at + 1),
        b'\'' => closed(TokenKind::String, string_end(bytes, at), at),
        b'"' => closed(TokenKind::Binary, binary_end(bytes, at), at),
        b'.' => dot_token(bytes, at),
        b'<' => closed(TokenKind::Resource, resource_end(bytes, at), at),
        b'#' => name_token(TokenKind::InstanceName, bytes, at),
        b'@' => name_token(TokenKind::ValueName, bytes, at),
        b'+' | b'-' | b'0'..=b'9' => number_token(bytes, at),
        b'!' | b'&' if bytes.get(at + 1).is_some_and(u8::is_ascii_alphabetic) => {
            (TokenKind::Keyword, keyword_end(bytes, at + 1))
        }
        b'_' | b'A'..=b'Z' | b'a'..=b'z' => (TokenKind::Keyword, keyword_end(bytes, at)),
        _ => (TokenKind::Junk, at + 1),
    }
}

/// A token that needs a closing mark: junk of one byte without it.
fn closed(kind: TokenKind, end: Option<usize>, at: usize) -> (TokenKind, usize) {
    end.map_or((TokenKind::Junk, at + 1), |end| (kind, end))
}

/// White space: the standard's blank and line ends; other controls and NUL padding, which real files have.
pub(crate) fn is_whitespace(byte: u8) -> bool {
    byte <= b' ' || byte == 0x7f
}

/// End of the white space at `at`; `at` itself when there is none.
pub(crate) fn whitespace_end(bytes: &[u8], mut at: usize) -> usize {
    while let Some(&byte) = bytes.get(at) {
        if is_whitespace(byte) {
            at += 1;
        } else if byte == b'\\' && is_print_control(bytes, at)
            || byte == 0xef && is_byte_order_mark(bytes, at)
        {
            at += 3;
        } else {
            break;
        }
    }
    at
}

/// `\N\` and `\F\` between tokens (ISO 10303-21 print control directives).
fn is_print_control(bytes: &[u8], at: usize) -> bool {
    matches!(bytes.get(at..at + 3), Some(b"\\N\\" | b"\\F\\"))
}

fn is_byte_order_mark(bytes: &[u8], at: usize) -> bool {
    bytes.get(at..at + 3) == Some(&[0xef, 0xbb, 0xbf])
}

/// Whether white space, a comment, a print control directive or a byte-order mark may begin with this byte.
static MAY_BEGIN_TRIVIA: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0_usize;
    while byte < table.len() {
        table[byte] = matches!(byte as u8, 0..=b' ' | b'/' | b'\\' | 0x7f | 0xef);
        byte += 1;
    }
    table
};

/// End of white space and comments at `at`. An unclosed comment runs to the end.
#[inline]
pub(crate) fn trivia_end(bytes: &[u8], at: usize) -> usize {
    // Between most tokens stands nothing.
    match bytes.get(at) {
        Some(&byte) if MAY_BEGIN_TRIVIA[usize::from(byte)] => trivia_end_slow(bytes, at),
        _ => at,
    }
}

#[inline(never)]
fn trivia_end_slow(bytes: &[u8], mut at: usize) -> usize {
    loop {
        at = whitespace_end(bytes, at);
        if bytes.get(at) != Some(&b'/') {
            return at;
        }
        match comment_end(bytes, at) {
            Some(end) => at = end,
            None => return at,
        }
    }
}

/// End of the comment that begins at `at`; `None` when `at` begins no comment.
pub(crate) fn comment_end(bytes: &[u8], at: usize) -> Option<usize> {
    let inside = bytes.get(at..)?.strip_prefix(b"/*")?;
    Some(memmem::find(inside, b"*/").map_or(bytes.len(), |found| at + 2 + found + 2))
}

/// Offset behind the closing quote of the string whose opening quote is at `at`.
#[inline]
pub(crate) fn string_end(bytes: &[u8], at: usize) -> Option<usize> {
    // Most strings are empty.
    match bytes.get(at + 1..at + 3) {
        Some([b'\'', next]) if *next != b'\'' => Some(at + 2),
        _ => string_end_slow(bytes, at),
    }
}

fn string_end_slow(bytes: &[u8], at: usize) -> Option<usize> {
    let mut from = at + 1;
    loop {
        let quote = from + memchr(b'\'', bytes.get(from..)?)?;
        if bytes.get(quote + 1) != Some(&b'\'') {
            return Some(quote + 1);
        }
        from = quote + 2;
    }
}

fn binary_end(bytes: &[u8], at: usize) -> Option<usize> {
    let end = at + 1 + bytes[at + 1..].iter().position(|byte| !byte.is_ascii_hexdigit())?;
    (bytes[end] == b'"').then_some(end + 1)
}

/// `<…>` on one line. Stopping at another `<` keeps the search linear over any bytes.
fn resource_end(bytes: &[u8], at: usize) -> Option<usize> {
    let end = at + 1 + memchr3(b'>', b'\n', b'<', &bytes[at + 1..])?;
    (bytes[end] == b'>').then_some(end + 1)
}

/// Letters, digits, `_` and `-`.
static KEYWORD_BYTES: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0_usize;
    while byte < table.len() {
        table[byte] = (byte as u8).is_ascii_alphanumeric() || matches!(byte as u8, b'_' | b'-');
        byte += 1;
    }
    table
};

#[inline]
pub(crate) fn is_keyword_byte(byte: u8) -> bool {
    KEYWORD_BYTES[usize::from(byte)]
}

/// End of the keyword bytes from `at` on.
#[inline]
pub(crate) fn keyword_end(bytes: &[u8], at: usize) -> usize {
    run_end(bytes, at, is_keyword_byte)
}

#[inline]
fn run_end(bytes: &[u8], mut at: usize, accept: impl Fn(u8) -> bool) -> usize {
    while bytes.get(at).is_some_and(|&byte| accept(byte)) {
        at += 1;
    }
    at
}

fn name_token(kind: TokenKind, bytes: &[u8], at: usize) -> (TokenKind, usize) {
    let end = keyword_end(bytes, at + 1);
    if end == at + 1 { (TokenKind::Junk, end) } else { (kind, end) }
}

/// `.5` is a real that no standard allows but files contain; `.T.` is an enumeration.
fn dot_token(bytes: &[u8], at: usize) -> (TokenKind, usize) {
    if bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
        return number_token(bytes, at);
    }
    let end = keyword_end(bytes, at + 1);
    if end > at + 1 && bytes.get(end) == Some(&b'.') {
        (TokenKind::Enumeration, end + 1)
    } else {
        (TokenKind::Junk, at + 1)
    }
}

/// Whether a digit or a sign: what a number begins with but for the forbidden `.5`.
#[inline]
pub(super) fn may_begin_number(byte: u8) -> bool {
    NUMBER_STARTS[usize::from(byte)]
}

/// Digits and signs.
static NUMBER_STARTS: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0_usize;
    while byte < table.len() {
        table[byte] = matches!(byte as u8, b'0'..=b'9' | b'+' | b'-');
        byte += 1;
    }
    table
};

/// Number at `at`, with the liberties that files take: `.5`, `1E5` without a point, lower-case `e`.
#[inline]
pub(super) fn number_token(bytes: &[u8], at: usize) -> (TokenKind, usize) {
    let signed = at + usize::from(matches!(bytes[at], b'+' | b'-'));
    let whole = digits_end(bytes, signed);
    let mut end = whole;
    let mut kind = TokenKind::Integer;
    if bytes.get(end) == Some(&b'.') {
        end = digits_end(bytes, end + 1);
        kind = TokenKind::Real;
    }
    if whole == signed && end <= whole + 1 {
        return (TokenKind::Junk, at + 1);
    }
    if matches!(bytes.get(end), Some(b'E' | b'e')) {
        let sign = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits_end(bytes, sign);
        if exponent > sign {
            return (TokenKind::Real, exponent);
        }
    }
    (kind, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers by the rule, a byte at a time.
    fn number_by_rule(bytes: &[u8]) -> (TokenKind, usize) {
        let digits = |at: usize| at + bytes[at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let signed = usize::from(matches!(bytes[0], b'+' | b'-'));
        let whole = digits(signed);
        let point = bytes.get(whole) == Some(&b'.');
        let end = if point { digits(whole + 1) } else { whole };
        if end - signed == usize::from(point) {
            return (TokenKind::Junk, 1);
        }
        let exponent = bytes.get(end).filter(|byte| byte.eq_ignore_ascii_case(&b'e')).map(|_| {
            let sign = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            (sign, digits(sign.min(bytes.len())))
        });
        match exponent {
            Some((sign, last)) if last > sign => (TokenKind::Real, last),
            _ => (if point { TokenKind::Real } else { TokenKind::Integer }, end),
        }
    }

    proptest::proptest! {
        #[test]
        fn numbers_end_where_the_rule_says(text in "[-+0-9.][0-9]{0,9}[-+.0-9eE,/]{0,4}[0-9]{0,18}[.,eE)\\PC]{0,3}[0-9]{0,9}") {
            proptest::prop_assert_eq!(number_token(text.as_bytes(), 0), number_by_rule(text.as_bytes()));
        }
    }
}
