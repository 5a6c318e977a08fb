//! From the words of `deform` to the operation: the face is selected, curves are read and sampled, lengths get their units.

use crate::brep::edge_samples::{EdgeRange, EdgeSampling, sample_curve};
use crate::brep::sample_edge;
use crate::job::file::LengthSetting;
use crate::job::file::deform::{Deform, DeformLine, FormWord, Minimise, NormalSetting};
use crate::job::file::detail::CurveSelector;
use crate::job::file::scale::Continuity;
use crate::job::operate::select::{self, point_in};
use crate::job::operate::select_curve;
use crate::job::operate::{OperateError, other_file};
use crate::math::{Point3, Vector3};
use crate::model::Model;
use crate::ops::deform::{Form, Line, Normal, Params, Path, Plan, plan};
use crate::ops::force_density::Criteria;
use crate::units::LengthUnit;

/// Strength of the lines in the penalty form, unless the job says one: noise-free lines are met closely.
const STRENGTH: f64 = 1e4;
/// Least count of spans, unless the job says one.
const SPANS: [usize; 2] = [8, 8];

/// Plans a deformation of a model.
pub(in crate::job) fn planned(model: &Model, words: &Deform) -> Result<Plan, OperateError> {
    let face = select::one_face(model, words.face.as_ref()).map_err(OperateError::Face)?;
    let unit = &model.context_of(face).length;
    let lines = words.lines.iter().enumerate().map(|(k, words)| line(model, words, unit, k));
    let params = Params {
        face,
        lines: lines.collect::<Result<_, _>>()?,
        criteria: criteria(words.minimise),
        form: match words.form {
            FormWord::Penalty => Form::Penalty { strength: words.strength.unwrap_or(STRENGTH) },
            FormWord::Exact => Form::Exact,
        },
        margin: match words.continuity {
            Continuity::Position => 1,
            Continuity::Tangent => 2,
            Continuity::Curvature => 3,
        },
        tolerance: words.tolerance.map(|length| length.0.in_unit(unit)),
        spans: words.spans.unwrap_or(SPANS),
    };
    Ok(plan(model, &params)?)
}

/// The weights of the measures.
pub(in crate::job) fn criteria(words: Minimise) -> Criteria {
    Criteria {
        force_variation: words.force_variation,
        force: words.force,
        bar_length: words.bar_length,
        displacement: words.displacement,
    }
}

fn line(model: &Model, words: &DeformLine, unit: &LengthUnit, k: usize) -> Result<Line, OperateError> {
    let source = Source { model, unit, key: format!("lines[{k}]") };
    let from = words.from.as_ref().map(|from| {
        let source = Source { key: format!("{}.from", source.key), ..source.clone() };
        source.path(&from.points, from.curve.as_ref(), from.file.as_deref())
    });
    Ok(Line {
        to: source.path(&words.points, words.curve.as_ref(), words.file.as_deref())?,
        from: from.transpose()?,
        weight: words.weight.0,
        normal: match words.normal {
            NormalSetting::Free => Normal::Free,
            NormalSetting::Keep => Normal::Keep,
            NormalSetting::Along(direction) => Normal::Along(Vector3::from(direction)),
        },
    })
}

/// Where a line's words are understood.
#[derive(Clone)]
struct Source<'a> {
    model: &'a Model,
    unit: &'a LengthUnit,
    /// The key of the words, for messages.
    key: String,
}

/// Chords of one span of a curve.
const CHORDS: usize = 24;
/// Distance of a curve from its chords, as a part of its size.
const CHORD: f64 = 1e-6;

impl Source<'_> {
    fn path(
        &self,
        points: &[[LengthSetting; 3]],
        curve: Option<&CurveSelector>,
        file: Option<&str>,
    ) -> Result<Path, OperateError> {
        if !points.is_empty() {
            return Ok(Path::Points(points.iter().map(|point| point_in(point, self.unit)).collect()));
        }
        let other = file.map(other_file).transpose().map_err(|error| self.in_file(error))?;
        let from = other.as_ref().unwrap_or(self.model);
        let points = curve_points(from, curve)
            .map_err(|reason| OperateError::Line { key: self.key.clone(), reason })?;
        let factor = match (&other, from.contexts.first()) {
            (Some(_), Some(context)) => context.length.metres / self.unit.metres,
            _ => 1.0,
        };
        Ok(Path::Curve(points.into_iter().map(|p| p * factor).collect()))
    }

    fn in_file(&self, error: OperateError) -> OperateError {
        match error {
            OperateError::SourceFile { file, reason } => {
                OperateError::Line { key: format!("{}.file", self.key), reason: format!("{file}: {reason}") }
            }
            other => other,
        }
    }
}

/// Points along a curve, or along an edge when that is what the name means.
pub(in crate::job) fn curve_points(
    model: &Model,
    selector: Option<&CurveSelector>,
) -> Result<Vec<Point3<f64>>, String> {
    let brep = &model.brep;
    let plain = |chord| EdgeSampling { chord, per_span: CHORDS };
    if let Some(CurveSelector::Record(wanted)) = selector {
        let edge = model.origins.edges.iter().find(|(_, origin)| *origin == wanted).map(|(edge, _)| edge);
        if let Some(edge) = edge {
            let coarse = sample_edge(brep, edge, &plain(f64::INFINITY)).unwrap_or_default();
            let fine = sample_edge(brep, edge, &plain(CHORD * size(coarse.iter().map(|s| s.point))));
            let fine = fine.filter(|points| !points.is_empty());
            return fine
                .map(|points| points.into_iter().map(|s| s.point).collect())
                .ok_or_else(|| format!("the edge `{wanted}` has no curve that was read"));
        }
    }
    let found = select_curve::one(model, selector).map_err(|error| error.to_string())?;
    let curve = brep.curves[found].read().ok_or("the curve was not read")?;
    let (start, end) = curve.domain();
    if !(start.is_finite() && end.is_finite()) {
        return Err(format!("the {} is endless; expected a curve with two ends", curve.kind()));
    }
    let range = EdgeRange { start, end };
    let coarse = sample_curve(curve, range, &plain(f64::INFINITY));
    let fine = sample_curve(curve, range, &plain(CHORD * size(coarse.iter().map(|s| s.point))));
    Ok(fine.into_iter().map(|s| s.point).collect())
}

fn size(points: impl Iterator<Item = Point3<f64>>) -> f64 {
    let points: Vec<Point3<f64>> = points.collect();
    crate::math::BoundingBox::of(&points).diagonal()
}
