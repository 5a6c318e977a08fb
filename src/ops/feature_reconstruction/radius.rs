//! The radius of a blend from its points: circles through slices, and a ball rolled along the line, fitted as a whole.
//!
//! Circles through short arcs scatter and are biased by noise. A ball that must touch the primary is neither; one that must
//! touch both surfaces scatters least, and takes over whatever the secondary's border is off.

use super::Closure;
use super::ball::{Section, Station};
use super::error::ReconstructionError;
use super::radius_law::{LinearLaw, SliceRadius};
use super::radius_on_primary::{OnPrimary, Slope, fitted};
use super::rolling::{Roller, centre_curve};
use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::cloud::Neighbours;
use crate::math::{Matrix3, PlaneCircle, Point2, Point3, Vector3};
use serde::Serialize;

/// What the radius does along the line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RadiusLaw {
    /// The same everywhere.
    Constant {
        /// Radius.
        radius: f64,
    },
    /// From one value at the start of the line to another at its end.
    Linear {
        /// Radii at both ends.
        ends: [f64; 2],
    },
}

impl RadiusLaw {
    /// The radius at a share of the line.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        match *self {
            Self::Constant { radius } => radius,
            Self::Linear { ends: [a, b] } => a + share * (b - a),
        }
    }

    /// The radius in the middle.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.at(0.5)
    }

    /// The same law on an image of another size.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::Constant { radius } => Self::Constant { radius: factor * radius },
            Self::Linear { ends } => Self::Linear { ends: ends.map(|r| factor * r) },
        }
    }
}

/// Which laws are allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wanted {
    /// Constant, or linear where the points leave no doubt.
    #[default]
    Tested,
    /// Constant.
    Constant,
    /// Linear.
    Linear,
}

/// Where a radius was taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FoundBy {
    /// A ball on the primary, its way across free.
    Primary,
    /// A ball between both surfaces: where the arcs are too short to tell without the secondary.
    BothSurfaces,
    /// The job.
    Given,
}

/// A radius with what it was found from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Radius {
    /// The law.
    pub law: RadiusLaw,
    /// Where it was taken from.
    pub found_by: FoundBy,
    /// Slices with a circle.
    pub slices: usize,
    /// Median angle of their arcs, in degrees.
    pub arc: f64,
    /// Radius in the middle of the line by the circles of the slices, against outliers, and its standard error.
    pub by_slices: [f64; 2],
    /// By a ball that rolls on the primary.
    pub by_primary: [f64; 2],
    /// By a ball that rolls between both surfaces.
    pub by_both_surfaces: [f64; 2],
    /// Deviation of the blend's points from the ball.
    pub scatter: f64,
}

impl Radius {
    /// Whether the circles of the slices and the balls disagree by more than a part of the radius.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        let mean = self.law.mean();
        let others = [self.by_slices, self.by_primary, self.by_both_surfaces];
        others.iter().any(|[radius, _]| (radius - mean).abs() > UNCERTAIN * mean)
    }
}

/// Points of a blend, ready to be sliced.
#[derive(Debug, Clone)]
pub struct BlendCloud {
    tree: Neighbours,
    spacing: f64,
    noise: f64,
}

impl BlendCloud {
    /// Of points so far apart, with a deviation.
    #[must_use]
    pub fn new(points: &[Point3<f64>], spacing: f64, noise: f64) -> Self {
        Self { tree: Neighbours::new(points), spacing, noise }
    }

    fn points(&self) -> &[Point3<f64>] {
        self.tree.points()
    }
}

/// Half width of a slab in spacings, without and with noise; noise in spacings that counts.
const SLAB: [f64; 2] = [1.5, 2.5];
const NOISY: f64 = 0.02;
/// Points of a slice at least, and slices at least.
const LEAST: (usize, usize) = (8, 5);
/// Reach of a slice in median distances of the points from the line.
const REACH: f64 = 3.0;
/// Error of the ball on the primary, as a part of the radius, beyond which the secondary must help.
const UNSURE: f64 = 0.02;
/// Difference of the ways to find a radius, as a part of it, that is told.
const UNCERTAIN: f64 = 0.05;
/// A linear law must be so many errors, and such a part of the radius, away from a constant one.
const CLEAR: [f64; 2] = [5.0, 0.1];
/// Points for each knot of the way across, and knots at least and at most.
const KNOTS: (usize, usize, usize) = (12, 12, 160);
/// Rounds of the fit by the ball, Huber's constant, and the greatest step as a part of the radius.
const ROUNDS: usize = 8;
const HUBER: f64 = 1.345;
const STRIDE: f64 = 0.2;

/// A slice with a circle.
struct Arc {
    at: f64,
    radius: f64,
    angle: f64,
    count: usize,
}

/// Finds the radius along a line. `roller` knows the two surfaces and the line's stations.
///
/// # Errors
/// [`ReconstructionError::RadiusFailed`] for too few slices, and those of the ball.
pub fn radius(
    cloud: &BlendCloud,
    roller: &Roller<'_>,
    wanted: Wanted,
) -> Result<Radius, ReconstructionError> {
    let closure = roller.closure();
    let first = arcs(cloud, roller.stations(), closure);
    let failed = |found: usize| ReconstructionError::RadiusFailed { found, least: LEAST.1 };
    if first.len() < LEAST.1 {
        return Err(failed(first.len()));
    }
    let start = 1.0 / median(first.iter().map(|arc| 1.0 / arc.radius).collect());
    let sections = roller.roll(&RadiusLaw::Constant { radius: start })?;
    // Slices across the ball's own way are circles; across the limiting line they are nearly.
    let arcs = arcs(cloud, &across_centres(&sections, closure), closure);
    let slices = of_slices(&arcs).ok_or_else(|| failed(arcs.len()))?;
    let both = ByBall::fitted(cloud, roller, start)?;
    let primary = on_primary(cloud, roller, start, wanted)?;
    let sure = primary.filter(|fit| fit.errors[0] <= UNSURE * fit.values[0]);
    let law = match sure {
        Some(OnPrimary { values: [mean, change], .. }) if change != 0.0 => {
            RadiusLaw::Linear { ends: [mean - 0.5 * change, mean + 0.5 * change] }
        }
        Some(fit) => RadiusLaw::Constant { radius: fit.values[0] },
        None => RadiusLaw::Constant { radius: both.radius },
    };
    Ok(Radius {
        law,
        found_by: if sure.is_some() { FoundBy::Primary } else { FoundBy::BothSurfaces },
        slices: arcs.len(),
        arc: median(arcs.iter().map(|arc| arc.angle.to_degrees()).collect()),
        by_slices: [slices.mean, slices.errors[0]],
        by_primary: primary.map_or([0.0; 2], |fit| [fit.values[0], fit.errors[0]]),
        by_both_surfaces: [both.radius, both.error],
        scatter: sure.map_or(both.scatter, |fit| fit.scatter),
    })
}

/// The radius by a ball on the primary; its change along the line is 0 unless a linear law is wanted or clear.
fn on_primary(
    cloud: &BlendCloud,
    roller: &Roller<'_>,
    start: f64,
    wanted: Wanted,
) -> Result<Option<OnPrimary>, ReconstructionError> {
    let (edge, closure) = (roller.edge(), roller.closure());
    let knots = (cloud.points().len() / KNOTS.0).clamp(KNOTS.1, KNOTS.2);
    let sections = Roller::new(*edge, knots)?.roll(&RadiusLaw::Constant { radius: start })?;
    let fit =
        |slope| fitted(cloud.points(), edge.surfaces[0], (&sections, closure), (edge.side, start, slope));
    let constant = fit(Slope::None);
    if wanted == Wanted::Constant || closure == Closure::Closed {
        return Ok(constant);
    }
    let linear = fit(Slope::Free);
    let clear = |fit: &OnPrimary| {
        let [mean, change] = fit.values;
        change.abs() > CLEAR[0] * fit.errors[1] && change.abs() > CLEAR[1] * mean
    };
    Ok(linear.filter(|fit| wanted == Wanted::Linear || clear(fit)).or(constant))
}

/// Circles through the points of slabs across stations.
fn arcs(cloud: &BlendCloud, stations: &[Station], closure: Closure) -> Vec<Arc> {
    let half = SLAB[usize::from(cloud.noise > NOISY * cloud.spacing)] * cloud.spacing;
    let line = Neighbours::new(&stations.iter().map(|s| s.point).collect::<Vec<_>>());
    let distance = |p: &Point3<f64>| line.nearest(p).map_or(0.0, |(_, d)| d);
    let reach = REACH * median(cloud.points().iter().map(distance).collect()) + half;
    let mut at = 0.0;
    let mut found = Vec::new();
    for (k, station) in stations.iter().enumerate() {
        at += if k > 0 { (station.point - stations[k - 1].point).norm() } else { 0.0 };
        // The slabs at the ends of an open line are half empty.
        if closure == Closure::Open && (k == 0 || k + 1 == stations.len()) {
            continue;
        }
        let points = slice(cloud, station, half, reach);
        if points.len() < LEAST.0 {
            continue;
        }
        let Some(circle) = PlaneCircle::pratt(&points).map(|circle| circle.refined(&points)) else {
            continue;
        };
        if circle.radius.is_finite() && circle.radius > 0.0 {
            found.push(Arc {
                at,
                radius: circle.radius,
                angle: extent(&circle, &points),
                count: points.len(),
            });
        }
    }
    found
}

/// Points of a slab as points of its plane.
fn slice(cloud: &BlendCloud, station: &Station, half: f64, reach: f64) -> Vec<Point2<f64>> {
    let axis = if station.tangent.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    let x = station.tangent.cross(&axis).normalize();
    let y = station.tangent.cross(&x);
    let mut points = Vec::new();
    cloud.tree.within(&station.point, reach, |k, _| {
        let away = cloud.points()[k] - station.point;
        if away.dot(&station.tangent).abs() <= half {
            points.push(Point2::new(away.dot(&x), away.dot(&y)));
        }
    });
    points
}

/// Angle of the arc that the points cover: what their widest gap leaves.
fn extent(circle: &PlaneCircle, points: &[Point2<f64>]) -> f64 {
    let away = points.iter().map(|p| p - circle.center);
    let mut angles: Vec<f64> = away.map(|d| d.y.atan2(d.x)).collect();
    angles.sort_by(f64::total_cmp);
    let turn = std::f64::consts::TAU;
    let last = turn + angles[0] - angles[angles.len() - 1];
    let widest = angles.windows(2).map(|w| w[1] - w[0]).fold(last, f64::max);
    turn - widest
}

/// The radii of slices as a law along the line, each weighted by what its arc and its points can tell.
fn of_slices(arcs: &[Arc]) -> Option<LinearLaw> {
    const SAMPLES: usize = 21;
    let deviation = |arc: &Arc| {
        let mut normal = Matrix3::zeros();
        for k in 0..SAMPLES {
            let angle = arc.angle * (k as f64 / (SAMPLES - 1) as f64 - 0.5);
            let row = Vector3::new(angle.cos(), angle.sin(), 1.0);
            normal += row * row.transpose() * (arc.count as f64 / SAMPLES as f64);
        }
        normal.try_inverse().map(|inverse| inverse[(2, 2)].max(0.0).sqrt())
    };
    let slice = |arc: &Arc| {
        let deviation = deviation(arc).filter(|d| d.is_finite() && *d > 0.0)?;
        Some(SliceRadius { at: arc.at, radius: arc.radius, deviation })
    };
    LinearLaw::of_radii(&arcs.iter().filter_map(slice).collect::<Vec<_>>())
}

/// Stations on the way of the ball's centre.
fn across_centres(sections: &[Section], closure: Closure) -> Vec<Station> {
    let n = sections.len();
    let chord = |k: usize| match closure {
        Closure::Closed => sections[(k + 1) % n].centre - sections[(k + n - 1) % n].centre,
        Closure::Open => sections[(k + 1).min(n - 1)].centre - sections[k.saturating_sub(1)].centre,
    };
    let station = |k: usize| {
        let tangent = chord(k).try_normalize(0.0)?;
        Some(Station { point: sections[k].centre, tangent })
    };
    (0..n).filter_map(station).collect()
}

/// A constant radius by the distances of all points from the way of the ball's centre between both surfaces.
#[derive(Debug, Clone, Copy)]
struct ByBall {
    radius: f64,
    error: f64,
    scatter: f64,
}

impl ByBall {
    /// Gauss and Newton with Huber's weights.
    fn fitted(cloud: &BlendCloud, roller: &Roller<'_>, start: f64) -> Result<Self, ReconstructionError> {
        let residuals = |radius: f64| off_ball(cloud, roller, radius);
        let mut found = Self { radius: start, error: f64::INFINITY, scatter: f64::INFINITY };
        for _ in 0..ROUNDS {
            let h = 1e-3 * found.radius;
            let off = residuals(found.radius)?;
            let (more, less) = (residuals(found.radius + h)?, residuals(found.radius - h)?);
            let slopes: Vec<f64> = more.iter().zip(&less).map(|(a, b)| (a - b) / (2.0 * h)).collect();
            let (step, error, scatter) = step(&off, &slopes);
            found = Self { error, scatter, ..found };
            found.radius += step.clamp(-STRIDE * found.radius, STRIDE * found.radius);
            if step.abs() < 1e-9 * found.radius {
                break;
            }
        }
        Ok(found)
    }
}

/// A step, the standard error and the scatter. Points that no centre is nearest to have no number and do not count.
fn step(off: &[f64], slopes: &[f64]) -> (f64, f64, f64) {
    let counted: Vec<(f64, f64)> = off
        .iter()
        .zip(slopes)
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(a, b)| (*a, *b))
        .collect();
    let middle = median(counted.iter().map(|(off, _)| *off).collect());
    let spread = median(counted.iter().map(|(off, _)| (off - middle).abs()).collect());
    let deviation = MEDIAN_TO_DEVIATION * spread + 1e-12;
    let (mut normal, mut right, mut square, mut weights) = (0.0, 0.0, 0.0, 0.0);
    for (off, slope) in counted {
        let weight = (HUBER * deviation / off.abs().max(1e-15)).min(1.0);
        normal += weight * slope * slope;
        right -= weight * slope * off;
        square += weight * off * off;
        weights += weight;
    }
    let normal = f64::max(normal, f64::MIN_POSITIVE);
    let variance = square / f64::max(weights - 1.0, 1.0);
    (right / normal, (variance / normal).sqrt(), variance.sqrt())
}

/// Distance of each point from the ball rolled along the line; NaN for points beyond its ends.
fn off_ball(cloud: &BlendCloud, roller: &Roller<'_>, radius: f64) -> Result<Vec<f64>, ReconstructionError> {
    let sections = roller.roll(&RadiusLaw::Constant { radius })?;
    let centres: Vec<Point3<f64>> = sections.iter().map(|s| s.centre).collect();
    let near = Neighbours::new(&centres);
    let centres = centre_curve(&centres, roller.closure());
    let steps = match roller.closure() {
        Closure::Closed => sections.len(),
        Closure::Open => sections.len() - 1,
    } as f64;
    let off = |p: &Point3<f64>| {
        let seed = near.nearest(p).map_or(0, |(k, _)| near.origin()[k]);
        let foot = centres.closest_from(p, f64::from(seed) / steps);
        // The start of a closed line is its end.
        let other = match (roller.closure(), seed) {
            (Closure::Closed, 0) => Some(centres.closest_from(p, 1.0)),
            _ => None,
        };
        let foot = other.filter(|o| o.distance < foot.distance).unwrap_or(foot);
        let beyond = roller.closure() == Closure::Open && (foot.t <= 0.0 || foot.t >= 1.0);
        if beyond { f64::NAN } else { foot.distance - radius }
    };
    Ok(cloud.points().iter().map(off).collect())
}
