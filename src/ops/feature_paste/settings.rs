//! What may be chosen about a paste, and what the numeric core is given.

use super::PasteError;
use crate::geometry::nurbs::NurbsSurface;
use crate::ops::net::Mask;

/// How the feature gets onto the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Displacement of control points from a smooth base, turned with the surface.
    Displacement,
    /// Gradients of the net, solved with the target's ring as border: the published method.
    Poisson,
    /// Laplacians of the net, solved with two rings of the target as border.
    Biharmonic,
    /// The displacement field fitted by least squares: any angle, mirror or parametrisation.
    Fit,
}

impl Method {
    /// The word of the job file.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Poisson => "poisson",
            Self::Biharmonic => "biharmonic",
            Self::Fit => "fit",
        }
    }
}

/// Which control points count as the feature's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rule {
    /// Those that act inside the contour's cells alone.
    #[default]
    Support,
    /// The published union over rows and columns, which reaches beyond the contour's cells.
    RowsAndColumns,
}

/// How gradients turn from the source to the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Turn {
    /// Not at all.
    None,
    /// By the least rotation that takes normal to normal.
    Normal,
    /// By the frames of tangent and normal.
    #[default]
    Frame,
}

/// Weights of a Laplacian over the net.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeWeights {
    /// All 1, as published.
    Uniform,
    /// Of finite volumes between Greville abscissae: exact for linear functions on uneven knots.
    #[default]
    FiniteVolume,
}

/// What becomes of detail that the target already has in the region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Existing {
    /// The feature is added to it.
    #[default]
    Keep,
    /// It gives way to the feature.
    Replace,
    /// At each place the stronger of the two stays (mixed gradients).
    Stronger,
}

/// Whether the ends of the source's domain become knots of the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// No: as published. The outermost control points of a feature that fills its source then act beyond it.
    Open,
    /// Yes, where they fall inside the target: nothing acts beyond the feature.
    #[default]
    Inserted,
}

/// Mirror of the feature before it is turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mirror {
    /// None.
    #[default]
    None,
    /// `u` runs the other way.
    U,
    /// `v` runs the other way.
    V,
}

/// All choices of one paste.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How; `None` chooses [`Method::Displacement`] where the nets can be matched, else [`Method::Fit`].
    pub method: Option<Method>,
    /// Which control points are the feature's.
    pub rule: Rule,
    /// How gradients turn.
    pub turn: Turn,
    /// Weights of the Laplacian.
    pub edge_weights: EdgeWeights,
    /// What becomes of the target's detail.
    pub existing: Existing,
    /// Factors along `u`, along `v`, along the normal; positive, the last may be negative.
    pub scale: [f64; 3],
    /// Angle from the target's `u` to the image of the source's `u`, about the target's normal, in radians.
    pub angle: f64,
    /// Mirror.
    pub mirror: Mirror,
    /// Ends of the source's domain (matched nets only).
    pub ends: Ends,
    /// Rows and columns at the border of the target that stay.
    pub margin: usize,
    /// Greatest deviation of a fit, in the target's units.
    pub tolerance: f64,
    /// Greatest count of control points of the result.
    pub limit: usize,
}

/// Control points beyond which a result is refused: a file of half a gigabyte.
pub const NET_LIMIT: usize = 4_000_000;

impl Settings {
    /// The defaults with a tolerance of fits, in the target's units.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self {
            method: None,
            rule: Rule::default(),
            turn: Turn::default(),
            edge_weights: EdgeWeights::default(),
            existing: Existing::default(),
            scale: [1.0; 3],
            angle: 0.0,
            mirror: Mirror::default(),
            ends: Ends::default(),
            margin: 2,
            tolerance,
            limit: NET_LIMIT,
        }
    }

    /// The method, chosen where it was left open.
    ///
    /// # Errors
    /// [`PasteError::MethodCannot`] when a method was named that cannot do what is asked,
    /// [`PasteError::BadSetting`].
    pub fn chosen_method(&self) -> Result<Method, PasteError> {
        self.check()?;
        let aligned = self.angle == 0.0 && self.mirror == Mirror::None;
        let method = self.method.unwrap_or(match (aligned, self.existing) {
            (true, Existing::Stronger) => Method::Biharmonic,
            (true, _) => Method::Displacement,
            _ => Method::Fit,
        });
        let cannot = |reason| Err(PasteError::MethodCannot { method: method.as_str(), reason });
        match (method, aligned, self.existing) {
            (Method::Displacement | Method::Poisson | Method::Biharmonic, false, _) => {
                cannot("keeps the directions of the parameters; `fit` turns and mirrors")
            }
            (Method::Displacement | Method::Fit, _, Existing::Stronger) => {
                cannot("knows no gradients; `existing = \"stronger\"` needs `poisson` or `biharmonic`")
            }
            _ => Ok(method),
        }
    }

    fn check(&self) -> Result<(), PasteError> {
        let bad = |what, expected, found: f64| {
            Err(PasteError::BadSetting { what, expected, found: found.to_string() })
        };
        if let Some(&factor) = self.scale[..2].iter().find(|f| !(f.is_finite() && **f > 0.0)) {
            return bad("scale", "a positive number", factor);
        }
        if !self.scale[2].is_finite() || self.scale[2] == 0.0 {
            return bad("scale along the normal", "a number other than 0", self.scale[2]);
        }
        if !self.angle.is_finite() {
            return bad("angle", "a finite number", self.angle);
        }
        if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            return bad("tolerance", "a positive number", self.tolerance);
        }
        Ok(())
    }
}

/// A feature on its source, and where on the target it goes.
#[derive(Debug, Clone, Copy)]
pub struct Feature<'a> {
    /// The source surface.
    pub source: &'a NurbsSurface,
    /// Closed polygon round the feature in the source's parameters.
    pub contour: &'a [[f64; 2]],
    /// Parameters of the source that go to [`Ground::at`].
    pub anchor: [f64; 2],
}

/// A place on the target.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// The target surface.
    pub target: &'a NurbsSurface,
    /// Parameters of the target where the anchor goes.
    pub at: [f64; 2],
}

/// A surface with a feature pasted onto it.
#[derive(Debug, Clone)]
pub struct Pasted {
    /// The result.
    pub surface: NurbsSurface,
    /// The target over the same knots: the same geometry as before, for comparison.
    pub refined: NurbsSurface,
    /// Control points that changed.
    pub changed: Mask,
    /// Source parameters to target parameters.
    pub map: ParameterMap,
    /// How it was done.
    pub method: Method,
    /// Control points of the feature that were left out: too near to a border, or without partner.
    pub lost: usize,
    /// Greatest displacement, in the source's units, of a control point that was left out.
    pub lost_detail: f64,
    /// Greatest deviation of a fit.
    pub fit_error: Option<f64>,
    /// Row and column of the target's net that the source's first row and column fall on (matched nets only).
    pub offset: Option<[isize; 2]>,
}

/// The affine map `x ↦ linear (x - from) + to` between parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterMap {
    /// Row by row.
    pub linear: [[f64; 2]; 2],
    /// Parameters of the source.
    pub from: [f64; 2],
    /// Their image.
    pub to: [f64; 2],
}

impl ParameterMap {
    /// Image of source parameters.
    #[must_use]
    pub fn apply(&self, x: [f64; 2]) -> [f64; 2] {
        let d = [x[0] - self.from[0], x[1] - self.from[1]];
        [0, 1].map(|k| self.linear[k][0] * d[0] + self.linear[k][1] * d[1] + self.to[k])
    }

    /// The inverse; `None` when the map is singular.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let [[a, b], [c, d]] = self.linear;
        let det = self.determinant();
        let linear = [[d / det, -b / det], [-c / det, a / det]];
        linear.iter().flatten().all(|x| x.is_finite()).then_some(Self {
            linear,
            from: self.to,
            to: self.from,
        })
    }

    /// Ratio of oriented areas: negative for a map that turns orientation round.
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.linear[0][0] * self.linear[1][1] - self.linear[0][1] * self.linear[1][0]
    }
}
