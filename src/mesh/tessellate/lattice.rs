//! How finely a surface wants to be divided: parameter lines by its curvature, and a scale of the parameter
//! plane in which well-shaped triangles are well shaped on the surface.

use super::Tolerances;
use super::region::Shape;

/// Samples a side at which the curvature is looked at, at most; a [`Shape`] may need fewer.
pub(super) const SAMPLES: usize = 17;

/// Most lines in one direction: the face's triangles are refined afterwards where that is not enough.
const MOST_LINES: f64 = 400.0;

/// Greatest ratio of the sides of a cell on the surface that the scale follows. On a cylinder long thin
/// triangles are right; without a limit the plane would shrink to a line.
const ASPECT: f64 = 8.0;

/// Inner parameter lines in both directions, and the scale.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lattice {
    /// Lines of equal `u`, ascending.
    pub us: Vec<f64>,
    /// Lines of equal `v`, ascending.
    pub vs: Vec<f64>,
    /// Factors from parameters to the plane of the triangulation; positive.
    pub scale: [f64; 2],
}

impl Lattice {
    /// Looks at a surface over a rectangle of parameters; `None` when the rectangle is degenerate or the
    /// surface is not finite there.
    pub(super) fn new(
        [low, high]: [[f64; 2]; 2],
        tolerances: &Tolerances,
        shape: &impl Shape,
    ) -> Option<Self> {
        let range = [high[0] - low[0], high[1] - low[1]];
        if !range.iter().all(|r| r.is_finite() && *r > 0.0) {
            return None;
        }
        // Cells wanted for a unit of the parameter, at each sampled line, and means of |du| and |dv|.
        let counts = shape.samples([low, high]);
        let places = [0, 1].map(|k| -> Vec<f64> {
            (0..counts[k]).map(|i| low[k] + range[k] * share(i, counts[k])).collect()
        });
        let mut density = counts.map(|count| vec![0.0f64; count]);
        let mut speed = [0.0; 2];
        for (at, d) in shape.grid(&places[0], &places[1]).iter().enumerate() {
            let (i, j) = (at / counts[1], at % counts[1]);
            let Some(normal) = d.normal() else { continue };
            let along_u = wanted(d.du.norm(), d.duu.dot(&normal).abs(), tolerances);
            let along_v = wanted(d.dv.norm(), d.dvv.dot(&normal).abs(), tolerances);
            density[0][i] = density[0][i].max(along_u);
            density[1][j] = density[1][j].max(along_v);
            speed = [speed[0] + d.du.norm(), speed[1] + d.dv.norm()];
        }
        let lines = [0, 1].map(|k| divide(low[k], range[k], &density[k]));
        let cells = [0, 1].map(|k| mean(&density[k]) * range[k]);
        let scale = scale(range, speed, cells)?;
        let [us, vs] = lines;
        Some(Self { us, vs, scale })
    }
}

/// Place of a sample within its range: inside, so that poles are passed over.
#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn share(sample: usize, count: usize) -> f64 {
    (sample as f64 + 0.5) / count as f64
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Cells for a unit of a parameter with the given speed and bend (second derivative along the normal). A cell
/// of step h sags by bend h²/8; half the chord tolerance is left to the other direction.
fn wanted(speed: f64, bend: f64, tolerances: &Tolerances) -> f64 {
    let by_chord = (bend / (4.0 * tolerances.chord)).sqrt();
    let by_angle = if speed > 0.0 { bend / (speed * tolerances.angle) } else { 0.0 };
    let cells = by_chord.max(by_angle);
    if cells.is_finite() { cells } else { 0.0 }
}

/// Inner lines that share the sum of the density evenly.
#[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "at most MOST_LINES")]
#[expect(clippy::cast_sign_loss, reason = "densities are not negative")]
fn divide(low: f64, range: f64, density: &[f64]) -> Vec<f64> {
    let step = range / density.len() as f64;
    let total: f64 = density.iter().sum::<f64>() * step;
    let count = total.ceil().min(MOST_LINES) as usize;
    let mut lines = Vec::with_capacity(count);
    let mut before = 0.0;
    for (k, d) in density.iter().enumerate() {
        let after = before + d * step;
        while lines.len() + 1 < count {
            let goal = total * (lines.len() + 1) as f64 / count as f64;
            if goal > after {
                break;
            }
            lines.push(low + step * (k as f64 + (goal - before) / (after - before)));
        }
        before = after;
    }
    lines
}

/// Scale that makes cells square, within [`ASPECT`] of what is square on the surface.
fn scale(range: [f64; 2], speed: [f64; 2], cells: [f64; 2]) -> Option<[f64; 2]> {
    let length = [0, 1].map(|k| speed[k] * range[k]);
    let longest = length[0].max(length[1]);
    if !(longest.is_finite() && length[0] > 0.0 && length[1] > 0.0) {
        return None;
    }
    let least = [0, 1].map(|k| cells[1 - k] * length[k] / (length[1 - k] * ASPECT));
    let flat = cells[0].max(cells[1]) < 1.0;
    let sides = [0, 1].map(|k| if flat { length[k] / longest } else { cells[k].max(least[k]) });
    let scale = [sides[0] / range[0], sides[1] / range[1]];
    scale.iter().all(|s| s.is_finite() && *s > 0.0).then_some(scale)
}
