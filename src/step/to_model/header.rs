//! What the header must hold: ISO 10303-21 clause 8.2.
//!
//! Reads nothing into the model: nothing of a part depends on it but the name of the schema. A header that is
//! wanting is said, since other programs refuse the file for it.

use super::code::ModelCode;
use crate::diagnostic::{Diagnostic, Sink};
use crate::source::Span;
use crate::step::{ExchangeStructure, SectionKind};

/// The records that a header must hold, with their counts of attributes.
const REQUIRED: [(&str, usize); 3] = [("FILE_DESCRIPTION", 2), ("FILE_NAME", 7), ("FILE_SCHEMA", 1)];

/// Reports records of the header that are missing or have other attributes than they must.
pub(super) fn check(file: &ExchangeStructure, sink: &mut dyn Sink) {
    let header = file.sections().iter().find(|section| section.kind == SectionKind::Header);
    // The opening keyword: the whole section would be a long mark.
    let opening = header.map(|section| Span { end: section.body.start, ..section.span });
    let mut report = |keyword: &str, span: Option<Span>, message: String| {
        sink.report(Diagnostic {
            code: ModelCode::BadHeader.text(),
            severity: ModelCode::BadHeader.severity(),
            entity: Some(keyword.to_owned()),
            span,
            message,
        });
    };
    for (keyword, expected) in REQUIRED {
        let Some(record) = file.header_record(keyword.as_bytes()) else {
            report(keyword, opening, format!("the header has no {keyword}, which every file must have"));
            continue;
        };
        let found = record.parameters().count();
        if found != expected {
            let message = format!("{keyword} has {found} attributes, expected {expected}");
            report(keyword, Some(record.keyword_span()), message);
        } else if keyword == "FILE_SCHEMA" && file.schemas().next().is_none() {
            let message = "FILE_SCHEMA names no schema, expected a list of texts".to_owned();
            report(keyword, Some(record.keyword_span()), message);
        }
    }
}
