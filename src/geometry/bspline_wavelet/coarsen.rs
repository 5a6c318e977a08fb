//! Which knots go from one level to the next.

use super::WaveletError;
use crate::geometry::nurbs::KnotVector;

/// Knots of the next coarser level.
#[derive(Debug, Clone, PartialEq)]
pub struct Coarsened {
    /// What stays.
    pub knots: KnotVector,
    /// What went, ascending.
    pub removed: Vec<f64>,
}

/// Removes the first, third, fifth … interior knot; `None` when nothing can go, or too few control points would
/// stay.
///
/// Kept are corners, which are knots of multiplicity `degree` and more (from degree 2 on), after which the
/// counting starts anew, and the `ends - 1` knots next to each end, so that the first and last `ends` control
/// points mean the same on both levels. On knots `i / 2^j` with `ends` of 0 or 1 this is the dyadic hierarchy.
///
/// # Errors
/// [`WaveletError::NotClamped`], [`WaveletError::Torn`], [`WaveletError::EndOrder`].
pub fn coarsened(knots: &KnotVector, ends: usize) -> Result<Option<Coarsened>, WaveletError> {
    check(knots, ends)?;
    let (p, n) = (knots.degree(), knots.n_basis());
    let inner = &knots.knots()[p + 1..n];
    let guard = ends.saturating_sub(1);
    let (mut kept, mut removed) = (knots.knots()[..=p].to_vec(), Vec::new());
    let (mut index, mut counter) = (0, 0);
    for same in inner.chunk_by(|a, b| a == b) {
        for &knot in same {
            if index < guard || index + guard >= inner.len() {
                kept.push(knot);
            } else if p >= 2 && same.len() >= p {
                kept.push(knot);
                counter = 0;
            } else {
                let list = if counter % 2 == 0 { &mut removed } else { &mut kept };
                list.push(knot);
                counter += 1;
            }
            index += 1;
        }
    }
    kept.extend_from_slice(&knots.knots()[n..]);
    let few = kept.len() - p - 1 < (2 * ends).max(p + 1);
    if removed.is_empty() || few {
        return Ok(None);
    }
    let knots = KnotVector::new(p, kept).expect("knots that were valid stay so when some go");
    Ok(Some(Coarsened { knots, removed }))
}

fn check(knots: &KnotVector, ends: usize) -> Result<(), WaveletError> {
    let (p, n) = (knots.degree(), knots.n_basis());
    if !knots.is_clamped() {
        return Err(WaveletError::NotClamped);
    }
    if ends > p {
        return Err(WaveletError::EndOrder { ends, degree: p });
    }
    // A knot at an end beyond the clamped ones tears as well: the curve would jump there.
    let (start, end) = knots.domain();
    let inner = knots.knots()[p + 1..n].chunk_by(|a, b| a == b);
    for same in inner {
        if same.len() > p || same[0] <= start || same[0] >= end {
            return Err(WaveletError::Torn { knot: same[0], multiplicity: same.len(), degree: p });
        }
    }
    Ok(())
}
