//! `resurf verify`: whether what a proof sheet claims holds between two files.

use std::path::Path;

use super::arguments::VerifyArguments;
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::job::side::proof::{self, Verification};

/// Checks a sheet and gives the exit code.
pub fn verify(arguments: &VerifyArguments, printer: &mut Printer) -> u8 {
    let text = match std::fs::read_to_string(&arguments.proof) {
        Ok(text) => text,
        Err(error) => return unreadable(&arguments.proof, &error.to_string(), printer),
    };
    let sheet = match proof::read(&text) {
        Ok(sheet) => sheet,
        Err(error) => return unreadable(&arguments.proof, &error, printer),
    };
    let mut documents = Vec::with_capacity(2);
    for path in [&arguments.before, &arguments.after] {
        match proof::document(path) {
            Ok(document) => documents.push(document),
            Err(error) => {
                show::part_error(printer, path, &error);
                return error.exit_code();
            }
        }
    }
    let found = proof::verify(&sheet, &documents[0], &documents[1]);
    if arguments.json {
        let text = serde_json::to_string_pretty(&found).expect("a check is a tree of texts and numbers");
        printer.data(&(text + "\n"));
    } else {
        printer.data(&plain(&found));
    }
    if found.is_proved() { exit_code::DONE } else { exit_code::GATE }
}

fn unreadable(path: &Path, error: &str, printer: &mut Printer) -> u8 {
    printer.message(Severity::Error, &format!("{}: {error}", path.display()));
    exit_code::UNREADABLE
}

fn plain(found: &Verification) -> String {
    let mut text = String::new();
    for fault in &found.faults {
        text.push_str(&format!("fault: {fault}\n"));
    }
    for (number, group) in found.groups.iter().enumerate() {
        text.push_str(&format!(
            "group {number}: {} points, off their motion by {:.1e}, {} distances by {:.1e}, directions by {:.1e}\n",
            group.points, group.motion, group.pairs, group.distances, group.directions
        ));
    }
    let verdict = if found.is_proved() { "proved" } else { "not proved" };
    text.push_str(&format!("{verdict}: {} entities, {} unmoved\n", found.entities, found.unmoved));
    text
}
