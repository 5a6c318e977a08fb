//! A proved bound on the distance of a face from the surface that another lies on.

use super::distance::bound_samples;
use super::placed::{PlacedFace, Side};
use crate::geometry::nurbs::{Accuracy, NurbsSurface, deviation};
use crate::math::BoundingBox;
use crate::math::Point3;

/// Bisections at most: a bound within some percent, in a second at most.
const BISECTIONS: usize = 400;

/// Distance that no point of `b` exceeds from the surface of `a`, in common units. `None` where one of the surfaces has no
/// B-spline form.
pub(super) fn bound(before: &Side<'_>, a: &PlacedFace, after: &Side<'_>, b: &PlacedFace) -> Option<f64> {
    let reference = net(before, a)?;
    let new = net(after, b)?;
    let accuracy = Accuracy { ratio: 1.05, floor: 0.0, bisections: BISECTIONS };
    let found = deviation(&new, &reference, &accuracy, &|_| true)?;
    found.bound.is_finite().then_some(found.bound)
}

/// The surface of a face over the parameters that its bounds take, in common coordinates.
fn net(side: &Side<'_>, face: &PlacedFace) -> Option<NurbsSurface> {
    let surface = side.model.brep.surface_of(face.face).read()?;
    let (mut u, mut v) = surface.domain();
    if !(u.0.is_finite() && u.1.is_finite() && v.0.is_finite() && v.1.is_finite()) {
        let inverse = face.transform.inverse()?;
        let parameters = bound_samples(side, face).into_iter().map(|point| {
            let (u, v) = surface.parameters_of(&inverse.point(&point), None);
            Point3::new(u, v, 0.0)
        });
        let parameters: Vec<Point3<f64>> = parameters.collect();
        let taken = BoundingBox::of(&parameters);
        if !(u.0.is_finite() && u.1.is_finite()) {
            u = (taken.min.x, taken.max.x);
        }
        if !(v.0.is_finite() && v.1.is_finite()) {
            v = (taken.min.y, taken.max.y);
        }
    }
    let net = surface.to_nurbs(u, v).ok()?;
    Some(net.transformed(&face.transform))
}
