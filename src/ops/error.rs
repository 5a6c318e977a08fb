//! Why an operation cannot be done on a part.

use super::constrained_scale::ScaleError;
use super::deform::DeformError;
use super::detail_transfer::TransferError;
use super::feature_paste::PasteError;
use super::simplify::SimplifyError;

/// An element that cannot take part, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Obstacle {
    /// Name of the record in the file: `#412`.
    pub entity: String,
    /// What it is: `cylinder`, or the entity's name when it was not understood.
    pub kind: String,
    /// Lower-case fragment.
    pub reason: String,
}

/// The operation cannot be done; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OperationError {
    /// A face could not be scaled.
    #[error(transparent)]
    Scale(#[from] ScaleError),
    /// A face could not be deformed.
    #[error(transparent)]
    Deform(#[from] DeformError),
    /// Detail could not be carried over.
    #[error(transparent)]
    Transfer(#[from] TransferError),
    /// A feature could not be pasted.
    #[error(transparent)]
    Paste(#[from] PasteError),
    /// A face could not be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// Elements in the scope have no image under the motion that they would need.
    #[error("{} cannot follow: {}", count(.obstacles), list(.obstacles))]
    CannotFollow {
        /// The elements.
        obstacles: Vec<Obstacle>,
    },
    /// Faces next to the selected ones would be torn off.
    #[error(
        "faces next to the selected ones are not selected, and cannot follow: {} (next to {})",
        .neighbours.join(", "), .faces.join(", ")
    )]
    NeighboursOutside {
        /// Selected faces.
        faces: Vec<String>,
        /// Their neighbours.
        neighbours: Vec<String>,
    },
    /// What is to be held matches no loop.
    #[error("no inner loop to hold was found on {}", .faces.join(", "))]
    NothingToHold {
        /// Faces searched.
        faces: Vec<String>,
    },
    /// A loop to be held is no inner loop of a selected B-spline face.
    #[error("{entity} cannot be held: {reason}")]
    NotHoldable {
        /// Loop or edge.
        entity: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// What hangs on a hold comes back to the part that is scaled.
    #[error("what hangs on {held} is not separated from the part: {reason}")]
    HoldNotSeparated {
        /// The held loop or face.
        held: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// A face is held at one end and scaled at another.
    #[error("face {face} is held at {held} and scaled at {scaled}: it cannot follow both")]
    PartlyHeld {
        /// The face.
        face: String,
        /// A held loop or edge.
        held: String,
        /// An element that would scale.
        scaled: String,
    },
    /// The loops of a face cannot be laid out in its parameters.
    #[error("face {face}: its loops have no image in the parameters of its surface: {reason}")]
    NoParameterLoops {
        /// The face.
        face: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// A held loop lost its shape. This is our bug, caught before anything is written.
    #[error(
        "internal error: loop {held} of face {face} deviates from the motion imposed on it by {deviation:.3e} of its size"
    )]
    RigidityLost {
        /// The face.
        face: String,
        /// The loop.
        held: String,
        /// Deviation relative to the loop's extent.
        deviation: f64,
    },
}

impl OperationError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Scale(error) => error.code(),
            Self::Deform(error) => error.code(),
            Self::Transfer(error) => error.code(),
            Self::Paste(error) => error.code(),
            Self::Simplify(error) => error.code(),
            Self::CannotFollow { .. } => "scale.cannot-follow",
            Self::NeighboursOutside { .. } => "scale.neighbours-outside",
            Self::NothingToHold { .. } => "scale.nothing-to-hold",
            Self::NotHoldable { .. } => "scale.held-loop-not-inner",
            Self::HoldNotSeparated { .. } => "scale.hold-not-separated",
            Self::PartlyHeld { .. } => "scale.face-partly-held",
            Self::NoParameterLoops { .. } => "scale.no-parameter-loops",
            Self::RigidityLost { .. } => "internal.rigidity-lost",
        }
    }
}

fn count(obstacles: &[Obstacle]) -> String {
    match obstacles.len() {
        1 => "1 element".to_owned(),
        n => format!("{n} elements"),
    }
}

/// Obstacles that a message spells out; the rest is only counted.
const LISTED: usize = 200;

fn list(obstacles: &[Obstacle]) -> String {
    let mut parts: Vec<String> =
        obstacles.iter().take(LISTED).map(|o| format!("{} ({}): {}", o.entity, o.kind, o.reason)).collect();
    if obstacles.len() > LISTED {
        parts.push(format!("and {} more", obstacles.len() - LISTED));
    }
    parts.join("; ")
}
