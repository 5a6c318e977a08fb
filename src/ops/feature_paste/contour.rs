//! A contour drawn in space becomes a polygon in the parameters of the source: each point goes along the normal of
//! a reference plane onto the surface.
//!
//! Where the normal meets several sheets the one nearest to the drawn point is taken; a contour that jumps from one
//! sheet to another is refused.

use super::PasteError;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Point3, Vector2, Vector3};
use crate::ops::net::sampling::steps;

/// A reference plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of it.
    pub origin: Point3<f64>,
    /// Unit normal.
    pub normal: Vector3<f64>,
}

/// Ends of a contour nearer than this part of its size are one point.
const CLOSED: f64 = 1e-6;

impl Plane {
    /// The plane through the centre of a closed polyline, across its vector area; `None` for one without area.
    #[must_use]
    pub fn of_contour(points: &[Point3<f64>]) -> Option<Self> {
        let count = points.len() as f64;
        let centre = points.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / count;
        let off = |p: &Point3<f64>| p.coords - centre;
        let next = points.iter().cycle().skip(1);
        let area = points.iter().zip(next).fold(Vector3::zeros(), |sum, (a, b)| sum + off(a).cross(&off(b)));
        let normal = area.try_normalize(0.0)?;
        Some(Self { origin: Point3::from(centre), normal })
    }
}

/// The points of a contour without a repeated first one at the end.
///
/// # Errors
/// [`PasteError::ContourOpen`] for a curve, whose ends must meet within 1e-6 of its size; a polyline of which the
/// closing side is implied is never open.
pub fn closed_points(mut points: Vec<Point3<f64>>) -> Result<Vec<Point3<f64>>, PasteError> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Err(PasteError::ContourDegenerate);
    };
    let size = points.iter().map(|p| (p - first).norm()).fold(0.0, f64::max);
    let (gap, allowed) = ((last - first).norm(), CLOSED * size);
    if gap > allowed {
        return Err(PasteError::ContourOpen { gap, allowed });
    }
    points.pop();
    Ok(points)
}

/// Seeds in each direction.
const SEEDS: usize = 33;
/// Seeds from which each point is sought.
const TRIED: usize = 6;
/// Steps allowed.
const MAX_STEPS: usize = 40;
/// Residual, as a part of the surface's size, at which a point counts as found.
const FOUND: f64 = 1e-10;
/// Step, as a part of the domain, below which the next one would be rounding.
const STEP_END: f64 = 1e-15;
/// Determinant, relative to the squared size, at which the surface stands along the normal.
const UPRIGHT: f64 = 1e-14;
/// Heights that differ by less than this part of the size are those of one sheet.
const SAME_SHEET: f64 = 1e-9;
/// A step this often as long as the median one is a jump.
const JUMP: f64 = 8.0;

struct Seed {
    at: [f64; 2],
    flat: Vector2<f64>,
}

struct Projector<'a> {
    surface: &'a NurbsSurface,
    plane: Plane,
    axes: [Vector3<f64>; 2],
    size: f64,
    seeds: Vec<Seed>,
}

impl<'a> Projector<'a> {
    fn new(surface: &'a NurbsSurface, plane: Plane) -> Self {
        let n = plane.normal;
        let least = n.iter().enumerate().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |m| m.0);
        let mut axis = Vector3::zeros();
        axis[least] = 1.0;
        let e = n.cross(&axis).normalize();
        let axes = [e, n.cross(&e)];
        let bounds = surface.bounding_box();
        let size = (bounds.max - bounds.min).max();
        let mut projector = Self { surface, plane, axes, size, seeds: Vec::new() };
        let (u, v) = surface.domain();
        for x in steps(u.0, u.1, SEEDS) {
            for y in steps(v.0, v.1, SEEDS) {
                let flat = projector.flat(&surface.point(x, y));
                projector.seeds.push(Seed { at: [x, y], flat });
            }
        }
        projector
    }

    /// Coordinates in the plane.
    fn flat(&self, point: &Point3<f64>) -> Vector2<f64> {
        let d = point - self.plane.origin;
        Vector2::new(self.axes[0].dot(&d), self.axes[1].dot(&d))
    }

    /// Whether a place of the surface lies inside the contour, as seen along the normal.
    fn within(&self, contour: &[Point3<f64>]) -> bool {
        let corners: Vec<Vector2<f64>> = contour.iter().map(|point| self.flat(point)).collect();
        let sides = || corners.iter().zip(corners.iter().cycle().skip(1));
        let inside = |p: &Vector2<f64>| {
            let crosses = |a: &Vector2<f64>, b: &Vector2<f64>| {
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            };
            sides().filter(|(a, b)| crosses(a, b)).count() % 2 == 1
        };
        self.seeds.iter().any(|seed| inside(&seed.flat))
    }

    /// Newton's method from one seed: parameters whose point lies on the normal through the target.
    fn descend(&self, goal: &Vector2<f64>, seed: [f64; 2]) -> Option<[f64; 2]> {
        let (du, dv) = self.surface.domain();
        let domain = [du, dv];
        let mut at = seed;
        for _ in 0..MAX_STEPS {
            let (point, su, sv) = self.surface.first_derivatives(at[0], at[1]);
            let rest = goal - self.flat(&point);
            let [a, c] = self.axes.map(|axis| axis.dot(&su));
            let [b, d] = self.axes.map(|axis| axis.dot(&sv));
            let determinant = a * d - b * c;
            if determinant.abs() < UPRIGHT * self.size * self.size {
                break;
            }
            let step = [(d * rest.x - b * rest.y) / determinant, (a * rest.y - c * rest.x) / determinant];
            let mut longest = 0.0_f64;
            for k in 0..2 {
                at[k] = (at[k] + step[k]).clamp(domain[k].0, domain[k].1);
                longest = longest.max(step[k].abs() / (domain[k].1 - domain[k].0));
            }
            if longest < STEP_END {
                break;
            }
        }
        let rest = (goal - self.flat(&self.surface.point(at[0], at[1]))).norm();
        (rest <= FOUND * self.size).then_some(at)
    }

    fn project(&self, target: &Point3<f64>, before: Option<[f64; 2]>) -> Option<[f64; 2]> {
        let goal = self.flat(target);
        let mut near: Vec<(f64, usize)> =
            self.seeds.iter().enumerate().map(|(k, s)| ((s.flat - goal).norm(), k)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let seeds = near.iter().take(TRIED).map(|&(_, k)| self.seeds[k].at).chain(before);
        let mut best: Option<(f64, [f64; 2])> = None;
        for seed in seeds {
            let Some(at) = self.descend(&goal, seed) else { continue };
            let height = (self.surface.point(at[0], at[1]) - target).dot(&self.plane.normal).abs();
            if best.is_none_or(|(least, _)| height < least - SAME_SHEET * self.size) {
                best = Some((height, at));
            }
        }
        best.map(|(_, at)| at)
    }
}

/// Parameters of the source for each point of a closed contour, along the normal of a plane.
///
/// # Errors
/// [`PasteError::ContourProjectionFailed`], [`PasteError::ContourOffFace`], [`PasteError::ContourLargerThanFace`],
/// [`PasteError::ContourJumpsSheet`], [`PasteError::ContourDegenerate`], [`PasteError::ContourNotFinite`].
pub fn project_contour(
    surface: &NurbsSurface,
    points: &[Point3<f64>],
    plane: Plane,
) -> Result<Vec<[f64; 2]>, PasteError> {
    if points.len() < 3 {
        return Err(PasteError::ContourDegenerate);
    }
    let normal = plane.normal.try_normalize(0.0).ok_or(PasteError::ContourDegenerate)?;
    if !points.iter().all(|p| p.iter().all(|c| c.is_finite())) {
        return Err(PasteError::ContourNotFinite);
    }
    let projector = Projector::new(surface, Plane { normal, ..plane });
    let mut found: Vec<Option<[f64; 2]>> = Vec::with_capacity(points.len());
    for target in points {
        let before = found.last().copied().flatten();
        found.push(projector.project(target, before));
    }
    if let Some(out) = found.iter().copied().collect::<Option<Vec<_>>>() {
        return refuse_jumps(surface, points, &out).map(|()| out);
    }
    Err(match found.iter().position(Option::is_some) {
        None if projector.within(points) => PasteError::ContourLargerThanFace,
        None => PasteError::ContourOffFace,
        Some(_) => {
            let point = found.iter().position(Option::is_none).unwrap_or(0);
            PasteError::ContourProjectionFailed { point }
        }
    })
}

/// A side that is long in parameters and not in space jumps.
fn refuse_jumps(
    surface: &NurbsSurface,
    points: &[Point3<f64>],
    found: &[[f64; 2]],
) -> Result<(), PasteError> {
    let (u, v) = surface.domain();
    let range = [u.1 - u.0, v.1 - v.0];
    let count = found.len();
    let ratios: Vec<f64> = (0..count)
        .map(|k| {
            let (a, b) = (found[k], found[(k + 1) % count]);
            let step = ((b[0] - a[0]) / range[0]).hypot((b[1] - a[1]) / range[1]);
            step / (points[(k + 1) % count] - points[k]).norm()
        })
        .collect();
    let mut sorted: Vec<f64> = ratios.iter().copied().filter(|r| r.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(&median) = sorted.get(sorted.len() / 2) else { return Err(PasteError::ContourDegenerate) };
    let jump = ratios.iter().position(|&r| r.is_finite() && r > JUMP * median);
    match jump {
        Some(point) => Err(PasteError::ContourJumpsSheet { point, times: ratios[point] / median }),
        None => Ok(()),
    }
}
