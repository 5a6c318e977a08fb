//! Facts about files and failures of parts, shown to people.

use std::collections::BTreeSet;
use std::path::Path;

use super::print::{Place, Printer};
use crate::diagnostic::{Diagnostic, Severity};
use crate::job::failure::PartError;
use crate::job::part::Read;
use crate::job::report::{Failure, PartReport};

/// Facts shown of each code; the rest is counted.
const SHOWN_PER_CODE: usize = 3;

/// Shows what was found in a file, gravest kinds as they come, and how much more there is.
pub fn diagnostics(printer: &mut Printer, path: &Path, read: &Read) {
    let source = read.document.source().bytes();
    let name = path.to_string_lossy();
    let mut shown: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    for fact in read.diagnostics.kept() {
        let count = shown.entry(fact.code).or_insert(0);
        *count += 1;
        if *count <= SHOWN_PER_CODE {
            diagnostic(printer, &name, source, fact);
        }
    }
    for (code, count) in read.diagnostics.counts() {
        if *count > SHOWN_PER_CODE {
            printer.line(&format!("{name}: {code}: {} more", count - SHOWN_PER_CODE));
        }
    }
}

fn diagnostic(printer: &mut Printer, path: &str, bytes: &[u8], fact: &Diagnostic) {
    let text = match &fact.entity {
        Some(entity) if !fact.message.contains(entity.as_str()) => format!("{entity}: {}", fact.message),
        _ => fact.message.clone(),
    };
    match fact.span {
        Some(span) => {
            printer.placed(fact.severity, fact.code, &text, &Place { path, bytes, span: span.range() })
        }
        None => printer.message(fact.severity, &format!("{path}: {}: {text}", fact.code)),
    }
}

/// Shows why something cannot be done with a file.
pub fn part_error(printer: &mut Printer, path: &Path, error: &PartError) {
    failure(printer, &path.to_string_lossy(), &error.failure());
}

/// Shows a failure that stands in a report.
pub fn failure(printer: &mut Printer, path: &str, failure: &Failure) {
    printer.message(Severity::Error, &format!("{path}: {} [{}]", failure.message, failure.code));
}

/// Shows the warnings of a part's report in a line each.
pub fn warnings(printer: &mut Printer, part: &PartReport) {
    let notes = part.operations.iter().flat_map(|operation| &operation.notes);
    let mut said = BTreeSet::new();
    for fact in part.losses.iter().chain(notes) {
        // A part has one such fact for each record; the report names them all.
        if !said.insert((&fact.code, &fact.message)) {
            continue;
        }
        let severity = match fact.severity.as_str() {
            "error" => Severity::Error,
            "warning" => Severity::Warning,
            _ => Severity::Note,
        };
        printer.message(severity, &format!("{}: {} [{}]", part.input, fact.message, fact.code));
    }
    for (code, count) in &part.diagnostic_counts {
        let first = part.diagnostics.iter().find(|fact| fact.code == *code);
        let Some(first) = first.filter(|fact| fact.severity != "note") else { continue };
        let severity = if first.severity == "error" { Severity::Error } else { Severity::Warning };
        let line = first.line.map(|line| format!(":{line}")).unwrap_or_default();
        let more = if *count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
        printer.message(severity, &format!("{}{line}: {} [{code}]{more}", part.input, first.message));
    }
}
