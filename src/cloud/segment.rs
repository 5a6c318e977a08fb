//! Which points lie on the primary surface, which on what replaced it, which on the blend between: for clouds without
//! labels.
//!
//! Points near the primary are its own. Of the others, those whose greatest principal curvature is of the high kind are the
//! blend's, the rest the objective's; the two kinds are found by two means of the logarithm. A point that differs from
//! nearly all of its neighbours is taken for one of theirs. Points by themselves and small islands belong to nobody.

use super::{Neighbours, local_shape};
use crate::math::Point3;
use rayon::prelude::*;

/// What a point lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// The primary surface.
    Primary,
    /// The surface that replaced a part of it.
    Objective,
    /// The blend between the two.
    Blend,
    /// Nothing: an error of the scanner.
    Outlier,
}

/// Sizes that a segmentation goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// Distance from the primary within which a point is its own. Left out: four deviations of the noise, at least a
    /// thousandth of `size`.
    pub tolerance: Option<f64>,
    /// Least side of the part's box.
    pub size: f64,
}

/// A segmented cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Segmentation {
    /// The role of each point.
    pub roles: Vec<Role>,
    /// Deviation of the points from the primary.
    pub noise: f64,
    /// Distance from the primary within which points are its own.
    pub tolerance: f64,
    /// Curvature that parts objective and blend; 0 when no point is off the primary.
    pub curvature: f64,
    /// Ratio of the two kinds' mean curvatures: near 1 there is no blend.
    pub separation: f64,
}

impl Segmentation {
    /// Count of points of a role.
    #[must_use]
    pub fn count(&self, role: Role) -> usize {
        self.roles.iter().filter(|r| **r == role).count()
    }
}

/// Share of the points, by distance from the primary, that are taken for its own when its noise is measured.
const OWN_SHARE: f64 = 0.6;
/// Rounds of the measure of noise; two change it by more than a hundredth.
const NOISE_ROUNDS: usize = 8;
/// Median of absolute values to the deviation of a normal distribution.
const MEDIAN_TO_DEVIATION: f64 = 1.4826;
/// Radius in spacings of the quadric that measures the curvature, for clouds with little and with much noise.
const QUADRIC: [f64; 2] = [2.8, 3.8];
/// Noise in spacings that counts as much.
const NOISY: f64 = 0.02;
/// Radius in spacings of the vote on a point, and the share of others among its neighbours that overrules it. A plain
/// majority would eat into the border of the objective.
const VOTE: (f64, f64) = (2.4, 0.7);
/// Radius in spacings within which a point must have [`LEAST_NEIGHBOURS`].
const ALONE: f64 = 3.0;
const LEAST_NEIGHBOURS: usize = 4;
/// Steps in spacings that join points to an island.
const LINK: f64 = 2.5;
/// Least island, in points and as a part of the greatest.
const ISLAND: (usize, f64) = (20, 0.02);

/// Segments a cloud of which the signed distances from the primary are known.
///
/// # Panics
/// When there are not as many distances as points.
#[must_use]
pub fn segmented(points: &[Point3<f64>], distances: &[f64], scales: &Scales) -> Segmentation {
    assert_eq!(points.len(), distances.len(), "a distance for each point");
    let noise = noise(distances);
    let tolerance = scales.tolerance.unwrap_or((4.0 * noise).max(1e-3 * scales.size));
    let off: Vec<usize> = (0..points.len()).filter(|&k| distances[k].abs() > tolerance).collect();
    let mut roles = vec![Role::Primary; points.len()];
    let rest: Vec<Point3<f64>> = off.iter().map(|&k| points[k]).collect();
    let tree = Neighbours::new(&rest);
    let kept = without_outliers(&tree, scales.spacing);
    for k in (0..rest.len()).filter(|&k| !kept[k]) {
        roles[off[tree.origin()[k] as usize]] = Role::Outlier;
    }
    let radius = QUADRIC[usize::from(noise > NOISY * scales.spacing)] * scales.spacing;
    let logarithms = logarithms(&tree, radius);
    let (low, high) = two_means(logarithms.iter().zip(&kept).filter(|(_, k)| **k).filter_map(|(l, _)| *l));
    let middle = 0.5 * (low + high);
    let objective = |k: usize| logarithms[k].is_some_and(|l| l <= middle);
    let votes: Vec<Role> = (0..rest.len())
        .into_par_iter()
        .map(|k| {
            let (mut like, mut all) = (0.0, 0.0);
            tree.within(&tree.points()[k], VOTE.0 * scales.spacing, |other, _| {
                like += f64::from(u8::from(objective(other)));
                all += 1.0;
            });
            let needed = if objective(k) { 1.0 - VOTE.1 } else { VOTE.1 };
            if like > needed * all { Role::Objective } else { Role::Blend }
        })
        .collect();
    for k in (0..rest.len()).filter(|&k| kept[k]) {
        roles[off[tree.origin()[k] as usize]] = votes[k];
    }
    let curvature = if rest.is_empty() { 0.0 } else { middle.exp() };
    Segmentation { roles, noise, tolerance, curvature, separation: (high - low).exp() }
}

/// Deviation of the points of the primary: of the nearest ones first, then of those within four deviations.
fn noise(distances: &[f64]) -> f64 {
    let mut all: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
    all.sort_unstable_by(f64::total_cmp);
    let mut own = (OWN_SHARE * all.len() as f64) as usize;
    let mut noise = 0.0;
    for _ in 0..NOISE_ROUNDS {
        noise = all[..own].get(own / 2).map_or(0.0, |median| MEDIAN_TO_DEVIATION * median);
        let next = all.partition_point(|d| *d <= 4.0 * noise).max(own);
        if next == own {
            break;
        }
        own = next;
    }
    noise
}

/// Which points, in the tree's order, have neighbours and belong to an island that is large enough.
fn without_outliers(tree: &Neighbours, spacing: f64) -> Vec<bool> {
    let n = tree.points().len();
    let company = |k: usize| {
        let mut count = 0;
        tree.within(&tree.points()[k], ALONE * spacing, |_, _| count += 1);
        count > LEAST_NEIGHBOURS
    };
    let mut kept: Vec<bool> = (0..n).into_par_iter().map(company).collect();
    let islands = islands(tree, &kept, LINK * spacing);
    let greatest = islands.iter().map(Vec::len).max().unwrap_or(0);
    let least = ISLAND.0.max((ISLAND.1 * greatest as f64) as usize);
    for island in islands.iter().filter(|island| island.len() < least) {
        island.iter().for_each(|&k| kept[k] = false);
    }
    kept
}

/// Points joined by steps of a length at most.
fn islands(tree: &Neighbours, of: &[bool], step: f64) -> Vec<Vec<usize>> {
    let mut seen: Vec<bool> = of.iter().map(|k| !k).collect();
    let mut islands = Vec::new();
    for start in 0..of.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut island = vec![start];
        let mut next = 0;
        while next < island.len() {
            let from = tree.points()[island[next]];
            tree.within(&from, step, |k, _| {
                if !std::mem::replace(&mut seen[k], true) {
                    island.push(k);
                }
            });
            next += 1;
        }
        islands.push(island);
    }
    islands
}

/// Part of `1 / radius` that is added to a curvature before its logarithm is taken: below it, noise tells more than shape.
const FLAT: f64 = 1e-4;

/// Logarithm of the greatest curvature at each point, in the tree's order; `None` where there is no shape.
fn logarithms(tree: &Neighbours, radius: f64) -> Vec<Option<f64>> {
    let at = |point: &Point3<f64>| {
        let shape = local_shape(tree, point, radius)?;
        Some((shape.greatest_curvature() + FLAT / radius).ln())
    };
    tree.points().par_iter().map(at).collect()
}

/// Rounds of the two means; they settle much earlier.
const ROUNDS: usize = 50;

/// The means of the two kinds that numbers fall into; both are 0 without numbers.
fn two_means(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let mut all: Vec<f64> = numbers.collect();
    if all.is_empty() {
        return (0.0, 0.0);
    }
    all.sort_by(f64::total_cmp);
    let part = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
    let (mut low, mut high) = (part(0.2), part(0.95));
    for _ in 0..ROUNDS {
        let split = all.partition_point(|x| x - low < high - x);
        let mean = |part: &[f64], old: f64| {
            if part.is_empty() { old } else { part.iter().sum::<f64>() / part.len() as f64 }
        };
        let next = (mean(&all[..split], low), mean(&all[split..], high));
        if next == (low, high) {
            break;
        }
        (low, high) = next;
    }
    (low, high)
}
