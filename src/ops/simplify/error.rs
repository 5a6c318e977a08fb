//! Why a face cannot be simplified. Each variant has a stable code.

/// A face could not be simplified; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimplifyError {
    /// The face lies on no B-spline surface.
    #[error("the face {face} lies on a {kind}; only a B-spline surface has knots to remove")]
    SurfaceKind {
        /// Name of the face.
        face: String,
        /// Kind of its surface.
        kind: String,
    },
    /// The tolerance is not a positive number.
    #[error("tolerance must be a positive length, found {found}")]
    BadTolerance {
        /// What was given.
        found: f64,
    },
    /// The bound that was kept step by step does not hold for the whole. This is our bug, caught before anything is written.
    #[error(
        "internal error: the simplified surface deviates by up to {bound:.3e}, and {tolerance:.3e} was kept to"
    )]
    BoundBroken {
        /// Certified distance.
        bound: f64,
        /// Tolerance.
        tolerance: f64,
    },
}

impl SimplifyError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::SurfaceKind { .. } => "simplify.surface-kind",
            Self::BadTolerance { .. } => "simplify.bad-tolerance",
            Self::BoundBroken { .. } => "internal.bound-broken",
        }
    }
}
