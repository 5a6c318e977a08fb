//! What to scale by, and how: the options of the operation, checked once.

use super::ScaleError;
use crate::math::{Affine, Matrix3, Point3, Vector3};

/// Rows of the natural border that stay exactly as plainly scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Continuity {
    /// One row: the border.
    Position,
    /// Two rows: the border and its tangent planes.
    #[default]
    Tangent,
    /// Three rows: curvature as well.
    Curvature,
}

impl Continuity {
    /// Rows and columns kept at each side of the net.
    #[must_use]
    pub fn rows(self) -> usize {
        match self {
            Self::Position => 1,
            Self::Tangent => 2,
            Self::Curvature => 3,
        }
    }
}

/// What the stretched part is compared with, and by which energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Energy {
    /// Thin plate against the scaled surface re-parametrised by the slip of the held features.
    #[default]
    Slide,
    /// The published formulation: equal parameters, unit square, weights (16) to (20) and the cross term. It is
    /// kept for comparison: it depends on origin, unit and direction of the parameters.
    Published,
}

/// How a held feature may move to lower the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Freedom {
    /// Along the feature's axis (equation 5 of the published method).
    #[default]
    Normal,
    /// In any direction (equation 6).
    Free,
}

/// What of a feature is held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Hold {
    /// Shape and size; it turns with the surface and moves with the scaled part.
    #[default]
    Rigid,
    /// Shape, size and orientation.
    Translated,
    /// Shape, size, orientation and place: its pivot goes to the given point, or stays.
    Pinned(Option<Point3<f64>>),
    /// Size along some of the scaling axes; along the others it scales.
    Axes([bool; 3]),
}

/// Options of one constrained scaling. Lengths and points are in file units.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Factors along the three axes, positive.
    pub factors: [f64; 3],
    /// Fixed point of the scaling.
    pub center: Point3<f64>,
    /// Orthonormal axes as columns.
    pub axes: Matrix3<f64>,
    /// What stays at the natural border.
    pub continuity: Continuity,
    /// Energy and reference.
    pub energy: Energy,
    /// Freedom of the held features.
    pub freedom: Freedom,
    /// Greatest count of control points of one face.
    pub max_control_points: usize,
}

impl Scaling {
    /// Default for [`max_control_points`](Self::max_control_points): what one core solves in a second or two.
    pub const MAX_CONTROL_POINTS: usize = 40_000;

    /// The given factors about the origin along the coordinate axes, all else default.
    #[must_use]
    pub fn new(factors: [f64; 3]) -> Self {
        Self {
            factors,
            center: Point3::origin(),
            axes: Matrix3::identity(),
            continuity: Continuity::default(),
            energy: Energy::default(),
            freedom: Freedom::default(),
            max_control_points: Self::MAX_CONTROL_POINTS,
        }
    }

    /// The plain scaling, once factors, centre and axes are checked. Factors of exactly 1 give exactly the identity.
    ///
    /// # Errors
    /// [`ScaleError::BadScale`].
    pub fn affine(&self) -> Result<Affine, ScaleError> {
        if let Some(factor) = self.factors.iter().find(|f| !(f.is_finite() && **f > 0.0)) {
            let found = factor.to_string();
            return Err(ScaleError::BadScale { what: "factor", expected: "a positive number", found });
        }
        if !self.center.iter().all(|c| c.is_finite()) {
            let found = format!("{:?}", self.center.coords.as_slice());
            return Err(ScaleError::BadScale { what: "centre", expected: "three finite numbers", found });
        }
        let product = self.axes.transpose() * self.axes;
        let off = (product - Matrix3::identity()).abs().max();
        if off.is_nan() || off > ORTHONORMAL {
            let found = format!("axes that are off by {off:.3e}");
            return Err(ScaleError::BadScale { what: "axes", expected: "orthonormal", found });
        }
        let linear = self.linear_by(self.factors);
        let identity = linear == Matrix3::identity();
        Ok(if identity { Affine::identity() } else { Affine::about(&self.center, linear) })
    }

    /// The linear map by other factors along the same axes.
    pub(super) fn linear_by(&self, factors: [f64; 3]) -> Matrix3<f64> {
        let diagonal = Matrix3::from_diagonal(&Vector3::from(factors));
        // Turned axes would leave rounding in a map that is uniform.
        let uniform = factors.iter().all(|f| f.to_bits() == factors[0].to_bits());
        if uniform || self.axes == Matrix3::identity() {
            diagonal
        } else {
            self.axes * diagonal * self.axes.transpose()
        }
    }
}

/// Greatest deviation of `AᵀA` from the identity: axes typed with nine decimals pass.
const ORTHONORMAL: f64 = 1e-8;
