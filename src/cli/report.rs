//! Reports written in the forms that are asked for.

use std::path::{Path, PathBuf};

use super::arguments::MergeArguments;
use super::exit_code;
use super::print::Printer;
use crate::batch::illustrate::{Illustrated, illustrate};
use crate::batch::merge::merged;
use crate::batch::{Interrupt, Limits};
use crate::diagnostic::Severity;
use crate::job::output::Staged;
use crate::job::report::Report;
use crate::publish::{junit, page};

/// The forms of a report.
#[derive(Debug, Clone, Copy)]
pub struct Forms<'a> {
    /// JSON file.
    pub report: Option<&'a Path>,
    /// JUnit file.
    pub junit: Option<&'a Path>,
    /// HTML file.
    pub html: Option<&'a Path>,
    /// JSON on standard output.
    pub json: bool,
}

/// Folder of the parts' own pages, beside the page of the run.
fn folder_of(page: &Path) -> PathBuf {
    let stem = page.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    page.with_file_name(format!("{stem}-parts"))
}

/// Puts the reports of shares together and gives the exit code: that of a run over all their parts.
pub fn merge(arguments: &MergeArguments, printer: &mut Printer) -> u8 {
    let mut reports = Vec::new();
    for path in &arguments.reports {
        let read = std::fs::read_to_string(path).map_err(|error| (error.to_string(), exit_code::IO));
        let parsed = read.and_then(|text| {
            serde_json::from_str(&text).map_err(|error| (format!("no report: {error}"), exit_code::USAGE))
        });
        match parsed {
            Ok(report) => reports.push(report),
            Err((message, code)) => {
                printer.message(Severity::Error, &format!("{}: {message}", path.display()));
                return code;
            }
        }
    }
    let merged = merged(reports).map_err(|error| error.to_string());
    let interrupt = Interrupt::listen().map_err(|error| error.to_string());
    let (report, interrupt) = match (merged, interrupt) {
        (Ok(report), Ok(interrupt)) => (report, interrupt),
        (Err(message), _) | (_, Err(message)) => {
            printer.message(Severity::Error, &message);
            return exit_code::USAGE;
        }
    };
    let forms = Forms {
        report: arguments.output.as_deref(),
        junit: arguments.junit.as_deref(),
        html: arguments.html.as_deref(),
        json: arguments.json,
    };
    let written = forms.write(&report, &arguments.limits.limits(), &interrupt, printer);
    if written == exit_code::DONE { report.code } else { written }
}

impl Forms<'_> {
    /// Pictures of all parts, where the page is asked for.
    fn illustrated(
        &self,
        report: &Report,
        limits: &Limits,
        interrupt: &Interrupt,
        printer: &mut Printer,
    ) -> Vec<Illustrated> {
        let Some(page) = self.html else { return Vec::new() };
        let illustrated = illustrate(report, &folder_of(page), limits, interrupt);
        for part in &illustrated {
            if let Err(error) = &part.illustration {
                printer.message(Severity::Warning, &format!("{}: no pictures: {error}", part.input));
            }
        }
        illustrated
    }

    /// Writes all of them and gives an exit code.
    pub fn write(
        &self,
        report: &Report,
        limits: &Limits,
        interrupt: &Interrupt,
        printer: &mut Printer,
    ) -> u8 {
        let illustrated = self.illustrated(report, limits, interrupt, printer);
        let text = match report.text() {
            Ok(text) => text,
            Err(error) => {
                printer.message(Severity::Error, &format!("the report cannot be written: {error}"));
                return exit_code::INTERNAL;
            }
        };
        let linked = |drawn: Illustrated| {
            let folder = drawn.page.parent()?.file_name()?.to_string_lossy().into_owned();
            let link = format!("{folder}/{}", drawn.page.file_name()?.to_string_lossy());
            Some((drawn.input, (drawn.illustration.ok()?, link)))
        };
        let illustrations = illustrated.into_iter().filter_map(linked).collect();
        let files = [
            (self.report, text.clone()),
            (self.junit, self.junit.map(|_| junit::of_run(report)).unwrap_or_default()),
            (self.html, self.html.map(|_| page::of_run(report, &illustrations)).unwrap_or_default()),
        ];
        for (path, text) in files {
            let Some(path) = path else { continue };
            if let Err(error) = Staged::write(path, text.as_bytes()).and_then(Staged::commit) {
                printer.message(Severity::Error, &format!("the report cannot be written: {error}"));
                return exit_code::IO;
            }
        }
        if self.json {
            printer.data(&text);
        }
        exit_code::DONE
    }
}
