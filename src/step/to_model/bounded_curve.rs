//! Curves made of other curves: trimmed, composite and offset ones, in space and in the plane.
//!
//! Reads a chain of references by recursion, with a cap on its depth and on the count of curves of one record,
//! so that a file cannot ask for more work than it has bytes for.

use std::cell::Cell;

use super::curve::{self, Trims};
use super::curve2d;
use super::error::ReadError;
use super::placement::{direction3, point2, point3};
use super::scope::{Scope, entity_name};
use super::transformation::placing;
use crate::geometry::{Composite, Curve, Curve2d, Segment, Trimmed};
use crate::math::Point3;
use crate::step::entity::Entity;
use crate::step::view::{EntityView, boolean, list, real, reference};
use crate::step::{InstanceName, Parameter};

/// Curves within curves that are followed before the chain counts as a cycle.
const MAX_DEPTH: usize = 16;
/// Curves that one record may be made of.
const MAX_CURVES: usize = 1 << 16;

/// How deep a curve or surface lies within others, and how many may still be read.
#[derive(Clone, Copy)]
pub(super) struct Nest<'n> {
    depth: usize,
    left: &'n Cell<usize>,
}

impl<'n> Nest<'n> {
    /// How many curves one record may be made of.
    pub(super) fn budget() -> Cell<usize> {
        Cell::new(MAX_CURVES)
    }

    /// The outermost place.
    pub(super) fn new(left: &'n Cell<usize>) -> Self {
        Self { depth: 0, left }
    }

    /// One further in.
    pub(super) fn inner(self, name: InstanceName) -> Result<Self, ReadError> {
        let left = self.left.get();
        if self.depth + 1 >= MAX_DEPTH || left == 0 {
            return Err(ReadError::Cycle(name));
        }
        self.left.set(left - 1);
        Ok(Self { depth: self.depth + 1, left: self.left })
    }
}

/// A curve that another is made of; a failure names it.
fn part(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    attribute: &'static str,
    nest: Nest<'_>,
) -> Result<Curve, ReadError> {
    let (name, _) = curve::resolve(scope, view.reference(attribute)?, Trims::Keep)?;
    let read = nest.inner(name).and_then(|nest| curve::read_nested(scope, name, nest));
    read.map_err(|source| within(scope, attribute, name, source))
}

/// The failure of a part, with its name.
pub(super) fn within(
    scope: Scope<'_>,
    attribute: &'static str,
    name: InstanceName,
    source: ReadError,
) -> ReadError {
    let entity = scope.file.instance(name).map(entity_name).unwrap_or_default();
    ReadError::Basis { attribute, name, entity, source: Box::new(source) }
}

/// `TRIMMED_CURVE` in space.
pub(super) fn trimmed(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Curve, ReadError> {
    let basis = part(scope, view, "basis_curve", nest)?;
    let scale = curve2d::of_curve(&basis, scope.radians);
    let place = |name| point3(scope, name).map(|p| basis.parameter_of(&p, None));
    let ends = trims(view, scale, &place)?;
    let piece = piece(basis, |basis| (basis.domain(), basis.period()), ends)?;
    Ok(Curve::Trimmed(piece))
}

/// `TRIMMED_CURVE` in the plane.
pub(super) fn trimmed2d(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    nest: Nest<'_>,
) -> Result<Curve2d, ReadError> {
    let basis = part2d(scope, view, "basis_curve", nest)?;
    let in_space = curve2d::in_space(&basis);
    let scale = curve2d::of_curve(&in_space, scope.radians);
    let place = |name| point2(scope, name).map(|p| in_space.parameter_of(&Point3::new(p.x, p.y, 0.0), None));
    let ends = trims(view, scale, &place)?;
    let piece = piece(basis, |_| (in_space.domain(), in_space.period()), ends)?;
    Ok(Curve2d::Trimmed(piece))
}

/// Where a piece begins and ends on its basis, and whether it runs as the basis does.
struct Ends {
    from: f64,
    to: f64,
    forward: bool,
}

/// Reads both trims: by parameter where the record says so, or where it says no point; else by point.
fn trims(
    view: &EntityView<'_>,
    scale: f64,
    place: &dyn Fn(InstanceName) -> Result<f64, ReadError>,
) -> Result<Ends, ReadError> {
    let [first, second, sense, master] =
        view.fields(["trim_1", "trim_2", "sense_agreement", "master_representation"]);
    let by_point = master.and_then(|m| m.as_enum()).is_some_and(|m| m.eq_ignore_ascii_case(b"CARTESIAN"));
    let one = |field: Option<Parameter<'_>>, attribute: &'static str| {
        let mut number = None;
        let mut point = None;
        for member in list(field, attribute)? {
            match member.as_reference() {
                Some(name) => point = point.or(Some(name)),
                None => number = number.or(member.as_f64()),
            }
        }
        match (number.filter(|n| n.is_finite()), point) {
            (Some(number), None) => Ok(number * scale),
            (Some(number), Some(_)) if !by_point => Ok(number * scale),
            (_, Some(name)) => place(name),
            (None, None) => Err(ReadError::Empty { attribute }),
        }
    };
    let (from, to) = (one(first, "trim_1")?, one(second, "trim_2")?);
    Ok(Ends { from, to, forward: boolean(sense, "sense_agreement")? })
}

/// The piece of a basis between two parameters, along its sense or against it. On a closed basis it may pass
/// the seam; from a parameter to itself it is the whole of it.
fn piece<C>(
    basis: C,
    of: impl FnOnce(&C) -> ((f64, f64), Option<f64>),
    ends: Ends,
) -> Result<Trimmed<C>, ReadError> {
    let (domain, period) = of(&basis);
    let (start, end) = interval([ends.from, ends.to], ends.forward, domain, period)?;
    Ok(Trimmed { basis: Box::new(basis), start, end, forward: ends.forward })
}

/// The parameters from one trim to the other along the sense: over the seam where what is trimmed is closed, and the
/// whole turn from a parameter to itself.
pub(super) fn interval(
    [from, to]: [f64; 2],
    forward: bool,
    (low, high): (f64, f64),
    period: Option<f64>,
) -> Result<(f64, f64), ReadError> {
    let (mut start, mut end) = if forward { (from, to) } else { (to, from) };
    match period {
        Some(period) => {
            let way = (end - start).rem_euclid(period);
            // A way of almost nothing is the whole turn, seen through rounding.
            let whole = way <= SAME * period || way >= (1.0 - SAME) * period;
            start = low + (start - low).rem_euclid(period);
            end = start + if whole { period } else { way };
        }
        // What is open has one piece between two parameters, whatever the order in which they stand.
        None => {
            if start > end {
                std::mem::swap(&mut start, &mut end);
            }
            (start, end) = (start.max(low), end.min(high));
        }
    }
    let whole = end > start && (end - start).is_finite();
    if whole { Ok((start, end)) } else { Err(ReadError::NoPiece { from, to }) }
}

/// Part of a period below which two trims count as one.
const SAME: f64 = 1e-9;

/// `COMPOSITE_CURVE` and its subtypes in space.
pub(super) fn composite(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Curve, ReadError> {
    let segments = segments(scope, view, |segment| {
        let curve = part(scope, segment, "parent_curve", nest)?;
        let domain = curve.domain();
        Ok((curve, domain))
    })?;
    Composite::new(segments).map(Curve::Composite).ok_or(ReadError::Unbounded { attribute: "segments" })
}

/// `COMPOSITE_CURVE` and its subtypes in the plane.
pub(super) fn composite2d(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    nest: Nest<'_>,
) -> Result<Curve2d, ReadError> {
    let segments = segments(scope, view, |segment| {
        let curve = part2d(scope, segment, "parent_curve", nest)?;
        let domain = curve.domain();
        Ok((curve, domain))
    })?;
    Composite::new(segments).map(Curve2d::Composite).ok_or(ReadError::Unbounded { attribute: "segments" })
}

fn segments<'a, C>(
    scope: Scope<'a>,
    view: &EntityView<'a>,
    read: impl Fn(&EntityView<'a>) -> Result<(C, (f64, f64)), ReadError>,
) -> Result<Vec<Segment<C>>, ReadError> {
    let mut segments = Vec::new();
    for name in view.references("segments")? {
        let segment = scope.view_of(name, Entity::CompositeCurveSegment)?;
        let forward = segment.boolean("same_sense")?;
        let (curve, domain) = read(&segment)?;
        segments.push(Segment { curve, domain, forward });
    }
    if segments.is_empty() {
        return Err(ReadError::Empty { attribute: "segments" });
    }
    Ok(segments)
}

/// `OFFSET_CURVE_3D`.
pub(super) fn offset(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Curve, ReadError> {
    let basis = Box::new(part(scope, view, "basis_curve", nest)?);
    let [distance, direction] = view.fields(["distance", "ref_direction"]);
    let direction = direction3(scope, reference(direction, "ref_direction")?)?;
    Ok(Curve::Offset { basis, distance: real(distance, "distance")?, direction })
}

/// `CURVE_REPLICA` in space: the parent's image under a scale, turn, mirror and shift.
pub(super) fn replica(scope: Scope<'_>, view: &EntityView<'_>, nest: Nest<'_>) -> Result<Curve, ReadError> {
    let parent = part(scope, view, "parent_curve", nest)?;
    let name = view.reference("transformation")?;
    parent.transformed(&placing(scope, name)?).map_err(|_| ReadError::Coordinates(name))
}

/// `OFFSET_CURVE_2D`.
pub(super) fn offset2d(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    nest: Nest<'_>,
) -> Result<Curve2d, ReadError> {
    let basis = Box::new(part2d(scope, view, "basis_curve", nest)?);
    Ok(Curve2d::Offset { basis, distance: view.real("distance")? })
}

fn part2d(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    attribute: &'static str,
    nest: Nest<'_>,
) -> Result<Curve2d, ReadError> {
    let name = view.reference(attribute)?;
    let read = nest.inner(name).and_then(|nest| curve2d::read_unscaled(scope, name, nest));
    read.map_err(|source| within(scope, attribute, name, source))
}
