//! Right-handed orthonormal frames.
//!
//! Does not know units, nor the entities that frames are written as.

use super::{Point3, Vector3};

/// An origin with three orthonormal axes, `z = x × y`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Origin, in file units.
    pub origin: Point3<f64>,
    /// First axis, unit length.
    pub x: Vector3<f64>,
    /// Second axis, unit length.
    pub y: Vector3<f64>,
    /// Third axis, unit length.
    pub z: Vector3<f64>,
}

impl Frame {
    /// The frame with third axis `z` and first axis as near to `x` as orthogonality allows.
    ///
    /// `x` may be absent, parallel to `z` or zero: then the coordinate axis that is least aligned with
    /// `z` takes its place, as `first_proj_axis` of ISO 10303-42 does.
    ///
    /// Returns `None` when `z` is zero or anything is not finite.
    #[must_use]
    pub fn from_axis(origin: Point3<f64>, z: Vector3<f64>, x: Option<Vector3<f64>>) -> Option<Self> {
        let z = unit(z)?;
        let across = |v: Vector3<f64>| {
            let v = unit(v)?;
            let rest = v - z * z.dot(&v);
            (rest.norm() > PARALLEL).then(|| rest.normalize())
        };
        let x = match x.and_then(across) {
            Some(x) => x,
            None if z.x.abs() < 1.0 - PARALLEL => across(Vector3::x())?,
            None => across(Vector3::y())?,
        };
        let finite = origin.iter().all(|c| c.is_finite());
        finite.then(|| Self { origin, x, y: z.cross(&x), z })
    }

    /// The point with the given coordinates in this frame.
    #[must_use]
    pub fn point(&self, x: f64, y: f64, z: f64) -> Point3<f64> {
        self.origin + self.x * x + self.y * y + self.z * z
    }

    /// Coordinates of a point in this frame.
    #[must_use]
    pub fn local(&self, point: &Point3<f64>) -> Vector3<f64> {
        let d = point - self.origin;
        Vector3::new(d.dot(&self.x), d.dot(&self.y), d.dot(&self.z))
    }
}

/// Sine of the angle below which two directions count as parallel: a direction with six decimals,
/// as poor exporters write them, still gives a frame.
const PARALLEL: f64 = 1e-7;

fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let norm = v.norm();
    (norm.is_finite() && norm > 0.0).then(|| v / norm)
}
