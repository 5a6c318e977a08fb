//! Why a feature cannot be reconstructed. Each variant has a stable code.

use crate::math::sparse::SingularSystem;
use crate::ops::force_density::ForceDensityError;

/// A feature could not be reconstructed; nothing was changed. Lengths are in file units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReconstructionError {
    /// Too few points.
    #[error("the {which} cloud has {found} points, at least {least} are needed")]
    CloudTooSmall {
        /// `objective`, `blend`.
        which: &'static str,
        /// Points found.
        found: usize,
        /// Points needed.
        least: usize,
    },
    /// Points in one place or on a line.
    #[error("the {which} cloud lies in one place or along a line: no surface goes through it")]
    CloudDegenerate {
        /// `objective`, `blend`.
        which: &'static str,
    },
    /// The blend's points do not go round the objective's as a band.
    #[error(
        "no guide line was found: the blend's points scatter {scatter:.4} about it, a band of their area would be \
         {width:.4} wide; the feature is not seen from its middle all round, or its points are mixed up: give a guide"
    )]
    GuideNotStar {
        /// Root mean square distance from the line.
        scatter: f64,
        /// Width of a band of the same area and length.
        width: f64,
    },
    /// The limiting line is lost over a stretch.
    #[error(
        "the limiting line is lost: {failed} of {samples} slices have no crossing with the primary, the longest gap from \
         ({}, {}, {}) on", near[0], near[1], near[2]
    )]
    LimitingLineLost {
        /// Slices without a crossing.
        failed: usize,
        /// All slices.
        samples: usize,
        /// Where the longest gap begins.
        near: [f64; 3],
    },
    /// The surface under the objective's points hardly leaves the primary.
    #[error(
        "the feature is tangent to the primary: the line where they meet is uncertain by {deviation:.4}, with points \
         {spacing:.4} apart"
    )]
    TangentFeature {
        /// Median deviation of the line.
        deviation: f64,
        /// Distance of neighbouring points.
        spacing: f64,
    },
    /// A line has no direction somewhere.
    #[error("a line stands still near ({}, {}, {})", near[0], near[1], near[2])]
    LineSingular {
        /// Where.
        near: [f64; 3],
    },
    /// Too few slices of the blend have a circle.
    #[error("no radius was found: {found} slices of the blend have a circle, at least {least} are needed")]
    RadiusFailed {
        /// Slices with a circle.
        found: usize,
        /// Slices needed.
        least: usize,
    },
    /// The ball does not rest between the surfaces.
    #[error("a ball of radius {radius:.4} does not fit near ({}, {}, {}): {reason}", near[0], near[1], near[2])]
    BallDoesNotFit {
        /// Its radius.
        radius: f64,
        /// The station of the limiting line.
        near: [f64; 3],
        /// Lower-case fragment.
        reason: &'static str,
    },
    /// The blend turns by half a turn or nearly.
    #[error("the blend's arc near ({}, {}, {}) is half a turn or nearly: the surfaces lie back to back", near[0], near[1], near[2])]
    ArcTooWide {
        /// Centre of the ball.
        near: [f64; 3],
    },
    /// The blend does not come near enough to the surfaces.
    #[error(
        "a blend of {sections} sections misses the surfaces by {deviation:.3e} where {tolerance:.3e} is allowed, and          {angle:.3} degrees; the secondary is not smooth"
    )]
    BlendNotFair {
        /// Sections.
        sections: usize,
        /// Greatest distance.
        deviation: f64,
        /// Greatest distance allowed.
        tolerance: f64,
        /// Greatest angle in degrees.
        angle: f64,
    },
    /// The primary cannot be trimmed.
    #[error("the primary cannot be trimmed near ({}, {}, {}): {reason}", near[0], near[1], near[2])]
    Trim {
        /// Where.
        near: [f64; 3],
        /// Lower-case fragment.
        reason: String,
    },
    /// What stands inside the feature's lines is not an old feature.
    #[error(
        "face {face} hangs on a bound of the primary inside the feature's lines and touches the primary outside of them, too:          it is no feature that could be replaced"
    )]
    RegionGoesOn {
        /// The face.
        face: String,
    },
    /// Two features of a repetition share a point of the primary.
    #[error("features {first} and {second} of the repetition overlap")]
    FeaturesOverlap {
        /// Number of one, from 1.
        first: usize,
        /// Number of the other.
        second: usize,
    },
    /// Where points of the secondary lie over the primary is not defined.
    #[error(
        "{share:.0} % of the objective's points are so far from the primary, against its radius of curvature, that no point of \
         it is clearly the nearest"
    )]
    HeightExceedsCurvature {
        /// Per cent of the points.
        share: f64,
    },
    /// No line through the feature has points enough.
    #[error("no character line was found: none has {least} points of the objective beside it")]
    NoCharacterLine {
        /// Points needed beside a line.
        least: usize,
    },
    /// Two lines cross more than once.
    #[error("{} and {} cross {times} times; lines of a feature cross once", names[0], names[1])]
    LinesCross {
        /// The lines.
        names: [String; 2],
        /// How often.
        times: usize,
    },
    /// The secondary surface does not come near enough to its points.
    #[error(
        "the secondary surface stays {:.4} from the objective's points in the mean and {:.4} from the farthest that count, \
         where {:.4} and {:.4} are allowed", found[0], found[1], limits[0], limits[1]
    )]
    SecondaryDeviates {
        /// Mean and upper distance.
        found: [f64; 2],
        /// What was allowed.
        limits: [f64; 2],
    },
    /// The secondary surface cannot be deformed.
    #[error(transparent)]
    Deform(#[from] ForceDensityError),
    /// A system of equations has no solution.
    #[error(transparent)]
    Singular(#[from] SingularSystem),
}

impl ReconstructionError {
    /// The stable code.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::CloudTooSmall { .. } => "reconstruct.cloud-too-small",
            Self::CloudDegenerate { .. } => "reconstruct.cloud-degenerate",
            Self::GuideNotStar { .. } => "reconstruct.guide-not-star",
            Self::LimitingLineLost { .. } => "reconstruct.limiting-line-lost",
            Self::TangentFeature { .. } => "reconstruct.tangent-feature",
            Self::LineSingular { .. } => "reconstruct.line-singular",
            Self::RadiusFailed { .. } => "reconstruct.radius-failed",
            Self::BallDoesNotFit { .. } => "reconstruct.ball-does-not-fit",
            Self::ArcTooWide { .. } => "reconstruct.arc-too-wide",
            Self::BlendNotFair { .. } => "reconstruct.blend-not-fair",
            Self::Trim { .. } => "reconstruct.trim",
            Self::RegionGoesOn { .. } => "reconstruct.region-goes-on",
            Self::FeaturesOverlap { .. } => "reconstruct.features-overlap",
            Self::HeightExceedsCurvature { .. } => "reconstruct.height-exceeds-curvature",
            Self::NoCharacterLine { .. } => "reconstruct.no-character-line",
            Self::LinesCross { .. } => "reconstruct.lines-cross",
            Self::SecondaryDeviates { .. } => "reconstruct.secondary-deviates",
            Self::Deform(error) => error.code(),
            Self::Singular(_) => "reconstruct.singular",
        }
    }
}
