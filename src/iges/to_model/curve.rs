//! Curves in space (IGES 5.3 sections 4.3 to 4.14, 4.23 and 4.25), each a range of an endless or closed one.
//!
//! Parameters are those of the standard, angles in radians.

use super::conic::conic;
use super::error::ReadError;
use super::scope::{MAX_DEPTH, MAX_PARTS, Scope, kind, small};
use super::spline;
use crate::geometry::nurbs::{KnotVector, NurbsCurve3};
use crate::geometry::{Composite, Curve, Segment, Trimmed};
use crate::iges::view::FieldError;
use crate::iges::{Entity, EntityView, EntryNumber};
use crate::math::{Affine, Frame, Point2, Point3, Vector3};
use std::f64::consts::TAU;

/// A range of a curve: what one curve entity is.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::iges) struct Piece {
    /// The curve, which may be endless or closed.
    pub(in crate::iges) curve: Curve,
    /// First and last parameter, ascending; infinite where a line has no end.
    pub(in crate::iges) range: (f64, f64),
}

impl Piece {
    fn whole(curve: Curve) -> Self {
        let range = curve.domain();
        Self { curve, range }
    }

    pub(in crate::iges) fn start(&self) -> Point3<f64> {
        self.curve.point_wrapped(self.range.0)
    }

    pub(in crate::iges) fn end(&self) -> Point3<f64> {
        self.curve.point_wrapped(self.range.1)
    }

    pub(in crate::iges) fn middle(&self) -> Point3<f64> {
        self.curve.point_wrapped(0.5 * (self.range.0 + self.range.1))
    }

    /// The curve with its own ends: trimmed, unless it has these already.
    pub(in crate::iges) fn bounded(self) -> Curve {
        let Self { curve, range: (start, end) } = self;
        let same = curve.domain() == (start, end);
        let turn =
            matches!(curve, Curve::Circle { .. } | Curve::Ellipse { .. }) && (end - start - TAU).abs() < TURN;
        if same || turn || !(end - start).is_finite() {
            return curve;
        }
        Curve::Trimmed(Trimmed { basis: Box::new(curve), start, end, forward: true })
    }

    fn placed(self, map: &Affine) -> Result<Self, ReadError> {
        if map.is_identity() {
            return Ok(self);
        }
        let image = |error: crate::geometry::NotRepresentable| ReadError::Image(error.to_string());
        let (curve, shift) = self.curve.transformed_with_shift(map).map_err(image)?;
        Ok(Self { curve, range: (self.range.0 - shift, self.range.1 - shift) })
    }
}

/// Angle below which the ends of an arc are one point.
const TURN: f64 = 1e-9;

/// The curve of an entity in the space that `within` leads to.
pub(in crate::iges) fn read(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
) -> Result<Piece, ReadError> {
    read_at(scope, number, within, &mut Budget::default())
}

/// The curves of an entity end to end: those of a composite one by one, any other alone.
pub(in crate::iges) fn pieces(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
) -> Result<Vec<(EntryNumber, Piece)>, ReadError> {
    let mut found = Vec::new();
    collect(scope, number, within, &mut Budget::default(), &mut found)?;
    if found.is_empty() { Err(ReadError::Empty("curves")) } else { Ok(found) }
}

/// How deep and how wide a curve may still be made of others.
struct Budget {
    depth: usize,
    parts: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { depth: MAX_DEPTH, parts: MAX_PARTS }
    }
}

impl Budget {
    /// Goes one level down.
    fn enter(&mut self, number: EntryNumber) -> Result<(), ReadError> {
        let left = self.depth.checked_sub(1).zip(self.parts.checked_sub(1));
        let (depth, parts) = left.ok_or(ReadError::Cycle(number))?;
        (self.depth, self.parts) = (depth, parts);
        Ok(())
    }

    fn leave(&mut self) {
        self.depth += 1;
    }
}

fn collect(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
    budget: &mut Budget,
    found: &mut Vec<(EntryNumber, Piece)>,
) -> Result<(), ReadError> {
    let instance = scope.instance(number)?;
    if kind(instance) != Some(Entity::CompositeCurve) {
        let piece =
            read_at(scope, number, within, budget).map_err(|e| in_entity(scope, "curve", number, e))?;
        found.push((number, piece));
        return Ok(());
    }
    budget.enter(number)?;
    let placed = scope.placed(instance, within)?;
    for member in members(scope, number)? {
        collect(scope, member, &placed, budget, found)?;
    }
    budget.leave();
    Ok(())
}

/// The curves of a composite; points among them mean nothing for its course.
fn members(scope: &Scope<'_>, number: EntryNumber) -> Result<Vec<EntryNumber>, ReadError> {
    let view = scope.view(number)?;
    small(view.fields(), "count", MAX_PARTS)?;
    let mut members = view.fields().pointers_of("curves")?;
    let is_point = |member: &EntryNumber| {
        let entity_type = scope.file.instance(*member).map(|instance| instance.entry().entity_type);
        matches!(entity_type, Some(116 | 132))
    };
    members.retain(|member| !is_point(member));
    Ok(members)
}

/// An error of an entity that another is made of.
pub(in crate::iges) fn in_entity(
    scope: &Scope<'_>,
    field: &'static str,
    number: EntryNumber,
    error: ReadError,
) -> ReadError {
    match error {
        ReadError::Basis { .. } | ReadError::Cycle(_) | ReadError::Dangling(_) => error,
        error => ReadError::Basis { field, number, entity: scope.name(number), source: Box::new(error) },
    }
}

fn read_at(
    scope: &Scope<'_>,
    number: EntryNumber,
    within: &Affine,
    budget: &mut Budget,
) -> Result<Piece, ReadError> {
    let placed = scope.placed(scope.instance(number)?, within)?;
    read_placed(scope, number, &placed, budget)
}

/// The curve of an entity without its own matrix.
pub(in crate::iges) fn definition(scope: &Scope<'_>, number: EntryNumber) -> Result<Piece, ReadError> {
    read_placed(scope, number, &Affine::identity(), &mut Budget::default())
}

fn read_placed(
    scope: &Scope<'_>,
    number: EntryNumber,
    placed: &Affine,
    budget: &mut Budget,
) -> Result<Piece, ReadError> {
    let instance = scope.instance(number)?;
    let wrong = ReadError::WrongEntity { number, found: scope.name(number), expected: "a curve" };
    let entity = kind(instance).filter(|entity| entity.is_curve()).ok_or(wrong)?;
    let view = scope.view(number)?;
    let piece = match entity {
        Entity::CircularArc => arc(scope, &view)?,
        Entity::ConicArc => conic_arc(&view)?,
        Entity::CopiousData => path(&view)?,
        Entity::Line => line(&view)?,
        Entity::ParametricSplineCurve => Piece::whole(Curve::Nurbs(spline::parametric_curve(view.fields())?)),
        Entity::RationalBSplineCurve => {
            let (curve, range) = spline::curve(view.fields())?;
            Piece { curve: Curve::Nurbs(curve), range }
        }
        Entity::CompositeCurve => return composite(scope, number, placed, budget),
        Entity::OffsetCurve => return offset(scope, &view, placed, budget),
        _ => return Err(ReadError::NotReadYet),
    };
    piece.placed(placed)
}

fn arc(scope: &Scope<'_>, view: &EntityView<'_>) -> Result<Piece, ReadError> {
    let fields = view.fields();
    let z = fields.real("z")?;
    let [center, start, end] = ["center", "start", "end"].map(|field| fields.array::<2>(field));
    let (center, start, end) = (center?, start?, end?);
    let arm = |[x, y]: [f64; 2]| (x - center[0], y - center[1]);
    let ((xs, ys), (xe, ye)) = (arm(start), arm(end));
    let radius = xs.hypot(ys);
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(ReadError::NotPositive { field: "radius", value: radius });
    }
    let from = ys.atan2(xs);
    let way = (ye.atan2(xe) - from).rem_euclid(TAU);
    // Ends that the file does not tell apart are one: the arc is the whole circle.
    let slack = (scope.resolution / radius).clamp(TURN, 1e-3);
    let way = if way <= slack || way >= TAU - slack { TAU } else { way };
    let frame = Frame {
        origin: Point3::new(center[0], center[1], z),
        x: Vector3::x(),
        y: Vector3::y(),
        z: Vector3::z(),
    };
    Ok(Piece { curve: Curve::Circle { frame, radius }, range: (from, from + way) })
}

fn conic_arc(view: &EntityView<'_>) -> Result<Piece, ReadError> {
    let fields = view.fields();
    let point = |[x, y]: [f64; 2]| Point2::new(x, y);
    let (start, end) = (point(fields.array("start")?), point(fields.array("end")?));
    let (curve, range) = conic(fields.array("coefficients")?, fields.real("z")?, start, end)?;
    Ok(Piece { curve, range })
}

/// Forms of copious data that are curves.
pub(in crate::iges) const PATHS: [i32; 4] = [11, 12, 13, 63];

fn path(view: &EntityView<'_>) -> Result<Piece, ReadError> {
    if !PATHS.contains(&view.instance().entry().form) {
        return Err(ReadError::NotReadYet);
    }
    let fields = view.fields();
    let count = small(fields, "count", MAX_PARTS * 100)?;
    if count < 2 {
        return Err(ReadError::NoExtent);
    }
    let numbers = fields.reals("points")?;
    let net: Vec<[f64; 4]> = match fields.integer("interpretation")? {
        1 => {
            let z = fields.real("z")?;
            numbers.as_chunks::<2>().0.iter().map(|&[x, y]| [x, y, z, 1.0]).collect()
        }
        2 => numbers.as_chunks::<3>().0.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect(),
        3 => numbers.as_chunks::<6>().0.iter().map(|&[x, y, z, ..]| [x, y, z, 1.0]).collect(),
        other => {
            let expected = "1, 2 or 3".to_owned();
            return Err(FieldError { field: "interpretation", found: other.to_string(), expected }.into());
        }
    };
    if net.iter().all(|point| *point == net[0]) {
        return Err(ReadError::NoExtent);
    }
    let knots: Vec<f64> =
        [0.0].into_iter().chain((0..count).map(|at| at as f64)).chain([(count - 1) as f64]).collect();
    Ok(Piece::whole(Curve::Polyline(NurbsCurve3::new(KnotVector::new(1, knots)?, net)?)))
}

fn line(view: &EntityView<'_>) -> Result<Piece, ReadError> {
    let fields = view.fields();
    let [start, end] = ["start", "end"].map(|field| fields.array::<3>(field).map(Point3::from));
    let (origin, end) = (start?, end?);
    let direction = end - origin;
    if !(direction.norm() > 0.0 && direction.norm().is_finite()) {
        return Err(ReadError::NoExtent);
    }
    let range = match view.instance().entry().form {
        1 => (0.0, f64::INFINITY),
        2 => (f64::NEG_INFINITY, f64::INFINITY),
        _ => (0.0, 1.0),
    };
    Ok(Piece { curve: Curve::Line { origin, direction }, range })
}

fn composite(
    scope: &Scope<'_>,
    number: EntryNumber,
    placed: &Affine,
    budget: &mut Budget,
) -> Result<Piece, ReadError> {
    budget.enter(number)?;
    let mut segments = Vec::new();
    for member in members(scope, number)? {
        let piece =
            read_at(scope, member, placed, budget).map_err(|e| in_entity(scope, "curves", member, e))?;
        let curve = piece.bounded();
        let domain = curve.domain();
        segments.push(Segment { curve, domain, forward: true });
    }
    budget.leave();
    let whole = Composite::new(segments).ok_or(ReadError::Empty("curves"))?;
    Ok(Piece::whole(Curve::Composite(whole)))
}

/// Flag of an offset curve at one distance everywhere.
const UNIFORM: i64 = 1;

fn offset(
    scope: &Scope<'_>,
    view: &EntityView<'_>,
    placed: &Affine,
    budget: &mut Budget,
) -> Result<Piece, ReadError> {
    let fields = view.fields();
    if fields.integer("flag")? != UNIFORM {
        return Err(ReadError::KindNotReadYet("an offset of varying distance"));
    }
    budget.enter(view.number())?;
    let base = fields.pointer("base")?;
    let basis =
        read_at(scope, base, &Affine::identity(), budget).map_err(|e| in_entity(scope, "base", base, e))?;
    budget.leave();
    let normal = Vector3::from(fields.array("normal")?);
    let direction =
        normal.try_normalize(f64::MIN_POSITIVE).ok_or(ReadError::ZeroVector { field: "normal" })?;
    let range = (fields.real("start")?, fields.real("end")?);
    let range = if range.0 < range.1 { range } else { basis.range };
    let basis = Box::new(basis.curve);
    let curve = Curve::Offset { basis, distance: fields.real("distance_1")?, direction };
    Piece { curve, range }.placed(placed)
}
