//! From curves of models to a change set.

use serde::Serialize;

use super::error::TransferError;
use super::face::{self, FaceTarget};
use super::measure::extent;
use super::prepare::{Prepared, prepare};
use super::settings::Settings;
use super::spline::Spline;
use super::transfer::transfer;
use super::weighted;
use crate::brep::CurveId;
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::{Carried, Curve};
use crate::math::Affine;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;

/// Parameters of the operation on a model. Lengths are in units of the target's file.
#[derive(Debug, Clone)]
pub struct Params<'a> {
    /// Model of the source curve.
    pub source_model: &'a Model,
    /// The curve that gives detail.
    pub source: CurveId,
    /// Length of the source's unit in the target's.
    pub source_unit: f64,
    /// What is changed.
    pub target: Target,
    /// Part of the target by its length: from 0 to 1.
    pub part: Option<[f64; 2]>,
    /// Greatest distance of an approximation from its curve; left out: [`TOLERANCE`] of its size.
    pub tolerance: Option<f64>,
    /// Derivatives that stay at the ends, the position counted as one. Left out: the position where an open curve
    /// is changed as a whole, else up to the second derivative.
    pub ends: Option<usize>,
    /// The rest; its `ends` and `interval` are not looked at.
    pub settings: Settings,
}

/// What gets detail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// A free curve.
    Curve(CurveId),
    /// A face, along a direction.
    Face(FaceTarget),
}

/// Tolerance of approximations relative to the size of the curve.
pub const TOLERANCE: f64 = 1e-6;

/// Derivatives that stay where new detail meets what is left: curvature is continuous.
pub(super) const SMOOTH: usize = 3;

/// What is to be done, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The new curve; empty when nothing changes.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
    /// Facts worth telling.
    pub notes: Vec<Diagnostic>,
}

/// Figures of a transfer. Lengths are in units of the target's file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Record of the target: a curve or a face.
    pub target: String,
    /// Levels that the source has.
    pub levels_available: usize,
    /// Levels carried over, counted from the finest, 1.
    pub levels: Vec<usize>,
    /// Factor on the detail.
    pub scale: f64,
    /// Derivatives that stay at the ends, the position counted as one.
    pub ends_held: usize,
    /// Part of the target's parameter.
    pub interval: [f64; 2],
    /// Greatest length of what was added.
    pub greatest_detail: f64,
    /// Greatest length of what was added, times the curvature there.
    pub detail_times_curvature: f64,
    /// How far the ends moved.
    pub end_shift: [f64; 2],
    /// Length of the target, of a face its middle line, before and after.
    pub length: [f64; 2],
    /// Degree of the target before and after.
    pub degree: [usize; 2],
    /// Control points of the target, of a face its whole net, before and after.
    pub control_points: [usize; 2],
    /// Greatest distance between the source and the spline that stands for it; 0 is exact.
    pub source_deviation: f64,
    /// Greatest distance between the target and the spline that stands for it; 0 is exact.
    pub target_deviation: f64,
}

/// Plans a transfer.
///
/// # Errors
/// [`OperationError::Transfer`]; for faces [`OperationError::NoParameterLoops`] too.
pub fn plan(model: &Model, params: &Params<'_>) -> Result<Plan, OperationError> {
    let source_name = name(params.source_model, params.source);
    if let Target::Curve(curve) = params.target {
        refuse_edges(model, curve)?;
    }
    let source = prepared_source(params, &source_name)?;
    match &params.target {
        Target::Curve(curve) => Ok(on_curve(model, params, *curve, &source, &source_name)?),
        Target::Face(target) => face::plan(model, params, target, &source, &source_name),
    }
}

fn name(model: &Model, curve: CurveId) -> String {
    model.origins.curves[curve].to_string()
}

/// The source in the units of the target.
fn prepared_source(params: &Params<'_>, name: &str) -> Result<Prepared, TransferError> {
    let curve = read(params.source_model, params.source, name)?;
    if params.source_unit.to_bits() == 1.0f64.to_bits() {
        return prepared(curve, name, params.tolerance);
    }
    let scaled = curve.transformed(&Affine::scale(params.source_unit)).map_err(|_| TransferError::Curve {
        curve: name.to_owned(),
        reason: "it cannot be brought to the units of the target".to_owned(),
    })?;
    prepared(&scaled, name, params.tolerance)
}

fn on_curve(
    model: &Model,
    params: &Params<'_>,
    curve: CurveId,
    source: &Prepared,
    source_name: &str,
) -> Result<Plan, TransferError> {
    let target_name = name(model, curve);
    let target = read(model, curve, &target_name)?;
    // Frames and lengths are taken from a spline without weights, which runs as the exact form does.
    let rational = weighted::rational_form(target);
    let target = match &rational {
        Some(exact) => prepared(&Curve::Nurbs(exact.clone()), &target_name, params.tolerance)?,
        None => prepared(target, &target_name, params.tolerance)?,
    };
    let settings = completed(params, &source.spline, &target.spline)?;
    let named = |error| in_file(error, source_name, &target_name);
    let made = transfer(&target.spline, &source.spline, &settings).map_err(named)?;
    let exact = match &rational {
        Some(exact) => weighted::sum(exact, &made.detail)?,
        None => None,
    };
    let is_exact = exact.is_some();
    let new = exact.or_else(|| made.curve.to_nurbs()).ok_or(TransferError::NotFinite)?;
    let extent = extent(&made);
    let (start, end) = target.spline.domain();
    let interval = settings.interval.unwrap_or((start, end));
    let before = rational.as_ref().map_or(&target.spline.knots, |exact| exact.knots());
    let measures = Measures {
        levels_available: made.levels_available,
        levels: made.levels.clone(),
        scale: made.scale,
        ends_held: settings.ends,
        interval: interval.into(),
        greatest_detail: extent.greatest,
        detail_times_curvature: extent.fold,
        end_shift: extent.ends,
        length: [&target.spline, &made.curve].map(|curve| curve.length(start, end)),
        degree: [before.degree(), new.knots().degree()],
        control_points: [before.n_basis(), new.points().len()],
        source_deviation: source.deviation,
        target_deviation: if is_exact { 0.0 } else { target.deviation },
        target: target_name.clone(),
    };
    let notes = notes(&measures, &target_name);
    let mut change_set = ChangeSet::default();
    let still = made.detail.points.iter().flatten().all(|c| *c == 0.0);
    if !still {
        change_set.free_curves.insert(curve, Curve::Nurbs(new));
    }
    Ok(Plan { change_set, measures, notes })
}

/// The new curve of an edge would not lie on its faces any more.
fn refuse_edges(model: &Model, curve: CurveId) -> Result<(), TransferError> {
    let brep = &model.brep;
    let edges = brep.edges.iter().filter(|(_, edge)| edge.curve == curve).map(|(id, _)| id);
    let edges: Vec<_> = edges.collect();
    if edges.is_empty() {
        return Ok(());
    }
    let of_edges = brep.coedges.iter().filter(|(_, coedge)| edges.contains(&coedge.edge));
    let mut faces: Vec<_> = of_edges.map(|(_, coedge)| brep.loops[coedge.in_loop].face).collect();
    faces.sort();
    faces.dedup();
    let names: Vec<String> = faces.iter().map(|&face| model.origins.faces[face].to_string()).collect();
    let faces = if names.is_empty() { "no face".to_owned() } else { names.join(", ") };
    Err(TransferError::EdgeOfFaces { curve: model.origins.curves[curve].to_string(), faces })
}

fn read<'a>(model: &'a Model, curve: CurveId, name: &str) -> Result<&'a Curve, TransferError> {
    match &model.brep.curves[curve] {
        Carried::Read(curve) => Ok(curve),
        Carried::Unread { reason, .. } => {
            Err(TransferError::Curve { curve: name.to_owned(), reason: reason.clone() })
        }
    }
}

fn prepared(curve: &Curve, name: &str, tolerance: Option<f64>) -> Result<Prepared, TransferError> {
    let relative = || {
        let (start, end) = curve.domain();
        let at = |part: f64| curve.point_at(start + (end - start) * part);
        let size = [0.25, 0.5, 0.75, 1.0].map(|part| (at(part) - at(0.0)).norm());
        TOLERANCE * size.into_iter().fold(0.0, f64::max)
    };
    prepare(curve, name, tolerance.unwrap_or_else(relative))
}

/// The settings with the interval and the order at the ends.
pub(super) fn completed(
    params: &Params<'_>,
    source: &Spline,
    target: &Spline,
) -> Result<Settings, TransferError> {
    let interval = match params.part {
        None => None,
        Some([from, to]) if (0.0..to).contains(&from) && to <= 1.0 => {
            Some((target.parameter_at_length(from), target.parameter_at_length(to)))
        }
        Some([start, end]) => return Err(TransferError::BadInterval { start, end }),
    };
    let whole = interval.is_none_or(|interval| interval == target.domain());
    let fitting = if whole && !target.is_closed() { 1 } else { SMOOTH.min(source.knots.degree()) };
    Ok(Settings { interval, ends: params.ends.unwrap_or(fitting), ..params.settings.clone() })
}

/// The records instead of `source` and `target`.
pub(super) fn in_file(error: TransferError, source: &str, target: &str) -> TransferError {
    let named = |name: String| match name.as_str() {
        "source" => source.to_owned(),
        "target" => target.to_owned(),
        _ => name,
    };
    match error {
        TransferError::NoLevels { curve, controls, degree } => {
            TransferError::NoLevels { curve: named(curve), controls, degree }
        }
        TransferError::Wavelets { curve, error } => TransferError::Wavelets { curve: named(curve), error },
        error => error,
    }
}

pub(super) fn notes(measures: &Measures, target: &str) -> Vec<Diagnostic> {
    let note = |code, severity, message| Diagnostic {
        code,
        severity,
        message,
        span: None,
        entity: Some(target.to_owned()),
    };
    let mut notes = Vec::new();
    if measures.detail_times_curvature > 1.0 {
        let message = "the detail is greater than the radius of the coarse curve: the result may fold over";
        notes.push(note("detail.foldover", Severity::Warning, message.to_owned()));
    }
    if measures.target_deviation > 0.0 {
        let message = format!(
            "the curve has no exact form; a cubic stands for it, at most {:.3e} away",
            measures.target_deviation
        );
        notes.push(note("detail.approximated", Severity::Note, message));
    }
    notes
}
