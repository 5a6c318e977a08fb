//! The normal equations of a deformation, and their two solutions: by penalty and exact.

use super::constraint::Prepared;
use super::{Constraint, Criteria, ForceDensityError, Network};
use crate::geometry::nurbs::{NetError, NurbsSurface};
use crate::math::{GridMatrix, Point3};

/// A surface, its network, and constraints that were added up.
#[derive(Debug, Clone)]
pub struct System<'a> {
    surface: &'a NurbsSurface,
    /// Free nodes, ascending.
    free: Vec<usize>,
    energy: GridMatrix,
    energy_slope: Vec<[f64; 3]>,
    /// `Aᵀ W A` and `Aᵀ W d` of the constraints.
    normal: GridMatrix,
    wanted: Vec<[f64; 3]>,
}

/// A deformed surface.
#[derive(Debug, Clone)]
pub struct Deformed {
    /// The surface over the same knots with the same weights.
    pub surface: NurbsSurface,
    /// Displacement of each control point.
    pub displacements: Vec<[f64; 3]>,
    /// Rounds of the exact form; 0 for the penalty form.
    pub rounds: usize,
}

/// Share of the mean stiffness that is added to every node: it makes a network solvable whose constraints hold it only
/// just, and moves nothing that can be measured.
const REGULAR: f64 = 1e-12;
/// Strength of the constraints in the exact form.
const EXACT_STRENGTH: f64 = 1e4;
/// Rounds of the exact form; independent constraints take 2 to 8.
const ROUNDS: usize = 20;
/// Part of the greatest displacement at which rounds end.
const SETTLED: f64 = 1e-13;

impl<'a> System<'a> {
    /// A network at rest, without constraints.
    ///
    /// # Errors
    /// [`ForceDensityError::NotPositive`], [`ForceDensityError::NothingFree`].
    pub fn new(
        surface: &'a NurbsSurface,
        network: &Network,
        criteria: &Criteria,
    ) -> Result<Self, ForceDensityError> {
        criteria.check()?;
        if let Some(&found) = network.densities().iter().find(|q| !(q.is_finite() && **q > 0.0)) {
            return Err(ForceDensityError::NotPositive { what: "a force density", found });
        }
        let free: Vec<usize> = network.free().indices().collect();
        if free.is_empty() {
            return Err(ForceDensityError::NothingFree);
        }
        let points: Vec<[f64; 3]> = surface.control_points().map(|p| p.coords.into()).collect();
        // Forces reach two nodes far, constraints as far as the degree.
        let reach = [surface.knots_u().degree().max(2), surface.knots_v().degree().max(2)];
        let (energy, energy_slope) = criteria.quadratic(network, &points, reach);
        let [rows, columns] = network.shape();
        let normal = GridMatrix::zeros(rows, columns, reach);
        Ok(Self { surface, free, energy, energy_slope, normal, wanted: vec![[0.0; 3]; points.len()] })
    }

    /// Adds constraints. They are not kept: any number may come.
    ///
    /// # Errors
    /// [`ForceDensityError::NotPositive`] for a weight.
    pub fn add(
        &mut self,
        constraints: impl IntoIterator<Item = Constraint>,
    ) -> Result<(), ForceDensityError> {
        for constraint in constraints {
            self.add_prepared(&ready(&constraint, self.surface)?);
        }
        Ok(())
    }

    fn add_prepared(&mut self, one: &Prepared) {
        self.normal.add_outer(&one.row, one.weight);
        one.row.add_to(self.surface.shape().1, &one.lack.map(|d| one.weight * d), &mut self.wanted);
    }

    /// The factor that makes a strength of 1 mean: as stiff as the network.
    fn scale(&self) -> f64 {
        let (energy, normal) = (self.energy.mean_diagonal(&self.free), self.normal.mean_diagonal(&self.free));
        if normal > 0.0 && energy > 0.0 { energy / normal } else { 1.0 }
    }

    /// The equations with constraints of a strength.
    fn matrix(&self, strength: f64) -> GridMatrix {
        let mut matrix = self.energy.clone();
        matrix.add_scaled(&self.normal, strength);
        let regular = REGULAR * self.energy.mean_diagonal(&self.free);
        self.free.iter().for_each(|&a| matrix.add_diagonal(a, regular));
        matrix
    }

    /// The penalty form: constraints and measure in balance, `strength` times as stiff as the network.
    ///
    /// # Errors
    /// [`ForceDensityError::NotPositive`], [`ForceDensityError::Singular`].
    pub fn balanced(&self, strength: f64) -> Result<Deformed, ForceDensityError> {
        if !(strength.is_finite() && strength > 0.0) {
            return Err(ForceDensityError::NotPositive {
                what: "the strength of the constraints",
                found: strength,
            });
        }
        let strength = strength * self.scale();
        let factor = self.matrix(strength).factored(&self.free).map_err(|_| self.singular())?;
        let right = combined(&self.energy_slope, &self.wanted, strength);
        self.deformed(factor.solve(&right), 0)
    }

    /// The exact form: all constraints that were added and those given here, which must be all of them but for constraints
    /// of the penalty form beside them, hold. This is the solution with multipliers, found by an augmented Lagrangian,
    /// which needs no choice of independent rows: what is said twice is met twice.
    ///
    /// # Errors
    /// [`ForceDensityError::Conflict`] when one is missed by more than the tolerance, [`ForceDensityError::Singular`].
    pub fn exact(&self, constraints: &[Constraint], tolerance: f64) -> Result<Deformed, ForceDensityError> {
        let mut hard = self.clone();
        let rows: Vec<Prepared> =
            constraints.iter().map(|c| ready(c, self.surface)).collect::<Result<_, _>>()?;
        rows.iter().for_each(|row| hard.add_prepared(row));
        let strength = EXACT_STRENGTH * hard.scale();
        let factor = hard.matrix(strength).factored(&hard.free).map_err(|_| self.singular())?;
        let columns = self.surface.shape().1;
        let plain = combined(&hard.energy_slope, &hard.wanted, strength);
        let mut multipliers = vec![[0.0; 3]; rows.len()];
        let mut displacements = vec![[0.0; 3]; plain.len()];
        for round in 1..=ROUNDS {
            let mut right = plain.clone();
            for (row, y) in rows.iter().zip(&multipliers) {
                row.row.add_to(columns, &y.map(|y| row.weight * y), &mut right);
            }
            let next = factor.solve(&right);
            let moved = greatest(next.iter().zip(&displacements).map(|(a, b)| difference(a, b)));
            displacements = next;
            for (row, y) in rows.iter().zip(&mut multipliers) {
                let rest = difference(&row.lack, &row.row.dot(columns, &displacements));
                (0..3).for_each(|k| y[k] += strength * rest[k]);
            }
            if moved <= SETTLED * greatest(displacements.iter().copied()) {
                return self.met(constraints, &rows, displacements, (tolerance, round));
            }
        }
        self.met(constraints, &rows, displacements, (tolerance, ROUNDS))
    }

    /// Whether all constraints hold.
    fn met(
        &self,
        constraints: &[Constraint],
        rows: &[Prepared],
        displacements: Vec<[f64; 3]>,
        (tolerance, rounds): (f64, usize),
    ) -> Result<Deformed, ForceDensityError> {
        let columns = self.surface.shape().1;
        let rest = |row: &Prepared| norm(&difference(&row.lack, &row.row.dot(columns, &displacements)));
        let residuals: Vec<f64> = rows.iter().map(rest).collect();
        let missed = |r: &&f64| r.is_nan() || **r > tolerance;
        let misses = residuals.iter().filter(missed).count();
        let worst = (0..residuals.len()).max_by(|&a, &b| residuals[a].total_cmp(&residuals[b]));
        if let Some(worst) = worst.filter(|_| misses > 0) {
            return Err(ForceDensityError::Conflict {
                at: constraints[worst].place(self.surface),
                residual: residuals[worst],
                misses,
                count: rows.len(),
                tolerance,
            });
        }
        self.deformed(displacements, rounds)
    }

    fn singular(&self) -> ForceDensityError {
        ForceDensityError::Singular { free: self.free.len() }
    }

    fn deformed(&self, displacements: Vec<[f64; 3]>, rounds: usize) -> Result<Deformed, ForceDensityError> {
        let surface = displaced(self.surface, &displacements).map_err(|_| self.singular())?;
        Ok(Deformed { surface, displacements, rounds })
    }
}

/// A surface with its control points moved; weights and knots stay.
///
/// # Errors
/// [`NetError`] for displacements that are not finite or of another count.
pub fn displaced(surface: &NurbsSurface, displacements: &[[f64; 3]]) -> Result<NurbsSurface, NetError> {
    let weights: Vec<f64> = surface.weights().collect();
    let moved = |(p, e): (Point3<f64>, &[f64; 3])| Point3::new(p.x + e[0], p.y + e[1], p.z + e[2]);
    let points: Vec<Point3<f64>> = surface.control_points().zip(displacements).map(moved).collect();
    let knots = (surface.knots_u().clone(), surface.knots_v().clone());
    NurbsSurface::from_points(knots.0, knots.1, &points, Some(&weights))
}

fn ready(constraint: &Constraint, surface: &NurbsSurface) -> Result<Prepared, ForceDensityError> {
    let weight = constraint.weight;
    if weight.is_finite() && weight > 0.0 {
        Ok(constraint.prepared(surface))
    } else {
        Err(ForceDensityError::NotPositive { what: "the weight of a constraint", found: weight })
    }
}

/// `-H + L Aᵀ W d`.
fn combined(slope: &[[f64; 3]], wanted: &[[f64; 3]], strength: f64) -> Vec<[f64; 3]> {
    slope.iter().zip(wanted).map(|(h, d)| [0, 1, 2].map(|k| strength * d[k] - h[k])).collect()
}

fn difference(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn norm(a: &[f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn greatest(all: impl Iterator<Item = [f64; 3]>) -> f64 {
    all.map(|a| norm(&a)).fold(0.0, f64::max)
}
