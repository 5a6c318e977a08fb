//! Tokens of an IGES file: kind and extent, nothing decoded.
//!
//! [`tokens`] cuts a file into tokens that tile it: each byte, line ends and padding included, belongs to exactly one
//! token. Nothing here can fail; bytes that have no place are [`TokenKind::Stray`].

use super::card::{CARD, DATA, Line, PARAMETER_DATA, offset};
use super::directory_entry::Field;
use super::exchange_structure::ExchangeStructure;
use super::parameter::Parameters;
use super::section::{Form, SectionKind};
use crate::source::Span;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TokenKind {
    /// Columns 1 to 72 of a start or flag card.
    Text,
    /// A parameter, or the piece of one that stands on one card.
    Value,
    /// Delimiter between parameters.
    ParameterDelimiter,
    /// Delimiter behind the last parameter.
    RecordDelimiter,
    /// Blanks between values.
    Blank,
    /// What stands behind the record delimiter.
    Comment,
    /// A field of a directory entry; all of them on one line in the compressed form.
    DirectoryField,
    /// Columns 65 to 72 of a parameter card.
    BackPointer,
    /// A count of the terminate card, and the blanks behind them.
    Count,
    /// Column 73.
    SectionLetter,
    /// Columns 74 to 80.
    SequenceNumber,
    /// Bytes behind column 80.
    Excess,
    /// The end of a line.
    LineEnd,
    /// Bytes of no section, and parameter cards of no entity.
    Stray,
}

/// A token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// Where it is; never empty.
    pub span: Span,
}

/// All tokens of a file in its order.
#[must_use]
pub fn tokens(structure: &ExchangeStructure) -> Vec<Token> {
    let mut cutter = Cutter { structure, data: data_tokens(structure), next: 0, at: 0, tokens: Vec::new() };
    let sections = sections_by_offset(structure);
    let mut section = sections.iter().peekable();
    for line in structure.lines() {
        while section.next_if(|(start, _)| *start < line.start).is_some() {}
        // A byte-order mark stands before the first card and on its line.
        let start = section.peek().map_or(line.end, |(start, _)| *start).clamp(line.start, line.end);
        let kind = section.next_if(|(at, _)| *at == start && start < line.next).map(|(_, kind)| *kind);
        cutter.up_to(start, TokenKind::Stray);
        cutter.line(kind, Line { start, ..line });
    }
    cutter.tokens
}

/// Offsets of all cards with their sections, ascending.
fn sections_by_offset(structure: &ExchangeStructure) -> Vec<(u32, SectionKind)> {
    const KINDS: [SectionKind; 6] = [
        SectionKind::Flag,
        SectionKind::Start,
        SectionKind::Global,
        SectionKind::Directory,
        SectionKind::Parameter,
        SectionKind::Terminate,
    ];
    let of = |kind: SectionKind| structure.sections().of(kind).iter().map(move |at| (*at, kind));
    let mut all: Vec<_> = KINDS.into_iter().flat_map(of).collect();
    all.sort_unstable();
    all
}

/// Values, delimiters and directory records of the global and parameter sections, ascending.
fn data_tokens(structure: &ExchangeStructure) -> Vec<Token> {
    let mut all = Vec::new();
    values(structure.global_parameters(), structure, &mut all);
    for instance in structure.instances() {
        if structure.form() == Form::Compressed {
            all.push(Token { kind: TokenKind::DirectoryField, span: instance.span() });
        }
        values(instance.record(), structure, &mut all);
    }
    all.retain(|token| !token.span.is_empty());
    all.sort_unstable_by_key(|token| token.span);
    all
}

fn values(mut parameters: Parameters<'_>, structure: &ExchangeStructure, all: &mut Vec<Token>) {
    while let Some(parameter) = parameters.next() {
        all.extend(parameter.pieces().map(|span| Token { kind: TokenKind::Value, span }));
        if parameters.is_unterminated() {
            continue;
        }
        let end = parameters.offset();
        let span = Span::new(end - 1, end);
        let record = structure.source().slice(span) == [structure.global().delimiters.record];
        let kind = if record { TokenKind::RecordDelimiter } else { TokenKind::ParameterDelimiter };
        all.push(Token { kind, span });
    }
}

struct Cutter<'a> {
    structure: &'a ExchangeStructure,
    data: Vec<Token>,
    /// Next of these.
    next: usize,
    /// Behind the last token.
    at: u32,
    tokens: Vec<Token>,
}

impl Cutter<'_> {
    /// The bytes up to an offset as one token.
    fn up_to(&mut self, end: u32, kind: TokenKind) {
        if end > self.at {
            self.tokens.push(Token { kind, span: Span::new(self.at, end) });
            self.at = end;
        }
    }

    fn line(&mut self, kind: Option<SectionKind>, line: Line) {
        let column = |at: usize| (line.start + offset(at)).min(line.end);
        let compressed = self.structure.form() == Form::Compressed;
        match kind {
            None => self.up_to(line.end, TokenKind::Stray),
            Some(SectionKind::Parameter) if compressed => self.values(line.end),
            Some(SectionKind::Flag | SectionKind::Start) => self.up_to(column(DATA), TokenKind::Text),
            Some(SectionKind::Global) => self.values(column(DATA)),
            Some(SectionKind::Parameter) => {
                self.values(column(PARAMETER_DATA));
                self.up_to(column(DATA), TokenKind::BackPointer);
            }
            Some(SectionKind::Directory) => {
                let ends = Field::ALL.iter().map(|field| field.place().1.end).filter(|end| *end <= DATA);
                ends.for_each(|end| self.up_to(column(end), TokenKind::DirectoryField));
            }
            Some(SectionKind::Terminate) => {
                (1..=4).for_each(|count| self.up_to(column(8 * count), TokenKind::Count));
                self.up_to(column(DATA), TokenKind::Count);
            }
        }
        if kind.is_some() {
            self.up_to(column(DATA + 1), TokenKind::SectionLetter);
            self.up_to(column(CARD), TokenKind::SequenceNumber);
            self.up_to(line.end, TokenKind::Excess);
        }
        self.up_to(line.next, TokenKind::LineEnd);
    }

    /// The tokens of a line's data, and what stands between them.
    fn values(&mut self, end: u32) {
        while let Some(token) = self.data.get(self.next).copied().filter(|token| token.span.start < end) {
            let between = self.between();
            self.up_to(token.span.start, between);
            // The directory record of the compressed form may go on over line ends.
            self.up_to(token.span.end.min(end), token.kind);
            if token.span.end > end {
                return self.line_end_within(token.span.end);
            }
            self.next += 1;
        }
        let between = self.between();
        self.up_to(end, between);
    }

    /// The rest of a token that goes on behind a line end is cut there.
    fn line_end_within(&mut self, end: u32) {
        let rest = self.structure.line_at(self.at).map_or(end, |line| line.next);
        self.data[self.next].span = Span::new(rest.min(end), end);
    }

    /// What stands before the next token: within a record blanks, behind it comments, on cards of no record nothing that
    /// is known.
    fn between(&self) -> TokenKind {
        let before = self.tokens.iter().rev().map(|token| token.kind).find(|kind| {
            matches!(
                kind,
                TokenKind::Value
                    | TokenKind::ParameterDelimiter
                    | TokenKind::RecordDelimiter
                    | TokenKind::DirectoryField
                    | TokenKind::Text
            )
        });
        match before {
            Some(TokenKind::RecordDelimiter) => TokenKind::Comment,
            _ => TokenKind::Blank,
        }
    }
}
