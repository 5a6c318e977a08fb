//! Surfaces (IGES 5.3 sections 4.12 to 4.19, 4.24, 4.30 and 4.50 to 4.54), and how their parameters in the file lead
//! to those of the model.

use super::curve::{self, in_entity};
use super::error::ReadError;
use super::ruled::{self, Pace};
use super::scope::{MAX_DEPTH, Scope, kind};
use super::spline::{self, Rectangle};
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::transform::ParameterMap;
use crate::geometry::{Curve, Surface};
use crate::iges::{Entity, EntityView, EntryNumber};
use crate::math::{Affine, Frame, Matrix2, Point3, Vector2, Vector3};
use std::f64::consts::{PI, TAU};

/// A surface entity as the model has it.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::iges) struct SurfaceRead {
    pub(in crate::iges) surface: Surface,
    /// The rectangle that the entity is, in the model's parameters; `None` where it is endless or closed in itself.
    pub(in crate::iges) bounds: Option<Rectangle>,
    /// From the file's parameters to the model's. The first is what the standard says; files have the others too. None for
    /// a surface without parameters.
    pub(in crate::iges) parameters: Vec<ParameterMap>,
    /// Whether the normal by the file's parameters is against the model's.
    pub(in crate::iges) turned: bool,
    /// How far the surface is from the one that the file means; `None` where it is that.
    pub(in crate::iges) off: Option<f64>,
}

impl SurfaceRead {
    fn new(surface: Surface) -> Self {
        Self { surface, bounds: None, parameters: vec![ParameterMap::identity()], turned: false, off: None }
    }

    fn placed(self, map: &Affine) -> Result<Self, ReadError> {
        if map.is_identity() {
            return Ok(self);
        }
        let image = |error: crate::geometry::NotRepresentable| ReadError::Image(error.to_string());
        let moved = self.surface.parameter_map(map).map_err(image)?;
        let surface = self.surface.transformed(map).map_err(image)?;
        let mirrored = !map.keeps_orientation();
        let turned = self.turned ^ (mirrored && !self.surface.image_turns_normal(map));
        let parameters = self.parameters.iter().map(|own| composed(&moved, own)).collect();
        let bounds = self.bounds.map(|bounds| rectangle(&moved, bounds));
        Ok(Self { surface, bounds, parameters, turned, off: self.off })
    }
}

/// First `inner`, then `outer`.
pub(in crate::iges) fn composed(outer: &ParameterMap, inner: &ParameterMap) -> ParameterMap {
    ParameterMap {
        linear: outer.linear * inner.linear,
        translation: outer.linear * inner.translation + outer.translation,
    }
}

/// Image of a rectangle under a map that keeps its sides parallel.
fn rectangle(map: &ParameterMap, ((u0, u1), (v0, v1)): Rectangle) -> Rectangle {
    let corners = [(u0, v0), (u1, v1)].map(|(u, v)| map.point(&crate::math::Point2::new(u, v)));
    let sorted = |a: f64, b: f64| (a.min(b), a.max(b));
    (sorted(corners[0].x, corners[1].x), sorted(corners[0].y, corners[1].y))
}

/// The surface of an entity in the space that `within` leads to.
pub(in crate::iges) fn read(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
) -> Result<SurfaceRead, ReadError> {
    read_at(scope, number, within, MAX_DEPTH)
}

fn read_at(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
    depth: usize,
) -> Result<SurfaceRead, ReadError> {
    let placed = scope.placed(scope.instance(number)?, within)?;
    definition_at(scope, number, depth)?.placed(&placed)
}

/// The surface of an entity without its own matrix.
pub(in crate::iges) fn definition(scope: &Scope<'_>, number: EntryNumber) -> Result<SurfaceRead, ReadError> {
    definition_at(scope, number, MAX_DEPTH)
}

fn definition_at(scope: &Scope<'_>, number: EntryNumber, depth: usize) -> Result<SurfaceRead, ReadError> {
    let instance = scope.instance(number)?;
    let wrong = ReadError::WrongEntity { number, found: scope.name(number), expected: "a surface" };
    let entity = kind(instance).filter(|entity| entity.is_surface()).ok_or(wrong)?;
    let view = scope.view(number)?;
    Ok(match entity {
        Entity::Plane => plane(&view)?,
        Entity::ParametricSplineSurface => whole(spline::parametric_surface(view.fields())?),
        Entity::RationalBSplineSurface => {
            let (surface, bounds) = spline::surface(view.fields())?;
            SurfaceRead { bounds: Some(bounds), ..SurfaceRead::new(Surface::Nurbs(surface)) }
        }
        Entity::RuledSurface => ruled_surface(scope, &view)?,
        Entity::SurfaceOfRevolution => revolution(scope, &view)?,
        Entity::TabulatedCylinder => tabulated(scope, &view)?,
        Entity::OffsetSurface => offset(scope, &view, depth)?,
        _ => elementary(scope, &view, entity)?,
    })
}

fn whole(surface: NurbsSurface) -> SurfaceRead {
    let bounds = Some(surface.domain());
    SurfaceRead { bounds, ..SurfaceRead::new(Surface::Nurbs(surface)) }
}

/// `a x + b y + c z = d`, seen from the display symbol, if it lies in the plane.
fn plane(view: &EntityView<'_>) -> Result<SurfaceRead, ReadError> {
    let fields = view.fields();
    let [a, b, c, d] = fields.array("coefficients")?;
    let normal = Vector3::new(a, b, c);
    let square = normal.norm_squared();
    if !(square > 0.0 && square.is_finite()) {
        return Err(ReadError::ZeroVector { field: "coefficients" });
    }
    // Some writers leave the symbol out, counts and all.
    let symbol = Point3::from(fields.array::<3>("symbol").unwrap_or_default());
    let foot = symbol - normal * ((normal.dot(&symbol.coords) - d) / square);
    let frame =
        Frame::from_axis(foot, normal, None).ok_or(ReadError::ZeroVector { field: "coefficients" })?;
    Ok(SurfaceRead { parameters: Vec::new(), ..SurfaceRead::new(Surface::Plane(frame)) })
}

fn ruled_surface(scope: &Scope<'_>, view: &EntityView<'_>) -> Result<SurfaceRead, ReadError> {
    let side = |field: &'static str| {
        let number = view.fields().pointer(field)?;
        curve::read(scope, number, &Affine::identity()).map_err(|e| in_entity(scope, field, number, e))
    };
    let (first, second) = (side("first")?, side("second")?);
    let reversed = view.fields().integer("reversed")? == 1;
    let pace = if view.instance().entry().form == 1 { Pace::Parameter } else { Pace::Length };
    let (surface, off) = ruled::ruled([&first, &second], reversed, pace, scope.resolution)?;
    Ok(SurfaceRead { off, ..whole(surface) })
}

fn revolution(scope: &Scope<'_>, view: &EntityView<'_>) -> Result<SurfaceRead, ReadError> {
    let fields = view.fields();
    let (axis, generatrix) = (fields.pointer("axis")?, fields.pointer("generatrix")?);
    let piece = |field: &'static str, number: EntryNumber| {
        curve::read(scope, number, &Affine::identity()).map_err(|e| in_entity(scope, field, number, e))
    };
    let Curve::Line { origin, direction } = piece("axis", axis)?.curve else {
        let found = scope.name(axis);
        return Err(ReadError::WrongEntity { number: axis, found, expected: "LINE" });
    };
    let profile = piece("generatrix", generatrix)?;
    let frame = Frame::from_axis(origin, direction, None).ok_or(ReadError::ZeroVector { field: "axis" })?;
    let (from, to) = (fields.real("start_angle")?, fields.real("end_angle")?);
    let way = to - from;
    if !(way > 0.0 && way.is_finite()) {
        return Err(ReadError::EmptyRange { from, to });
    }
    // Six digits of a whole turn are one.
    let way = if way > TAU - TURN_ROUNDED { TAU } else { way };
    let bounds = ((from, from + way), profile.range);
    Ok(SurfaceRead {
        surface: Surface::Revolution { curve: Box::new(profile.curve), frame },
        bounds: Some(bounds),
        parameters: vec![swap()],
        turned: true,
        off: None,
    })
}

/// Parameters of a surface of revolution: the file counts along the profile first, the model round the axis.
pub(in crate::iges) fn swap() -> ParameterMap {
    ParameterMap { linear: Matrix2::new(0.0, 1.0, 1.0, 0.0), translation: Vector2::zeros() }
}

/// Parameters of a tabulated cylinder by the ranges of those of the model: the standard counts from 0 to 1 along the
/// directrix and along the straight line; files count as the directrix does.
pub(in crate::iges) fn along(u: (f64, f64), v: (f64, f64)) -> Vec<ParameterMap> {
    let height = v.1 - v.0;
    let unit = ParameterMap::stretch(u.1 - u.0, height, Vector2::new(u.0, v.0));
    vec![unit, ParameterMap::stretch(1.0, height, Vector2::new(0.0, v.0))]
}

/// Angle that a whole turn may lack.
const TURN_ROUNDED: f64 = 1e-5;

fn tabulated(scope: &Scope<'_>, view: &EntityView<'_>) -> Result<SurfaceRead, ReadError> {
    let number = view.fields().pointer("directrix")?;
    let directrix = curve::read(scope, number, &Affine::identity())
        .map_err(|e| in_entity(scope, "directrix", number, e))?;
    let direction = Point3::from(view.fields().array::<3>("end")?) - directrix.start();
    if !(direction.norm() > 0.0 && direction.norm().is_finite()) {
        return Err(ReadError::ZeroVector { field: "end" });
    }
    let (start, end) = directrix.range;
    Ok(SurfaceRead {
        surface: Surface::LinearExtrusion { curve: Box::new(directrix.curve), direction },
        bounds: Some(((start, end), (0.0, 1.0))),
        parameters: along((start, end), (0.0, 1.0)),
        turned: false,
        off: None,
    })
}

fn offset(scope: &Scope<'_>, view: &EntityView<'_>, depth: usize) -> Result<SurfaceRead, ReadError> {
    let fields = view.fields();
    let number = fields.pointer("surface")?;
    let depth = depth.checked_sub(1).ok_or(ReadError::Cycle(number))?;
    let basis = read_at(scope, number, &Affine::identity(), depth)
        .map_err(|e| in_entity(scope, "surface", number, e))?;
    let indicator = Vector3::from(fields.array("indicator")?);
    let middle = basis.bounds.map_or((0.0, 0.0), |((u0, u1), (v0, v1))| (0.5 * (u0 + u1), 0.5 * (v0 + v1)));
    let normal = basis.surface.normal(middle.0, middle.1);
    let side = normal.map_or(0.0, |normal| normal.dot(&indicator));
    if side == 0.0 {
        return Err(ReadError::ZeroVector { field: "indicator" });
    }
    let distance = fields.real("distance")? * side.signum();
    let surface = Surface::Offset { basis: Box::new(basis.surface.clone()), distance };
    Ok(SurfaceRead { surface, ..basis })
}

fn point(scope: &Scope<'_>, view: &EntityView<'_>, field: &'static str) -> Result<Point3<f64>, ReadError> {
    let number = view.fields().pointer(field)?;
    let at = scope.view_of(number, Entity::Point, "POINT")?;
    let point = Point3::from(at.fields().array::<3>("coordinates")?);
    Ok(scope.matrix(at.instance())?.point(&point))
}

fn direction(
    scope: &Scope<'_>,
    view: &EntityView<'_>,
    field: &'static str,
) -> Result<Vector3<f64>, ReadError> {
    let number = view.fields().pointer(field)?;
    let of = scope.view_of(number, Entity::Direction, "DIRECTION")?;
    let vector = Vector3::from(of.fields().array::<3>("components")?);
    Ok(scope.matrix(of.instance())?.vector(&vector))
}

/// Form of an elementary surface with a reference direction, and so with parameters.
const WITH_PARAMETERS: i32 = 1;

fn elementary(scope: &Scope<'_>, view: &EntityView<'_>, entity: Entity) -> Result<SurfaceRead, ReadError> {
    let fields = view.fields();
    let with_parameters = view.instance().entry().form == WITH_PARAMETERS;
    let origin = point(scope, view, "location")?;
    let axis_field = if entity == Entity::PlaneSurface { "normal" } else { "axis" };
    let axis = match entity {
        Entity::SphericalSurface if !with_parameters => Vector3::z(),
        _ => direction(scope, view, axis_field)?,
    };
    let reference = if with_parameters { Some(direction(scope, view, "reference")?) } else { None };
    let frame =
        Frame::from_axis(origin, axis, reference).ok_or(ReadError::ZeroVector { field: axis_field })?;
    let positive = |field: &'static str| {
        let value = fields.real(field)?;
        if value > 0.0 { Ok(value) } else { Err(ReadError::NotPositive { field, value }) }
    };
    let surface = match entity {
        Entity::PlaneSurface => Surface::Plane(frame),
        Entity::CylindricalSurface => Surface::Cylinder { frame, radius: positive("radius")? },
        Entity::ConicalSurface => {
            let (radius, degrees) = (fields.real("radius")?, fields.real("semi_angle")?);
            if radius < 0.0 {
                return Err(ReadError::NotPositive { field: "radius", value: radius });
            }
            if !(degrees.abs() > 0.0 && degrees.abs() < 90.0) {
                return Err(ReadError::SemiAngle { degrees });
            }
            Surface::Cone { frame, radius, semi_angle: degrees.to_radians() }
        }
        Entity::SphericalSurface => Surface::Sphere { frame, radius: positive("radius")? },
        _ => Surface::Torus {
            frame,
            major_radius: positive("major_radius")?,
            minor_radius: positive("minor_radius")?,
        },
    };
    let parameters = if with_parameters { angles(entity) } else { Vec::new() };
    Ok(SurfaceRead { parameters, ..SurfaceRead::new(surface) })
}

/// Elementary surfaces count angles in degrees; files count them in radians too.
pub(in crate::iges) fn angles(entity: Entity) -> Vec<ParameterMap> {
    const DEGREE: f64 = PI / 180.0;
    let [u, v] = match entity {
        Entity::PlaneSurface => return vec![ParameterMap::identity()],
        Entity::CylindricalSurface | Entity::ConicalSurface => [DEGREE, 1.0],
        _ => [DEGREE, DEGREE],
    };
    vec![ParameterMap::stretch(u, v, Vector2::zeros()), ParameterMap::identity()]
}
