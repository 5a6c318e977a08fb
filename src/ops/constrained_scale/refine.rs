//! Bisection of all spans until held loops, border and each other lie far enough apart in control points.
//!
//! Geometry is never changed, only the net.

use super::ScaleError;
use super::envelope::{Envelopes, GAP, Prepared};
use super::sampling::mean_lengths;
use super::scaling::Scaling;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};

/// A net with room between its held loops.
#[derive(Debug, Clone)]
pub struct Refined {
    /// Refined surface.
    pub surface: NurbsSurface,
    /// Its index sets.
    pub envelopes: Envelopes,
    /// How often spans were bisected.
    pub level: usize,
    /// Pairs of loops that stay too near to each other: they must share one motion.
    pub near_pairs: Vec<(usize, usize)>,
}

/// A direction is bisected when its spans are longer than this part of the other direction's.
const BISECT: f64 = 0.6;
/// Points in each direction at which span lengths are measured.
const LENGTH_SAMPLES: usize = 17;

/// Bisects the net of a face until the gaps are wide enough and `least_level` is reached, or the next net would
/// exceed the limit. `group` tells for each held loop which loops move with it: those may be near.
///
/// # Errors
/// [`ScaleError::NetTooLarge`] for the input net, [`ScaleError::HoldCoversFace`],
/// [`ScaleError::FeatureTooCloseToBoundary`].
pub fn refine(
    face: &Prepared,
    group: &[usize],
    least_level: usize,
    scaling: &Scaling,
) -> Result<Refined, ScaleError> {
    let limit = scaling.max_control_points;
    let mut surface = face.surface.clone();
    if surface.net().len() > limit {
        let points = surface.net().len();
        return Err(ScaleError::NetTooLarge { face: face.name.clone(), points, limit });
    }
    // Bisection changes no geometry, so one measurement serves all levels.
    let lengths = mean_lengths(&surface, LENGTH_SAMPLES);
    let mut level = 0;
    loop {
        let envelopes = Envelopes::new(face, &surface, scaling.continuity.rows());
        let border = envelopes.near_border();
        let near_pairs = envelopes.near_pairs(group);
        if level >= least_level && border.is_none() && near_pairs.is_empty() {
            return Ok(Refined { surface, envelopes, level, near_pairs });
        }
        let Some(next) = bisected(&surface, lengths, limit) else {
            return match border {
                None => Ok(Refined { surface, envelopes, level, near_pairs }),
                Some(held) => Err(too_close(face, &surface, &envelopes, held, limit)),
            };
        };
        surface = next;
        level += 1;
    }
}

fn too_close(
    face: &Prepared,
    surface: &NurbsSurface,
    envelopes: &Envelopes,
    held: usize,
    limit: usize,
) -> ScaleError {
    let points = surface.net().len();
    if envelopes.held[held].count() == points {
        return ScaleError::HoldCoversFace { face: face.name.clone() };
    }
    ScaleError::FeatureTooCloseToBoundary { face: face.name.clone(), held, needed: GAP, points, limit }
}

/// The net with the longer spans bisected, unless it would exceed the limit.
fn bisected(surface: &NurbsSurface, lengths: [f64; 2], limit: usize) -> Option<NurbsSurface> {
    let middles = [middles(surface.knots_u()), middles(surface.knots_v())];
    let span = |k: usize| lengths[k] / middles[k].len() as f64;
    let longer = [span(0) > BISECT * span(1), span(1) > BISECT * span(0)];
    // A face without extent has no longer direction; it must be bisected all the same, or there is no end.
    let split = if longer[0] || longer[1] { longer } else { [true; 2] };
    let (rows, columns) = surface.shape();
    let more = |k: usize| if split[k] { middles[k].len() } else { 0 };
    let fits = (rows + more(0)).checked_mul(columns + more(1)).is_some_and(|points| points <= limit);
    if !fits {
        return None;
    }
    let inside = "the middle of a span lies in the domain";
    let mut next = surface.clone();
    if split[0] {
        next = next.refined_u(&middles[0]).expect(inside);
    }
    if split[1] {
        next = next.refined_v(&middles[1]).expect(inside);
    }
    Some(next)
}

fn middles(knots: &KnotVector) -> Vec<f64> {
    knots.distinct().0.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
}
