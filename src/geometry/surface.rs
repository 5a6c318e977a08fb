//! Surfaces in space.
//!
//! Each is parametrised as ISO 10303-42 says, with angles in radians.

use super::curve::Curve;
use super::nurbs::NurbsSurface;
use crate::math::{Frame, Vector3};

/// A surface of ISO 10303-42 clause 4.5.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// `origin + u x + v y`.
    Plane(Frame),
    /// `origin + radius (cos u · x + sin u · y) + v z`.
    Cylinder {
        /// Axis placement.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
    },
    /// `origin + (radius + v tan semi_angle)(cos u · x + sin u · y) + v z`.
    Cone {
        /// Axis placement.
        frame: Frame,
        /// Radius in the placement's plane; zero when the apex is the origin.
        radius: f64,
        /// Half opening angle in radians, within (-π/2, π/2) and not zero.
        semi_angle: f64,
    },
    /// `origin + radius cos v (cos u · x + sin u · y) + radius sin v · z`.
    Sphere {
        /// Axis placement.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
    },
    /// `origin + (major_radius + minor_radius cos v)(cos u · x + sin u · y) + minor_radius sin v · z`.
    Torus {
        /// Axis placement.
        frame: Frame,
        /// Distance of the tube's centre from the axis, positive.
        major_radius: f64,
        /// Radius of the tube, positive.
        minor_radius: f64,
    },
    /// `curve(u) + v · direction`.
    LinearExtrusion {
        /// Swept curve.
        curve: Box<Curve>,
        /// Derivative by `v`, with its magnitude.
        direction: Vector3<f64>,
    },
    /// `curve(v)` turned by the angle `u` about the axis through `frame.origin` along `frame.z`.
    Revolution {
        /// Turned curve.
        curve: Box<Curve>,
        /// Axis; its first axis is arbitrary.
        frame: Frame,
    },
    /// A B-spline surface in any of its forms.
    Nurbs(NurbsSurface),
    /// `basis(u, v) + distance · normal(u, v)`.
    Offset {
        /// The surface that is left by the distance.
        basis: Box<Surface>,
        /// Signed distance along the normal `du × dv`.
        distance: f64,
    },
    /// A parameter rectangle of a surface. Where a sense agrees, the parameter is the basis surface's; else
    /// its negative.
    Trimmed {
        /// The surface that is trimmed.
        basis: Box<Surface>,
        /// Least and greatest `u` on the basis.
        u: (f64, f64),
        /// Least and greatest `v` on the basis.
        v: (f64, f64),
        /// Whether `u` and `v` run as the basis's do.
        forward: [bool; 2],
    },
    /// A surface that the standard bounds by curves on it. As the surface of a face it is its basis: the
    /// face has bounds of its own.
    CurveBounded {
        /// The surface.
        basis: Box<Surface>,
    },
    /// A grid of patches.
    Composite(PatchGrid),
}

/// A patch of a composite surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// The surface, of finite domain.
    pub surface: Surface,
    /// Whether `u` and `v` of the composite run as those of the patch.
    pub forward: [bool; 2],
}

/// Patches in rows along `v` and columns along `u`: ISO 10303-42 `rectangular_composite_surface`. Each spans a
/// unit square of the parameters, `(i, j)` that from `(i, j)` to `(i + 1, j + 1)`.
///
/// INVARIANT: one patch at least, all domains finite, `patches.len()` a multiple of `rows`.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchGrid {
    patches: Vec<Patch>,
    rows: usize,
}

impl PatchGrid {
    /// Takes patches, those of one `u` together; `rows` of them along `v`. `None` when there is none, they
    /// are no full grid, or the domain of one is not finite.
    #[must_use]
    pub fn new(patches: Vec<Patch>, rows: usize) -> Option<Self> {
        let finite = |patch: &Patch| {
            let ((u0, u1), (v0, v1)) = patch.surface.domain();
            [u0, u1, v0, v1].iter().all(|x| x.is_finite()) && u1 > u0 && v1 > v0
        };
        let full = rows > 0 && !patches.is_empty() && patches.len().is_multiple_of(rows);
        (full && patches.iter().all(finite)).then_some(Self { patches, rows })
    }

    /// The patches, those of one `u` together.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// Count of patches along `u` and along `v`.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.patches.len() / self.rows, self.rows)
    }

    /// The same grid of other surfaces.
    ///
    /// # Errors
    /// What `change` fails with.
    pub fn try_map<E>(&self, change: impl Fn(&Surface) -> Result<Surface, E>) -> Result<Self, E> {
        let patches = self
            .patches
            .iter()
            .map(|patch| Ok(Patch { surface: change(&patch.surface)?, forward: patch.forward }));
        Ok(Self { patches: patches.collect::<Result<_, E>>()?, rows: self.rows })
    }
}

impl Surface {
    /// The selector and report word for this kind: `plane`, `cylinder`, …, `b_spline`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::LinearExtrusion { .. } => "linear_extrusion",
            Self::Revolution { .. } => "revolution",
            Self::Nurbs(_) => "b_spline",
            Self::Offset { .. } => "offset",
            Self::Trimmed { .. } => "rectangular_trimmed",
            Self::CurveBounded { .. } => "curve_bounded",
            Self::Composite(_) => "rectangular_composite",
        }
    }
}
