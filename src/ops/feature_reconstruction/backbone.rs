//! The backbone of a fishbone: the line along a feature across which its ribs run.

use super::Closure;
use super::feet::Projector;
use super::path::Path;
use super::relief::{Lie, Relief};
use super::smoothing::{Order, smoothed_against_outliers};
use crate::math::{Point2, Point3};

/// How the backbone is found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Backbone<'a> {
    /// Straight through the middle along the axis of greatest spread: the line that fits the places best.
    #[default]
    Fit,
    /// Through the middles of slices across that axis: for features that wind.
    Slices,
    /// Through the places of the slices where the surface bends most: for features with a crest.
    Crest,
    /// Along a curve near the feature.
    Curve(&'a [Point3<f64>]),
}

/// Slices along a feature.
const SLICES: usize = 40;
/// Slices in the wavelength that the smoothing halves.
const WAVELENGTH: f64 = 10.0;
/// Share of a slice at each end that has no crest.
const ENDS: f64 = 0.15;
/// Places of a slice where its bend is looked at.
const LOOKS: usize = 60;
/// Bend of a crest, as a multiple of the slice's median one, at which it counts fully.
const PROMINENT: f64 = 3.0;
/// Weight of a slice without a crest.
const DULL: f64 = 1e-3;

impl Backbone<'_> {
    /// The line; `None` when the places have no extent or the curve no length.
    #[must_use]
    pub fn path(&self, relief: &Relief, primary: &Projector) -> Option<Path> {
        let lie = relief.lie()?;
        match self {
            Self::Fit => Path::new(lie.length.map(|x| lie.centre + lie.long * x)),
            Self::Slices => through_slices(relief, &lie, &middle),
            Self::Crest => through_slices(relief, &lie, &crest),
            Self::Curve(points) => {
                let at = |point: &Point3<f64>| Point2::from(relief.metric().lengths(primary.foot(point).at));
                Path::new(points.iter().map(at))
            }
        }
    }
}

/// A place of a slice, by the length along it, and its weight.
type Found = Option<(f64, f64)>;

/// A smooth line through one place of each slice across the long axis.
fn through_slices(relief: &Relief, lie: &Lie, place: &dyn Fn(&Relief, &Path) -> Found) -> Option<Path> {
    let step = (lie.length[1] - lie.length[0]) / SLICES as f64;
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for k in 0..SLICES {
        let along = lie.length[0] + (k as f64 + 0.5) * step;
        let slice = Path::new(lie.width.map(|y| lie.centre + lie.long * along + lie.wide * y))?;
        let (across, weight) = place(relief, &slice).unwrap_or((0.0, 0.0));
        points.push([across + lie.width[0]]);
        weights.push(weight);
    }
    let order = (Order::Third, Order::Third.stiffness(WAVELENGTH * step, step));
    let smooth = smoothed_against_outliers(&points, order, &weights, relief.spacing(), Closure::Open).ok()?;
    let at = |(k, [across]): (usize, &[f64; 1])| {
        let along = lie.length[0] + (k as f64 + 0.5) * step;
        lie.centre + lie.long * along + lie.wide * *across
    };
    Path::new(smooth.iter().enumerate().map(at))
}

fn middle(relief: &Relief, slice: &Path) -> Found {
    let slab = relief.slab(slice);
    let ([low, high], _) = relief.reach(slice, &slab);
    (high > low).then_some((0.5 * (low + high), 1.0))
}

/// Where the height along a slice bends most.
fn crest(relief: &Relief, slice: &Path) -> Found {
    let profile = relief.profile(slice, &[])?;
    let [low, high] = profile.range();
    let at = |k: usize| {
        let share = ENDS + (1.0 - 2.0 * ENDS) * k as f64 / (LOOKS - 1) as f64;
        low + (high - low) * share
    };
    let bend = |k: usize| {
        let s = at(k);
        profile.value(s, 2).abs() / (1.0 + profile.value(s, 1).powi(2)).powf(1.5)
    };
    let mut bends: Vec<f64> = (0..LOOKS).map(bend).collect();
    let best = (0..LOOKS).max_by(|&a, &b| bends[a].total_cmp(&bends[b]))?;
    let most = bends[best];
    bends.sort_unstable_by(f64::total_cmp);
    let usual = bends[LOOKS / 2];
    let clear = ((most - usual) / ((PROMINENT - 1.0) * usual.max(f64::MIN_POSITIVE))).clamp(DULL, 1.0);
    Some((at(best), clear))
}
