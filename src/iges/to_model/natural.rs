//! The rectangle of a surface as a loop: its four sides, a seam where it is closed, nothing at a pole.

use super::curve::Piece;
use super::curve2d::Piece2d;
use super::error::ReadError;
use super::image;
use super::spline::Rectangle;
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::{Affine, Frame, Matrix3, Point2, Point3, Vector2, Vector3};

/// A side of the rectangle.
#[derive(Debug, Clone)]
pub(super) struct Side {
    pub(super) piece: Piece,
    /// In the model's parameters, over the parameter of the piece.
    pub(super) pcurve: Curve2d,
    /// Whether the loop runs as the piece does.
    pub(super) forward: bool,
    /// The side before it that is the same curve.
    pub(super) same_as: Option<usize>,
}

/// The sides counter-clockwise in the parameter plane, those that have a length. A side without exact form is taken
/// within the resolution.
pub(super) fn sides(
    surface: &Surface,
    ((u0, u1), (v0, v1)): Rectangle,
    resolution: f64,
) -> Result<Vec<Side>, ReadError> {
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return Err(ReadError::Unbounded { kind: surface.kind() });
    }
    let along_u = |v: f64| -> Result<(Piece, Curve2d), ReadError> {
        let flat = Curve2d::Line { origin: Point2::new(0.0, v), direction: Vector2::x() };
        let piece = match line_of_v(surface, v, (u0, u1)) {
            Some(piece) => piece,
            None => image::of(surface, &Piece2d { curve: flat.clone(), range: (u0, u1) }, resolution)?.piece,
        };
        Ok((piece, flat))
    };
    let along_v = |u: f64| -> Result<(Piece, Curve2d), ReadError> {
        let flat = Curve2d::Line { origin: Point2::new(u, 0.0), direction: Vector2::y() };
        let piece = match line_of_u(surface, u, (v0, v1)) {
            Some(piece) => piece,
            None => image::of(surface, &Piece2d { curve: flat.clone(), range: (v0, v1) }, resolution)?.piece,
        };
        Ok((piece, flat))
    };
    let all = [(along_u(v0)?, true), (along_v(u1)?, true), (along_u(v1)?, false), (along_v(u0)?, false)];
    let mut sides: Vec<Side> = Vec::new();
    for ((piece, pcurve), forward) in all {
        if length(&piece) <= resolution {
            continue;
        }
        let same_as = sides.iter().position(|side| same(&side.piece, &piece, resolution));
        sides.push(Side { piece, pcurve, forward, same_as });
    }
    if sides.is_empty() { Err(ReadError::NoExtent) } else { Ok(sides) }
}

/// Points of a side that are looked at.
const SAMPLES: u32 = 8;

fn samples(piece: &Piece) -> impl Iterator<Item = Point3<f64>> + '_ {
    let (from, to) = piece.range;
    (0..=SAMPLES)
        .map(move |k| piece.curve.point_wrapped(from + (to - from) * f64::from(k) / f64::from(SAMPLES)))
}

fn length(piece: &Piece) -> f64 {
    let points: Vec<_> = samples(piece).collect();
    points.windows(2).map(|pair| (pair[0] - pair[1]).norm()).sum()
}

/// Opposite sides of a closed surface run alike.
fn same(a: &Piece, b: &Piece, resolution: f64) -> bool {
    samples(a).zip(samples(b)).all(|(p, q)| (p - q).norm() <= resolution)
}

/// The curve of constant `u` over a range of `v`, where it has an exact form.
fn line_of_u(surface: &Surface, u: f64, range: (f64, f64)) -> Option<Piece> {
    let curve = match surface {
        Surface::Nurbs(spline) => Curve::Nurbs(spline.iso_curve_u(u)),
        Surface::Revolution { curve, frame } => {
            let map = Affine::about(&frame.origin, rotation(&frame.z, u));
            curve.transformed(&map).ok()?
        }
        Surface::LinearExtrusion { curve, direction } => {
            Curve::Line { origin: curve.point_at(u), direction: *direction }
        }
        _ => return None,
    };
    Some(Piece { curve, range })
}

/// The curve of constant `v` over a range of `u`, where it has an exact form.
fn line_of_v(surface: &Surface, v: f64, range: (f64, f64)) -> Option<Piece> {
    let curve = match surface {
        Surface::Nurbs(spline) => Curve::Nurbs(spline.iso_curve_v(v)),
        Surface::Revolution { curve, frame } => circle(curve.point_at(v), frame),
        Surface::LinearExtrusion { curve, direction } => {
            curve.transformed(&Affine::translation(direction * v)).ok()?
        }
        _ => return None,
    };
    Some(Piece { curve, range })
}

/// The way of a point round an axis, by the angle from where it is. A point on the axis stays: a circle without radius.
fn circle(point: Point3<f64>, axis: &Frame) -> Curve {
    let origin = axis.origin + axis.z * (point - axis.origin).dot(&axis.z);
    let arm = point - origin;
    let radius = arm.norm();
    let frame = Frame::from_axis(origin, axis.z, Some(arm));
    Curve::Circle { frame: frame.unwrap_or(Frame { origin, ..*axis }), radius }
}

fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    let across = Matrix3::new(0.0, -axis.z, axis.y, axis.z, 0.0, -axis.x, -axis.y, axis.x, 0.0);
    Matrix3::identity() * cos + across * sin + axis * axis.transpose() * (1.0 - cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn cone() -> Surface {
        let frame = Frame::from_axis(Point3::origin(), Vector3::z(), Some(Vector3::x())).expect("a frame");
        let profile = Curve::Line { origin: Point3::origin(), direction: Vector3::new(1.0, 0.0, 2.0) };
        Surface::Revolution { curve: Box::new(profile), frame }
    }

    #[test]
    fn sides_lie_on_the_surface_over_their_parameters() {
        let surface = cone();
        let sides = sides(&surface, ((0.5, 2.0), (1.0, 3.0)), 1e-6).expect("four sides");
        assert_eq!(sides.len(), 4);
        for side in &sides {
            let (from, to) = side.piece.range;
            for part in [0.0, 0.3, 1.0] {
                let t = from + (to - from) * part;
                let p = side.pcurve.point_at(t);
                assert!((surface.point(p.x, p.y) - side.piece.curve.point_wrapped(t)).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn a_pole_has_no_side_and_a_seam_is_one_curve() {
        // From the apex, all the way round: seam up, circle, seam down.
        let sides = sides(&cone(), ((0.0, TAU), (0.0, 3.0)), 1e-6).expect("three sides");
        let same: Vec<_> = sides.iter().map(|side| side.same_as).collect();
        assert_eq!(same, [None, None, Some(0)]);
        assert!(sides[0].forward && !sides[1].forward && !sides[2].forward);
    }
}
