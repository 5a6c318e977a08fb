//! Fact: an edge is longer than the tolerance.

use super::Finding;
use super::survey::Survey;
use crate::brep::{EdgeId, FaceId};
use crate::math::Point3;
use std::collections::BTreeSet;

/// An edge is shorter than the tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct DegenerateEdge {
    /// The edge.
    pub edge: EdgeId,
    /// Its length, in file units.
    pub length: f64,
    /// Its start.
    pub place: Point3<f64>,
}

/// Looks at the edges of some faces, each once.
pub(super) fn check(survey: &Survey<'_>, faces: &[FaceId], tolerance: f64, findings: &mut Vec<Finding>) {
    let brep = survey.brep;
    let edges: BTreeSet<EdgeId> =
        faces.iter().flat_map(|&face| brep.coedges_of(face)).map(|c| brep.coedges[c].edge).collect();
    for edge in edges {
        let Some(sampled) = survey.edge(edge) else { continue };
        let points = &sampled.points;
        let length: f64 = points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
        if length <= tolerance {
            let place = points[0].point;
            findings.push(Finding::DegenerateEdge(DegenerateEdge { edge, length, place }));
        }
    }
}
