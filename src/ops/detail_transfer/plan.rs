//! From curves and faces of models to a change set.

use super::error::TransferError;
use super::face;
use super::on_curve::{self, name, prepared, read};
use super::params::{Params, Plan, Source, Target};
use super::prepare::Prepared;
use super::spline::Spline;
use crate::math::Affine;
use crate::model::Model;
use crate::ops::OperationError;

/// Plans a transfer.
///
/// # Errors
/// [`OperationError::Transfer`]; for faces [`OperationError::NoParameterLoops`] too.
pub fn plan(model: &Model, params: &Params<'_>) -> Result<Plan, OperationError> {
    let source_name = match params.source {
        Source::Curve(model, curve) => name(model, curve),
        Source::Spline(_, name) => name.to_owned(),
    };
    let source = prepared_source(params, &source_name)?;
    match &params.target {
        Target::Curve(curve) => Ok(on_curve::plan(model, params, *curve, &source, &source_name)?),
        Target::Face(target) => face::plan(model, params, target, &source, &source_name),
    }
}

/// The source in the units of the target.
fn prepared_source(params: &Params<'_>, name: &str) -> Result<Prepared, TransferError> {
    let (model, curve) = match params.source {
        Source::Curve(model, curve) => (model, curve),
        Source::Spline(spline, _) => {
            let points = spline.points.iter().map(|p| p.map(|c| c * params.source_unit)).collect();
            return Ok(Prepared { spline: Spline { knots: spline.knots.clone(), points }, deviation: 0.0 });
        }
    };
    let curve = read(model, curve, name)?;
    if params.source_unit.to_bits() == 1.0f64.to_bits() {
        return prepared(curve, name, params.tolerance);
    }
    let scaled = curve.transformed(&Affine::scale(params.source_unit)).map_err(|_| TransferError::Curve {
        curve: name.to_owned(),
        reason: "it cannot be brought to the units of the target".to_owned(),
    })?;
    prepared(&scaled, name, params.tolerance)
}
