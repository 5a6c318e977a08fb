//! What is wrong with a file, by stable code.
//!
//! A diagnostic is a fact about the user's data. It is neither an error of a call (those are `Result`s)
//! nor a bug of ours (those are panics), and nothing here prints. Each module of the formats owns an enum
//! of codes; this module only knows their text.

use crate::source::Span;

/// How much a fact matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; nothing is lost.
    Note,
    /// Unusual or against the standard, but understood.
    Warning,
    /// Part of the file could not be understood.
    Error,
}

impl Severity {
    /// Lower-case word used in text and JSON output.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// One fact about a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code, `area.what-is-wrong`.
    pub code: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// Entity concerned, as the file names it (`#412`).
    pub entity: Option<String>,
    /// Where in the file.
    pub span: Option<Span>,
    /// Lower-case fragment without a final period: what was found and what was expected.
    pub message: String,
}

/// Where diagnostics go. The caller decides what to keep.
pub trait Sink {
    /// Takes one diagnostic.
    fn report(&mut self, diagnostic: Diagnostic);
}

impl Sink for Vec<Diagnostic> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.push(diagnostic);
    }
}

/// Collects diagnostics up to a limit for each code, so that a hostile file cannot fill the memory.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagnostics {
    kept: Vec<Diagnostic>,
    counts: std::collections::BTreeMap<&'static str, usize>,
}

impl Diagnostics {
    /// How many diagnostics of one code are kept; the rest is only counted.
    pub const KEPT_PER_CODE: usize = 100;

    /// The diagnostics that were kept, in the order of their report.
    #[must_use]
    pub fn kept(&self) -> &[Diagnostic] {
        &self.kept
    }

    /// How often each code was reported, kept or not.
    #[must_use]
    pub fn counts(&self) -> &std::collections::BTreeMap<&'static str, usize> {
        &self.counts
    }

    /// The gravest severity among those kept.
    #[must_use]
    pub fn worst(&self) -> Option<Severity> {
        self.kept.iter().map(|d| d.severity).max()
    }
}

impl Sink for Diagnostics {
    fn report(&mut self, diagnostic: Diagnostic) {
        let count = self.counts.entry(diagnostic.code).or_insert(0);
        *count += 1;
        if *count <= Self::KEPT_PER_CODE {
            self.kept.push(diagnostic);
        }
    }
}

/// Declares the enum of a format's codes, and the only constructors of its diagnostics: each code with its stable text and
/// the severity that follows from it.
macro_rules! codes {
    ($(#[$what:meta])* enum $codes:ident; $($(#[$doc:meta])* $name:ident, $text:literal, $severity:ident;)*) => {
        $(#[$what])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $codes { $($(#[$doc])* $name,)* }

        impl $codes {
            /// Every code, in the order of the declaration.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// The stable text of the code.
            #[must_use]
            pub fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }

            /// How much the fact matters.
            #[must_use]
            pub fn severity(self) -> $crate::diagnostic::Severity {
                match self { $(Self::$name => $crate::diagnostic::Severity::$severity,)* }
            }

            /// A diagnostic of this code at a place.
            #[must_use]
            pub fn note(
                self,
                span: $crate::source::Span,
                message: impl Into<String>,
            ) -> $crate::diagnostic::Diagnostic {
                $crate::diagnostic::Diagnostic {
                    code: self.text(),
                    severity: self.severity(),
                    entity: None,
                    span: Some(span),
                    message: message.into(),
                }
            }

            /// A diagnostic of this code about one entity.
            #[must_use]
            pub fn note_on(
                self,
                entity: impl std::fmt::Display,
                span: $crate::source::Span,
                message: impl Into<String>,
            ) -> $crate::diagnostic::Diagnostic {
                $crate::diagnostic::Diagnostic { entity: Some(entity.to_string()), ..self.note(span, message) }
            }
        }
    };
}

pub(crate) use codes;
