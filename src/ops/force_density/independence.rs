//! Which constraints say nothing that earlier ones do not say.
//!
//! Row by row into a triangular factor by Givens rotations (George and Heath 1980): a row of which nothing is left depends
//! on the rows before it. Works in the band that local rows have; an empty pivot takes the row as it is.

use super::Constraint;
use super::network::Network;
use crate::geometry::nurbs::NurbsSurface;

/// Part of a row's length that may be left of it when it counts as dependent: the rotations' rounding stays far below.
const DEPENDENT: f64 = 1e-9;

/// Indices of the constraints whose rows depend on earlier ones, or that reach no free control point.
#[must_use]
pub fn redundant(surface: &NurbsSurface, network: &Network, constraints: &[Constraint]) -> Vec<usize> {
    let columns = network.shape()[1];
    let (p, q) = (surface.knots_u().degree(), surface.knots_v().degree());
    let mut triangle = Triangle::new(surface.net().len(), p * columns + q + 1);
    let mut found = Vec::new();
    for (k, constraint) in constraints.iter().enumerate() {
        let row = constraint.prepared(surface).row;
        let free = |(a, x): (usize, &f64)| if network.free().contains_index(a) { (a, *x) } else { (a, 0.0) };
        let entries: Vec<(usize, f64)> = row.nodes(columns).zip(&row.values).map(free).collect();
        if !triangle.take(&entries) {
            found.push(k);
        }
    }
    found
}

/// An upper triangular factor in a band; rows that are not there yet are empty.
struct Triangle {
    width: usize,
    rows: Vec<Vec<f64>>,
}

impl Triangle {
    fn new(size: usize, width: usize) -> Self {
        Self { width, rows: vec![Vec::new(); size] }
    }

    /// Takes a row up; false when it depends on those that are there.
    fn take(&mut self, entries: &[(usize, f64)]) -> bool {
        let size = self.rows.len();
        let norm = entries.iter().map(|(_, x)| x * x).sum::<f64>().sqrt();
        let Some(first) = entries.first().map(|e| e.0).filter(|_| norm > 0.0) else { return false };
        // The part of the row from the pivot on, in a ring as wide as the band.
        let mut rest = vec![0.0; self.width];
        for (column, x) in entries {
            rest[column - first] = x / norm;
        }
        for pivot in first..size {
            if rest.iter().all(|x| x.abs() <= DEPENDENT) {
                return false;
            }
            if rest[0].abs() > DEPENDENT * DEPENDENT {
                if self.rows[pivot].is_empty() {
                    self.rows[pivot] = rest;
                    return true;
                }
                rotate(&mut self.rows[pivot], &mut rest);
            }
            rest.rotate_left(1);
            rest[self.width - 1] = 0.0;
        }
        false
    }
}

/// Turns two rows against each other so that the second begins with zero.
fn rotate(upper: &mut [f64], lower: &mut [f64]) {
    let length = upper[0].hypot(lower[0]);
    let (c, s) = (upper[0] / length, lower[0] / length);
    for (a, b) in upper.iter_mut().zip(lower.iter_mut()) {
        (*a, *b) = (c * *a + s * *b, c * *b - s * *a);
    }
    lower[0] = 0.0;
}
