//! Parameters of a record: a cursor over the text that decodes nothing before it is asked for.
//!
//! [`Parameters`] allocates nothing and never recurses: a list is skipped by counting parentheses, and read
//! when its own cursor is used. What cannot be read is a [`ParameterKind::Malformed`]; the next parameter
//! is found all the same. Values are not checked against any schema here.

use std::borrow::Cow;

use memchr::memchr3;

use super::exchange_structure::InstanceName;
use super::string;
use super::syntax::{self, TokenKind};
use crate::source::Span;

/// What a parameter is (ISO 10303-21:2016 clause 12).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// `$`: an optional attribute without value.
    Omitted,
    /// `*`: an attribute that a subtype derives.
    Derived,
    /// A number without point and exponent.
    Integer,
    /// A number with point or exponent.
    Real,
    /// `'…'`
    String,
    /// `.NAME.`, booleans and logicals included.
    Enumeration,
    /// `"…"`
    Binary,
    /// `#12`
    Reference,
    /// `(…)`
    List,
    /// `KEYWORD(…)`
    Typed,
    /// Edition 3: `@12`, `@NAME`, `#NAME` or `<resource>`.
    External,
    /// Text that is no parameter; empty where one is missing between commas.
    Malformed,
}

/// One parameter: its kind and its text, decoded when asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter<'a> {
    /// The file up to the end of the parameter.
    bytes: &'a [u8],
    start: usize,
    kind: ParameterKind,
    comments: Comments,
}

impl<'a> Parameter<'a> {
    /// What it is.
    #[inline]
    #[must_use]
    pub fn kind(&self) -> ParameterKind {
        self.kind
    }

    /// The bytes as they stand in the file: quotes and points, keyword and parentheses included.
    #[inline]
    #[must_use]
    pub fn text(&self) -> &'a [u8] {
        &self.bytes[self.start..]
    }

    /// Where it stands in the file.
    #[inline]
    #[must_use]
    pub fn span(&self) -> Span {
        syntax::span(self.start, self.bytes.len())
    }

    /// The keyword of `KEYWORD(…)` as written.
    #[must_use]
    pub fn keyword(&self) -> Option<&'a [u8]> {
        let end = || syntax::keyword_end(self.bytes, self.start + 1);
        (self.kind == ParameterKind::Typed).then(|| &self.bytes[self.start..end()])
    }

    /// A cursor over what stands in the parentheses of a list or of `KEYWORD(…)`.
    #[inline]
    #[must_use]
    pub fn members(&self) -> Option<Parameters<'a>> {
        let open = match self.kind {
            ParameterKind::List => self.start,
            ParameterKind::Typed => {
                syntax::trivia_end(self.bytes, syntax::keyword_end(self.bytes, self.start + 1))
            }
            _ => return None,
        };
        let bytes = &self.bytes[..self.bytes.len() - 1];
        Some(Parameters { bytes, at: open + 1, after_comma: false, comments: self.comments })
    }

    /// The parameter inside `KEYWORD(…)` when there is exactly one; any other parameter as it is.
    /// Unwraps one level.
    #[must_use]
    pub fn untyped(&self) -> Self {
        if self.kind == ParameterKind::Typed
            && let Some(mut inner) = self.members()
            && let (Some(only), None) = (inner.next(), inner.next())
        {
            return only;
        }
        *self
    }

    /// The inside of `KEYWORD(…)` when it is no such thing again.
    fn value(&self) -> Option<Self> {
        (self.kind == ParameterKind::Typed)
            .then(|| self.untyped())
            .filter(|inner| inner.kind != ParameterKind::Typed)
    }

    /// Value of a number. Accepts integers, a lower-case `e`, `.5` and `1.0E+0`; `None` for anything else and
    /// for a number beyond the range of `f64`, so the value is always finite.
    #[inline]
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        match self.kind {
            ParameterKind::Real | ParameterKind::Integer => crate::number::parse_real(self.text()),
            _ => self.value()?.as_f64(),
        }
    }

    /// Value of an integer that 64 bits hold.
    #[must_use]
    pub fn as_i64(&self) -> Option<i64> {
        match self.kind {
            ParameterKind::Integer => crate::number::parse_integer(self.text()),
            _ => self.value()?.as_i64(),
        }
    }

    /// Decoded text of a string; bytes that are neither ASCII nor UTF-8 are read as ISO 8859-1
    /// (see [`string::decode`] to learn whether that happened).
    #[must_use]
    pub fn as_str(&self) -> Option<Cow<'a, str>> {
        match self.kind {
            ParameterKind::String => Some(string::decode(self.text()).text),
            _ => self.value()?.as_str(),
        }
    }

    /// The instance that is referred to.
    #[inline]
    #[must_use]
    pub fn as_reference(&self) -> Option<InstanceName> {
        match self.kind {
            ParameterKind::Reference => {
                crate::number::number_at(self.bytes, self.start + 1).0.map(InstanceName)
            }
            _ => None,
        }
    }

    /// A cursor over the members of a list.
    #[inline]
    #[must_use]
    pub fn as_list(&self) -> Option<Parameters<'a>> {
        self.members().filter(|_| self.kind == ParameterKind::List)
    }

    /// The name of an enumeration item as written, without its points.
    #[must_use]
    pub fn as_enum(&self) -> Option<&'a [u8]> {
        match self.kind {
            ParameterKind::Enumeration => self.text().strip_prefix(b".")?.strip_suffix(b"."),
            _ => None,
        }
    }

    /// `.T.` or `.F.`
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        match self.as_enum()? {
            b"T" | b"t" => Some(true),
            b"F" | b"f" => Some(false),
            _ => None,
        }
    }

    /// `.T.`, `.F.` or `.U.`; the inner `None` is unknown.
    #[must_use]
    pub fn as_logical(&self) -> Option<Option<bool>> {
        match self.as_enum()? {
            b"U" | b"u" => Some(None),
            _ => self.as_bool().map(Some),
        }
    }

    /// Whether it is `$`.
    #[must_use]
    pub fn is_omitted(&self) -> bool {
        self.kind == ParameterKind::Omitted
    }
}

/// Whether comments may stand between parameters. Where none can, lists are skipped faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comments {
    /// The index found no comment inside any record of the file.
    Absent,
    /// There may be comments.
    Possible,
}

/// A cursor over the parameters between two parentheses. Copies are cheap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameters<'a> {
    /// The file up to the closing parenthesis: what follows is hidden, so that no token can run over it.
    bytes: &'a [u8],
    at: usize,
    /// A comma was read: a parameter must follow.
    after_comma: bool,
    comments: Comments,
}

impl<'a> Parameters<'a> {
    /// Cursor over `inside`, the span between the parentheses, of the file's `bytes`.
    #[inline]
    #[must_use]
    pub(crate) fn new(bytes: &'a [u8], inside: Span, comments: Comments) -> Self {
        let bytes = &bytes[..inside.end as usize];
        Self { bytes, at: inside.start as usize, after_comma: false, comments }
    }

    /// What is still to be read: for a fresh cursor, everything between the parentheses.
    #[must_use]
    pub fn span(&self) -> Span {
        syntax::span(self.at, self.bytes.len())
    }

    /// What begins at `start`, and goes on at `next` with something that may not stand there.
    #[cold]
    fn malformed(&mut self, start: usize, next: usize) -> Parameter<'a> {
        let next = delimiter(self.bytes, next);
        let end = trimmed_end(self.bytes, start, next);
        self.after_comma = next < self.bytes.len();
        self.at = next + usize::from(self.after_comma);
        self.parameter(ParameterKind::Malformed, start, end)
    }

    #[inline]
    fn parameter(&self, kind: ParameterKind, start: usize, end: usize) -> Parameter<'a> {
        Parameter { bytes: &self.bytes[..end], start, kind, comments: self.comments }
    }
}

impl<'a> Iterator for Parameters<'a> {
    type Item = Parameter<'a>;

    // A parameter that is handed back through memory costs more than reading it.
    #[inline(always)]
    fn next(&mut self) -> Option<Parameter<'a>> {
        let start = syntax::trivia_end(self.bytes, self.at);
        if start >= self.bytes.len() && !self.after_comma {
            self.at = self.bytes.len();
            return None;
        }
        let (kind, end) = parameter_at(self.bytes, start, self.comments);
        let next = syntax::trivia_end(self.bytes, end);
        self.after_comma = match self.bytes.get(next) {
            Some(b',') => true,
            None => false,
            Some(_) => return Some(self.malformed(start, next)),
        };
        self.at = next + usize::from(self.after_comma);
        Some(self.parameter(kind, start, end))
    }
}

/// Kind and end of the parameter at `at`, where no white space stands.
// The frequent kinds are asked for one by one: a jump through a table is guessed wrong at every other parameter.
#[inline]
fn parameter_at(bytes: &[u8], at: usize, comments: Comments) -> (ParameterKind, usize) {
    let Some(&first) = bytes.get(at) else { return (ParameterKind::Malformed, at) };
    if syntax::may_begin_number(first) {
        number_at(bytes, at)
    } else if first == b'#' {
        name_at(bytes, at)
    } else if first == b'(' {
        match list_end(bytes, at, comments) {
            Some(end) => (ParameterKind::List, end),
            None => (ParameterKind::Malformed, bytes.len()),
        }
    } else if first == b',' {
        (ParameterKind::Malformed, at)
    } else {
        token_parameter_at(bytes, at, comments)
    }
}

#[inline]
fn number_at(bytes: &[u8], at: usize) -> (ParameterKind, usize) {
    match syntax::number_token(bytes, at) {
        (TokenKind::Real, end) => (ParameterKind::Real, end),
        (TokenKind::Integer, end) => (ParameterKind::Integer, end),
        (_, end) => (ParameterKind::Malformed, end),
    }
}

fn token_parameter_at(bytes: &[u8], at: usize, comments: Comments) -> (ParameterKind, usize) {
    let (token, end) = syntax::solid_token_at(bytes, at);
    let kind = match token {
        TokenKind::String => ParameterKind::String,
        TokenKind::Real => ParameterKind::Real,
        TokenKind::Omitted => ParameterKind::Omitted,
        TokenKind::Derived => ParameterKind::Derived,
        TokenKind::Enumeration => ParameterKind::Enumeration,
        TokenKind::Binary => ParameterKind::Binary,
        TokenKind::ValueName | TokenKind::Resource => ParameterKind::External,
        TokenKind::Keyword => return typed_at(bytes, end, comments),
        _ => ParameterKind::Malformed,
    };
    (kind, end)
}

/// What begins with a keyword that ends at `end`.
fn typed_at(bytes: &[u8], end: usize, comments: Comments) -> (ParameterKind, usize) {
    let open = syntax::trivia_end(bytes, end);
    let close = (bytes.get(open) == Some(&b'(')).then(|| list_end(bytes, open, comments)).flatten();
    close.map_or((ParameterKind::Malformed, end), |close| (ParameterKind::Typed, close))
}

/// What begins with `#`: a reference, or a constant of edition 3.
#[inline]
fn name_at(bytes: &[u8], at: usize) -> (ParameterKind, usize) {
    let (name, end) = crate::number::number_at(bytes, at + 1);
    if name.is_some() && !bytes.get(end).is_some_and(|&byte| syntax::is_keyword_byte(byte)) {
        return (ParameterKind::Reference, end);
    }
    let end = syntax::keyword_end(bytes, at + 1);
    let constant = bytes[..end].get(at + 1).is_some_and(|byte| !byte.is_ascii_digit());
    (if constant { ParameterKind::External } else { ParameterKind::Malformed }, end)
}

/// Offset behind the parenthesis that closes the one at `open`; `None` when it is not closed.
#[inline]
pub(crate) fn list_end(bytes: &[u8], open: usize, comments: Comments) -> Option<usize> {
    match comments {
        Comments::Absent => list_end_plain(bytes, open),
        Comments::Possible => list_end_commented(bytes, open),
    }
}

fn list_end_plain(bytes: &[u8], open: usize) -> Option<usize> {
    let mut depth = 1_usize;
    let mut at = open + 1;
    loop {
        at += memchr3(b'(', b')', b'\'', bytes.get(at..)?)?;
        match bytes[at] {
            b'(' => depth += 1,
            b')' if depth == 1 => return Some(at + 1),
            b')' => depth -= 1,
            _ => {
                at = syntax::string_end(bytes, at)?;
                continue;
            }
        }
        at += 1;
    }
}

fn list_end_commented(bytes: &[u8], open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    let mut at = open;
    loop {
        match *bytes.get(at)? {
            b'(' => depth += 1,
            b')' if depth <= 1 => return Some(at + 1),
            b')' => depth -= 1,
            b'\'' => {
                at = syntax::string_end(bytes, at)?;
                continue;
            }
            b'/' => {
                if let Some(end) = syntax::comment_end(bytes, at) {
                    at = end;
                    continue;
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// Offset of the next comma outside lists and strings; the end when there is none.
fn delimiter(bytes: &[u8], mut at: usize) -> usize {
    while at < bytes.len() {
        at = match bytes[at] {
            b',' => return at,
            b'(' => list_end_commented(bytes, at).unwrap_or(bytes.len()),
            _ => syntax::token_at(bytes, at).1,
        };
    }
    bytes.len()
}

/// `end` without the white space before it.
fn trimmed_end(bytes: &[u8], start: usize, mut end: usize) -> usize {
    while end > start && syntax::is_whitespace(bytes[end - 1]) {
        end -= 1;
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(text: &str) -> Parameters<'_> {
        Parameters::new(text.as_bytes(), syntax::span(0, text.len()), Comments::Possible)
    }

    #[test]
    fn every_kind_is_recognised() {
        let text = "$,*,1,-2.5E1,'a,b)',.T.,\"0F\",#12,(1,(2)),LENGTH_MEASURE(3.),@4,<u#v>,!MY_TYPE()";
        let read: Vec<_> = parameters(text).collect();
        assert!(read[0].is_omitted() && read[1].kind() == ParameterKind::Derived);
        assert_eq!((read[2].as_i64(), read[2].as_f64()), (Some(1), Some(1.0)));
        assert_eq!((read[3].as_i64(), read[3].as_f64()), (None, Some(-25.0)));
        assert_eq!(read[4].as_str().as_deref(), Some("a,b)"));
        assert_eq!((read[5].as_enum(), read[5].as_bool()), (Some(b"T".as_slice()), Some(true)));
        assert_eq!(read[6].kind(), ParameterKind::Binary);
        assert_eq!(read[7].as_reference(), Some(InstanceName(12)));
        assert_eq!(read[8].as_list().map(Iterator::count), Some(2));
        assert_eq!(read[9].as_f64(), Some(3.0));
        assert!(read[10].kind() == ParameterKind::External && read[11].kind() == ParameterKind::External);
        assert_eq!(read[12].keyword(), Some(b"!MY_TYPE".as_slice()));
        assert_eq!(read.len(), 13);
    }

    #[test]
    fn malformed_parameters_do_not_hide_their_neighbours() {
        for (text, count) in
            [("1,,2", 3), ("1,", 2), (",", 2), ("1 2,3", 2), ("NAN,3", 2), ("(1,2", 1), ("", 0), (" ", 0)]
        {
            let read: Vec<_> = parameters(text).collect();
            assert_eq!(read.len(), count, "{text}");
            let malformed = read.iter().any(|parameter| parameter.kind() == ParameterKind::Malformed);
            assert_eq!(malformed, count > 0, "{text}");
        }
        assert_eq!(parameters("1 2,3").nth(1).and_then(|p| p.as_i64()), Some(3));
    }

    #[test]
    fn places_cover_the_whole_parameter() {
        let text = " 'x' , /*c*/ A( 1 ) , ( 2 ) ";
        let spans: Vec<_> = parameters(text).map(|parameter| &text[parameter.span().range()]).collect();
        assert_eq!(spans, ["'x'", "A( 1 )", "( 2 )"]);
    }
}
