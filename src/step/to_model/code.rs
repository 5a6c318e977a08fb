//! Stable codes of what may be wrong with the meaning of a STEP file.
//!
//! The grammar's codes are [`Code`](crate::step::Code)'s. Texts never change once released.

use crate::diagnostic::{Diagnostic, codes};
use crate::step::{ExchangeStructure, InstanceName};

codes! {
    /// What a file means badly, or what of its meaning is not read.
    enum ModelCode;

    /// Geometry of a kind that is carried, not read.
    NotReadYet, "step.not-read-yet", Note;
    /// Geometry whose data contradict themselves or the standard.
    BadGeometry, "step.bad-geometry", Error;
    /// A number beyond every finite one: whoever wrote it lost the value.
    NotFinite, "step.not-finite", Error;
    /// Topology that cannot be built: the element is left out or counts as unread.
    BadTopology, "step.bad-topology", Error;
    /// A chain of references that returns to itself.
    Cycle, "step.cycle", Error;
    /// A reference to a record that the file does not define.
    Dangling, "step.dangling-reference", Error;
    /// A parameter-space curve that cannot be used; the edge's curve in space stands.
    BadPcurve, "step.bad-pcurve", Warning;
    /// A context says no unit of length or angle.
    MissingUnit, "step.missing-unit", Warning;
    /// A unit that cannot be understood.
    UnknownUnit, "step.unknown-unit", Warning;
    /// A body or shell that no representation holds, so that its units are assumed.
    LooseBody, "step.loose-body", Warning;
    /// A shell that several bodies hold; the first has it.
    SharedShell, "step.shared-shell", Warning;
    /// A face that its shell lists more than once; it counts once.
    RepeatedFace, "step.repeated-face", Warning;
    /// A context's uncertainty that is no positive length.
    BadUncertainty, "step.bad-uncertainty", Warning;
    /// A record of the header that is missing or has not the attributes that it must have.
    BadHeader, "step.bad-header", Warning;
    /// A coordinate without a point, against ISO 10303-21; said once for a file.
    IntegerForReal, "step.integer-for-real", Warning;
    /// A coordinate with a lower-case exponent, against ISO 10303-21; said once for a file.
    LowerCaseExponent, "step.lower-case-exponent", Warning;
    /// A name with raw bytes that are not UTF-8; they are shown as ISO 8859-1.
    RawString, "step.raw-string", Warning;
    /// A product, an assembly use, a style or a layer that cannot be followed.
    BadReference, "step.bad-reference", Warning;
    /// An assembly with more instances than are walked.
    TooManyInstances, "step.too-many-instances", Warning;
}

impl ModelCode {
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
