//! The smooth base under a feature: chosen control points give way to the minimiser of the exact thin-plate
//! energy, all others stay.
//!
//! A plane, and any surface that is linear in its parameters, is its own base, so that detail vanishes exactly
//! where there is none.

use super::PasteError;
use crate::geometry::nurbs::{KnotVector, NurbsSurface, gram};
use crate::ops::net::sampling::mean_lengths;
use crate::ops::net::{GridSystem, Mask};

/// Points in each direction at which the physical size of the domain is measured.
const SIZE_SAMPLES: usize = 33;

/// Gram matrices of one direction in band storage.
struct Bands {
    degree: usize,
    /// Of the functions, of first, of second derivatives; row `i` holds columns `i - p ..= i + p`.
    orders: [Vec<f64>; 3],
}

impl Bands {
    /// Over a domain mapped to the given length.
    fn new(knots: &KnotVector, length: f64) -> Self {
        let (p, n) = (knots.degree(), knots.n_basis());
        let (start, end) = knots.domain();
        let scale = length / (end - start);
        let orders = [0, 1, 2].map(|order| {
            let factor = scale.powi(1 - 2 * order as i32);
            let mut band = vec![0.0; n * (2 * p + 1)];
            for (i, row) in gram(knots, order, order).outer_iterator().enumerate() {
                for (k, value) in row.iter() {
                    band[i * (2 * p + 1) + k + p - i] = factor * value;
                }
            }
            band
        });
        Self { degree: p, orders }
    }

    fn at(&self, i: usize, k: usize) -> [f64; 3] {
        let at = i * (2 * self.degree + 1) + k + self.degree - i;
        [self.orders[0][at], self.orders[1][at], self.orders[2][at]]
    }

    fn near(&self, i: usize, count: usize) -> std::ops::Range<usize> {
        i.saturating_sub(self.degree)..(i + self.degree + 1).min(count)
    }
}

/// The surface with the chosen control points replaced by the smoothest ones.
///
/// # Errors
/// [`PasteError::SingularSystem`], [`PasteError::WeightNotPositive`].
pub fn smoothed(surface: &NurbsSurface, chosen: &Mask) -> Result<NurbsSurface, PasteError> {
    let (rows, columns) = surface.shape();
    let [length_u, length_v] = mean_lengths(surface, SIZE_SAMPLES);
    let side = (length_u / length_v).sqrt();
    let side = if side.is_finite() && side > 0.0 { side } else { 1.0 };
    let (bu, bv) = (Bands::new(surface.knots_u(), side), Bands::new(surface.knots_v(), 1.0 / side));
    let mut system = GridSystem::new(chosen, [bu.degree, bv.degree]);
    let count = system.len();
    let mut right = vec![0.0; 4 * count];
    for k in 0..count {
        let at = system.places()[k];
        let (i, j) = (at / columns, at % columns);
        for i2 in bu.near(i, rows) {
            let a = bu.at(i, i2);
            for j2 in bv.near(j, columns) {
                let b = bv.at(j, j2);
                let energy = a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2];
                let other = i2 * columns + j2;
                system.add(k, other, energy);
                if system.number(other).is_none() {
                    for (c, coordinate) in surface.net()[other].iter().enumerate() {
                        right[c * count + k] -= energy * coordinate;
                    }
                }
            }
        }
    }
    solve(&system, &mut right)?;
    with_points(surface, system.places(), &right)
}

/// Solves a system over a net for several right sides in place.
pub(super) fn solve(system: &GridSystem, right: &mut [f64]) -> Result<(), PasteError> {
    system.solve(right).map_err(|_| PasteError::SingularSystem { unknowns: system.len() })
}

/// The surface with new homogeneous points, given coordinate by coordinate.
pub(super) fn with_points(
    surface: &NurbsSurface,
    places: &[usize],
    coordinates: &[f64],
) -> Result<NurbsSurface, PasteError> {
    let count = places.len();
    let mut net = surface.net().to_vec();
    for (k, &at) in places.iter().enumerate() {
        net[at] = [0, 1, 2, 3].map(|c| coordinates[c * count + k]);
    }
    with_net(surface, net)
}

/// The surface over the same knots with another net.
pub(super) fn with_net(surface: &NurbsSurface, net: Vec<[f64; 4]>) -> Result<NurbsSurface, PasteError> {
    if let Some(point) = net.iter().find(|point| point[3].is_nan() || point[3] <= 0.0) {
        return Err(PasteError::WeightNotPositive { weight: point[3] });
    }
    let (u, v) = (surface.knots_u().clone(), surface.knots_v().clone());
    NurbsSurface::new(u, v, net).map_err(|_| PasteError::SingularSystem { unknowns: surface.net().len() })
}
