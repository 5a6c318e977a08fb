//! The objective's points as heights over the metric plane of the primary, with the limiting lines round them.

use super::feet::Foot;
use super::metric::{Metric, ParameterLine};
use super::path::Path;
use super::profile::{Pin, Profile, SlabPlace};
use crate::math::{Point2, Point3, PrincipalAxes, Vector2};
use rayon::prelude::*;

/// Heights over the metric plane.
#[derive(Debug, Clone)]
pub struct Relief {
    metric: Metric,
    places: Vec<Point2<f64>>,
    heights: Vec<f64>,
    spacing: f64,
    rims: Vec<Path>,
}

/// Where a relief lies: its middle and its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lie {
    /// Mean of the places.
    pub centre: Point2<f64>,
    /// Unit direction of the greatest spread.
    pub long: Vector2<f64>,
    /// Unit direction to the left of it.
    pub wide: Vector2<f64>,
    /// Least and greatest place along the first axis from the centre, but for half a per cent at each end.
    pub length: [f64; 2],
    /// The same along the second.
    pub width: [f64; 2],
}

/// Half width of a slab in spacings.
const HALF: f64 = 2.5;
/// Weight of the height 0 on a limiting line, as a number of points.
const ON_RIM: f64 = 30.0;
/// Share of the places at each end of an extent that is not counted.
const CUT: f64 = 0.005;

impl Relief {
    /// Feet whose points are so far apart, and the limiting lines, on which the height is 0.
    #[must_use]
    pub fn new(metric: Metric, feet: &[Foot], spacing: f64, rims: &[ParameterLine]) -> Self {
        Self {
            metric,
            places: feet.iter().map(|foot| Point2::from(metric.lengths(foot.at))).collect(),
            heights: feet.iter().map(|foot| foot.height).collect(),
            spacing,
            rims: rims.iter().filter_map(|rim| Path::of(rim, &metric)).collect(),
        }
    }

    /// The metric.
    #[must_use]
    pub fn metric(&self) -> &Metric {
        &self.metric
    }

    /// Distance of neighbouring points.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The limiting lines.
    #[must_use]
    pub fn rims(&self) -> &[Path] {
        &self.rims
    }

    /// Places of the points in the metric plane.
    #[must_use]
    pub fn places(&self) -> &[Point2<f64>] {
        &self.places
    }

    /// Greatest height, up or down.
    #[must_use]
    pub fn greatest_height(&self) -> f64 {
        self.heights.iter().fold(0.0, |most, height| height.abs().max(most))
    }

    /// Where it lies; `None` without points.
    #[must_use]
    pub fn lie(&self) -> Option<Lie> {
        let points: Vec<Point3<f64>> = self.places.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let axes = PrincipalAxes::of(points.iter())?;
        let (centre, long) = (axes.centre.xy(), axes.axes[0].xy().try_normalize(0.0)?);
        let wide = Vector2::new(-long.y, long.x);
        let extent = |axis: Vector2<f64>| {
            let mut all: Vec<f64> = self.places.iter().map(|p| (p - centre).dot(&axis)).collect();
            all.sort_unstable_by(f64::total_cmp);
            let cut = (CUT * all.len() as f64) as usize;
            [all[cut], all[all.len() - 1 - cut]]
        };
        Some(Lie { centre, long, wide, length: extent(long), width: extent(wide) })
    }

    /// Points beside a path.
    #[must_use]
    pub fn slab(&self, path: &Path) -> Vec<SlabPlace> {
        let half = HALF * self.spacing;
        let place = |(place, height): (&Point2<f64>, &f64)| {
            let (along, beside) = path.located(*place);
            (beside.abs() <= half).then(|| SlabPlace { along, across: beside / half, height: *height })
        };
        self.places.par_iter().zip(&self.heights).filter_map(place).collect()
    }

    /// The part of a path between the limiting lines, or else between its outermost points, and the heights that the
    /// limiting lines give.
    #[must_use]
    pub fn reach(&self, path: &Path, slab: &[SlabPlace]) -> ([f64; 2], Vec<Pin>) {
        let range = |(low, high): (f64, f64), p: &SlabPlace| (low.min(p.along), high.max(p.along));
        let (low, high) = slab.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range);
        let middle = 0.5 * (low + high);
        let met = || self.rims.iter().flat_map(|rim| path.crossings(rim)).map(|meeting| meeting.here);
        let before = met().filter(|s| *s < middle).max_by(f64::total_cmp);
        let after = met().filter(|s| *s > middle).min_by(f64::total_cmp);
        let pin = |along: f64| Pin { along, height: 0.0, weight: ON_RIM };
        let pins = before.into_iter().chain(after).map(pin).collect();
        ([before.unwrap_or(low), after.unwrap_or(high)], pins)
    }

    /// The height along a path; `None` with too few points beside it.
    #[must_use]
    pub fn profile(&self, path: &Path, known: &[Pin]) -> Option<Profile> {
        let slab = self.slab(path);
        let (range, mut pins) = self.reach(path, &slab);
        pins.extend(known);
        Profile::fitted(&slab, range, self.spacing, &pins)
    }
}
