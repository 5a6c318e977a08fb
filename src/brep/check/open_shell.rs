//! Fact: every edge of a shell that is said to be closed has a face on either side.

use super::Finding;
use super::edge_use::Uses;
use crate::brep::{EdgeId, ShellId};
use crate::math::Point3;

/// An edge of a shell that is said to be closed has a face on one side only.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeEdge {
    /// The shell.
    pub shell: ShellId,
    /// The edge.
    pub edge: EdgeId,
    /// The edge's start.
    pub place: Point3<f64>,
}

/// A shell that is said to be closed has edges with a face on one side only.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenShell {
    /// The shell.
    pub shell: ShellId,
    /// Count of such edges.
    pub free_edges: usize,
    /// The start of one.
    pub place: Point3<f64>,
}

/// Looks at the edges of one shell: each free one, and the shell that they open.
pub(super) fn check(uses: &Uses<'_>, findings: &mut Vec<Finding>) {
    let shell = uses.shell;
    if !uses.brep.shells[shell].closed {
        return;
    }
    let mut open: Option<OpenShell> = None;
    for (edge, _) in uses.by_edge().filter(|(_, uses)| uses.len() == 1) {
        let place = uses.start(edge);
        findings.push(Finding::FreeEdge(FreeEdge { shell, edge, place }));
        open.get_or_insert(OpenShell { shell, free_edges: 0, place }).free_edges += 1;
    }
    findings.extend(open.map(Finding::OpenShell));
}
