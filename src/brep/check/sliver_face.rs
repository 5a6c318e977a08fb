//! Fact: a face is wider than the tolerance.

use super::Finding;
use crate::brep::mass_properties::{Quadrature, of_loops};
use crate::brep::{Brep, FaceId, ParameterLoop};
use crate::math::{Point3, Vector3};

/// A face that is narrower than the tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct SliverFace {
    /// The face.
    pub face: FaceId,
    /// Twice its area over the length of its bounds, in file units.
    pub width: f64,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// Factor on the tolerance below which the flat measure of a width makes a face worth measuring.
const SUSPECT: f64 = 4.0;

/// Looks at one face.
pub(super) fn check(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    tolerance: f64,
    findings: &mut Vec<Finding>,
) {
    let Some(first) = loops.iter().find_map(|l| l.points.first()) else { return };
    let length: f64 = loops.iter().map(length).sum();
    // A polygon of small vector area may still be wide: the area decides.
    if length == 0.0 || 2.0 * vector_area(loops) > SUSPECT * tolerance * length {
        return;
    }
    let place = first.point;
    if let Ok(found) = of_loops(brep, face, loops, &Quadrature::rough(tolerance), place) {
        let width = 2.0 * found.area() / length;
        if width <= tolerance {
            findings.push(Finding::SliverFace(SliverFace { face, width, place }));
        }
    }
}

fn length(of: &ParameterLoop) -> f64 {
    let closing = of.points.last().zip(of.points.first()).map(|(a, b)| (b.point - a.point).norm());
    of.points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum::<f64>() + closing.unwrap_or(0.0)
}

/// Length of the sum of the loops' vector areas.
fn vector_area(loops: &[ParameterLoop]) -> f64 {
    let mut sum = Vector3::zeros();
    for points in loops.iter().map(|l| &l.points).filter(|p| !p.is_empty()) {
        let origin = points[0].point;
        for w in points.windows(2) {
            sum += (w[0].point - origin).cross(&(w[1].point - origin)) * 0.5;
        }
    }
    sum.norm()
}
