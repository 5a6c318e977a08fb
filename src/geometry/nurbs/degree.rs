//! Degree elevation. Geometry does not change; every knot's multiplicity rises with the degree.
//!
//! Each new control point is a mean of blossom values (The NURBS Book 5.36 in polar form). The blossom is
//! taken from the polynomial of the longest span under the new function, for which the values are bounded
//! by the old control points times a constant of the degree alone, however uneven the knots are.

use super::refine::to_points;
use super::{KnotVector, KnotVectorError, NurbsCurve, NurbsSurface};

/// Raises rows of `width` numbers by one degree.
fn elevate_rows(
    knots: &KnotVector,
    rows: &[f64],
    width: usize,
) -> Result<(KnotVector, Vec<f64>), KnotVectorError> {
    let raised = knots.elevated(1)?;
    let p = knots.degree();
    let mut out = vec![0.0; raised.n_basis() * width];
    let mut pyramid = vec![0.0; (p + 1) * width];
    let mut arguments = vec![0.0; p];
    for (j, target) in out.chunks_exact_mut(width).enumerate() {
        let under = &raised.knots()[j + 1..=j + p + 1];
        let span = span_under(knots, raised.knots()[j], under);
        // Omitting one of several equal knots gives the same value: count it once with its multiplicity.
        let mut omitted = 0;
        for group in under.chunk_by(|a, b| a == b) {
            arguments[..omitted].copy_from_slice(&under[..omitted]);
            arguments[omitted..].copy_from_slice(&under[omitted + 1..]);
            let active = &rows[(span - p) * width..(span + 1) * width];
            blossom(knots, active, width, span, &arguments, &mut pyramid);
            let share = group.len() as f64 / (p + 1) as f64;
            for (sum, value) in target.iter_mut().zip(&pyramid[p * width..]) {
                *sum += share * value;
            }
            omitted += group.len();
        }
    }
    Ok((raised, out))
}

/// The span of the old knots whose polynomial defines a new control point over the knots `under`.
fn span_under(knots: &KnotVector, before: f64, under: &[f64]) -> usize {
    let all = knots.knots();
    let (low, high) = (under[0], under[under.len() - 1]);
    if low < high {
        let first = all.partition_point(|&k| k < low);
        let last = all.partition_point(|&k| k <= high) - 1;
        let middle = 0.5 * (low + high);
        let width = |k: usize| all[k + 1] - all[k];
        let off = |k: usize| (0.5 * (all[k] + all[k + 1]) - middle).abs();
        let best = (first.max(knots.degree())..last.min(knots.n_basis())).filter(|&k| width(k) > 0.0).reduce(
            |a, b| {
                let wider = width(b) > width(a) * EQUAL_SPANS;
                let as_wide = width(b) * EQUAL_SPANS > width(a);
                if wider || (as_wide && off(b) < off(a)) { b } else { a }
            },
        );
        return best.unwrap_or_else(|| knots.span(middle));
    }
    // All equal: the value at a knot, from the left when the new function ends the piece to its left.
    let left = all.partition_point(|&k| k < low);
    if before < low && left > knots.degree() { left - 1 } else { knots.span(low) }
}

/// Spans whose lengths differ by less than this factor count as equal: then the middle one is taken.
const EQUAL_SPANS: f64 = 1.0 + 1e-6;

/// The polar form of a span's polynomial at `p` arguments, into the last row of `pyramid` (de Boor). `active` are the
/// `p + 1` rows that act on the span.
pub(super) fn blossom(
    knots: &KnotVector,
    active: &[f64],
    width: usize,
    span: usize,
    at: &[f64],
    pyramid: &mut [f64],
) {
    let p = knots.degree();
    let all = knots.knots();
    pyramid.copy_from_slice(active);
    for (r, &x) in (1..=p).zip(at) {
        for i in (r..=p).rev() {
            let (low, high) = (all[span - p + i], all[span + 1 + i - r]);
            let alpha = (x - low) / (high - low);
            for c in 0..width {
                let before = pyramid[(i - 1) * width + c];
                let value = &mut pyramid[i * width + c];
                *value = (1.0 - alpha) * before + alpha * *value;
            }
        }
    }
}

/// Raises rows to a degree; a degree at or below the present one leaves them.
fn elevate_to(
    knots: &KnotVector,
    rows: &[f64],
    width: usize,
    degree: usize,
) -> Result<(KnotVector, Vec<f64>), KnotVectorError> {
    if degree > KnotVector::MAX_DEGREE {
        return Err(KnotVectorError::Degree { degree });
    }
    let mut state = (knots.clone(), rows.to_vec());
    while state.0.degree() < degree {
        state = elevate_rows(&state.0, &state.1, width)?;
    }
    Ok(state)
}

impl<const H: usize> NurbsCurve<H> {
    /// The same curve with at least the given degree; clamped first when it has to be raised.
    ///
    /// # Errors
    /// [`KnotVectorError::Degree`] above [`KnotVector::MAX_DEGREE`].
    pub fn elevated(&self, degree: usize) -> Result<Self, KnotVectorError> {
        if degree <= self.knots().degree() {
            return Ok(self.clone());
        }
        let clamped = self.clamped();
        let (knots, rows) = elevate_to(clamped.knots(), clamped.points().as_flattened(), H, degree)?;
        Ok(Self::from_valid(knots, to_points(&rows)))
    }
}

impl NurbsSurface {
    /// The same surface with at least the given degrees; clamped first when one has to be raised.
    ///
    /// # Errors
    /// [`KnotVectorError::Degree`] above [`KnotVector::MAX_DEGREE`].
    pub fn elevated(&self, degree_u: usize, degree_v: usize) -> Result<Self, KnotVectorError> {
        let mut surface = self.clone();
        for degree in [degree_u, degree_v] {
            if degree > surface.knots_u().degree() {
                surface = surface.clamped();
                let width = 4 * surface.shape().1;
                let (knots, rows) =
                    elevate_to(surface.knots_u(), surface.net().as_flattened(), width, degree)?;
                surface = Self::from_valid(knots, surface.knots_v().clone(), to_points(&rows));
            }
            surface = surface.swapped();
        }
        Ok(surface)
    }
}
