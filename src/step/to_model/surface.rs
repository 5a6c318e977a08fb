//! Surfaces: ISO 10303-42 chapter 4.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::bounded_curve::{Nest, interval, within};
use super::curve::{self, Trims, positive};
use super::curve2d::parameter_scale;
use super::error::ReadError;
use super::placement::{frame, point3, vector3};
use super::scope::Scope;
use super::spline::{Form, WrittenKnots, apply_weights, implied_knots};
use super::transformation::placing;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::geometry::{Curve, Patch, PatchGrid, Surface};
use crate::step::entity::Entity;
use crate::step::view::{EntityView, boolean, count, list, real, reference};
use crate::step::{InstanceName, Parameter};

/// Reads a surface.
pub(super) fn read(scope: Scope<'_>, name: InstanceName) -> Result<Surface, ReadError> {
    read_nested(scope, name, Nest::new(&Nest::budget()))
}

fn read_nested(scope: Scope<'_>, name: InstanceName, nest: Nest<'_>) -> Result<Surface, ReadError> {
    let view = scope.view(name)?;
    match view.entity() {
        Entity::OffsetSurface => {
            let distance = view.real("distance")?;
            Ok(Surface::Offset { basis: basis(scope, &view, nest)?, distance })
        }
        Entity::RectangularTrimmedSurface => trimmed(scope, &view, nest),
        Entity::CurveBoundedSurface => Ok(Surface::CurveBounded { basis: basis(scope, &view, nest)? }),
        Entity::RectangularCompositeSurface => composite(scope, &view, nest),
        Entity::SurfaceReplica => replica(scope, &view, nest),
        Entity::Plane => Ok(Surface::Plane(frame(scope, view.reference("position")?)?)),
        Entity::CylindricalSurface | Entity::SphericalSurface => round(scope, &view),
        Entity::ConicalSurface => cone(scope, &view),
        Entity::ToroidalSurface => torus(scope, &view),
        Entity::DegenerateToroidalSurface => degenerate_torus(scope, &view),
        Entity::SurfaceOfLinearExtrusion => {
            let direction = vector3(scope, view.reference("extrusion_axis")?)?;
            Ok(Surface::LinearExtrusion { curve: swept(scope, &view)?, direction })
        }
        Entity::SurfaceOfRevolution => {
            let frame = frame(scope, view.reference("axis_position")?)?;
            Ok(Surface::Revolution { curve: swept(scope, &view)?, frame })
        }
        _ if view.is(Entity::BSplineSurface) => spline(scope, &view).map(Surface::Nurbs),
        _ if view.is(Entity::Surface) => Err(ReadError::NotReadYet),
        found => {
            let found = found.name().to_owned();
            Err(ReadError::WrongEntity { name, found, expected: Entity::Surface.name() })
        }
    }
}

fn round(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Surface, ReadError> {
    let [position, radius] = view.fields(["position", "radius"]);
    let radius = positive(real(radius, "radius")?, "radius")?;
    let frame = frame(scope, reference(position, "position")?)?;
    Ok(match view.entity() {
        Entity::SphericalSurface => Surface::Sphere { frame, radius },
        _ => Surface::Cylinder { frame, radius },
    })
}

fn cone(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Surface, ReadError> {
    let [position, radius, semi_angle] = view.fields(["position", "radius", "semi_angle"]);
    let radius = real(radius, "radius")?;
    if radius < 0.0 {
        return Err(ReadError::NotPositive { attribute: "radius", value: radius });
    }
    let radians = real(semi_angle, "semi_angle")? * scope.radians;
    if radians == 0.0 || radians.abs() >= FRAC_PI_2 {
        return Err(ReadError::SemiAngle { radians });
    }
    let frame = frame(scope, reference(position, "position")?)?;
    Ok(Surface::Cone { frame, radius, semi_angle: radians })
}

fn torus(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Surface, ReadError> {
    let [position, major, minor] = view.fields(["position", "major_radius", "minor_radius"]);
    Ok(Surface::Torus {
        frame: frame(scope, reference(position, "position")?)?,
        major_radius: positive(real(major, "major_radius")?, "major_radius")?,
        minor_radius: positive(real(minor, "minor_radius")?, "minor_radius")?,
    })
}

/// A torus that meets itself on its axis: of the two parts between the poles the one that is asked for.
fn degenerate_torus(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Surface, ReadError> {
    let torus = torus(scope, view)?;
    let Surface::Torus { major_radius, minor_radius, .. } = torus else { return Ok(torus) };
    if major_radius >= minor_radius {
        return Ok(torus);
    }
    let pole = (-major_radius / minor_radius).acos();
    let v = if view.boolean("select_outer")? { (-pole, pole) } else { (pole, TAU - pole) };
    Ok(Surface::Trimmed { basis: Box::new(torus), u: (0.0, TAU), v, forward: [true; 2] })
}

/// The surface that another is made of; a failure names it.
fn basis(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Box<Surface>, ReadError> {
    part(scope, view, "basis_surface", nest).map(Box::new)
}

fn part(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    attribute: &'static str,
    nest: Nest<'_>,
) -> Result<Surface, ReadError> {
    let name = view.reference(attribute)?;
    nest.inner(name)
        .and_then(|nest| read_nested(scope, name, nest))
        .map_err(|source| within(scope, attribute, name, source))
}

/// A `RECTANGULAR_TRIMMED_SURFACE`; its trims count in the file's units of angle where the parameter is one.
fn trimmed(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Surface, ReadError> {
    let basis = basis(scope, view, nest)?;
    let [u1, u2, v1, v2, usense, vsense] = view.fields(["u1", "u2", "v1", "v2", "usense", "vsense"]);
    let [su, sv] = parameter_scale(&basis, scope.radians);
    let (us, vs) = basis.domain();
    let (pu, pv) = basis.periods();
    let forward = [boolean(usense, "usense")?, boolean(vsense, "vsense")?];
    let u = interval([real(u1, "u1")? * su, real(u2, "u2")? * su], forward[0], us, pu)?;
    let v = interval([real(v1, "v1")? * sv, real(v2, "v2")? * sv], forward[1], vs, pv)?;
    Ok(Surface::Trimmed { basis, u, v, forward })
}

/// A `RECTANGULAR_COMPOSITE_SURFACE`: a list of patches along `v` for each step of `u`.
fn composite(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Surface, ReadError> {
    let attribute = "segments";
    let mut patches = Vec::new();
    let mut rows = 0;
    for (at, column) in view.list(attribute)?.enumerate() {
        let before = patches.len();
        for member in list(Some(column), attribute)? {
            let patch = scope.view_of(reference(Some(member), attribute)?, Entity::SurfacePatch)?;
            let [u, v] = patch.fields(["u_sense", "v_sense"]);
            let forward = [boolean(u, "u_sense")?, boolean(v, "v_sense")?];
            patches.push(Patch { surface: part(scope, &patch, "parent_surface", nest)?, forward });
        }
        let found = patches.len() - before;
        if at == 0 {
            rows = found;
        }
        if found != rows {
            return Err(ReadError::RaggedNet { row: at, expected: rows, found });
        }
    }
    PatchGrid::new(patches, rows).map(Surface::Composite).ok_or(ReadError::Unbounded { attribute })
}

/// A `SURFACE_REPLICA`: the parent's image under a scale, turn, mirror and shift.
fn replica(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Surface, ReadError> {
    let parent = part(scope, view, "parent_surface", nest)?;
    let name = view.reference("transformation")?;
    let map = placing(scope, name)?;
    parent.replica(&map).map_err(|_| ReadError::Coordinates(name))
}

fn swept(scope: Scope<'_>, view: &EntityView<'_>) -> Result<Box<Curve>, ReadError> {
    let (name, _) = curve::resolve(scope, view.reference("swept_curve")?, Trims::Follow)?;
    let curve = curve::read(scope, name).map_err(|source| within(scope, "swept_curve", name, source))?;
    Ok(Box::new(curve))
}

/// A B-spline surface of any form, with weights or without.
fn spline(scope: Scope<'_>, view: &EntityView<'_>) -> Result<NurbsSurface, ReadError> {
    let [u_degree, v_degree, net] = view.fields(["u_degree", "v_degree", "control_points_list"]);
    let degrees = [count(u_degree, "u_degree")?, count(v_degree, "v_degree")?];
    let mut points = Vec::new();
    let (mut rows, mut columns) = (0, 0);
    for row in list(net, "control_points_list")? {
        let before = points.len();
        for member in list(Some(row), "control_points_list")? {
            let point = point3(scope, reference(Some(member), "control_points_list")?)?;
            points.push([point.x, point.y, point.z, 1.0]);
        }
        let found = points.len() - before;
        if rows == 0 {
            columns = found;
        }
        if found != columns {
            return Err(ReadError::RaggedNet { row: rows, expected: columns, found });
        }
        rows += 1;
    }
    let [knots_u, knots_v] = knots(view, degrees, [rows, columns])?;
    if view.is(Entity::RationalBSplineSurface) {
        let weights = view.list("weights_data")?.filter_map(|row| row.as_list()).flatten();
        apply_weights(&mut points, weights.map(|weight: Parameter<'_>| weight.as_f64().unwrap_or(f64::NAN)))?;
    }
    Ok(NurbsSurface::new(knots_u, knots_v, points)?.clamped())
}

fn knots(
    view: &EntityView<'_>,
    degrees: [usize; 2],
    counts: [usize; 2],
) -> Result<[KnotVector; 2], ReadError> {
    match Form::of(view) {
        None => Err(ReadError::NotReadYet),
        Some(Form::WithKnots) => {
            let [mu, mv, ku, kv] =
                view.fields(["u_multiplicities", "v_multiplicities", "u_knots", "v_knots"]);
            let u = WrittenKnots {
                multiplicities: list(mu, "u_multiplicities")?,
                knots: list(ku, "u_knots")?,
                direction: " in u",
            };
            let v = WrittenKnots {
                multiplicities: list(mv, "v_multiplicities")?,
                knots: list(kv, "v_knots")?,
                direction: " in v",
            };
            Ok([u.read(degrees[0], counts[0])?, v.read(degrees[1], counts[1])?])
        }
        Some(form) => {
            Ok([implied_knots(form, degrees[0], counts[0])?, implied_knots(form, degrees[1], counts[1])?])
        }
    }
}
