//! Fact: the bounds of a face enclose a piece of its surface.

use super::Finding;
use crate::brep::mass_properties::{MassPropertiesError, Quadrature, of_loops};
use crate::brep::{Brep, FaceId, ParameterLoop};
use crate::math::Point3;

/// Bounds run round a surface and leave a side open where it has no end: a seam, or another bound, is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingSeam {
    /// The face.
    pub face: FaceId,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// Looks at one face.
pub(super) fn check(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    tolerance: f64,
    findings: &mut Vec<Finding>,
) {
    let Some(first) = loops.iter().find_map(|l| l.points.first()) else { return };
    if loops.iter().all(|l| l.winding == (0.0, 0.0)) {
        return;
    }
    let place = first.point;
    let found = of_loops(brep, face, loops, &Quadrature::rough(tolerance), place);
    if let Err(MassPropertiesError::Endless { .. } | MassPropertiesError::BothWays { .. }) = found {
        findings.push(Finding::MissingSeam(MissingSeam { face, place }));
    }
}
