//! `resurf convert`: a part passed through as it is, or its mesh.

use std::path::{Path, PathBuf};

use super::arguments::{ConvertArguments, Target};
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::document::Format;
use crate::job::failure::PartError;
use crate::job::file::SideFormat;
use crate::job::judge::{chord, mesh_bytes, whole_mesh};
use crate::job::output::Staged;
use crate::job::part::Read;
use crate::job::plan::normal;
use crate::units::Length;

/// Converts parts and gives the exit code.
pub fn convert(arguments: &ConvertArguments, printer: &mut Printer) -> u8 {
    let outputs = match places(arguments) {
        Ok(outputs) => outputs,
        Err(message) => {
            printer.message(Severity::Error, &message);
            return exit_code::USAGE;
        }
    };
    let mut codes = Vec::new();
    for (input, (output, target)) in arguments.inputs.iter().zip(&outputs) {
        let result = one(input, output, *target, arguments.tolerance, printer);
        codes.push(match result {
            Ok(()) => exit_code::DONE,
            Err(error) => {
                show::part_error(printer, input, &error);
                error.exit_code()
            }
        });
    }
    match codes.as_slice() {
        [code] => *code,
        codes if codes.iter().all(|&code| code == exit_code::DONE) => exit_code::DONE,
        _ => exit_code::GATE,
    }
}

/// Output and target of each input.
fn places(arguments: &ConvertArguments) -> Result<Vec<(PathBuf, Target)>, String> {
    let output = &arguments.output;
    let into_folder = output.is_dir() || arguments.inputs.len() > 1;
    let mut places: Vec<(PathBuf, Target)> = Vec::new();
    for input in &arguments.inputs {
        let target = match arguments.to {
            Some(target) => target,
            None if into_folder => Target::Step,
            None => by_extension(output)?,
        };
        let place = if into_folder {
            let name = input.file_name().ok_or_else(|| format!("{} is no file", input.display()))?;
            let name = PathBuf::from(name);
            output.join(match target {
                Target::Step => name,
                Target::Stl => name.with_extension("stl"),
                Target::Off => name.with_extension("off"),
            })
        } else {
            output.clone()
        };
        if places.iter().any(|(other, _)| normal(other) == normal(&place)) {
            return Err(format!("two parts would be written to {}", place.display()));
        }
        let same = |other: &PathBuf| normal(&place) == normal(other);
        if arguments.inputs.iter().any(same) {
            return Err(format!("{} would be written over an input", place.display()));
        }
        places.push((place, target));
    }
    Ok(places)
}

fn by_extension(output: &Path) -> Result<Target, String> {
    let extension = output.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "stl" => Ok(Target::Stl),
        "off" => Ok(Target::Off),
        _ if Format::of_extension(&extension) == Some(Format::Step) => Ok(Target::Step),
        _ => Err(format!(
            "the extension of {} is not one that is written: step, stp, stl, off; `--to` decides as well",
            output.display()
        )),
    }
}

fn one(
    input: &Path,
    output: &Path,
    target: Target,
    tolerance: Option<Length>,
    printer: &mut Printer,
) -> Result<(), PartError> {
    let mut read = Read::file(input)?;
    let format = match target {
        Target::Step => None,
        Target::Stl => Some(SideFormat::Stl),
        Target::Off => Some(SideFormat::Off),
    };
    let bytes = match format {
        None => {
            read.look_for_overflow();
            None
        }
        Some(format) => {
            let model = read.model();
            let chord = tolerance.map(|length| chord(&model, length, "--tolerance")).transpose()?;
            Some(mesh_bytes(&whole_mesh(&model, chord)?, format))
        }
    };
    show::diagnostics(printer, input, &read);
    // The mesh of what could be read would be the mesh of half a part; a copy is whole whatever it means.
    if bytes.is_some() { read.refuse_errors() } else { read.refuse_damage() }?;
    let bytes = bytes.as_deref().unwrap_or_else(|| read.document.source().bytes());
    Staged::write(output, bytes).and_then(Staged::commit).map_err(PartError::Output)
}
