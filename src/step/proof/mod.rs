//! What anybody can say of two exchange structures without knowing how one came from the other: whether a record, with
//! all that it stands for, is the same in both, or a rigid copy.
//!
//! Reads records and references only. Shares nothing with the reader of models or the writer of changes, whose faults it is
//! there to find. The forms that are compared are laid down in `docs/proof-sheet.md`.

mod canonical;
mod frame;
mod rigid_copy;

pub use canonical::Digests;
pub use rigid_copy::{Residuals, RigidCopy};

use super::exchange_structure::{Instance, InstanceName};
use super::parameter::{Parameter, ParameterKind};

/// References within references that are followed: real shapes need some dozen.
const MAX_DEPTH: usize = 500;

/// Why two records cannot be compared, or how they differ.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProofError {
    /// A reference leads nowhere.
    #[error("{0} is not defined")]
    Undefined(InstanceName),
    /// A record refers to itself on some way, or too deep.
    #[error("{0} refers to itself, or through too many others")]
    Endless(InstanceName),
    /// A record is damaged, or not what its keyword asks for.
    #[error("{0} is malformed")]
    Malformed(InstanceName),
    /// The records are not copies of each other.
    #[error("{before} and {after} differ: {what}")]
    Different {
        /// The record before.
        before: InstanceName,
        /// The record after.
        after: InstanceName,
        /// In what.
        what: &'static str,
    },
}

/// The curve in space that a curve on surfaces stands for; `None` for any other record. Curves in parameters belong to the
/// faces, and change with these.
fn curve_in_space(instance: &Instance<'_>) -> Option<InstanceName> {
    const ON_SURFACES: [&[u8]; 3] = [b"SURFACE_CURVE", b"SEAM_CURVE", b"INTERSECTION_CURVE"];
    let record = ON_SURFACES.iter().find_map(|keyword| instance.record(keyword))?;
    // A partial record of a complex instance has no name in front.
    let place = usize::from(!instance.is_complex());
    record.parameters().nth(place)?.as_reference()
}

/// Bits of a number, those of zero for minus zero; `None` for what is no number.
fn bits(parameter: &Parameter<'_>) -> Option<u64> {
    let number = matches!(parameter.kind(), ParameterKind::Real | ParameterKind::Integer);
    let value = number.then(|| parameter.as_f64()).flatten()?;
    Some(if value == 0.0 { 0 } else { value.to_bits() })
}
