//! From the words of `feature_paste` to the operation: faces are selected, the source's file is read, lengths get
//! their units, patterns become places.

use crate::brep::FaceId;
use crate::brep::edge_samples::{EdgeRange, EdgeSampling, sample_curve};
use crate::brep::sample_edge;
use crate::job::file::paste::{
    EdgeWeightsWord, ExistingWord, HolesWord, LoopsWord, MirrorWord, PasteMethod, Pattern, PlaneSetting,
    RegionSetting, RuleWord, TurnWord,
};
use crate::job::file::selector::Selector;
use crate::job::file::{FeaturePaste, LengthSetting};
use crate::job::library::feature::FeatureFile;
use crate::job::operate::select::{self, point_in};
use crate::job::operate::{OperateError, other_file};
use crate::math::{Point3, Vector3};
use crate::model::{Model, Origin};
use crate::ops::feature_paste::contour::{Plane, closed_points};
use crate::ops::feature_paste::plan::{
    Extracted, FaceSource, Holes, Params, Place, Plan, Region, TargetLoops, circular_pattern, direction_at,
    extract, linear_pattern, plan,
};
use crate::ops::feature_paste::{EdgeWeights, Existing, Method, Mirror, Rule, Settings, Turn};
use crate::units::LengthUnit;

/// Plans a paste onto a model.
pub(in crate::job) fn planned(model: &Model, words: &FeaturePaste) -> Result<Plan, OperateError> {
    let target = select::one_face(model, words.target.face.as_ref()).map_err(OperateError::TargetFace)?;
    let unit = &model.context_of(target).length;
    let wanted = &words.source;
    let feature = match &wanted.feature {
        Some(file) => saved(file)?,
        None => {
            let other = wanted.file.as_deref().map(other_file).transpose()?;
            let from = other.as_ref().unwrap_or(model);
            extracted(from, wanted.face.as_ref(), &wanted.region, wanted.at.as_ref())?.0
        }
    };
    let settings = settings(words);
    let places = places(model, words, unit, target)?;
    let loops = match words.loops {
        LoopsWord::Refuse => TargetLoops::Refuse,
        LoopsWord::Protect => TargetLoops::Protect,
    };
    let tolerance = words.tolerance.map(|length| length.0.in_unit(unit));
    let holes = match words.holes {
        HolesWord::Close => Holes::Close,
        HolesWord::Carry => Holes::Carry,
    };
    Ok(plan(model, &Params { source: &feature, target, places, settings, tolerance, loops, holes })?)
}

/// Takes a feature off a face, and tells which.
///
/// # Errors
/// [`OperateError`].
pub(in crate::job) fn extracted(
    model: &Model,
    face: Option<&Selector>,
    wanted: &RegionSetting,
    at: Option<&[LengthSetting; 3]>,
) -> Result<(Extracted, FaceId), OperateError> {
    let face = select::one_face(model, face).map_err(OperateError::SourceFace)?;
    let unit = &model.context_of(face).length;
    let anchor = at.map(|point| point_in(point, unit));
    let source = FaceSource { model, face, region: region(model, wanted, unit)?, anchor };
    Ok((extract(&source)?, face))
}

/// A feature of a library.
fn saved(file: &str) -> Result<Extracted, OperateError> {
    let fault = |reason: String| OperateError::FeatureFile { file: file.to_owned(), reason };
    let text = std::fs::read_to_string(file).map_err(|error| fault(error.to_string()))?;
    FeatureFile::read(&text).map_err(fault)
}

fn settings(words: &FeaturePaste) -> Settings {
    Settings {
        method: words.method.map(|method| match method {
            PasteMethod::Displacement => Method::Displacement,
            PasteMethod::Poisson => Method::Poisson,
            PasteMethod::Biharmonic => Method::Biharmonic,
            PasteMethod::Fit => Method::Fit,
        }),
        rule: match words.rule {
            RuleWord::Support => Rule::Support,
            RuleWord::RowsAndColumns => Rule::RowsAndColumns,
        },
        turn: match words.turn {
            TurnWord::Frame => Turn::Frame,
            TurnWord::Normal => Turn::Normal,
            TurnWord::None => Turn::None,
        },
        edge_weights: match words.edge_weights {
            EdgeWeightsWord::FiniteVolume => EdgeWeights::FiniteVolume,
            EdgeWeightsWord::Uniform => EdgeWeights::Uniform,
        },
        existing: match words.existing {
            ExistingWord::Keep => Existing::Keep,
            ExistingWord::Replace => Existing::Replace,
            ExistingWord::Stronger => Existing::Stronger,
        },
        margin: words.margin.0,
        ..Settings::new(1.0)
    }
}

fn mirror(word: MirrorWord) -> Mirror {
    match word {
        MirrorWord::None => Mirror::None,
        MirrorWord::U => Mirror::U,
        MirrorWord::V => Mirror::V,
    }
}

fn places(
    model: &Model,
    words: &FeaturePaste,
    unit: &LengthUnit,
    target: FaceId,
) -> Result<Vec<Place>, OperateError> {
    let wanted = &words.target;
    let along = wanted.along.map(Vector3::from);
    let place = |at: Point3<f64>| Place {
        at,
        along,
        angle: words.rotate.0,
        mirror: mirror(words.mirror),
        scale: words.scale.0,
    };
    let mut places = Vec::new();
    if let Some(at) = &wanted.at {
        let first = place(point_in(at, unit));
        match &wanted.pattern {
            None => places.push(first),
            Some(Pattern::Linear(row)) => {
                places.extend(linear_pattern(&first, &point_in(&row.step, unit).coords, row.count.0));
            }
            Some(Pattern::Circular(ring)) => {
                let axis = (&point_in(&ring.point, unit), &Vector3::from(ring.direction));
                let along = along.map_or_else(|| direction_at(model, target, &first), Ok)?;
                places.extend(circular_pattern(&first, axis, ring.angle.0, ring.count.0, &along));
            }
        }
    }
    places.extend(wanted.places.iter().map(|own| {
        let plain = place(point_in(&own.at, unit));
        Place {
            angle: plain.angle + own.rotate.0,
            mirror: own.mirror.map_or(plain.mirror, mirror),
            scale: own.scale.map_or(plain.scale, |s| s.0),
            ..plain
        }
    }));
    Ok(places)
}

fn plane(setting: Option<PlaneSetting>, unit: &LengthUnit) -> Option<Plane> {
    let setting = setting?;
    let normal = Vector3::from(setting.direction).try_normalize(0.0)?;
    Some(Plane { origin: point_in(&setting.point, unit), normal })
}

fn region(model: &Model, words: &RegionSetting, unit: &LengthUnit) -> Result<Region, OperateError> {
    Ok(match words {
        RegionSetting::Outer => Region::Outer,
        RegionSetting::Inner(number) => Region::Inner(*number),
        RegionSetting::Polygon(points) => Region::Parameters(points.clone()),
        RegionSetting::Contour(points, reference) => {
            let points = points.iter().map(|point| point_in(point, unit)).collect();
            Region::Contour(points, plane(*reference, unit))
        }
        RegionSetting::Curve(name, reference) => {
            let points = closed_points(curve_points(model, *name)?);
            let points = points.map_err(crate::ops::OperationError::from)?;
            Region::Contour(points, plane(*reference, unit))
        }
    })
}

/// Chords of one span of a contour's curve.
const CHORDS: usize = 16;

/// Points along a curve of the file: an edge, or a curve that belongs to none.
fn curve_points(model: &Model, wanted: Origin) -> Result<Vec<Point3<f64>>, OperateError> {
    let brep = &model.brep;
    let sampling = EdgeSampling { per_span: CHORDS, ..EdgeSampling::default() };
    let edge = brep
        .edges
        .iter()
        .find(|(id, edge)| model.origins.edges[*id] == wanted || model.origins.curves[edge.curve] == wanted);
    let samples = match edge {
        Some((id, _)) => sample_edge(brep, id, &sampling),
        None => {
            let curve = model.origins.curves.iter().find(|(_, origin)| **origin == wanted);
            curve.and_then(|(id, _)| brep.curves[id].read()).map(|curve| {
                let (start, end) = curve.domain();
                sample_curve(curve, EdgeRange { start, end }, &sampling)
            })
        }
    };
    let none = || OperateError::NoCurve { name: wanted };
    Ok(samples.ok_or_else(none)?.into_iter().map(|sample| sample.point).collect())
}
