//! Whether a cloud can be one of a part at all: in its units, and where it is.
//!
//! Few formats state a unit, and a wrong one looks like a cloud far from the part, or like a speck near its origin.

use super::Neighbours;
use crate::math::{BoundingBox, Point3};

/// A cloud that is not one of the part.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Misplacement {
    /// In other units it would fit.
    #[error(
        "the cloud does not fit the part, and fits it {factor} times as large: a wrong unit is suspected ({unit}); half of \
         its points are more than {distance:.6} from the surface"
    )]
    Unit {
        /// Factor that makes it fit.
        factor: f64,
        /// What the factor hints at.
        unit: &'static str,
        /// Median distance as it is.
        distance: f64,
    },
    /// It is elsewhere.
    #[error(
        "the cloud is far from the part: half of its points are more than {distance:.6} from the surface, and it is \
         {size:.6} across"
    )]
    Far {
        /// Median distance of the points from the surface.
        distance: f64,
        /// Diagonal of the cloud's box.
        size: f64,
    },
}

impl Misplacement {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unit { .. } => "cloud.wrong-unit",
            Self::Far { .. } => "cloud.far-from-part",
        }
    }
}

/// Factors between units that are mistaken for each other, the usual ones first, and what each hints at.
const FACTORS: [(f64, &str); 8] = [
    (25.4, "inches read as millimetres"),
    (1.0 / 25.4, "millimetres read as inches"),
    (1000.0, "metres read as millimetres"),
    (1e-3, "millimetres read as metres"),
    (10.0, "centimetres read as millimetres"),
    (0.1, "millimetres read as centimetres"),
    (39.370_078_740_157_48, "metres read as inches"),
    (0.0254, "inches read as metres"),
];

/// Points that are asked.
const SAMPLED: usize = 400;
/// Median distance, as a part of the cloud's size, up to which a cloud is believed at once.
const NEAR: f64 = 0.05;
/// Median distance, as a part of the cloud's size, beyond which it is not believed.
const FAR: f64 = 0.5;
/// By how much nearer, relative to its size, a scaled cloud must be to be suspected.
const BETTER: f64 = 0.25;
/// Median distance of a scaled cloud, as a part of its size, up to which it is suspected.
const CREDIBLE: f64 = 0.1;
/// Size of a scaled cloud that is suspected, in parts of the part's.
const FITTING: [f64; 2] = [0.02, 2.0];

/// Checks a cloud against a part whose surface is so far from a place.
///
/// # Errors
/// [`Misplacement`].
pub fn check(
    cloud: &[Point3<f64>],
    part: &BoundingBox,
    distance: &dyn Fn(&Point3<f64>) -> f64,
) -> Result<(), Misplacement> {
    let size = BoundingBox::of(cloud).diagonal();
    let sample: Vec<Point3<f64>> = cloud.iter().step_by((cloud.len() / SAMPLED).max(1)).copied().collect();
    let median = |factor: f64| {
        let mut all: Vec<f64> = sample.iter().map(|p| distance(&(p * factor))).collect();
        let half = all.len() / 2;
        if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(half, f64::total_cmp).1 }
    };
    let now = median(1.0);
    if now <= NEAR * size {
        return Ok(());
    }
    let fits = |factor: f64| {
        let share = factor * size / part.diagonal();
        let relative = median(factor) / factor;
        (FITTING[0]..=FITTING[1]).contains(&share) && relative < (BETTER * now).min(CREDIBLE * size)
    };
    let best = FACTORS.iter().find(|(factor, _)| fits(*factor));
    match best {
        Some(&(factor, unit)) => Err(Misplacement::Unit { factor, unit, distance: now }),
        None if now > FAR * size => Err(Misplacement::Far { distance: now, size }),
        None => Ok(()),
    }
}

/// Least count of points that a surface can be made from.
pub const LEAST_POINTS: usize = 50;

/// Whether the points of a cloud lie along a line or in one place, so that no surface goes through them.
#[must_use]
pub fn is_degenerate(cloud: &Neighbours) -> bool {
    let Some(axes) = crate::math::PrincipalAxes::of(cloud.points().iter()) else { return true };
    axes.variances[1] <= FLAT * axes.variances[0]
}

/// Second variance, as a part of the first, of points along a line.
const FLAT: f64 = 1e-12;
