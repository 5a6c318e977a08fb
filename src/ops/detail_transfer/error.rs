//! Why detail cannot be carried over.

use crate::geometry::bspline_wavelet::WaveletError;

/// The transfer cannot be done; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransferError {
    /// A curve has no form as a spline.
    #[error("{curve}: {reason}")]
    Curve {
        /// Name of the curve: `#12`.
        curve: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// A curve could not be approximated well enough.
    #[error("{curve}: the nearest spline misses it by {reached:.3e}, the tolerance is {tolerance:.3e}")]
    FitTolerance {
        /// Name of the curve.
        curve: String,
        /// Greatest distance reached.
        reached: f64,
        /// Distance wanted.
        tolerance: f64,
    },
    /// The source has no detail to give.
    #[error(
        "{curve}: {controls} control points of degree {degree} leave no knot to remove, so there is no detail"
    )]
    NoLevels {
        /// Name of the source.
        curve: String,
        /// Its control points.
        controls: usize,
        /// Its degree.
        degree: usize,
    },
    /// A level was asked for that the source does not have.
    #[error("level {level} was asked for; the source has {available}, counted from the finest, 1")]
    NoSuchLevel {
        /// Level asked for.
        level: usize,
        /// Levels that there are.
        available: usize,
    },
    /// Gains and levels differ in number.
    #[error("{gains} gains for {levels} levels")]
    GainCount {
        /// Gains given.
        gains: usize,
        /// Levels chosen.
        levels: usize,
    },
    /// The interval is empty or leaves the target.
    #[error("[{start}, {end}] is no part of the target")]
    BadInterval {
        /// First parameter.
        start: f64,
        /// Last parameter.
        end: f64,
    },
    /// Part of a curve cannot be changed with free ends.
    #[error("a part of the target needs ends that are held, in position at least")]
    PartialNeedsEnds,
    /// Free ends would open a closed curve.
    #[error("free ends would open the target, which is closed; hold them in position at least")]
    OpensSeam,
    /// A coarse curve without direction.
    #[error(
        "the coarse {curve} curve has no length or direction near the parameter {at}, so it has no frame"
    )]
    DegenerateBase {
        /// `source` or `target`.
        curve: &'static str,
        /// Where.
        at: f64,
    },
    /// A number is not finite.
    #[error("the result is not finite; gain or scale are too great")]
    NotFinite,
    /// Detail cannot be laid over a face.
    #[error("face {face}: {reason}")]
    Face {
        /// Name of the face: `#12`.
        face: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// The curve is an edge of faces.
    #[error(
        "{curve} is an edge of {faces}; moved alone it would leave its faces, and only free curves are changed"
    )]
    EdgeOfFaces {
        /// Name of the curve.
        curve: String,
        /// Names of the faces.
        faces: String,
    },
    /// The knots allow no wavelets.
    #[error("{curve}: {error}")]
    Wavelets {
        /// Name of the curve.
        curve: String,
        /// Why.
        error: WaveletError,
    },
}

impl TransferError {
    /// The stable code.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Curve { .. } => "detail.unusable-curve",
            Self::FitTolerance { .. } => "detail.fit-tolerance",
            Self::NoLevels { .. } => "detail.no-levels",
            Self::NoSuchLevel { .. } => "detail.no-such-level",
            Self::GainCount { .. } => "detail.gain-count",
            Self::BadInterval { .. } => "detail.bad-interval",
            Self::PartialNeedsEnds => "detail.partial-needs-ends",
            Self::OpensSeam => "detail.opens-seam",
            Self::DegenerateBase { .. } => "detail.degenerate-base",
            Self::NotFinite => "detail.not-finite",
            Self::Face { .. } => "detail.unusable-face",
            Self::EdgeOfFaces { .. } => "detail.edge-of-faces",
            Self::Wavelets { .. } => "detail.no-wavelets",
        }
    }
}
