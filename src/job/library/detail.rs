//! The library of curve detail: a curve split into its base and levels, as a JSON file that transfers read without
//! the part.
//!
//! The filters are not in the file: they follow from the knots, the end order and the rules of
//! `docs/decisions/detail-transfer.md`, whose version is stated. Splitting and joining are each other's inverse, so a
//! transfer from the library is one from the curve, but for rounding.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::bspline_wavelet::{Decomposition, decompose};
use crate::geometry::nurbs::KnotVector;
use crate::job::file::detail::CurveSelector;
use crate::job::operate::OperateError;
use crate::job::operate::select_curve;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::detail_transfer::on_curve::spline_of;
use crate::ops::detail_transfer::{Spline, TransferError};

/// The detail of one curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "resurf detail")]
pub struct DetailFile {
    /// What the file is: `resurf-detail`.
    pub format: Format,
    /// Version of the format and of the rules of the filters: 1.
    pub version: u32,
    /// Where it was taken from, for people.
    #[serde(default)]
    pub origin: String,
    /// Length of its unit, in metres.
    pub metres_per_unit: f64,
    /// Degree of the curve.
    pub degree: usize,
    /// Derivatives at both ends that are the same on all levels, the position counted as one.
    pub ends: usize,
    /// Knots of the curve, each as often as it counts.
    pub knots: Vec<f64>,
    /// Knots of the base.
    pub base_knots: Vec<f64>,
    /// Control points of the base.
    pub base: Vec<[f64; 3]>,
    /// Coefficients of the wavelets of each level, finest first.
    pub levels: Vec<Vec<[f64; 3]>>,
}

/// The word that tells a file of detail from other JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Format {
    /// The only one.
    #[serde(rename = "resurf-detail")]
    Detail,
}

/// The version that is written and read.
const VERSION: u32 = 1;

/// End order of what is written: with the position kept, the base runs from end to end of the curve.
const ENDS: usize = 1;

impl DetailFile {
    /// From a spline; `origin` is for people.
    fn of(spline: &Spline, metres_per_unit: f64, origin: String) -> Result<Self, TransferError> {
        let degree = spline.knots.degree();
        let ends = ENDS.min(degree);
        let split = decompose(&spline.knots, &spline.points, usize::MAX, ends)
            .map_err(|error| TransferError::Wavelets { curve: origin.clone(), error })?;
        if split.levels.is_empty() {
            return Err(TransferError::NoLevels { curve: origin, controls: spline.points.len(), degree });
        }
        Ok(Self {
            format: Format::Detail,
            version: VERSION,
            origin,
            metres_per_unit,
            degree,
            ends,
            knots: spline.knots.knots().to_vec(),
            base_knots: split.base_knots.knots().to_vec(),
            base: split.base,
            levels: split.details,
        })
    }

    /// The curve, put together again.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn spline(&self) -> Result<Spline, String> {
        if self.version != VERSION {
            let known = format!("this program reads version {VERSION}");
            return Err(format!("version {} is not known; {known}", self.version));
        }
        if !(self.metres_per_unit.is_finite() && self.metres_per_unit > 0.0) {
            return Err(format!("`metres_per_unit` is {}; expected a positive number", self.metres_per_unit));
        }
        let knots = KnotVector::new(self.degree, self.knots.clone()).map_err(|e| format!("`knots`: {e}"))?;
        let nothing = vec![[0.0; 3]; knots.n_basis()];
        let filters = decompose(&knots, &nothing, self.levels.len(), self.ends).map_err(|e| e.to_string())?;
        if filters.levels.len() != self.levels.len() {
            let (found, expected) = (self.levels.len(), filters.levels.len());
            return Err(format!("`levels` has {found} levels; the knots have {expected}"));
        }
        let mut counts =
            filters.details.iter().zip(&self.levels).map(|(e, f)| (e.len(), f.len())).enumerate();
        if let Some((at, (expected, found))) = counts.find(|(_, (expected, found))| expected != found) {
            return Err(format!("`levels[{at}]` has {found} coefficients; the knots ask for {expected}"));
        }
        if filters.base_knots.knots() != self.base_knots || filters.base.len() != self.base.len() {
            return Err("`base_knots` and `base` are not those of the knots".to_owned());
        }
        let split = Decomposition { base: self.base.clone(), details: self.levels.clone(), ..filters };
        let points = split.joined();
        if !points.iter().flatten().all(|c| c.is_finite()) {
            return Err("its numbers are not finite".to_owned());
        }
        Ok(Spline { knots, points })
    }

    /// The text of the file, with a line feed behind it.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = serde_json::to_string(self).expect("detail is a tree of texts and numbers");
        text.push('\n');
        text
    }

    /// Reads a text.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn read(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|e| e.to_string())
    }
}

/// Takes the detail of a curve of a model; of the only free one when none is selected.
///
/// # Errors
/// [`OperateError`].
pub fn export(model: &Model, curve: Option<&CurveSelector>, file: &str) -> Result<DetailFile, OperateError> {
    let curve = select_curve::one(model, curve).map_err(OperateError::SourceCurve)?;
    let spline = spline_of(model, curve)?;
    let metres = model.contexts.first().map_or(1.0, |context| context.length.metres);
    let kept = DetailFile::of(&spline, metres, format!("{} of {file}", model.origins.curves[curve]));
    Ok(kept.map_err(OperationError::from)?)
}
