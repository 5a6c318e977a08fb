//! `resurf view`: a part as one HTML page.

use super::arguments::ViewArguments;
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::job::failure::PartError;
use crate::job::judge::chord;
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::plan::normal;
use crate::view;

/// Faces without triangles that are named; the rest is counted.
const NAMED: usize = 5;

/// Writes the page of a part and gives the exit code.
pub fn view(arguments: &ViewArguments, printer: &mut Printer) -> u8 {
    if normal(&arguments.output) == normal(&arguments.part) {
        let message = format!("{} would be written over the input", arguments.output.display());
        printer.message(Severity::Error, &message);
        return exit_code::USAGE;
    }
    match write(arguments, printer) {
        Ok(true) => exit_code::DONE,
        Ok(false) => exit_code::GATE,
        Err(error) => {
            show::part_error(printer, &arguments.part, &error);
            error.exit_code()
        }
    }
}

/// Writes the page; gives whether all of the part was understood and is shown.
fn write(arguments: &ViewArguments, printer: &mut Printer) -> Result<bool, PartError> {
    let mut read = Read::file(&arguments.part)?;
    let model = read.model();
    show::diagnostics(printer, &arguments.part, &read);
    read.refuse_damage()?;
    let chord = arguments.tolerance.map(|length| chord(&model, length, "--tolerance")).transpose()?;
    let title = arguments.part.file_name().unwrap_or_default().to_string_lossy();
    let page = view::page(&model, &title, chord);
    let path = arguments.part.display();
    for face in page.missing.iter().take(NAMED) {
        printer.message(Severity::Warning, &format!("{path}: not shown: {face}"));
    }
    if page.missing.len() > NAMED {
        printer.line(&format!("{path}: not shown: {} more faces", page.missing.len() - NAMED));
    }
    if page.cut {
        let message = format!("{path}: only {} placed bodies are shown", view::MOST_BODIES);
        printer.message(Severity::Warning, &message);
    }
    let written = Staged::write(&arguments.output, page.html.as_bytes()).and_then(Staged::commit);
    written.map_err(PartError::Output)?;
    Ok(page.missing.is_empty() && !read.has_errors())
}
