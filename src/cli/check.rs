//! `resurf check`: whether parts are sound, by our own eyes and by other programs'.

use std::path::Path;

use serde::Serialize;

use super::arguments::CheckArguments;
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::job::failure::PartError;
use crate::job::file::ValidateSettings;
use crate::job::judge::{first_missing, judge};
use crate::job::own_check::{OwnFinding, own_findings};
use crate::job::part::Read;
use crate::job::report::measure::Figures;
use crate::job::report::{DiagnosticReport, Failure};
use crate::validate::Verdict;

/// What is known of one part.
#[derive(Debug, Serialize)]
struct Checked {
    part: String,
    accepted: bool,
    code: u8,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<Failure>,
    diagnostics: Vec<DiagnosticReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<Figures>,
    findings: Vec<OwnFinding>,
    validators: Vec<Verdict>,
}

/// Checks parts and gives the exit code.
pub fn check(arguments: &CheckArguments, printer: &mut Printer) -> u8 {
    let settings = ValidateSettings { with: arguments.with.clone(), require: true, timeout: None };
    if let Some(error) = first_missing(&settings) {
        printer.message(Severity::Error, &error.to_string());
        return exit_code::VALIDATOR_MISSING;
    }
    let parts: Vec<Checked> = arguments.parts.iter().map(|part| one(part, &settings, printer)).collect();
    if arguments.json {
        let text = serde_json::to_string_pretty(&parts).expect("a check is a tree of texts and numbers");
        printer.data(&(text + "\n"));
    } else {
        let lines: Vec<String> = parts.iter().map(plain).collect();
        printer.data(&lines.concat());
    }
    match parts.as_slice() {
        [part] => part.code,
        parts if parts.iter().all(|part| part.code == exit_code::DONE) => exit_code::DONE,
        _ => exit_code::GATE,
    }
}

fn one(path: &Path, settings: &ValidateSettings, printer: &mut Printer) -> Checked {
    let mut checked = Checked {
        part: path.to_string_lossy().into_owned(),
        accepted: false,
        code: exit_code::DONE,
        failure: None,
        diagnostics: Vec::new(),
        figures: None,
        findings: Vec::new(),
        validators: Vec::new(),
    };
    match examine(path, settings, &mut checked, printer) {
        Ok(accepted) => {
            checked.accepted = accepted;
            checked.code = if accepted { exit_code::DONE } else { exit_code::GATE };
        }
        Err(error) => {
            show::part_error(printer, path, &error);
            checked.code = error.exit_code();
            checked.failure = Some(error.failure());
        }
    }
    checked
}

fn examine(
    path: &Path,
    settings: &ValidateSettings,
    checked: &mut Checked,
    printer: &mut Printer,
) -> Result<bool, PartError> {
    let mut read = Read::file(path)?;
    let model = read.model();
    show::diagnostics(printer, path, &read);
    let source = read.document.source();
    checked.diagnostics =
        read.diagnostics.kept().iter().map(|fact| DiagnosticReport::new(fact, source)).collect();
    checked.figures = Some(Figures::of(&model));
    read.refuse_damage()?;
    checked.findings = own_findings(&read.document, &model, 1.0);
    let judged = judge(settings, path, &model, None)?;
    for unasked in judged.unasked {
        printer.message(Severity::Warning, &format!("{}: {unasked}", path.display()));
    }
    checked.validators = judged.verdicts;
    Ok(!read.has_errors()
        && !checked.findings.iter().any(OwnFinding::is_error)
        && checked.validators.iter().all(|verdict| verdict.accepted))
}

fn plain(checked: &Checked) -> String {
    let mut text =
        format!("{}: {}\n", checked.part, if checked.accepted { "accepted" } else { "not accepted" });
    for finding in &checked.findings {
        text += &format!("  {finding}\n");
    }
    for verdict in &checked.validators {
        let word = if verdict.accepted { "accepts it" } else { "refuses it" };
        text += &format!("  {} {word}\n", verdict.validator.as_str());
        for message in &verdict.messages {
            text += &format!("    {message}\n");
        }
    }
    text
}
