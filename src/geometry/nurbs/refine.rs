//! Knot insertion (Boehm), and clamping and pieces by it. Geometry does not change.
//!
//! Works on flat rows: a curve is a list of rows of `H` numbers, a surface along `u` a list of rows of
//! `4 nv` numbers, so that curves and both directions of a surface share the algorithm.

use super::{KnotVector, KnotVectorError, NurbsCurve, NurbsSurface};

/// Inserts knots into rows of `width` numbers; `more` must have passed [`KnotVector::with_inserted`].
pub(super) fn insert_rows(knots: &KnotVector, rows: &[f64], width: usize, more: &[f64]) -> Vec<f64> {
    let p = knots.degree();
    let mut knots = knots.knots().to_vec();
    let mut rows = rows.to_vec();
    let mut sorted = more.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut fresh = vec![0.0; p * width];
    for x in sorted {
        // The NURBS Book 5.15: rows `k - p + 1 ..= k` become `p` mixtures of neighbours.
        let k = knots.partition_point(|&knot| knot <= x) - 1;
        let n = rows.len() / width;
        let first = k + 1 - p;
        let last = k.min(n);
        for i in first..=last {
            let alpha = ratio(x, knots[i], knots[i + p]);
            for c in 0..width {
                let before = rows[(i - 1) * width + c];
                let here = if i < n { rows[i * width + c] } else { 0.0 };
                fresh[(i - first) * width + c] = (1.0 - alpha) * before + alpha * here;
            }
        }
        let count = last + 1 - first;
        rows.splice(first * width..last * width, fresh[..count * width].iter().copied());
        knots.insert(k + 1, x);
    }
    rows
}

/// `(x - low) / (high - low)`; exactly 0 at `low` and for an empty interval.
fn ratio(x: f64, low: f64, high: f64) -> f64 {
    if high > low { (x - low) / (high - low) } else { 0.0 }
}

/// Knots to insert, so that both ends of the domain occur `p` times.
fn clamping_knots(knots: &KnotVector) -> Vec<f64> {
    let (start, end) = knots.domain();
    let lacking = |x: f64| knots.degree().saturating_sub(knots.multiplicity(x));
    let mut more = vec![start; lacking(start)];
    more.extend(std::iter::repeat_n(end, lacking(end)));
    more
}

/// Clamped knots and rows of the same geometry over the same domain.
fn clamp_rows(knots: &KnotVector, rows: &[f64], width: usize) -> (KnotVector, Vec<f64>) {
    let p = knots.degree();
    let (start, end) = knots.domain();
    let more = clamping_knots(knots);
    let rows = insert_rows(knots, rows, width, &more);
    let mut all = knots.knots().to_vec();
    all.extend(more);
    all.sort_by(f64::total_cmp);
    let first = all.partition_point(|&k| k <= start) - 1 - p;
    let last = all.partition_point(|&k| k < end);
    let mut clamped = vec![start; p + 1];
    clamped.extend_from_slice(&all[first + p + 1..last]);
    clamped.extend(std::iter::repeat_n(end, p + 1));
    let clamped = KnotVector::new(p, clamped).expect("interior knots were valid before");
    (clamped, rows[first * width..last * width].to_vec())
}

/// Clamped knots and rows of the same geometry over a part of the domain.
fn piece_rows(
    knots: &KnotVector,
    rows: &[f64],
    width: usize,
    (start, end): (f64, f64),
) -> Result<(KnotVector, Vec<f64>), KnotVectorError> {
    let (start, end) = (knots.snapped(start), knots.snapped(end));
    if start.is_nan() || end.is_nan() || start >= end {
        return Err(KnotVectorError::EmptyDomain);
    }
    let p = knots.degree();
    let lacking = |x: f64| p.saturating_sub(knots.multiplicity(x));
    let mut more = vec![start; lacking(start)];
    more.extend(std::iter::repeat_n(end, lacking(end)));
    let refined = knots.with_inserted(&more)?;
    let rows = insert_rows(knots, rows, width, &more);
    let all = refined.knots();
    let first = all.partition_point(|&k| k <= start) - 1 - p;
    let last = all.partition_point(|&k| k < end);
    let mut cut = vec![start; p + 1];
    cut.extend_from_slice(&all[first + p + 1..last]);
    cut.extend(std::iter::repeat_n(end, p + 1));
    Ok((KnotVector::new(p, cut)?, rows[first * width..last * width].to_vec()))
}

/// Flat numbers back to points.
pub(super) fn to_points<const H: usize>(flat: &[f64]) -> Vec<[f64; H]> {
    flat.as_chunks::<H>().0.to_vec()
}

/// Rows become columns: `rows x columns` points to `columns x rows`.
pub(super) fn transposed(net: &[[f64; 4]], rows: usize, columns: usize) -> Vec<[f64; 4]> {
    let mut out = Vec::with_capacity(net.len());
    for j in 0..columns {
        out.extend((0..rows).map(|i| net[i * columns + j]));
    }
    out
}

impl<const H: usize> NurbsCurve<H> {
    /// The same curve with further knots.
    ///
    /// # Errors
    /// See [`KnotVector::with_inserted`].
    pub fn refined(&self, more: &[f64]) -> Result<Self, KnotVectorError> {
        let knots = self.knots().with_inserted(more)?;
        let rows = insert_rows(self.knots(), self.points().as_flattened(), H, more);
        Ok(Self::from_valid(knots, to_points(&rows)))
    }

    /// The same curve with ends that are control points.
    #[must_use]
    pub fn clamped(&self) -> Self {
        if self.knots().is_clamped() {
            return self.clone();
        }
        let (knots, rows) = clamp_rows(self.knots(), self.points().as_flattened(), H);
        Self::from_valid(knots, to_points(&rows))
    }

    /// The piece of the curve over `[start, end]`, clamped. An end within 1e-10 of the range from a knot is that knot.
    ///
    /// # Errors
    /// As [`KnotVector::with_inserted`]; [`KnotVectorError::EmptyDomain`] when `start >= end`.
    pub fn piece(&self, start: f64, end: f64) -> Result<Self, KnotVectorError> {
        let (knots, rows) = piece_rows(self.knots(), self.points().as_flattened(), H, (start, end))?;
        Ok(Self::from_valid(knots, to_points(&rows)))
    }
}

impl NurbsSurface {
    /// The same surface with further knots along `u`.
    ///
    /// # Errors
    /// See [`KnotVector::with_inserted`].
    pub fn refined_u(&self, more: &[f64]) -> Result<Self, KnotVectorError> {
        let knots = self.knots_u().with_inserted(more)?;
        let width = 4 * self.shape().1;
        let rows = insert_rows(self.knots_u(), self.net().as_flattened(), width, more);
        Ok(Self::from_valid(knots, self.knots_v().clone(), to_points(&rows)))
    }

    /// The same surface with further knots along `v`.
    ///
    /// # Errors
    /// See [`KnotVector::with_inserted`].
    pub fn refined_v(&self, more: &[f64]) -> Result<Self, KnotVectorError> {
        Ok(self.swapped().refined_u(more)?.swapped())
    }

    /// The part of the surface over a rectangle of parameters, clamped: the same points at the same parameters. A side
    /// within 1e-10 of the range from a knot is that knot.
    ///
    /// # Errors
    /// As [`KnotVector::with_inserted`]; [`KnotVectorError::EmptyDomain`] for a rectangle without area.
    pub fn piece(&self, u: (f64, f64), v: (f64, f64)) -> Result<Self, KnotVectorError> {
        Ok(self.piece_u(u)?.swapped().piece_u(v)?.swapped())
    }

    fn piece_u(&self, u: (f64, f64)) -> Result<Self, KnotVectorError> {
        let width = 4 * self.shape().1;
        let (knots, rows) = piece_rows(self.knots_u(), self.net().as_flattened(), width, u)?;
        Ok(Self::from_valid(knots, self.knots_v().clone(), to_points(&rows)))
    }

    /// The same surface with no span longer than `1 / n` of the domain: each longer one is cut into equal parts.
    ///
    /// # Errors
    /// [`KnotVectorError::EmptyDomain`] for a count of 0; others when spans are too short to be cut.
    pub fn with_spans(&self, n_u: usize, n_v: usize) -> Result<Self, KnotVectorError> {
        self.refined_u(&self.knots_u().cuts(n_u)?)?.refined_v(&self.knots_v().cuts(n_v)?)
    }

    /// The same surface with clamped knots in both directions.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let mut surface = self.clone();
        for _ in 0..2 {
            if !surface.knots_u().is_clamped() {
                let width = 4 * surface.shape().1;
                let (knots, rows) = clamp_rows(surface.knots_u(), surface.net().as_flattened(), width);
                surface = Self::from_valid(knots, surface.knots_v().clone(), to_points(&rows));
            }
            surface = surface.swapped();
        }
        surface
    }
}
