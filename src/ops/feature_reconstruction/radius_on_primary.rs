//! The radius of a ball that rolls on the primary alone, its way across left free: what the blend's points tell without
//! the secondary, whose border lies beyond its points.
//!
//! Unknowns are the way across at knots along the line and the radius, or its mean and change. Gauss-Newton on the distances
//! of all points from the ball, with Huber's weights.

use super::Closure;
use super::ball::Section;
use super::radius::RadiusLaw;
use super::rolling::centre_curve;
use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::cloud::Neighbours;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::sparse::SymmetricFactor;
use crate::math::{Point3, TriMat, Vector3};

/// Whether the radius may change along the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slope {
    /// It stays.
    None,
    /// It may change linearly.
    Free,
}

/// A fitted radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnPrimary {
    /// Mean radius and its change along the line.
    pub values: [f64; 2],
    /// Their standard errors.
    pub errors: [f64; 2],
    /// Deviation of the points from the ball.
    pub scatter: f64,
}

/// Rounds, Huber's constant, greatest step as a part of the radius.
const ROUNDS: usize = 12;
const HUBER: f64 = 1.345;
const STRIDE: f64 = 0.2;
/// Second differences of the ways across, as a part of what one knot's points weigh: holds knots without points.
const STIFF: f64 = 1e-3;

/// A knot: the ball's contact with the primary, and how it moves across.
#[derive(Debug, Clone, Copy)]
struct Knot {
    at: [f64; 2],
    /// Step of the parameters for a unit way across.
    across: [f64; 2],
    way: f64,
}

impl Knot {
    /// Centre of the ball, and its derivative by the way across and by the radius.
    fn centre(&self, primary: &NurbsSurface, distance: f64, side: f64) -> Option<[Vector3<f64>; 3]> {
        let centre = |way: f64| {
            let [u, v] = [0, 1].map(|k| self.at[k] + way * self.across[k]);
            Some((primary.point(u, v).coords, primary.normal(u, v)?))
        };
        let step = 1e-4 * distance.abs();
        let ((p, n), (more, m), (less, l)) =
            (centre(self.way)?, centre(self.way + step)?, centre(self.way - step)?);
        let by_way = ((more - less) + (m - l) * distance) / (2.0 * step);
        Some([p + n * distance, by_way, n * side])
    }
}

/// Fits the radius, starting from a ball that was rolled along both surfaces; its sections are the knots. `None` when the
/// equations have no solution.
#[must_use]
pub fn fitted(
    points: &[Point3<f64>],
    primary: &NurbsSurface,
    (sections, closure): (&[Section], Closure),
    (side, start, slope): (f64, f64, Slope),
) -> Option<OnPrimary> {
    let mut knots: Vec<Knot> = sections.iter().map(|s| knot(primary, s)).collect::<Option<_>>()?;
    let mut values = [start, 0.0];
    let mut found = None;
    for _ in 0..ROUNDS {
        let system = System::new(points, primary, (&knots, closure), (side, values, slope))?;
        let (step, errors) = system.solved()?;
        found = Some(OnPrimary { values, errors, scatter: system.scatter });
        let n = knots.len();
        let stride = STRIDE * values[0];
        for (knot, step) in knots.iter_mut().zip(&step[..n]) {
            knot.way += step.clamp(-stride, stride);
        }
        values = [0, 1].map(|k| values[k] + step[n + k].clamp(-stride, stride));
        if step[n..].iter().all(|s| s.abs() < 1e-8 * values[0]) {
            break;
        }
    }
    found.filter(|f| f.values.iter().chain(&f.errors).all(|x| x.is_finite()) && f.values[0] > 0.0)
}

/// The knot of a section: across is the way from the contact with the primary to that with the secondary.
fn knot(primary: &NurbsSurface, section: &Section) -> Option<Knot> {
    let [u, v] = section.contacts[0].at;
    let (_, du, dv) = primary.first_derivatives(u, v);
    let normal = section.contacts[0].normal;
    let way = section.contacts[1].point - section.contacts[0].point;
    let way = (way - normal * normal.dot(&way)).try_normalize(0.0)?;
    let (e, f, g) = (du.norm_squared(), du.dot(&dv), dv.norm_squared());
    let determinant = e * g - f * f;
    let (a, b) = (way.dot(&du), way.dot(&dv));
    Some(Knot {
        at: [u, v],
        across: [(g * a - f * b) / determinant, (e * b - f * a) / determinant],
        way: 0.0,
    })
}

/// The equations of one round.
struct System {
    matrix: TriMat<f64>,
    right: Vec<f64>,
    scatter: f64,
    size: usize,
}

impl System {
    fn new(
        points: &[Point3<f64>],
        primary: &NurbsSurface,
        (knots, closure): (&[Knot], Closure),
        (side, values, slope): (f64, [f64; 2], Slope),
    ) -> Option<Self> {
        let n = knots.len();
        let steps = if closure == Closure::Closed { n } else { n - 1 };
        let law = RadiusLaw::Linear { ends: [values[0] - 0.5 * values[1], values[0] + 0.5 * values[1]] };
        let share = |k: usize| k as f64 / steps as f64;
        let centres: Vec<[Vector3<f64>; 3]> =
            (0..n).map(|k| knots[k].centre(primary, side * law.at(share(k)), side)).collect::<Option<_>>()?;
        let way = centre_curve(&centres.iter().map(|c| Point3::from(c[0])).collect::<Vec<_>>(), closure);
        let near = Neighbours::new(&centres.iter().map(|c| Point3::from(c[0])).collect::<Vec<_>>());
        let mut rows = Vec::with_capacity(points.len());
        for p in points {
            let seed = near.nearest(p).map_or(0, |(k, _)| near.origin()[k] as usize);
            let mut foot = way.closest_from(p, share(seed));
            if closure == Closure::Closed && seed == 0 {
                let other = way.closest_from(p, 1.0);
                foot = if other.distance < foot.distance { other } else { foot };
            }
            if closure == Closure::Open && (foot.t <= 0.0 || foot.t >= 1.0) {
                continue;
            }
            rows.push(row(p, &foot, &centres, (steps, law)));
        }
        Some(Self::summed(&rows, n, closure, slope))
    }

    fn summed(rows: &[Row], n: usize, closure: Closure, slope: Slope) -> Self {
        let middle = median(rows.iter().map(|row| row.off).collect());
        let spread = median(rows.iter().map(|row| (row.off - middle).abs()).collect());
        let deviation = MEDIAN_TO_DEVIATION * spread + 1e-12;
        let size = n + 2;
        let mut matrix = TriMat::new((size, size));
        let mut right = vec![0.0; size];
        let (mut square, mut weights) = (0.0, 0.0);
        for row in rows {
            let weight = (HUBER * deviation / row.off.abs().max(1e-15)).min(1.0);
            let entries = [
                (row.knots[0], row.ways[0]),
                (row.knots[1], row.ways[1]),
                (n, row.mean),
                (n + 1, if slope == Slope::Free { row.change } else { 0.0 }),
            ];
            for (i, a) in entries {
                right[i] -= weight * a * row.off;
                entries.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, weight * a * b));
            }
            square += weight * row.off * row.off;
            weights += weight;
        }
        let stiff = STIFF * weights / n as f64;
        let count = if closure == Closure::Closed { n } else { n.saturating_sub(2) };
        for k in 0..count {
            let entries = [(k, -1.0), ((k + 1) % n, 2.0), ((k + 2) % n, -1.0)];
            for (i, a) in entries {
                entries.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, stiff * a * b));
            }
        }
        if slope == Slope::None {
            matrix.add_triplet(n + 1, n + 1, 1.0);
        }
        let scatter = (square / f64::max(weights - size as f64, 1.0)).sqrt();
        Self { matrix, right, scatter, size }
    }

    /// The step, and the standard errors of mean and change.
    fn solved(&self) -> Option<(Vec<f64>, [f64; 2])> {
        let factor = SymmetricFactor::new(&self.matrix.to_csr()).ok()?;
        let mut step = self.right.clone();
        factor.solve(&mut step);
        let error = |k: usize| {
            let mut unit = vec![0.0; self.size];
            unit[k] = 1.0;
            factor.solve(&mut unit);
            self.scatter * unit[k].max(0.0).sqrt()
        };
        Some((step, [error(self.size - 2), error(self.size - 1)]))
    }
}

/// A point's distance from the ball, and how it changes.
struct Row {
    off: f64,
    knots: [usize; 2],
    ways: [f64; 2],
    mean: f64,
    change: f64,
}

fn row(
    p: &Point3<f64>,
    foot: &crate::geometry::nurbs::CurveProjection,
    centres: &[[Vector3<f64>; 3]],
    (steps, law): (usize, RadiusLaw),
) -> Row {
    let place = foot.t * steps as f64;
    let first = (place.floor() as usize).min(steps - 1);
    let share = place - first as f64;
    let knots = [first, (first + 1) % centres.len()];
    let outwards = (p - foot.point) / foot.distance.max(f64::MIN_POSITIVE);
    let hats = [1.0 - share, share];
    let ways = [0, 1].map(|k| -hats[k] * outwards.dot(&centres[knots[k]][1]));
    let lift: f64 = (0..2).map(|k| hats[k] * outwards.dot(&centres[knots[k]][2])).sum();
    let mean = -lift - 1.0;
    Row { off: foot.distance - law.at(foot.t), knots, ways, mean, change: mean * (foot.t - 0.5) }
}
