//! Fact: a face lies the same way up as its neighbours.

use super::Finding;
use super::edge_use::Uses;
use crate::brep::{EdgeId, FaceId};
use crate::math::Point3;

/// Every neighbour of a face runs along the common edge as the face does: the face is turned over.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnedFace {
    /// The face.
    pub face: FaceId,
    /// The start of one of its edges.
    pub place: Point3<f64>,
}

/// Looks at the faces of one shell: those of which every edge is used the same way by one other face, where that face
/// has edges that are used well.
pub(super) fn check(uses: &Uses<'_>, findings: &mut Vec<Finding>) {
    for &face in &uses.brep.shells[uses.shell].faces {
        let shared = || uses.edges_of(face).filter(|&edge| is_shared(uses, edge));
        let turned = shared().next().is_some() && shared().all(|edge| is_one_way(uses, edge));
        if !turned {
            continue;
        }
        // Its neighbours are at peace with others: it is this face that is turned.
        let sound =
            |other: FaceId| uses.edges_of(other).any(|e| uses.of_edge(e).len() == 2 && !is_one_way(uses, e));
        let mut others =
            shared().flat_map(|edge| uses.of_edge(edge)).map(|of| of.face).filter(|&f| f != face);
        if let Some(edge) = shared().next().filter(|_| others.all(sound)) {
            findings.push(Finding::TurnedFace(TurnedFace { face, place: uses.start(edge) }));
        }
    }
}

/// Whether two different faces use an edge.
fn is_shared(uses: &Uses<'_>, edge: EdgeId) -> bool {
    matches!(uses.of_edge(edge), [a, b] if a.face != b.face)
}

fn is_one_way(uses: &Uses<'_>, edge: EdgeId) -> bool {
    matches!(uses.of_edge(edge), [a, b] if a.along == b.along)
}
