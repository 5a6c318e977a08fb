//! The limiting line: where primary and secondary would meet in a sharp edge.
//!
//! Along a guide, slabs of the objective's points are extended to the primary; the crossings, weighted by what their own
//! scatter predicts, are smoothed as offsets from the guide, which loses no curvature. The first result is the guide of a
//! second pass.

use super::Closure;
use super::error::ReconstructionError;
use super::feet::Foot;
use super::metric::{Metric, ParameterLine};
use super::polynomial_slice::{Crossing, HIGHEST, SlabPoint, crossing};
use super::smoothing::{Order, median, smoothed_against_outliers};
use crate::cloud::Neighbours;
use crate::geometry::nurbs::{NurbsCurve2, NurbsSurface, open_cubic, periodic_cubic};
use crate::math::{Point3, Vector3};
use rayon::prelude::*;

/// The objective's points as the primary sees them, ready to be sliced.
#[derive(Debug, Clone)]
pub struct Objective {
    tree: Neighbours,
    heights: Vec<f64>,
    spacing: f64,
}

impl Objective {
    /// Of feet, whose points are so far apart.
    #[must_use]
    pub fn new(feet: &[Foot], spacing: f64) -> Self {
        let tree = Neighbours::new(&feet.iter().map(|foot| foot.point).collect::<Vec<_>>());
        let heights = tree.origin().iter().map(|&k| feet[k as usize].height).collect();
        Self { tree, heights, spacing }
    }

    /// Points of a slab of half width `half` along, up to a distance.
    fn slab(&self, frame: &Frame, half: f64, reach: f64) -> Vec<SlabPoint> {
        let mut found = Vec::new();
        self.tree.within(&frame.point, reach, |k, _| {
            let away = self.tree.points()[k] - frame.point;
            let along = away.dot(&frame.tangent);
            if along.abs() <= half {
                found.push(SlabPoint { across: away.dot(&frame.inward), along, height: self.heights[k] });
            }
        });
        found
    }
}

/// Settings of the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSettings {
    /// Twice the distance within which nine tenths of the blend's feet lie about the guide.
    pub band: f64,
    /// Wavelength whose amplitude the smoothing halves; `None` for 4.5 bands, at least 30 spacings.
    pub wavelength: Option<f64>,
}

/// A place on the guide.
#[derive(Debug, Clone, Copy)]
struct Frame {
    at: [f64; 2],
    point: Point3<f64>,
    /// Along the guide, across the normal.
    tangent: Vector3<f64>,
    /// Across the guide, towards the feature.
    inward: Vector3<f64>,
}

/// A limiting line with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitingLine {
    /// In the parameters of the primary, over [0, 1] by even length; the feature lies on the side of `normal x tangent`.
    pub curve: NurbsCurve2,
    /// Whether it is closed.
    pub closure: Closure,
    /// Its length.
    pub length: f64,
    /// Median deviation of a crossing as predicted, before smoothing.
    pub deviation: f64,
    /// Slices, and those of them without a crossing.
    pub slices: (usize, usize),
    /// Median distance from the line to the first points of the objective.
    pub gap: f64,
}

/// Greatest count of slices, and their distance in spacings.
const SLICES: (usize, f64) = (400, 1.5);
/// Half width of a slab: in spacings, and as a part of the guide's radius of curvature.
const HALF: [f64; 2] = [1.5, 4.0];
const BEND: f64 = 0.5;
/// Windows of the two passes: in bands, and in gaps between line and points (each at least so many spacings).
const WINDOW: [f64; 2] = [2.0, 3.0];
const LEAST_GAP: f64 = 2.0;
/// Deviation in spacings below which no offset counts as an outlier, pass by pass: at first the guide is what is off. Each
/// pass goes along the line that the one before has found.
const FLOORS: [f64; 2] = [1.0, 0.3];
const LAST_FLOOR: f64 = 0.1;
/// Part of the wavelength for a line that is redrawn.
const REDRAWN: f64 = 0.7;
/// Growth of the window while a crossing is uncertain by more than a part of the spacing, and how often it grows.
const GROWTH: f64 = 1.3;
const CERTAIN: f64 = 0.1;
const WINDOWS: usize = 4;
/// Wavelength of the smoothing in bands, and at least in spacings.
const WAVELENGTH: [f64; 2] = [6.0, 40.0];
/// Weights of crossings.
const WEIGHT: [f64; 2] = [0.02, 100.0];
/// Neighbours over which the gap is averaged, to each side.
const AROUND: usize = 5;
/// Degree of the slices' polynomials; a higher one must leave so much less scatter.
const DEGREE: usize = 3;
const LESS_SCATTER: f64 = 0.88;
/// Shares and runs of slices without a crossing that are too many.
const LOST: (f64, usize) = (0.3, 10);
/// Deviation in spacings, and slope, of a feature that does not meet the primary at an angle.
const TANGENT: [f64; 2] = [1.0, 0.05];
/// Points of a dense line for each of its own.
const DENSER: usize = 16;
/// Places of the final curve: at least, at most, and on a wavelength.
const PLACES: (usize, usize, f64) = (48, 192, 8.0);

/// Finds the limiting line near a guide.
///
/// # Errors
/// [`ReconstructionError::LimitingLineLost`], [`ReconstructionError::TangentFeature`], [`ReconstructionError::Singular`].
pub fn limiting_line(
    primary: &NurbsSurface,
    metric: &Metric,
    objective: &Objective,
    guide: &ParameterLine,
    settings: &LineSettings,
) -> Result<LimitingLine, ReconstructionError> {
    let spacing = objective.spacing;
    let wavelength =
        settings.wavelength.unwrap_or((WAVELENGTH[0] * settings.band).max(WAVELENGTH[1] * spacing));
    let mut pass = Pass::new(primary, objective, guide, &|_| WINDOW[0] * settings.band, DEGREE)?;
    for (number, floor) in FLOORS.into_iter().enumerate() {
        let guide = match guide.closure {
            Closure::Open if number == 0 => pass.redrawn(primary, metric, REDRAWN * wavelength, floor)?,
            _ => pass.smooth(primary, wavelength, floor)?,
        };
        let gaps = pass.gaps();
        let window = |share: f64| {
            let at = ((share * gaps.len() as f64) as usize).min(gaps.len() - 1);
            WINDOW[1] * gaps[at].max(LEAST_GAP * spacing)
        };
        pass = Pass::new(primary, objective, &guide, &window, HIGHEST)?;
    }
    pass.line(primary, wavelength)
}

/// Slices along one guide.
struct Pass {
    frames: Vec<Frame>,
    crossings: Vec<Option<Crossing>>,
    step: f64,
    spacing: f64,
    closure: Closure,
}

impl Pass {
    fn new(
        primary: &NurbsSurface,
        objective: &Objective,
        guide: &ParameterLine,
        window: &(dyn Fn(f64) -> f64 + Sync),
        highest: usize,
    ) -> Result<Self, ReconstructionError> {
        let spacing = objective.spacing;
        let (_, length) = guide.resampled(primary, 2);
        let count = ((length / (SLICES.1 * spacing)) as usize).clamp(8, SLICES.0);
        let (line, length) = guide.resampled(primary, count);
        let step = length / count as f64;
        let mut frames = frames(primary, &line)?;
        if !feature_inwards(&frames, objective) {
            let points = line.points.iter().rev().copied().collect();
            frames = self::frames(primary, &ParameterLine { points, ..line })?;
        }
        let closure = guide.closure;
        let halves = half_widths(&frames, step, spacing, closure);
        let one = |k: usize| {
            let window = window(k as f64 / count as f64);
            sliced(objective, &frames[k], halves[k], window, highest)
        };
        let crossings: Vec<Option<Crossing>> = (0..count).into_par_iter().map(one).collect();
        let pass = Self { frames, crossings, step, spacing, closure };
        pass.check()?;
        Ok(pass)
    }

    fn check(&self) -> Result<(), ReconstructionError> {
        let n = self.crossings.len();
        let lost: Vec<bool> = self.crossings.iter().map(Option::is_none).collect();
        let failed = lost.iter().filter(|lost| **lost).count();
        let turn = if self.closure == Closure::Closed { n } else { 0 };
        let run = |k: usize| (0..n).take_while(|i| k + i < n + turn && lost[(k + i) % n]).count();
        let longest = (0..n).max_by_key(|&k| (run(k), n - k)).unwrap_or(0);
        if failed as f64 > LOST.0 * n as f64 || run(longest) >= LOST.1 {
            let near = self.frames[longest].point.coords.into();
            return Err(ReconstructionError::LimitingLineLost { failed, samples: n, near });
        }
        let found = || self.crossings.iter().flatten();
        let deviation = median(found().map(|c| c.deviation).collect());
        let slope = median(found().map(|c| c.slope.abs()).collect());
        if deviation > TANGENT[0] * self.spacing || slope < TANGENT[1] {
            return Err(ReconstructionError::TangentFeature { deviation, spacing: self.spacing });
        }
        Ok(())
    }

    /// Offset of each crossing from the guide, and its weight; where there is none, between those beside it, without one.
    fn offsets(&self) -> (Vec<f64>, Vec<f64>) {
        let nominal = CERTAIN * self.spacing;
        let weight = |c: &Option<Crossing>| {
            c.map_or(0.0, |c| {
                let variance = c.deviation * c.deviation + (CERTAIN * nominal).powi(2);
                (nominal * nominal / variance).clamp(WEIGHT[0], WEIGHT[1])
            })
        };
        let values = self.filled(&|c| c.across);
        (values, self.crossings.iter().map(weight).collect())
    }

    /// A value of each crossing, between the nearest ones where there is none.
    fn filled(&self, value: &dyn Fn(&Crossing) -> f64) -> Vec<f64> {
        let n = self.crossings.len();
        let known = |k: usize| self.crossings[k].as_ref().map(value);
        let closed = self.closure == Closure::Closed;
        let towards = |from: usize, back: bool| {
            (1..n).find_map(|d| {
                let k = if back { from.checked_sub(d).or(closed.then(|| from + n - d))? } else { from + d };
                if k >= n && !closed { None } else { known(k % n).map(|v| (d as f64, v)) }
            })
        };
        let between = |k: usize| match (towards(k, true), towards(k, false)) {
            (Some((a, x)), Some((b, y))) => (b * x + a * y) / (a + b),
            (Some((_, x)), None) | (None, Some((_, x))) => x,
            (None, None) => 0.0,
        };
        (0..n).map(|k| known(k).unwrap_or_else(|| between(k))).collect()
    }

    /// Distances from the line to the first points of the objective, averaged.
    fn gaps(&self) -> Vec<f64> {
        let gaps = self.filled(&|c| c.start - c.across);
        let n = gaps.len();
        let at = |k: usize, d: usize| match self.closure {
            Closure::Closed => (k + n + d - AROUND) % n,
            Closure::Open => (k + d).saturating_sub(AROUND).min(n - 1),
        };
        let mean = |k: usize| (0..=2 * AROUND).map(|d| gaps[at(k, d)]).sum::<f64>() / (2 * AROUND + 1) as f64;
        (0..n).map(|k| mean(k).max(0.0)).collect()
    }

    /// The crossings of an open line, smoothed as points of the metric plane: whatever the guide was, near its ends too.
    fn redrawn(
        &self,
        primary: &NurbsSurface,
        metric: &Metric,
        wavelength: f64,
        floor: f64,
    ) -> Result<ParameterLine, ReconstructionError> {
        let (values, weights) = self.offsets();
        let raw: Vec<[f64; 2]> =
            self.placed(primary, &values).into_iter().map(|at| metric.lengths(at)).collect();
        let order = (Order::Third, Order::Third.stiffness(wavelength, self.step));
        let smooth = smoothed_against_outliers(&raw, order, &weights, floor * self.spacing, self.closure)?;
        let points = smooth.into_iter().map(|x| metric.parameters(x)).collect();
        Ok(dense(&ParameterLine { points, closure: self.closure }))
    }

    /// The crossings as a smooth line: their offsets from the guide are smoothed, which loses none of its bends.
    fn smooth(
        &self,
        primary: &NurbsSurface,
        wavelength: f64,
        floor: f64,
    ) -> Result<ParameterLine, ReconstructionError> {
        let (values, weights) = self.offsets();
        let values: Vec<[f64; 1]> = values.into_iter().map(|value| [value]).collect();
        let order = (Order::Third, Order::Third.stiffness(wavelength, self.step));
        let floor = floor * self.spacing;
        let offsets = smoothed_against_outliers(&values, order, &weights, floor, self.closure)?;
        let points = self.placed(primary, offsets.as_flattened());
        Ok(dense(&ParameterLine { points, closure: self.closure }))
    }

    /// Places of the primary at offsets from the guide.
    fn placed(&self, primary: &NurbsSurface, offsets: &[f64]) -> Vec<[f64; 2]> {
        self.frames.iter().zip(offsets).map(|(frame, z)| on_primary(primary, frame, *z)).collect()
    }

    /// The line by smoothed offsets.
    fn line(&self, primary: &NurbsSurface, wavelength: f64) -> Result<LimitingLine, ReconstructionError> {
        let line = self.smooth(primary, wavelength, LAST_FLOOR)?;
        let (curve, length) = fitted(primary, &line, wavelength);
        let found = || self.crossings.iter().flatten();
        let n = self.crossings.len();
        Ok(LimitingLine {
            curve,
            closure: self.closure,
            length,
            deviation: median(found().map(|c| c.deviation).collect()),
            slices: (n, n - found().count()),
            gap: median(self.gaps()),
        })
    }
}

/// The cubic through the points of a line.
pub(super) fn cubic(line: &ParameterLine) -> NurbsCurve2 {
    let through = match line.closure {
        Closure::Closed => periodic_cubic,
        Closure::Open => open_cubic,
    };
    let (knots, rows) = through(line.points.as_flattened(), 2);
    let points = rows.chunks_exact(2).map(|p| [p[0], p[1], 1.0]).collect();
    NurbsCurve2::new(knots, points).expect("as many points as the knots ask for")
}

/// The line with so many times the points, on the cubic through them: between two points straight is not near enough.
fn dense(line: &ParameterLine) -> ParameterLine {
    let curve = cubic(line);
    let steps = match line.closure {
        Closure::Closed => line.points.len(),
        Closure::Open => line.points.len() - 1,
    };
    let count = DENSER * steps + usize::from(line.closure == Closure::Open);
    let at = |k: usize| curve.point_at(k as f64 / (DENSER * steps) as f64).into();
    ParameterLine { points: (0..count).map(at).collect(), closure: line.closure }
}

/// The curve through places at even steps of a line that is dense, and its length.
fn fitted(primary: &NurbsSurface, line: &ParameterLine, wavelength: f64) -> (NurbsCurve2, f64) {
    let (_, length) = line.resampled(primary, 2);
    let count = ((PLACES.2 * length / wavelength) as usize).clamp(PLACES.0, PLACES.1);
    let (even, length) = line.resampled(primary, count);
    (cubic(&even), length)
}

/// Frames at the points of a line.
fn frames(primary: &NurbsSurface, line: &ParameterLine) -> Result<Vec<Frame>, ReconstructionError> {
    let n = line.points.len();
    let points: Vec<Point3<f64>> = line.points.iter().map(|[u, v]| primary.point(*u, *v)).collect();
    let chord = |k: usize| match line.closure {
        Closure::Closed => points[(k + 1) % n] - points[(k + n - 1) % n],
        Closure::Open => points[(k + 1).min(n - 1)] - points[k.saturating_sub(1)],
    };
    let frame = |(k, &at): (usize, &[f64; 2])| {
        let normal = primary.normal(at[0], at[1])?;
        let tangent = (chord(k) - normal * normal.dot(&chord(k))).try_normalize(0.0)?;
        Some(Frame { at, point: points[k], tangent, inward: normal.cross(&tangent) })
    };
    let frames: Option<Vec<Frame>> = line.points.iter().enumerate().map(frame).collect();
    frames.ok_or(ReconstructionError::CloudDegenerate { which: "blend" })
}

/// Whether the feature lies inwards of the frames.
fn feature_inwards(frames: &[Frame], objective: &Objective) -> bool {
    let side = |frame: &Frame| {
        let near = objective.tree.nearest(&frame.point).map_or(0, |(k, _)| k);
        (objective.tree.points()[near] - frame.point).dot(&frame.inward)
    };
    median(frames.iter().map(side).collect()) >= 0.0
}

/// Half widths of the slabs: narrow where the guide bends.
fn half_widths(frames: &[Frame], step: f64, spacing: f64, closure: Closure) -> Vec<f64> {
    let n = frames.len();
    let index = |k: usize, d: usize| match closure {
        Closure::Closed => (k + n + d - 3) % n,
        Closure::Open => (k + d).saturating_sub(3).min(n - 1),
    };
    let bend = |k: usize| (frames[index(k, 4)].tangent - frames[index(k, 2)].tangent).norm() / (2.0 * step);
    let bends: Vec<f64> = (0..n).map(bend).collect();
    let greatest = |k: usize| (0..7).map(|d| bends[index(k, d)]).fold(0.0, f64::max);
    (0..n).map(|k| (BEND / greatest(k).max(1e-12)).clamp(HALF[0] * spacing, HALF[1] * spacing)).collect()
}

/// The most certain crossing at a frame; the window grows while it is uncertain.
fn sliced(
    objective: &Objective,
    frame: &Frame,
    half: f64,
    mut window: f64,
    highest: usize,
) -> Option<Crossing> {
    let mut best: Option<Crossing> = None;
    for _ in 0..WINDOWS {
        let slab = objective.slab(frame, half, 1.6 * window + half);
        let mut found = crossing(&slab, half, window, DEGREE);
        for degree in DEGREE + 1..=highest {
            let higher = crossing(&slab, half, window, degree);
            let better = |a: &Crossing, b: &Crossing| b.scatter < LESS_SCATTER * a.scatter;
            match (found, higher) {
                (Some(a), Some(b)) if better(&a, &b) => found = Some(b),
                _ => break,
            }
        }
        best = match (best, found) {
            (Some(a), Some(b)) => Some(if b.deviation < a.deviation { b } else { a }),
            (a, b) => a.or(b),
        };
        if best.is_some_and(|best| best.deviation <= CERTAIN * objective.spacing) {
            break;
        }
        window *= GROWTH;
    }
    best
}

/// The point of the primary in the plane of a frame, at an offset across: Newton's method.
fn on_primary(primary: &NurbsSurface, frame: &Frame, offset: f64) -> [f64; 2] {
    let mut at = frame.at;
    for _ in 0..20 {
        let (point, du, dv) = primary.first_derivatives(at[0], at[1]);
        let away = point - frame.point;
        let lack = [-away.dot(&frame.tangent), offset - away.dot(&frame.inward)];
        let (a, b) = (du.dot(&frame.tangent), dv.dot(&frame.tangent));
        let (c, d) = (du.dot(&frame.inward), dv.dot(&frame.inward));
        let determinant = a * d - b * c;
        if determinant == 0.0 {
            break;
        }
        at[0] += (d * lack[0] - b * lack[1]) / determinant;
        at[1] += (a * lack[1] - c * lack[0]) / determinant;
        if lack[0].abs().max(lack[1].abs()) < 1e-13 * (1.0 + frame.point.coords.amax()) {
            break;
        }
    }
    at
}
