//! How a group of held loops moves: pivot, direction, rotation and the freedom that is left to the solve.

use super::ScaleError;
use super::polygon::Polygon;
use super::sampling::Tangents;
use super::scaling::{Energy, Freedom, Hold, Scaling};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Affine, Matrix3, Point3, Vector3, cofactor, minimal_rotation};

/// What one loop adds to the pivot and the direction of its group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopFrame {
    /// Sum of points times their weights.
    weighted: Vector3<f64>,
    /// Sum of the weights.
    weight: f64,
    /// Vector area, or mean unit normal in the published formulation, on the side of the surface's normal.
    direction: Vector3<f64>,
}

/// A loop whose vector area is below this part of its squared length encloses nothing.
const NO_AREA: f64 = 1e-12;

impl LoopFrame {
    /// From sums that were taken elsewhere: points times weights, the weights, and a direction.
    #[must_use]
    pub fn of_sums(weighted: Vector3<f64>, weight: f64, direction: Vector3<f64>) -> Self {
        Self { weighted, weight, direction }
    }

    /// Frame of a loop on the surface before scaling.
    ///
    /// # Errors
    /// The parameters of a vertex at which the normal vanishes, or the first vertex when the loop has no
    /// direction at all.
    pub fn new(surface: &NurbsSurface, polygon: &Polygon, energy: Energy) -> Result<Self, [f64; 2]> {
        let at: Vec<Tangents> = polygon.points().iter().map(|p| Tangents::of(surface, p[0], p[1])).collect();
        match energy {
            Energy::Slide => Self::by_area(&at).ok_or(polygon.points()[0]),
            Energy::Published => Self::by_unit_normals(&at).map_err(|k| polygon.points()[k]),
        }
    }

    /// Pivot by arc length, direction by vector area: both independent of how the loop was sampled.
    fn by_area(at: &[Tangents]) -> Option<Self> {
        let origin = at.first()?.point;
        let (mut weighted, mut weight, mut area) = (Vector3::zeros(), 0.0, Vector3::zeros());
        for (a, b) in at.iter().zip(at.iter().cycle().skip(1)) {
            let length = (b.point - a.point).norm();
            weighted += (a.point.coords + b.point.coords) * (0.5 * length);
            weight += length;
            area += 0.5 * (a.point - origin).cross(&(b.point - origin));
        }
        let normal: Vector3<f64> = at.iter().map(Tangents::normal).sum::<Vector3<f64>>() / at.len() as f64;
        if area.dot(&normal) < 0.0 {
            area = -area;
        }
        if area.norm() < NO_AREA * weight * weight {
            area = normal;
        }
        (weight > 0.0 && area.norm() > 0.0).then_some(Self { weighted, weight, direction: area })
    }

    fn by_unit_normals(at: &[Tangents]) -> Result<Self, usize> {
        let (mut weighted, mut direction) = (Vector3::zeros(), Vector3::zeros());
        for (k, t) in at.iter().enumerate() {
            let normal = t.normal();
            let size = normal.norm();
            if size.is_nan() || size <= 0.0 {
                return Err(k);
            }
            weighted += t.point.coords;
            direction += normal / size;
        }
        let n = at.len() as f64;
        Ok(Self { weighted: weighted / n, weight: 1.0, direction: direction / n })
    }
}

/// The motion `x -> linear (x - pivot) + target + shift` of one group.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Rotation; for [`Hold::Axes`] the stretch along the axes that are not held.
    pub linear: Matrix3<f64>,
    /// Centre of the group before the scaling.
    pub pivot: Point3<f64>,
    /// Where the pivot goes before the solve.
    pub target: Point3<f64>,
    /// Unit normal of the group after the scaling.
    pub axis: Vector3<f64>,
    /// Directions in which the solve may move the group.
    pub directions: Vec<Vector3<f64>>,
    /// How far it did, by direction.
    pub amounts: Vec<f64>,
}

impl Motion {
    /// The motion of the loops of one group, not yet shifted.
    ///
    /// Directions are brought to the side of the largest: the two ends of a hole face apart, yet are one feature.
    /// Returns `None` when the directions cancel.
    #[must_use]
    pub fn new(frames: &[LoopFrame], hold: Hold, scaling: &Scaling, plain: &Affine) -> Option<Self> {
        let largest = frames.iter().map(|f| f.direction).fold(Vector3::zeros(), |best: Vector3<f64>, d| {
            if d.norm_squared() > best.norm_squared() { d } else { best }
        });
        let sided = |d: Vector3<f64>| if d.dot(&largest) < 0.0 { -d } else { d };
        let normal: Vector3<f64> = frames.iter().map(|f| sided(f.direction)).sum();
        let weight: f64 = frames.iter().map(|f| f.weight).sum();
        let weighted: Vector3<f64> = frames.iter().map(|f| f.weighted).sum();
        let pivot = Point3::from(weighted / weight);
        let scaled_normal = cofactor(&plain.linear) * normal;
        let turn = minimal_rotation(&normal, &scaled_normal, &Vector3::x());
        Some(Self::placed(turn, pivot, scaled_normal.try_normalize(0.0)?, hold, scaling, plain))
    }

    /// The motion about a pivot, by the given rotation where the hold lets the group turn.
    #[must_use]
    pub fn placed(
        turn: Matrix3<f64>,
        pivot: Point3<f64>,
        axis: Vector3<f64>,
        hold: Hold,
        scaling: &Scaling,
        plain: &Affine,
    ) -> Self {
        let linear = match hold {
            Hold::Rigid => turn,
            Hold::Translated | Hold::Pinned(_) => Matrix3::identity(),
            Hold::Axes(held) => {
                let factors = [0, 1, 2].map(|k| if held[k] { 1.0 } else { scaling.factors[k] });
                scaling.linear_by(factors)
            }
        };
        let (target, directions) = match (hold, scaling.freedom) {
            (Hold::Pinned(at), _) => (at.unwrap_or(pivot), Vec::new()),
            (Hold::Axes(_), _) | (_, Freedom::Normal) => (scaled(plain, &pivot), vec![axis]),
            (_, Freedom::Free) => (scaled(plain, &pivot), vec![Vector3::x(), Vector3::y(), Vector3::z()]),
        };
        Self { linear, pivot, target, axis, amounts: vec![0.0; directions.len()], directions }
    }

    /// The displacement that the solve chose.
    #[must_use]
    pub fn shift(&self) -> Vector3<f64> {
        self.directions.iter().zip(&self.amounts).map(|(f, &d)| f * d).sum()
    }

    /// Image of a point.
    #[must_use]
    pub fn apply(&self, point: &Point3<f64>) -> Point3<f64> {
        self.target + self.shift() + self.linear * (point - self.pivot)
    }

    /// Whether lengths are kept, so that a curve keeps its kind and size.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        let off = (self.linear.transpose() * self.linear - Matrix3::identity()).abs().max();
        off <= RIGID
    }
}

/// Roundings of a coordinate within which a point counts as its own image: a feature at the centre of the scaling must
/// keep its bits.
const STAYS: f64 = 4.0;

/// The image of a pivot, or the pivot itself where only rounding moves it.
fn scaled(plain: &Affine, pivot: &Point3<f64>) -> Point3<f64> {
    let image = plain.point(pivot);
    let size = pivot.coords.amax().max(plain.translation.amax());
    if (image - pivot).amax() <= STAYS * f64::EPSILON * size { *pivot } else { image }
}

/// Greatest deviation of `MᵀM` from the identity that rounding leaves in a rotation.
const RIGID: f64 = 1e-14;

/// The error of a loop without direction.
pub(super) fn degenerate(face: &str, held: usize, energy: Energy, at: [f64; 2]) -> ScaleError {
    match energy {
        Energy::Slide => ScaleError::LoopDegenerate { face: face.to_owned(), held },
        Energy::Published => ScaleError::SingularParametrisation { face: face.to_owned(), at },
    }
}
