//! Detail put onto a free curve.

use super::error::TransferError;
use super::measure::extent;
use super::params::{Measures, Params, Plan, TOLERANCE, completed, in_file, notes};
use super::prepare::{Prepared, prepare};
use super::settings::TargetBase;
use super::spline::Spline;
use super::transfer::transfer;
use super::weighted;
use crate::brep::CurveId;
use crate::geometry::{Carried, Curve};
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;

/// Plans a transfer onto a curve that belongs to no face.
pub(super) fn plan(
    model: &Model,
    params: &Params<'_>,
    curve: CurveId,
    source: &Prepared,
    source_name: &str,
) -> Result<Plan, TransferError> {
    refuse_edges(model, curve)?;
    let target_name = name(model, curve);
    let target = read(model, curve, &target_name)?;
    // Frames and lengths are taken from a spline without weights, which runs as the exact form does.
    let rational = weighted::rational_form(target);
    let target = match &rational {
        Some(exact) => prepared(&Curve::Nurbs(exact.clone()), &target_name, params.tolerance)?,
        None => prepared(target, &target_name, params.tolerance)?,
    };
    let mut settings = completed(params, &source.spline, &target.spline)?;
    if target.deviation > 0.0 {
        settings.target_base = TargetBase::AsItIs;
    }
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

/// The spline that stands for a curve of a model, within a millionth of its size.
///
/// # Errors
/// [`OperationError::Transfer`].
pub fn spline_of(model: &Model, curve: CurveId) -> Result<Spline, OperationError> {
    let name = name(model, curve);
    Ok(prepared(read(model, curve, &name)?, &name, None)?.spline)
}

/// Name of a curve in messages: its origin.
pub(super) fn name(model: &Model, curve: CurveId) -> String {
    model.origins.curves[curve].to_string()
}

/// The curve, if it was read.
pub(super) fn read<'a>(model: &'a Model, curve: CurveId, name: &str) -> Result<&'a Curve, TransferError> {
    match &model.brep.curves[curve] {
        Carried::Read(curve) => Ok(curve),
        Carried::Unread { reason, .. } => {
            Err(TransferError::Curve { curve: name.to_owned(), reason: reason.clone() })
        }
    }
}

/// The spline of a curve, within the tolerance or a millionth of its size.
pub(super) fn prepared(curve: &Curve, name: &str, tolerance: Option<f64>) -> Result<Prepared, TransferError> {
    let relative = || {
        let (start, end) = curve.domain();
        let at = |part: f64| curve.point_at(start + (end - start) * part);
        let size = [0.25, 0.5, 0.75, 1.0].map(|part| (at(part) - at(0.0)).norm());
        TOLERANCE * size.into_iter().fold(0.0, f64::max)
    };
    prepare(curve, name, tolerance.unwrap_or_else(relative))
}
