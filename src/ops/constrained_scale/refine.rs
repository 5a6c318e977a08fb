//! Bisection of all spans until held loops, border and each other lie far enough apart in control points; where that
//! would cost too many, of those spans alone that lie between them.
//!
//! Geometry is never changed, only the net.

use super::ScaleError;
use super::envelope::{Envelopes, GAP, Prepared};
use super::sampling::mean_lengths;
use super::scaling::Scaling;
use super::strips::Strips;
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

/// Control points up to which all spans are bisected before strips are looked for.
const MODERATE: usize = 10_000;
/// A direction is bisected when its spans are longer than this part of the other direction's.
const BISECT: f64 = 0.6;
/// Points in each direction at which span lengths are measured.
const LENGTH_SAMPLES: usize = 17;

/// Refines the net of a face until the gaps are wide enough and `least_level` is reached, or the next net would
/// exceed the limit. `group` tells for each held loop which loops move with it: those may be near.
///
/// All spans are bisected, as published, while the net stays of moderate size. Where a loop is then still too near to the
/// outline of a face within its surface, spans are bisected only in the strips between them. Where that does not make room within the limit, because
/// the knots are uneven, only the longer spans are bisected.
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
    let points = face.surface.net().len();
    if points > limit {
        return Err(ScaleError::NetTooLarge { face: face.name.clone(), points, limit });
    }
    // Refinement changes no geometry, so one measurement serves all levels.
    let lengths = mean_lengths(&face.surface, LENGTH_SAMPLES);
    let moderate = limit.min(MODERATE);
    let all = |limit: usize| move |surface: &NurbsSurface, _: usize| bisected(surface, lengths, limit);
    let refined = run(face, group, least_level, scaling, all(moderate));
    match refined {
        Err(ScaleError::FeatureTooCloseToBoundary { .. }) => {}
        Ok(refined) if !refined.near_pairs.is_empty() => {
            return run(face, group, least_level, scaling, all(limit));
        }
        done => return done,
    }
    let rows = scaling.continuity.rows();
    let strips = Strips { face, group, lengths, limit };
    let (mut start, mut level) = (face.surface.clone(), 0);
    while level < least_level
        && let Some(finer) = bisected(&start, lengths, moderate)
    {
        (start, level) = (finer, level + 1);
    }
    let surface = strips.refined(&start);
    let envelopes = Envelopes::new(face, &surface, rows);
    if envelopes.near_border().is_none() {
        let near_pairs = envelopes.near_pairs(group);
        return Ok(Refined { surface, envelopes, level, near_pairs });
    }
    let longer = |_: &NurbsSurface, level: usize| evened(&face.surface, lengths, level, limit);
    run(face, group, least_level, scaling, longer)
}

/// Takes one net after the other from `next`, which gets the present net and the next level.
fn run(
    face: &Prepared,
    group: &[usize],
    least_level: usize,
    scaling: &Scaling,
    next: impl Fn(&NurbsSurface, usize) -> Option<NurbsSurface>,
) -> Result<Refined, ScaleError> {
    let mut surface = face.surface.clone();
    let mut level = 0;
    loop {
        let envelopes = Envelopes::new(face, &surface, scaling.continuity.rows());
        let border = envelopes.near_border();
        let near_pairs = envelopes.near_pairs(group);
        if level >= least_level && border.is_none() && near_pairs.is_empty() {
            return Ok(Refined { surface, envelopes, level, near_pairs });
        }
        let Some(finer) = next(&surface, level + 1) else {
            return match border {
                None => Ok(Refined { surface, envelopes, level, near_pairs }),
                Some(held) => Err(too_close(face, &surface, &envelopes, held, scaling.max_control_points)),
            };
        };
        surface = finer;
        level += 1;
    }
}

/// The net with every span halved until it is at most as long as the longest span after `level` bisections, unless
/// it would exceed the limit.
fn evened(surface: &NurbsSurface, lengths: [f64; 2], level: usize, limit: usize) -> Option<NurbsSurface> {
    let knots = [surface.knots_u(), surface.knots_v()];
    let spans = [0, 1].map(|k| {
        let distinct = knots[k].distinct().0;
        let (start, end) = knots[k].domain();
        let per_parameter = lengths[k] / (end - start);
        distinct.windows(2).map(|w| ((w[0], w[1]), (w[1] - w[0]) * per_parameter)).collect::<Vec<_>>()
    });
    let longest = spans.iter().flatten().map(|s| s.1).fold(0.0, f64::max);
    let target = longest * 0.5_f64.powi(i32::try_from(level).ok()?);
    let mut more = [Vec::new(), Vec::new()];
    for (more, spans) in more.iter_mut().zip(&spans) {
        for ((start, end), length) in spans {
            let halvings = (length / target).log2().ceil().max(0.0);
            let pieces = 2.0_f64.powf(halvings);
            if pieces.is_nan() || pieces > limit as f64 {
                return None;
            }
            let count = pieces as usize;
            more.extend((1..count).map(|k| start + (end - start) * (k as f64 / pieces)));
        }
    }
    let (rows, columns) = surface.shape();
    let points = (rows + more[0].len()).checked_mul(columns + more[1].len())?;
    if points > limit || (more[0].is_empty() && more[1].is_empty()) {
        return None;
    }
    let inside = "an inner point of a span lies in the domain";
    let along = surface.refined_u(&more[0]).expect(inside);
    Some(along.refined_v(&more[1]).expect(inside))
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
