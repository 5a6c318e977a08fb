//! The guide: a smooth line through the middle of the blend's points, near which the limiting line is looked for.
//!
//! Round a closed feature the blend's distance from the middle is a function of the angle; where whole sectors have no
//! point of the blend, the feature runs out over a border there, and each band between has a line of its own.

use std::f64::consts::TAU;

use super::Closure;
use super::error::ReconstructionError;
use super::feet::Foot;
use super::metric::{Metric, ParameterLine};
use crate::geometry::nurbs::KnotVector;
use crate::math::sparse::SymmetricFactor;
use crate::math::{Matrix2, Point2, TriMat, Vector2};

/// Sectors by which gaps of the blend are found, and the least gap in sectors.
const SECTORS: usize = 90;
const GAP: usize = 10;
/// Functions, or spans, of a line.
const SPANS: usize = 24;
/// Weight of second differences, closed and open: without it thin blends give wiggles.
const STIFF: [f64; 2] = [3e-2, 3e-3];
/// Keeps functions without points in place.
const REGULAR: f64 = 1e-9;
/// Share of an open line at each end where the data are not taken.
const CUT: f64 = 0.01;
/// Points of a line.
const DENSE: usize = 2000;
/// Scatter about the line in widths of the band beyond which the feature is no star: an even band has 0.29.
const STAR: f64 = 0.5;

/// Axes of the objective's feet, each as long as their deviation along it.
struct Axes {
    centre: Point2<f64>,
    to_axes: Matrix2<f64>,
    from_axes: Matrix2<f64>,
}

impl Axes {
    /// `None` for points in one place or on a line.
    fn of(points: &[[f64; 2]]) -> Option<Self> {
        let n = points.len().max(1) as f64;
        let centre = points.iter().fold(Point2::origin(), |sum, p| sum + Vector2::from(*p) / n);
        let spread: Matrix2<f64> = points
            .iter()
            .map(|p| Point2::from(*p) - centre)
            .map(|d| d * d.transpose() / n)
            .fold(Matrix2::zeros(), |sum, m| sum + m);
        let parts = spread.symmetric_eigen();
        let deviations = parts.eigenvalues.map(|x| x.max(0.0).sqrt());
        let from_axes = parts.eigenvectors * Matrix2::from_diagonal(&deviations);
        Some(Self { centre, to_axes: from_axes.try_inverse()?, from_axes })
    }

    fn polar(&self, p: [f64; 2]) -> (f64, f64) {
        let local = self.to_axes * (Point2::from(p) - self.centre);
        ((local.y.atan2(local.x) / TAU).rem_euclid(1.0), local.norm())
    }

    fn point(&self, turn: f64, radius: f64) -> [f64; 2] {
        let (sine, cosine) = (TAU * turn).sin_cos();
        (self.centre + self.from_axes * Vector2::new(radius * cosine, radius * sine)).into()
    }
}

/// Guides of a feature from the feet of its objective and blend points. `spacing` is the distance of neighbouring points.
///
/// # Errors
/// [`ReconstructionError::GuideNotStar`], [`ReconstructionError::CloudDegenerate`].
pub fn guides(
    metric: &Metric,
    objective: &[Foot],
    blend: &[Foot],
    spacing: f64,
) -> Result<Vec<ParameterLine>, ReconstructionError> {
    let flat = |feet: &[Foot]| -> Vec<[f64; 2]> { feet.iter().map(|foot| metric.lengths(foot.at)).collect() };
    let (inside, band) = (flat(objective), flat(blend));
    let axes = Axes::of(&inside).ok_or(ReconstructionError::CloudDegenerate { which: "objective" })?;
    let mut polar: Vec<(f64, f64, [f64; 2])> = band
        .iter()
        .map(|p| {
            let (turn, radius) = axes.polar(*p);
            (turn, radius, *p)
        })
        .collect();
    polar.sort_by(|a, b| a.0.total_cmp(&b.0));
    let gaps = gaps(&polar.iter().map(|p| p.0).collect::<Vec<_>>());
    let lines = match gaps[..] {
        [] => vec![round(&axes, &polar)],
        [gap] => vec![along(&axes, &turned(&polar, gap.1), gap)],
        _ => (0..gaps.len()).map(|k| across(&between(&polar, gaps[k], gaps[(k + 1) % gaps.len()]))).collect(),
    };
    check_star(&lines, &band, spacing)?;
    let back = |line: ParameterLine| ParameterLine {
        points: line.points.into_iter().map(|x| metric.parameters(x)).collect(),
        ..line
    };
    Ok(lines.into_iter().map(back).collect())
}

/// Runs of sectors without a point, as first and last turn; the last may be beyond 1.
fn gaps(turns: &[f64]) -> Vec<(f64, f64)> {
    let mut filled = [false; SECTORS];
    for turn in turns {
        filled[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
    }
    let mut gaps = Vec::new();
    for first in (0..SECTORS).filter(|&k| !filled[k] && filled[(k + SECTORS - 1) % SECTORS]) {
        let length = (1..SECTORS).find(|&n| filled[(first + n) % SECTORS]).unwrap_or(SECTORS);
        if length >= GAP {
            gaps.push((first as f64 / SECTORS as f64, (first + length) as f64 / SECTORS as f64));
        }
    }
    gaps
}

type Polar = (f64, f64, [f64; 2]);

/// Points with their turns counted from a gap's end on.
fn turned(polar: &[Polar], from: f64) -> Vec<Polar> {
    let mut all: Vec<Polar> =
        polar.iter().map(|&(turn, r, p)| ((turn - from).rem_euclid(1.0), r, p)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Points between the end of one gap and the start of the next.
fn between(polar: &[Polar], gap: (f64, f64), next: (f64, f64)) -> Vec<[f64; 2]> {
    let width = (next.0 - gap.1).rem_euclid(1.0);
    turned(polar, gap.1).iter().filter(|(turn, ..)| *turn <= width).map(|(.., p)| *p).collect()
}

/// The closed line: radius over turn.
fn round(axes: &Axes, polar: &[Polar]) -> ParameterLine {
    let row = |turn: f64| {
        let place = turn * SPANS as f64;
        let first = place.floor();
        let f = place - first;
        let values = [
            (1.0 - f).powi(3),
            3.0 * f.powi(3) - 6.0 * f * f + 4.0,
            -3.0 * f.powi(3) + 3.0 * f * f + 3.0 * f + 1.0,
            f.powi(3),
        ];
        let first = first as usize + SPANS - 1;
        std::array::from_fn(|k| ((first + k) % SPANS, values[k] / 6.0))
    };
    let data: Vec<(f64, f64)> = polar.iter().map(|&(turn, r, _)| (turn, r)).collect();
    let value = fitted(&row, &data, (SPANS, Closure::Closed));
    let points =
        (0..DENSE).map(|k| k as f64 / DENSE as f64).map(|turn| axes.point(turn, value(turn))).collect();
    ParameterLine { points, closure: Closure::Closed }
}

/// The line of a feature that runs out over one border: radius over turn, from the gap's end on.
fn along(axes: &Axes, polar: &[Polar], gap: (f64, f64)) -> ParameterLine {
    let data: Vec<(f64, f64)> = polar.iter().map(|&(turn, r, _)| (turn, r)).collect();
    let (range, value) = open_fitted(&data);
    let points = even(range).map(|turn| axes.point(turn + gap.1, value(turn))).collect();
    ParameterLine { points, closure: Closure::Open }
}

/// The line of a band by itself: along its longer axis.
fn across(points: &[[f64; 2]]) -> ParameterLine {
    let n = points.len().max(1) as f64;
    let centre = points.iter().fold(Point2::origin(), |sum, p| sum + Vector2::from(*p) / n);
    let spread: Matrix2<f64> = points
        .iter()
        .map(|p| Point2::from(*p) - centre)
        .map(|d| d * d.transpose())
        .fold(Matrix2::zeros(), |s, m| s + m);
    let parts = spread.symmetric_eigen();
    let long: Vector2<f64> = parts.eigenvectors.column(parts.eigenvalues.imax()).into_owned();
    let side = Vector2::new(-long.y, long.x);
    let data: Vec<(f64, f64)> =
        points.iter().map(|p| Point2::from(*p) - centre).map(|d| (d.dot(&long), d.dot(&side))).collect();
    let (range, value) = open_fitted(&data);
    let points = even(range).map(|x| (centre + long * x + side * value(x)).into()).collect();
    ParameterLine { points, closure: Closure::Open }
}

/// Places from one end of a range to the other.
fn even((first, last): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..DENSE).map(move |k| first + (last - first) * k as f64 / (DENSE - 1) as f64)
}

/// The function through data along an open line, and its range. Near the ends, where the border cuts the band aslant, data
/// are not taken: the function goes on from what is before.
fn open_fitted(data: &[(f64, f64)]) -> ((f64, f64), impl Fn(f64) -> f64) {
    let range = data.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    let cut = CUT * (range.1 - range.0);
    let taken: Vec<(f64, f64)> =
        data.iter().filter(|(x, _)| (range.0 + cut..=range.1 - cut).contains(x)).copied().collect();
    // A band in one place has no length; the knots need one.
    let knots =
        KnotVector::clamped_uniform(3, SPANS, range.0, range.1.max(range.0 + f64::MIN_POSITIVE.sqrt()))
            .expect("a range of positive length");
    let n = knots.n_basis();
    let row = move |x: f64| {
        let basis = knots.basis_derivatives(x, 0);
        std::array::from_fn(|k| (basis.first() + k, basis.values()[k]))
    };
    (range, fitted(row, &taken, (n, Closure::Open)))
}

/// The function whose rows give the data best, with small second differences of its coefficients.
fn fitted<F: Fn(f64) -> [(usize, f64); 4]>(
    row: F,
    data: &[(f64, f64)],
    (n, closure): (usize, Closure),
) -> impl Fn(f64) -> f64 + use<F> {
    let mut matrix = TriMat::new((n, n));
    let mut right = vec![0.0; n];
    for &(x, value) in data {
        let row = row(x);
        for (i, a) in row {
            right[i] += a * value;
            row.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, a * b));
        }
    }
    let (stiff, differences) = match closure {
        Closure::Closed => (STIFF[0], 0..n),
        Closure::Open => (STIFF[1], 1..n - 1),
    };
    let stiff = stiff * data.len() as f64 / n as f64;
    for i in differences {
        let row = [((i + n - 1) % n, -1.0), (i, 2.0), ((i + 1) % n, -1.0)];
        for (i, a) in row {
            row.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, stiff * a * b));
        }
    }
    (0..n).for_each(|i| matrix.add_triplet(i, i, REGULAR));
    if let Ok(factor) = SymmetricFactor::new(&matrix.to_csr()) {
        factor.solve(&mut right);
    }
    move |x| row(x).iter().map(|&(i, a)| a * right[i]).sum()
}

/// The band's points must lie about the lines as evenly as a band's do.
fn check_star(lines: &[ParameterLine], band: &[[f64; 2]], spacing: f64) -> Result<(), ReconstructionError> {
    let plane = |p: &[f64; 2]| Point2::from(*p);
    let length = |line: &ParameterLine| -> f64 {
        line.points.windows(2).map(|pair| (plane(&pair[1]) - plane(&pair[0])).norm()).sum()
    };
    let coarse: Vec<Point2<f64>> =
        lines.iter().flat_map(|line| line.points.iter().step_by(8)).map(plane).collect();
    let square =
        |p: &[f64; 2]| coarse.iter().map(|q| (q - plane(p)).norm_squared()).fold(f64::INFINITY, f64::min);
    let width = band.len() as f64 * spacing * spacing / lines.iter().map(length).sum::<f64>();
    let scatter = (band.iter().map(square).sum::<f64>() / band.len() as f64).sqrt();
    if scatter > STAR * width + spacing {
        return Err(ReconstructionError::GuideNotStar { scatter, width });
    }
    Ok(())
}
