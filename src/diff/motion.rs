//! Whether two faces are one shape at two places.

use super::Motion;
use super::placed::{PlacedFace, Side};
use crate::brep::{EdgePoint, EdgeSampling, edge_range, sample_curve};
use crate::geometry::Surface;
use crate::math::{Point3, rigid_fit};

/// The rigid motion from one face to another, by points that correspond: those of edges in the order of the loops, and those
/// of nets at equal places. `None` where the faces are not built alike.
pub(super) fn between(before: &Side<'_>, a: &PlacedFace, after: &Side<'_>, b: &PlacedFace) -> Option<Motion> {
    let (from, to) = (marks(before, a)?, marks(after, b)?);
    if from.len() != to.len() || from.len() < 3 {
        return None;
    }
    let pairs: Vec<(Point3<f64>, Point3<f64>)> = from.into_iter().zip(to).collect();
    let fit = rigid_fit(&pairs)?;
    let residual = pairs.iter().map(|(p, q)| (fit.point(p) - q).norm()).fold(0.0, f64::max);
    let count = pairs.len() as f64;
    let shift = pairs.iter().map(|(p, q)| q - p).sum::<crate::math::Vector3<f64>>() / count;
    let cosine = ((fit.linear.trace() - 1.0) / 2.0).clamp(-1.0, 1.0);
    Some(Motion { shift: shift.into(), degrees: cosine.acos().to_degrees(), residual })
}

/// Points of a face that a motion takes to those of its image. `None` for a surface whose shape they do not tell.
fn marks(side: &Side<'_>, face: &PlacedFace) -> Option<Vec<Point3<f64>>> {
    let brep = &side.model.brep;
    let mut marks = Vec::new();
    for coedge in brep.coedges_of(face.face) {
        let edge = brep.coedges[coedge].edge;
        let curve = brep.curve_of(edge).read()?;
        let range = edge_range(brep, edge)?;
        let sampling = EdgeSampling { chord: f64::INFINITY, per_span: 2 };
        marks.extend(sample_curve(curve, range, &sampling).into_iter().map(|EdgePoint { point, .. }| point));
    }
    match brep.surface_of(face.face).read()? {
        // The bounds of a plane are all that it has.
        Surface::Plane(_) => {}
        Surface::Nurbs(net) => marks.extend(net.control_points()),
        // A point between two of the bounds and the middle of the surface there tell how the rest lies.
        surface => {
            let parameters = marks.iter().map(|point| surface.parameters_of(point, None)).collect::<Vec<_>>();
            let (u, v) = parameters.first().copied()?;
            let mean = |part: fn(&(f64, f64)) -> f64, first: f64| {
                first + parameters.iter().map(|at| part(at) - first).sum::<f64>() / parameters.len() as f64
            };
            let (mu, mv) = (mean(|at| at.0, u), mean(|at| at.1, v));
            let (wu, wv) = surface.wrapped(mu, mv);
            marks.push(surface.point(wu, wv));
        }
    }
    Some(marks.iter().map(|point| face.transform.point(point)).collect())
}
