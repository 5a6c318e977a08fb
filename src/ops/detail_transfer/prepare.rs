//! Curves as they come to splines without weights: exactly where there is such a form, else by interpolation.
//!
//! Lines, parabolas, polylines and B-splines, their pieces, and composites of these are exact. Rational splines,
//! circles, ellipses, hyperbolas and offsets are interpolated by cubics, with more and more knots until the
//! tolerance is met at equal parameters, which bounds the distance. Ends are met exactly, kinks of B-splines and
//! joints of composites stay.

use super::error::TransferError;
use super::spline::Spline;
use crate::geometry::nurbs::{GrevilleCollocation, KnotVector, NurbsCurve3};
use crate::geometry::{Composite, Curve};

/// A curve as a spline.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// The spline.
    pub spline: Spline,
    /// Greatest distance of sampled points from the curve; 0 where the form is exact.
    pub deviation: f64,
}

/// Knots closer than this part of the domain are one knot.
const MERGED: f64 = 1e-12;
/// Degree of approximations.
const FIT_DEGREE: usize = 3;
/// Spans of an approximation at most.
const MOST_SPANS: usize = 1 << 14;
/// Points per span at which an approximation is compared with its curve.
const PROBES: usize = 8;

/// The spline of a curve; `name` is for messages, `tolerance` in the units of the curve.
///
/// # Errors
/// [`TransferError::Curve`], [`TransferError::FitTolerance`].
pub fn prepare(curve: &Curve, name: &str, tolerance: f64) -> Result<Prepared, TransferError> {
    let (start, end) = curve.domain();
    if !(end > start && (end - start).is_finite()) {
        return Err(unusable(name, format!("a {} has no ends of its own", curve.kind())));
    }
    over(curve, (start, end), name, tolerance)
}

fn unusable(name: &str, reason: String) -> TransferError {
    TransferError::Curve { curve: name.to_owned(), reason }
}

fn over(curve: &Curve, range: (f64, f64), name: &str, tolerance: f64) -> Result<Prepared, TransferError> {
    if let Curve::Composite(whole) = curve {
        return composite(whole, name, tolerance);
    }
    let exact = curve.to_nurbs(range).ok();
    if let Some(spline) = exact.as_ref().and_then(Spline::of) {
        return Ok(Prepared { spline: merged(spline, name)?, deviation: 0.0 });
    }
    // The exact form of a conic runs otherwise than the conic; a rational spline is its own.
    let breaks = match curve {
        Curve::Nurbs(rational) => kinks(rational, range),
        _ => vec![(range.0, 1), (range.1, 1)],
    };
    interpolated(curve, &breaks, name, tolerance)
}

/// Near knots become one.
fn merged(spline: Spline, name: &str) -> Result<Spline, TransferError> {
    let (start, end) = spline.domain();
    let near = MERGED * (end - start);
    let mut knots: Vec<f64> = Vec::with_capacity(spline.knots.knots().len());
    for &knot in spline.knots.knots() {
        let last = knots.last().copied().unwrap_or(start);
        knots.push(if knot - last <= near {
            last
        } else if end - knot <= near {
            end
        } else {
            knot
        });
    }
    let knots = KnotVector::new(spline.knots.degree(), knots).map_err(|e| unusable(name, e.to_string()))?;
    Ok(Spline { knots, points: spline.points })
}

/// Knots of a rational spline in a range, with the multiplicity that keeps its continuity in a cubic.
fn kinks(curve: &NurbsCurve3, (start, end): (f64, f64)) -> Vec<(f64, usize)> {
    let (values, counts) = curve.knots().distinct();
    let degree = curve.knots().degree();
    let inner = values.into_iter().zip(counts).filter(|(k, _)| start < *k && *k < end);
    let kept = inner.map(|(k, count)| {
        let smooth = degree.saturating_sub(count);
        (k, FIT_DEGREE.saturating_sub(smooth).clamp(1, FIT_DEGREE))
    });
    std::iter::once((start, 1)).chain(kept).chain(std::iter::once((end, 1))).collect()
}

fn interpolated(
    curve: &Curve,
    breaks: &[(f64, usize)],
    name: &str,
    tolerance: f64,
) -> Result<Prepared, TransferError> {
    let mut best = f64::INFINITY;
    let mut pieces = 4;
    while pieces * (breaks.len() - 1) <= MOST_SPANS {
        let knots = fit_knots(breaks, pieces).map_err(|e| unusable(name, e.to_string()))?;
        let collocation = GrevilleCollocation::new(&knots).map_err(|e| unusable(name, e.to_string()))?;
        let mut values: Vec<f64> =
            collocation.abscissae().iter().flat_map(|&t| curve.point_at(t).coords.data.0[0]).collect();
        collocation.solve_rows(&mut values, 3);
        let points = values.as_chunks::<3>().0.to_vec();
        if !points.iter().flatten().all(|c| c.is_finite()) {
            return Err(unusable(name, "it has points that are not finite".to_owned()));
        }
        let spline = Spline { knots, points };
        let deviation = deviation(&spline, curve);
        best = best.min(deviation);
        if deviation <= tolerance {
            return Ok(Prepared { spline, deviation });
        }
        pieces *= 2;
    }
    Err(TransferError::FitTolerance { curve: name.to_owned(), reached: best, tolerance })
}

fn fit_knots(
    breaks: &[(f64, usize)],
    pieces: usize,
) -> Result<KnotVector, crate::geometry::nurbs::KnotVectorError> {
    let (start, end) = (breaks[0].0, breaks[breaks.len() - 1].0);
    let mut knots = vec![start; FIT_DEGREE + 1];
    for pair in breaks.windows(2) {
        let [(low, _), (high, multiplicity)] = [pair[0], pair[1]];
        let inner = (1..pieces).map(|i| low + (high - low) * (i as f64 / pieces as f64));
        knots.extend(inner);
        let count = if high < end { multiplicity } else { FIT_DEGREE + 1 };
        knots.extend(std::iter::repeat_n(high, count));
    }
    KnotVector::new(FIT_DEGREE, knots)
}

/// Greatest distance at equal parameters, between the knots.
fn deviation(spline: &Spline, curve: &Curve) -> f64 {
    let mut worst: f64 = 0.0;
    for span in spline.knots.spans() {
        let (low, high) = (spline.knots.knots()[span], spline.knots.knots()[span + 1]);
        for probe in 0..PROBES {
            let t = low + (high - low) * (probe as f64 + 0.5) / PROBES as f64;
            worst = worst.max((spline.at(t)[0] - curve.point_at(t).coords).norm());
        }
    }
    worst
}

/// Segments end to end, each of them as a spline, raised to one degree; joints are kinks.
fn composite(whole: &Composite<Curve>, name: &str, tolerance: f64) -> Result<Prepared, TransferError> {
    let mut parts = Vec::new();
    let mut deviation: f64 = 0.0;
    for segment in whole.segments() {
        let part = over(&segment.curve, segment.domain, name, tolerance)?;
        deviation = deviation.max(part.deviation);
        parts.push(if segment.forward { part.spline } else { part.spline.reversed() });
    }
    let degree = parts.iter().map(|part| part.knots.degree()).max().unwrap_or(1);
    let (mut knots, mut points) = (Vec::new(), Vec::new());
    for (part, &at) in parts.iter().zip(whole.breaks()) {
        let high = || unusable(name, "its degree is too high".to_owned());
        let part = part.elevated(degree).ok_or_else(high)?;
        let (start, _) = part.domain();
        let shifted = part.knots.knots().iter().map(|k| at + (k - start));
        if knots.is_empty() {
            knots.extend(shifted);
            points.extend(part.points);
        } else {
            // Of the joint's `degree + 1` knots one goes, and of the two equal points one.
            knots.truncate(knots.len() - degree - 1);
            knots.extend(std::iter::repeat_n(at, degree));
            knots.extend(shifted.skip(degree + 1));
            points.extend(part.points.into_iter().skip(1));
        }
    }
    let knots = KnotVector::new(degree, knots).map_err(|e| unusable(name, e.to_string()))?;
    Ok(Prepared { spline: merged(Spline { knots, points }, name)?, deviation })
}
