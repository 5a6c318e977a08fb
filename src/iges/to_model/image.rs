//! The image of a parameter-space curve on a surface as a curve in space: exact where its kind allows that, else a
//! B-spline through it.

use super::curve::Piece;
use super::curve2d::Piece2d;
use super::error::ReadError;
use crate::geometry::nurbs::{KnotVector, NurbsCurve3};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::{Point3, Vector3};

/// A curve in space, and how far it lies from the true image; `None` where it is that.
pub(super) struct Image {
    pub(super) piece: Piece,
    pub(super) off: Option<f64>,
}

/// Halvings of the interval of an approximation.
const MAX_HALVINGS: u32 = 10;

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
    for _ in 0..MAX_HALVINGS {
        let curve = hermite(surface, flat, &breaks)?;
        let off = distance(surface, flat, &curve, &breaks);
        if off <= tolerance {
            return Ok(Image {
                piece: Piece { curve: Curve::Nurbs(curve), range: (from, to) },
                off: Some(off),
            });
        }
        let middles: Vec<f64> = breaks.array_windows::<2>().map(|[a, b]| 0.5 * (a + b)).collect();
        breaks.extend(middles);
        breaks.sort_by(f64::total_cmp);
    }
    Err(ReadError::KindNotReadYet("a boundary in parameters alone that is too long for its resolution"))
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

/// Cubic pieces between breaks that share point and tangent with the image at both ends.
fn hermite(surface: &Surface, flat: &Piece2d, breaks: &[f64]) -> Result<NurbsCurve3, ReadError> {
    let mut net: Vec<[f64; 4]> = Vec::with_capacity(3 * breaks.len());
    let homogeneous = |p: Point3<f64>| [p.x, p.y, p.z, 1.0];
    for [a, b] in breaks.array_windows::<2>() {
        let third = (b - a) / 3.0;
        // At a corner of the parameter-space curve each piece has its own tangent.
        let inside = (b - a) * 1e-9;
        let ((p, _), (q, _)) = (at(surface, flat, *a), at(surface, flat, *b));
        let (dp, dq) = (at(surface, flat, a + inside).1, at(surface, flat, b - inside).1);
        net.pop();
        net.extend([p, p + dp * third, q - dq * third, q].map(homogeneous));
    }
    let last = breaks.len() - 1;
    let multiplicities: Vec<usize> = (0..=last).map(|i| 3 + usize::from(i == 0 || i == last)).collect();
    let knots = KnotVector::from_multiplicities(3, breaks, &multiplicities)?;
    Ok(NurbsCurve3::new(knots, net)?)
}

/// Point and derivative of the image.
fn at(surface: &Surface, flat: &Piece2d, t: f64) -> (Point3<f64>, Vector3<f64>) {
    let [p, d, _] = flat.curve.derivatives(t);
    let on = surface.derivatives(p.x, p.y);
    (on.point, on.du * d.x + on.dv * d.y)
}

fn distance(surface: &Surface, flat: &Piece2d, curve: &NurbsCurve3, breaks: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for [a, b] in breaks.array_windows::<2>() {
        for part in [0.25, 0.5, 0.75] {
            let t = a + (b - a) * part;
            worst = worst.max((at(surface, flat, t).0 - curve.point_at(t)).norm());
        }
    }
    worst
}
