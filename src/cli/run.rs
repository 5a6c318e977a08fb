//! `resurf run`: a job over its parts.

use std::path::Path;

use super::arguments::RunArguments;
use super::exit_code;
use super::print::{Place, Printer};
use super::show;
use crate::diagnostic::Severity;
use crate::job::judge::first_missing;
use crate::job::output::Staged;
use crate::job::plan::{self, Part};
use crate::job::read::{JobFileError, Syntax, read};
use crate::job::report::{PartReport, Report, Status, WritePath};
use crate::job::run::Mode;
use crate::job::{self, Job};

/// Runs a job and gives the exit code.
pub fn run(arguments: &RunArguments, printer: &mut Printer) -> u8 {
    let (job, parts) = match planned(&arguments.job, printer) {
        Ok(planned) => planned,
        Err(code) => return code,
    };
    if !arguments.dry_run
        && let Some(error) = first_missing(&job.validate)
    {
        printer.message(Severity::Error, &error.to_string());
        return exit_code::VALIDATOR_MISSING;
    }
    let mode = if arguments.dry_run { Mode::DryRun } else { Mode::Write };
    let report = job::run::run(&job, &parts, mode, &mut |part| finished(printer, part, mode));
    let written = write_report(arguments, &report, printer);
    if written == exit_code::DONE { report.code } else { written }
}

/// The job and its parts, or the exit code after a message.
fn planned(path: &Path, printer: &mut Printer) -> Result<(Job, Vec<Part>), u8> {
    let name = path.to_string_lossy();
    if path.is_dir() {
        printer
            .message(Severity::Error, &format!("job file {name} is a folder; expected a TOML or JSON file"));
        return Err(exit_code::USAGE);
    }
    let text = std::fs::read_to_string(path).map_err(|error| {
        printer.message(Severity::Error, &format!("job file {name}: {error}"));
        exit_code::USAGE
    })?;
    let json = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut job = read(&text, if json { Syntax::Json } else { Syntax::Toml }).map_err(|error| {
        show_job_error(printer, &name, &text, &error);
        exit_code::USAGE
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let planned = plan::resolve(&mut job, folder).and_then(|()| plan::parts(&job, folder));
    let parts = planned.map_err(|error| {
        printer.message(Severity::Error, &format!("{name}: {error}"));
        exit_code::USAGE
    })?;
    Ok((job, parts))
}

fn show_job_error(printer: &mut Printer, path: &str, text: &str, error: &JobFileError) {
    let place = Place { path, bytes: text.as_bytes(), span: error.span.clone() };
    printer.placed(Severity::Error, "", &error.to_string(), &place);
}

fn finished(printer: &mut Printer, part: &PartReport, mode: Mode) {
    show::warnings(printer, part);
    if let Some(failure) = &part.failure {
        show::failure(printer, &part.input, failure);
        return;
    }
    let how = match part.write_path {
        Some(WritePath::Patched) => "patched",
        _ => "unchanged",
    };
    let place = if mode == Mode::DryRun { "nothing written" } else { part.output.as_str() };
    let accepted: Vec<String> = part
        .validators
        .iter()
        .map(|verdict| format!(", accepted by {}", verdict.validator.as_str()))
        .collect();
    let mark = if part.status == Status::Done { "done" } else { "failed" };
    printer.line(&format!("{mark}: {} -> {place} ({how}{})", part.input, accepted.concat()));
}

fn write_report(arguments: &RunArguments, report: &Report, printer: &mut Printer) -> u8 {
    let mut text = match serde_json::to_string_pretty(report) {
        Ok(text) => text,
        Err(error) => {
            printer.message(Severity::Error, &format!("the report cannot be written: {error}"));
            return exit_code::INTERNAL;
        }
    };
    text.push('\n');
    if let Some(path) = &arguments.report {
        let written = Staged::write(path, text.as_bytes()).and_then(Staged::commit);
        if let Err(error) = written {
            printer.message(Severity::Error, &format!("the report cannot be written: {error}"));
            return exit_code::IO;
        }
    }
    if arguments.json {
        printer.data(&text);
    }
    exit_code::DONE
}
