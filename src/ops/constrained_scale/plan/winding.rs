//! The outline of a face in the parameters of its surface: none where it is the natural border, one loop, or loops that
//! wind round a closed surface, joined along the seam.

use super::layout::LoopShape;
use crate::geometry::nurbs::NurbsSurface;
use crate::ops::constrained_scale::task::Contour;
use crate::ops::net::acting::{closed_directions, winding};

/// Distance from a side of the domain, as a part of its range, within which a loop runs on the natural border.
const ON_BORDER: f64 = 1e-7;

/// A face on a surface that may go round.
pub(super) struct Round<'a> {
    pub surface: &'a NurbsSurface,
    /// Whether the face's normal is the surface's.
    pub same_sense: bool,
}

/// The outline made of the loops that bound no hole.
///
/// # Errors
/// A lower-case fragment when they make none.
pub(super) fn outline(round: &Round<'_>, loops: Vec<LoopShape>) -> Result<Option<Contour>, &'static str> {
    let off: Vec<LoopShape> = loops.into_iter().filter(|l| !on_border(round.surface, &l.contour)).collect();
    if off.is_empty() {
        return Ok(None);
    }
    let (closed, wound): (Vec<LoopShape>, Vec<LoopShape>) = off.into_iter().partition(|l| l.closed);
    match (closed.as_slice(), wound.is_empty()) {
        ([one], true) => Ok(Some(one.contour.clone())),
        ([], false) => round.joined(wound).map(Some),
        _ => Err("its loops wind round the closed surface in more than one way"),
    }
}

/// Whether every point of a loop lies on the natural border of a surface.
fn on_border(surface: &NurbsSurface, contour: &Contour) -> bool {
    let (u, v) = surface.domain();
    let near = |x: f64, (start, end): (f64, f64)| {
        let room = ON_BORDER * (end - start);
        (x - start).abs() <= room || (x - end).abs() <= room
    };
    contour.points.iter().all(|p| near(p[0], u) || near(p[1], v))
}

impl Round<'_> {
    /// One or two loops that wind round the same way, as a polygon that is cut along the seam; with one, the face goes
    /// on to the border on its left.
    fn joined(&self, wound: Vec<LoopShape>) -> Result<Contour, &'static str> {
        let periods = closed_directions(self.surface);
        let turns: Vec<[f64; 2]> = wound.iter().map(|l| winding(&l.contour, periods)).collect();
        let along = (0..2).find(|&k| turns.iter().all(|turn| turn[k] != 0.0 && turn[1 - k] == 0.0));
        let (Some(along), true) = (along, wound.len() <= 2) else {
            return Err("its loops wind round the closed surface in more than one way");
        };
        let (u, v) = self.surface.domain();
        let (range, across) = ([u, v][along], [u, v][1 - along]);
        let margin =
            wound.iter().fold([0.0_f64; 2], |most, l| [0, 1].map(|k| most[k].max(l.contour.margin[k])));
        let mut chains: Vec<Vec<[f64; 2]>> = Vec::new();
        for (shape, turn) in wound.iter().zip(&turns) {
            chains.push(chain(&shape.contour.points, turn[along], along, range));
        }
        if let [only] = chains.as_slice() {
            // Running up, the left is on the side of greater values of the other parameter, or, of `v` running up, of
            // smaller ones; a face that looks against its surface lies on the right.
            let ascends = (turns[0][along] > 0.0) == self.same_sense;
            let upper = ascends == (along == 0);
            let end = if upper { across.1 } else { across.0 };
            let point = |x: f64| if along == 0 { [x, end] } else { [end, x] };
            let border = vec![point(range.0), point(range.1)];
            if only.iter().all(|p| p[1 - along] == end) {
                return Err("a loop winds round the border that the face would go on to");
            }
            chains.push(border);
        }
        let mut points = chains[0].clone();
        points.extend(chains[1].iter().rev());
        Ok(Contour { points, margin })
    }
}

/// A loop that winds once, as a chain from the start of the range to its end.
fn chain(points: &[[f64; 2]], turn: f64, along: usize, range: (f64, f64)) -> Vec<[f64; 2]> {
    let mut run: Vec<[f64; 2]> = points.to_vec();
    if turn < 0.0 {
        run.reverse();
    }
    let period = range.1 - range.0;
    // Two turns of the loop, so that one of them covers the range whole.
    let home = ((run[0][along] - range.0) / period).floor() * period;
    let at = |k: f64| {
        run.iter()
            .map(move |p| {
                let mut q = *p;
                q[along] += k * period - home;
                q
            })
            .collect::<Vec<_>>()
    };
    let long: Vec<[f64; 2]> = [at(-1.0), at(0.0), at(1.0)].concat();
    let value = |x: f64| {
        let pair =
            long.windows(2).find(|w| w[0][along] <= x && w[1][along] >= x && w[1][along] > w[0][along]);
        let pair = pair.unwrap_or(&long[..2]);
        let part = (x - pair[0][along]) / (pair[1][along] - pair[0][along]);
        let mut q = pair[0];
        q[1 - along] += part * (pair[1][1 - along] - pair[0][1 - along]);
        q[along] = x;
        q
    };
    let inside = long.iter().copied().filter(|p| p[along] > range.0 && p[along] < range.1);
    let mut out = vec![value(range.0)];
    out.extend(inside);
    out.push(value(range.1));
    out
}
