//! Fact: a face that runs round its surface is on the side of its loops that its sense says.

use super::Finding;
use crate::brep::{Brep, FaceId, ParameterLoop};
use crate::geometry::Surface;
use crate::math::Point3;

/// The bounds of a face that runs round its surface leave it on the other side than its sense says.
#[derive(Debug, Clone, PartialEq)]
pub struct InconsistentSense {
    /// The face.
    pub face: FaceId,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// Looks at one face.
pub(super) fn check(brep: &Brep, face: FaceId, loops: &[ParameterLoop], findings: &mut Vec<Finding>) {
    let Some(first) = loops.iter().find_map(|l| l.points.first()) else { return };
    if runs_wrong(brep, face, loops) {
        findings.push(Finding::InconsistentSense(InconsistentSense { face, place: first.point }));
    }
}

/// Whether two or more loops that run round a surface with borders leave a negative area to their left.
fn runs_wrong(brep: &Brep, face: FaceId, loops: &[ParameterLoop]) -> bool {
    let Some(surface) = brep.surface_of(face).read() else { return false };
    let (around, total): (usize, f64) = loops
        .iter()
        .filter(|l| l.winding.0 != 0.0 && l.winding.1 == 0.0)
        .fold((0, 0.0), |(n, sum), l| (n + 1, sum + l.winding.0));
    let both_ways = loops.iter().any(|l| l.winding.1 != 0.0);
    let closed = matches!(surface, Surface::Sphere { .. } | Surface::Torus { .. })
        || matches!(surface.periods(), (Some(_), Some(_)));
    if around < 2 || both_ways || closed || total.abs() > 1e-9 {
        return false;
    }
    let mut area = 0.0;
    let mut size = 0.0f64;
    for of in loops {
        let Some(first) = of.points.first() else { continue };
        let ends = of.points.iter().skip(1).map(|p| (p.u, p.v)).chain([(first.u + of.winding.0, first.v)]);
        let mut here = (first.u, first.v);
        for to in ends {
            area -= 0.5 * (here.1 + to.1) * (to.0 - here.0);
            size = size.max(to.1.abs() * (to.0 - here.0).abs());
            here = to;
        }
    }
    let signed = if brep.faces[face].same_sense { area } else { -area };
    signed < -1e-9 * size
}
