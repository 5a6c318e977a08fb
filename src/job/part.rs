//! Reading one file: bytes, structure, model, and whether it is whole enough to go on.

use std::path::Path;

use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::document::{Document, Format, Unpacked};
use crate::job::failure::PartError;
use crate::job::output::FileError;
use crate::model::Model;
use crate::source::Source;

/// A file that was read.
#[derive(Debug)]
pub struct Read {
    /// Its bytes and structure.
    pub document: Document,
    /// What was found in the file.
    pub diagnostics: Diagnostics,
}

/// Codes of files that cannot be trusted to be whole: what is missing may be what the job is about.
const DAMAGE: [&str; 8] = [
    "step.truncated",
    "step.not-exchange-structure",
    "step.compressed",
    "step.not-finite",
    "iges.truncated",
    "iges.not-iges",
    "iges.missing-section",
    "iges.not-finite",
];

impl Read {
    /// Reads a file from its place.
    ///
    /// # Errors
    /// As [`unpack`](Self::unpack).
    pub fn file(path: &Path) -> Result<Self, PartError> {
        Ok(Self::parse(Self::unpack(path)?))
    }

    /// Reads the bytes of a file from its place, and takes them out of their container.
    ///
    /// # Errors
    /// [`PartError::Input`], [`PartError::Folder`], [`PartError::NoFile`], and [`PartError::Open`] for what is too large,
    /// of no known format or badly packed.
    pub fn unpack(path: &Path) -> Result<Unpacked, PartError> {
        if path.is_dir() {
            return Err(PartError::Folder(path.to_owned()));
        }
        let input = |source| PartError::Input(FileError { path: path.to_owned(), source });
        let found = std::fs::metadata(path).map_err(input)?;
        if !found.is_file() {
            return Err(PartError::NoFile(path.to_owned()));
        }
        // Before it is in memory: what is too large is not read first.
        if let Err(error) = Source::check_size(found.len()) {
            return Err(PartError::Open(error.into()));
        }
        let bytes = std::fs::read(path).map_err(input)?;
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Ok(Document::unpack(bytes, extension)?)
    }

    /// Parses an unpacked file.
    #[must_use]
    pub fn parse(unpacked: Unpacked) -> Self {
        let mut diagnostics = Diagnostics::default();
        let document = Document::parse(unpacked, &mut diagnostics);
        Self { document, diagnostics }
    }

    /// Reads bytes.
    ///
    /// # Errors
    /// [`PartError::Open`].
    pub fn bytes(bytes: Vec<u8>, extension: &str) -> Result<Self, PartError> {
        Ok(Self::parse(Document::unpack(bytes, extension)?))
    }

    /// The first damage that makes a file unfit.
    ///
    /// # Errors
    /// [`PartError::Damaged`] with the place.
    pub fn refuse_damage(&self) -> Result<(), PartError> {
        let damage = self.diagnostics.kept().iter().find(|fact| DAMAGE.contains(&fact.code));
        damage.map_or(Ok(()), |fact| Err(self.damaged(fact)))
    }

    /// The first error in the file: an operation on what could be read would change half of the part.
    ///
    /// # Errors
    /// [`PartError::Damaged`] with the place.
    pub fn refuse_errors(&self) -> Result<(), PartError> {
        let error = self.diagnostics.kept().iter().find(|fact| fact.severity == Severity::Error);
        error.map_or(Ok(()), |fact| Err(self.damaged(fact)))
    }

    fn damaged(&self, fact: &Diagnostic) -> PartError {
        let place =
            fact.span.map(|span| format!(" (line {})", self.document.source().position(span.start).line));
        let entity = fact.entity.as_ref().map(|entity| format!("{entity}: "));
        PartError::Damaged(format!(
            "{}{}{}",
            entity.unwrap_or_default(),
            fact.message,
            place.unwrap_or_default()
        ))
    }

    /// Refuses an output whose name promises another format than the file has.
    ///
    /// # Errors
    /// [`PartError::Setting`].
    pub fn refuse_other_format(&self, output: &Path) -> Result<(), PartError> {
        let found = self.document.format();
        let extension = output.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match Format::of_extension(extension) {
            Some(promised) if promised != found => {
                let [found, promised] = [found, promised].map(Format::as_str);
                let message = format!(
                    "{} would be {promised}, and the part is {found}, in which it is written",
                    output.display()
                );
                Err(PartError::Setting { key: "output", message })
            }
            _ => Ok(()),
        }
    }

    /// Reads what the file means only if a number beyond the finite ones may stand in it: in a file that is
    /// passed through, nobody else would see it.
    pub fn look_for_overflow(&mut self) {
        if self.document.may_overflow() {
            let _ = self.model();
        }
    }

    /// The gravest fact is an error: part of the file is not understood.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.worst() == Some(Severity::Error)
    }

    /// What the file means.
    #[must_use]
    pub fn model(&mut self) -> Model {
        self.document.model(&mut self.diagnostics)
    }
}
