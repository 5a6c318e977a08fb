//! The bars: which nodes they join, what they pull, and what stands beyond the border.

use crate::geometry::nurbs::NurbsSurface;
use crate::math::GridRow;
use crate::ops::net::Mask;

/// What the control points of the border hang on beyond it. A ghost is the mirror image of the second node of a row in
/// the first, so that an even net is in balance up to its border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ghosts {
    /// Mirror nodes that stay where they are: the border is held back to where it was.
    #[default]
    Fixed,
    /// Mirror nodes that move with the net: the border is free. Bilinear motions of the net cost nothing, so that
    /// constraints must hold all of it.
    Floating,
    /// None: bars end at the border.
    None,
}

/// Up to two nodes with factors.
type Ends = [(usize, f64); 2];

/// A bar, as coefficients of nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bar {
    /// Of the forces that it gives: to which nodes, with which sign.
    pub pull: Ends,
    /// Of its vector before, by the nodes.
    pub before: Ends,
    /// Of the change of its vector, by the displacements.
    pub change: Ends,
    /// Force density.
    pub density: f64,
}

/// Bars over a control net of `shape[0]` rows and `shape[1]` columns.
#[derive(Debug, Clone)]
pub struct Network {
    shape: [usize; 2],
    densities: [f64; 2],
    ghosts: Ghosts,
    free: Mask,
}

impl Network {
    /// The network of a surface: `densities` along `u` and `v` are positive, `free` has the shape of the net.
    ///
    /// # Panics
    /// For a mask of another shape.
    #[must_use]
    pub fn new(surface: &NurbsSurface, densities: [f64; 2], ghosts: Ghosts, free: Mask) -> Self {
        assert_eq!(surface.shape(), free.shape(), "the free nodes are those of the net");
        let (rows, columns) = surface.shape();
        Self { shape: [rows, columns], densities, ghosts, free }
    }

    /// All nodes free.
    #[must_use]
    pub fn unsupported(surface: &NurbsSurface, densities: [f64; 2], ghosts: Ghosts) -> Self {
        let (rows, columns) = surface.shape();
        Self::new(surface, densities, ghosts, Mask::empty(rows, columns).complement())
    }

    /// Densities under which a net of longer bars along one direction resists as much along it as along the other:
    /// inverse to the squares of the mean bar lengths, with the product 1. Both are 1 for a net that is a point.
    #[must_use]
    pub fn even_densities(surface: &NurbsSurface) -> [f64; 2] {
        let (rows, columns) = surface.shape();
        let points: Vec<_> = surface.control_points().collect();
        let mean = |sum: f64, count: usize| sum / count.max(1) as f64;
        let along_u = (0..(rows - 1) * columns).map(|k| (points[k + columns] - points[k]).norm()).sum();
        let row = |i: usize| points[i * columns..(i + 1) * columns].windows(2).map(|w| (w[1] - w[0]).norm());
        let along_v = (0..rows).flat_map(row).sum();
        let (hu, hv) = (mean(along_u, (rows - 1) * columns), mean(along_v, rows * (columns - 1)));
        if hu > 0.0 && hv > 0.0 { [hv / hu, hu / hv] } else { [1.0; 2] }
    }

    /// Rows and columns of the net.
    #[must_use]
    pub fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// The nodes that may move.
    #[must_use]
    pub fn free(&self) -> &Mask {
        &self.free
    }

    /// Force densities along `u` and `v`.
    #[must_use]
    pub fn densities(&self) -> [f64; 2] {
        self.densities
    }

    /// All bars, those to ghosts last.
    pub(super) fn bars(&self) -> Vec<Bar> {
        let [rows, columns] = self.shape;
        let mut bars = Vec::with_capacity(2 * rows * columns + 2 * (rows + columns));
        // Along each direction: lines of nodes, given by the first node, the step and the count.
        let along_u = (0..columns).map(|j| (j, columns, rows, self.densities[0]));
        let along_v = (0..rows).map(|i| (i * columns, 1, columns, self.densities[1]));
        let lines: Vec<_> = along_u.chain(along_v).collect();
        for &(first, step, count, density) in &lines {
            bars.extend((1..count).map(|k| inner(first + (k - 1) * step, first + k * step, density)));
        }
        if self.ghosts != Ghosts::None {
            for (first, step, count, density) in lines {
                let last = first + (count - 1) * step;
                bars.push(self.to_ghost(first, first + step, density));
                bars.push(self.to_ghost(last, last - step, density));
            }
        }
        bars
    }

    /// The bar from a border node to the mirror image of its inner neighbour.
    fn to_ghost(&self, border: usize, next: usize, density: f64) -> Bar {
        // border - (2 border - next)
        let mirrored = [(border, -1.0), (next, 1.0)];
        let alone = [(border, 1.0), (border, 0.0)];
        let change = if self.ghosts == Ghosts::Floating { mirrored } else { alone };
        Bar { pull: alone, before: mirrored, change, density }
    }

    /// Of each node, the change of the force on it by the displacements of the free nodes; all zeros for nodes that are
    /// not free: what a support has to bear is no matter.
    pub(super) fn force_rows(&self) -> Vec<GridRow> {
        let mut rows: Vec<GridRow> = (0..self.shape[0] * self.shape[1]).map(|a| self.around(a)).collect();
        for bar in self.bars() {
            for (to, sign) in bar.pull {
                for (of, factor) in bar.change {
                    if sign * factor != 0.0 && self.free.contains_index(to) && self.free.contains_index(of) {
                        let [i, j] = [of / self.shape[1], of % self.shape[1]];
                        let row = &mut rows[to];
                        let at = (i - row.first[0]) * row.shape[1] + j - row.first[1];
                        row.values[at] += sign * factor * bar.density;
                    }
                }
            }
        }
        rows
    }

    /// A row of zeros over a node and its neighbours.
    fn around(&self, node: usize) -> GridRow {
        let at = [node / self.shape[1], node % self.shape[1]];
        let first = at.map(|k| k.saturating_sub(1));
        let shape = [0, 1].map(|k| (at[k] + 2).min(self.shape[k]) - first[k]);
        GridRow { first, shape, values: vec![0.0; shape[0] * shape[1]] }
    }

    /// Forces on the nodes before anything moves.
    pub(super) fn forces(&self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; points.len()];
        for bar in self.bars() {
            let vector = of(&bar.before, points);
            for (to, sign) in bar.pull {
                (0..3).for_each(|k| forces[to][k] += sign * bar.density * vector[k]);
            }
        }
        forces
    }
}

fn inner(a: usize, b: usize, density: f64) -> Bar {
    let ends = [(a, 1.0), (b, -1.0)];
    Bar { pull: ends, before: ends, change: ends, density }
}

/// The vector that coefficients of nodes give.
pub(super) fn of(ends: &Ends, points: &[[f64; 3]]) -> [f64; 3] {
    let [(a, x), (b, y)] = *ends;
    [0, 1, 2].map(|k| x * points[a][k] + y * points[b][k])
}
