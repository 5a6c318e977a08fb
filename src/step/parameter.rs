//! Parameters of a record: a cursor over the text that decodes nothing before it is asked for.
//!
//! [`Parameters`] allocates nothing and never recurses: a list is skipped by counting parentheses, and read
//! when its own cursor is used. What cannot be read is a [`Parameter::Malformed`]; the next parameter
//! is found all the same. Values are not checked against any schema here.

use std::borrow::Cow;

use memchr::memchr3;

use super::exchange_structure::InstanceName;
use super::string;
use super::syntax::{self, TokenKind};
use crate::source::Span;

/// The text of one token and its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token<'a> {
    text: &'a [u8],
    start: u32,
}

impl<'a> Token<'a> {
    #[inline]
    fn new(bytes: &'a [u8], start: usize, end: usize) -> Self {
        Self { text: &bytes[start..end], start: syntax::span(start, end).start }
    }

    /// The bytes as they stand in the file, quotes and points included.
    #[must_use]
    pub fn text(&self) -> &'a [u8] {
        self.text
    }

    /// Where it stands.
    #[must_use]
    pub fn span(&self) -> Span {
        let start = self.start as usize;
        syntax::span(start, start + self.text.len())
    }
}

/// One parameter (ISO 10303-21:2016 clause 12).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Parameter<'a> {
    /// `$`: an optional attribute without value.
    Omitted,
    /// `*`: an attribute that a subtype derives.
    Derived,
    /// A number without point and exponent.
    Integer(Token<'a>),
    /// A number with point or exponent.
    Real(Token<'a>),
    /// `'…'`
    String(Token<'a>),
    /// `.NAME.`, booleans and logicals included.
    Enumeration(Token<'a>),
    /// `"…"`
    Binary(Token<'a>),
    /// `#12`
    Reference(InstanceName),
    /// `(…)`
    List(Parameters<'a>),
    /// `KEYWORD(…)`
    Typed {
        /// The keyword as written.
        keyword: &'a [u8],
        /// What stands in its parentheses.
        parameters: Parameters<'a>,
    },
    /// Edition 3: `@12`, `@NAME`, `#NAME` or `<resource>`.
    External(Token<'a>),
    /// Text that is no parameter; empty where one is missing between commas.
    Malformed(Token<'a>),
}

impl<'a> Parameter<'a> {
    /// The parameter inside `KEYWORD(…)` when there is exactly one; any other parameter as it is.
    /// Unwraps one level.
    #[must_use]
    pub fn untyped(&self) -> Self {
        if let Self::Typed { parameters, .. } = self {
            let mut inner = parameters.clone();
            if let (Some(only), None) = (inner.next(), inner.next()) {
                return only;
            }
        }
        self.clone()
    }

    /// Value of a number. Accepts integers, a lower-case `e`, `.5` and `1.0E+0`; `None` for anything else and
    /// for a number beyond the range of `f64`, so the value is always finite.
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Real(token) | Self::Integer(token) => super::literal::parse_real(token.text),
            Self::Typed { .. } => match self.untyped() {
                Self::Typed { .. } => None,
                inner => inner.as_f64(),
            },
            _ => None,
        }
    }

    /// Value of an integer that 64 bits hold.
    #[must_use]
    pub fn as_i64(&self) -> Option<i64> {
        match self {
            Self::Integer(token) => super::literal::parse_integer(token.text),
            Self::Typed { .. } => match self.untyped() {
                Self::Typed { .. } => None,
                inner => inner.as_i64(),
            },
            _ => None,
        }
    }

    /// Decoded text of a string; bytes that are neither ASCII nor UTF-8 are read as ISO 8859-1
    /// (see [`string::decode`] to learn whether that happened).
    #[must_use]
    pub fn as_str(&self) -> Option<Cow<'a, str>> {
        match self {
            Self::String(token) => Some(string::decode(token.text).text),
            Self::Typed { .. } => match self.untyped() {
                Self::Typed { .. } => None,
                inner => inner.as_str(),
            },
            _ => None,
        }
    }

    /// The instance that is referred to.
    #[must_use]
    pub fn as_reference(&self) -> Option<InstanceName> {
        match self {
            Self::Reference(name) => Some(*name),
            _ => None,
        }
    }

    /// A cursor over the members of a list.
    #[must_use]
    pub fn as_list(&self) -> Option<Parameters<'a>> {
        match self {
            Self::List(members) => Some(members.clone()),
            _ => None,
        }
    }

    /// The name of an enumeration item as written, without its points.
    #[must_use]
    pub fn as_enum(&self) -> Option<&'a [u8]> {
        match self {
            Self::Enumeration(token) => token.text.get(1..token.text.len() - 1),
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
        matches!(self, Self::Omitted)
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
    bytes: &'a [u8],
    at: u32,
    end: u32,
    /// A comma was read: a parameter must follow.
    after_comma: bool,
    comments: Comments,
}

impl<'a> Parameters<'a> {
    /// Cursor over `inside`, the span between the parentheses, of the file's `bytes`.
    #[must_use]
    pub(crate) fn new(bytes: &'a [u8], inside: Span, comments: Comments) -> Self {
        Self { bytes, at: inside.start, end: inside.end, after_comma: false, comments }
    }

    /// What is still to be read: for a fresh cursor, everything between the parentheses.
    #[must_use]
    pub fn span(&self) -> Span {
        Span::new(self.at, self.end)
    }

    /// The next parameter with its place, keyword and parentheses included.
    pub fn next_with_span(&mut self) -> Option<(Parameter<'a>, Span)> {
        // Everything behind `end` is hidden, so that no token can run over the closing parenthesis.
        let bytes = &self.bytes[..self.end as usize];
        let start = syntax::trivia_end(bytes, self.at as usize);
        if start >= bytes.len() && !self.after_comma {
            self.at = self.end;
            return None;
        }
        let (mut parameter, mut end) = self.read(bytes, start);
        let mut next = syntax::trivia_end(bytes, end);
        if next < bytes.len() && bytes[next] != b',' {
            next = delimiter(bytes, next);
            end = trimmed_end(bytes, start, next);
            parameter = Parameter::Malformed(Token::new(bytes, start, end));
        }
        self.after_comma = next < bytes.len();
        self.at = syntax::span(start, next + usize::from(self.after_comma)).end;
        Some((parameter, syntax::span(start, end)))
    }

    /// The parameter at `at`, which is no white space, and its end.
    #[inline]
    fn read(&self, bytes: &'a [u8], at: usize) -> (Parameter<'a>, usize) {
        match bytes.get(at) {
            None | Some(b',') => (Parameter::Malformed(Token::new(bytes, at, at)), at),
            Some(b'#') => read_name(bytes, at),
            Some(b'(') => match list_end(bytes, at, self.comments) {
                Some(end) => (Parameter::List(self.inside(bytes, at + 1, end - 1)), end),
                None => (Parameter::Malformed(Token::new(bytes, at, bytes.len())), bytes.len()),
            },
            Some(_) => self.read_token(bytes, at),
        }
    }

    fn inside(&self, bytes: &'a [u8], start: usize, end: usize) -> Self {
        Self::new(bytes, syntax::span(start, end), self.comments)
    }

    #[inline]
    fn read_token(&self, bytes: &'a [u8], at: usize) -> (Parameter<'a>, usize) {
        let (kind, end) = syntax::solid_token_at(bytes, at);
        let token = Token::new(bytes, at, end);
        let parameter = match kind {
            TokenKind::Omitted => Parameter::Omitted,
            TokenKind::Derived => Parameter::Derived,
            TokenKind::Integer => Parameter::Integer(token),
            TokenKind::Real => Parameter::Real(token),
            TokenKind::String => Parameter::String(token),
            TokenKind::Enumeration => Parameter::Enumeration(token),
            TokenKind::Binary => Parameter::Binary(token),
            TokenKind::ValueName | TokenKind::Resource => Parameter::External(token),
            TokenKind::Keyword => return self.read_typed(bytes, token, end),
            _ => Parameter::Malformed(token),
        };
        (parameter, end)
    }

    fn read_typed(&self, bytes: &'a [u8], keyword: Token<'a>, end: usize) -> (Parameter<'a>, usize) {
        let open = syntax::trivia_end(bytes, end);
        if bytes.get(open) == Some(&b'(')
            && let Some(close) = list_end(bytes, open, self.comments)
        {
            let parameters = self.inside(bytes, open + 1, close - 1);
            return (Parameter::Typed { keyword: keyword.text, parameters }, close);
        }
        (Parameter::Malformed(keyword), end)
    }

    /// The parameters with their places.
    pub fn with_spans(mut self) -> impl Iterator<Item = (Parameter<'a>, Span)> {
        std::iter::from_fn(move || self.next_with_span())
    }
}

impl<'a> Iterator for Parameters<'a> {
    type Item = Parameter<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_with_span().map(|(parameter, _)| parameter)
    }
}

/// What begins with `#`: a reference, or a constant of edition 3.
#[inline]
fn read_name(bytes: &[u8], at: usize) -> (Parameter<'_>, usize) {
    let (name, end) = syntax::number_at(bytes, at + 1);
    if let Some(name) = name
        && !bytes.get(end).is_some_and(|&byte| syntax::is_keyword_byte(byte))
    {
        return (Parameter::Reference(InstanceName(name)), end);
    }
    let end = syntax::keyword_end(bytes, at + 1);
    let token = Token::new(bytes, at, end);
    match token.text.get(1) {
        Some(byte) if !byte.is_ascii_digit() => (Parameter::External(token), end),
        _ => (Parameter::Malformed(token), end),
    }
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
        assert!(matches!(read[0], Parameter::Omitted) && matches!(read[1], Parameter::Derived));
        assert_eq!((read[2].as_i64(), read[2].as_f64()), (Some(1), Some(1.0)));
        assert_eq!((read[3].as_i64(), read[3].as_f64()), (None, Some(-25.0)));
        assert_eq!(read[4].as_str().as_deref(), Some("a,b)"));
        assert_eq!((read[5].as_enum(), read[5].as_bool()), (Some(b"T".as_slice()), Some(true)));
        assert!(matches!(read[6], Parameter::Binary(_)));
        assert_eq!(read[7].as_reference(), Some(InstanceName(12)));
        assert_eq!(read[8].as_list().map(Iterator::count), Some(2));
        assert_eq!(read[9].as_f64(), Some(3.0));
        assert!(matches!(read[10], Parameter::External(_)) && matches!(read[11], Parameter::External(_)));
        assert!(matches!(&read[12], Parameter::Typed { keyword: b"!MY_TYPE", .. }));
        assert_eq!(read.len(), 13);
    }

    #[test]
    fn malformed_parameters_do_not_hide_their_neighbours() {
        for (text, count) in
            [("1,,2", 3), ("1,", 2), (",", 2), ("1 2,3", 2), ("NAN,3", 2), ("(1,2", 1), ("", 0), (" ", 0)]
        {
            let read: Vec<_> = parameters(text).collect();
            assert_eq!(read.len(), count, "{text}");
            let malformed = read.iter().any(|parameter| matches!(parameter, Parameter::Malformed(_)));
            assert_eq!(malformed, count > 0, "{text}");
        }
        assert_eq!(parameters("1 2,3").nth(1).and_then(|p| p.as_i64()), Some(3));
    }

    #[test]
    fn places_cover_the_whole_parameter() {
        let text = " 'x' , /*c*/ A( 1 ) , ( 2 ) ";
        let spans: Vec<_> = parameters(text).with_spans().map(|(_, span)| &text[span.range()]).collect();
        assert_eq!(spans, ["'x'", "A( 1 )", "( 2 )"]);
    }
}
