//! Stable codes of what may be wrong with the meaning of an IGES file.
//!
//! The grammar's codes are [`Code`](crate::iges::Code)'s. Texts never change once released.

use crate::diagnostic::{Diagnostic, Severity};
use crate::iges::{EntryNumber, ExchangeStructure};

/// What a file means badly, or what of its meaning is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ModelCode {
    /// An entity of a kind that is carried, not read.
    NotReadYet,
    /// Geometry whose data contradict themselves or the standard.
    BadGeometry,
    /// A number beyond every finite one.
    NotFinite,
    /// Topology that cannot be built: the element is left out or counts as unread.
    BadTopology,
    /// A chain of pointers that returns to itself.
    Cycle,
    /// A pointer to an entry that the file does not have.
    Dangling,
    /// A parameter-space curve that cannot be used; the model-space curve stands.
    BadPcurve,
    /// Curves of a boundary whose counterparts in the other space are not found; they stand without.
    UnpairedPcurve,
    /// A model-space curve that the file leaves out and that was approximated from the parameter-space one.
    ApproximatedCurve,
    /// A surface that no kind of geometry is, and that was approximated.
    ApproximatedSurface,
    /// Pieces of a boundary that do not run head to tail; they are turned.
    TurnedPiece,
    /// A boundary that runs with its face on the wrong side.
    ReversedBoundary,
    /// A transformation whose axes are not perpendicular and of length one.
    NotRigid,
    /// Flag and name of the unit of length contradict each other, or say nothing.
    BadUnit,
    /// A body or shell that several others hold; the first has it.
    SharedShell,
    /// A face that its shell lists more than once; it counts once.
    RepeatedFace,
    /// Loose faces were sewn along common edges, as was asked for.
    Sewn,
    /// A colour, name, level or group that cannot be followed.
    BadReference,
    /// An assembly with more instances than are walked.
    TooManyInstances,
}

impl ModelCode {
    /// The stable text of the code.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::NotReadYet => "iges.not-read-yet",
            Self::BadGeometry => "iges.bad-geometry",
            Self::NotFinite => "iges.not-finite",
            Self::BadTopology => "iges.bad-topology",
            Self::Cycle => "iges.cycle",
            Self::Dangling => "iges.dangling-pointer",
            Self::BadPcurve => "iges.bad-pcurve",
            Self::UnpairedPcurve => "iges.unpaired-pcurve",
            Self::ApproximatedCurve => "iges.approximated-curve",
            Self::ApproximatedSurface => "iges.approximated-surface",
            Self::TurnedPiece => "iges.turned-piece",
            Self::ReversedBoundary => "iges.reversed-boundary",
            Self::NotRigid => "iges.not-rigid",
            Self::BadUnit => "iges.bad-unit",
            Self::SharedShell => "iges.shared-shell",
            Self::RepeatedFace => "iges.repeated-face",
            Self::Sewn => "iges.sewn",
            Self::BadReference => "iges.bad-reference",
            Self::TooManyInstances => "iges.too-many-instances",
        }
    }

    /// How much the fact matters.
    #[must_use]
    pub fn severity(self) -> Severity {
        match self {
            Self::NotReadYet | Self::UnpairedPcurve | Self::Sewn => Severity::Note,
            Self::BadGeometry | Self::NotFinite | Self::BadTopology | Self::Cycle | Self::Dangling => {
                Severity::Error
            }
            Self::BadPcurve
            | Self::ApproximatedCurve
            | Self::ApproximatedSurface
            | Self::TurnedPiece
            | Self::ReversedBoundary
            | Self::NotRigid
            | Self::BadUnit
            | Self::SharedShell
            | Self::RepeatedFace
            | Self::BadReference
            | Self::TooManyInstances => Severity::Warning,
        }
    }

    /// A diagnostic about an entity; without a place when the file does not have it.
    #[must_use]
    pub fn at(self, file: &ExchangeStructure, number: EntryNumber, message: String) -> Diagnostic {
        Diagnostic {
            code: self.text(),
            severity: self.severity(),
            entity: Some(number.to_string()),
            span: file.instance(number).map(|instance| instance.span()),
            message,
        }
    }
}
