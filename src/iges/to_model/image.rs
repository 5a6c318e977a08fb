//! The image of a parameter-space curve on a surface as a curve in space: exact where its kind allows that, else a
//! B-spline through it.

use super::approximate::{self, Jet};
use super::curve::Piece;
use super::curve2d::Piece2d;
use super::error::ReadError;
use crate::geometry::nurbs::NurbsCurve3;
use crate::geometry::{Curve, Curve2d, Surface};

/// A curve in space, and how far it lies from the true image; `None` where it is that.
pub(super) struct Image {
    pub(super) piece: Piece,
    pub(super) off: Option<f64>,
}

/// The image of a piece in the parameters of a surface, within a tolerance.
pub(super) fn of(surface: &Surface, flat: &Piece2d, tolerance: f64) -> Result<Image, ReadError> {
    if let Some(piece) = exact(surface, flat) {
        return Ok(Image { piece, off: None });
    }
    let (from, to) = flat.range;
    if !(to - from).is_finite() {
        return Err(ReadError::EmptyRange { from, to });
    }
    let mut breaks = match &flat.curve {
        Curve2d::Nurbs(curve) | Curve2d::Polyline(curve) => {
            curve.knots().distinct().0.into_iter().filter(|t| *t > from && *t < to).collect()
        }
        _ => Vec::new(),
    };
    breaks.insert(0, from);
    breaks.push(to);
    let what = "a boundary in parameters alone that is too long for its resolution";
    let (curve, off) = approximate::hermite(&|t| at(surface, flat, t), breaks, tolerance, what)?;
    Ok(Image { piece: Piece { curve: Curve::Nurbs(curve), range: (from, to) }, off: Some(off) })
}

/// Parameter lines, and everything on a plane.
fn exact(surface: &Surface, flat: &Piece2d) -> Option<Piece> {
    match (surface, &flat.curve) {
        (Surface::Plane(frame), Curve2d::Line { origin, direction }) => {
            let origin = frame.point(origin.x, origin.y, 0.0);
            let direction = frame.x * direction.x + frame.y * direction.y;
            Some(Piece { curve: Curve::Line { origin, direction }, range: flat.range })
        }
        (Surface::Plane(frame), Curve2d::Nurbs(curve) | Curve2d::Polyline(curve)) => {
            let net = curve.points().iter().map(|&[x, y, w]| {
                let p = frame.origin.coords * w + frame.x * x + frame.y * y;
                [p.x, p.y, p.z, w]
            });
            let lifted = NurbsCurve3::new(curve.knots().clone(), net.collect()).ok()?;
            Some(Piece { curve: Curve::Nurbs(lifted), range: flat.range })
        }
        _ => None,
    }
}

/// Point and derivative of the image.
fn at(surface: &Surface, flat: &Piece2d, t: f64) -> Jet {
    let [p, d, _] = flat.curve.derivatives(t);
    let on = surface.derivatives(p.x, p.y);
    (on.point, on.du * d.x + on.dv * d.y)
}
