//! Elimination of the free control points of each face, and the small dense system that the faces of a group share.
//!
//! Knows net indices, no parameters and no loops. Columns are flat arrays, one number for each control point.

use super::motion::Motion;
use crate::math::banded::Banded;
use crate::math::sparse::{SingularSystem, SymmetricFactor};
use crate::math::{CsMat, Vector3};

/// The control points of one group on one face.
#[derive(Debug, Clone, Copy)]
pub struct Held<'a> {
    /// Index of the group among all groups.
    pub group: usize,
    /// Flat indices of its control points, ascending.
    pub points: &'a [usize],
    /// Its motion.
    pub motion: &'a Motion,
}

/// The energy of one face with its free part factored, once for all right sides.
pub struct FaceSystem {
    matrix: CsMat<f64>,
    free: Vec<usize>,
    factor: SymmetricFactor,
}

impl FaceSystem {
    /// Factors the free part of an energy matrix. `free` is ascending.
    ///
    /// # Errors
    /// [`SingularSystem`] when the fixed points do not hold the free ones.
    pub fn new(matrix: CsMat<f64>, free: Vec<usize>) -> Result<Self, SingularSystem> {
        let factor = SymmetricFactor::new(&principal_part(&matrix, &free))?;
        Ok(Self { matrix, free, factor })
    }

    /// Flat indices of the free control points.
    #[must_use]
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Sets the free values of a column to those of least energy for the given others.
    pub fn relax(&self, column: &mut [f64]) {
        for &index in &self.free {
            column[index] = 0.0;
        }
        let product = self.times(column);
        let mut right: Vec<f64> = self.free.iter().map(|&index| product[index]).collect();
        self.factor.solve(&mut right);
        for (&index, value) in self.free.iter().zip(right) {
            column[index] = -value;
        }
    }

    /// The product of the energy matrix with a column.
    #[must_use]
    pub fn times(&self, column: &[f64]) -> Vec<f64> {
        let rows = self.matrix.outer_iterator();
        rows.map(|row| row.iter().map(|(k, value)| value * column[k]).sum()).collect()
    }

    /// Greatest entry of the energy matrix.
    #[must_use]
    pub fn greatest_entry(&self) -> f64 {
        self.matrix.data().iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    /// Eliminates the free points for a known displacement `known` (three columns, zero on the free points) and
    /// one column for each held group, which has the weight on the group's points.
    #[must_use]
    pub fn eliminate(&self, known: [Vec<f64>; 3], groups: &[(usize, Vec<f64>)]) -> Elimination {
        let columns: Vec<&[f64]> =
            known.iter().map(Vec::as_slice).chain(groups.iter().map(|g| g.1.as_slice())).collect();
        let products: Vec<Vec<f64>> = columns.iter().map(|c| self.times(c)).collect();
        let right: Vec<f64> = products.iter().flat_map(|p| self.free.iter().map(|&index| p[index])).collect();
        let mut free = right.clone();
        self.factor.solve(&mut free);
        let n = self.free.len();
        let schur = |a: usize, b: usize| {
            let direct = dot(columns[a], &products[b]);
            direct - dot(&right[a * n..][..n], &free[b * n..][..n])
        };
        let rows = groups.iter().enumerate().map(|(a, (group, _))| SchurRow {
            group: *group,
            by_group: groups
                .iter()
                .enumerate()
                .map(|(b, (other, _))| (*other, schur(3 + a, 3 + b)))
                .collect(),
            by_known: Vector3::new(schur(3 + a, 0), schur(3 + a, 1), schur(3 + a, 2)),
        });
        Elimination { rows: rows.collect(), known, groups: groups.to_vec(), free }
    }
}

/// One group's row of a face's reduced energy.
#[derive(Debug, Clone)]
pub struct SchurRow {
    /// The group.
    pub group: usize,
    /// Coefficients by group.
    pub by_group: Vec<(usize, f64)>,
    /// Coefficients of the known displacement.
    pub by_known: Vector3<f64>,
}

/// A face with its free points eliminated.
pub struct Elimination {
    /// Reduced energy.
    pub rows: Vec<SchurRow>,
    known: [Vec<f64>; 3],
    groups: Vec<(usize, Vec<f64>)>,
    /// Solutions for the three known columns, then for each group.
    free: Vec<f64>,
}

impl Elimination {
    /// The displacement of all control points once the groups have moved by `shift`.
    #[must_use]
    pub fn displacement(&self, system: &FaceSystem, shift: impl Fn(usize) -> Vector3<f64>) -> [Vec<f64>; 3] {
        let shifts: Vec<Vector3<f64>> = self.groups.iter().map(|(group, _)| shift(*group)).collect();
        let n = system.free.len();
        let mut out = self.known.clone();
        for (c, column) in out.iter_mut().enumerate() {
            for ((_, weights), shift) in self.groups.iter().zip(&shifts) {
                for (value, weight) in column.iter_mut().zip(weights) {
                    *value += weight * shift[c];
                }
            }
            for (k, &index) in system.free.iter().enumerate() {
                let moved: f64 =
                    shifts.iter().enumerate().map(|(g, s)| self.free[(3 + g) * n + k] * s[c]).sum();
                column[index] = -(self.free[c * n + k] + moved);
            }
        }
        out
    }
}

/// Chooses the amounts of all motions so that the sum of the faces' energies is least.
///
/// `faces` gives the reduced rows of each face with the factor that makes its energy comparable.
///
/// # Errors
/// The size of the system, when it is singular: a group that no face resists.
pub fn choose_amounts(motions: &mut [Motion], faces: &[(f64, &[SchurRow])]) -> Result<(), usize> {
    let mut first = Vec::with_capacity(motions.len());
    let mut size = 0;
    for motion in motions.iter() {
        first.push(size);
        size += motion.directions.len();
    }
    if size == 0 {
        return Ok(());
    }
    let mut matrix = Banded::zeros(size, size - 1, size - 1);
    let mut right = vec![0.0; size];
    for (factor, rows) in faces {
        for row in *rows {
            for (k, direction) in motions[row.group].directions.iter().enumerate() {
                let at = first[row.group] + k;
                right[at] -= factor * direction.dot(&row.by_known);
                for (group, coefficient) in &row.by_group {
                    for (l, other) in motions[*group].directions.iter().enumerate() {
                        matrix.add(at, first[*group] + l, factor * coefficient * direction.dot(other));
                    }
                }
            }
        }
    }
    matrix.factored().map_err(|_| size)?.solve_rows(&mut right, 1);
    for (motion, &first) in motions.iter_mut().zip(&first) {
        let count = motion.directions.len();
        motion.amounts = right[first..first + count].to_vec();
    }
    Ok(())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Rows and columns of a symmetric matrix that belong to ascending indices.
fn principal_part(matrix: &CsMat<f64>, indices: &[usize]) -> CsMat<f64> {
    let mut place = vec![usize::MAX; matrix.rows()];
    for (k, &index) in indices.iter().enumerate() {
        place[index] = k;
    }
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for &index in indices {
        let row = matrix.outer_view(index);
        for (column, value) in row.iter().flat_map(|row| row.iter()) {
            if place[column] != usize::MAX {
                columns.push(place[column]);
                values.push(*value);
            }
        }
        starts.push(columns.len());
    }
    CsMat::new((indices.len(), indices.len()), starts, columns, values)
}
