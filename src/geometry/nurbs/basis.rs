//! B-spline basis functions and their derivatives, without allocation.
//!
//! After A2.2 of The NURBS Book; derivatives up to the second by differences of the bases of lower degree,
//! which the recurrence passes through anyway, instead of the full table of A2.3.

use super::KnotVector;

/// Room for the functions of one span, of any degree.
const ROOM: usize = KnotVector::MAX_DEGREE + 1;

/// The `p + 1` basis functions that do not vanish at a parameter, with derivatives up to the second, in room for
/// `N` functions: filling and moving the room for the greatest degree takes longer than a cubic's basis.
#[derive(Debug, Clone)]
pub struct LocalBasis<const N: usize = ROOM> {
    /// Span, see [`KnotVector::span`].
    pub span: usize,
    degree: usize,
    rows: [[f64; N]; 3],
}

impl<const N: usize> LocalBasis<N> {
    /// Index of the first function.
    #[must_use]
    pub fn first(&self) -> usize {
        self.span - self.degree
    }

    /// Values of the functions.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.rows[0][..=self.degree]
    }

    /// Derivatives of the given order, 0 to 2; zeros above the order that was asked for.
    ///
    /// # Panics
    /// For an order above 2.
    #[must_use]
    pub fn derivatives(&self, order: usize) -> &[f64] {
        &self.rows[order][..=self.degree]
    }
}

impl KnotVector {
    /// Values at `u` of the functions `span - p ..= span` into the first `p + 1` of `out`; gives the span.
    ///
    /// Outside the domain the polynomial of the nearest span goes on.
    ///
    /// # Panics
    /// When `out` is shorter than `p + 1`.
    pub fn basis(&self, u: f64, out: &mut [f64]) -> usize {
        let span = self.span(u);
        let out = &mut out[..=self.degree()];
        out[0] = 1.0;
        for j in 1..=self.degree() {
            self.raise(span, u, j, out);
        }
        span
    }

    /// Functions at `u` with derivatives up to `order`, at most 2.
    #[inline]
    #[must_use]
    pub fn basis_derivatives(&self, u: f64, order: usize) -> LocalBasis {
        self.basis_of_span(self.span(u), u, order)
    }

    /// As [`basis_derivatives`](Self::basis_derivatives), by the polynomials of a given span: at a knot it
    /// tells the derivative from the left from the one from the right.
    ///
    /// # Panics
    /// When the span is not one of `p ..= n - 1`.
    #[inline]
    #[must_use]
    pub fn basis_of_span(&self, span: usize, u: f64, order: usize) -> LocalBasis {
        self.basis_within(span, u, order)
    }

    /// As [`basis_derivatives`](Self::basis_derivatives), in room for `N` functions.
    ///
    /// # Panics
    /// When the degree is not below `N`.
    #[inline]
    pub(super) fn basis_in_room<const N: usize>(&self, u: f64, order: usize) -> LocalBasis<N> {
        self.basis_within(self.span(u), u, order)
    }

    #[inline]
    fn basis_within<const N: usize>(&self, span: usize, u: f64, order: usize) -> LocalBasis<N> {
        let p = self.degree();
        assert!(span >= p && span < self.n_basis(), "span {span} is not in the domain");
        let mut rows = [[0.0; N]; 3];
        let mut now = [0.0; N];
        now[0] = 1.0;
        for j in 0..=p {
            if j > 0 {
                self.raise(span, u, j, &mut now);
            }
            let lacking = p - j;
            if lacking <= order.min(2) {
                // Only what is set: the room for the greatest degree is many times that of a cubic.
                rows[lacking][..=j].copy_from_slice(&now[..=j]);
            }
        }
        for (lacking, row) in rows.iter_mut().enumerate().take(order.min(2).min(p) + 1).skip(1) {
            for step in (0..lacking).rev() {
                self.differentiate(span, p - step, row);
            }
        }
        for row in rows.iter_mut().skip(p + 1) {
            *row = [0.0; N];
        }
        LocalBasis { span, degree: p, rows }
    }

    /// From the `j` functions of degree `j - 1` on a span to the `j + 1` of degree `j` (A2.2).
    #[inline]
    fn raise(&self, span: usize, u: f64, j: usize, row: &mut [f64]) {
        let knots = self.knots();
        let (lows, highs) = (&knots[span + 1 - j..][..j], &knots[span + 1..][..j]);
        let mut saved = 0.0;
        let (row, last) = row.split_at_mut(j);
        for ((value, &low), &high) in row.iter_mut().zip(lows).zip(highs) {
            let share = if high > low { *value / (high - low) } else { 0.0 };
            *value = saved + (high - u) * share;
            saved = (u - low) * share;
        }
        last[0] = saved;
    }

    /// From coefficients on the `degree` functions of degree `degree - 1` to the derivatives they stand for
    /// on the `degree + 1` functions of `degree` (The NURBS Book 2.7).
    #[inline]
    fn differentiate(&self, span: usize, degree: usize, row: &mut [f64]) {
        let knots = self.knots();
        let (lows, highs) = (&knots[span + 1 - degree..][..degree], &knots[span + 1..][..degree]);
        let mut saved = 0.0;
        let (row, last) = row.split_at_mut(degree);
        for ((value, &low), &high) in row.iter_mut().zip(lows).zip(highs) {
            let share = if high > low { degree as f64 * *value / (high - low) } else { 0.0 };
            *value = saved - share;
            saved = share;
        }
        last[0] = saved;
    }
}
