//! Why a network has no deformed state.

use crate::math::Point3;

/// A surface could not be deformed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForceDensityError {
    /// The state is not determined: too few constraints for what is free, or numbers that vanish.
    #[error(
        "the network is singular: its {free} free control points are not held by the constraints and its supports"
    )]
    Singular {
        /// Count of free control points.
        free: usize,
    },
    /// No control point may move.
    #[error("no control point of the surface is free to move")]
    NothingFree,
    /// A constraint cannot be met while the others are.
    #[error(
        "constraints contradict each other: at ({:.6}, {:.6}, {:.6}) the surface stays {residual:.3e} from where it should \
         be ({misses} of {count} are missed by more than {tolerance:.3e})",
        .at.x, .at.y, .at.z
    )]
    Conflict {
        /// Where the constraint that is missed most wants the surface.
        at: Point3<f64>,
        /// By how much it is missed.
        residual: f64,
        /// Count of constraints that are missed.
        misses: usize,
        /// Count of constraints.
        count: usize,
        /// What was allowed.
        tolerance: f64,
    },
    /// A weight, a strength or a density that is no positive number.
    #[error("{what} must be a positive number, found {found}")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// What was given.
        found: f64,
    },
}

impl ForceDensityError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Singular { .. } => "deform.singular",
            Self::NothingFree => "deform.nothing-free",
            Self::Conflict { .. } => "deform.constraint-conflict",
            Self::NotPositive { .. } => "deform.not-positive",
        }
    }
}
