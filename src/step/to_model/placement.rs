//! Points, directions and axis placements: ISO 10303-42 chapter 4, the part below curves.

use super::error::ReadError;
use super::scope::Scope;
use crate::math::{Frame, Point2, Point3, Vector2, Vector3};
use crate::number::real_at;
use crate::step::entity::Entity;
use crate::step::syntax::{string_end, trivia_end};
use crate::step::view::{real, reference, simple_parts};
use crate::step::{Instance, InstanceName, ParameterKind, Parameters};

/// A `CARTESIAN_POINT` in space; a missing third coordinate is an error.
pub(super) fn point3(scope: Scope<'_>, name: InstanceName) -> Result<Point3<f64>, ReadError> {
    coordinates(scope, name, Entity::CartesianPoint).map(Point3::from)
}

/// A `CARTESIAN_POINT` in the plane; a third coordinate is passed over.
pub(super) fn point2(scope: Scope<'_>, name: InstanceName) -> Result<Point2<f64>, ReadError> {
    coordinates(scope, name, Entity::CartesianPoint).map(Point2::from)
}

/// A `DIRECTION` in space, of unit length.
pub(super) fn direction3(scope: Scope<'_>, name: InstanceName) -> Result<Vector3<f64>, ReadError> {
    let ratios = Vector3::from(coordinates(scope, name, Entity::Direction)?);
    ratios.try_normalize(0.0).ok_or(ReadError::ZeroDirection(name))
}

/// A `DIRECTION` in the plane, of unit length.
pub(super) fn direction2(scope: Scope<'_>, name: InstanceName) -> Result<Vector2<f64>, ReadError> {
    let ratios = Vector2::from(coordinates(scope, name, Entity::Direction)?);
    ratios.try_normalize(0.0).ok_or(ReadError::ZeroDirection(name))
}

/// A `VECTOR` in space: its direction times its magnitude.
pub(super) fn vector3(scope: Scope<'_>, name: InstanceName) -> Result<Vector3<f64>, ReadError> {
    let (orientation, magnitude) = vector(scope, name)?;
    Ok(direction3(scope, orientation)? * magnitude)
}

/// A `VECTOR` in the plane: its direction times its magnitude.
pub(super) fn vector2(scope: Scope<'_>, name: InstanceName) -> Result<Vector2<f64>, ReadError> {
    let (orientation, magnitude) = vector(scope, name)?;
    Ok(direction2(scope, orientation)? * magnitude)
}

fn vector(scope: Scope<'_>, name: InstanceName) -> Result<(InstanceName, f64), ReadError> {
    let view = scope.view_of(name, Entity::Vector)?;
    let [orientation, magnitude] = view.fields(["orientation", "magnitude"]);
    let magnitude = real(magnitude, "magnitude")?;
    if magnitude <= 0.0 {
        return Err(ReadError::NotPositive { attribute: "magnitude", value: magnitude });
    }
    Ok((reference(orientation, "orientation")?, magnitude))
}

/// An `AXIS2_PLACEMENT_3D`, or an `AXIS1_PLACEMENT` with an arbitrary first axis.
pub(super) fn frame(scope: Scope<'_>, name: InstanceName) -> Result<Frame, ReadError> {
    let view = scope.view_of(name, Entity::Placement)?;
    let [location, axis, first] = view.fields(["location", "axis", "ref_direction"]);
    let origin = point3(scope, reference(location, "location")?)?;
    let axis = axis.and_then(|axis| axis.as_reference());
    let z = axis.map_or(Ok(Vector3::z()), |axis| direction3(scope, axis))?;
    let first = first.and_then(|first| first.as_reference());
    let x = first.map(|first| direction3(scope, first)).transpose()?;
    Frame::from_axis(origin, z, x).ok_or(ReadError::Coordinates(name))
}

/// An `AXIS2_PLACEMENT_2D`: its location and its first axis.
pub(super) fn frame2(scope: Scope<'_>, name: InstanceName) -> Result<(Point2<f64>, Vector2<f64>), ReadError> {
    let view = scope.view_of(name, Entity::Axis2Placement2d)?;
    let location = point2(scope, view.reference("location")?)?;
    let first = view.optional_reference("ref_direction");
    Ok((location, first.map_or(Ok(Vector2::x()), |first| direction2(scope, first))?))
}

/// The first `N` numbers of a point or direction. The text is read directly: nine of ten records of a
/// freeform part are points.
fn coordinates<const N: usize>(
    scope: Scope<'_>,
    name: InstanceName,
    entity: Entity,
) -> Result<[f64; N], ReadError> {
    let instance = scope.instance(name)?;
    if let Some(numbers) = plain_numbers(instance, entity) {
        return Ok(numbers);
    }
    let simple = simple_parts(instance).filter(|(keyword, _)| *keyword == entity.name().as_bytes());
    let Some((_, inside)) = simple else {
        // Lower case, a short name, a complex instance, or something else altogether.
        let view = scope.view_of(name, entity)?;
        let attribute = if entity == Entity::Direction { "direction_ratios" } else { "coordinates" };
        return numbers(scope, name, view.list(attribute)?);
    };
    let mut parameters = instance.parameters_in(inside);
    let list = parameters.nth(1).and_then(|parameter| parameter.as_list());
    numbers(scope, name, list.ok_or(ReadError::Coordinates(name))?)
}

/// The first `N` numbers of `KEYWORD('…',(…` when it is written without liberties; `None` sends everything
/// else the careful way.
#[inline]
fn plain_numbers<const N: usize>(instance: Instance<'_>, entity: Entity) -> Option<[f64; N]> {
    let bytes = instance.bytes();
    // Behind `mark` and white space or comments, when it stands at `at`.
    let behind = |at: usize, mark: u8| (*bytes.get(at)? == mark).then(|| trivia_end(bytes, at + 1));
    let start = instance.body_start()?;
    let keyword = entity.name().as_bytes();
    if !bytes.get(start..)?.starts_with(keyword) {
        return None;
    }
    let name = behind(trivia_end(bytes, start + keyword.len()), b'(')?;
    if bytes.get(name) != Some(&b'\'') {
        return None;
    }
    let comma = trivia_end(bytes, string_end(bytes, name)?);
    let mut at = behind(behind(comma, b',')?, b'(')?;
    let mut numbers = [0.0; N];
    for (index, number) in numbers.iter_mut().enumerate() {
        if index > 0 {
            at = behind(at, b',')?;
        }
        let (value, end) = real_at(bytes, at)?;
        *number = value;
        at = trivia_end(bytes, end);
    }
    // A damaged record may lack its end: what stands behind it does not count.
    let closed = matches!(bytes.get(at), Some(b',' | b')')) && at < instance.span().end as usize;
    closed.then_some(numbers)
}

fn numbers<const N: usize>(
    scope: Scope<'_>,
    name: InstanceName,
    mut list: Parameters<'_>,
) -> Result<[f64; N], ReadError> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        let parameter = list.next().ok_or(ReadError::Coordinates(name))?;
        match parameter.kind() {
            ParameterKind::Real if !parameter.text().contains(&b'e') => {}
            ParameterKind::Real if scope.habits.exponent.get().is_none() => {
                scope.habits.exponent.set(Some(name))
            }
            ParameterKind::Integer if scope.habits.integer.get().is_none() => {
                scope.habits.integer.set(Some(name))
            }
            _ => {}
        }
        *number = match (parameter.as_f64(), parameter.kind()) {
            (Some(value), _) if value.is_finite() => value,
            (_, ParameterKind::Real) => {
                let text = String::from_utf8_lossy(parameter.text()).into_owned();
                return Err(ReadError::NotFinite(name, text));
            }
            _ => return Err(ReadError::Coordinates(name)),
        };
    }
    Ok(numbers)
}
