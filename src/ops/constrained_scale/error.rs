//! Why a face cannot be scaled with features held. Each variant has a stable code and names the face.

use crate::math::Point3;

/// A face could not be scaled; nothing of it was changed.
///
/// `face` is the name that the caller gave the face, as a rule its origin in the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScaleError {
    /// A factor is not a positive number, or centre or axes are not finite or not orthonormal.
    #[error("{what} must be {expected}, found {found}")]
    BadScale {
        /// `factor`, `centre`, `axes`.
        what: &'static str,
        /// What is accepted.
        expected: &'static str,
        /// What was given.
        found: String,
    },
    /// The surface is torn: an interior knot occurs more than degree times.
    #[error(
        "face {face}: knot {knot} in {direction} occurs more than {degree} times, the surface is torn there"
    )]
    BadKnots {
        /// Face.
        face: String,
        /// `u` or `v`.
        direction: &'static str,
        /// Knot value.
        knot: f64,
        /// Degree, the greatest multiplicity accepted.
        degree: usize,
    },
    /// A number that is not finite was met.
    #[error("face {face}: {what} is not finite")]
    NonFiniteInput {
        /// Face.
        face: String,
        /// What it belongs to.
        what: &'static str,
    },
    /// Two pieces of one loop cross.
    #[error("face {face}: loop {held} crosses itself at parameters ({:.6}, {:.6})", at[0], at[1])]
    LoopSelfIntersects {
        /// Face.
        face: String,
        /// Loop, by the caller's index.
        held: usize,
        /// A point near the crossing.
        at: [f64; 2],
    },
    /// A loop leaves the parameter domain.
    #[error("face {face}: loop {held} leaves the parameter domain at ({:.6}, {:.6})", at[0], at[1])]
    LoopOutsideDomain {
        /// Face.
        face: String,
        /// Loop, by the caller's index.
        held: usize,
        /// The first point outside.
        at: [f64; 2],
    },
    /// A loop has fewer than three points or encloses nothing.
    #[error("face {face}: loop {held} is degenerate, it encloses no area")]
    LoopDegenerate {
        /// Face.
        face: String,
        /// Loop, by the caller's index.
        held: usize,
    },
    /// Two held loops cross, or one lies within the other.
    #[error("face {face}: held loops {first} and {second} overlap")]
    HeldLoopsOverlap {
        /// Face.
        face: String,
        /// First loop.
        first: usize,
        /// Second loop.
        second: usize,
    },
    /// What is held ends on planes that the scaling takes apart or turns against each other, and no wall in between can
    /// be made longer.
    #[error(
        "what is held on {} ends on planes that the scaling {}, and no straight wall between them can be made longer",
        .faces.join(", "), parted(*.apart)
    )]
    PlanesConflict {
        /// The planes.
        faces: Vec<String>,
        /// Greatest distance, in file units, of a held loop from the image of its plane; infinite when the planes turn
        /// against each other.
        apart: f64,
    },
    /// A held wall would turn inside out: its ends would pass each other.
    #[error("face {face}: a wall of length {before:.6} would get the length {after:.6}")]
    WallInverted {
        /// A face of the wall.
        face: String,
        /// Length before.
        before: f64,
        /// Length after, negative when the ends have passed each other.
        after: f64,
    },
    /// Nothing of the face is left to stretch.
    #[error("face {face}: the held loops cover the face, nothing is left to stretch")]
    HoldCoversFace {
        /// Face.
        face: String,
    },
    /// A held loop stays too near the border however the net is refined.
    #[error(
        "face {face}: held loop {held} is too close to the border: between them fewer than {needed} free \
         control points are left in a net of {points}, which may not exceed {limit}"
    )]
    FeatureTooCloseToBoundary {
        /// Face.
        face: String,
        /// Loop, by the caller's index.
        held: usize,
        /// Free control points that are needed.
        needed: usize,
        /// Size of the finest net tried.
        points: usize,
        /// Greatest size accepted.
        limit: usize,
    },
    /// The input net is greater than the limit already.
    #[error("face {face}: its net of {points} control points exceeds the limit of {limit}")]
    NetTooLarge {
        /// Face.
        face: String,
        /// Size of the input net.
        points: usize,
        /// Greatest size accepted.
        limit: usize,
    },
    /// The stretched part would fold over itself.
    #[error(
        "face {face}: the surface folds over near ({:.4}, {:.4}, {:.4}): the smallest ratio of areas is {ratio:.3}",
        near.x, near.y, near.z
    )]
    FoldOver {
        /// Face.
        face: String,
        /// Smallest ratio of the new oriented area element to the plainly scaled one.
        ratio: f64,
        /// Where, in the plainly scaled part.
        near: Point3<f64>,
    },
    /// Two skins that share a feature lose the material between them.
    #[error(
        "faces {} and {} come too close near ({:.4}, {:.4}, {:.4}): what is between them is {ratio:.3} of the lesser \
         of the thickness before and that of the plain scaling, at least 0.8 is needed",
        faces[0], faces[1], near.x, near.y, near.z
    )]
    SkinsTooClose {
        /// The faces.
        faces: [String; 2],
        /// Thickness now over the lesser expected one; negative where they cross.
        ratio: f64,
        /// Where, on the first face as it would be.
        near: Point3<f64>,
    },
    /// The derivatives of the surface are parallel where a direction is needed.
    #[error("face {face}: the parametrisation is singular at ({:.6}, {:.6})", at[0], at[1])]
    SingularParametrisation {
        /// Face.
        face: String,
        /// Parameters.
        at: [f64; 2],
    },
    /// The linear system has no unique solution.
    #[error("face {face}: the system of {unknowns} equations is singular")]
    SingularSystem {
        /// Face.
        face: String,
        /// Count of unknowns.
        unknowns: usize,
    },
}

impl ScaleError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::BadScale { .. } => "scale.bad-scale",
            Self::BadKnots { .. } => "scale.bad-knots",
            Self::NonFiniteInput { .. } => "scale.non-finite-input",
            Self::LoopSelfIntersects { .. } => "scale.loop-self-intersects",
            Self::LoopOutsideDomain { .. } => "scale.loop-outside-domain",
            Self::LoopDegenerate { .. } => "scale.loop-degenerate",
            Self::HeldLoopsOverlap { .. } => "scale.held-loops-overlap",
            Self::PlanesConflict { .. } => "scale.hold-conflict-planes",
            Self::WallInverted { .. } => "scale.wall-inverted",
            Self::HoldCoversFace { .. } => "scale.hold-covers-face",
            Self::FeatureTooCloseToBoundary { .. } => "scale.feature-too-close-to-boundary",
            Self::NetTooLarge { .. } => "scale.net-too-large",
            Self::FoldOver { .. } => "scale.fold-over",
            Self::SkinsTooClose { .. } => "scale.skins-too-close",
            Self::SingularParametrisation { .. } => "scale.singular-parametrisation",
            Self::SingularSystem { .. } => "scale.singular-system",
        }
    }
}

fn parted(apart: f64) -> String {
    if apart.is_finite() {
        format!("moves apart by {apart:.6}")
    } else {
        "turns against each other".to_owned()
    }
}
