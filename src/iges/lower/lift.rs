//! Curves in the parameters of a surface, as the format has them: curves in space whose third coordinate is zero.

use super::compose_curve::resolved;
use crate::geometry::nurbs::{NurbsCurve2, NurbsCurve3};
use crate::geometry::{Composite, Curve, Curve2d, ParameterMap, Segment, Trimmed};
use crate::iges::to_model::curve::Piece;
use crate::iges::to_model::curve2d::Piece2d;
use crate::math::{Frame, Matrix2, Point2, Point3, Vector2, Vector3};

/// The curve in space; `None` for a kind that has no such form. A conic that is no circle, and a circle
/// that runs clockwise, becomes its exact B-spline: another form would need a matrix.
pub(in crate::iges) fn lifted(piece: &Piece2d) -> Option<Piece> {
    let Piece { curve, range } = resolved(Piece { curve: raised(&piece.curve)?, range: piece.range });
    let is_plain = match &curve {
        Curve::Circle { frame, .. } => frame.z.z > 0.0,
        Curve::Ellipse { .. } | Curve::Parabola { .. } | Curve::Hyperbola { .. } => false,
        _ => true,
    };
    if is_plain {
        return Some(Piece { curve, range });
    }
    let spline = curve.to_nurbs(range).ok()?;
    let range = spline.domain();
    Some(Piece { curve: Curve::Nurbs(spline), range })
}

/// The inverse of a map of parameters.
pub(super) fn inverse(map: &ParameterMap) -> Option<ParameterMap> {
    if map.is_identity() {
        return Some(*map);
    }
    let linear: Matrix2<f64> = map.linear.try_inverse()?;
    Some(ParameterMap { linear, translation: -(linear * map.translation) })
}

/// A piece in the parameters that the file counts in; a conic that the map would turn becomes its exact B-spline.
pub(in crate::iges) fn in_file(piece: &Piece2d, map: &ParameterMap) -> Option<Piece2d> {
    let back = inverse(map)?;
    if let Ok(moved) = piece.mapped(&back) {
        return Some(moved);
    }
    let spline = raised(&piece.curve)?.to_nurbs(piece.range).ok()?;
    let net = spline.points().iter().map(|p| [p[0], p[1], p[3]]).collect();
    let flat = NurbsCurve2::new(spline.knots().clone(), net).ok()?;
    let range = spline.domain();
    Piece2d { curve: Curve2d::Nurbs(flat), range }.mapped(&back).ok()
}

fn point(p: &Point2<f64>) -> Point3<f64> {
    Point3::new(p.x, p.y, 0.0)
}

fn frame(origin: &Point2<f64>, x: &Vector2<f64>, y: &Vector2<f64>) -> Frame {
    let up = x.perp(y).signum();
    let raise = |v: &Vector2<f64>| Vector3::new(v.x, v.y, 0.0);
    Frame { origin: point(origin), x: raise(x), y: raise(y), z: Vector3::new(0.0, 0.0, up) }
}

fn left(x: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-x.y, x.x)
}

fn net(curve: &NurbsCurve2) -> Option<NurbsCurve3> {
    let points = curve.points().iter().map(|&[x, y, w]| [x, y, 0.0, w]).collect();
    NurbsCurve3::new(curve.knots().clone(), points).ok()
}

fn raised(curve: &Curve2d) -> Option<Curve> {
    Some(match curve {
        Curve2d::Line { origin, direction } => {
            Curve::Line { origin: point(origin), direction: Vector3::new(direction.x, direction.y, 0.0) }
        }
        Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
            let frame = frame(center, x, y);
            if semi_axis_1 == semi_axis_2 && frame.z.z > 0.0 {
                Curve::Circle { frame, radius: *semi_axis_1 }
            } else {
                Curve::Ellipse { frame, semi_axis_1: *semi_axis_1, semi_axis_2: *semi_axis_2 }
            }
        }
        Curve2d::Parabola { vertex, x, focal_distance } => {
            Curve::Parabola { frame: frame(vertex, x, &left(x)), focal_distance: *focal_distance }
        }
        Curve2d::Hyperbola { center, x, semi_axis, semi_imaginary_axis } => Curve::Hyperbola {
            frame: frame(center, x, &left(x)),
            semi_axis: *semi_axis,
            semi_imaginary_axis: *semi_imaginary_axis,
        },
        Curve2d::Nurbs(curve) => Curve::Nurbs(net(curve)?),
        Curve2d::Polyline(curve) => Curve::Polyline(net(curve)?),
        Curve2d::Trimmed(trimmed) => Curve::Trimmed(Trimmed {
            basis: Box::new(raised(&trimmed.basis)?),
            start: trimmed.start,
            end: trimmed.end,
            forward: trimmed.forward,
        }),
        Curve2d::Composite(whole) => {
            let segment = |segment: &Segment<Curve2d>| {
                let curve = raised(&segment.curve)?;
                Some(Segment { curve, domain: segment.domain, forward: segment.forward })
            };
            let segments = whole.segments().iter().map(segment).collect::<Option<Vec<_>>>()?;
            Curve::Composite(Composite::new(segments)?)
        }
        Curve2d::Offset { .. } | Curve2d::Scaled { .. } => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conic_that_the_map_turns_is_the_same_curve() {
        let axis = Vector2::new(0.6, 0.8);
        let ellipse = Curve2d::Ellipse {
            center: Point2::new(1.0, -2.0),
            x: axis,
            y: left(&axis),
            semi_axis_1: 3.0,
            semi_axis_2: 1.0,
        };
        let map = ParameterMap::stretch(2.0, -0.5, Vector2::new(1.0, 0.0));
        let piece = Piece2d { curve: ellipse, range: (0.5, 2.0) };
        let own = in_file(&piece, &map).expect("a curve");
        for (t, s) in [(0.5, own.range.0), (2.0, own.range.1)] {
            let image = map.point(&own.curve.point_at(s));
            assert!((image - piece.curve.point_at(t)).norm() < 1e-13);
        }
        let raised = lifted(&piece).expect("a curve");
        let middle = raised.curve.point_at(0.5 * (raised.range.0 + raised.range.1));
        let arm = Vector2::new(middle.x - 1.0, middle.y + 2.0);
        let (a, b) = (arm.dot(&axis) / 3.0, arm.dot(&left(&axis)));
        assert!((a * a + b * b - 1.0).abs() < 1e-14);
    }
}
