//! Fact: no more than two faces of a shell meet at an edge.

use super::Finding;
use super::edge_use::Uses;
use crate::brep::{EdgeId, ShellId};
use crate::math::Point3;

/// More than two faces of a shell meet at an edge: the shell is no manifold there.
#[derive(Debug, Clone, PartialEq)]
pub struct CrowdedEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// Count of uses.
    pub uses: usize,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// Looks at the edges of one shell.
pub(super) fn check(uses: &Uses<'_>, findings: &mut Vec<Finding>) {
    for (edge, of) in uses.by_edge().filter(|(_, of)| of.len() > 2) {
        let (shell, place) = (uses.shell, uses.start(edge));
        findings.push(Finding::CrowdedEdge(CrowdedEdge { shell, edge, uses: of.len(), place }));
    }
}
