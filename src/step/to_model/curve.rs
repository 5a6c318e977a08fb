//! Curves in space: ISO 10303-42 chapter 4.

use super::bounded_curve::{self, Nest};
use super::error::ReadError;
use super::placement::{frame, point3, vector3};
use super::scope::Scope;
use super::spline::{Form, WrittenKnots, apply_weights, implied_knots};
use crate::geometry::Curve;
use crate::geometry::nurbs::{KnotVector, NurbsCurve3};
use crate::math::Frame;
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::{EntityView, count, list, real, reference};

/// Curves around curves that are followed before the chain counts as a cycle.
const MAX_NESTED_CURVES: usize = 16;

/// What becomes of a trimmed curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trims {
    /// Its basis curve stands for it: vertices or face bounds say where it ends.
    Follow,
    /// It stays what it is.
    Keep,
}

/// The curve that a reference stands for: the curve in space of a surface curve, the basis of a trimmed
/// curve of the same sense, else itself.
///
/// Also gives the outermost surface curve, whose parameter-space curves count. A trimmed curve of opposite
/// sense is kept: the edge's own sense would have to change with it.
pub(super) fn resolve(
    scope: Scope<'_>,
    name: InstanceName,
    trims: Trims,
) -> Result<(InstanceName, Option<EntityView<'_>>), ReadError> {
    let mut current = name;
    let mut outermost = None;
    for _ in 0..MAX_NESTED_CURVES {
        let Ok(view) = scope.view(current) else { return Ok((current, outermost)) };
        if view.is(Entity::SurfaceCurve) {
            outermost.get_or_insert(view);
            current = view.reference("curve_3d")?;
        } else if trims == Trims::Follow
            && view.is(Entity::TrimmedCurve)
            && view.boolean("sense_agreement")?
        {
            current = view.reference("basis_curve")?;
        } else {
            return Ok((current, outermost));
        }
    }
    Err(ReadError::Cycle(name))
}

/// Reads a curve that is no surface curve.
pub(super) fn read(scope: Scope<'_>, name: InstanceName) -> Result<Curve, ReadError> {
    read_nested(scope, name, Nest::new(&Nest::budget()))
}

/// As [`read`], for a curve within others.
pub(super) fn read_nested(scope: Scope<'_>, name: InstanceName, nest: Nest<'_>) -> Result<Curve, ReadError> {
    let view = scope.view(name)?;
    match view.entity() {
        Entity::Line => line(scope, &view),
        Entity::Circle => circle(scope, &view),
        Entity::Ellipse => ellipse(scope, &view),
        Entity::Parabola => parabola(scope, &view),
        Entity::Hyperbola => hyperbola(scope, &view),
        Entity::Polyline => polyline(scope, &view),
        Entity::TrimmedCurve => bounded_curve::trimmed(scope, &view, nest),
        Entity::OffsetCurve3d => bounded_curve::offset(scope, &view, nest),
        Entity::CurveReplica => bounded_curve::replica(scope, &view, nest),
        _ if view.is(Entity::CompositeCurve) => bounded_curve::composite(scope, &view, nest),
        _ if view.is(Entity::BSplineCurve) => spline(scope, &view).map(Curve::Nurbs),
        _ if view.is(Entity::Curve) => Err(ReadError::NotReadYet),
        found => Err(ReadError::WrongEntity {
            name,
            found: found.name().to_owned(),
            expected: Entity::Curve.name(),
        }),
    }
}

fn line(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let [pnt, dir] = view.fields(["pnt", "dir"]);
    let origin = point3(scope, reference(pnt, "pnt")?)?;
    Ok(Curve::Line { origin, direction: vector3(scope, reference(dir, "dir")?)? })
}

fn circle(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let [position, radius] = view.fields(["position", "radius"]);
    let radius = positive(real(radius, "radius")?, "radius")?;
    Ok(Curve::Circle { frame: frame(scope, reference(position, "position")?)?, radius })
}

fn ellipse(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let [position, first, second] = view.fields(["position", "semi_axis_1", "semi_axis_2"]);
    Ok(Curve::Ellipse {
        frame: frame(scope, reference(position, "position")?)?,
        semi_axis_1: positive(real(first, "semi_axis_1")?, "semi_axis_1")?,
        semi_axis_2: positive(real(second, "semi_axis_2")?, "semi_axis_2")?,
    })
}

fn parabola(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let [position, focal] = view.fields(["position", "focal_dist"]);
    let (frame, focal) = (frame(scope, reference(position, "position")?)?, real(focal, "focal_dist")?);
    if focal == 0.0 {
        return Err(ReadError::NotPositive { attribute: "focal_dist", value: focal });
    }
    // A negative distance, which the standard allows, opens the curve the other way: both axes turn.
    let turned = Frame { x: -frame.x, y: -frame.y, ..frame };
    let frame = if focal < 0.0 { turned } else { frame };
    Ok(Curve::Parabola { frame, focal_distance: focal.abs() })
}

fn hyperbola(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let [position, real_axis, imaginary] = view.fields(["position", "semi_axis", "semi_imag_axis"]);
    Ok(Curve::Hyperbola {
        frame: frame(scope, reference(position, "position")?)?,
        semi_axis: positive(real(real_axis, "semi_axis")?, "semi_axis")?,
        semi_imaginary_axis: positive(real(imaginary, "semi_imag_axis")?, "semi_imag_axis")?,
    })
}

fn polyline(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve, ReadError> {
    let mut points = Vec::new();
    for name in view.references("points")? {
        let point = point3(scope, name)?;
        points.push([point.x, point.y, point.z, 1.0]);
    }
    Ok(Curve::Polyline(NurbsCurve3::new(polyline_knots(points.len())?, points)?))
}

/// Knots 0, 1, 2, … of a polyline.
pub(super) fn polyline_knots(points: usize) -> Result<KnotVector, ReadError> {
    let spans = points.checked_sub(1).filter(|&n| n > 0).ok_or(ReadError::Empty { attribute: "points" })?;
    Ok(KnotVector::clamped_uniform(1, spans, 0.0, spans as f64)?)
}

/// A B-spline curve of any form, with weights or without.
fn spline(scope: Scope<'_>, view: &EntityView<'_>) -> Result<NurbsCurve3, ReadError> {
    let members = view.list("control_points_list")?;
    let mut points = Vec::new();
    for member in members {
        let point = point3(scope, reference(Some(member), "control_points_list")?)?;
        points.push([point.x, point.y, point.z, 1.0]);
    }
    let knots = knots_and_weights(view, &mut points)?;
    Ok(NurbsCurve3::new(knots, points)?.clamped())
}

/// Knots of a B-spline curve in space or in the plane; multiplies the points by their weights.
pub(super) fn knots_and_weights<const H: usize>(
    view: &EntityView<'_>,
    points: &mut [[f64; H]],
) -> Result<KnotVector, ReadError> {
    let [degree, multiplicities, knots, weights] =
        view.fields(["degree", "knot_multiplicities", "knots", "weights_data"]);
    let degree = count(degree, "degree")?;
    let knots = match Form::of(view) {
        None => return Err(ReadError::NotReadYet),
        Some(Form::WithKnots) => WrittenKnots {
            multiplicities: list(multiplicities, "knot_multiplicities")?,
            knots: list(knots, "knots")?,
            direction: "",
        }
        .read(degree, points.len())?,
        Some(form) => implied_knots(form, degree, points.len())?,
    };
    if view.is(Entity::RationalBSplineCurve) {
        let weights = list(weights, "weights_data")?;
        apply_weights(points, weights.map(|weight| weight.as_f64().unwrap_or(f64::NAN)))?;
    }
    Ok(knots)
}

/// A number that must be above zero.
pub(super) fn positive(value: f64, attribute: &'static str) -> Result<f64, ReadError> {
    if value > 0.0 { Ok(value) } else { Err(ReadError::NotPositive { attribute, value }) }
}
