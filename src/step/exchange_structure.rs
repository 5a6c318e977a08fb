//! The exchange structure: one file's bytes and where its sections and records stand.
//!
//! Owns the [`Source`] and an index over it; every view borrows from these and decodes on demand.
//! Reading never fails on data: [`ExchangeStructure::parse`] gives whatever could be found, and diagnostics.
//! It does not know any schema, resolve references, or change anything.
//!
//! INVARIANT: record spans begin at a `#` followed by a digit, ascend by their start, and lie inside the
//! source. They are disjoint, except that a record of the edition-1 scope construct spans the records of
//! its scope.

use super::code::Code;
use super::index::{self, Index, RecordSpan};
use super::parameter::{self, Comments, Parameters};
use super::section::{Entry, Section, SectionKind};
use super::syntax;
use crate::diagnostic::Sink;
use crate::source::{Source, Span};

/// Entity instance name: the number behind `#`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InstanceName(pub u64);

impl InstanceName {
    /// Reads `#12`, leading zeros allowed; `None` when it is no number or exceeds 64 bits.
    #[must_use]
    pub fn parse(text: &[u8]) -> Option<Self> {
        match (text.first()?, crate::number::number_at(text, 1)) {
            (b'#', (Some(value), end)) if end == text.len() => Some(Self(value)),
            _ => None,
        }
    }
}

impl std::fmt::Display for InstanceName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// One file: its bytes and an index over them.
#[derive(Debug, Clone)]
pub struct ExchangeStructure {
    source: Source,
    index: Index,
}

impl ExchangeStructure {
    /// Reads a file of ISO 10303-21, editions 1 to 3. Whatever is wrong goes to the sink.
    pub fn parse(source: Source, sink: &mut dyn Sink) -> Self {
        let index = index::build(source.bytes(), sink);
        Self { source, index }
    }

    /// The bytes.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The sections in file order.
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.index.sections
    }

    /// The parameters of `DATA(…)`; `None` for a section without.
    #[must_use]
    pub fn section_parameters(&self, section: &Section) -> Option<Parameters<'_>> {
        section.parameters.map(|inside| Parameters::new(self.source.bytes(), inside, Comments::Possible))
    }

    /// The records of the header: `FILE_DESCRIPTION`, `FILE_NAME`, `FILE_SCHEMA` and others.
    pub fn header(&self) -> impl Iterator<Item = SimpleRecord<'_>> {
        let bytes = self.source.bytes();
        self.index.header.iter().filter_map(|span| {
            simple_record(bytes, span.start as usize, content_end(bytes, *span), Comments::Possible)
        })
    }

    /// The header record of a keyword; case is not looked at.
    #[must_use]
    pub fn header_record(&self, keyword: &[u8]) -> Option<SimpleRecord<'_>> {
        self.header().find(|record| record.is(keyword))
    }

    /// The names in `FILE_SCHEMA`, decoded, as written: `AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }`.
    pub fn schemas(&self) -> impl Iterator<Item = std::borrow::Cow<'_, str>> {
        let record = self.header_record(b"FILE_SCHEMA");
        let list =
            record.and_then(|record| record.parameters().next()).and_then(|parameter| parameter.as_list());
        list.into_iter().flatten().filter_map(|name| name.as_str())
    }

    /// Reports every record whose parentheses do not close, or behind which something stands. The index does
    /// not look inside records, so this is a pass of its own.
    pub fn damaged_records(&self, sink: &mut dyn Sink) {
        for instance in self.instances().filter(|instance| !instance.is_closed()) {
            let message = "parentheses do not close where the record ends";
            sink.report(Code::DamagedRecord.note_on(instance.name(), instance.span(), message.to_owned()));
        }
    }

    /// Reports every reference to a name that neither a record nor the reference section defines.
    pub fn unresolved_references(&self, sink: &mut dyn Sink) {
        super::reverse_index::unresolved_references(self, sink);
    }

    /// The instances of all data sections in file order, duplicates included.
    pub fn instances(&self) -> impl ExactSizeIterator<Item = Instance<'_>> + DoubleEndedIterator {
        (0..self.len()).map(|position| Instance { structure: self, position })
    }

    /// How many instances there are. Positions run from 0 to below this.
    #[must_use]
    pub fn len(&self) -> u32 {
        // A record takes at least four bytes of a source below 4 GiB.
        u32::try_from(self.index.records.len()).expect("fewer records than bytes")
    }

    /// Whether there is no instance.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.records.is_empty()
    }

    /// The instance of a name; the first, when the file defines it twice.
    #[must_use]
    pub fn instance(&self, name: InstanceName) -> Option<Instance<'_>> {
        self.position(name).map(|position| Instance { structure: self, position })
    }

    /// The instance at a position in file order.
    #[must_use]
    pub fn instance_at(&self, position: u32) -> Option<Instance<'_>> {
        (position < self.len()).then_some(Instance { structure: self, position })
    }

    /// Position in file order of the instance of a name.
    #[must_use]
    pub fn position(&self, name: InstanceName) -> Option<u32> {
        self.index.names.position(name.0)
    }

    /// The greatest name in the file, those of the reference section included: new names must lie above.
    #[must_use]
    pub fn greatest_name(&self) -> Option<InstanceName> {
        let external = self.references().filter_map(|(name, _)| InstanceName::parse(name)).map(|name| name.0);
        self.index.names.greatest().into_iter().chain(external).max().map(InstanceName)
    }

    /// The lines of the anchor section: `<name>` and the item, tags included.
    pub fn anchors(&self) -> impl Iterator<Item = (&[u8], &[u8])> {
        self.entries(&self.index.anchors)
    }

    /// The lines of the reference section: `#n` or `@n` and its resource.
    pub fn references(&self) -> impl Iterator<Item = (&[u8], &[u8])> {
        self.entries(&self.index.references)
    }

    fn entries<'a>(&'a self, entries: &'a [Entry]) -> impl Iterator<Item = (&'a [u8], &'a [u8])> {
        entries.iter().map(|entry| (self.source.slice(entry.name), self.source.slice(entry.item)))
    }

    /// Where new records go: before `ENDSEC` of the last data section. `None` without a data section.
    #[must_use]
    pub fn insertion_offset(&self) -> Option<u32> {
        self.sections()
            .iter()
            .rev()
            .find(|section| section.kind == SectionKind::Data)
            .map(|section| section.body.end)
    }
}

/// One entity instance of a data section.
#[derive(Debug, Clone, Copy)]
pub struct Instance<'a> {
    structure: &'a ExchangeStructure,
    position: u32,
}

impl<'a> Instance<'a> {
    pub(super) fn bytes(&self) -> &'a [u8] {
        self.structure.source.bytes()
    }

    fn record_span(&self) -> RecordSpan {
        self.structure.index.records[self.position as usize]
    }

    /// A cursor over a span between two parentheses of this instance.
    pub(super) fn parameters_in(&self, inside: Span) -> Parameters<'a> {
        Parameters::new(self.bytes(), inside, self.structure.index.comments)
    }

    /// Position in file order.
    #[must_use]
    pub fn position(&self) -> u32 {
        self.position
    }

    /// The instance name.
    #[must_use]
    pub fn name(&self) -> InstanceName {
        let start = self.record_span().start as usize;
        let (name, _) = crate::number::number_at(self.bytes(), start + 1);
        InstanceName(name.expect("records are indexed under a name of 64 bits"))
    }

    /// From `#` to behind `;`.
    #[must_use]
    pub fn span(&self) -> Span {
        let RecordSpan { start, end } = self.record_span();
        Span::new(start, end)
    }

    /// The bytes of [`span`](Self::span).
    #[must_use]
    pub fn text(&self) -> &'a [u8] {
        self.structure.source.slice(self.span())
    }

    /// Offset of what stands behind `=`, a scope included; `None` for a damaged head.
    #[inline]
    pub(super) fn body_start(&self) -> Option<usize> {
        index::body_start(self.bytes(), self.record_span().start as usize)
    }

    /// Whether the parentheses close just before the semicolon.
    fn is_closed(&self) -> bool {
        let (start, end) = self.body();
        let bytes = &self.bytes()[..end];
        let Some(open) = memchr::memchr(b'(', &bytes[start..]).map(|at| start + at) else { return false };
        parameter::list_end(bytes, open, self.structure.index.comments)
            .is_some_and(|close| syntax::trivia_end(bytes, close) == end)
    }

    /// What stands behind `=` and the scope, and before `;`.
    pub(super) fn body(&self) -> (usize, usize) {
        let bytes = self.bytes();
        let span = self.span();
        let end = content_end(bytes, span);
        let start = self.body_start().unwrap_or(end).min(end);
        match bytes.get(start) {
            Some(b'&') => {
                (self.structure.index.scope_bodies.get(&span.start).map_or(end, |&body| body as usize), end)
            }
            _ => (start, end),
        }
    }

    /// What stands between `=` (and the scope, if any) and `;`.
    #[must_use]
    pub fn body_span(&self) -> Span {
        let (start, end) = self.body();
        syntax::span(start, end)
    }

    /// Whether it is written in external mapping, as `(A(…)B(…))`.
    #[must_use]
    pub fn is_complex(&self) -> bool {
        let (start, _) = self.body();
        self.bytes().get(start) == Some(&b'(')
    }

    /// Its records: one for a simple instance, one for each partial entity of a complex one, none for an
    /// instance too damaged to say.
    pub fn records(&self) -> impl Iterator<Item = SimpleRecord<'a>> + use<'a> {
        let bytes = self.bytes();
        let (mut at, end) = self.body();
        let complex = bytes.get(at) == Some(&b'(');
        at += usize::from(complex);
        let comments = self.structure.index.comments;
        let mut done = false;
        std::iter::from_fn(move || {
            if done {
                return None;
            }
            let record = if complex {
                simple_record(bytes, at, end, comments)
            } else {
                whole_record(bytes, at, end, comments)
            };
            done = record.is_none() || !complex;
            at = record.as_ref().map_or(end, |record| record.inside.end as usize + 1);
            record
        })
    }

    /// The record of a keyword; case is not looked at.
    #[must_use]
    pub fn record(&self, keyword: &[u8]) -> Option<SimpleRecord<'a>> {
        self.records().find(|record| record.is(keyword))
    }

    /// The keyword of a simple instance as written.
    #[must_use]
    pub fn keyword(&self) -> Option<&'a [u8]> {
        let (start, end) = self.body();
        let bytes = self.bytes();
        let keyword = keyword_span(bytes, start, end)?;
        Some(&bytes[keyword.range()])
    }
}

/// One `KEYWORD(…)`: a simple instance, a partial entity of a complex one, or a header record.
#[derive(Debug, Clone, Copy)]
pub struct SimpleRecord<'a> {
    bytes: &'a [u8],
    keyword: Span,
    inside: Span,
    comments: Comments,
}

impl<'a> SimpleRecord<'a> {
    /// The keyword as written.
    #[must_use]
    pub fn keyword(&self) -> &'a [u8] {
        &self.bytes[self.keyword.range()]
    }

    /// Whether it has this keyword; case is not looked at.
    #[must_use]
    pub fn is(&self, keyword: &[u8]) -> bool {
        self.keyword().eq_ignore_ascii_case(keyword)
    }

    /// Where the keyword stands.
    #[must_use]
    pub fn keyword_span(&self) -> Span {
        self.keyword
    }

    /// A cursor over the parameters.
    #[must_use]
    pub fn parameters(&self) -> Parameters<'a> {
        Parameters::new(self.bytes, self.inside, self.comments)
    }

    /// What stands between the parentheses.
    #[must_use]
    pub fn parameters_span(&self) -> Span {
        self.inside
    }
}

/// End of a statement without its semicolon.
fn content_end(bytes: &[u8], span: Span) -> usize {
    let end = span.end as usize;
    // Only a damaged record has no semicolon.
    end - usize::from(end > span.start as usize && bytes[end - 1] == b';')
}

fn keyword_span(bytes: &[u8], start: usize, end: usize) -> Option<Span> {
    let begin = start + usize::from(bytes.get(start) == Some(&b'!'));
    let stop = syntax::keyword_end(bytes, begin).min(end);
    (stop > begin && !bytes[begin].is_ascii_digit()).then(|| syntax::span(start, stop))
}

/// Keyword of the record at or behind `at`, and the offset of its parenthesis.
fn opening(bytes: &[u8], at: usize, end: usize) -> Option<(Span, usize)> {
    let bytes = &bytes[..end];
    let keyword = keyword_span(bytes, syntax::trivia_end(bytes, at), end)?;
    let open = syntax::trivia_end(bytes, keyword.end as usize);
    (bytes.get(open) == Some(&b'(')).then_some((keyword, open))
}

/// The record at or behind `at`, before `end`. An unclosed one runs to `end`.
fn simple_record(bytes: &[u8], at: usize, end: usize, comments: Comments) -> Option<SimpleRecord<'_>> {
    let (keyword, open) = opening(bytes, at, end)?;
    let close = parameter::list_end(&bytes[..end], open, comments);
    let inside = syntax::span(open + 1, close.map_or(end, |close| close - 1));
    Some(SimpleRecord { bytes, keyword, inside, comments })
}

/// The record that fills everything from `at` to `end`, so that its last byte tells where its parameters end.
fn whole_record(bytes: &[u8], at: usize, end: usize, comments: Comments) -> Option<SimpleRecord<'_>> {
    if bytes[..end].last() != Some(&b')') {
        return simple_record(bytes, at, end, comments);
    }
    let (keyword, open) = opening(bytes, at, end)?;
    let inside = syntax::span(open + 1, (end - 1).max(open + 1));
    Some(SimpleRecord { bytes, keyword, inside, comments })
}
