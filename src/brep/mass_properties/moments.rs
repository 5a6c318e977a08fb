//! Integrals over a piece of surface: area and its first moments, and what the divergence theorem makes of a
//! closed shell, its volume with first and second moments.

use crate::math::{Matrix3, Point3, Vector3};
use std::ops::{Add, AddAssign, Mul};

/// Count of integrals.
pub(super) const COUNT: usize = 14;
/// The first four are those of the area; they do not turn with the normal.
pub(super) const AREAS: usize = 4;
/// Powers of a length that each integral has.
const POWERS: [i32; COUNT] = [2, 3, 3, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5];

/// Factor and power by which the distance of two rules overstates the error of the better one, as QUADPACK has
/// them.
const OVERSTATED: (f64, f64) = (200.0, 1.5);

/// Integrals over a piece of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sums(pub(super) [f64; COUNT]);

impl Sums {
    /// Nothing.
    pub(super) const ZERO: Self = Self([0.0; COUNT]);

    /// Integrands at a point, seen from the reference, by `du × dv`.
    pub(super) fn at(p: &Vector3<f64>, n: &Vector3<f64>) -> Self {
        let area = n.norm();
        // Divergence theorem: x dV = d(x²/2)/dx, and so on; the volume by the whole position vector.
        let (xx, yy, zz) = (p.x * p.x, p.y * p.y, p.z * p.z);
        Self([
            area,
            p.x * area,
            p.y * area,
            p.z * area,
            p.dot(n) / 3.0,
            0.5 * xx * n.x,
            0.5 * yy * n.y,
            0.5 * zz * n.z,
            xx * p.x * n.x / 3.0,
            yy * p.y * n.y / 3.0,
            zz * p.z * n.z / 3.0,
            0.5 * xx * p.y * n.x,
            0.5 * yy * p.z * n.y,
            0.5 * zz * p.x * n.z,
        ])
    }

    /// With the integrals of the area times one factor and the others times another.
    pub(super) fn turned(mut self, area: f64, flux: f64) -> Self {
        for (i, value) in self.0.iter_mut().enumerate() {
            *value *= if i < AREAS { area } else { flux };
        }
        self
    }

    /// Absolute values.
    pub(super) fn abs(mut self) -> Self {
        self.0.iter_mut().for_each(|value| *value = value.abs());
        self
    }

    /// The error of this integral where a coarser rule gives another and the absolute values a third.
    pub(super) fn error_against(&self, coarse: &Self, size: &Self) -> Self {
        let mut error = (*self + *coarse * -1.0).abs();
        for (error, size) in error.0.iter_mut().zip(size.0) {
            if size > 0.0 {
                *error = size * (OVERSTATED.0 * *error / size).powf(OVERSTATED.1).min(1.0);
            }
        }
        error
    }

    /// Each over what it is for a piece of the given size at the given distance from the reference.
    pub(super) fn relative(&self, size: f64, reach: f64) -> f64 {
        let shares = self.0.iter().zip(POWERS).map(|(value, power)| {
            let scale = size * size * reach.powi(power - 2);
            if scale > 0.0 { value.abs() / scale } else { value.abs() }
        });
        shares.fold(0.0, f64::max)
    }
}

impl Add for Sums {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl AddAssign for Sums {
    fn add_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }
}

impl Mul<f64> for Sums {
    type Output = Self;
    fn mul(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|value| *value *= factor);
        self
    }
}

/// Mass properties of a face, a shell or a body of density one, in file units.
///
/// The volume of anything but a closed shell is that of the cone from [`reference`](Self::reference): pieces
/// add up, and only their sum over a closed shell means something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Point that the moments are taken about.
    pub reference: Point3<f64>,
    pub(super) sums: Sums,
    pub(super) errors: Sums,
    pub(super) gap: f64,
}

impl MassProperties {
    /// Of nothing, about a point.
    #[must_use]
    pub fn none(reference: Point3<f64>) -> Self {
        Self { reference, sums: Sums::ZERO, errors: Sums::ZERO, gap: 0.0 }
    }

    /// Area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.sums.0[0]
    }

    /// Bound on the error of the area by the quadrature's own estimate.
    #[must_use]
    pub fn area_error(&self) -> f64 {
        self.errors.0[0]
    }

    /// Centroid of the surface; the reference where there is no area.
    #[must_use]
    pub fn area_centroid(&self) -> Point3<f64> {
        let [area, x, y, z] = [0, 1, 2, 3].map(|i| self.sums.0[i]);
        if area > 0.0 { self.reference + Vector3::new(x, y, z) / area } else { self.reference }
    }

    /// Volume; negative when the shell is turned inside out.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.sums.0[4]
    }

    /// Bound on the error of the volume by the quadrature's own estimate.
    #[must_use]
    pub fn volume_error(&self) -> f64 {
        self.errors.0[4]
    }

    /// Centroid of the volume; the reference where there is none.
    #[must_use]
    pub fn centroid(&self) -> Point3<f64> {
        let [volume, x, y, z] = [4, 5, 6, 7].map(|i| self.sums.0[i]);
        if volume == 0.0 { self.reference } else { self.reference + Vector3::new(x, y, z) / volume }
    }

    /// Inertia of the volume about its centroid: `∫ (|r|² I - r rᵀ) dV`.
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        let [xx, yy, zz, xy, yz, zx] = [8, 9, 10, 11, 12, 13].map(|i| self.sums.0[i]);
        let second = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let away = self.centroid() - self.reference;
        let about = second - away * away.transpose() * self.volume();
        Matrix3::identity() * about.trace() - about
    }

    /// Greatest distance of an edge from a surface that it bounds. Where faces end is open to this extent; the
    /// bounds on errors do not count it.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// As a shell that an oriented shell turns round: the same area, the opposite volume.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.sums = self.sums.turned(1.0, -1.0);
        self
    }
}

impl AddAssign for MassProperties {
    /// Adds a piece about the same reference.
    fn add_assign(&mut self, other: Self) {
        self.sums += other.sums;
        self.errors += other.errors;
        self.gap = self.gap.max(other.gap);
    }
}
