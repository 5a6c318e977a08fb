//! How thick the material stays between faces that a feature ties together, and whether they come too near.
//!
//! A hole through two skins moves both; each skin alone stays near its plain scaling, but what is between them may
//! vanish all the same. Compared are distances along the normal at samples of the first skin: where material keeps the
//! thickness that it had, or gets that of the plain scaling, all is well; what falls well below both is refused.
//!
//! Looks at the surfaces where the first face has material, and at pairs that share a feature; other pairs of faces are not
//! its concern.

use super::envelope::Prepared;
use super::sampling::steps;
use super::task::{Scaled, ScaledFace};
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use crate::math::Point3;

/// Least, greatest and mean distance of two skins, in file units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thickness {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
    /// Mean over the samples, which are evenly spread over the parameters of the first skin.
    pub mean: f64,
}

/// Two skins and the material between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinPair {
    /// The faces, by the caller's indices.
    pub faces: [usize; 2],
    /// As they came.
    pub before: Thickness,
    /// Plainly scaled.
    pub plain: Thickness,
    /// With features held.
    pub after: Thickness,
    /// Least quotient of the thickness now and the lesser of two: that of the same material before, and that of the
    /// plain scaling at the same place. Negative where the skins cross.
    pub least_ratio: f64,
    /// Where that is, on the first skin as it is now.
    pub near: Point3<f64>,
}

impl SkinPair {
    /// Whether material is lost that neither holding nor scaling takes away.
    #[must_use]
    pub fn is_too_close(&self) -> bool {
        self.least_ratio.is_nan() || self.least_ratio < TOO_CLOSE
    }
}

/// Part of the lesser expected thickness below which skins are too close.
const TOO_CLOSE: f64 = 0.8;
/// Distance, as a part of the size, at which two faces are one: there is nothing between them to keep.
const COINCIDENT: f64 = 1e-9;
/// Samples of the first skin in each direction.
const SAMPLES: usize = 33;
/// Least cosine between the normal and the way to the other face, for it to be one's other side.
const OPPOSITE: f64 = 0.7;

/// All pairs of faces that share a group, with their thickness; those that do not face each other are left out.
pub(super) fn pairs(faces: &[Prepared], scaled: &Scaled) -> Vec<SkinPair> {
    let mut pairs = Vec::new();
    for first in 0..faces.len() {
        for second in first + 1..faces.len() {
            let of = |face: usize| move |&(f, _): &(usize, usize)| f == face;
            let shared =
                |loops: &[(usize, usize)]| loops.iter().any(of(first)) && loops.iter().any(of(second));
            if scaled.groups.iter().any(|group| shared(&group.loops)) {
                pairs.extend(Skins::new(faces, scaled, [first, second]).measured());
            }
        }
    }
    pairs
}

struct Skins<'a> {
    faces: [usize; 2],
    prepared: &'a Prepared,
    before: [&'a NurbsSurface; 2],
    scaled: [&'a ScaledFace; 2],
}

impl<'a> Skins<'a> {
    fn new(faces: &'a [Prepared], scaled: &'a Scaled, pair: [usize; 2]) -> Self {
        Self {
            faces: pair,
            prepared: &faces[pair[0]],
            before: pair.map(|f| &faces[f].surface),
            scaled: pair.map(|f| &scaled.faces[f]),
        }
    }

    fn measured(&self) -> Option<SkinPair> {
        let locator = SurfaceLocator::new(self.before[1], Wrap::default());
        let coincident = COINCIDENT * self.before[0].bounding_box().diagonal();
        let (u, v) = self.before[0].domain();
        let mut sums = [Sum::default(); 3];
        let mut worst = (f64::INFINITY, Point3::origin());
        let places = steps(u.0, u.1, SAMPLES).flat_map(|u| steps(v.0, v.1, SAMPLES).map(move |v| [u, v]));
        for at in places.filter(|at| self.has_material(*at)) {
            let sample = self.sample(at, &locator);
            let Some(sample) = sample.filter(|sample| sample.thickness[0] > coincident) else { continue };
            for (sum, thickness) in sums.iter_mut().zip(sample.thickness) {
                sum.add(thickness);
            }
            if sample.ratio.is_nan() || sample.ratio < worst.0 {
                worst = (sample.ratio, self.scaled[0].surface.point(at[0], at[1]));
            }
        }
        let [before, plain, after] = sums.map(Sum::thickness);
        Some(SkinPair {
            faces: self.faces,
            before: before?,
            plain: plain?,
            after: after?,
            least_ratio: worst.0,
            near: worst.1,
        })
    }

    fn has_material(&self, at: [f64; 2]) -> bool {
        let Prepared { held, outer, scaled, .. } = self.prepared;
        let mut holes = held.iter().map(|held| &held.polygon).chain(scaled);
        outer.as_ref().is_none_or(|outer| outer.contains(at)) && !holes.any(|hole| hole.contains(at))
    }

    /// `None` where the other face is not opposite.
    fn sample(&self, at: [f64; 2], locator: &SurfaceLocator<'_>) -> Option<Sample> {
        let point = self.before[0].point(at[0], at[1]);
        let found = locator.closest(&point);
        let seed = (found.u, found.v);
        let before = across([self.before[0], self.before[1]], at, seed)?;
        let side = before.signum();
        let images = [&self.scaled[0].image, &self.scaled[1].image];
        let surfaces = [&self.scaled[0].surface, &self.scaled[1].surface];
        let plain = across(images, at, seed)? * side;
        let after = across(surfaces, at, seed)? * side;
        // The plain thickness where the material is now.
        let now = surfaces[0].point(at[0], at[1]);
        let foot = images[0].closest_from(&now, (at[0], at[1]), Wrap::default());
        let there = across(images, [foot.u, foot.v], seed)? * side;
        let ratio = after / before.abs().min(there);
        Some(Sample { thickness: [before.abs(), plain, after], ratio })
    }
}

struct Sample {
    /// Before, plainly scaled, and now.
    thickness: [f64; 3],
    ratio: f64,
}

/// Distance of the second surface from a point of the first, positive on the side of its normal; `None` where it does not
/// lie along the normal.
fn across(surfaces: [&NurbsSurface; 2], at: [f64; 2], seed: (f64, f64)) -> Option<f64> {
    let point = surfaces[0].point(at[0], at[1]);
    let normal = surfaces[0].normal(at[0], at[1])?;
    let foot = surfaces[1].closest_from(&point, seed, Wrap::default());
    let height = (foot.point - point).dot(&normal);
    (height.abs() > OPPOSITE * foot.distance).then_some(height)
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    least: f64,
    greatest: f64,
    total: f64,
    count: usize,
}

impl Sum {
    fn add(&mut self, thickness: f64) {
        self.least = if self.count == 0 { thickness } else { self.least.min(thickness) };
        self.greatest = if self.count == 0 { thickness } else { self.greatest.max(thickness) };
        self.total += thickness;
        self.count += 1;
    }

    fn thickness(self) -> Option<Thickness> {
        let Self { least, greatest, total, count } = self;
        (count > 0).then(|| Thickness { least, greatest, mean: total / count as f64 })
    }
}
