//! What a transfer on a model is told, and what it tells.

use serde::Serialize;

use super::error::TransferError;
use super::settings::Settings;
use super::spline::Spline;
use crate::brep::{CurveId, FaceId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::{ChangeSet, Model};

/// Parameters of the operation on a model. Lengths are in units of the target's file.
#[derive(Debug, Clone)]
pub struct Params<'a> {
    /// What gives detail.
    pub source: Source<'a>,
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

/// What gives detail.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// A curve of a model.
    Curve(&'a Model, CurveId),
    /// A spline of a library, and its name in messages.
    Spline(&'a Spline, &'a str),
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

/// A face that detail is laid over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceTarget {
    /// The face.
    pub face: FaceId,
    /// The direction in which the source runs.
    pub direction: Direction,
    /// Part of the other parameter that gets detail: from 0 to 1.
    pub across: [f64; 2],
}

/// A direction on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along `u`.
    U,
    /// Along `v`.
    V,
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
