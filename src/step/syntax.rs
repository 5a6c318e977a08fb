//! Tokens of ISO 10303-21 clear text: kind and extent, nothing decoded.
//!
//! [`Tokens`] cuts any bytes into tokens that tile them: each byte, white space and comments included,
//! belongs to exactly one token. Nothing here can fail; bytes that begin no token of the standard are
//! [`TokenKind::Junk`]. Structure (records, nesting) is not looked at: see
//! [`exchange_structure`](super::exchange_structure) and [`parameter`](super::parameter).

use memchr::{memchr, memchr3, memmem};

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

/// Reads the digits from `at` on: their value, `None` when it exceeds 64 bits or there are none, and their end.
#[inline]
pub(crate) fn number_at(bytes: &[u8], at: usize) -> (Option<u64>, usize) {
    /// Digits that always fit.
    const SAFE_DIGITS: usize = 19;
    let mut value = 0;
    let end = digits_at(bytes, at, &mut value);
    match end - at {
        0 => (None, end),
        1..=SAFE_DIGITS => (Some(value), end),
        _ => (checked_number(&bytes[at..end]), end),
    }
}

fn checked_number(digits: &[u8]) -> Option<u64> {
    digits.iter().try_fold(0_u64, |value, digit| value.checked_mul(10)?.checked_add(u64::from(digit - b'0')))
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

/// Eight digits `0`, as [`leading_digits`] takes them.
pub(super) const DIGIT_ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);

/// How many of eight bytes, the first in the lowest place, are digits before the first that is none.
#[inline]
pub(super) fn leading_digits(word: u64) -> usize {
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    const SIXES: u64 = 0x0606_0606_0606_0606;
    // A digit has the high half 3, and keeps it when 6 is added. A carry out of a byte disturbs only bytes
    // behind it, and that byte is no digit itself.
    let others = ((word & HIGH) ^ DIGIT_ZEROS) | ((word.wrapping_add(SIXES) & HIGH) ^ DIGIT_ZEROS);
    (others.trailing_zeros() / 8) as usize
}

/// The eight bytes from `at` on, the first in the lowest place; zeros behind the end.
#[inline]
pub(super) fn word_at(bytes: &[u8], at: usize) -> u64 {
    match bytes.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(chunk) => u64::from_le_bytes(*chunk),
        None => last_word(bytes, at),
    }
}

/// Like [`word_at`], for less than eight bytes from `at` on.
#[inline(never)]
fn last_word(bytes: &[u8], at: usize) -> u64 {
    match bytes.last_chunk() {
        // The last eight bytes, less those before `at`.
        Some(chunk) if at < bytes.len() => u64::from_le_bytes(*chunk) >> (8 * (at + 8 - bytes.len())),
        _ => bytes.iter().skip(at).rev().fold(0, |word, &byte| word << 8 | u64::from(byte)),
    }
}

/// End of the decimal digits from `at` on. Coordinates have many, so eight are looked at together.
#[inline]
pub(crate) fn digits_end(bytes: &[u8], mut at: usize) -> usize {
    loop {
        let found = leading_digits(word_at(bytes, at));
        if found < 8 {
            return at + found;
        }
        // Not by `found`: the next word can be looked at before this one is counted.
        at += 8;
    }
}

/// Appends the digits from `at` on to a number, which wraps around beyond 64 bits; gives their end.
#[inline]
pub(super) fn digits_at(bytes: &[u8], mut at: usize, number: &mut u64) -> usize {
    const SCALE: [u64; 8] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000];
    loop {
        let word = word_at(bytes, at);
        let found = leading_digits(word);
        if found == 0 {
            return at;
        }
        if found < 8 {
            // What is no digit is shifted out, and zeros come in before the first digit.
            let digits = (word ^ DIGIT_ZEROS) << (64 - 8 * found);
            *number = number.wrapping_mul(SCALE[found]).wrapping_add(eight_digits(digits));
            return at + found;
        }
        *number = number.wrapping_mul(100_000_000).wrapping_add(eight_digits(word ^ DIGIT_ZEROS));
        at += 8;
    }
}

/// The number of eight digits 0 to 9, the first in the lowest byte: neighbours are joined
/// three times, the left one times its power of ten moved onto the right one.
#[inline]
fn eight_digits(digits: u64) -> u64 {
    let pairs = digits.wrapping_mul(1 + (10 << 8)) >> 8;
    let fours = (pairs & 0x00ff_00ff_00ff_00ff).wrapping_mul(1 + (100 << 16)) >> 16;
    (fours & 0x0000_ffff_0000_ffff).wrapping_mul(1 + (10_000 << 32)) >> 32
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

    #[test]
    fn runs_of_digits_end_at_the_first_other_byte() {
        for length in 0..20 {
            for other in 0..=255_u8 {
                let mut bytes = b"01234567890123456789"[..length].to_vec();
                bytes.push(other);
                bytes.extend_from_slice(b"7777777777");
                let expected = if other.is_ascii_digit() { bytes.len() } else { length };
                assert_eq!(digits_end(&bytes, 0), expected, "{other} behind {length} digits");
            }
        }
    }
}
