//! Room made only where it is missing: knots go into the strips between a held loop and what it is too near to.
//!
//! A net is a product: halving all spans for one hole beside the outline multiplies all control points by four. Here the
//! nearest pair of cells that are too near is looked for again and again, and only the spans from the one to the other are
//! halved, along the parameter along which they are farther apart.
//!
//! Geometry is never changed, only the net. The natural border is not looked at: a hole that close to it is refused.

use std::collections::BTreeSet;

use super::cells::{CellGrid, Mask};
use super::envelope::{GAP, Prepared};
use super::polygon::Polygon;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};

/// Part of the range of a parameter below which no span is halved.
const SHORTEST: f64 = 1e-6;

/// What room is needed between.
pub(super) struct Strips<'a> {
    /// The face.
    pub face: &'a Prepared,
    /// For each held loop which loops move with it.
    pub group: &'a [usize],
    /// Mean lengths of the parameter lines.
    pub lengths: [f64; 2],
    /// Greatest count of control points.
    pub limit: usize,
}

/// Spans to halve, by direction.
type Spans = [BTreeSet<usize>; 2];

impl Strips<'_> {
    /// The net with room between held loops and what stays, as far as the limit allows.
    pub fn refined(&self, surface: &NurbsSurface) -> NurbsSurface {
        let mut surface = surface.clone();
        loop {
            let knots = [surface.knots_u(), surface.knots_v()];
            let grid = CellGrid::new(knots[0], knots[1]);
            let Some(finer) = halved(&surface, &self.lacking(&grid), self.limit) else { return surface };
            surface = finer;
        }
    }

    /// For each held loop the spans between the nearest of what it is too near to.
    fn lacking(&self, grid: &CellGrid) -> Spans {
        let met: Vec<Mask> = self.face.held.iter().map(|l| grid.met_by(&l.polygon)).collect();
        let (rows, columns) = grid.shape();
        let mut fixed = Mask::empty(rows, columns);
        for polygon in self.stays() {
            fixed.unite(&grid.met_by(polygon));
        }
        let mut spans = Spans::default();
        for (k, cells) in met.iter().enumerate() {
            let mut others = fixed.clone();
            let apart = met.iter().zip(self.group).filter(|(_, group)| **group != self.group[k]);
            apart.for_each(|(other, _)| others.unite(other));
            if let Some((a, b)) = self.nearest(grid, cells, &others) {
                self.between(grid, a, b, &mut spans);
            }
        }
        spans
    }

    fn stays(&self) -> impl Iterator<Item = &Polygon> {
        self.face.outer.iter().chain(&self.face.scaled)
    }

    /// The nearest pair of cells, one of each set, between whose control points there are too few.
    fn nearest(&self, grid: &CellGrid, held: &Mask, others: &Mask) -> Option<([usize; 2], [usize; 2])> {
        let shape = <[usize; 2]>::from(grid.shape());
        let reach = [0, 1].map(|k| grid.support(k, 0).1 + 1 + GAP);
        let mut best = None;
        for at in held.indices() {
            let a = [at / shape[1], at % shape[1]];
            let [rows, columns] =
                [0, 1].map(|k| a[k].saturating_sub(reach[k])..=(a[k] + reach[k]).min(shape[k] - 1));
            for i in rows {
                for j in columns.clone().filter(|&j| others.contains(i, j)) {
                    let b = [i, j];
                    let distance = self.distance(grid, a, b);
                    let near = best.is_none_or(|(_, _, least)| distance < least);
                    if near && (0..2).all(|k| rows_between(grid, k, a[k], b[k]) < GAP) {
                        best = Some((a, b, distance));
                    }
                }
            }
        }
        best.map(|(a, b, _)| (a, b))
    }

    fn distance(&self, grid: &CellGrid, a: [usize; 2], b: [usize; 2]) -> f64 {
        (0..2).map(|k| self.apart(grid, k, a[k], b[k]).powi(2)).sum::<f64>()
    }

    /// Distance of the middles of two cells along one parameter, in space.
    fn apart(&self, grid: &CellGrid, k: usize, a: usize, b: usize) -> f64 {
        let middle = |cell: usize| {
            let (start, end) = grid.span(k, cell);
            0.5 * (start + end)
        };
        (middle(a) - middle(b)).abs() * self.lengths[k] / range(grid, k)
    }

    /// Spans from one cell to another along the parameter along which they are farther apart; those of one cell along
    /// both.
    fn between(&self, grid: &CellGrid, a: [usize; 2], b: [usize; 2], spans: &mut Spans) {
        let [along_u, along_v] = [0, 1].map(|k| self.apart(grid, k, a[k], b[k]));
        for (k, farther) in [along_u >= along_v, along_v >= along_u].into_iter().enumerate() {
            if farther {
                spans[k].extend(a[k].min(b[k])..=a[k].max(b[k]));
            }
        }
    }
}

fn range(grid: &CellGrid, k: usize) -> f64 {
    let last = <[usize; 2]>::from(grid.shape())[k] - 1;
    grid.span(k, last).1 - grid.span(k, 0).0
}

/// Rows of control points between those that act on two cells; 0 where they share some.
fn rows_between(grid: &CellGrid, k: usize, a: usize, b: usize) -> usize {
    let ((_, low), (high, _)) = (grid.support(k, a.min(b)), grid.support(k, a.max(b)));
    high.saturating_sub(low + 1)
}

/// A net with some spans halved; none when there are none that can be, or the net would become too large.
fn halved(surface: &NurbsSurface, spans: &Spans, limit: usize) -> Option<NurbsSurface> {
    let more = [surface.knots_u(), surface.knots_v()].map(KnotVector::distinct);
    let middles = [0, 1].map(|k| {
        let knots = &more[k].0;
        let shortest = SHORTEST * (knots[knots.len() - 1] - knots[0]);
        let long = spans[k].iter().filter(|&&cell| knots[cell + 1] - knots[cell] > shortest);
        long.map(|&cell| 0.5 * (knots[cell] + knots[cell + 1])).collect::<Vec<_>>()
    });
    let (rows, columns) = surface.shape();
    let points = (rows + middles[0].len()).checked_mul(columns + middles[1].len())?;
    if points > limit || middles.iter().all(Vec::is_empty) {
        return None;
    }
    surface.refined_u(&middles[0]).ok()?.refined_v(&middles[1]).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ops::constrained_scale::envelope::{Envelopes, PreparedLoop};
    use crate::ops::constrained_scale::scaling::Hold;

    const DOMAIN: [(f64, f64); 2] = [(0.0, 1.0), (0.0, 1.0)];

    fn rectangle(x: [f64; 2], y: [f64; 2]) -> Polygon {
        let points = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        Polygon::new(&points, [0.0; 2], DOMAIN).unwrap()
    }

    /// A plane of ten spans, and a hole a two-hundredth off the upper side of its outline.
    fn face() -> Prepared {
        let knots = KnotVector::clamped_uniform(3, 10, 0.0, 1.0).unwrap();
        let places: Vec<f64> =
            (0..13).map(|i| knots.knots()[i + 1..i + 4].iter().sum::<f64>() / 3.0).collect();
        let net = places.iter().flat_map(|&x| places.iter().map(move |&y| [x, y, 0.0, 1.0])).collect();
        let held = PreparedLoop { polygon: rectangle([0.4, 0.5], [0.7, 0.795]), hold: Hold::Rigid };
        Prepared {
            name: "1".to_owned(),
            surface: NurbsSurface::new(knots.clone(), knots, net).unwrap(),
            held: vec![held],
            outer: Some(rectangle([0.1, 0.9], [0.1, 0.8])),
            scaled: Vec::new(),
        }
    }

    #[test]
    fn knots_go_only_between_the_hole_and_the_outline() {
        let face = face();
        let strips = Strips { face: &face, group: &[0], lengths: [1.0; 2], limit: 40_000 };
        let refined = strips.refined(&face.surface);
        let envelopes = Envelopes::new(&face, &refined, 2);
        assert_eq!(envelopes.near_border(), None);
        // Halving all spans until six of them lie within a two-hundredth takes eight rounds and millions of points.
        assert!(refined.net().len() < 1000, "{}", refined.net().len());
        let added: Vec<f64> =
            refined.knots_v().knots().iter().copied().filter(|k| (k * 10.0).fract() != 0.0).collect();
        assert!(added.iter().any(|k| (0.795..0.8).contains(k)), "{added:?}");
        for (u, v) in [(0.13, 0.77), (0.5, 0.797), (0.99, 0.01)] {
            assert!((refined.point(u, v) - face.surface.point(u, v)).norm() < 1e-14);
        }
    }

    #[test]
    fn the_limit_ends_it() {
        let face = face();
        let strips = Strips { face: &face, group: &[0], lengths: [1.0; 2], limit: 200 };
        assert!(strips.refined(&face.surface).net().len() <= 200);
    }
}
