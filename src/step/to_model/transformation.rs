//! Transformations between representations: ISO 10303-43 clause 5 and the operators of ISO 10303-42 clause 4.

use super::error::ReadError;
use super::placement::{direction3, frame, point3};
use super::scope::Scope;
use crate::math::{Affine, Frame, Matrix3, Vector3};
use crate::step::entity::Entity;
use crate::step::view::EntityView;
use crate::step::{InstanceName, Parameter};

/// Sine of the angle between two unit axes below which they count as one: no third can be taken from them.
const PARALLEL: f64 = 1e-12;

/// From coordinates in the space that an item is in to that of what it places: a frame, or an operator.
///
/// For a frame, from coordinates in the frame; for an operator, what it does.
pub(super) fn placing(scope: Scope<'_>, name: InstanceName) -> Result<Affine, ReadError> {
    match scope.view(name) {
        Ok(view) if view.is(Entity::CartesianTransformationOperator) => operator(scope, &view),
        _ => Ok(Affine::from_frame(&frame(scope, name)?)),
    }
}

/// The inverse of a [`placing`].
pub(super) fn placing_back(scope: Scope<'_>, name: InstanceName) -> Result<Affine, ReadError> {
    placing(scope, name)?.inverse().ok_or(ReadError::Coordinates(name))
}

/// A `CARTESIAN_TRANSFORMATION_OPERATOR_3D`: its axes by the standard's `base_axis`, times its scale, and its
/// origin.
///
/// Files differ in how many names they write before the axes, so the attributes are counted from the end.
fn operator(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Affine, ReadError> {
    let [axis1, axis2, origin, scale, axis3] = operator_fields(view);
    let direction = |field: Option<Parameter<'_>>| {
        field.and_then(|field| field.as_reference()).map(|name| direction3(scope, name)).transpose()
    };
    let origin = origin.and_then(|field| field.as_reference()).ok_or(ReadError::Coordinates(view.name()))?;
    let scale = scale.and_then(|field| field.as_f64()).unwrap_or(1.0);
    if !(scale.is_finite() && scale > 0.0) {
        return Err(ReadError::NotPositive { attribute: "scale", value: scale });
    }
    let axes = axes(direction(axis1)?, direction(axis2)?, direction(axis3)?);
    let linear = axes.ok_or(ReadError::Coordinates(view.name()))? * scale;
    Ok(Affine { linear, translation: point3(scope, origin)?.coords })
}

fn operator_fields<'a>(view: &EntityView<'a>) -> [Option<Parameter<'a>>; 5] {
    if view.instance().is_complex() {
        return view.fields(["axis1", "axis2", "local_origin", "scale", "axis3"]);
    }
    let all: Vec<Parameter<'a>> =
        view.instance().records().next().map(|record| record.parameters().collect()).unwrap_or_default();
    let first = all.len().saturating_sub(5);
    let mut last = all.into_iter().skip(first);
    std::array::from_fn(|_| last.next())
}

/// `base_axis` of ISO 10303-42 in three dimensions: the second axis may make the system left-handed.
fn axes(
    first: Option<Vector3<f64>>,
    second: Option<Vector3<f64>>,
    third: Option<Vector3<f64>>,
) -> Option<Matrix3<f64>> {
    let third = third.or_else(|| first.zip(second).and_then(|(x, y)| x.cross(&y).try_normalize(PARALLEL)));
    let base = Frame::from_axis(crate::math::Point3::origin(), third.unwrap_or_else(Vector3::z), first)?;
    let turned = second.is_some_and(|second| second.dot(&base.y) < 0.0);
    Some(Matrix3::from_columns(&[base.x, if turned { -base.y } else { base.y }, base.z]))
}
