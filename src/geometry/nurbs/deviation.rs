//! How far one surface is from another at most, proved and not sampled.
//!
//! **Claim.** Every point of the new surface `N` (over the cells that are asked for) is within
//! [`Deviation::bound`] of the reference `W`.
//!
//! **Proof.** A cell is a rectangle on which `N` is one polynomial piece (with weights: a quotient of such). Take any four
//! parameter points of `W` for its corners, and let `ψ` be the bilinear map between. It stays in the hull of the four
//! points, so in `W`'s domain, and `dist(N(s, t), W) <= |N(s, t) - W(ψ(s, t))|` for each point of the cell, whatever `ψ` is.
//! `W(ψ(s, t))` is one of the pieces `W_ab` of `W` that the rectangle round the four points meets, so the distance is at most
//! the greatest over these pieces of `|N - W_ab ∘ ψ|` over the whole cell, each piece being continued beyond its span where
//! need be. `W_ab ∘ ψ` is a polynomial of degree `p + q` in both parameters (numerator and weight alike), and so the
//! difference lies in the hull of its control points: for the rational case see `bezier::distance_bound`. ∎
//!
//! How tight the bound is depends on `ψ`: the corners' closest points make the difference nearly normal to `W`. It is
//! tightened by bisecting the cell with the greatest bound, until that is within [`Accuracy::ratio`] of the greatest
//! distance found at a corner.
//!
//! One-sided: from the new surface to the reference. Where both have the same border, the other side follows in so far as
//! `W` has no part that no path within the bound leads to. Rounding is allowed for by a part of the coordinates' size.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::bezier::{BezierPatch, Extraction, distance_bound};
use super::project::{SurfaceProjection, Wrap};
use super::{KnotVector, NurbsSurface};
use crate::math::Point3;

/// A proved bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// No point of the new surface is further from the reference; infinite where weights of the continued reference
    /// vanish within reach of a cell.
    pub bound: f64,
    /// Greatest distance found at a corner of a cell: how tight the bound is.
    pub found: f64,
    /// Cells that were looked at.
    pub cells: usize,
}

/// When a bound is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Quotient of the bound and the greatest distance found, above 1.
    pub ratio: f64,
    /// Distance below which nothing is bisected.
    pub floor: f64,
    /// Bisections at most; what is not bisected any more keeps its bound.
    pub bisections: usize,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self { ratio: 1.02, floor: 0.0, bisections: 4_000 }
    }
}

/// Part of the greatest coordinate that is added for rounding.
const ROUNDING: f64 = 1e-12;
/// Part of the domain's length within which a foot point counts as on a knot: it then meets one piece less.
const ON_KNOT: f64 = 1e-11;

/// Bounds the distance of a new surface from a reference over the cells for which `include` holds: pairs of indices of
/// the spans of the new surface's knots that are not empty, along `u` and along `v`. `None` when that is none of them.
///
/// The parameters of the two surfaces should correspond roughly: the search for closest points starts at equal ones. Time
/// is linear in the count of cells and of bisections.
#[must_use]
pub fn deviation(
    new: &NurbsSurface,
    reference: &NurbsSurface,
    accuracy: &Accuracy,
    include: &dyn Fn([usize; 2]) -> bool,
) -> Option<Deviation> {
    let comparison = Comparison::new(new, reference);
    let spans = [new.knots_u(), new.knots_v()].map(|knots| knots.spans().collect::<Vec<usize>>());
    let grid = comparison.feet(&spans);
    let columns = spans[1].len() + 1;
    let mut queue = Queue::new(*accuracy);
    for i in 0..spans[0].len() {
        for j in 0..spans[1].len() {
            if include([i, j]) {
                let at = i * columns + j;
                let feet = [at, at + 1, at + columns, at + columns + 1].map(|k| grid[k]);
                let range = [(new.knots_u(), spans[0][i]), (new.knots_v(), spans[1][j])]
                    .map(|(knots, k)| (knots.knots()[k], knots.knots()[k + 1]));
                queue.add(&comparison, Cell { spans: [spans[0][i], spans[1][j]], range, feet });
            }
        }
    }
    queue.tighten(&comparison);
    queue.result(ROUNDING * comparison.magnitude)
}

/// Bounds the distance of two surfaces over one domain at equal parameters, from above: the greatest over the cells of
/// both surfaces' knots, on each of which the difference is one patch.
#[must_use]
pub fn deviation_at_equal_parameters(a: &NurbsSurface, b: &NurbsSurface) -> f64 {
    let rational = a.is_rational() || b.is_rational();
    let along = |[a, b]: [&KnotVector; 2]| -> Vec<[Extraction; 2]> {
        let (start, end) = a.domain();
        let mut all = [a.knots(), b.knots()].concat();
        all.retain(|knot| *knot >= start && *knot <= end);
        all.sort_by(f64::total_cmp);
        all.dedup();
        let intervals = all.windows(2).map(|pair| (pair[0], pair[1]));
        intervals.map(|cell| [a, b].map(|knots| Extraction::new(knots, knots.span(cell.0), cell))).collect()
    };
    let columns = along([a.knots_v(), b.knots_v()]);
    let mut worst = 0.0_f64;
    for [of_a, of_b] in along([a.knots_u(), b.knots_u()]) {
        for [across_a, across_b] in &columns {
            let bound = distance_bound(&a.bezier(&of_a, across_a), &b.bezier(&of_b, across_b), rational);
            worst = if bound.is_nan() { f64::INFINITY } else { worst.max(bound) };
        }
    }
    worst
}

/// A rectangle of the new surface's parameters within one span each, with the feet of its corners `(0, 0)`, `(0, 1)`,
/// `(1, 0)`, `(1, 1)`.
#[derive(Debug, Clone, Copy)]
struct Cell {
    spans: [usize; 2],
    range: [(f64, f64); 2],
    feet: [Foot; 4],
}

/// A parameter point of the reference for a point of the new surface.
#[derive(Debug, Clone, Copy)]
struct Foot {
    at: [f64; 2],
    distance: f64,
}

struct Comparison<'a> {
    new: &'a NurbsSurface,
    reference: &'a NurbsSurface,
    rational: bool,
    /// Distinct knots of the reference.
    knots: [Vec<f64>; 2],
    /// Greatest coordinate in play.
    magnitude: f64,
}

impl<'a> Comparison<'a> {
    fn new(new: &'a NurbsSurface, reference: &'a NurbsSurface) -> Self {
        let points = new.control_points().chain(reference.control_points());
        Self {
            new,
            reference,
            rational: new.is_rational() || reference.is_rational(),
            knots: [reference.knots_u(), reference.knots_v()].map(|knots| knots.to_multiplicities().0),
            magnitude: points.map(|p| p.coords.amax()).fold(0.0, f64::max),
        }
    }

    /// The feet of the grid of all knots of the new surface, row by row in `u`.
    fn feet(&self, spans: &[Vec<usize>; 2]) -> Vec<Foot> {
        let [us, vs] = [(self.new.knots_u(), &spans[0]), (self.new.knots_v(), &spans[1])].map(values);
        let points = self.new.grid(&us, &vs);
        let mut feet: Vec<Foot> = Vec::with_capacity(points.len());
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                // A neighbour's shift is a better start than none.
                let near = match (i, j) {
                    (0, 0) => None,
                    (_, 0) => Some((feet[(i - 1) * vs.len()], us[i - 1], v)),
                    _ => Some((feet[feet.len() - 1], u, vs[j - 1])),
                };
                let shift = near.map_or([0.0; 2], |(foot, u, v)| [foot.at[0] - u, foot.at[1] - v]);
                feet.push(self.foot(&points[i * vs.len() + j], [u + shift[0], v + shift[1]]));
            }
        }
        feet
    }

    fn foot(&self, point: &Point3<f64>, seed: [f64; 2]) -> Foot {
        let wrap = Wrap::default();
        let found: SurfaceProjection = self.reference.closest_from(point, (seed[0], seed[1]), wrap);
        let at = [on_knot(&self.knots[0], found.u), on_knot(&self.knots[1], found.v)];
        Foot { at, distance: found.distance }
    }

    fn bound(&self, cell: &Cell) -> f64 {
        let [u, v] = [0, 1].map(|k| {
            let knots = [self.new.knots_u(), self.new.knots_v()][k];
            Extraction::new(knots, cell.spans[k], cell.range[k])
        });
        let new = self.new.bezier(&u, &v);
        let feet = [0, 1].map(|k| cell.feet.map(|foot| foot.at[k]));
        let ends = feet.map(|at| at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), least_and_greatest));
        let local = [0, 1].map(|k| feet[k].map(|x| part_of(x, ends[k])));
        let mut worst = 0.0_f64;
        for a in pieces(self.reference.knots_u(), ends[0]) {
            let along_u = Extraction::new(self.reference.knots_u(), a, ends[0]);
            for b in pieces(self.reference.knots_v(), ends[1]) {
                let along_v = Extraction::new(self.reference.knots_v(), b, ends[1]);
                let piece: BezierPatch = self.reference.bezier(&along_u, &along_v);
                let old = piece.composed(&local[0], &local[1]);
                let bound = distance_bound(&new, &old, self.rational);
                worst = if bound.is_nan() { f64::INFINITY } else { worst.max(bound) };
            }
        }
        worst
    }

    /// The quarters of a cell.
    fn quarters(&self, cell: &Cell) -> [Cell; 4] {
        let [(u0, u2), (v0, v2)] = cell.range;
        let (us, vs) = ([u0, 0.5 * (u0 + u2), u2], [v0, 0.5 * (v0 + v2), v2]);
        let [a, b, c, d] = cell.feet;
        let between = |feet: &[Foot], at: [f64; 2]| {
            let mean = |k: usize| feet.iter().map(|foot| foot.at[k]).sum::<f64>() / feet.len() as f64;
            self.foot(&self.new.point(at[0], at[1]), [mean(0), mean(1)])
        };
        let feet = [
            [a, between(&[a, b], [us[0], vs[1]]), b],
            [
                between(&[a, c], [us[1], vs[0]]),
                between(&[a, b, c, d], [us[1], vs[1]]),
                between(&[b, d], [us[1], vs[2]]),
            ],
            [c, between(&[c, d], [us[2], vs[1]]), d],
        ];
        [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, j]| Cell {
            spans: cell.spans,
            range: [(us[i], us[i + 1]), (vs[j], vs[j + 1])],
            feet: [feet[i][j], feet[i][j + 1], feet[i + 1][j], feet[i + 1][j + 1]],
        })
    }
}

/// Knots at the ends of spans.
fn values((knots, spans): (&KnotVector, &Vec<usize>)) -> Vec<f64> {
    let last = spans.last().map(|&k| knots.knots()[k + 1]);
    spans.iter().map(|&k| knots.knots()[k]).chain(last).collect()
}

fn least_and_greatest((low, high): (f64, f64), x: &f64) -> (f64, f64) {
    (low.min(*x), high.max(*x))
}

/// Where a number stands in an interval: 0 at its start and in an empty one, 1 at its end.
fn part_of(x: f64, (low, high): (f64, f64)) -> f64 {
    if high > low { ((x - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 }
}

/// A parameter moved onto a knot that it misses by rounding.
fn on_knot(knots: &[f64], x: f64) -> f64 {
    let next = knots.partition_point(|&k| k < x);
    let near = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|k| knots.get(k));
    let margin = ON_KNOT * (knots[knots.len() - 1] - knots[0]);
    near.copied().find(|k| (k - x).abs() <= margin).unwrap_or(x)
}

/// The spans whose closed intervals cover an interval of the domain.
fn pieces(knots: &KnotVector, (low, high): (f64, f64)) -> impl Iterator<Item = usize> + '_ {
    let first = knots.span(low);
    knots.spans().filter(move |&k| k == first || (k > first && knots.knots()[k] < high))
}

/// A cell with its bound.
struct Ranked {
    bound: f64,
    /// Of equal bounds the older one comes first.
    order: usize,
    cell: Cell,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.order.cmp(&self.order))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ranked {}

/// Cells by their bounds, the greatest first.
struct Queue {
    accuracy: Accuracy,
    cells: BinaryHeap<Ranked>,
    found: f64,
    count: usize,
}

impl Queue {
    fn new(accuracy: Accuracy) -> Self {
        Self { accuracy, cells: BinaryHeap::new(), found: 0.0, count: 0 }
    }

    fn add(&mut self, comparison: &Comparison<'_>, cell: Cell) {
        self.found = cell.feet.iter().map(|foot| foot.distance).fold(self.found, f64::max);
        self.cells.push(Ranked { bound: comparison.bound(&cell), order: self.count, cell });
        self.count += 1;
    }

    fn tighten(&mut self, comparison: &Comparison<'_>) {
        for _ in 0..self.accuracy.bisections {
            let enough = self.accuracy.ratio * self.found.max(self.accuracy.floor);
            match self.cells.peek() {
                Some(worst) if worst.bound > enough => {}
                _ => return,
            }
            let Some(worst) = self.cells.pop() else { return };
            for quarter in comparison.quarters(&worst.cell) {
                self.add(comparison, quarter);
            }
        }
    }

    fn result(&self, rounding: f64) -> Option<Deviation> {
        let bound = self.cells.peek()?.bound + rounding;
        Some(Deviation { bound, found: self.found, cells: self.count })
    }
}
