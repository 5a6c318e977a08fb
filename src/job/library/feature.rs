//! The feature library: a feature taken off its face, as a JSON file that pastes read without the part.
//!
//! Homogeneous points are kept as they are, so that a paste from the library gives the bytes of one from the part.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::nurbs::{KnotVector, NurbsCurve2, NurbsSurface};
use crate::job::file::LengthSetting;
use crate::job::file::paste::RegionSetting;
use crate::job::file::selector::Selector;
use crate::job::operate::OperateError;
use crate::job::operate::paste::extracted;
use crate::model::Model;
use crate::ops::feature_paste::plan::Extracted;

/// A feature of a library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "resurf feature")]
pub struct FeatureFile {
    /// What the file is: `resurf-feature`.
    pub format: Format,
    /// Version of the format: 1.
    pub version: u32,
    /// Where it was taken from, for people.
    #[serde(default)]
    pub origin: String,
    /// Length of its unit, in metres.
    pub metres_per_unit: f64,
    /// Whether the normal `du x dv` of the surface points out of the face.
    pub outward: bool,
    /// The surface.
    pub surface: SurfaceEntry,
    /// Closed polygon round the feature in the parameters of the surface; the closing side is implied.
    pub contour: Vec<[f64; 2]>,
    /// Parameters that go to the place on the target.
    pub anchor: [f64; 2],
    /// Holes inside the contour: edges in order, in the parameters of the surface.
    #[serde(default)]
    pub holes: Vec<Vec<CurveEntry>>,
}

/// The word that tells a feature file from other JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Format {
    /// The only one.
    #[serde(rename = "resurf-feature")]
    Feature,
}

/// A B-spline surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceEntry {
    /// Degrees along `u` and `v`.
    pub degree: [usize; 2],
    /// Knots along `u`, each as often as it counts.
    pub knots_u: Vec<f64>,
    /// Knots along `v`.
    pub knots_v: Vec<f64>,
    /// Control points `(w x, w y, w z, w)`, those of one `u` together.
    pub points: Vec<[f64; 4]>,
}

/// A B-spline curve in the parameters of the surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurveEntry {
    /// Degree.
    pub degree: usize,
    /// Knots, each as often as it counts.
    pub knots: Vec<f64>,
    /// Control points `(w u, w v, w)`.
    pub points: Vec<[f64; 3]>,
}

/// The version that is written and read.
const VERSION: u32 = 1;

impl FeatureFile {
    /// From a feature; `origin` is for people.
    #[must_use]
    pub fn of(feature: &Extracted, origin: String) -> Self {
        let surface = &feature.surface;
        let curve = |c: &NurbsCurve2| CurveEntry {
            degree: c.knots().degree(),
            knots: c.knots().knots().to_vec(),
            points: c.points().to_vec(),
        };
        Self {
            format: Format::Feature,
            version: VERSION,
            origin,
            metres_per_unit: feature.metres,
            outward: feature.natural,
            surface: SurfaceEntry {
                degree: [surface.knots_u().degree(), surface.knots_v().degree()],
                knots_u: surface.knots_u().knots().to_vec(),
                knots_v: surface.knots_v().knots().to_vec(),
                points: surface.net().to_vec(),
            },
            contour: feature.contour.clone(),
            anchor: feature.anchor,
            holes: feature.holes.iter().map(|hole| hole.iter().map(curve).collect()).collect(),
        }
    }

    /// The feature.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn feature(&self) -> Result<Extracted, String> {
        if self.version != VERSION {
            return Err(format!(
                "version {} is not known; this program reads version {VERSION}",
                self.version
            ));
        }
        if !(self.metres_per_unit.is_finite() && self.metres_per_unit > 0.0) {
            return Err(format!("`metres_per_unit` is {}; expected a positive number", self.metres_per_unit));
        }
        let knots = |degree: usize, values: &[f64], key: &str| {
            KnotVector::new(degree, values.to_vec()).map_err(|e| format!("`{key}`: {e}"))
        };
        let entry = &self.surface;
        let surface = NurbsSurface::new(
            knots(entry.degree[0], &entry.knots_u, "surface.knots_u")?,
            knots(entry.degree[1], &entry.knots_v, "surface.knots_v")?,
            entry.points.clone(),
        )
        .map_err(|e| format!("`surface`: {e}"))?;
        let curve = |c: &CurveEntry| {
            let knots = knots(c.degree, &c.knots, "holes.knots")?;
            NurbsCurve2::new(knots, c.points.clone()).map_err(|e| format!("`holes`: {e}"))
        };
        let holes = self.holes.iter().map(|hole| hole.iter().map(curve).collect::<Result<Vec<_>, _>>());
        Ok(Extracted {
            surface,
            contour: self.contour.clone(),
            anchor: self.anchor,
            metres: self.metres_per_unit,
            natural: self.outward,
            holes: holes.collect::<Result<_, _>>()?,
        })
    }

    /// The text of the file, with a line feed behind it.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = serde_json::to_string(self).expect("a feature is a tree of texts and numbers");
        text.push('\n');
        text
    }

    /// Reads a text.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn read(text: &str) -> Result<Extracted, String> {
        serde_json::from_str::<Self>(text).map_err(|e| e.to_string())?.feature()
    }
}

/// Takes a feature off a face of a model.
///
/// # Errors
/// [`OperateError`].
pub fn export(
    model: &Model,
    face: Option<&Selector>,
    region: &RegionSetting,
    at: Option<&[LengthSetting; 3]>,
    file: &str,
) -> Result<FeatureFile, OperateError> {
    let (feature, face) = extracted(model, face, region, at)?;
    Ok(FeatureFile::of(&feature, format!("{} of {file}", model.origins.faces[face])))
}
