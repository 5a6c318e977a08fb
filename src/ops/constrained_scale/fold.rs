//! Whether a stretched surface folds over itself.

use super::sampling::{Tangents, steps};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::math::Point3;

/// The place where the new surface is most compressed against the plainly scaled one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compression {
    /// Smallest ratio of oriented area elements: `n_new · n_plain / |n_plain|²`. One where nothing moved, and
    /// one over the product of two factors within a held region.
    pub ratio: f64,
    /// Place on the plainly scaled surface.
    pub near: Point3<f64>,
}

impl Compression {
    /// Whether the surface folds over itself, or is no surface at all.
    #[must_use]
    pub fn is_fold(&self) -> bool {
        self.ratio.is_nan() || self.ratio <= FOLDED
    }
}

/// A surface whose compression falls to this or below counts as folded.
const FOLDED: f64 = 0.02;

/// Samples within each span and direction.
const SAMPLES: usize = 3;
/// Area element, relative to the greatest, below which the parametrisation has a pole and no ratio.
const POLE: f64 = 1e-9;

/// The strongest compression over three samples per span and direction. Both surfaces have the same knots.
#[must_use]
pub fn strongest_compression(new: &NurbsSurface, plain: &NurbsSurface) -> Compression {
    let v = samples(plain.knots_v());
    let mut greatest = 0.0_f64;
    let mut areas = Vec::new();
    for u in samples(plain.knots_u()) {
        for &v in &v {
            let old = Tangents::of(plain, u, v);
            let area = old.normal();
            let size = area.norm_squared();
            greatest = greatest.max(size);
            areas.push((size, Tangents::of(new, u, v).normal().dot(&area), old.point));
        }
    }
    let mut worst = Compression { ratio: f64::INFINITY, near: Point3::origin() };
    for (size, product, near) in areas {
        let regular = size > POLE * POLE * greatest;
        let ratio = product / size;
        if regular && (ratio.is_nan() || ratio < worst.ratio) {
            worst = Compression { ratio, near };
        }
    }
    worst
}

fn samples(knots: &KnotVector) -> Vec<f64> {
    let (distinct, _) = knots.distinct();
    let within = distinct.windows(2).flat_map(|w| steps(w[0], w[1], SAMPLES + 1).take(SAMPLES));
    within.chain(distinct.last().copied()).collect()
}
