//! Which way the loops of a loose face run: with the face to the left, the outer one and the inner ones apart.
//!
//! A trimmed surface does not say (IGES 5.3 section 4.34); a bounded one does, and files are wrong about it.

use crate::brep::{Brep, EdgeSampling, FaceId, LoopSampling, ParameterLoop, parameter_loops};

/// Chords of a span that tell the area of a loop.
const CHORDS: usize = 4;

/// Loops that run with the face to their right, as they are; `None` where that cannot be told.
///
/// `outer` is the place of the outer loop among those of the face; without it, it is the greatest.
pub(super) fn reversed(brep: &Brep, face: FaceId, outer: Option<usize>, tolerance: f64) -> Option<Vec<bool>> {
    let sampling = LoopSampling {
        edge: EdgeSampling { per_span: CHORDS, ..EdgeSampling::default() },
        ..LoopSampling::of_tolerance(tolerance)
    };
    let loops = parameter_loops(brep, face, &sampling).ok()?;
    let areas: Vec<f64> = loops.iter().map(area).collect();
    let greatest = || (0..areas.len()).max_by(|&a, &b| areas[a].abs().total_cmp(&areas[b].abs()));
    let outer = outer.or_else(greatest)?;
    // Seen against the normal of a face whose sense is not its surface's, left is right.
    let sense = if brep.faces[face].same_sense { 1.0 } else { -1.0 };
    let winds = |of: &ParameterLoop| of.winding.0 != 0.0 || of.winding.1 != 0.0;
    let around: Vec<usize> = (0..loops.len()).filter(|&at| winds(&loops[at])).collect();
    let reversed = |at: usize| {
        if winds(&loops[at]) {
            return rounds_wrong(&loops, &around, at, sense);
        }
        let wanted = if at == outer { sense } else { -sense };
        areas[at] * wanted < 0.0
    };
    Some((0..loops.len()).map(reversed).collect())
}

fn area(of: &ParameterLoop) -> f64 {
    let points = &of.points;
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| 0.5 * (a.u * b.v - b.u * a.v)).sum()
}

/// Whether a loop that goes round a closed surface runs with the others to its right: of two, the lower one runs with
/// growing `u`, that of the smaller `u` with falling `v`.
fn rounds_wrong(loops: &[ParameterLoop], around: &[usize], at: usize, sense: f64) -> bool {
    let own = &loops[at];
    let across = own.winding.0 != 0.0;
    let middle = |of: &ParameterLoop| {
        let sum: f64 = of.points.iter().map(|point| if across { point.v } else { point.u }).sum();
        sum / of.points.len().max(1) as f64
    };
    let here = middle(own);
    let Some(other) = around.iter().filter(|&&other| other != at).map(|&other| middle(&loops[other])).next()
    else {
        // Alone, it bounds the side of a pole, or nothing that could be told.
        return false;
    };
    let lower = here < other;
    let runs = if across { own.winding.0 } else { -own.winding.1 };
    (runs * sense > 0.0) != lower
}
