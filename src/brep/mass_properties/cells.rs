//! The rectangles between knot lines that a face covers whole, or up to a line across: each is integrated once.
//!
//! A column from the base to the boundary would be integrated anew at every point of the boundary; what lies
//! below the cell of the boundary's piece is booked here instead, and pieces that run back take it away again.

use super::column::{Column, between};
use super::moments::Sums;
use super::{Accuracy, thinned};

/// Lines along each parameter at most; beyond, lines are passed over. A bound for hostile files.
const MAX_LINES: usize = 1 << 11;
/// Part of a strip's width within which two values of the parameter across are one: what the search for
/// crossings leaves open.
const SAME: f64 = 1e-9;
/// Halvings of a cell, each way, at most.
const MAX_DEPTH: u32 = 4;

/// What the pieces of a boundary leave below them in one strip.
#[derive(Debug, Clone, Copy)]
struct Cover {
    from: f64,
    to: f64,
    sign: f64,
    rows: (usize, usize),
}

/// Cells of a face.
pub(super) struct Cells {
    /// Lines that columns cross, ascending; at least two.
    rows: Vec<f64>,
    /// Lines along columns, ascending; at least two.
    strips: Vec<f64>,
    base: usize,
    covers: Vec<Vec<Cover>>,
}

/// Extent of a boundary along and across columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) along: (f64, f64),
    pub(super) across: (f64, f64),
}

/// Values at which a surface may change its form, and the period of the parameter.
pub(super) type Lines<'a> = (&'a [f64], Option<f64>);

impl Cells {
    /// Cells over the extent of a boundary and the line that columns begin at.
    pub(super) fn new(
        along: Lines<'_>,
        across: Lines<'_>,
        extent: &Extent,
        base: f64,
        pieces: usize,
    ) -> Self {
        let pieces = pieces.min(MAX_LINES);
        let list = |(values, period): Lines<'_>, low: f64, high: f64| {
            let mut all = vec![low];
            all.extend(between(values, period, low, high));
            all.push(high.max(low));
            thinned(&all, pieces)
        };
        let mut rows = list(along, extent.along.0.min(base), extent.along.1.max(base));
        if !rows.contains(&base) {
            rows.push(base);
            rows.sort_by(f64::total_cmp);
        }
        let strips = list(across, extent.across.0, extent.across.1);
        let base = rows.iter().position(|&row| row == base).unwrap_or(0);
        let covers = vec![Vec::new(); strips.len() - 1];
        Self { rows, strips, base, covers }
    }

    /// Lines that columns cross between two values.
    pub(super) fn rows_between(&self, low: f64, high: f64) -> Vec<f64> {
        self.rows.iter().copied().filter(|&x| x >= low && x <= high).collect()
    }

    /// Lines along columns between two values.
    pub(super) fn strips_between(&self, low: f64, high: f64) -> Vec<f64> {
        self.strips.iter().copied().filter(|&x| x >= low && x <= high).collect()
    }

    /// Books what lies between the base and a piece of the boundary that stays in one cell, given by its
    /// middle as (across, along) and its ends across; gives the line that the piece's own columns begin at.
    pub(super) fn book(&mut self, middle: (f64, f64), from: f64, to: f64) -> f64 {
        let (strip, row) = (cell_of(&self.strips, middle.0), cell_of(&self.rows, middle.1));
        let (low, high) = (self.strips[strip], self.strips[strip + 1]);
        let slack = SAME * (high - low);
        let snap = |x: f64| {
            if (x - low).abs() <= slack {
                low
            } else if (x - high).abs() <= slack {
                high
            } else {
                x
            }
        };
        let (from, to) = (snap(from), snap(to));
        if row != self.base && from != to && from.is_finite() && to.is_finite() {
            let (rows, up) = if row > self.base { ((self.base, row), 1.0) } else { ((row, self.base), -1.0) };
            let (from, to, way) = if from <= to { (from, to, 1.0) } else { (to, from, -1.0) };
            self.covers[strip].push(Cover { from, to, sign: up * way, rows });
        }
        self.rows[row]
    }

    /// The integral over all that is booked, by `d(across) d(along)`, and its error.
    pub(super) fn integral(&self, column: &Column<'_>, accuracy: &Accuracy) -> (Sums, Sums) {
        let (mut sum, mut errors) = (Sums::ZERO, Sums::ZERO);
        for (strip, covers) in self.covers.iter().enumerate().filter(|(_, covers)| !covers.is_empty()) {
            let slack = SAME * (self.strips[strip + 1] - self.strips[strip]);
            for (row, from, to, weight) in rectangles(covers, self.rows.len() - 1, slack) {
                let (part, error) =
                    adaptive(column, (from, to), (self.rows[row], self.rows[row + 1]), accuracy);
                sum += part * weight;
                errors += error * weight.abs();
            }
        }
        (sum, errors)
    }
}

/// The interval between ascending values that holds one, the first or last for what lies outside.
fn cell_of(values: &[f64], x: f64) -> usize {
    values.partition_point(|&line| line <= x).clamp(1, values.len() - 1) - 1
}

/// Row, ends and weight of every rectangle of one strip that counts.
fn rectangles(covers: &[Cover], rows: usize, slack: f64) -> Vec<(usize, f64, f64, f64)> {
    let mut stops: Vec<f64> = covers.iter().flat_map(|cover| [cover.from, cover.to]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|b, a| *b - *a <= slack);
    let nearest = |x: f64| {
        let after = stops.partition_point(|&stop| stop < x).min(stops.len() - 1);
        if after > 0 && x - stops[after - 1] <= stops[after] - x { after - 1 } else { after }
    };
    let pieces = stops.len() - 1;
    // Differences along the rows for each piece between two stops.
    let mut steps = vec![vec![0.0; rows + 1]; pieces];
    for cover in covers {
        for piece in &mut steps[nearest(cover.from)..nearest(cover.to)] {
            piece[cover.rows.0] += cover.sign;
            piece[cover.rows.1] -= cover.sign;
        }
    }
    let mut found: Vec<(usize, f64, f64, f64)> = Vec::new();
    let mut weights = vec![0.0; pieces];
    for row in 0..rows {
        for (weight, piece) in weights.iter_mut().zip(&steps) {
            *weight += piece[row];
        }
        let mut at = 0;
        for run in weights.chunk_by(|a, b| a == b) {
            if run[0] != 0.0 {
                found.push((row, stops[at], stops[at + run.len()], run[0]));
            }
            at += run.len();
        }
    }
    found
}

/// Integral and error over one rectangle, cut in four where the rules are not at one.
fn adaptive(column: &Column<'_>, across: (f64, f64), along: (f64, f64), accuracy: &Accuracy) -> (Sums, Sums) {
    let (mut sum, mut errors) = (Sums::ZERO, Sums::ZERO);
    let mut open = vec![(across, along, 0)];
    while let Some((across, along, depth)) = open.pop() {
        let (part, error) = column.rectangle(across, along);
        if depth == MAX_DEPTH || error.relative(accuracy.size, accuracy.reach) <= accuracy.target {
            sum += part;
            errors += error;
            continue;
        }
        let (x, y) = (0.5 * (across.0 + across.1), 0.5 * (along.0 + along.1));
        for across in [(across.0, x), (x, across.1)] {
            for along in [(along.0, y), (y, along.1)] {
                open.push((across, along, depth + 1));
            }
        }
    }
    (sum, errors)
}
