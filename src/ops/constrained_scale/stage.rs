//! One face from its refined net to its result: system, reference, elimination, back substitution.

use std::collections::BTreeSet;

use super::ScaleError;
use super::cells::Mask;
use super::energy::energy_matrix;
use super::fold::strongest_compression;
use super::motion::Motion;
use super::refine::Refined;
use super::scaling::{Energy, Scaling};
use super::slide::slide_reference;
use super::solve::{Elimination, FaceSystem, Held};
use super::task::ScaledFace;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Affine, Point3, Vector3};

/// One face between refinement and back substitution.
pub(super) struct Stage {
    original: NurbsSurface,
    plain: NurbsSurface,
    level: usize,
    fixed: Mask,
    /// Group and its points.
    held: Vec<(usize, Mask, Vec<usize>)>,
    reference: Vec<[f64; 3]>,
    system: FaceSystem,
    /// What makes the energies of several faces comparable.
    pub(super) per_area: f64,
    /// The reduced energy.
    pub(super) elimination: Elimination,
}

/// For each motion that loops on a face follow: its index, its control points as a set and as a list. `of_loop` tells
/// the motion of each held loop.
pub(super) fn held_sets(refined: &Refined, of_loop: &[usize]) -> Vec<(usize, Mask, Vec<usize>)> {
    let (rows, columns) = refined.surface.shape();
    let motions: BTreeSet<usize> = of_loop.iter().copied().collect();
    let mut sets = Vec::with_capacity(motions.len());
    for motion in motions {
        let mut mask = Mask::empty(rows, columns);
        for (held, _) in refined.envelopes.held.iter().zip(of_loop).filter(|(_, own)| **own == motion) {
            mask.unite(held);
        }
        let points: Vec<usize> = mask.indices().collect();
        if !points.is_empty() {
            sets.push((motion, mask, points));
        }
    }
    sets
}

/// Sets up and factors the system of a face, finds its reference and eliminates its free points.
pub(super) fn stage(
    name: &str,
    refined: Refined,
    held: Vec<(usize, Mask, Vec<usize>)>,
    motions: &[Motion],
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Stage, ScaleError> {
    let Refined { surface: original, envelopes, level, .. } = refined;
    let scaled = original.transformed(plain);
    let mut known = envelopes.fixed.clone();
    for (_, mask, _) in &held {
        known.unite(mask);
    }
    let free: Vec<usize> = known.complement().indices().collect();
    let unknowns = free.len();
    let energy = energy_matrix(&scaled, scaling.energy);
    let singular = || ScaleError::SingularSystem { face: name.to_owned(), unknowns };
    let system = FaceSystem::new(energy.matrix, free).map_err(|_| singular())?;
    let sets: Vec<Held<'_>> = held
        .iter()
        .map(|(group, _, points)| Held { group: *group, points, motion: &motions[*group] })
        .collect();
    let reference = match scaling.energy {
        Energy::Slide => slide_reference(&original, &scaled, &sets, &system).map_err(|_| singular())?,
        Energy::Published => scaled.net().iter().map(|h| [h[0], h[1], h[2]]).collect(),
    };
    let elimination = eliminate(&original, &scaled, &envelopes.fixed, &sets, &reference, &system);
    let per_area = energy.per_area;
    let fixed = envelopes.fixed;
    Ok(Stage { original, plain: scaled, level, fixed, held, reference, system, per_area, elimination })
}

/// The known displacements from the reference, and the reduced energy.
fn eliminate(
    original: &NurbsSurface,
    plain: &NurbsSurface,
    fixed: &Mask,
    held: &[Held<'_>],
    reference: &[[f64; 3]],
    system: &FaceSystem,
) -> Elimination {
    let n = original.net().len();
    let mut known = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for index in fixed.indices() {
        for c in 0..3 {
            known[c][index] = plain.net()[index][c] - reference[index][c];
        }
    }
    let mut columns = Vec::with_capacity(held.len());
    for group in held {
        let mut weights = vec![0.0; n];
        for &index in group.points {
            let image = moved(&original.net()[index], group.motion);
            weights[index] = image[3];
            for c in 0..3 {
                known[c][index] = image[c] - reference[index][c];
            }
        }
        columns.push((group.group, weights));
    }
    system.eliminate(known, &columns)
}

/// A homogeneous point moved by a group's motion, its weight kept.
fn moved(point: &[f64; 4], motion: &Motion) -> [f64; 4] {
    let weight = point[3];
    let image = motion.apply(&Point3::new(point[0] / weight, point[1] / weight, point[2] / weight));
    [image.x * weight, image.y * weight, image.z * weight, weight]
}

/// Back substitution: free points from the solve, held and fixed ones written directly, without cancellation.
pub(super) fn finish(
    stage: Stage,
    name: &str,
    image: NurbsSurface,
    motions: &[Motion],
    residual: &mut Residual,
) -> Result<ScaledFace, ScaleError> {
    let displacement = stage.elimination.displacement(&stage.system, |group| motions[group].shift());
    residual.add(&stage, &displacement);
    let mut net = stage.plain.net().to_vec();
    for &index in stage.system.free() {
        for c in 0..3 {
            net[index][c] = stage.reference[index][c] + displacement[c][index];
        }
    }
    let (rows, columns) = stage.plain.shape();
    let mut held = Mask::empty(rows, columns);
    for (group, mask, points) in &stage.held {
        held.unite(mask);
        for &index in points {
            net[index] = moved(&stage.original.net()[index], &motions[*group]);
        }
    }
    debug_assert!(!held.meets(&stage.fixed), "gaps keep held and fixed points apart");
    let knots = (stage.plain.knots_u().clone(), stage.plain.knots_v().clone());
    let surface = NurbsSurface::new(knots.0, knots.1, net)
        .map_err(|_| ScaleError::NonFiniteInput { face: name.to_owned(), what: "the result" })?;
    let compression = strongest_compression(&surface, &stage.plain);
    let free_points = stage.system.free().len();
    let Stage { plain, level, .. } = stage;
    let points_before = image.net().len();
    Ok(ScaledFace { surface, plain, image, held, points_before, free_points, level, compression })
}

/// Collects how far the solution is from stationary.
pub(super) struct Residual {
    free: f64,
    /// By group: gradient of the summed energies by its shift, and what it is measured against.
    groups: Vec<(Vector3<f64>, f64)>,
}

impl Residual {
    /// Nothing collected yet.
    pub(super) fn new(motions: &[Motion]) -> Self {
        Self { free: 0.0, groups: vec![(Vector3::zeros(), 0.0); motions.len()] }
    }

    fn add(&mut self, stage: &Stage, displacement: &[Vec<f64>; 3]) {
        let greatest = displacement.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let scale = greatest * stage.system.greatest_entry();
        if scale <= 0.0 {
            return;
        }
        for (c, column) in displacement.iter().enumerate() {
            let product = stage.system.times(column);
            for &index in stage.system.free() {
                self.free = self.free.max(product[index].abs() / scale);
            }
            for (group, _, points) in &stage.held {
                let entry = &mut self.groups[*group];
                let weighted = points.iter().map(|&k| product[k] * stage.original.net()[k][3]);
                entry.0[c] += stage.per_area * weighted.sum::<f64>();
                entry.1 = entry.1.max(stage.per_area * scale);
            }
        }
    }

    /// The greatest of all relative residuals.
    pub(super) fn greatest(&self, motions: &[Motion]) -> f64 {
        let along = self.groups.iter().zip(motions).flat_map(|((gradient, scale), motion)| {
            let scale = if *scale > 0.0 { *scale } else { 1.0 };
            motion.directions.iter().map(move |f| f.dot(gradient).abs() / scale)
        });
        along.fold(self.free, f64::max)
    }
}
