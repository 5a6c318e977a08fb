//! Parameters of a record: a cursor over the text that decodes nothing before it is asked for.
//!
//! [`Parameters`] allocates nothing and never recurses: a list is skipped by counting parentheses, and read
//! when its own cursor is used. What cannot be read is a [`Parameter::Malformed`]; the next parameter
//! is found all the same. Values are not checked against any schema here.

use std::borrow::Cow;

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

/// A cursor over the parameters between two parentheses. Copies are cheap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameters<'a> {
    bytes: &'a [u8],
    at: u32,
    end: u32,
    /// A comma was read: a parameter must follow.
    after_comma: bool,
}

impl<'a> Parameters<'a> {
    /// Cursor over `inside`, the span between the parentheses, of the file's `bytes`.
    #[must_use]
    pub(crate) fn new(bytes: &'a [u8], inside: Span) -> Self {
        Self { bytes, at: inside.start, end: inside.end, after_comma: false }
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
        let (mut parameter, mut end) = read(bytes, start);
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

/// The parameter at `at`, which is no white space, and its end.
fn read(bytes: &[u8], at: usize) -> (Parameter<'_>, usize) {
    if at >= bytes.len() || bytes[at] == b',' {
        return (Parameter::Malformed(Token::new(bytes, at, at)), at);
    }
    if bytes[at] == b'(' {
        return match list_end(bytes, at) {
            Some(end) => (Parameter::List(Parameters::new(bytes, syntax::span(at + 1, end - 1))), end),
            None => (Parameter::Malformed(Token::new(bytes, at, bytes.len())), bytes.len()),
        };
    }
    let (kind, end) = syntax::token_at(bytes, at);
    let token = Token::new(bytes, at, end);
    let parameter = match kind {
        TokenKind::Omitted => Parameter::Omitted,
        TokenKind::Derived => Parameter::Derived,
        TokenKind::Integer => Parameter::Integer(token),
        TokenKind::Real => Parameter::Real(token),
        TokenKind::String => Parameter::String(token),
        TokenKind::Enumeration => Parameter::Enumeration(token),
        TokenKind::Binary => Parameter::Binary(token),
        TokenKind::InstanceName => match InstanceName::parse(token.text) {
            Some(name) => Parameter::Reference(name),
            None if token.text[1].is_ascii_digit() => Parameter::Malformed(token),
            None => Parameter::External(token),
        },
        TokenKind::ValueName | TokenKind::Resource => Parameter::External(token),
        TokenKind::Keyword => return read_typed(bytes, token, end),
        _ => Parameter::Malformed(token),
    };
    (parameter, end)
}

fn read_typed<'a>(bytes: &'a [u8], keyword: Token<'a>, end: usize) -> (Parameter<'a>, usize) {
    let open = syntax::trivia_end(bytes, end);
    if bytes.get(open) == Some(&b'(')
        && let Some(close) = list_end(bytes, open)
    {
        let parameters = Parameters::new(bytes, syntax::span(open + 1, close - 1));
        return (Parameter::Typed { keyword: keyword.text, parameters }, close);
    }
    (Parameter::Malformed(keyword), end)
}

/// Offset behind the parenthesis that closes the one at `open`; `None` when it is not closed.
pub(crate) fn list_end(bytes: &[u8], open: usize) -> Option<usize> {
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
            b'(' => list_end(bytes, at).unwrap_or(bytes.len()),
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
