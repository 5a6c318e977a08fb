//! Engines in the gradient domain: differences of the source's net, carried by a local affine map of homogeneous
//! space, become the right side of a graph Laplacian over the feature's control points.
//!
//! Source: Poisson mesh editing on control nets, with the corrections of `docs/decisions/feature-paste.md`.

use super::PasteError;
use super::base::solve;
use super::block::{Block, Point, euclidean};
use super::settings::{EdgeWeights, Existing, Settings, Turn};
use crate::math::{Matrix3, Vector3};
use crate::ops::net::GridSystem;

/// Gap of Greville abscissae below which a multiple knot would give an infinite weight.
const LEAST_GAP: f64 = 1e-12;

/// The affine map `x ↦ linear x + shift w` of homogeneous points, which keeps weights.
struct Carry {
    linear: Matrix3<f64>,
    shift: Vector3<f64>,
}

impl Carry {
    fn apply(&self, p: &Point) -> Point {
        let moved = self.linear * Vector3::new(p[0], p[1], p[2]) + self.shift * p[3];
        [moved.x, moved.y, moved.z, p[3]]
    }
}

/// Edges of the grid graph with their weights, and what the differences along them shall be.
struct Graph<'a> {
    block: &'a Block,
    settings: &'a Settings,
    gaps: [Vec<f64>; 2],
    widths: [Vec<f64>; 2],
}

fn difference(a: &Point, b: &Point) -> Point {
    [0, 1, 2, 3].map(|c| a[c] - b[c])
}

fn length(p: &Point) -> f64 {
    Vector3::new(p[0], p[1], p[2]).norm()
}

impl<'a> Graph<'a> {
    fn new(block: &'a Block, settings: &'a Settings) -> Self {
        let gaps = block
            .abscissae
            .each_ref()
            .map(|g| g.windows(2).map(|w| (w[1] - w[0]).max(LEAST_GAP)).collect::<Vec<f64>>());
        let widths = [0, 1].map(|k| {
            let gap = |at: Option<usize>| at.and_then(|at| gaps[k].get(at)).copied().unwrap_or(0.0);
            (0..block.abscissae[k].len()).map(|i| 0.5 * (gap(i.checked_sub(1)) + gap(Some(i)))).collect()
        });
        Self { block, settings, gaps, widths }
    }

    /// Neighbours of a place with the weights of the edges.
    fn neighbours(&self, at: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (rows, columns) = (self.block.rows, self.block.columns);
        let (i, j) = (at / columns, at % columns);
        let along_u = |gap: usize| self.weight(self.widths[1][j], self.gaps[0][gap]);
        let along_v = |gap: usize| self.weight(self.widths[0][i], self.gaps[1][gap]);
        let found = [
            (i > 0).then(|| (at - columns, along_u(i - 1))),
            (i + 1 < rows).then(|| (at + columns, along_u(i))),
            (j > 0).then(|| (at - 1, along_v(j - 1))),
            (j + 1 < columns).then(|| (at + 1, along_v(j))),
        ];
        found.into_iter().flatten()
    }

    fn weight(&self, width: f64, gap: f64) -> f64 {
        match self.settings.edge_weights {
            EdgeWeights::Uniform => 1.0,
            EdgeWeights::FiniteVolume => width / gap,
        }
    }

    /// The difference from `q` to `p` that the result shall have, as `p` sees it.
    fn wanted(&self, p: usize, q: usize, carry: &Carry) -> Point {
        let b = self.block;
        let on_target = || difference(&b.target[p], &b.target[q]);
        let detail = |net: &[Point], base: &[Point]| {
            difference(&difference(&net[p], &base[p]), &difference(&net[q], &base[q]))
        };
        let carried = || carry.apply(&difference(&b.source[p], &b.source[q]));
        match self.settings.existing {
            Existing::Replace => carried(),
            Existing::Keep => {
                let (carried, kept) = (carried(), detail(&b.target, &b.target_base));
                [0, 1, 2, 3].map(|c| carried[c] + kept[c])
            }
            Existing::Stronger => {
                let feature = length(&detail(&b.source, &b.source_base)) * self.settings.scale[2].abs();
                if feature >= length(&detail(&b.target, &b.target_base)) { carried() } else { on_target() }
            }
        }
    }

    /// Laplacians that the feature's control points shall have, in order.
    fn wanted_laplacians(&self) -> Vec<Point> {
        let own = self.block.own.indices().zip(&self.block.carries);
        own.map(|(p, linear)| {
            let (base, target) = (&self.block.source_base[p], &self.block.target_base[p]);
            let shift = match self.settings.turn {
                Turn::None => Vector3::zeros(),
                _ => euclidean(target) - linear * euclidean(base),
            };
            let carry = Carry { linear: *linear, shift };
            let mut sum = [0.0; 4];
            for (q, weight) in self.neighbours(p) {
                let wanted = self.wanted(p, q, &carry);
                sum = [0, 1, 2, 3].map(|c| sum[c] + weight * wanted[c]);
            }
            sum
        })
        .collect()
    }
}

/// Points from columns of coordinates.
fn points(columns: &[f64], count: usize) -> Vec<Point> {
    (0..count).map(|k| [0, 1, 2, 3].map(|c| columns[c * count + k])).collect()
}

/// The published method: each Laplacian is met exactly, the ring of the target is the border.
///
/// # Errors
/// [`PasteError::SingularSystem`].
pub(super) fn poisson(block: &Block, settings: &Settings) -> Result<Vec<Point>, PasteError> {
    let graph = Graph::new(block, settings);
    let mut system = GridSystem::new(&block.own, [1, 1]);
    let count = system.len();
    let mut right = vec![0.0; 4 * count];
    for (k, wanted) in graph.wanted_laplacians().into_iter().enumerate() {
        let own = system.places()[k];
        let mut sum = wanted;
        let mut diagonal = 0.0;
        for (q, weight) in graph.neighbours(own) {
            diagonal += weight;
            system.add(k, q, -weight);
            if system.number(q).is_none() {
                sum = [0, 1, 2, 3].map(|c| sum[c] + weight * block.target[q][c]);
            }
        }
        system.add(k, own, diagonal);
        for c in 0..4 {
            right[c * count + k] = sum[c];
        }
    }
    solve(&system, &mut right)?;
    Ok(points(&right, count))
}

/// Laplacians met in the sense of least squares on the feature's control points and one ring; two rings of the
/// target are data, so that position and slope go over into it.
///
/// # Errors
/// [`PasteError::SingularSystem`].
pub(super) fn biharmonic(block: &Block, settings: &Settings) -> Result<Vec<Point>, PasteError> {
    let graph = Graph::new(block, settings);
    let mut system = GridSystem::new(&block.own, [2, 2]);
    let count = system.len();
    let wanted = graph.wanted_laplacians();
    let mut right = vec![0.0; 4 * count];
    for row in block.own.dilated(1).indices() {
        let mut entries: Vec<(usize, f64)> = graph.neighbours(row).map(|(q, w)| (q, -w)).collect();
        let diagonal: f64 = entries.iter().map(|(_, w)| -w).sum();
        entries.push((row, diagonal));
        let own = system.number(row);
        let mut rest = own.map_or([0.0; 4], |k| wanted[k]);
        for &(q, weight) in &entries {
            // On the ring the target's own Laplacian is wanted, of which the data parts cancel.
            let sign = match (own, system.number(q)) {
                (Some(_), None) => -1.0,
                (None, Some(_)) => 1.0,
                _ => 0.0,
            };
            rest = [0, 1, 2, 3].map(|c| rest[c] + sign * weight * block.target[q][c]);
        }
        for &(q, a) in &entries {
            let Some(k) = system.number(q) else { continue };
            for c in 0..4 {
                right[c * count + k] += a * rest[c] / diagonal;
            }
            for &(r, b) in &entries {
                system.add(k, r, a * b / diagonal);
            }
        }
    }
    solve(&system, &mut right)?;
    Ok(points(&right, count))
}
