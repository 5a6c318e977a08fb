//! Stable codes of what may be wrong with the meaning of an IGES file.
//!
//! The grammar's codes are [`Code`](crate::iges::Code)'s. Texts never change once released.

use crate::diagnostic::{Diagnostic, codes};
use crate::iges::{EntryNumber, ExchangeStructure};

codes! {
    /// What a file means badly, or what of its meaning is not read.
    enum ModelCode;

    /// An entity of a kind that is carried, not read.
    NotReadYet, "iges.not-read-yet", Note;
    /// Geometry whose data contradict themselves or the standard.
    BadGeometry, "iges.bad-geometry", Error;
    /// A number beyond every finite one.
    NotFinite, "iges.not-finite", Error;
    /// Topology that cannot be built: the element is left out or counts as unread.
    BadTopology, "iges.bad-topology", Error;
    /// A chain of pointers that returns to itself.
    Cycle, "iges.cycle", Error;
    /// A pointer to an entry that the file does not have.
    Dangling, "iges.dangling-pointer", Error;
    /// A parameter-space curve that cannot be used; the model-space curve stands.
    BadPcurve, "iges.bad-pcurve", Warning;
    /// Curves of a boundary whose counterparts in the other space are not found; they stand without.
    UnpairedPcurve, "iges.unpaired-pcurve", Note;
    /// A model-space curve that the file leaves out and that was approximated from the parameter-space one.
    ApproximatedCurve, "iges.approximated-curve", Warning;
    /// A surface that no kind of geometry is, and that was approximated.
    ApproximatedSurface, "iges.approximated-surface", Warning;
    /// Pieces of a boundary that do not run head to tail; they are turned.
    TurnedPiece, "iges.turned-piece", Warning;
    /// A boundary that runs with its face on the wrong side.
    ReversedBoundary, "iges.reversed-boundary", Warning;
    /// A transformation whose axes are not perpendicular and of length one.
    NotRigid, "iges.not-rigid", Warning;
    /// Flag and name of the unit of length contradict each other, or say nothing.
    BadUnit, "iges.bad-unit", Warning;
    /// A body or shell that several others hold; the first has it.
    SharedShell, "iges.shared-shell", Warning;
    /// A face that its shell lists more than once; it counts once.
    RepeatedFace, "iges.repeated-face", Warning;
    /// A colour, name, level or group that cannot be followed.
    BadReference, "iges.bad-reference", Warning;
    /// An assembly with more instances than are walked.
    TooManyInstances, "iges.too-many-instances", Warning;
}

impl ModelCode {
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
