//! `resurf diff`: how two parts differ.

use std::path::Path;

use super::arguments::{Aspect, DiffArguments};
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::job::failure::PartError;
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::report::difference::{Compared, json, lines};
use crate::model::Model;

/// Compares two parts and gives the exit code: 1 when they differ.
pub fn diff(arguments: &DiffArguments, printer: &mut Printer) -> u8 {
    let model = |path: &Path, printer: &mut Printer| match read(path, printer) {
        Ok(model) => Ok(model),
        Err(error) => {
            show::part_error(printer, path, &error);
            Err(error.exit_code())
        }
    };
    let (before, after) = match (model(&arguments.before, printer), model(&arguments.after, printer)) {
        (Ok(before), Ok(after)) => (before, after),
        (Err(code), _) | (_, Err(code)) => return code,
    };
    let mut compared = Compared::new(&before, &after, arguments.tolerance);
    match arguments.only {
        Some(Aspect::Geometry) => compared.difference.structure.clear(),
        Some(Aspect::Structure) => {
            compared.difference.changes.clear();
            compared.difference.curves.clear();
        }
        None => {}
    }
    let difference = &mut compared.difference;
    difference.equal =
        difference.structure.is_empty() && difference.changes.is_empty() && difference.curves.is_empty();
    let name = |path: &Path| path.to_string_lossy().into_owned();
    if let Some(place) = &arguments.html {
        let title = format!("{} to {}", name(&arguments.before), name(&arguments.after));
        let page = compared.page(&title);
        if let Err(error) = Staged::write(place, page.html.as_bytes()).and_then(Staged::commit) {
            let error = PartError::Output(error);
            show::part_error(printer, place, &error);
            return error.exit_code();
        }
    }
    let difference = &compared.difference;
    if arguments.json {
        printer.data(&json(difference, &name(&arguments.before), &name(&arguments.after)));
    } else {
        printer.data(&(lines(difference).join("\n") + "\n"));
    }
    if difference.equal { exit_code::DONE } else { exit_code::GATE }
}

fn read(path: &Path, printer: &mut Printer) -> Result<Model, PartError> {
    let mut read = Read::file(path)?;
    let model = read.model();
    show::diagnostics(printer, path, &read);
    // Half of a part has no difference from another that is worth telling.
    read.refuse_damage()?;
    Ok(model)
}
