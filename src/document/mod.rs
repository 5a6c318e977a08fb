//! Recognises the format of a file, part or cloud; the one place that dispatches between formats.
//!
//! Holds no policy: what to do with a file that cannot be read is the caller's decision. STEP is read, plain,
//! in a gzip stream or in a zip archive, and IGES; everything else is recognised, so that a message can say what the
//! file is.

pub mod cloud;
mod compressed;
mod convert;
pub mod proof;

use crate::diagnostic::Sink;
use crate::exchange::Patch;
use crate::model::{ChangeSet, Model, Origin};
use crate::source::{Source, SourceTooLarge};
use crate::{iges, step};
pub use compressed::CompressedError;
pub use convert::{Conversion, ConvertError, Schema, Solids, converted};
pub use proof::{CopyResiduals, ProofError};

/// What the bytes of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// ISO 10303-21 clear text.
    Step,
    /// IGES, fixed or compressed ASCII.
    Iges,
    /// A gzip stream, as `.stpZ` files are.
    Gzip,
    /// A zip archive, as `.stpZ` files of the CAx-IF are.
    Zip,
}

impl Format {
    /// Name in messages and reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Iges => "iges",
            Self::Gzip => "gzip",
            Self::Zip => "zip",
        }
    }

    /// The format of a file by its content; the extension decides only when the content does not.
    #[must_use]
    pub fn recognise(bytes: &[u8], extension: &str) -> Option<Self> {
        if bytes.starts_with(&[0x1f, 0x8b]) {
            return Some(Self::Gzip);
        }
        if bytes.starts_with(b"PK\x03\x04") {
            return Some(Self::Zip);
        }
        // Some writers put bytes before the first line, and OpenCASCADE's predecessors a comment.
        let head = &bytes[..bytes.len().min(HEAD)];
        if memchr::memmem::find(head, b"ISO-10303-21").is_some() {
            return Some(Self::Step);
        }
        if is_iges(bytes) {
            return Some(Self::Iges);
        }
        Self::of_extension(extension)
    }

    /// The format that an extension promises.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "step" | "stp" | "p21" | "214" => Some(Self::Step),
            "iges" | "igs" => Some(Self::Iges),
            _ => None,
        }
    }
}

/// Bytes searched for the first line of a STEP file.
const HEAD: usize = 4096;

/// IGES: the first record has `S` (or, for the compressed and binary forms, `C` or `B`) in column 73
/// and a sequence number behind it.
fn is_iges(bytes: &[u8]) -> bool {
    matches!(bytes.get(72), Some(b'S' | b'C' | b'B'))
        && bytes
            .get(73..80)
            .is_some_and(|n| n.iter().all(|b| b.is_ascii_digit() || *b == b' ') && n[6] == b'1')
}

/// Why a file is not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// Neither the content nor the extension is known.
    #[error("neither the content nor the extension is that of a known format")]
    Unknown,
    /// The file is empty.
    #[error("the file is empty; export the part again")]
    Empty,
    /// The file is compressed, and what is inside cannot be had.
    #[error(transparent)]
    Compressed(#[from] CompressedError),
    /// The file is larger than can be addressed.
    #[error(transparent)]
    TooLarge(#[from] SourceTooLarge),
}

impl OpenError {
    /// The stable code.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unknown => "document.unknown-format",
            Self::Empty => "document.empty",
            Self::TooLarge(_) | Self::Compressed(CompressedError::TooLarge { .. }) => "document.too-large",
            Self::Compressed(CompressedError::OutOfMemory) => "resource.memory",
            Self::Compressed(_) => "document.bad-compression",
        }
    }
}

/// One file of a format that is read, out of its container, not yet parsed.
#[derive(Debug)]
pub struct Unpacked {
    source: Source,
    format: Format,
}

impl Unpacked {
    /// The bytes.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// What the bytes are.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }
}

/// One file, parsed.
#[derive(Debug)]
pub struct Document {
    structure: Structure,
}

/// The exchange structure of either format.
#[derive(Debug)]
enum Structure {
    Step(step::ExchangeStructure),
    Iges(Box<iges::ExchangeStructure>),
}

impl Document {
    /// Recognises and parses a file. What is wrong inside it goes to the sink.
    ///
    /// # Errors
    /// [`OpenError`] when it is no file of a format that is read.
    pub fn open(bytes: Vec<u8>, extension: &str, sink: &mut dyn Sink) -> Result<Self, OpenError> {
        Ok(Self::parse(Self::unpack(bytes, extension)?, sink))
    }

    /// Parses an unpacked file. What is wrong inside it goes to the sink.
    pub fn parse(unpacked: Unpacked, sink: &mut dyn Sink) -> Self {
        let structure = match unpacked.format {
            Format::Iges => Structure::Iges(Box::new(iges::ExchangeStructure::parse(unpacked.source, sink))),
            Format::Step | Format::Gzip | Format::Zip => {
                Structure::Step(step::ExchangeStructure::parse(unpacked.source, sink))
            }
        };
        Self { structure }
    }

    /// Recognises a file and takes it out of its container, if it has one.
    ///
    /// # Errors
    /// [`OpenError`] when it is no file of a format that is read.
    pub fn unpack(bytes: Vec<u8>, extension: &str) -> Result<Unpacked, OpenError> {
        if bytes.is_empty() {
            return Err(OpenError::Empty);
        }
        let (bytes, format) = match Format::recognise(&bytes, extension) {
            Some(Format::Gzip) => Self::unfolded(compressed::gunzip(&bytes)?),
            Some(Format::Zip) => Self::unfolded(compressed::unzip(&bytes)?),
            format => (bytes, format),
        };
        match format {
            // A container in a container is nobody's part.
            None | Some(Format::Gzip | Format::Zip) => Err(OpenError::Unknown),
            Some(format) => Ok(Unpacked { source: Source::new(bytes)?, format }),
        }
    }

    /// Unfolded bytes with their format, which counts as STEP when they do not say: that is what is sent so.
    fn unfolded(bytes: Vec<u8>) -> (Vec<u8>, Option<Format>) {
        let format = Format::recognise(&bytes, "stp");
        (bytes, format)
    }

    /// Name of the format.
    #[must_use]
    pub fn format(&self) -> Format {
        match self.structure {
            Structure::Step(_) => Format::Step,
            Structure::Iges(_) => Format::Iges,
        }
    }

    /// The input bytes; those inside, when the file was compressed.
    #[must_use]
    pub fn source(&self) -> &Source {
        match &self.structure {
            Structure::Step(structure) => structure.source(),
            Structure::Iges(structure) => structure.source(),
        }
    }

    /// Whether a number may stand in the file that no finite one holds: a cheap look at the bytes, which errs on
    /// the side of yes.
    #[must_use]
    pub fn may_overflow(&self) -> bool {
        let bytes = self.source().bytes();
        match self.structure {
            Structure::Step(_) => crate::number::may_overflow(bytes),
            Structure::Iges(_) => iges::may_overflow(bytes),
        }
    }

    /// Line of a record, from 1; `None` when the file has no such record.
    #[must_use]
    pub fn line_of(&self, origin: Origin) -> Option<usize> {
        let span = match (&self.structure, origin) {
            (Structure::Step(structure), Origin::Instance(name)) => {
                structure.instance(step::InstanceName(name))?.span()
            }
            (Structure::Iges(structure), Origin::DirectoryEntry(entry) | Origin::Member { entry, .. }) => {
                structure.instance(iges::EntryNumber(entry))?.span()
            }
            _ => return None,
        };
        Some(self.source().position(span.start).line)
    }

    /// What the file means.
    pub fn model(&self, sink: &mut dyn Sink) -> Model {
        match &self.structure {
            Structure::Step(structure) => {
                structure.unresolved_references(sink);
                structure.damaged_records(sink);
                step::to_model(structure, sink)
            }
            Structure::Iges(structure) => {
                structure.unresolved_pointers(sink);
                structure.damaged_records(sink);
                iges::to_model(structure, sink)
            }
        }
    }

    /// The byte edits that carry out a change set; the header gets its stamp when anything changes.
    ///
    /// # Errors
    /// [`LowerError`] naming the entity that cannot be written.
    pub fn lower(&self, model: &Model, changes: &ChangeSet, stamp: &Stamp) -> Result<Patch, LowerError> {
        let patch = match &self.structure {
            Structure::Step(structure) => {
                let patch = step::lower(structure, model, changes)?;
                if patch.is_empty() {
                    return Ok(patch);
                }
                let mut edits = patch.edits().to_vec();
                edits.extend(step::edit::stamp(structure, &stamp.time, &stamp.preprocessor));
                Patch::new(self.source().bytes().len(), edits)?
            }
            Structure::Iges(structure) => {
                let mut changes = iges::lower(structure, model, changes)?;
                if !changes.is_empty() {
                    changes.stamp(structure, &stamp.time, &stamp.preprocessor);
                }
                iges::lower::patch(structure, &changes)?
            }
        };
        Ok(patch)
    }
}

/// What a changed file says about its writing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stamp {
    /// ISO 8601 time without zone.
    pub time: String,
    /// Name and version of the program that wrote the file.
    pub preprocessor: String,
}

/// A change that cannot be written in the file's format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LowerError {
    /// By the writer of STEP.
    #[error(transparent)]
    Step(#[from] step::lower::LowerError),
    /// By the writer of IGES.
    #[error(transparent)]
    Iges(#[from] iges::lower::LowerError),
    /// The header's stamp and an edit overlap.
    #[error(transparent)]
    Patch(#[from] crate::exchange::PatchError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_is_stronger_than_the_extension() {
        let mut iges = vec![b' '; 72];
        iges.extend_from_slice(b"S      1\n");
        let cases: [(&[u8], &str, Option<Format>); 7] = [
            (b"ISO-10303-21;\n", "igs", Some(Format::Step)),
            (b"\xef\xbb\xbfISO-10303-21;", "", Some(Format::Step)),
            (b"x\nISO-10303-21;", "txt", Some(Format::Step)),
            (&iges, "stp", Some(Format::Iges)),
            (&[0x1f, 0x8b, 8], "stpZ", Some(Format::Gzip)),
            (b"PK\x03\x04", "stpZ", Some(Format::Zip)),
            (b"solid cube", "stl", None),
        ];
        for (bytes, extension, expected) in cases {
            assert_eq!(Format::recognise(bytes, extension), expected, "{extension}");
        }
    }
}
