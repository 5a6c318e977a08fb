//! Curves in the parameter plane of a surface: curve entities whose third coordinate means nothing.

use super::curve::Piece;
use super::error::ReadError;
use crate::geometry::nurbs::NurbsCurve2;
use crate::geometry::transform::ParameterMap;
use crate::geometry::{Curve, Curve2d};
use crate::math::{Frame, Point2, Point3, Vector2, Vector3};

/// A range of a curve in the plane, as a [`Piece`] is one in space.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::iges) struct Piece2d {
    pub(in crate::iges) curve: Curve2d,
    pub(in crate::iges) range: (f64, f64),
}

impl Piece2d {
    /// The piece without its third coordinate.
    pub(in crate::iges) fn flat(piece: &Piece) -> Result<Self, ReadError> {
        Ok(Self { curve: flat(&piece.curve)?, range: piece.range })
    }

    pub(in crate::iges) fn start(&self) -> Point2<f64> {
        self.curve.point_at(self.range.0)
    }

    pub(in crate::iges) fn end(&self) -> Point2<f64> {
        self.curve.point_at(self.range.1)
    }

    /// The piece in other parameters.
    pub(in crate::iges) fn mapped(&self, map: &ParameterMap) -> Result<Self, ReadError> {
        if map.is_identity() {
            return Ok(self.clone());
        }
        let curve = self.curve.transformed(map).map_err(|error| ReadError::Image(error.to_string()))?;
        Ok(Self { curve, range: self.range })
    }

    /// The curve over the parameters of another, from `range.0` at its start to `range.1` at its end; as it is where its
    /// kind has no such form.
    pub(in crate::iges) fn over(self, range: (f64, f64)) -> Curve2d {
        let (from, to) = self.range;
        let factor = (range.1 - range.0) / (to - from);
        let shift = range.0 - from * factor;
        let same = (factor - 1.0).abs() <= f64::EPSILON && shift.abs() <= f64::EPSILON * range.0.abs();
        if same || !(factor.is_finite() && factor > 0.0 && shift.is_finite()) {
            return self.curve;
        }
        match self.curve {
            Curve2d::Line { origin, direction } => {
                let direction = direction / factor;
                Curve2d::Line { origin: origin - direction * shift, direction }
            }
            Curve2d::Nurbs(curve) | Curve2d::Polyline(curve) => {
                let knots = curve.knots().affine(factor, shift);
                let moved =
                    knots.ok().and_then(|knots| NurbsCurve2::new(knots, curve.points().to_vec()).ok());
                Curve2d::Nurbs(moved.unwrap_or(curve))
            }
            // A circle counts from another axis.
            Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 }
                if semi_axis_1 == semi_axis_2 && (factor - 1.0).abs() < 1e-9 =>
            {
                let (sin, cos) = (-shift).sin_cos();
                let (x, y) = (x * cos + y * sin, y * cos - x * sin);
                Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 }
            }
            other => other,
        }
    }
}

fn point(p: &Point3<f64>) -> Point2<f64> {
    Point2::new(p.x, p.y)
}

fn vector(v: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(v.x, v.y)
}

fn flat(curve: &Curve) -> Result<Curve2d, ReadError> {
    Ok(match curve {
        Curve::Line { origin, direction } => {
            let direction = vector(direction);
            if direction.norm() == 0.0 {
                return Err(ReadError::NoExtent);
            }
            Curve2d::Line { origin: point(origin), direction }
        }
        Curve::Circle { frame, radius } => ellipse(frame, *radius, *radius)?,
        Curve::Ellipse { frame, semi_axis_1, semi_axis_2 } => ellipse(frame, *semi_axis_1, *semi_axis_2)?,
        Curve::Nurbs(curve) => Curve2d::Nurbs(net(curve)?),
        Curve::Polyline(curve) => Curve2d::Polyline(net(curve)?),
        // Conics with a right turn and pieces of pieces: as B-splines where they have that form.
        other => {
            let (start, end) = other.domain();
            Curve2d::Nurbs(net(&other.to_nurbs((start, end))?)?)
        }
    })
}

fn ellipse(frame: &Frame, semi_axis_1: f64, semi_axis_2: f64) -> Result<Curve2d, ReadError> {
    let (x, y) = (vector(&frame.x), vector(&frame.y));
    if (x.perp(&y) - 1.0).abs() > 1e-9 {
        return Err(ReadError::KindNotReadYet("a conic across the parameter plane"));
    }
    Ok(Curve2d::Ellipse { center: point(&frame.origin), x, y, semi_axis_1, semi_axis_2 })
}

fn net(curve: &crate::geometry::nurbs::NurbsCurve3) -> Result<NurbsCurve2, ReadError> {
    let points = curve.points().iter().map(|p| [p[0], p[1], p[3]]).collect();
    Ok(NurbsCurve2::new(curve.knots().clone(), points)?)
}
