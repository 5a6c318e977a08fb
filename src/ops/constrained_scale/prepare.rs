//! Checks that surfaces and loops must pass before anything is computed.

use super::ScaleError;
use super::envelope::{Prepared, PreparedLoop};
use super::polygon::{Domain, Polygon, PolygonFault};
use super::task::{Contour, FaceTask};
use crate::geometry::nurbs::KnotVector;

/// Checks a task and clamps its surface.
pub(super) fn prepare(task: &FaceTask<'_>) -> Result<Prepared, ScaleError> {
    let face = || task.name.clone();
    for (direction, knots) in [("u", task.surface.knots_u()), ("v", task.surface.knots_v())] {
        if let Some(knot) = torn_at(knots) {
            return Err(ScaleError::BadKnots { face: face(), direction, knot, degree: knots.degree() });
        }
    }
    let surface = task.surface.clamped();
    let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
    let held = task.held.iter().enumerate().map(|(k, l)| {
        let polygon = checked(&l.contour, domain, &task.name, k)?;
        Ok(PreparedLoop { polygon, hold: l.hold })
    });
    let held = held.collect::<Result<Vec<_>, _>>()?;
    let more = |k: usize| task.held.len() + k;
    let scaled = task.scaled.iter().enumerate().map(|(k, c)| checked(c, domain, &task.name, more(k)));
    let scaled = scaled.collect::<Result<Vec<_>, _>>()?;
    let last = more(task.scaled.len());
    let outer = task.outer.as_ref().map(|c| checked(c, domain, &task.name, last)).transpose()?;
    for first in 0..held.len() {
        for second in first + 1..held.len() {
            if held[first].polygon.overlaps(&held[second].polygon) {
                return Err(ScaleError::HeldLoopsOverlap { face: face(), first, second });
            }
        }
    }
    Ok(Prepared { name: face(), surface, held, outer, scaled })
}

/// An interior knot that occurs more than degree times.
fn torn_at(knots: &KnotVector) -> Option<f64> {
    let (start, end) = knots.domain();
    let (distinct, multiplicities) = knots.distinct();
    let inner = distinct.iter().zip(multiplicities).filter(|(k, _)| **k > start && **k < end);
    inner.filter(|(_, m)| *m > knots.degree()).map(|(k, _)| *k).next()
}

fn checked(contour: &Contour, domain: Domain, face: &str, held: usize) -> Result<Polygon, ScaleError> {
    let face = || face.to_owned();
    Polygon::new(&contour.points, contour.margin, domain).map_err(|fault| match fault {
        PolygonFault::NotFinite => ScaleError::NonFiniteInput { face: face(), what: "a loop" },
        PolygonFault::Outside(at) => ScaleError::LoopOutsideDomain { face: face(), held, at },
        PolygonFault::Degenerate => ScaleError::LoopDegenerate { face: face(), held },
        PolygonFault::Crosses(at) => ScaleError::LoopSelfIntersects { face: face(), held, at },
    })
}
