//! `resurf feature`: the library of features and of curve detail.

use std::path::Path;

use super::arguments::{DetailArguments, ExportArguments};
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::job::failure::PartError;
use crate::job::library::detail::export as detail_of;
use crate::job::library::feature::export as feature_of;
use crate::job::operate::OperateError;
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::plan::normal;
use crate::model::Model;

/// Takes a feature off a part, writes its file and gives the exit code.
pub fn export(arguments: &ExportArguments, printer: &mut Printer) -> u8 {
    let region = arguments.region.clone().unwrap_or_default();
    keep(&arguments.part, &arguments.output, printer, |model, name| {
        Ok(feature_of(model, arguments.face.as_ref(), &region, None, name)?.text())
    })
}

/// Takes the detail of a curve off a part, writes its file and gives the exit code.
pub fn detail(arguments: &DetailArguments, printer: &mut Printer) -> u8 {
    keep(&arguments.part, &arguments.output, printer, |model, name| {
        Ok(detail_of(model, arguments.curve.as_ref(), name)?.text())
    })
}

/// Writes what is taken off a model, given the name of its file.
fn keep(
    part: &Path,
    output: &Path,
    printer: &mut Printer,
    take: impl Fn(&Model, &str) -> Result<String, OperateError>,
) -> u8 {
    if normal(output) == normal(part) {
        let message = format!("{} would be written over the input", output.display());
        printer.message(Severity::Error, &message);
        return exit_code::USAGE;
    }
    match taken(part, printer, take).and_then(|text| {
        Staged::write(output, text.as_bytes()).and_then(Staged::commit).map_err(PartError::Output)
    }) {
        Ok(()) => exit_code::DONE,
        Err(error) => {
            show::part_error(printer, part, &error);
            error.exit_code()
        }
    }
}

fn taken(
    part: &Path,
    printer: &mut Printer,
    take: impl Fn(&Model, &str) -> Result<String, OperateError>,
) -> Result<String, PartError> {
    let mut read = Read::file(part)?;
    let model = read.model();
    show::diagnostics(printer, part, &read);
    read.refuse_damage()?;
    Ok(take(&model, &part.file_name().unwrap_or_default().to_string_lossy())?)
}
