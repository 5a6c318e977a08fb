//! How good a scaled face is: distance, normals and curvature against the closest points of the plainly scaled
//! surface, and how exactly held loops kept their shape.
//!
//! Figures for the report; no decision hangs on them but that of [`motion_deviation`].

use super::motion::Motion;
use super::sampling::{closest, steps};
use super::task::ScaledFace;
use crate::geometry::nurbs::{Accuracy, Deviation, NurbsSurface, deviation};
use crate::math::{Point3, Vector3, rigid_fit};

/// Comparison of a face with the plainly scaled surface outside the held cells, sampled on a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Greatest distance from the closest point, in file units.
    pub deviation_max: f64,
    /// Root mean square of the distances.
    pub deviation_rms: f64,
    /// Greatest angle between normals at closest points, in radians.
    pub normal_angle_max: f64,
    /// Correlation of the Gaussian curvatures at closest points; none for constant curvature.
    pub gaussian_correlation: Option<f64>,
    /// Correlation of the mean curvatures at closest points; none for constant curvature.
    pub mean_correlation: Option<f64>,
    /// Ratio of the integrals of `k1² + k2²`, new over plainly scaled; none for a plane.
    pub bending_ratio: Option<f64>,
}

/// Samples in each direction for [`quality`] in a report.
pub const REPORT_SAMPLES: usize = 101;

/// A point counts as held when the held control points carry all but this part of it.
const HELD: f64 = 1e-9;
/// Curvature integral below which a surface counts as flat: rounding of a panel of any size stays below.
const FLAT: f64 = 1e-18;

/// Compares a face with its plain scaling on `samples` x `samples` points of the domain.
#[must_use]
pub fn quality(face: &ScaledFace, samples: usize) -> Quality {
    let (knots_u, knots_v) = (face.surface.knots_u(), face.surface.knots_v());
    let ((u0, u1), (v0, v1)) = (knots_u.domain(), knots_v.domain());
    let mut sums = Sums::default();
    for u in steps(u0, u1, samples) {
        for v in steps(v0, v1, samples) {
            let (Some(new), Some(same)) = (Bend::of(&face.surface, [u, v]), Bend::of(&face.plain, [u, v]))
            else {
                continue;
            };
            sums.bending[0] += new.energy();
            sums.bending[1] += same.energy();
            if held_part(face, [u, v]) < 1.0 - HELD {
                let near = closest(&face.plain, &new.point, [u, v]);
                if let Some(old) = Bend::of(&face.plain, near) {
                    sums.add(&new, &old);
                }
            }
        }
    }
    sums.quality()
}

/// Proved bounds of how far a face is from the plainly scaled surface; see [`deviation()`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certified {
    /// Over the cells in which some control point that acts is not held; none when there are no such cells.
    pub outside: Option<Deviation>,
    /// Over the cells in which all are held: there the face keeps its shape, and the plain scaling does not.
    pub held: Option<Deviation>,
}

/// Bounds the deviation of a face.
#[must_use]
pub fn certified(face: &ScaledFace) -> Certified {
    let (knots_u, knots_v) = (face.surface.knots_u(), face.surface.knots_v());
    let (p, q) = (knots_u.degree(), knots_v.degree());
    let (spans_u, spans_v): (Vec<usize>, Vec<usize>) = (knots_u.spans().collect(), knots_v.spans().collect());
    let held = |[i, j]: [usize; 2]| {
        let (k, l) = (spans_u[i], spans_v[j]);
        (k - p..=k).all(|row| (l - q..=l).all(|column| face.held.contains(row, column)))
    };
    let bound =
        |part: &dyn Fn([usize; 2]) -> bool| deviation(&face.surface, &face.image, &Accuracy::default(), part);
    Certified { outside: bound(&|cell| !held(cell)), held: bound(&held) }
}

/// How far a held loop is from where its group's motion takes it, and from being a rigid copy of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionDeviation {
    /// Greatest deviation of a coordinate from the rigid copy that fits best, as a part of the loop's extent. A
    /// motion that stretches, as one that holds only some axes, leaves its stretch here.
    pub rigid: f64,
    /// Greatest deviation of a coordinate from the imposed motion, as a part of the loop's extent.
    pub relative: f64,
    /// The part of it that rounding of the coordinates themselves explains: it matters for a small loop far from
    /// the origin.
    pub rounding: f64,
}

/// Deviation of a held loop from the imposed motion, and from a rigid copy.
///
/// `before` and `after` are the surfaces, `points` the loop's polygon, which is sampled eight times finer.
#[must_use]
pub fn motion_deviation(
    before: &NurbsSurface,
    after: &NurbsSurface,
    points: &[[f64; 2]],
    motion: &Motion,
) -> MotionDeviation {
    let mut pairs = Vec::with_capacity(points.len() * FINER);
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        for k in 0..FINER {
            let t = k as f64 / FINER as f64;
            let (u, v) = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
            pairs.push((before.point(u, v), after.point(u, v)));
        }
    }
    MotionDeviation::of_pairs(&pairs, motion)
}

impl MotionDeviation {
    /// Of points with what became of them.
    #[must_use]
    pub fn of_pairs(pairs: &[(Point3<f64>, Point3<f64>)], motion: &Motion) -> Self {
        let (mut worst, mut magnitude) = (0.0_f64, 0.0_f64);
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = -low;
        for (start, found) in pairs {
            let expected = motion.apply(start);
            worst = worst.max((found - expected).amax());
            magnitude = magnitude.max(start.coords.amax()).max(expected.coords.amax());
            low = low.inf(&start.coords);
            high = high.sup(&start.coords);
        }
        let extent = (high - low).max();
        // Where the motion is rigid, it is the copy that was meant: a fit could only flatter it.
        let best = if motion.is_rigid() { None } else { rigid_fit(pairs) };
        let off = best.map(|best| pairs.iter().map(|(p, q)| (best.point(p) - q).amax()).fold(0.0, f64::max));
        Self {
            rigid: off.unwrap_or(worst) / extent,
            relative: worst / extent,
            rounding: ROUNDINGS * f64::EPSILON * magnitude / extent,
        }
    }
}

/// Sub-samples of each side of a loop's polygon.
const FINER: usize = 8;
/// Roundings of a coordinate between two evaluations of one point through different nets.
const ROUNDINGS: f64 = 8.0;

/// Part of a point that comes from held control points.
fn held_part(face: &ScaledFace, at: [f64; 2]) -> f64 {
    let u = face.surface.knots_u().basis_derivatives(at[0], 0);
    let v = face.surface.knots_v().basis_derivatives(at[1], 0);
    let mut sum = 0.0;
    for (i, nu) in u.values().iter().enumerate() {
        for (j, nv) in v.values().iter().enumerate() {
            if face.held.contains(u.first() + i, v.first() + j) {
                sum += nu * nv;
            }
        }
    }
    sum
}

/// Point, normal and curvatures.
struct Bend {
    point: Point3<f64>,
    normal: Vector3<f64>,
    gaussian: f64,
    mean: f64,
    area: f64,
}

impl Bend {
    /// Returns `None` where the parametrisation is singular.
    fn of(surface: &NurbsSurface, at: [f64; 2]) -> Option<Self> {
        let d = surface.derivatives(at[0], at[1]);
        let normal = d.normal()?;
        let (gaussian, mean) = d.curvatures()?;
        let area = d.cross().norm();
        let finite = gaussian.is_finite() && mean.is_finite();
        finite.then_some(Self { point: d.point, normal, gaussian, mean, area })
    }

    /// `(k1² + k2²) dA`.
    fn energy(&self) -> f64 {
        (4.0 * self.mean * self.mean - 2.0 * self.gaussian) * self.area
    }
}

#[derive(Default)]
struct Sums {
    count: f64,
    squares: f64,
    deviation: f64,
    angle: f64,
    gaussian: Vec<(f64, f64)>,
    mean: Vec<(f64, f64)>,
    bending: [f64; 2],
}

impl Sums {
    fn add(&mut self, new: &Bend, old: &Bend) {
        let distance = (new.point - old.point).norm();
        self.count += 1.0;
        self.squares += distance * distance;
        self.deviation = self.deviation.max(distance);
        self.angle = self.angle.max(new.normal.angle(&old.normal));
        self.gaussian.push((new.gaussian, old.gaussian));
        self.mean.push((new.mean, old.mean));
    }

    fn quality(&self) -> Quality {
        let [new, old] = self.bending;
        Quality {
            deviation_max: self.deviation,
            deviation_rms: if self.count > 0.0 { (self.squares / self.count).sqrt() } else { 0.0 },
            normal_angle_max: self.angle,
            gaussian_correlation: correlation(&self.gaussian),
            mean_correlation: correlation(&self.mean),
            bending_ratio: (old > FLAT).then(|| new / old),
        }
    }
}

/// Pearson's coefficient; `None` when either side is constant.
fn correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let (sum_a, sum_b) = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (mean_a, mean_b) = (sum_a / n, sum_b / n);
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a - mean_a, b - mean_b);
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    let size = (aa * bb).sqrt();
    (size > 0.0).then(|| ab / size)
}
