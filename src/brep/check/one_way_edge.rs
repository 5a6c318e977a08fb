//! Fact: two faces use their common edge in opposite directions.

use super::Finding;
use super::edge_use::Uses;
use crate::brep::{EdgeId, ShellId};
use crate::math::Point3;

/// Two faces use an edge in the same direction.
#[derive(Debug, Clone, PartialEq)]
pub struct OneWayEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// Looks at the edges of one shell.
pub(super) fn check(uses: &Uses<'_>, findings: &mut Vec<Finding>) {
    for (edge, of) in uses.by_edge() {
        if let [a, b] = of
            && a.along == b.along
        {
            let (shell, place) = (uses.shell, uses.start(edge));
            findings.push(Finding::OneWayEdge(OneWayEdge { shell, edge, place }));
        }
    }
}
