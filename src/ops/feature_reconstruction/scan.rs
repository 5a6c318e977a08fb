//! The points of a feature: which lie on the secondary and which on the blend, and whether they can be points of the part.

use super::error::ReconstructionError;
use super::feet::Projector;
use super::metric::Metric;
use crate::brep::FaceId;
use crate::cloud::placement::{LEAST_POINTS, check, is_degenerate};
use crate::cloud::segment::Scales;
use crate::cloud::{Neighbours, Role, segmented};
use crate::geometry::Surface;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Affine, BoundingBox, Point3, Vector3, rotation};
use crate::model::Model;

/// Points as they come.
#[derive(Debug, Clone, PartialEq)]
pub enum Scan {
    /// Sorted already.
    Sorted {
        /// Points of the secondary.
        objective: Vec<Point3<f64>>,
        /// Points of the blend.
        blend: Vec<Point3<f64>>,
    },
    /// Of the whole region, the primary among them.
    Whole(Vec<Point3<f64>>),
}

/// Points of a feature, sorted.
#[derive(Debug, Clone)]
pub struct Sorted {
    /// Points of the secondary.
    pub objective: Vec<Point3<f64>>,
    /// Points of the blend.
    pub blend: Vec<Point3<f64>>,
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// Points of the primary, and points that belong to nothing.
    pub left_out: [usize; 2],
}

/// Least counts of the specification, objective and blend.
const LEAST: [usize; 2] = [200, LEAST_POINTS];
/// Ratio of the two kinds of curvature below which a cloud has no blend.
const NO_BLEND: f64 = 1.5;

impl Scan {
    /// All points.
    pub fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        let (first, second) = match self {
            Self::Sorted { objective, blend } => (&objective[..], &blend[..]),
            Self::Whole(points) => (&points[..], &[][..]),
        };
        first.iter().chain(second)
    }

    /// All features of a ring of `count` turned onto one of them: points are turned by whole steps about the axis.
    #[must_use]
    pub fn folded(self, axis: (&Point3<f64>, &Vector3<f64>), count: usize) -> Self {
        let turns = Turns::new(axis, count);
        let phase = turns.phase(self.points());
        let fold = |points: Vec<Point3<f64>>| points.iter().map(|p| turns.folded(p, phase)).collect();
        match self {
            Self::Sorted { objective, blend } => {
                Self::Sorted { objective: fold(objective), blend: fold(blend) }
            }
            Self::Whole(points) => Self::Whole(fold(points)),
        }
    }

    /// The points by what they lie on.
    ///
    /// # Errors
    /// [`ReconstructionError::Misplaced`], [`ReconstructionError::CloudTooSmall`],
    /// [`ReconstructionError::CloudDegenerate`], [`ReconstructionError::NoBlend`].
    pub fn sorted(self, primary: &Projector<'_>) -> Result<Sorted, ReconstructionError> {
        let all: Vec<Point3<f64>> = self.points().copied().collect();
        if all.is_empty() {
            return Err(ReconstructionError::CloudTooSmall { which: "objective", found: 0, least: LEAST[0] });
        }
        let distance = |point: &Point3<f64>| primary.foot(point).height.abs();
        check(&all, &primary.surface().bounding_box(), &distance)?;
        let tree = Neighbours::new(&all);
        let spacing = tree.spacing();
        let (objective, blend, left_out) = match self {
            Self::Sorted { objective, blend } => (objective, blend, [0; 2]),
            Self::Whole(points) => by_role(&points, primary, spacing)?,
        };
        for (which, points, least) in [("objective", &objective, LEAST[0]), ("blend", &blend, LEAST[1])] {
            if points.len() < least {
                return Err(ReconstructionError::CloudTooSmall { which, found: points.len(), least });
            }
            if is_degenerate(&Neighbours::new(points)) {
                return Err(ReconstructionError::CloudDegenerate { which });
            }
        }
        Ok(Sorted { objective, blend, spacing, left_out })
    }
}

type ByRole = (Vec<Point3<f64>>, Vec<Point3<f64>>, [usize; 2]);

fn by_role(
    points: &[Point3<f64>],
    primary: &Projector<'_>,
    spacing: f64,
) -> Result<ByRole, ReconstructionError> {
    let heights: Vec<f64> = primary.feet(points).iter().map(|foot| foot.height).collect();
    let size = BoundingBox::of(points);
    let sides = size.max - size.min;
    let scales = Scales { spacing, tolerance: None, size: sides.min() };
    let found = segmented(points, &heights, &scales);
    if found.separation < NO_BLEND {
        return Err(ReconstructionError::NoBlend { separation: found.separation });
    }
    let of =
        |role: Role| points.iter().zip(&found.roles).filter(|(_, r)| **r == role).map(|(p, _)| *p).collect();
    let left_out = [Role::Primary, Role::Outlier].map(|role| found.count(role));
    Ok((of(Role::Objective), of(Role::Blend), left_out))
}

/// Whole steps of a ring.
struct Turns {
    point: Point3<f64>,
    axis: Vector3<f64>,
    across: [Vector3<f64>; 2],
    step: f64,
}

impl Turns {
    fn new((point, direction): (&Point3<f64>, &Vector3<f64>), count: usize) -> Self {
        let axis = direction.normalize();
        let least = axis.iamin();
        let first = axis.cross(&Vector3::ith(least, 1.0)).normalize();
        let across = [first, axis.cross(&first)];
        Self { point: *point, axis, across, step: std::f64::consts::TAU / count as f64 }
    }

    fn angle(&self, point: &Point3<f64>) -> f64 {
        let away = point - self.point;
        away.dot(&self.across[1]).atan2(away.dot(&self.across[0]))
    }

    /// Angle of the middle of a step's points.
    fn phase<'a>(&self, points: impl Iterator<Item = &'a Point3<f64>>) -> f64 {
        let turns = std::f64::consts::TAU / self.step;
        let (sine, cosine) = points.fold((0.0, 0.0), |(s, c), p| {
            let (sine, cosine) = (turns * self.angle(p)).sin_cos();
            (s + sine, c + cosine)
        });
        f64::atan2(sine, cosine) / turns
    }

    fn folded(&self, point: &Point3<f64>, phase: f64) -> Point3<f64> {
        let steps = ((self.angle(point) - phase) / self.step).round();
        if steps == 0.0 {
            return *point;
        }
        Affine::about(&self.point, rotation(&self.axis, -steps * self.step)).point(point)
    }
}

/// Part of the points' extent by which a working surface reaches beyond them.
const BEYOND: f64 = 0.4;
/// Points by which the extent is found.
const ASKED: usize = 20_000;

/// A B-spline of the primary under a feature, and whether it has the face's own parameters: the face's own surface where it
/// is one, or else a piece of it.
///
/// # Errors
/// [`ReconstructionError::Primary`].
pub fn working_surface(
    model: &Model,
    face: FaceId,
    points: &[Point3<f64>],
) -> Result<NurbsSurface, ReconstructionError> {
    let fault = |reason: String| ReconstructionError::Primary { reason };
    let surface = model.brep.surface_of(face).read().ok_or_else(|| fault("it was not read".to_owned()))?;
    if let Surface::Nurbs(surface) = surface {
        return Ok(surface.clamped());
    }
    let mut places: Vec<(f64, f64)> = Vec::new();
    for point in points.iter().step_by((points.len() / ASKED).max(1)) {
        places.push(surface.parameters_of(point, places.last().copied()));
    }
    let range = |of: &dyn Fn(&(f64, f64)) -> f64, domain: (f64, f64), period: Option<f64>| {
        let (low, high) = places
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let more = BEYOND * (high - low);
        match period {
            Some(period) => {
                let more = more.min(0.49 * (period - (high - low)).max(0.0));
                (low - more, high + more)
            }
            None => ((low - more).max(domain.0), (high + more).min(domain.1)),
        }
    };
    let (domain, periods) = (surface.domain(), surface.periods());
    let u = range(&|at| at.0, domain.0, periods.0);
    let v = range(&|at| at.1, domain.1, periods.1);
    surface.to_nurbs(u, v).map_err(|error| fault(error.to_string()))
}

/// Lengths by which a surface must go on beyond its ends, in its parameters along `u` and `v`, for a feature that runs out
/// there; `None` for one with all points farther within than they are apart.
#[must_use]
pub fn extension(primary: &Projector<'_>, points: &[Point3<f64>], spacing: f64) -> Option<[f64; 2]> {
    let surface = primary.surface();
    let feet = primary.feet(points);
    let metric = Metric::around(surface, &feet);
    let (u, v) = surface.domain();
    let near = metric.parameters([spacing; 2]);
    let at_end = |x: f64, (low, high): (f64, f64), near: f64| x <= low + near || x >= high - near;
    if !feet.iter().any(|foot| at_end(foot.at[0], u, near[0]) || at_end(foot.at[1], v, near[1])) {
        return None;
    }
    let height = feet.iter().fold(0.0, |most: f64, foot| most.max(foot.height.abs()));
    Some(metric.parameters([EXTENSION * height; 2]))
}

/// Extension in heights of the feature.
const EXTENSION: f64 = 2.0;
