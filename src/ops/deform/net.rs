//! The net that is deformed: fine enough for the lines, with what holds the face in place.

use super::line::Traced;
use crate::geometry::nurbs::{KnotVector, KnotVectorError, NurbsSurface};
use crate::ops::net::acting::{acting_on, closed_directions};
use crate::ops::net::layout::Layout;
use crate::ops::net::{Contour, Mask};

/// Least degree of a surface that is deformed: below it, a net bends in creases.
const LEAST_DEGREE: usize = 3;

/// The same surface with a net that can be deformed: of degree 3 at least, with spans no longer than so many parts of the
/// domain.
pub(super) fn prepared(surface: &NurbsSurface, spans: [usize; 2]) -> Result<NurbsSurface, KnotVectorError> {
    surface.clamped().elevated(LEAST_DEGREE, LEAST_DEGREE)?.with_spans(spans[0], spans[1])
}

/// The control points that may move: not the outermost rows and columns, and none that acts on a loop.
pub(super) fn free(original: &NurbsSurface, net: &NurbsSurface, layout: &Layout, margin: usize) -> Mask {
    let (rows, columns) = net.shape();
    let mut free = Mask::empty(rows, columns).complement().off_border(margin);
    let periods = closed_directions(original);
    for shape in layout.loops.iter().flatten() {
        let contour: &Contour = &shape.contour;
        free = free.without(&acting_on(contour, net, periods));
    }
    free
}

/// The same surface with the spans under the lines cut in two.
pub(super) fn halved(net: &NurbsSurface, lines: &[Traced]) -> Result<NurbsSurface, KnotVectorError> {
    let middles = |knots: &KnotVector, k: usize| {
        let at = || lines.iter().flat_map(|line| &line.points).map(|p| p.at[k]);
        let (low, high) = (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max));
        let all = knots.knots();
        let met = knots.spans().filter(|&s| all[s] <= high && all[s + 1] >= low);
        met.map(|s| 0.5 * (all[s] + all[s + 1])).collect::<Vec<f64>>()
    };
    net.refined_u(&middles(net.knots_u(), 0))?.refined_v(&middles(net.knots_v(), 1))
}

/// Indices of the points of a line at least `step` spans apart, the first and the last among them.
pub(super) fn spaced(net: &NurbsSurface, line: &Traced, step: f64) -> Vec<usize> {
    if line.single {
        return (0..line.points.len()).collect();
    }
    let width = |knots: &KnotVector, t: f64| {
        let k = knots.span(t);
        knots.knots()[k + 1] - knots.knots()[k]
    };
    let way = |a: [f64; 2], b: [f64; 2]| {
        let u = (b[0] - a[0]) / width(net.knots_u(), a[0]);
        let v = (b[1] - a[1]) / width(net.knots_v(), a[1]);
        u.hypot(v)
    };
    let mut chosen = vec![0];
    let mut gone = 0.0;
    for k in 1..line.points.len() {
        gone += way(line.points[k - 1].at, line.points[k].at);
        if gone >= step {
            chosen.push(k);
            gone = 0.0;
        }
    }
    let last = line.points.len() - 1;
    if chosen[chosen.len() - 1] != last {
        // Two points next to each other at the end would be one too many.
        if chosen.len() > 1 && gone < 0.5 * step {
            chosen.pop();
        }
        chosen.push(last);
    }
    chosen
}
