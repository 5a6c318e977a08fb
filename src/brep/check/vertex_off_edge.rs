//! Fact: a vertex lies at the end of every edge that it bounds.

use super::Finding;
use super::limits::Limits;
use super::survey::Survey;
use crate::brep::{EdgeId, FaceId, VertexId};
use crate::diagnostic::Severity;
use crate::math::Point3;
use std::collections::BTreeSet;

/// A vertex is not at the end of its edge.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexOffEdge {
    /// The vertex.
    pub vertex: VertexId,
    /// The edge.
    pub edge: EdgeId,
    /// Distance of the vertex from the edge's curve, in file units.
    pub distance: f64,
    /// A warning where other programs take it for the edge's own tolerance.
    pub severity: Severity,
    /// The vertex's point.
    pub place: Point3<f64>,
}

/// Looks at the edges of some faces, each once.
pub(super) fn check(survey: &Survey<'_>, faces: &[FaceId], limits: &Limits, findings: &mut Vec<Finding>) {
    let brep = survey.brep;
    let edges: BTreeSet<EdgeId> =
        faces.iter().flat_map(|&f| brep.coedges_of(f)).map(|c| brep.coedges[c].edge).collect();
    for id in edges {
        let (Some(curve), Some(range)) = (brep.curve_of(id).read(), survey.range(id)) else { continue };
        let edge = &brep.edges[id];
        for (vertex, t) in [(edge.start, range.start), (edge.end, range.end)] {
            let place = brep.vertices[vertex].point;
            let distance = (curve.point_wrapped(t) - place).norm();
            if distance > limits.tolerance {
                let severity = limits.severity(distance);
                let found = VertexOffEdge { vertex, edge: id, distance, severity, place };
                findings.push(Finding::VertexOffEdge(found));
            }
            if edge.start == edge.end {
                break;
            }
        }
    }
}
