//! Records of curves.

use super::super::write::ParameterText;
use super::super::{Entity, EntryNumber};
use super::draft::Look;
use super::planar;
use super::record::{Matrix, Record, Value};
use super::{LowerError, Lowering};
use crate::geometry::nurbs::NurbsCurve3;
use crate::geometry::{Composite, Curve, Segment};
use crate::iges::to_model::curve::Piece;
use crate::math::{Affine, Frame, Point3, Vector3};

impl Lowering<'_> {
    /// The record of a curve, given in the space of its user, for an entity whose own matrix is `own`. `at` is the entity
    /// that it stands for, or is made for.
    pub(super) fn curve_record(
        &mut self,
        at: EntryNumber,
        piece: &Piece,
        own: &Affine,
        look: Look<'_>,
    ) -> Result<Record, LowerError> {
        let piece = resolved(piece.clone());
        let local = moved(&piece, own).ok_or_else(|| unwritable(at, &piece.curve))?;
        if let Some(record) = flat(&local) {
            return Ok(record);
        }
        if let Some(frame) = planar::frame(&piece.curve) {
            let (level, map) = planar::level(&piece, frame);
            let record = planar::record(&level).ok_or_else(|| unwritable(at, &piece.curve))?;
            return Ok(Record { matrix: Matrix::New(map), ..record });
        }
        match &local.curve {
            Curve::Composite(whole) => self.composite_record(at, whole, local.range, look),
            Curve::Offset { basis, distance, direction } => {
                let base = Piece { curve: (**basis).clone(), range: local.range };
                let base = self.add_curve(at, &base, look)?;
                let (from, to) = local.range;
                let zero = Value::Integer(0);
                let record = Record::new(Entity::OffsetCurve.number(), 0).pointer(base);
                let record = record.values([Value::Integer(1), Value::Pointer(None), zero, zero]);
                let record = record.reals([*distance, 0.0, 0.0, 0.0]);
                Ok(record.reals(direction.iter().copied()).reals([from, to]))
            }
            other => Err(unwritable(at, other)),
        }
    }

    /// A new curve.
    pub(in crate::iges) fn add_curve(
        &mut self,
        at: EntryNumber,
        piece: &Piece,
        look: Look<'_>,
    ) -> Result<EntryNumber, LowerError> {
        let record = self.curve_record(at, piece, &Affine::identity(), look)?;
        self.draft.add(&record, look, &[])
    }

    /// A new curve that stands for itself, with pointers behind its fields; its parts get no such pointers.
    pub(in crate::iges) fn add_named_curve(
        &mut self,
        piece: &Piece,
        look: Look<'_>,
        behind: &[ParameterText],
    ) -> Result<EntryNumber, LowerError> {
        let part = Look::part(look.from);
        let record = self.curve_record(EntryNumber(0), piece, &Affine::identity(), part)?;
        self.draft.add(&record, look, behind)
    }

    fn composite_record(
        &mut self,
        at: EntryNumber,
        whole: &Composite<Curve>,
        (from, to): (f64, f64),
        look: Look<'_>,
    ) -> Result<Record, LowerError> {
        let mut members = Vec::new();
        for (segment, breaks) in whole.segments().iter().zip(whole.breaks().windows(2)) {
            let (low, high) = (from.max(breaks[0]), to.min(breaks[1]));
            if low < high {
                let piece = part_of(segment, (low - breaks[0], high - breaks[0]));
                members.push(Value::to(self.add_curve(at, &piece, look)?));
            }
        }
        let record = Record::new(Entity::CompositeCurve.number(), 0);
        Ok(record.values([Value::count(members.len())]).values(members))
    }
}

fn unwritable(number: EntryNumber, curve: &Curve) -> LowerError {
    LowerError::Unwritable { number, kind: curve.kind() }
}

/// A part of a segment, between two lengths of parameter from its start.
fn part_of(segment: &Segment<Curve>, (low, high): (f64, f64)) -> Piece {
    let (first, last) = segment.domain;
    let curve = segment.curve.clone();
    if segment.forward {
        Piece { curve, range: (first + low, first + high) }
    } else {
        reversed(Piece { curve, range: (last - high, last - low) })
    }
}

/// A piece in the space of an entity, from that of its user.
fn moved(piece: &Piece, own: &Affine) -> Option<Piece> {
    if own.is_identity() {
        return Some(piece.clone());
    }
    let (curve, shift) = piece.curve.transformed_with_shift(&own.inverse()?).ok()?;
    Some(Piece { curve, range: (piece.range.0 - shift, piece.range.1 - shift) })
}

/// The record of a curve that needs no other entity; `None` for one that does.
pub(super) fn flat(piece: &Piece) -> Option<Record> {
    match &piece.curve {
        Curve::Line { origin, direction } => Some(line(origin, direction, piece.range)),
        Curve::Nurbs(curve) => Some(spline(&held(curve, piece.range)?, piece.range)),
        Curve::Polyline(curve) => {
            let whole = piece.range == curve.domain();
            if whole { Some(path(curve)) } else { Some(spline(&held(curve, piece.range)?, piece.range)) }
        }
        _ => planar::record(piece),
    }
}

fn line(origin: &Point3<f64>, direction: &Vector3<f64>, (from, to): (f64, f64)) -> Record {
    let (form, from, to) = match (from.is_finite(), to.is_finite()) {
        (true, true) => (0, from, to),
        (true, false) => (1, from, from + 1.0),
        (false, _) => (2, 0.0, 1.0),
    };
    let ends = [from, to].map(|t| origin + direction * t);
    Record::new(Entity::Line.number(), form).reals(ends.iter().flat_map(|p| [p.x, p.y, p.z]))
}

/// Form of a path of straight lines in space.
const PATH: i32 = 12;

fn path(curve: &NurbsCurve3) -> Record {
    let points: Vec<Point3<f64>> = curve.control_points().collect();
    let record = Record::new(Entity::CopiousData.number(), PATH);
    let record = record.values([Value::Integer(2), Value::count(points.len())]);
    record.reals(points.iter().flat_map(|p| [p.x, p.y, p.z]))
}

/// A spline whose domain holds a range: on a closed one the range may go on past the end.
fn held(curve: &NurbsCurve3, (from, to): (f64, f64)) -> Option<NurbsCurve3> {
    let (first, last) = curve.domain();
    let slack = SLACK * (last - first);
    if from >= first - slack && to <= last + slack {
        return Some(curve.clone());
    }
    let period = last - first;
    let turns = ((from - first) / period).floor() * period;
    let (low, high) = (from - turns, to - turns);
    if high <= last + slack {
        let knots = curve.knots().affine(1.0, turns).ok()?;
        return NurbsCurve3::new(knots, curve.points().to_vec()).ok();
    }
    let [tail, head] = [curve.piece(low, last).ok()?, curve.piece(first, high - period).ok()?];
    NurbsCurve3::joined(&[tail, head], from).ok()
}

/// Part of a domain by which a range may leave it.
const SLACK: f64 = 1e-9;

/// A B-spline, of which a range is meant.
fn spline(curve: &NurbsCurve3, (from, to): (f64, f64)) -> Record {
    let (first, last) = curve.domain();
    let (from, to) = (from.clamp(first, last), to.clamp(first, last));
    let points: Vec<Point3<f64>> = curve.control_points().collect();
    let normal = plane_of(&points);
    let size = curve.bounding_box().diagonal();
    let closed = (curve.point_at(from) - curve.point_at(to)).norm() <= CLOSED * size;
    let knots = curve.knots();
    let record = Record::new(Entity::RationalBSplineCurve.number(), 0).values([
        Value::count(points.len() - 1),
        Value::count(knots.degree()),
        Value::flag(normal.is_some()),
        Value::flag(closed),
        Value::flag(is_polynomial(curve.weights())),
        Value::Integer(0),
    ]);
    let record = record.reals(knots.knots().iter().copied()).reals(curve.weights());
    let record = record.reals(points.iter().flat_map(|p| [p.x, p.y, p.z])).reals([from, to]);
    record.reals(normal.unwrap_or_default().iter().copied())
}

pub(super) fn is_polynomial(mut weights: impl Iterator<Item = f64>) -> bool {
    let first = weights.next();
    weights.all(|weight| Some(weight) == first)
}

/// Part of its size by which a curve that counts as closed may be open.
const CLOSED: f64 = 1e-9;
/// Part of their extent by which points may leave a plane that they lie in.
const FLAT: f64 = 1e-9;

/// Unit normal of the plane that points lie in; `None` where they lie in none, or in several.
fn plane_of(points: &[Point3<f64>]) -> Option<Vector3<f64>> {
    let origin = *points.first()?;
    let arms = || points.iter().map(|point| point - origin);
    let longest = arms().max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
    let across =
        arms().map(|arm| longest.cross(&arm)).max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
    let size = longest.norm();
    if across.norm() <= FLAT * size * size {
        return None;
    }
    let normal = across.normalize();
    let normal = if normal.z < -FLAT { -normal } else { normal };
    arms().all(|arm| arm.dot(&normal).abs() <= FLAT * size).then_some(normal)
}

/// Without trims.
pub(in crate::iges) fn resolved(piece: Piece) -> Piece {
    match piece.curve {
        Curve::Trimmed(trimmed) if trimmed.forward => {
            resolved(Piece { curve: *trimmed.basis, range: piece.range })
        }
        Curve::Trimmed(trimmed) => {
            let (from, to) = piece.range;
            reversed(resolved(Piece { curve: *trimmed.basis, range: (-to, -from) }))
        }
        curve => Piece { curve, range: piece.range },
    }
}

/// The piece run the other way.
pub(in crate::iges) fn reversed(piece: Piece) -> Piece {
    let (from, to) = piece.range;
    let turned = |frame: Frame| Frame { y: -frame.y, z: -frame.z, ..frame };
    let back = |curve: Curve| Piece { curve, range: (-to, -from) };
    match piece.curve {
        Curve::Line { origin, direction } => {
            let curve = Curve::Line { origin: origin + direction * (from + to), direction: -direction };
            Piece { curve, range: (from, to) }
        }
        Curve::Circle { frame, radius } => back(Curve::Circle { frame: turned(frame), radius }),
        Curve::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
            back(Curve::Ellipse { frame: turned(frame), semi_axis_1, semi_axis_2 })
        }
        Curve::Parabola { frame, focal_distance } => {
            back(Curve::Parabola { frame: turned(frame), focal_distance })
        }
        Curve::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
            back(Curve::Hyperbola { frame: turned(frame), semi_axis, semi_imaginary_axis })
        }
        Curve::Nurbs(curve) => {
            let (first, last) = curve.domain();
            let range = (first + (last - to), first + (last - from));
            Piece { curve: Curve::Nurbs(curve.reversed()), range }
        }
        Curve::Polyline(curve) => {
            let (first, last) = curve.domain();
            let range = (first + (last - to), first + (last - from));
            Piece { curve: Curve::Polyline(curve.reversed()), range }
        }
        Curve::Composite(whole) => reversed_composite(&whole, (from, to)),
        Curve::Offset { basis, distance, direction } => {
            let basis = reversed(Piece { curve: *basis, range: (from, to) });
            let curve = Curve::Offset { basis: Box::new(basis.curve), distance: -distance, direction };
            Piece { curve, range: basis.range }
        }
        Curve::Trimmed(_) => reversed(resolved(piece)),
    }
}

fn reversed_composite(whole: &Composite<Curve>, (from, to): (f64, f64)) -> Piece {
    let (first, last) = whole.domain();
    let segments = whole.segments().iter().rev();
    let segments = segments.map(|segment| Segment { forward: !segment.forward, ..segment.clone() }).collect();
    let curve = Composite::new(segments).map_or_else(|| Curve::Composite(whole.clone()), Curve::Composite);
    Piece { curve, range: (first + (last - to), first + (last - from)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nurbs::KnotVector;

    fn tilted() -> Frame {
        Frame::from_axis(Point3::new(1.0, 2.0, 3.0), Vector3::new(1.0, 1.0, 2.0), Some(Vector3::x()))
            .expect("a frame")
    }

    fn pieces() -> Vec<Piece> {
        let net =
            vec![[0.0, 0.0, 0.0, 1.0], [1.0, 2.0, 0.5, 0.5], [3.0, 1.0, 1.0, 1.0], [4.0, 4.0, -1.0, 2.0]];
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0]).expect("knots");
        let curve = NurbsCurve3::new(knots, net).expect("a curve");
        let line = Curve::Line { origin: Point3::new(1.0, 0.0, 0.0), direction: Vector3::new(1.0, 2.0, 3.0) };
        vec![
            Piece { curve: line, range: (0.5, 2.0) },
            Piece { curve: Curve::Circle { frame: tilted(), radius: 2.0 }, range: (0.3, 5.0) },
            Piece {
                curve: Curve::Ellipse { frame: tilted(), semi_axis_1: 3.0, semi_axis_2: 1.0 },
                range: (-1.0, 2.0),
            },
            Piece { curve: Curve::Parabola { frame: tilted(), focal_distance: 0.5 }, range: (-1.0, 2.0) },
            Piece {
                curve: Curve::Hyperbola { frame: tilted(), semi_axis: 1.0, semi_imaginary_axis: 2.0 },
                range: (-1.0, 0.5),
            },
            Piece { curve: Curve::Nurbs(curve), range: (0.1, 0.9) },
        ]
    }

    #[test]
    fn a_reversed_piece_runs_from_the_end_to_the_start() {
        for piece in pieces() {
            let back = reversed(piece.clone());
            for part in [0.0, 0.25, 1.0] {
                let t = piece.range.0 + part * (piece.range.1 - piece.range.0);
                let s = back.range.1 - part * (back.range.1 - back.range.0);
                let off = (piece.curve.point_at(t) - back.curve.point_at(s)).norm();
                assert!(off < 1e-13, "{}: {off}", piece.curve.kind());
            }
        }
    }

    #[test]
    fn planes_are_found_and_lines_have_none() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let flat = [p(0.0, 0.0, 1.0), p(1.0, 0.0, 2.0), p(0.0, 1.0, 3.0), p(2.0, 2.0, 7.0)];
        let normal = plane_of(&flat).expect("a plane");
        assert!((normal - Vector3::new(-1.0, -2.0, 1.0).normalize()).norm() < 1e-15);
        assert_eq!(plane_of(&[p(0.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(3.0, 3.0, 0.0)]), None);
        assert_eq!(plane_of(&[flat[0], flat[1], flat[2], p(2.0, 2.0, 7.1)]), None);
    }

    #[test]
    fn a_range_past_the_seam_is_one_curve() {
        // A closed square path.
        let net = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(|[x, y]| [x, y, 0.0, 1.0]);
        let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0]).expect("knots");
        let curve = NurbsCurve3::new(knots, net.to_vec()).expect("a curve");
        let over = held(&curve, (3.5, 4.5)).expect("a curve");
        for (t, expected) in [(3.5, p2(0.0, 0.5)), (4.0, p2(0.0, 0.0)), (4.5, p2(0.5, 0.0))] {
            assert!((over.point_at(t) - expected).norm() < 1e-15);
        }
        let later = held(&curve, (5.0, 6.0)).expect("a curve");
        assert!((later.point_at(5.5) - p2(1.0, 0.5)).norm() < 1e-15);
    }

    fn p2(x: f64, y: f64) -> Point3<f64> {
        Point3::new(x, y, 0.0)
    }
}
