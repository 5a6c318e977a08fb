//! Fact: the bounds of a face neither cross each other nor lie outside the outer one.

use super::Finding;
use super::crossing::Crossing;
use crate::brep::{Brep, FaceId, LoopId, ParameterLoop};
use crate::geometry::Surface;
use crate::math::Point3;

/// Two bounds of a face cross, or an inner one lies outside the outer one.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlappingBounds {
    /// The face.
    pub face: FaceId,
    /// One of the loops, an inner one.
    pub bound: LoopId,
    /// Where.
    pub place: Point3<f64>,
}

/// Looks at the places where edges of a face cross, and at the bounds that lie apart.
pub(super) fn check(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    crossings: &[Crossing],
    findings: &mut Vec<Finding>,
) {
    for &Crossing { loops: [a, b], place } in crossings {
        if a != b {
            findings.push(Finding::OverlappingBounds(OverlappingBounds { face, bound: loops[b].of, place }));
        }
    }
    outside(brep, face, loops, crossings, findings);
}

/// Inner bounds all of whose points lie outside the outer one.
fn outside(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    crossings: &[Crossing],
    findings: &mut Vec<Finding>,
) {
    let closed = brep.surface_of(face).read().is_none_or(|surface| {
        matches!(surface, Surface::Sphere { .. }) || matches!(surface.periods(), (Some(_), _) | (_, Some(_)))
    });
    let size = |i: &usize| loops[*i].signed_area().map_or(0.0, f64::abs);
    let biggest = (0..loops.len()).max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some(outer) = biggest.filter(|_| !closed && loops.iter().all(|l| l.winding == (0.0, 0.0))) else {
        return;
    };
    for (i, bound) in loops.iter().enumerate() {
        let crosses = crossings.iter().any(|of| of.loops[0] != of.loops[1] && of.loops.contains(&i));
        if i == outer || bound.points.is_empty() || crosses {
            continue;
        }
        if !bound.points.iter().any(|p| is_inside(&loops[outer], (p.u, p.v))) {
            let place = bound.points[0].point;
            findings.push(Finding::OverlappingBounds(OverlappingBounds { face, bound: bound.of, place }));
        }
    }
}

fn is_inside(polygon: &ParameterLoop, (u, v): (f64, f64)) -> bool {
    let points = &polygon.points;
    let crossings = (0..points.len()).filter(|&i| {
        let (a, b) = (&points[i], &points[(i + 1) % points.len()]);
        (a.v > v) != (b.v > v) && u < a.u + (v - a.v) / (b.v - a.v) * (b.u - a.u)
    });
    crossings.count() % 2 == 1
}
