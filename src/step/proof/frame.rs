//! Places and directions of ISO 10303-42 as numbers: what a rigid motion carries along.

use super::super::exchange_structure::{ExchangeStructure, Instance, InstanceName};
use super::super::parameter::{Parameter, ParameterKind};
use super::ProofError;
use crate::math::{Point3, Vector3};

/// Points, unit directions and lengths that a record stands for, in a fixed order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Placed {
    pub points: Vec<Point3<f64>>,
    pub directions: Vec<Vector3<f64>>,
    pub lengths: Vec<f64>,
}

/// What a record places; `None` for one whose parameters are to be looked at one by one.
pub(super) fn placed(
    structure: &ExchangeStructure,
    instance: &Instance<'_>,
) -> Result<Option<Placed>, ProofError> {
    let Some(keyword) = instance.keyword() else { return Ok(None) };
    let name = instance.name();
    let of = |place: usize| parameter(instance, place);
    let mut found = Placed::default();
    match keyword.to_ascii_uppercase().as_slice() {
        b"CARTESIAN_POINT" => match numbers(instance)?[..] {
            [x, y, z] => found.points.push(Point3::new(x, y, z)),
            _ => return Ok(None),
        },
        b"DIRECTION" => match numbers(instance)?[..] {
            [x, y, z] => found.directions.push(unit(Vector3::new(x, y, z), name)?),
            _ => return Ok(None),
        },
        b"VECTOR" => {
            let Some(direction) = direction(structure, of(1)?, name)? else { return Ok(None) };
            found.directions.push(direction);
            found.lengths.push(of(2)?.as_f64().ok_or(ProofError::Malformed(name))?);
        }
        b"AXIS1_PLACEMENT" => {
            found.points.push(point(structure, of(1)?, name)?);
            found.directions.push(direction(structure, of(2)?, name)?.unwrap_or_else(Vector3::z));
        }
        b"AXIS2_PLACEMENT_3D" => {
            found.points.push(point(structure, of(1)?, name)?);
            let z = direction(structure, of(2)?, name)?.unwrap_or_else(Vector3::z);
            let reference = direction(structure, of(3)?, name)?;
            found.directions.extend([z, first_axis(z, reference, name)?]);
        }
        _ => return Ok(None),
    }
    Ok(Some(found))
}

/// `first_proj_axis` of ISO 10303-42.
fn first_axis(
    z: Vector3<f64>,
    reference: Option<Vector3<f64>>,
    of: InstanceName,
) -> Result<Vector3<f64>, ProofError> {
    let along_x = z.y == 0.0 && z.z == 0.0;
    let reference = reference.unwrap_or_else(|| if along_x { Vector3::y() } else { Vector3::x() });
    unit(reference - z * reference.dot(&z), of)
}

fn unit(vector: Vector3<f64>, of: InstanceName) -> Result<Vector3<f64>, ProofError> {
    vector.try_normalize(0.0).ok_or(ProofError::Malformed(of))
}

fn parameter<'a>(instance: &Instance<'a>, place: usize) -> Result<Parameter<'a>, ProofError> {
    let malformed = || ProofError::Malformed(instance.name());
    let record = instance.records().next().ok_or_else(malformed)?;
    record.parameters().nth(place).ok_or_else(malformed)
}

/// The numbers in the list behind a record's name.
fn numbers(instance: &Instance<'_>) -> Result<Vec<f64>, ProofError> {
    let malformed = || ProofError::Malformed(instance.name());
    let list = parameter(instance, 1)?;
    let members = list.as_list().ok_or_else(malformed)?;
    members.map(|member| member.as_f64().ok_or_else(malformed)).collect()
}

fn referred<'a>(
    structure: &'a ExchangeStructure,
    parameter: Parameter<'_>,
    of: InstanceName,
) -> Result<Instance<'a>, ProofError> {
    let target = parameter.as_reference().ok_or(ProofError::Malformed(of))?;
    structure.instance(target).ok_or(ProofError::Undefined(target))
}

fn point(
    structure: &ExchangeStructure,
    parameter: Parameter<'_>,
    of: InstanceName,
) -> Result<Point3<f64>, ProofError> {
    match numbers(&referred(structure, parameter, of)?)?[..] {
        [x, y, z] => Ok(Point3::new(x, y, z)),
        _ => Err(ProofError::Malformed(of)),
    }
}

/// A direction in space; `None` where none is given, and for one in the plane.
fn direction(
    structure: &ExchangeStructure,
    parameter: Parameter<'_>,
    of: InstanceName,
) -> Result<Option<Vector3<f64>>, ProofError> {
    if parameter.kind() == ParameterKind::Omitted {
        return Ok(None);
    }
    match numbers(&referred(structure, parameter, of)?)?[..] {
        [x, y, z] => unit(Vector3::new(x, y, z), of).map(Some),
        [_, _] => Ok(None),
        _ => Err(ProofError::Malformed(of)),
    }
}
