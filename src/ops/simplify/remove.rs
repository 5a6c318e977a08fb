//! Knot removal from a net, with the distance bounded at every step and certified at the end.
//!
//! One removal is algorithm A5.8 of The NURBS Book for every row at once; bounds add up over spans as in A9.9. What the
//! steps add up to is not relied on: at the end the two surfaces are compared cell by cell.

use super::SimplifyError;
use crate::geometry::nurbs::{KnotVector, NurbsSurface, deviation_at_equal_parameters};
use crate::ops::net::{KnotRows, Mask};

/// Distance, as a part of the surface's size, within which held control points may be off: rounding of a removal that is
/// exact.
const EXACT: f64 = 1e-12;
/// Share of the tolerance for each direction.
const SHARE: f64 = 0.5;
/// Part by which a certified bound may pass the sum of the steps: rounding.
const ROUNDING: f64 = 1e-9;

/// Parameters that must stay: control points that act there move by rounding only.
pub trait Held {
    /// The control points of a net over these knots that must stay.
    fn control_points(&self, knots_u: &KnotVector, knots_v: &KnotVector) -> Mask;
}

impl<F: Fn(&KnotVector, &KnotVector) -> Mask> Held for F {
    fn control_points(&self, knots_u: &KnotVector, knots_v: &KnotVector) -> Mask {
        self(knots_u, knots_v)
    }
}

/// A surface with fewer knots.
#[derive(Debug, Clone)]
pub struct Simplified {
    /// The surface, over the same domain.
    pub surface: NurbsSurface,
    /// Greatest distance from the old surface at equal parameters, certified.
    pub bound: f64,
    /// Knots removed along `u` and along `v`.
    pub removed: [usize; 2],
}

/// Removes what knots it can.
///
/// # Errors
/// [`SimplifyError::BadTolerance`], [`SimplifyError::BoundBroken`].
pub fn simplified(
    surface: &NurbsSurface,
    tolerance: f64,
    held: &dyn Held,
) -> Result<Simplified, SimplifyError> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(SimplifyError::BadTolerance { found: tolerance });
    }
    let start = surface.clamped();
    let (along_u, removed_u) = one_direction(&start, SHARE * tolerance, held, Axis::U);
    let (turned, removed_v) = one_direction(&along_u.swapped(), SHARE * tolerance, held, Axis::V);
    let surface = turned.swapped();
    let bound = deviation_at_equal_parameters(&start, &surface);
    if bound > tolerance * (1.0 + ROUNDING) {
        return Err(SimplifyError::BoundBroken { bound, tolerance });
    }
    Ok(Simplified { surface, bound, removed: [removed_u, removed_v] })
}

/// Which parameter of the surface the rows run along now.
#[derive(Clone, Copy, PartialEq)]
enum Axis {
    U,
    V,
}

/// Removes knots along the first direction, pass after pass: of the knots that can go, the cheapest go first, and those
/// near one that went wait for the next pass.
fn one_direction(
    surface: &NurbsSurface,
    tolerance: f64,
    held: &dyn Held,
    axis: Axis,
) -> (NurbsSurface, usize) {
    let p = surface.knots_u().degree();
    let exact = EXACT * surface.bounding_box().diagonal();
    let per_length = homogeneous_share(surface);
    let mut rows = KnotRows::new(surface);
    // What the spans between distinct knots have cost so far.
    let mut spent = vec![0.0; surface.knots_u().knots().len()];
    let mut removed = 0;
    while let Some(knots) = rows.knots() {
        let mask = match axis {
            Axis::U => held.control_points(&knots, surface.knots_v()),
            Axis::V => held.control_points(surface.knots_v(), &knots).transposed(),
        };
        let mut candidates: Vec<(f64, usize)> = rows
            .interior()
            .filter_map(|r| {
                let cost = rows.cost(r, &mask, (exact, tolerance), per_length)?;
                let range = r - p..=r + p;
                let worst = spent[range].iter().fold(0.0, |a: f64, b| a.max(*b));
                (worst + cost <= tolerance).then_some((cost, r))
            })
            .collect();
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut gone: Vec<(f64, usize)> = Vec::new();
        for (cost, r) in candidates {
            if gone.iter().all(|(_, other)| r.abs_diff(*other) > 2 * p + 2) {
                gone.push((cost, r));
            }
        }
        if gone.is_empty() {
            break;
        }
        gone.sort_by_key(|(_, r)| std::cmp::Reverse(*r));
        for (cost, r) in gone {
            rows.remove(r);
            for s in &mut spent[r - p..=r + p] {
                *s += cost;
            }
            // The two spans at the knot become one, which has cost what the dearer has.
            let joined = spent[r - 1].max(spent[r]);
            spent[r - 1] = joined;
            spent.remove(r);
            removed += 1;
        }
    }
    rows.surface().map_or_else(|| (surface.clone(), 0), |s| (s, removed))
}

/// How far a point of space moves at most for a unit of distance of homogeneous ones; 1 without weights.
fn homogeneous_share(surface: &NurbsSurface) -> f64 {
    if !surface.is_rational() {
        return 1.0;
    }
    let least = surface.net().iter().map(|p| p[3]).fold(f64::INFINITY, f64::min);
    let farthest = surface.control_points().map(|p| p.coords.norm()).fold(0.0, f64::max);
    (1.0 + farthest) / least
}
