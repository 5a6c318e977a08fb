//! `resurf run`: a job over its parts.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::arguments::RunArguments;
use super::exit_code;
use super::print::{Place, Printer};
use super::progress::Display;
use super::report::Forms;
use crate::batch::run::Memory;
use crate::batch::task::JobError;
use crate::batch::{self, Interrupt, JobText, Run};
use crate::diagnostic::Severity;
use crate::job::Job;
use crate::job::judge::first_missing;
use crate::job::plan::{self, Part};
use crate::job::report::{PartReport, Report, WritePath};
use crate::job::run::Mode;
use crate::job::text::JobFileError;

/// Runs a job and gives the exit code.
pub fn run(arguments: &RunArguments, printer: &mut Printer) -> u8 {
    match done(arguments, printer) {
        Ok((report, interrupt)) => {
            summary(printer, &report.parts);
            let written = write_report(arguments, &report, &interrupt, printer);
            if written == exit_code::DONE { report.code } else { written }
        }
        Err(code) => code,
    }
}

/// The report of the run with what may end it, or the exit code after a message.
fn done(arguments: &RunArguments, printer: &mut Printer) -> Result<(Report, Interrupt), u8> {
    let (text, parts) = planned(&arguments.job, printer)?;
    let job = text.job().map_err(|error| show_job_error(printer, &arguments.job, &text, &error))?;
    let mut refuse = |message: &str, code: u8| {
        printer.message(Severity::Error, message);
        code
    };
    let shard = arguments.shard.map(batch::Share::resolve).transpose();
    let shard = shard.map_err(|message| refuse(&message, exit_code::USAGE))?;
    if !arguments.dry_run
        && let Some(error) = first_missing(&job.validate)
    {
        return Err(refuse(&error.to_string(), exit_code::VALIDATOR_MISSING));
    }
    if let Some(message) = clash(arguments, &job, &text, &parts) {
        return Err(refuse(&message, exit_code::USAGE));
    }
    let interrupt = Interrupt::listen().map_err(|error| refuse(&error.to_string(), exit_code::IO))?;
    let mode = if arguments.dry_run { Mode::DryRun } else { Mode::Write };
    let run = Run {
        job: &text,
        parts: &parts,
        mode,
        limits: arguments.limits.limits(),
        shard,
        memory: if arguments.fresh { Memory::Fresh } else { Memory::Kept },
    };
    let line = if arguments.dry_run { planned_line } else { done_line };
    let mut display = Display::new(printer, arguments.limits.verbose, line);
    let report = batch::run(&run, &interrupt, &mut |progress| display.show(progress));
    display.end();
    let report = report.map_err(|error| show_job_error(printer, &arguments.job, &text, &error))?;
    Ok((report, interrupt))
}

/// A report that would be written over a file of the run, or over another report.
fn clash(arguments: &RunArguments, job: &Job, text: &JobText, parts: &[Part]) -> Option<String> {
    let files = parts.iter().flat_map(|part| [part.input.clone(), part.output.clone()]);
    let read = plan::referenced(job).into_iter().map(|file| text.folder.join(file));
    let mut taken: BTreeSet<PathBuf> = files.chain(read).map(|path| plan::normal(&path)).collect();
    taken.insert(plan::normal(&arguments.job));
    let reports = [&arguments.report, &arguments.junit, &arguments.html];
    let over = reports.into_iter().flatten().find(|path| !taken.insert(plan::normal(path)))?;
    Some(format!("the report {} would be written over another file of the run", over.display()))
}

/// The job's text and its parts, or the exit code after a message.
fn planned(path: &Path, printer: &mut Printer) -> Result<(JobText, Vec<Part>), u8> {
    let name = path.to_string_lossy();
    if path.is_dir() {
        printer
            .message(Severity::Error, &format!("job file {name} is a folder; expected a TOML or JSON file"));
        return Err(exit_code::USAGE);
    }
    let text = JobText::file(path).map_err(|error| {
        printer.message(Severity::Error, &format!("job file {name}: {error}"));
        exit_code::USAGE
    })?;
    let parts = text.job().and_then(|job| Ok(plan::parts(&job, &text.folder)?));
    match parts {
        Ok(parts) => Ok((text, parts)),
        Err(error) => Err(show_job_error(printer, path, &text, &error)),
    }
}

/// Says what is wrong with a job file, and gives the exit code.
fn show_job_error(printer: &mut Printer, path: &Path, job: &JobText, error: &JobError) -> u8 {
    let path = path.to_string_lossy();
    match error {
        JobError::Read(JobFileError { span, .. }) => {
            let place = Place { path: &path, bytes: job.text.as_bytes(), span: span.clone() };
            printer.placed(Severity::Error, "", &error.to_string(), &place);
        }
        JobError::Plan(error) => printer.message(Severity::Error, &format!("{path}: {error}")),
    }
    exit_code::USAGE
}

fn done_line(part: &PartReport) -> String {
    if part.unchanged {
        return format!("unchanged: {} -> {}", part.input, part.output);
    }
    line(part, &part.output)
}

fn planned_line(part: &PartReport) -> String {
    line(part, "nothing written")
}

fn line(part: &PartReport, place: &str) -> String {
    let how = match part.write_path {
        Some(WritePath::Patched) => "patched",
        _ => "unchanged",
    };
    let accepted: Vec<String> = part
        .validators
        .iter()
        .map(|verdict| format!(", accepted by {}", verdict.validator.as_str()))
        .collect();
    format!("done: {} -> {place} ({how}{})", part.input, accepted.concat())
}

/// One line on a run of several parts, and on a run that had nothing to do.
fn summary(printer: &mut Printer, parts: &[PartReport]) {
    let unchanged = parts.iter().filter(|part| part.unchanged).count();
    let failed = parts.iter().filter(|part| part.failure.is_some()).count();
    if parts.len() < 2 && unchanged == 0 {
        return;
    }
    let mut text = format!("{} parts: {} done, {failed} failed", parts.len(), parts.len() - failed);
    if unchanged == parts.len() {
        text += "; nothing has changed since the last run, and nothing was done";
    } else if unchanged > 0 {
        text += &format!("; {unchanged} unchanged since the last run");
    }
    printer.line(&text);
}

/// Writes the report in every form that is asked for.
fn write_report(
    arguments: &RunArguments,
    report: &Report,
    interrupt: &Interrupt,
    printer: &mut Printer,
) -> u8 {
    let forms = Forms {
        report: arguments.report.as_deref(),
        junit: arguments.junit.as_deref(),
        html: arguments.html.as_deref().filter(|_| !arguments.dry_run),
        json: arguments.json,
    };
    forms.write(report, &arguments.limits.limits(), interrupt, printer)
}
