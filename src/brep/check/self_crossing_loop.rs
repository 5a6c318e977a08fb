//! Fact: a loop does not cross itself.

use super::Finding;
use super::crossing::Crossing;
use crate::brep::{FaceId, LoopId, ParameterLoop};
use crate::math::Point3;

/// A loop crosses itself.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfCrossingLoop {
    /// The face.
    pub face: FaceId,
    /// The loop.
    pub bound: LoopId,
    /// Where.
    pub place: Point3<f64>,
}

/// Looks at the places where edges of a face cross.
pub(super) fn check(
    face: FaceId,
    loops: &[ParameterLoop],
    crossings: &[Crossing],
    findings: &mut Vec<Finding>,
) {
    for &Crossing { loops: [a, b], place } in crossings {
        if a == b {
            findings.push(Finding::SelfCrossingLoop(SelfCrossingLoop { face, bound: loops[a].of, place }));
        }
    }
}
