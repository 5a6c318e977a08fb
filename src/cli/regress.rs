//! `resurf regress`: parts and jobs of a folder against a baseline.

use std::path::Path;

use super::arguments::RegressArguments;
use super::exit_code;
use super::print::{Place, Printer};
use crate::batch::Interrupt;
use crate::diagnostic::Severity;
use crate::job::file::ValidateSettings;
use crate::job::judge::first_missing;
use crate::job::output::Staged;
use crate::job::report::measured::Measure;
use crate::publish::junit::{Blame, Case, suite};
use crate::regress::compare::updated;
use crate::regress::{Baseline, Comparison, Outcome, Surveyed, compare, survey};

/// Measures a folder, compares, and gives the exit code: 1 when anything differs from the baseline.
pub fn regress(arguments: &RegressArguments, printer: &mut Printer) -> u8 {
    match done(arguments, printer) {
        Ok(code) | Err(code) => code,
    }
}

fn done(arguments: &RegressArguments, printer: &mut Printer) -> Result<u8, u8> {
    let settings = ValidateSettings { with: arguments.with.clone(), require: true, timeout: None };
    if let Some(error) = first_missing(&settings) {
        printer.message(Severity::Error, &error.to_string());
        return Err(exit_code::VALIDATOR_MISSING);
    }
    let known = baseline(&arguments.baseline, arguments.update, printer)?;
    let surveyed = measured(arguments, printer)?;
    let compared = compare(&known, &surveyed);
    let differing = compared.iter().filter(|part| part.outcome != Outcome::Same).count();
    let passing = surveyed.iter().find_map(|part| Some((part, passing(part)?)));
    if let Some((part, code)) = passing.filter(|_| arguments.update) {
        let text = format!("{}: a limit or a disk was in the way; the baseline is as it was", part.name);
        printer.message(Severity::Error, &text);
        return Err(code);
    }
    if arguments.update {
        write(&arguments.baseline, &updated(&known, &surveyed).text(), printer)?;
    }
    if let Some(path) = &arguments.junit {
        let cases: Vec<Case> = compared.iter().map(case).collect();
        write(path, &suite("regress", &cases), printer)?;
    }
    if arguments.json {
        let text =
            serde_json::to_string_pretty(&compared).expect("a comparison is a tree of texts and numbers");
        printer.data(&(text + "\n"));
    } else {
        let lines: Vec<String> = compared.iter().flat_map(lines).collect();
        printer.data(&lines.iter().map(|line| format!("{line}\n")).collect::<String>());
    }
    let kept = if arguments.update { "; the baseline is what was measured now" } else { "" };
    printer.line(&format!("{} parts: {differing} differ from the baseline{kept}", compared.len()));
    Ok(match (differing, passing) {
        (0, _) => exit_code::DONE,
        _ if arguments.update => exit_code::DONE,
        (_, Some((_, code))) => code,
        _ => exit_code::GATE,
    })
}

/// The exit code of a part that ended by something that says nothing of it: trying again, or a higher limit, may give its
/// measures.
fn passing(part: &Surveyed) -> Option<u8> {
    match part.measures.get("outcome") {
        Some(Measure::Word(code)) if code.starts_with("resource.") => Some(exit_code::RESOURCE),
        Some(Measure::Word(code)) if code.starts_with("io.") => Some(exit_code::IO),
        _ => None,
    }
}

fn measured(arguments: &RegressArguments, printer: &mut Printer) -> Result<Vec<Surveyed>, u8> {
    let refused = |printer: &mut Printer, error: std::io::Error| {
        printer.message(Severity::Error, &format!("{}: {error}", arguments.folder.display()));
        if error.kind() == std::io::ErrorKind::NotFound { exit_code::USAGE } else { exit_code::IO }
    };
    let interrupt = Interrupt::listen().map_err(|error| refused(printer, error))?;
    let mut told = |part: &Surveyed| {
        if arguments.limits.verbose {
            printer.line(&format!("{}: {:.2} s", part.name, part.seconds));
        }
    };
    let surveyed =
        survey(&arguments.folder, &arguments.with, &arguments.limits.limits(), &interrupt, &mut told);
    let surveyed = surveyed.map_err(|error| refused(printer, error))?;
    if interrupt.asked() {
        printer.message(Severity::Error, "interrupted: the baseline is as it was");
        return Err(exit_code::INTERRUPTED);
    }
    Ok(surveyed)
}

/// The baseline as its file has it; an empty one when there is none yet and one is to be written.
fn baseline(path: &Path, update: bool, printer: &mut Printer) -> Result<Baseline, u8> {
    let name = path.to_string_lossy();
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound && update => "version = 1\n".to_owned(),
        Err(error) => {
            let help = if error.kind() == std::io::ErrorKind::NotFound {
                "; `--update` writes the first one"
            } else {
                ""
            };
            printer.message(Severity::Error, &format!("baseline {name}: {error}{help}"));
            return Err(exit_code::USAGE);
        }
    };
    Baseline::read(&text).map_err(|error| {
        let place = Place { path: &name, bytes: text.as_bytes(), span: error.span.clone() };
        printer.placed(Severity::Error, "", &error.message, &place);
        exit_code::USAGE
    })
}

fn write(path: &Path, text: &str, printer: &mut Printer) -> Result<(), u8> {
    Staged::write(path, text.as_bytes()).and_then(Staged::commit).map_err(|error| {
        printer.message(Severity::Error, &error.to_string());
        exit_code::IO
    })
}

/// What is said of a part; nothing of one that is the same.
fn lines(part: &Comparison) -> Vec<String> {
    let mut lines = match &part.outcome {
        Outcome::Same => return Vec::new(),
        Outcome::Changed => vec![format!("changed: {}", part.part)],
        Outcome::New => vec![format!("new: {}", part.part)],
        Outcome::Missing => vec![format!("missing: {}", part.part)],
        Outcome::Renamed { from } => vec![format!("renamed: {from} to {}", part.part)],
    };
    if part.edited && part.outcome == Outcome::Changed {
        lines.push("  its file has other bytes than the one that was measured".to_owned());
    }
    lines.extend(part.changes.iter().map(|change| format!("  {change}")));
    lines
}

fn case(part: &Comparison) -> Case {
    let lines = lines(part);
    let word = match part.outcome {
        Outcome::Same => "same",
        Outcome::Changed => "regress.changed",
        Outcome::New => "regress.new",
        Outcome::Missing => "regress.missing",
        Outcome::Renamed { .. } => "regress.renamed",
    };
    let failure = (!lines.is_empty()).then(|| (word.to_owned(), lines.join("\n"), Blame::Part));
    Case { name: part.part.clone(), seconds: part.seconds, failure }
}
