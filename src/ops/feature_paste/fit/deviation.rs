//! How far a fitted surface is from the field that it was fitted to, at its worst place.
//!
//! Least squares are best at the very points at which they were formed, so that the deviation is sought elsewhere: on a
//! grid in every cell, its lines included, and from there uphill where it is greatest.

use super::field::Field;
use crate::geometry::nurbs::{KnotVector, LocalBasis, NurbsSurface};
use crate::ops::net::Mask;

/// Samples of a cell along each parameter; the first stands on the cell's first knot.
const SAMPLES: usize = 4;
/// Part of the greatest sample above which a cell's own is followed uphill.
const HIGH: f64 = 0.8;
/// Cells followed at most.
const FOLLOWED: usize = 2000;
/// Times that the step uphill is halved, from half a distance of samples.
const HALVINGS: u32 = 5;

/// Greatest distance of the displacement from the field, over the cells. `ground` is the surface that was displaced.
pub(super) fn greatest_deviation(
    field: &Field<'_>,
    ground: &NurbsSurface,
    surface: &NurbsSurface,
    cells: &Mask,
) -> f64 {
    let lines = [ground.knots_u(), ground.knots_v()].map(sample_lines);
    let columns = cells.shape().1;
    let mut peaks = Vec::new();
    for cell in cells.indices() {
        let mut peak = Peak { deviation: 0.0, at: [0.0; 2], step: [0.0; 2] };
        let [along, across] = [&lines[0][cell / columns], &lines[1][cell % columns]];
        for (bu, u) in &along.samples {
            for (bv, v) in &across.samples {
                let (old, new) = (ground.derivatives_by(bu, bv), surface.point_by(bu, bv));
                let deviation = (new - old.point - field.at([*u, *v], (&old.du, &old.dv))).norm();
                if deviation > peak.deviation {
                    peak = Peak { deviation, at: [*u, *v], step: [along.step, across.step] };
                }
            }
        }
        peaks.push(peak);
    }
    peaks.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
    let greatest = peaks.first().map_or(0.0, |peak| peak.deviation);
    let high = peaks.into_iter().take_while(|peak| peak.deviation >= HIGH * greatest).take(FOLLOWED);
    let deviation = |at: [f64; 2]| {
        let (old, du, dv) = ground.first_derivatives(at[0], at[1]);
        (surface.point(at[0], at[1]) - old - field.at(at, (&du, &dv))).norm()
    };
    high.map(|peak| peak.uphill(&deviation)).fold(greatest, f64::max)
}

/// A place of great deviation, with the distance of samples there.
struct Peak {
    deviation: f64,
    at: [f64; 2],
    step: [f64; 2],
}

impl Peak {
    /// The deviation at the top, by steps along the parameters that are halved where none leads up.
    fn uphill(mut self, deviation: &dyn Fn([f64; 2]) -> f64) -> f64 {
        let mut share = 0.5;
        for _ in 0..HALVINGS {
            for (k, way) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
                let mut at = self.at;
                at[k] += way * share * self.step[k];
                let found = deviation(at);
                if found > self.deviation {
                    (self.at, self.deviation) = (at, found);
                }
            }
            share *= 0.5;
        }
        self.deviation
    }
}

/// Samples of one cell in one direction.
struct Line {
    samples: Vec<(LocalBasis, f64)>,
    step: f64,
}

fn sample_lines(knots: &KnotVector) -> Vec<Line> {
    let (distinct, _) = knots.distinct();
    let of_cell = |w: &[f64]| {
        let step = (w[1] - w[0]) / SAMPLES as f64;
        let sample = |k: usize| {
            let at = w[0] + step * k as f64;
            (knots.basis_derivatives(at, 2), at)
        };
        Line { samples: (0..SAMPLES).map(sample).collect(), step }
    };
    distinct.windows(2).map(of_cell).collect()
}
