//! Curves in the parameter plane of a surface: `PCURVE` and what its representation holds.

use super::curve::{knots_and_weights, positive};
use super::error::ReadError;
use super::placement::{frame2, point2, vector2};
use super::scope::Scope;
use crate::geometry::nurbs::{NurbsCurve, NurbsCurve2};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::Vector2;
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::{EntityView, real, reference};

/// Model parameters per file parameter of a surface: angles are radians in the model, lengths are as in
/// the file.
///
/// `radians` is the angle unit of the file. The curve of a swept surface counts in angles when it is a
/// conic.
#[must_use]
pub fn parameter_scale(surface: &Surface, radians: f64) -> [f64; 2] {
    let of_curve = |curve: &Curve| match curve {
        Curve::Circle { .. } | Curve::Ellipse { .. } => radians,
        Curve::Line { .. } | Curve::Nurbs(_) => 1.0,
    };
    match surface {
        Surface::Plane(_) | Surface::Nurbs(_) => [1.0, 1.0],
        Surface::Cylinder { .. } | Surface::Cone { .. } => [radians, 1.0],
        Surface::Sphere { .. } | Surface::Torus { .. } => [radians, radians],
        Surface::LinearExtrusion { curve, .. } => [of_curve(curve), 1.0],
        Surface::Revolution { curve, .. } => [radians, of_curve(curve)],
    }
}

/// The curve of a `PCURVE`, in model parameters.
pub(super) fn read(scope: Scope<'_>, name: InstanceName, scale: [f64; 2]) -> Result<Curve2d, ReadError> {
    let pcurve = scope.view_of(name, Entity::Pcurve)?;
    let holder = scope.view_of(pcurve.reference("reference_to_curve")?, Entity::Representation)?;
    let item = holder.references("items")?.next().ok_or(ReadError::Empty { attribute: "items" })?;
    let view = scope.view_of(item, Entity::Curve)?;
    match view.entity() {
        Entity::Line => line(scope, &view, scale),
        Entity::Circle | Entity::Ellipse => conic(scope, &view, scale),
        _ if view.is(Entity::BSplineCurve) => spline(scope, &view, scale).map(Curve2d::Nurbs),
        _ => Err(ReadError::NotReadYet),
    }
}

fn line(scope: Scope<'_>, view: &EntityView<'_>, [su, sv]: [f64; 2]) -> Result<Curve2d, ReadError> {
    let [pnt, dir] = view.fields(["pnt", "dir"]);
    let mut origin = point2(scope, reference(pnt, "pnt")?)?;
    let direction = vector2(scope, reference(dir, "dir")?)?;
    origin.x *= su;
    origin.y *= sv;
    Ok(Curve2d::Line { origin, direction: Vector2::new(direction.x * su, direction.y * sv) })
}

/// A circle or ellipse. Where angles and lengths are scaled differently its image is an ellipse of other
/// axes; nobody has shown a file with one, so it is not read.
fn conic(scope: Scope<'_>, view: &EntityView<'_>, [su, sv]: [f64; 2]) -> Result<Curve2d, ReadError> {
    if su.to_bits() != sv.to_bits() {
        return Err(ReadError::NotReadYet);
    }
    let (center, x) = frame2(scope, view.reference("position")?)?;
    let [radius, first, second] = view.fields(["radius", "semi_axis_1", "semi_axis_2"]);
    let (first, second) = match view.entity() {
        Entity::Circle => {
            let radius = positive(real(radius, "radius")?, "radius")?;
            (radius, radius)
        }
        _ => (
            positive(real(first, "semi_axis_1")?, "semi_axis_1")?,
            positive(real(second, "semi_axis_2")?, "semi_axis_2")?,
        ),
    };
    Ok(Curve2d::Ellipse {
        center: center * su,
        x,
        y: Vector2::new(-x.y, x.x),
        semi_axis_1: first * su,
        semi_axis_2: second * su,
    })
}

fn spline(scope: Scope<'_>, view: &EntityView<'_>, [su, sv]: [f64; 2]) -> Result<NurbsCurve2, ReadError> {
    let mut points = Vec::new();
    for member in view.list("control_points_list")? {
        let point = point2(scope, reference(Some(member), "control_points_list")?)?;
        points.push([point.x * su, point.y * sv, 1.0]);
    }
    let knots = knots_and_weights(view, &mut points)?;
    Ok(NurbsCurve::new(knots, points)?.clamped())
}
