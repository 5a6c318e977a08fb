//! Fact: edges that follow each other in a loop end at one place.

use super::Finding;
use super::limits::Limits;
use super::survey::Survey;
use crate::brep::{Brep, CoedgeId, FaceId};
use crate::diagnostic::Severity;
use crate::math::Point3;

/// The curves of two edges that follow each other in a loop end apart, though their vertex is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// The later of the two uses.
    pub coedge: CoedgeId,
    /// Distance of the ends, in file units.
    pub distance: f64,
    /// A warning where other programs take it for the edges' own tolerance.
    pub severity: Severity,
    /// Where the earlier one ends.
    pub place: Point3<f64>,
}

/// Tolerances that two ends of edges may be apart: each may be one off their vertex.
const BOTH_ENDS: f64 = 2.0;

/// Looks at the loops of a face.
pub(super) fn check(survey: &Survey<'_>, face: FaceId, limits: &Limits, findings: &mut Vec<Finding>) {
    let brep = survey.brep;
    for &bound in &brep.faces[face].loops {
        let coedges = &brep.loops[bound].coedges;
        let ends: Vec<Option<[Point3<f64>; 2]>> = coedges.iter().map(|&c| curve_ends(survey, c)).collect();
        for i in 0..coedges.len() {
            let next = (i + 1) % coedges.len();
            let (Some([_, end]), Some([start, _])) = (ends[i], ends[next]) else { continue };
            let distance = (start - end).norm();
            if distance > BOTH_ENDS * limits.tolerance && joined(brep, coedges[i], coedges[next]) {
                let (coedge, severity) = (coedges[next], limits.severity(distance));
                findings.push(Finding::Gap(Gap { coedge, distance, severity, place: end }));
            }
        }
    }
}

/// Ends of the curve of an edge, in the direction of its use.
fn curve_ends(survey: &Survey<'_>, coedge: CoedgeId) -> Option<[Point3<f64>; 2]> {
    let of = &survey.brep.coedges[coedge];
    let points = &survey.edge(of.edge)?.points;
    let (start, end) = (points.first()?.point, points.last()?.point);
    Some(if of.forward { [start, end] } else { [end, start] })
}

/// Whether one use ends at the vertex at which the other starts.
fn joined(brep: &Brep, from: CoedgeId, to: CoedgeId) -> bool {
    let (a, b) = (&brep.coedges[from], &brep.coedges[to]);
    let (ea, eb) = (&brep.edges[a.edge], &brep.edges[b.edge]);
    (if a.forward { ea.end } else { ea.start }) == (if b.forward { eb.start } else { eb.end })
}
