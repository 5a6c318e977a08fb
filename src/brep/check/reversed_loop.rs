//! Fact: seen against the face's normal, an outer bound runs counter-clockwise and an inner one clockwise.

use super::Finding;
use crate::brep::{Brep, FaceId, LoopId, ParameterLoop};
use crate::geometry::Surface;
use crate::math::Point3;

/// Which bound a loop should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundKind {
    /// The one that holds the others.
    Outer,
    /// A hole's.
    Inner,
}

/// An outer bound runs clockwise, or an inner one counter-clockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct ReversedLoop {
    /// The face.
    pub face: FaceId,
    /// The loop.
    pub bound: LoopId,
    /// What it is by its place.
    pub kind: BoundKind,
    /// A point of the loop.
    pub place: Point3<f64>,
}

/// Looks at the loops of a face that enclose an area in the parameter plane.
///
/// Loops that run round a closed surface are passed over, as are spheres and tori: there the same loop bounds
/// the part to its left either way.
pub(super) fn check(brep: &Brep, face: FaceId, loops: &[ParameterLoop], findings: &mut Vec<Finding>) {
    let closed = brep
        .surface_of(face)
        .read()
        .is_none_or(|s| matches!(s, Surface::Sphere { .. }) || matches!(s.periods(), (Some(_), Some(_))));
    let areas: Vec<Option<f64>> = loops.iter().map(ParameterLoop::signed_area).collect();
    let whole = loops.iter().zip(&areas).all(|(l, a)| a.is_some() || l.points.is_empty());
    if closed || !whole {
        return;
    }
    let flagged = (0..loops.len()).find(|&i| brep.loops[loops[i].of].outer);
    let size = |i: usize| areas[i].map_or(0.0, f64::abs);
    let outer = flagged.or_else(|| (0..loops.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))));
    for (i, bound) in loops.iter().enumerate() {
        let (Some(area), Some(first)) = (areas[i], bound.points.first()) else { continue };
        let kind = if outer == Some(i) { BoundKind::Outer } else { BoundKind::Inner };
        let expected = (kind == BoundKind::Outer) == brep.faces[face].same_sense;
        if area != 0.0 && (area > 0.0) != expected {
            let place = first.point;
            findings.push(Finding::ReversedLoop(ReversedLoop { face, bound: bound.of, kind, place }));
        }
    }
}
