//! Every number of one part that a later version must give again.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::brep::mass_properties::Quadrature;
use crate::job::failure::PartError;
use crate::job::file::{ValidateSettings, ValidatorName};
use crate::job::judge::judge;
use crate::job::own_check::own_findings;
use crate::job::part::Read;
use crate::job::report::measure::{BodyMeasures, Figures, measure_bodies_by};

/// A measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Measure {
    /// A verdict.
    Truth(bool),
    /// A count.
    Count(i64),
    /// A number.
    Number(f64),
    /// A point.
    Point([f64; 3]),
    /// A word.
    Word(String),
}

/// Measures by name: `faces`, `surface.b_spline`, `volume`, `check.open-loop`, `valid.freecad`.
pub type Measures = BTreeMap<String, Measure>;

/// Measures a file; other programs are asked whether they accept it.
///
/// # Errors
/// [`PartError`] of a file that cannot be read or a program that gives no verdict.
pub fn measured(path: &Path, validators: &[ValidatorName]) -> Result<Measures, PartError> {
    let mut read = Read::file(path)?;
    let model = read.model();
    read.refuse_damage()?;
    let figures = Figures::of(&model);
    let mut measures = Measures::new();
    let mut put = |name: String, measure: Measure| drop(measures.insert(name, measure));
    let count = |count: usize| Measure::Count(i64::try_from(count).unwrap_or(i64::MAX));
    put("schema".to_owned(), Measure::Word(figures.schema.join(", ")));
    put("units".to_owned(), Measure::Word(figures.units.join(", ")));
    figures.counts.iter().for_each(|(name, &n)| put(name.clone(), count(n)));
    figures.surfaces.iter().for_each(|(name, &n)| put(format!("surface.{name}"), count(n)));
    if let Some([least, greatest]) = figures.vertex_extents {
        put("extents.min".to_owned(), Measure::Point(least));
        put("extents.max".to_owned(), Measure::Point(greatest));
    }
    let bodies = measure_bodies_by(&model, Quadrature::good);
    whole(&bodies).into_iter().for_each(|(name, measure)| put(name.to_owned(), measure));
    let mut checks: BTreeMap<String, usize> = BTreeMap::new();
    for finding in own_findings(&read.document, &model, 1.0) {
        *checks.entry(finding.code).or_insert(0) += 1;
    }
    checks.iter().for_each(|(code, &n)| put(format!("check.{code}"), count(n)));
    read.diagnostics.counts().iter().for_each(|(code, &n)| put(format!("found.{code}"), count(n)));
    let settings = ValidateSettings { with: validators.to_vec(), require: true, timeout: None };
    for verdict in judge(&settings, path, &model, None)?.verdicts {
        put(format!("valid.{}", verdict.validator.as_str()), Measure::Truth(verdict.accepted));
    }
    Ok(measures)
}

/// Volume, area and centroid of all bodies together, each once, in its own coordinates. Nothing of a part with a body
/// that cannot be measured, beside the count of such.
fn whole(bodies: &[BodyMeasures]) -> Vec<(&'static str, Measure)> {
    let unknown = bodies.iter().filter(|body| body.unknown.is_some()).count();
    if unknown > 0 {
        return vec![("unmeasured", Measure::Count(i64::try_from(unknown).unwrap_or(i64::MAX)))];
    }
    let sum = |value: fn(&BodyMeasures) -> Option<f64>| bodies.iter().filter_map(value).sum::<f64>();
    let (volume, area) = (sum(|body| body.volume), sum(|body| body.area));
    let mut found = vec![("area", Measure::Number(area))];
    if bodies.iter().any(|body| body.volume.is_some()) {
        found.push(("volume", Measure::Number(volume)));
    }
    // Weighed by volume where there is one, else by area; sheets beside solids weigh nothing.
    let solid = volume != 0.0;
    let weighed = bodies.iter().filter_map(|body| {
        let weight = if solid { body.volume.unwrap_or(0.0) } else { body.area? };
        Some((weight, body.centroid?))
    });
    let (mut total, mut moment) = (0.0, [0.0; 3]);
    for (weight, centroid) in weighed {
        total += weight;
        moment.iter_mut().zip(centroid).for_each(|(sum, c)| *sum += weight * c);
    }
    if total != 0.0 {
        found.push(("centroid", Measure::Point(moment.map(|sum| sum / total))));
    }
    found
}
