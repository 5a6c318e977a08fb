//! Why a feature cannot be pasted. Each variant has a stable code.

use crate::geometry::nurbs::KnotVectorError;

/// A feature could not be pasted; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PasteError {
    /// A setting is out of its range.
    #[error("{what} must be {expected}, found {found}")]
    BadSetting {
        /// `scale`, `angle`, `tolerance`, `anchor`.
        what: &'static str,
        /// What is accepted.
        expected: &'static str,
        /// What was given.
        found: String,
    },
    /// Two settings exclude each other.
    #[error("method `{method}` {reason}")]
    MethodCannot {
        /// The method.
        method: &'static str,
        /// Lower-case fragment.
        reason: &'static str,
    },
    /// A surface is torn: an interior knot occurs more than degree times.
    #[error("{side}: knot {knot} in {direction} occurs more than {degree} times, the surface is torn there")]
    BadKnots {
        /// `source`, `target`.
        side: &'static str,
        /// `u`, `v`.
        direction: &'static str,
        /// Knot value.
        knot: f64,
        /// Degree.
        degree: usize,
    },
    /// The knots of source and target cannot be brought together.
    #[error("the knots of source and target do not go together: {0}")]
    Knots(#[from] KnotVectorError),
    /// The contour has fewer than three points or encloses nothing.
    #[error("the contour is degenerate: it has fewer than three distinct points, or encloses no area")]
    ContourDegenerate,
    /// A coordinate of the contour is not finite.
    #[error("a coordinate of the contour is not finite")]
    ContourNotFinite,
    /// The contour's last point is not its first.
    #[error("the contour is open: its ends are {gap} apart, more than {allowed}")]
    ContourOpen {
        /// Distance of the ends.
        gap: f64,
        /// Distance that counts as closed.
        allowed: f64,
    },
    /// The contour crosses itself.
    #[error("the contour crosses itself near parameters ({:.6}, {:.6}) of the source", at[0], at[1])]
    ContourCrosses {
        /// Parameters of the source.
        at: [f64; 2],
    },
    /// The contour leaves the source face.
    #[error("the contour leaves the source face at parameters ({:.6}, {:.6})", at[0], at[1])]
    ContourOutside {
        /// Parameters of the source.
        at: [f64; 2],
    },
    /// No point of the contour lies on the source face.
    #[error("the contour lies off the source face: none of its points is on the face")]
    ContourOffFace,
    /// The contour goes round the whole source face.
    #[error("the contour is larger than the source face: it goes round the whole face")]
    ContourLargerThanFace,
    /// The contour meets the border of the source face.
    #[error(
        "the contour touches the border of the source face at parameters ({:.6}, {:.6}); expected one inside, or \
         `loop = \"outer\"` for all that the border holds", at[0], at[1]
    )]
    ContourTouchesBorder {
        /// Parameters of the source.
        at: [f64; 2],
    },
    /// A point of the contour has no image on the source along the normal of its plane.
    #[error("point {point} of the contour does not meet the source surface along the normal of its plane")]
    ContourProjectionFailed {
        /// Index of the point.
        point: usize,
    },
    /// Neighbouring points of the contour land on different sheets of the source.
    #[error(
        "the contour jumps between sheets of the source surface after point {point}: a step of {times:.1} times \
         the median step"
    )]
    ContourJumpsSheet {
        /// Index of the point before the jump.
        point: usize,
        /// Length of the step over the median step.
        times: f64,
    },
    /// The contour holds too few control points, however the source is refined.
    #[error(
        "the feature's region is too small, or too near to the border: {rows} x {columns} control points act \
         inside it alone, and {needed} x {needed} are needed"
    )]
    RegionTooSmall {
        /// Rows found.
        rows: usize,
        /// Columns found.
        columns: usize,
        /// Rows and columns needed.
        needed: usize,
    },
    /// The feature does not lie within the target.
    #[error(
        "the feature leaves the target surface along {direction}: it would reach from {:.6} to {:.6}, and the \
         surface from {:.6} to {:.6}",
        reach.0, reach.1, domain.0, domain.1
    )]
    OutsideTarget {
        /// `u`, `v`.
        direction: &'static str,
        /// Parameters of the target that the feature needs.
        reach: (f64, f64),
        /// Parameters that the target has.
        domain: (f64, f64),
    },
    /// A blended weight is zero or negative.
    #[error("a weight of the result would be {weight:.3e}; the weights of source and target differ too much")]
    WeightNotPositive {
        /// The weight.
        weight: f64,
    },
    /// The derivatives of a surface are parallel where a direction is needed.
    #[error("{side}: the parametrisation is singular at ({:.6}, {:.6})", at[0], at[1])]
    SingularParametrisation {
        /// `source`, `target`.
        side: &'static str,
        /// Parameters.
        at: [f64; 2],
    },
    /// The fitted field is too far from the feature at the finest net tried.
    #[error(
        "the fit deviates by {error:.3e} at a net of {points} control points, and {tolerance:.3e} is asked for"
    )]
    FitToleranceNotReached {
        /// Greatest deviation.
        error: f64,
        /// Deviation asked for.
        tolerance: f64,
        /// Control points of the finest net.
        points: usize,
    },
    /// The result would have more control points than the limit.
    #[error("the net would have {points} control points, and the limit is {limit}")]
    NetTooLarge {
        /// Control points.
        points: usize,
        /// Limit.
        limit: usize,
    },
    /// A linear system has no unique solution.
    #[error("the system of {unknowns} equations is singular")]
    SingularSystem {
        /// Unknowns.
        unknowns: usize,
    },
    /// The face's surface is of a kind that cannot give or take a feature.
    #[error("the {side} face {face} lies on a {kind}; {expected}")]
    SurfaceKind {
        /// `source`, `target`.
        side: &'static str,
        /// Name of the face.
        face: String,
        /// Kind of its surface.
        kind: String,
        /// What would do.
        expected: &'static str,
    },
    /// The source face has no such loop.
    #[error("the source face {face} has no {wanted}")]
    NoSuchLoop {
        /// Name of the face.
        face: String,
        /// What was asked for.
        wanted: String,
    },
    /// A place is not on the target face.
    #[error(
        "place ({:.6}, {:.6}, {:.6}) is not on the target face {face}: {reason}", place[0], place[1], place[2]
    )]
    PlaceOffFace {
        /// Name of the face.
        face: String,
        /// The place.
        place: [f64; 3],
        /// Lower-case fragment.
        reason: String,
    },
    /// The features of two places would overlap.
    #[error("places {first} and {second} are so near that their features overlap")]
    PlacesOverlap {
        /// Index of a place, from 0.
        first: usize,
        /// Index of the other.
        second: usize,
    },
    /// A carried hole does not lie within the target, or crosses its seam.
    #[error("a hole of the feature leaves the target surface, or crosses its seam")]
    HoleOutsideTarget,
    /// A hole would open a closed shell.
    #[error(
        "a hole of the feature would open the solid that the target face {face} belongs to; expected \
         `holes = \"close\"`, or a face of a sheet"
    )]
    HoleOpensSolid {
        /// Name of the face.
        face: String,
    },
    /// The pasted region meets a loop of the target face.
    #[error(
        "the pasted region meets loop {held} of the target face: move the feature, or set `loops = \"protect\"`"
    )]
    TargetLoopInRegion {
        /// Name of the loop.
        held: String,
    },
}

impl PasteError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::BadSetting { .. } => "paste.bad-setting",
            Self::MethodCannot { .. } => "paste.method-cannot",
            Self::BadKnots { .. } => "paste.bad-knots",
            Self::Knots(_) => "paste.knots-do-not-match",
            Self::ContourDegenerate => "paste.contour-degenerate",
            Self::ContourNotFinite => "paste.contour-not-finite",
            Self::ContourOpen { .. } => "paste.contour-open",
            Self::ContourCrosses { .. } => "paste.contour-crosses-itself",
            Self::ContourOutside { .. } => "paste.contour-outside-source",
            Self::ContourOffFace => "paste.contour-off-face",
            Self::ContourLargerThanFace => "paste.contour-larger-than-face",
            Self::ContourTouchesBorder { .. } => "paste.contour-touches-border",
            Self::ContourProjectionFailed { .. } => "paste.contour-projection-failed",
            Self::ContourJumpsSheet { .. } => "paste.contour-jumps-sheet",
            Self::RegionTooSmall { .. } => "paste.region-too-small",
            Self::OutsideTarget { .. } => "paste.outside-target",
            Self::WeightNotPositive { .. } => "paste.weight-not-positive",
            Self::SingularParametrisation { .. } => "paste.singular-parametrisation",
            Self::FitToleranceNotReached { .. } => "paste.fit-tolerance-not-reached",
            Self::NetTooLarge { .. } => "paste.net-too-large",
            Self::SingularSystem { .. } => "paste.singular-system",
            Self::SurfaceKind { .. } => "paste.surface-kind",
            Self::NoSuchLoop { .. } => "paste.no-such-loop",
            Self::PlaceOffFace { .. } => "paste.place-off-face",
            Self::PlacesOverlap { .. } => "paste.places-overlap",
            Self::HoleOutsideTarget => "paste.hole-outside-target",
            Self::HoleOpensSolid { .. } => "paste.hole-opens-solid",
            Self::TargetLoopInRegion { .. } => "paste.target-loop-in-region",
        }
    }
}
