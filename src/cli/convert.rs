//! `resurf convert`: a part passed through as it is, made anew in the other format, or its mesh.

use std::path::{Path, PathBuf};

use super::arguments::{ConvertArguments, SchemaWord, SolidsWord, Target};
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::diagnostic::Severity;
use crate::document::{Conversion, Format, Unpacked};
use crate::job::convert::made;
use crate::job::failure::PartError;
use crate::job::file::SideFormat;
use crate::job::judge::{chord, side_bytes};
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
        let result = one(input, output, *target, arguments, printer);
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
            None if into_folder => own_format(input),
            None => by_extension(output)?,
        };
        let place = if into_folder {
            let name = input.file_name().ok_or_else(|| format!("{} is no file", input.display()))?;
            let name = PathBuf::from(name);
            output.join(match target {
                // What is written of a compressed file is plain.
                Target::Step if is_compressed(&name) => name.with_extension("stp"),
                Target::Step | Target::Iges if own_format(&name) == target => name,
                Target::Step => name.with_extension("step"),
                Target::Iges => name.with_extension("igs"),
                Target::Stl | Target::StlText => name.with_extension("stl"),
                Target::Off => name.with_extension("off"),
                Target::ThreeMf => name.with_extension("3mf"),
                Target::Glb => name.with_extension("glb"),
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

/// The format that a file's name promises: STEP unless it says otherwise.
fn own_format(name: &Path) -> Target {
    let extension = name.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if Format::of_extension(extension) == Some(Format::Iges) { Target::Iges } else { Target::Step }
}

fn is_compressed(name: &Path) -> bool {
    let extension = name.extension().and_then(|e| e.to_str()).unwrap_or_default();
    ["stpz", "gz", "zip"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

fn by_extension(output: &Path) -> Result<Target, String> {
    let extension = output.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "stl" => Ok(Target::Stl),
        "off" => Ok(Target::Off),
        "3mf" => Ok(Target::ThreeMf),
        "glb" => Ok(Target::Glb),
        _ if Format::of_extension(&extension).is_some() => Ok(own_format(output)),
        _ => Err(format!(
            "the extension of {} is not one that is written: step, stp, igs, iges, stl, off, 3mf, glb; `--to` decides \
             as well",
            output.display()
        )),
    }
}

fn one(
    input: &Path,
    output: &Path,
    target: Target,
    arguments: &ConvertArguments,
    printer: &mut Printer,
) -> Result<(), PartError> {
    let tolerance = arguments.tolerance;
    if !matches!(target, Target::Step | Target::Iges) {
        refuse_misplaced(arguments, None)?;
    }
    match target {
        Target::Step | Target::Iges => part(input, output, target, arguments, printer),
        Target::Stl => mesh(input, output, SideFormat::Stl, tolerance, printer),
        Target::StlText => mesh(input, output, SideFormat::StlText, tolerance, printer),
        Target::Off => mesh(input, output, SideFormat::Off, tolerance, printer),
        Target::ThreeMf => mesh(input, output, SideFormat::ThreeMf, tolerance, printer),
        Target::Glb => mesh(input, output, SideFormat::Glb, tolerance, printer),
    }
}

/// A part in a format of parts: its own, or the other one.
fn part(
    input: &Path,
    output: &Path,
    target: Target,
    arguments: &ConvertArguments,
    printer: &mut Printer,
) -> Result<(), PartError> {
    let unpacked = Read::unpack(input)?;
    let same = (unpacked.format() == Format::Iges) == (target == Target::Iges);
    refuse_misplaced(arguments, (!same).then_some(target))?;
    if same {
        return copy(input, output, unpacked, printer);
    }
    let conversion = match target {
        Target::Iges => Conversion::Iges(arguments.solids.unwrap_or(SolidsWord::Brep).into()),
        _ => Conversion::Step(arguments.schema.unwrap_or(SchemaWord::Ap214).into()),
    };
    let mut read = Read::parse(unpacked);
    read.look_for_overflow();
    let name = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let bytes = read.refuse_damage().and_then(|()| made(&mut read, conversion, &name));
    show::diagnostics(printer, input, &read);
    Staged::write(output, &bytes?).and_then(Staged::commit).map_err(PartError::Output)
}

/// Refuses arguments that say nothing of what is made; `made` is the format of a part that is made of another.
fn refuse_misplaced(arguments: &ConvertArguments, made: Option<Target>) -> Result<(), PartError> {
    let refused = |key, message: &str| Err(PartError::Setting { key, message: message.to_owned() });
    match (arguments.schema, arguments.solids) {
        (Some(_), _) if made != Some(Target::Step) => {
            refused("schema", "is for STEP files that are made of IGES files")
        }
        (_, Some(_)) if made != Some(Target::Iges) => {
            refused("solids", "is for IGES files that are made of STEP files")
        }
        _ => Ok(()),
    }
}

/// Passes a part through. The disk takes longer than the look at the file, so the bytes are on their way while they
/// are read; a file that turns out damaged leaves no file behind.
fn copy(input: &Path, output: &Path, unpacked: Unpacked, printer: &mut Printer) -> Result<(), PartError> {
    let source = unpacked.source().clone();
    let staged = std::thread::scope(|scope| {
        let staged = scope.spawn(|| Staged::write(output, source.bytes()));
        let mut read = Read::parse(unpacked);
        read.look_for_overflow();
        show::diagnostics(printer, input, &read);
        read.refuse_damage()?;
        staged.join().map_err(|_| PartError::Internal)?.map_err(PartError::Output)
    })?;
    staged.commit().map_err(PartError::Output)
}

fn mesh(
    input: &Path,
    output: &Path,
    format: SideFormat,
    tolerance: Option<Length>,
    printer: &mut Printer,
) -> Result<(), PartError> {
    let mut read = Read::file(input)?;
    let model = read.model();
    let chord = tolerance.map(|length| chord(&model, length, "--tolerance")).transpose()?;
    let bytes = side_bytes(&model, chord, format)?;
    show::diagnostics(printer, input, &read);
    // The mesh of what could be read would be the mesh of half a part.
    read.refuse_errors()?;
    Staged::write(output, &bytes).and_then(Staged::commit).map_err(PartError::Output)
}
