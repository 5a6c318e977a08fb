//! `resurf feature`: the library of features.

use super::arguments::ExportArguments;
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::job::failure::PartError;
use crate::job::feature_file::export as exported;
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::plan::normal;

/// Takes a feature off a part, writes its file and gives the exit code.
pub fn export(arguments: &ExportArguments, printer: &mut Printer) -> u8 {
    if normal(&arguments.output) == normal(&arguments.part) {
        let message = format!("{} would be written over the input", arguments.output.display());
        printer.message(Severity::Error, &message);
        return exit_code::USAGE;
    }
    match write(arguments, printer) {
        Ok(()) => exit_code::DONE,
        Err(error) => {
            show::part_error(printer, &arguments.part, &error);
            error.exit_code()
        }
    }
}

fn write(arguments: &ExportArguments, printer: &mut Printer) -> Result<(), PartError> {
    let mut read = Read::file(&arguments.part)?;
    let model = read.model();
    show::diagnostics(printer, &arguments.part, &read);
    read.refuse_damage()?;
    let name = arguments.part.file_name().unwrap_or_default().to_string_lossy();
    let region = arguments.region.clone().unwrap_or_default();
    let feature = exported(&model, arguments.face.as_ref(), &region, None, &name)?;
    let written = Staged::write(&arguments.output, feature.text().as_bytes()).and_then(Staged::commit);
    written.map_err(PartError::Output)
}
