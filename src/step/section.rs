//! Sections of an exchange structure: what they are and where they stand.

use crate::source::Span;

/// Kind of a section (ISO 10303-21:2016 clause 5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SectionKind {
    /// `HEADER;`
    Header,
    /// `ANCHOR;`, edition 3.
    Anchor,
    /// `REFERENCE;`, edition 3.
    Reference,
    /// `DATA;`, or `DATA(…);` from edition 2 on.
    Data,
    /// `SIGNATURE;`, edition 3.
    Signature,
}

impl SectionKind {
    /// The section that a keyword opens; case is not looked at.
    #[must_use]
    pub fn from_keyword(keyword: &[u8]) -> Option<Self> {
        const KINDS: [(&[u8], SectionKind); 5] = [
            (b"HEADER", SectionKind::Header),
            (b"ANCHOR", SectionKind::Anchor),
            (b"REFERENCE", SectionKind::Reference),
            (b"DATA", SectionKind::Data),
            (b"SIGNATURE", SectionKind::Signature),
        ];
        KINDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(keyword)).map(|&(_, kind)| kind)
    }
}

/// One section of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Section {
    /// What it is.
    pub kind: SectionKind,
    /// From the section keyword to behind the semicolon of `ENDSEC;`, or to where the section ends without.
    pub span: Span,
    /// What stands between the opening and `ENDSEC`.
    pub body: Span,
    /// Inside of the parentheses of `DATA(…)`; `None` without parentheses.
    pub parameters: Option<Span>,
}

/// A line of the anchor section, `<name>=item;`, or of the reference section, `#n=<resource>;`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Left side, without white space.
    pub name: Span,
    /// Right side, tags included, without the semicolon.
    pub item: Span,
}
