//! Curves in the parameter plane of a surface: `PCURVE` and what its representation holds.

use super::bounded_curve::{self, Nest};
use super::curve::{knots_and_weights, polyline_knots, positive};
use super::error::ReadError;
use super::placement::{frame2, point2, vector2};
use super::scope::Scope;
use crate::geometry::nurbs::{NurbsCurve, NurbsCurve2};
use crate::geometry::{Composite, Curve, Curve2d, Segment, Surface, Trimmed};
use crate::math::{Frame, Point2, Point3, Vector2, Vector3};
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::{EntityView, real, reference};

/// Model parameters per file parameter of a curve.
pub(super) fn of_curve(curve: &Curve, radians: f64) -> f64 {
    match curve {
        Curve::Circle { .. } | Curve::Ellipse { .. } => radians,
        Curve::Trimmed(piece) => of_curve(&piece.basis, radians),
        Curve::Offset { basis, .. } => of_curve(basis, radians),
        // The parameter of a composite is a sum of lengths of intervals, which need not be all of one unit.
        Curve::Line { .. }
        | Curve::Parabola { .. }
        | Curve::Hyperbola { .. }
        | Curve::Nurbs(_)
        | Curve::Polyline(_)
        | Curve::Composite(_) => 1.0,
    }
}

/// Model parameters per file parameter of a surface: angles are radians in the model, lengths are as in
/// the file.
///
/// `radians` is the angle unit of the file. The curve of a swept surface counts in angles when it is a
/// conic.
#[must_use]
pub fn parameter_scale(surface: &Surface, radians: f64) -> [f64; 2] {
    match surface {
        Surface::Plane(_) | Surface::Nurbs(_) => [1.0, 1.0],
        Surface::Cylinder { .. } | Surface::Cone { .. } => [radians, 1.0],
        Surface::Sphere { .. } | Surface::Torus { .. } => [radians, radians],
        Surface::LinearExtrusion { curve, .. } => [of_curve(curve, radians), 1.0],
        Surface::Revolution { curve, .. } => [radians, of_curve(curve, radians)],
        Surface::Offset { basis, .. } | Surface::Trimmed { basis, .. } | Surface::CurveBounded { basis } => {
            parameter_scale(basis, radians)
        }
        Surface::Composite(_) => [1.0, 1.0],
    }
}

/// The curve of a `PCURVE`, in model parameters.
pub(super) fn read(scope: Scope<'_>, name: InstanceName, scale: [f64; 2]) -> Result<Curve2d, ReadError> {
    let pcurve = scope.view_of(name, Entity::Pcurve)?;
    let holder = scope.view_of(pcurve.reference("reference_to_curve")?, Entity::Representation)?;
    let item = holder.references("items")?.next().ok_or(ReadError::Empty { attribute: "items" })?;
    let curve = read_unscaled(scope, item, Nest::new(&Nest::budget()))?;
    Ok(scaled(curve, scale))
}

/// A curve in the parameters of the file.
pub(super) fn read_unscaled(
    scope: Scope<'_>,
    name: InstanceName,
    nest: Nest<'_>,
) -> Result<Curve2d, ReadError> {
    let view = scope.view_of(name, Entity::Curve)?;
    match view.entity() {
        Entity::Line => line(scope, &view),
        Entity::Circle | Entity::Ellipse => ellipse(scope, &view),
        Entity::Parabola => parabola(scope, &view),
        Entity::Hyperbola => hyperbola(scope, &view),
        Entity::Polyline => polyline(scope, &view),
        Entity::TrimmedCurve => bounded_curve::trimmed2d(scope, &view, nest),
        Entity::OffsetCurve2d => bounded_curve::offset2d(scope, &view, nest),
        _ if view.is(Entity::CompositeCurve) => bounded_curve::composite2d(scope, &view, nest),
        _ if view.is(Entity::BSplineCurve) => spline(scope, &view).map(Curve2d::Nurbs),
        _ => Err(ReadError::NotReadYet),
    }
}

/// The curve with its coordinates in model parameters; of the same kind where it has one.
fn scaled(curve: Curve2d, factors: [f64; 2]) -> Curve2d {
    let [su, sv] = factors;
    let stay = 1f64.to_bits();
    if su.to_bits() == stay && sv.to_bits() == stay {
        return curve;
    }
    match curve {
        Curve2d::Line { origin, direction } => Curve2d::Line {
            origin: Point2::new(origin.x * su, origin.y * sv),
            direction: Vector2::new(direction.x * su, direction.y * sv),
        },
        Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } if su.to_bits() == sv.to_bits() => {
            let (semi_axis_1, semi_axis_2) = (semi_axis_1 * su, semi_axis_2 * su);
            Curve2d::Ellipse { center: center * su, x, y, semi_axis_1, semi_axis_2 }
        }
        Curve2d::Nurbs(curve) => match stretched(&curve, factors) {
            Some(image) => Curve2d::Nurbs(image),
            None => Curve2d::Scaled { basis: Box::new(Curve2d::Nurbs(curve)), factors },
        },
        basis => Curve2d::Scaled { basis: Box::new(basis), factors },
    }
}

/// `None` where a coordinate is no longer finite.
fn stretched(curve: &NurbsCurve2, [su, sv]: [f64; 2]) -> Option<NurbsCurve2> {
    let points = curve.points().iter().map(|p| [p[0] * su, p[1] * sv, p[2]]).collect();
    NurbsCurve::new(curve.knots().clone(), points).ok()
}

/// The curve in the plane `z = 0`, with the same parameters.
pub(super) fn in_space(curve: &Curve2d) -> Curve {
    let at = |p: &Point2<f64>| Point3::new(p.x, p.y, 0.0);
    let along = |v: &Vector2<f64>| Vector3::new(v.x, v.y, 0.0);
    let frame = |origin: &Point2<f64>, x: &Vector2<f64>| Frame {
        origin: at(origin),
        x: along(x),
        y: Vector3::new(-x.y, x.x, 0.0),
        z: Vector3::z(),
    };
    let lifted = |curve: &NurbsCurve2| {
        let points = curve.points().iter().map(|p| [p[0], p[1], 0.0, p[2]]).collect();
        NurbsCurve::new(curve.knots().clone(), points).expect("the net of a curve, with zeros")
    };
    match curve {
        Curve2d::Line { origin, direction } => {
            Curve::Line { origin: at(origin), direction: along(direction) }
        }
        Curve2d::Ellipse { center, x, semi_axis_1, semi_axis_2, .. } => {
            Curve::Ellipse { frame: frame(center, x), semi_axis_1: *semi_axis_1, semi_axis_2: *semi_axis_2 }
        }
        Curve2d::Parabola { vertex, x, focal_distance } => {
            Curve::Parabola { frame: frame(vertex, x), focal_distance: *focal_distance }
        }
        Curve2d::Hyperbola { center, x, semi_axis, semi_imaginary_axis } => Curve::Hyperbola {
            frame: frame(center, x),
            semi_axis: *semi_axis,
            semi_imaginary_axis: *semi_imaginary_axis,
        },
        Curve2d::Nurbs(curve) => Curve::Nurbs(lifted(curve)),
        Curve2d::Polyline(curve) => Curve::Polyline(lifted(curve)),
        Curve2d::Trimmed(Trimmed { basis, start, end, forward }) => {
            let basis = Box::new(in_space(basis));
            Curve::Trimmed(Trimmed { basis, start: *start, end: *end, forward: *forward })
        }
        Curve2d::Composite(whole) => {
            let segments = whole.segments().iter().map(|segment| Segment {
                curve: in_space(&segment.curve),
                domain: segment.domain,
                forward: segment.forward,
            });
            Curve::Composite(Composite::new(segments.collect()).expect("the intervals of a composite"))
        }
        Curve2d::Offset { basis, distance } => {
            Curve::Offset { basis: Box::new(in_space(basis)), distance: *distance, direction: Vector3::z() }
        }
        // Only the outermost curve of a record is scaled.
        Curve2d::Scaled { basis, .. } => in_space(basis),
    }
}

fn line(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve2d, ReadError> {
    let [pnt, dir] = view.fields(["pnt", "dir"]);
    let origin = point2(scope, reference(pnt, "pnt")?)?;
    Ok(Curve2d::Line { origin, direction: vector2(scope, reference(dir, "dir")?)? })
}

fn ellipse(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve2d, ReadError> {
    let (center, x) = frame2(scope, view.reference("position")?)?;
    let [radius, first, second] = view.fields(["radius", "semi_axis_1", "semi_axis_2"]);
    let (semi_axis_1, semi_axis_2) = match view.entity() {
        Entity::Circle => {
            let radius = positive(real(radius, "radius")?, "radius")?;
            (radius, radius)
        }
        _ => (
            positive(real(first, "semi_axis_1")?, "semi_axis_1")?,
            positive(real(second, "semi_axis_2")?, "semi_axis_2")?,
        ),
    };
    Ok(Curve2d::Ellipse { center, x, y: Vector2::new(-x.y, x.x), semi_axis_1, semi_axis_2 })
}

fn parabola(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve2d, ReadError> {
    let (vertex, x) = frame2(scope, view.reference("position")?)?;
    let focal = view.real("focal_dist")?;
    if focal == 0.0 {
        return Err(ReadError::NotPositive { attribute: "focal_dist", value: focal });
    }
    let x = if focal < 0.0 { -x } else { x };
    Ok(Curve2d::Parabola { vertex, x, focal_distance: focal.abs() })
}

fn hyperbola(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve2d, ReadError> {
    let (center, x) = frame2(scope, view.reference("position")?)?;
    Ok(Curve2d::Hyperbola {
        center,
        x,
        semi_axis: positive(view.real("semi_axis")?, "semi_axis")?,
        semi_imaginary_axis: positive(view.real("semi_imag_axis")?, "semi_imag_axis")?,
    })
}

fn polyline(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Curve2d, ReadError> {
    let mut points = Vec::new();
    for name in view.references("points")? {
        let point = point2(scope, name)?;
        points.push([point.x, point.y, 1.0]);
    }
    Ok(Curve2d::Polyline(NurbsCurve::new(polyline_knots(points.len())?, points)?))
}

fn spline(scope: Scope<'_>, view: &EntityView<'_>) -> Result<NurbsCurve2, ReadError> {
    let mut points = Vec::new();
    for member in view.list("control_points_list")? {
        let point = point2(scope, reference(Some(member), "control_points_list")?)?;
        points.push([point.x, point.y, 1.0]);
    }
    let knots = knots_and_weights(view, &mut points)?;
    Ok(NurbsCurve::new(knots, points)?.clamped())
}
