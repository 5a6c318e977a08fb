//! The transfer between two splines.

use super::embed::{embedded, sum};
use super::error::TransferError;
use super::frames::{across, frames, least_aligned};
use super::settings::{Existing, Frame, LevelChoice, Scale, Settings, TargetBase};
use super::spline::Spline;
use crate::geometry::bspline_wavelet::{Decomposition, WaveletError, coarsened, decompose};
use crate::math::{Matrix3, Vector3, minimal_rotation};

/// A target with the detail of a source.
#[derive(Debug, Clone)]
pub struct Transferred {
    /// The new curve, over the target's domain.
    pub curve: Spline,
    /// What was added, over the same domain.
    pub detail: Spline,
    /// The coarse target that frames and lengths are taken from.
    pub target_base: Spline,
    /// Levels that the source has.
    pub levels_available: usize,
    /// Levels that were carried over, counted from the finest, 1.
    pub levels: Vec<usize>,
    /// Factor on the detail.
    pub scale: f64,
}

/// The detail of a source, split once for any number of targets.
#[derive(Debug, Clone)]
pub struct SourceDetail {
    /// The source as it is run.
    spline: Spline,
    split: Decomposition<3>,
    base: Spline,
    /// Length of the base.
    length: f64,
    levels_available: usize,
    gains: Vec<f64>,
}

impl SourceDetail {
    /// Splits a source into its base and the levels that the settings choose.
    ///
    /// # Errors
    /// [`TransferError`]; the curve is named `source`.
    pub fn of(source: &Spline, settings: &Settings) -> Result<Self, TransferError> {
        let spline = if settings.reverse { source.reversed() } else { source.clone() };
        let mut split = decomposed(&spline, usize::MAX, settings.ends, "source")?;
        let levels_available = split.levels.len();
        if levels_available == 0 {
            return Err(no_levels(&spline));
        }
        let gains = gains(settings, levels_available)?;
        if gains.len() < levels_available {
            split = decomposed(&spline, gains.len(), settings.ends, "source")?;
        }
        let base = Spline { knots: split.base_knots.clone(), points: split.base.clone() };
        let length = base.length(base.domain().0, base.domain().1);
        let needs_length = settings.frame == Frame::Local || settings.scale == Scale::ArcLength;
        if needs_length && length <= no_length(&spline) {
            return Err(TransferError::DegenerateBase { curve: "source", at: spline.domain().0 });
        }
        Ok(Self { spline, split, base, length, levels_available, gains })
    }
}

/// Adds chosen levels of the source's detail to the target.
///
/// With gains of 0 the target stays; the result is linear in every gain.
///
/// # Errors
/// [`TransferError`]; curves are named `source` and `target`.
pub fn transfer(target: &Spline, source: &Spline, settings: &Settings) -> Result<Transferred, TransferError> {
    // What is wrong with the interval is told before the source is looked at.
    checked_interval(target, settings)?;
    transfer_split(target, &SourceDetail::of(source, settings)?, settings)
}

/// [`transfer`] with a source that was split under the same settings, but for the normals.
///
/// # Errors
/// [`TransferError`]; curves are named `source` and `target`.
pub fn transfer_split(
    target: &Spline,
    source: &SourceDetail,
    settings: &Settings,
) -> Result<Transferred, TransferError> {
    let domain = target.domain();
    let interval = checked_interval(target, settings)?;
    let spans = source.base.span_count();
    let target_base = match settings.target_base {
        TargetBase::Coarse => coarse_target(target, interval, spans, settings.ends)?,
        TargetBase::AsItIs => target.clone(),
    };
    let scale = match settings.scale {
        Scale::Factor(factor) => factor,
        Scale::ArcLength => target_base.length(interval.0, interval.1) / source.length,
    };
    let scaled: Vec<f64> = source.gains.iter().map(|gain| gain * scale).collect();
    let points = if settings.frame == Frame::Local {
        let turned = turned(source, &target_base, interval, settings)?;
        source.split.detail_of(&turned, &scaled)
    } else {
        source.split.detail(&scaled)
    };
    let mut detail = Spline { knots: source.spline.knots.clone(), points };
    hold_ends(&mut detail, settings.ends);
    let mut detail = embedded(&detail, interval, domain, settings.ends)?;
    if settings.existing == Existing::Replace
        && let Some(own) = own_detail(target, interval, spans, settings.ends)?
    {
        detail = sum(&detail, &own)?;
    }
    let curve = sum(target, &detail)?;
    let gains = source.gains.iter().enumerate();
    let levels = gains.filter(|(_, gain)| **gain != 0.0).map(|(at, _)| at + 1).collect();
    let levels_available = source.levels_available;
    Ok(Transferred { curve, detail, target_base, levels_available, levels, scale })
}

fn no_levels(source: &Spline) -> TransferError {
    let (controls, degree) = (source.points.len(), source.knots.degree());
    TransferError::NoLevels { curve: "source".to_owned(), controls, degree }
}

/// Length of a coarse curve, against its control polygon, at which it has none.
const SHORT: f64 = 1e-9;
/// The same against its coordinates, whose rounding has a length too.
const ROUNDING: f64 = 1e-12;

fn no_length(curve: &Spline) -> f64 {
    let steps = curve.points.windows(2).map(|pair| (Vector3::from(pair[1]) - Vector3::from(pair[0])).norm());
    let greatest = curve.points.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
    SHORT * steps.sum::<f64>() + ROUNDING * greatest
}

/// The interval, whole when none is given.
fn checked_interval(target: &Spline, settings: &Settings) -> Result<(f64, f64), TransferError> {
    let (start, end) = target.domain();
    let (a, b) = settings.interval.unwrap_or((start, end));
    if !(start <= a && a < b && b <= end) {
        return Err(TransferError::BadInterval { start: a, end: b });
    }
    if settings.ends == 0 && (a > start || b < end) {
        return Err(TransferError::PartialNeedsEnds);
    }
    if settings.ends == 0 && target.is_closed() {
        return Err(TransferError::OpensSeam);
    }
    Ok((a, b))
}

fn decomposed(
    curve: &Spline,
    depth: usize,
    ends: usize,
    name: &'static str,
) -> Result<Decomposition<3>, TransferError> {
    decompose(&curve.knots, &curve.points, depth, ends).map_err(|error| wavelets(name, error))
}

fn wavelets(name: &str, error: WaveletError) -> TransferError {
    TransferError::Wavelets { curve: name.to_owned(), error }
}

/// A gain for each level up to the coarsest chosen one, finest first.
fn gains(settings: &Settings, available: usize) -> Result<Vec<f64>, TransferError> {
    let chosen: Vec<usize> = match &settings.levels {
        LevelChoice::All => (1..=available).collect(),
        LevelChoice::Finest(count) => (1..=available.min(*count)).collect(),
        LevelChoice::These(levels) => levels.clone(),
    };
    if let Some(&level) = chosen.iter().find(|&&level| level == 0 || level > available) {
        return Err(TransferError::NoSuchLevel { level, available });
    }
    let gains = match settings.gains.as_slice() {
        [one] => vec![*one; chosen.len()],
        gains => gains.to_vec(),
    };
    if gains.len() != chosen.len() {
        return Err(TransferError::GainCount { gains: gains.len(), levels: chosen.len() });
    }
    let mut all = vec![0.0; chosen.iter().copied().max().unwrap_or(0)];
    for (level, gain) in chosen.into_iter().zip(gains) {
        all[level - 1] = gain;
    }
    Ok(all)
}

/// How often a curve is split until it has no more spans than asked for, on the given part of it.
fn comparable_depth(curve: &Spline, part: f64, spans: usize, ends: usize) -> Result<usize, TransferError> {
    let (mut knots, mut depth) = (curve.knots.clone(), 0);
    while knots.spans().count() as f64 * part > spans as f64 {
        let Some(coarse) = coarsened(&knots, ends).map_err(|error| wavelets("target", error))? else { break };
        knots = coarse.knots;
        depth += 1;
    }
    Ok(depth)
}

/// The target as coarse as the base of the source, so that its frames do not follow its own detail.
fn coarse_target(
    target: &Spline,
    (a, b): (f64, f64),
    spans: usize,
    ends: usize,
) -> Result<Spline, TransferError> {
    let (start, end) = target.domain();
    // A target of low degree may have a lower order at its ends.
    let ends = ends.min(target.knots.degree());
    let depth = comparable_depth(target, (b - a) / (end - start), spans, ends)?;
    let split = decomposed(target, depth, ends, "target")?;
    Ok(Spline { knots: split.base_knots, points: split.base })
}

/// The target's own detail over the interval, with the opposite sign; `None` when it has none.
fn own_detail(
    target: &Spline,
    (a, b): (f64, f64),
    spans: usize,
    ends: usize,
) -> Result<Option<Spline>, TransferError> {
    let bad = || TransferError::BadInterval { start: a, end: b };
    let piece = target.to_nurbs().ok_or(TransferError::NotFinite)?.piece(a, b).map_err(|_| bad())?;
    let piece = Spline::of(&piece).ok_or_else(bad)?;
    let piece = piece.elevated(ends.max(1)).ok_or_else(bad)?;
    let depth = comparable_depth(&piece, 1.0, spans, ends)?;
    if depth == 0 {
        return Ok(None);
    }
    let split = decomposed(&piece, depth, ends, "target")?;
    let mut own = Spline { knots: piece.knots.clone(), points: split.detail(&vec![-1.0; depth]) };
    hold_ends(&mut own, ends);
    embedded(&own, (a, b), target.domain(), ends).map(Some)
}

/// Detail at held ends is zero; what the lift leaves there is rounding.
fn hold_ends(detail: &mut Spline, ends: usize) {
    let n = detail.points.len();
    for at in (0..ends.min(n)).chain(n.saturating_sub(ends)..n) {
        detail.points[at] = [0.0; 3];
    }
}

/// Each wavelet's coefficients, turned from the frame of the source to that of the target.
fn turned(
    source: &SourceDetail,
    target: &Spline,
    (a, b): (f64, f64),
    settings: &Settings,
) -> Result<Vec<Vec<[f64; 3]>>, TransferError> {
    let (split, base) = (&source.split, &source.base);
    let (start, end) = base.domain();
    let centres: Vec<Vec<f64>> = split.levels.iter().map(|level| level.centres()).collect();
    let mut at: Vec<f64> = std::iter::once(start).chain(centres.iter().flatten().copied()).collect();
    at.sort_by(f64::total_cmp);
    at.dedup();
    let on_target: Vec<f64> =
        at.iter().map(|x| (a + (x - start) * ((b - a) / (end - start))).clamp(a, b)).collect();
    let lost = |curve: &'static str| move |at: f64| TransferError::DegenerateBase { curve, at };
    let [n_source, n_target] = start_normals(base, start, target, a, settings)?;
    let from = frames(base, &at, &n_source).map_err(lost("source"))?;
    let to = frames(target, &on_target, &n_target).map_err(lost("target"))?;
    let turns: Vec<Matrix3<f64>> = from.iter().zip(&to).map(|(from, to)| to * from.transpose()).collect();
    let turn = |(row, centre): (&[f64; 3], &f64)| {
        let index = at.partition_point(|x| x < centre).min(turns.len() - 1);
        (turns[index] * Vector3::from(*row)).into()
    };
    let rows = split.details.iter().zip(&centres);
    Ok(rows.map(|(rows, centres)| rows.iter().zip(centres).map(turn).collect()).collect())
}

/// Normals at the start of both curves, that of the target turned by the roll.
fn start_normals(
    source: &Spline,
    start: f64,
    target: &Spline,
    a: f64,
    settings: &Settings,
) -> Result<[Vector3<f64>; 2], TransferError> {
    let direction = |curve: &Spline, at: f64, name: &'static str| {
        let lost = TransferError::DegenerateBase { curve: name, at };
        curve.at(at)[1].try_normalize(0.0).ok_or(lost)
    };
    let (ts, tt) = (direction(source, start, "source")?, direction(target, a, "target")?);
    let [from, to] = settings.normals;
    let lost = |curve, at| TransferError::DegenerateBase { curve, at };
    let n_source = from.and_then(|n| across(&n, &ts)).or_else(|| across(&least_aligned(&ts), &ts));
    let n_source = n_source.ok_or(lost("source", start))?;
    let turned = || {
        // Opposite tangents: half a turn about the binormal keeps the plane of the curve.
        let fallback = ts.cross(&n_source);
        minimal_rotation(&ts, &tt, &fallback) * n_source
    };
    let n_target = to.and_then(|n| across(&n, &tt)).or_else(|| across(&turned(), &tt));
    let n_target = n_target.ok_or(lost("target", a))?;
    let (sin, cos) = settings.roll.sin_cos();
    Ok([n_source, n_target * cos + tt.cross(&n_target) * sin])
}
