//! From the words of `feature_reconstruction` to the operation: the face is selected, clouds are read, lengths get their
//! units, patterns become motions.

use std::path::Path;

use crate::cloud::{LabelColumn, PointCloud};
use crate::document::cloud;
use crate::job::file::paste::Pattern;
use crate::job::file::reconstruct::{
    BackboneCurve, BackboneSetting, BlendSetting, CloudSetting, ColumnSetting, FeatureReconstruction,
    FollowWord, LabelsSetting,
};
use crate::job::operate::deform::{criteria, curve_points};
use crate::job::operate::select::{self, point_in};
use crate::job::operate::{OperateError, other_file};
use crate::math::{Affine, Point3, Vector3, rotation};
use crate::model::Model;
use crate::ops::feature_reconstruction::plan::{BackboneChoice, Params, Plan, RadiusChoice, plan};
use crate::ops::feature_reconstruction::radius::Wanted;
use crate::ops::feature_reconstruction::scan::Scan;
use crate::ops::feature_reconstruction::secondary::CloudUse;
use crate::units::LengthUnit;

/// Ribs, unless the job says how many.
const RIBS: usize = 11;

/// Plans a reconstruction on a model.
pub(in crate::job) fn planned(model: &Model, words: &FeatureReconstruction) -> Result<Plan, OperateError> {
    let selector = words.primary.face.as_ref();
    let face = select::one_face(model, selector).map_err(OperateError::PrimaryFace)?;
    let unit = &model.context_of(face).length;
    let scan = scan(&words.cloud, unit)?;
    let lines = &words.lines;
    let params = Params {
        face,
        scan: folded(scan, words.pattern.as_ref(), unit),
        backbone: match &lines.backbone {
            BackboneSetting::Fit => BackboneChoice::Fit,
            BackboneSetting::Slices => BackboneChoice::Slices,
            BackboneSetting::Crest => BackboneChoice::Crest,
            BackboneSetting::Curve(curve) => BackboneChoice::Curve(backbone(model, curve, unit)?),
        },
        along: lines.along,
        ribs: lines.ribs.unwrap_or(RIBS),
        cloud: match words.follow {
            FollowWord::Cloud => CloudUse::Fitted,
            FollowWord::Lines => CloudUse::Compared,
        },
        criteria: criteria(words.minimise),
        spans: lines.spans,
        limits: words.limits.map(|limits| [limits.mean, limits.greatest].map(|l| l.0.in_unit(unit))),
        radius: match words.blend {
            BlendSetting::Tested => RadiusChoice::Found(Wanted::Tested),
            BlendSetting::Constant => RadiusChoice::Found(Wanted::Constant),
            BlendSetting::Linear => RadiusChoice::Found(Wanted::Linear),
            BlendSetting::Radius(length) => RadiusChoice::Given(length.0.in_unit(unit)),
        },
        motions: words.pattern.as_ref().map_or_else(Vec::new, |pattern| motions(pattern, unit)),
    };
    Ok(plan(model, &params)?)
}

/// The points in the part's unit.
fn scan(words: &CloudSetting, unit: &LengthUnit) -> Result<Scan, OperateError> {
    let stated = words.unit.map(|length| length.0.in_unit(unit));
    let read = |file: &str, labels: Option<&LabelsSetting>| cloud_file(file, labels, stated, unit);
    if let (Some(objective), Some(blend)) = (&words.objective, &words.blend) {
        let [objective, blend] = [read(objective, None)?, read(blend, None)?].map(PointCloud::into_points);
        return Ok(Scan::Sorted { objective, blend });
    }
    let file = words.file.as_deref().unwrap_or_default();
    let all = read(file, words.labels.as_ref())?;
    let Some(labels) = &words.labels else { return Ok(Scan::Whole(all.into_points())) };
    let with = |wanted: &[i64]| {
        let found = all.with_labels(wanted).map(PointCloud::into_points);
        found
            .map_err(|error| fault(file, error.code(), &format!("no point has one of the labels {wanted:?}")))
    };
    Ok(Scan::Sorted { objective: with(&labels.objective)?, blend: with(&labels.blend)? })
}

fn fault(file: &str, code: &'static str, reason: &str) -> OperateError {
    OperateError::CloudFile { file: file.to_owned(), code, reason: reason.to_owned() }
}

/// A cloud in the part's unit; `stated` is the length of one of its units.
fn cloud_file(
    file: &str,
    labels: Option<&LabelsSetting>,
    stated: Option<f64>,
    unit: &LengthUnit,
) -> Result<PointCloud, OperateError> {
    let bytes = std::fs::read(file).map_err(|error| fault(file, "job.io", &error.to_string()))?;
    let extension = Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default();
    let column = labels.map(|labels| match &labels.column {
        ColumnSetting::Named(name) => LabelColumn::Named(name.clone()),
        ColumnSetting::Numbered(number) => LabelColumn::Numbered(*number),
    });
    let found = cloud::read(&bytes, extension, column.as_ref())
        .map_err(|error| fault(file, error.code(), &error.to_string()))?;
    let factor = stated.or(found.metres.map(|metres| metres / unit.metres)).unwrap_or(1.0);
    Ok(found.cloud.scaled(factor))
}

/// Points of a whole ring turned onto one of its features.
fn folded(scan: Scan, pattern: Option<&Pattern>, unit: &LengthUnit) -> Scan {
    match pattern {
        Some(Pattern::Circular(ring)) if is_full(ring.angle.0) => {
            scan.folded((&point_in(&ring.point, unit), &Vector3::from(ring.direction)), ring.count.0)
        }
        _ => scan,
    }
}

/// Angle within which a ring is a full turn.
const FULL: f64 = 1e-9;

fn is_full(angle: f64) -> bool {
    (angle.abs() - std::f64::consts::TAU).abs() < FULL
}

/// Motions to all places but the first.
fn motions(pattern: &Pattern, unit: &LengthUnit) -> Vec<Affine> {
    match pattern {
        Pattern::Linear(row) => {
            let step = point_in(&row.step, unit).coords;
            (1..row.count.0).map(|k| Affine::translation(step * k as f64)).collect()
        }
        Pattern::Circular(ring) => {
            let centre = point_in(&ring.point, unit);
            let axis = Vector3::from(ring.direction).normalize();
            let count = ring.count.0;
            let steps = if is_full(ring.angle.0) { count } else { count.saturating_sub(1).max(1) };
            let turn = |k: usize| rotation(&axis, ring.angle.0 * k as f64 / steps as f64);
            (1..count).map(|k| Affine::about(&centre, turn(k))).collect()
        }
    }
}

fn backbone(
    model: &Model,
    words: &BackboneCurve,
    unit: &LengthUnit,
) -> Result<Vec<Point3<f64>>, OperateError> {
    let no_line = |reason| OperateError::Line { key: "lines.backbone".to_owned(), reason };
    let other = words.file.as_deref().map(other_file).transpose();
    let other = other.map_err(|error| no_line(error.to_string()))?;
    let from = other.as_ref().unwrap_or(model);
    let points = curve_points(from, words.curve.as_ref()).map_err(no_line)?;
    let factor = match (&other, from.contexts.first()) {
        (Some(_), Some(context)) => context.length.metres / unit.metres,
        _ => 1.0,
    };
    Ok(points.into_iter().map(|p| p * factor).collect())
}
