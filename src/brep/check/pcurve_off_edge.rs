//! Fact: a pcurve, taken through its surface, lies on its edge's curve.

use super::Finding;
use super::limits::Limits;
use super::survey::Survey;
use crate::brep::{CoedgeId, FaceId};
use crate::diagnostic::Severity;
use crate::math::Point3;

/// A pcurve does not lie on its edge.
#[derive(Debug, Clone, PartialEq)]
pub struct PcurveOffEdge {
    /// The use of the edge.
    pub coedge: CoedgeId,
    /// Greatest distance of the pcurve's sampled points from the edge's curve, in file units.
    pub distance: f64,
    /// A warning where other programs take it for the edge's own tolerance.
    pub severity: Severity,
    /// The pcurve's point at that distance.
    pub place: Point3<f64>,
}

/// Samples of each pcurve: enough to meet an error of low degree on every part of it.
const SAMPLES: usize = 17;

/// Part of an edge's interval by which a parameter curve may fall short of it and still count as running over the
/// same parameters: domains are often written with six digits.
const SAME_DOMAIN: f64 = 1e-6;

/// Looks at the coedges of a face that have pcurves.
///
/// The standard asks that pcurve and curve be the same points, not that they share the parameter; a pcurve
/// over another interval is compared end to end.
pub(super) fn check(survey: &Survey<'_>, face: FaceId, limits: &Limits, findings: &mut Vec<Finding>) {
    let brep = survey.brep;
    let Some(surface) = brep.surface_of(face).read() else { return };
    for coedge in brep.coedges_of(face) {
        let of = &brep.coedges[coedge];
        let (Some(pcurve), Some(curve), Some(range)) =
            (&of.pcurve, brep.curve_of(of.edge).read(), survey.range(of.edge))
        else {
            continue;
        };
        let (low, high) = (range.start.min(range.end), range.start.max(range.end));
        let (first, last) = pcurve.domain();
        let slack = SAME_DOMAIN * (high - low);
        let shares = first <= low + slack && last >= high - slack;
        let mut worst = (0.0, Point3::origin());
        for i in 0..SAMPLES {
            let part = i as f64 / (SAMPLES - 1) as f64;
            let t = low + (high - low) * part;
            let p = pcurve.point_at(if shares { t } else { first + (last - first) * part });
            let point = surface.point(p.x, p.y);
            let same = (curve.point_wrapped(t) - point).norm();
            let nearest = || (curve.point_wrapped(curve.parameter_of(&point, Some(t))) - point).norm();
            let distance = if same <= limits.tolerance { same } else { same.min(nearest()) };
            if distance > worst.0 {
                worst = (distance, point);
            }
        }
        if worst.0 > limits.tolerance {
            let (distance, place) = worst;
            let severity = limits.severity(distance);
            findings.push(Finding::PcurveOffEdge(PcurveOffEdge { coedge, distance, severity, place }));
        }
    }
}
