//! Why a face cannot be deformed. Each variant has a stable code.

use crate::math::Point3;
use crate::ops::force_density::ForceDensityError;

/// A face could not be deformed; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The face lies on no B-spline surface.
    #[error("the face {face} lies on a {kind}; only a B-spline surface has a net to deform")]
    SurfaceKind {
        /// Name of the face.
        face: String,
        /// Kind of its surface.
        kind: String,
    },
    /// No line, or one without a point.
    #[error("line {line} has no point")]
    EmptyLine {
        /// Number of the line, from 1.
        line: usize,
    },
    /// A line that is pulled lies beside the face.
    #[error(
        "line {line}: at ({:.6}, {:.6}, {:.6}) it lies {reason} of face {face}", .at.x, .at.y, .at.z
    )]
    LineOffFace {
        /// Number of the line, from 1.
        line: usize,
        /// Where.
        at: Point3<f64>,
        /// `0.5 beside the surface`, `inside loop #12`.
        reason: String,
        /// Name of the face.
        face: String,
    },
    /// Where a point is pulled from is not defined: the target is as far as the surface's radius of curvature.
    #[error(
        "line {line}: {share:.0} % of its points are so far from face {face}, against its radius of curvature, that no point \
         of the face is clearly the nearest; name the line on the face with `from`"
    )]
    HeightExceedsCurvature {
        /// Number of the line, from 1.
        line: usize,
        /// Per cent of its points.
        share: f64,
        /// Name of the face.
        face: String,
    },
    /// The line pulls where the face is held.
    #[error(
        "line {line} pulls the face by {distance:.6} at ({:.6}, {:.6}, {:.6}), where it is held by its border or a loop",
        .at.x, .at.y, .at.z
    )]
    PullsHeld {
        /// Number of the line, from 1.
        line: usize,
        /// Where it pulls to.
        at: Point3<f64>,
        /// By how much.
        distance: f64,
    },
    /// The surface does not come near enough to the lines.
    #[error(
        "the deformed surface stays {reached:.3e} from line {line} at ({:.6}, {:.6}, {:.6}), the tolerance is {tolerance:.3e} \
         (net of {rows} x {columns})", .at.x, .at.y, .at.z
    )]
    Tolerance {
        /// Number of the line, from 1.
        line: usize,
        /// Where.
        at: Point3<f64>,
        /// Distance reached.
        reached: f64,
        /// Distance wanted.
        tolerance: f64,
        /// Rows of the finest net that was tried.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// The surface would turn over.
    #[error("the deformed surface folds over at ({:.6}, {:.6}, {:.6})", .at.x, .at.y, .at.z)]
    Folded {
        /// Where.
        at: Point3<f64>,
    },
    /// The network has no solution.
    #[error(transparent)]
    Network(#[from] ForceDensityError),
}

impl DeformError {
    /// Whether more control points may help.
    pub(super) fn may_go_on_a_finer_net(&self) -> bool {
        use ForceDensityError::{Conflict, NothingFree};
        matches!(self, Self::Folded { .. } | Self::Network(Conflict { .. } | NothingFree))
    }

    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::SurfaceKind { .. } => "deform.surface-kind",
            Self::EmptyLine { .. } => "deform.empty-line",
            Self::LineOffFace { .. } => "deform.line-off-face",
            Self::HeightExceedsCurvature { .. } => "deform.height-exceeds-curvature",
            Self::PullsHeld { .. } => "deform.pulls-held",
            Self::Tolerance { .. } => "deform.tolerance",
            Self::Folded { .. } => "deform.folded",
            Self::Network(error) => error.code(),
        }
    }
}
