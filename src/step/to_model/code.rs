//! Stable codes of what may be wrong with the meaning of a STEP file.
//!
//! The grammar's codes are [`Code`](crate::step::Code)'s. Texts never change once released.

use crate::diagnostic::{Diagnostic, Severity};
use crate::step::{ExchangeStructure, InstanceName};

/// What a file means badly, or what of its meaning is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ModelCode {
    /// Geometry of a kind that is carried, not read.
    NotReadYet,
    /// Geometry whose data contradict themselves or the standard.
    BadGeometry,
    /// A number beyond every finite one: whoever wrote it lost the value.
    NotFinite,
    /// Topology that cannot be built: the element is left out or counts as unread.
    BadTopology,
    /// A chain of references that returns to itself.
    Cycle,
    /// A reference to a record that the file does not define.
    Dangling,
    /// A parameter-space curve that cannot be used; the edge's curve in space stands.
    BadPcurve,
    /// A context says no unit of length or angle.
    MissingUnit,
    /// A unit that cannot be understood.
    UnknownUnit,
    /// A body or shell that no representation holds, so that its units are assumed.
    LooseBody,
    /// A shell that several bodies hold; the first has it.
    SharedShell,
    /// A face that its shell lists more than once; it counts once.
    RepeatedFace,
    /// A context's uncertainty that is no positive length.
    BadUncertainty,
    /// A record of the header that is missing or has not the attributes that it must have.
    BadHeader,
    /// A coordinate without a point, against ISO 10303-21; said once for a file.
    IntegerForReal,
    /// A coordinate with a lower-case exponent, against ISO 10303-21; said once for a file.
    LowerCaseExponent,
    /// A name with raw bytes that are not UTF-8; they are shown as ISO 8859-1.
    RawString,
    /// A product, an assembly use, a style or a layer that cannot be followed.
    BadReference,
    /// An assembly with more instances than are walked.
    TooManyInstances,
}

impl ModelCode {
    /// The stable text of the code.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::NotReadYet => "step.not-read-yet",
            Self::BadGeometry => "step.bad-geometry",
            Self::NotFinite => "step.not-finite",
            Self::BadTopology => "step.bad-topology",
            Self::Cycle => "step.cycle",
            Self::Dangling => "step.dangling-reference",
            Self::BadPcurve => "step.bad-pcurve",
            Self::MissingUnit => "step.missing-unit",
            Self::UnknownUnit => "step.unknown-unit",
            Self::LooseBody => "step.loose-body",
            Self::SharedShell => "step.shared-shell",
            Self::RepeatedFace => "step.repeated-face",
            Self::BadUncertainty => "step.bad-uncertainty",
            Self::BadHeader => "step.bad-header",
            Self::IntegerForReal => "step.integer-for-real",
            Self::LowerCaseExponent => "step.lower-case-exponent",
            Self::RawString => "step.raw-string",
            Self::BadReference => "step.bad-reference",
            Self::TooManyInstances => "step.too-many-instances",
        }
    }

    /// How much the fact matters.
    #[must_use]
    pub fn severity(self) -> Severity {
        match self {
            Self::NotReadYet => Severity::Note,
            Self::BadGeometry | Self::NotFinite | Self::BadTopology | Self::Cycle | Self::Dangling => {
                Severity::Error
            }
            Self::BadPcurve
            | Self::MissingUnit
            | Self::UnknownUnit
            | Self::LooseBody
            | Self::SharedShell
            | Self::RepeatedFace
            | Self::BadUncertainty
            | Self::BadHeader
            | Self::IntegerForReal
            | Self::LowerCaseExponent
            | Self::RawString
            | Self::BadReference
            | Self::TooManyInstances => Severity::Warning,
        }
    }

    /// A diagnostic about an instance; without a place when the file does not define it.
    #[must_use]
    pub fn at(self, file: &ExchangeStructure, name: InstanceName, message: String) -> Diagnostic {
        Diagnostic {
            code: self.text(),
            severity: self.severity(),
            entity: Some(name.to_string()),
            span: file.instance(name).map(|instance| instance.span()),
            message,
        }
    }
}
