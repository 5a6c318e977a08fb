//! A part made anew in the other format, and read again before it is believed.

use crate::diagnostic::Severity;
use crate::document::{Conversion, Stamp, converted};
use crate::job::failure::PartError;
use crate::job::part::Read;
use crate::model::{Inventory, Model};

/// The bytes of the part in the other format, with each loss among the diagnostics of what was read.
///
/// # Errors
/// [`PartError::Damaged`] where not all of the part was read, [`PartError::Convert`] for what the format cannot say, and
/// [`PartError::Check`] when the bytes, read again, do not have what the part has.
pub fn made(read: &mut Read, conversion: Conversion, name: &str) -> Result<Vec<u8>, PartError> {
    let model = read.model();
    read.refuse_errors()?;
    let stamp = Stamp { time: crate::job::clock::time_stamp(), preprocessor: crate::job::run::program() };
    let bytes = converted(&model, conversion, name, &stamp, &mut read.diagnostics)?;
    let faults = faults(&model, bytes.clone(), conversion)?;
    if faults.is_empty() { Ok(bytes) } else { Err(PartError::Check(faults)) }
}

/// What a made file, read again, has not as the model has it.
fn faults(model: &Model, bytes: Vec<u8>, conversion: Conversion) -> Result<Vec<String>, PartError> {
    let mut again = Read::bytes(bytes, "")?;
    let written = Inventory::of(&again.model());
    let meant = Inventory::of(model);
    let counts = [("faces", meant.faces, written.faces), ("free curves", meant.curves, written.curves)];
    let differ = counts.into_iter().filter(|(_, meant, written)| meant != written);
    let mut faults: Vec<String> =
        differ.map(|(what, meant, written)| format!("{written} {what} are written of {meant}")).collect();
    // Trimmed surfaces have edges of their own each.
    if matches!(conversion, Conversion::Step(_)) && meant.edges != written.edges {
        faults.push(format!("{} edges are written of {}", written.edges, meant.edges));
    }
    let errors = again.diagnostics.kept().iter().filter(|fact| fact.severity == Severity::Error);
    faults.extend(errors.take(FAULTS).map(|fact| format!("{}: {}", fact.code, fact.message)));
    Ok(faults)
}

/// Errors of a made file that are told.
const FAULTS: usize = 5;
