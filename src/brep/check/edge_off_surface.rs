//! Fact: an edge lies on the surface of every face that it bounds.

use super::Finding;
use super::limits::Limits;
use crate::brep::{CoedgeId, FaceId, LoopPoint, ParameterLoop};
use crate::diagnostic::Severity;
use crate::math::Point3;

/// An edge leaves the surface of its face.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeOffSurface {
    /// The face.
    pub face: FaceId,
    /// The use of the edge.
    pub coedge: CoedgeId,
    /// Greatest distance of the sampled points of the edge from the surface, in file units.
    pub distance: f64,
    /// A warning where other programs take it for the edge's own tolerance.
    pub severity: Severity,
    /// The edge's point at that distance.
    pub place: Point3<f64>,
}

/// Looks at the sampled loops of a face: one finding for each coedge, at its worst point.
pub(super) fn check(face: FaceId, loops: &[ParameterLoop], limits: &Limits, findings: &mut Vec<Finding>) {
    for points in loops.iter().flat_map(|l| l.points.chunk_by(|a, b| a.coedge == b.coedge)) {
        let mut worst: &LoopPoint = &points[0];
        for point in points {
            if point.gap > worst.gap {
                worst = point;
            }
        }
        if worst.gap > limits.tolerance {
            findings.push(Finding::EdgeOffSurface(EdgeOffSurface {
                face,
                coedge: worst.coedge,
                distance: worst.gap,
                severity: limits.severity(worst.gap),
                place: worst.point,
            }));
        }
    }
}
