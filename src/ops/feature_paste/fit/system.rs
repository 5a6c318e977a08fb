//! The least-squares system of a fit: the displacement field at Gauss points, by the rational functions of the
//! control points that may move.

use super::field::Field;
use crate::geometry::nurbs::{KnotVector, LocalBasis, NurbsSurface};
use crate::math::quadrature::gauss_legendre;
use crate::ops::feature_paste::PasteError;
use crate::ops::feature_paste::base::solve;
use crate::ops::net::{GridSystem, Mask};

/// A Gauss point of one direction: basis, weight and parameter.
type GaussPoint = (LocalBasis, f64, f64);

/// Displacements of the free control points that come nearest to the field over the cells: all `x`, then `y`, then `z`.
///
/// # Errors
/// [`PasteError::SingularSystem`].
pub(super) fn least_squares(
    field: &Field<'_>,
    ground: &NurbsSurface,
    cells: &Mask,
    free: &Mask,
) -> Result<Vec<f64>, PasteError> {
    let degrees = [ground.knots_u().degree(), ground.knots_v().degree()];
    let lines = [ground.knots_u(), ground.knots_v()].map(gauss_lines);
    let mut system = GridSystem::new(free, degrees);
    let mut right = vec![0.0; 3 * system.len()];
    let mut cell = CellProducts::default();
    let columns = cells.shape().1;
    for at in cells.indices() {
        cell.gather(field, ground, &system, [&lines[0][at / columns], &lines[1][at % columns]]);
        cell.add_to(&mut system, &mut right);
    }
    solve(&system, &mut right)?;
    Ok(right)
}

/// Products of the functions of one cell, added up over its Gauss points.
#[derive(Default)]
struct CellProducts {
    /// Unknowns that act on the cell, and their flat indices.
    unknowns: Vec<(usize, usize)>,
    /// Rational basis values at one Gauss point, in that order.
    values: Vec<f64>,
    matrix: Vec<f64>,
    right: Vec<[f64; 3]>,
}

impl CellProducts {
    fn gather(
        &mut self,
        field: &Field<'_>,
        ground: &NurbsSurface,
        system: &GridSystem,
        [along, across]: [&[GaussPoint]; 2],
    ) {
        self.unknowns.clear();
        self.matrix.clear();
        self.right.clear();
        for (bu, wu, u) in along {
            for (bv, wv, v) in across {
                self.fill(ground, system, bu, bv);
                let count = self.unknowns.len();
                self.matrix.resize(count * count, 0.0);
                self.right.resize(count, [0.0; 3]);
                let at = ground.derivatives_by(bu, bv);
                let wanted = field.at([*u, *v], (&at.du, &at.dv));
                for (a, value) in self.values.iter().enumerate() {
                    let weighted = wu * wv * value;
                    for (c, sum) in self.right[a].iter_mut().enumerate() {
                        *sum += weighted * wanted[c];
                    }
                    for (sum, other) in self.matrix[a * count..=a * count + a].iter_mut().zip(&self.values) {
                        *sum += weighted * other;
                    }
                }
            }
        }
    }

    /// Values of the unknowns' functions at a Gauss point.
    fn fill(&mut self, ground: &NurbsSurface, system: &GridSystem, bu: &LocalBasis, bv: &LocalBasis) {
        self.values.clear();
        // All Gauss points of a cell see the same control points.
        let first = self.unknowns.is_empty();
        let columns = ground.shape().1;
        let mut sum = 0.0;
        for (i, nu) in bu.values().iter().enumerate() {
            for (j, nv) in bv.values().iter().enumerate() {
                let at = (bu.first() + i) * columns + bv.first() + j;
                let value = nu * nv * ground.net()[at][3];
                sum += value;
                if let Some(k) = system.number(at) {
                    self.values.push(value);
                    if first {
                        self.unknowns.push((k, at));
                    }
                }
            }
        }
        self.values.iter_mut().for_each(|value| *value /= sum);
    }

    fn add_to(&self, system: &mut GridSystem, right: &mut [f64]) {
        let (count, all) = (self.unknowns.len(), system.len());
        for (a, (k, _)) in self.unknowns.iter().enumerate() {
            for (c, sum) in self.right[a].iter().enumerate() {
                right[c * all + k] += sum;
            }
            for ((_, at), sum) in self.unknowns.iter().zip(&self.matrix[a * count..=a * count + a]) {
                system.add(*k, *at, *sum);
            }
        }
    }
}

/// For each cell of one direction its Gauss points.
fn gauss_lines(knots: &KnotVector) -> Vec<Vec<GaussPoint>> {
    let (nodes, weights) = gauss_legendre(knots.degree() + 1);
    let (distinct, _) = knots.distinct();
    let of_cell = |w: &[f64]| {
        let (half, middle) = (0.5 * (w[1] - w[0]), 0.5 * (w[0] + w[1]));
        let point = |(x, weight): (&f64, &f64)| {
            let at = middle + half * x;
            (knots.basis_derivatives(at, 2), weight * half, at)
        };
        nodes.iter().zip(&weights).map(point).collect()
    };
    distinct.windows(2).map(of_cell).collect()
}
