//! Axis-parallel boxes in space.
//!
//! INVARIANT: a box without a point has `min > max`, and no distance to it is finite.

use super::Point3;

/// The smallest axis-parallel box round some points; may be empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingBox {
    /// Least coordinates.
    pub min: Point3<f64>,
    /// Greatest coordinates.
    pub max: Point3<f64>,
}

impl Default for BoundingBox {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl BoundingBox {
    /// The box of no point.
    pub const EMPTY: Self = Self {
        min: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// The box of some points.
    #[must_use]
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Self {
        let mut bounds = Self::EMPTY;
        for point in points {
            bounds.include(point);
        }
        bounds
    }

    /// Grows to hold a point.
    pub fn include(&mut self, point: &Point3<f64>) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(point[axis]);
            self.max[axis] = self.max[axis].max(point[axis]);
        }
    }

    /// Grows to hold another box.
    pub fn merge(&mut self, other: &Self) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Whether it holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.min[axis] > self.max[axis])
    }

    /// Length of the diagonal; 0 for the empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).norm() }
    }

    /// Whether a point is in it, its border counted.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        (0..3).all(|axis| point[axis] >= self.min[axis] && point[axis] <= self.max[axis])
    }

    /// Square of the distance of a point from the box; 0 inside, infinite for the empty box.
    #[must_use]
    pub fn distance_squared(&self, point: &Point3<f64>) -> f64 {
        let mut sum = 0.0;
        for axis in 0..3 {
            let outside = (self.min[axis] - point[axis]).max(point[axis] - self.max[axis]).max(0.0);
            sum += outside * outside;
        }
        sum
    }
}
