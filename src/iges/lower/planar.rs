//! Conics in a plane of constant `z`, as the format has them (IGES 5.3 sections 4.3 and 4.5).

use super::super::Entity;
use super::record::Record;
use crate::geometry::Curve;
use crate::iges::to_model::curve::Piece;
use crate::math::{Affine, Frame, Vector3};

/// Deviation of a unit normal from the third axis that is rounding.
const LEVEL: f64 = 4.0 * f64::EPSILON;

/// The frame of a conic.
pub(super) fn frame(curve: &Curve) -> Option<&Frame> {
    match curve {
        Curve::Circle { frame, .. }
        | Curve::Ellipse { frame, .. }
        | Curve::Parabola { frame, .. }
        | Curve::Hyperbola { frame, .. } => Some(frame),
        _ => None,
    }
}

/// The same conic in another frame.
fn in_frame(curve: &Curve, frame: Frame) -> Curve {
    match curve.clone() {
        Curve::Circle { radius, .. } => Curve::Circle { frame, radius },
        Curve::Ellipse { semi_axis_1, semi_axis_2, .. } => Curve::Ellipse { frame, semi_axis_1, semi_axis_2 },
        Curve::Parabola { focal_distance, .. } => Curve::Parabola { frame, focal_distance },
        Curve::Hyperbola { semi_axis, semi_imaginary_axis, .. } => {
            Curve::Hyperbola { frame, semi_axis, semi_imaginary_axis }
        }
        other => other,
    }
}

/// The conic in its own plane, and the map from there.
pub(super) fn level(piece: &Piece, frame: &Frame) -> (Piece, Affine) {
    let own = Frame { origin: Default::default(), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() };
    (Piece { curve: in_frame(&piece.curve, own), range: piece.range }, Affine::from_frame(frame))
}

/// An arc or conic in a plane of constant `z`; `None` for what is none. A circle may be turned in its plane, another conic
/// has its axes along x and y.
pub(super) fn record(piece: &Piece) -> Option<Record> {
    let frame = frame(&piece.curve)?;
    let is_level = frame.z.x.abs() <= LEVEL && frame.z.y.abs() <= LEVEL && frame.z.z > 0.0;
    let is_straight = frame.x.y.abs() <= LEVEL && frame.x.x > 0.0;
    let center = frame.origin;
    let ends = [piece.range.0, piece.range.1].map(|t| piece.curve.point_at(t));
    let ends = ends.iter().flat_map(|p| [p.x, p.y]);
    if let Curve::Circle { .. } = piece.curve {
        let record = Record::new(Entity::CircularArc.number(), 0).reals([center.z, center.x, center.y]);
        return is_level.then(|| record.reals(ends));
    }
    // Anywhere else the other axes would have to be turned: coefficients of a turned conic lose digits.
    if !(is_level && is_straight && center.x == 0.0 && center.y == 0.0) {
        return None;
    }
    let (form, coefficients) = match &piece.curve {
        Curve::Ellipse { semi_axis_1: a, semi_axis_2: b, .. } => {
            (1, [1.0 / (a * a), 0.0, 1.0 / (b * b), 0.0, 0.0, -1.0])
        }
        Curve::Hyperbola { semi_axis: a, semi_imaginary_axis: b, .. } => {
            (2, [1.0 / (a * a), 0.0, -1.0 / (b * b), 0.0, 0.0, -1.0])
        }
        // y² = 4 f x.
        Curve::Parabola { focal_distance: f, .. } => (3, [0.0, 0.0, 1.0, -4.0 * f, 0.0, 0.0]),
        _ => return None,
    };
    let record = Record::new(Entity::ConicArc.number(), form).reals(coefficients);
    Some(record.reals([center.z]).reals(ends))
}
