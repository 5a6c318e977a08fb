//! One step of the hierarchy: its filters, and splitting and joining by them.

use super::coarsen::coarsened;
use super::refinement::Refinement;
use super::wavelets::Wavelets;
use super::{Coarsened, WaveletError};
use crate::geometry::nurbs::{KnotVector, gram_band};
use crate::math::banded_cholesky::{BandedCholesky, NotPositiveDefinite};

/// The filters between a level and the next coarser one.
///
/// Control points `c` over the fine knots are `P b + Q d`, with the base `b` over the coarse knots and the detail
/// `d`, one row for each wavelet.
#[derive(Debug, Clone)]
pub struct Level {
    fine: KnotVector,
    coarse: KnotVector,
    ends: usize,
    refinement: Refinement,
    wavelets: Wavelets,
    gram: Vec<f64>,
    base_factor: BandedCholesky,
    detail_factor: BandedCholesky,
}

impl Level {
    /// The filters of fine knots with an end order; `None` when no knot can go.
    ///
    /// # Errors
    /// [`WaveletError`].
    pub fn new(fine: &KnotVector, ends: usize) -> Result<Option<Self>, WaveletError> {
        let Some(Coarsened { knots: coarse, .. }) = coarsened(fine, ends)? else { return Ok(None) };
        let refinement = Refinement::new(&coarse, fine);
        let gram = gram_band(fine, 0, 0);
        let wavelets = Wavelets::find(fine, &coarse, ends, &refinement, &gram)?;
        let lost = |NotPositiveDefinite { row }| {
            let at = fine.knots()[row.min(fine.n_basis())];
            WaveletError::NoBasis { at }
        };
        let base_factor = base_factor(&coarse, ends).map_err(lost)?;
        let detail_factor = detail_factor(fine.degree(), &wavelets, &gram).map_err(lost)?;
        let fine = fine.clone();
        Ok(Some(Self { fine, coarse, ends, refinement, wavelets, gram, base_factor, detail_factor }))
    }

    /// Knots of the finer side.
    #[must_use]
    pub fn fine(&self) -> &KnotVector {
        &self.fine
    }

    /// Knots of the coarser side.
    #[must_use]
    pub fn coarse(&self) -> &KnotVector {
        &self.coarse
    }

    /// How many wavelets there are: rows of detail.
    #[must_use]
    pub fn wavelet_count(&self) -> usize {
        self.wavelets.count()
    }

    /// A wavelet: the first fine control point that it has, and its coefficients from there on.
    ///
    /// # Panics
    /// For an index that is not below [`wavelet_count`](Self::wavelet_count).
    #[must_use]
    pub fn wavelet(&self, index: usize) -> (usize, &[f64]) {
        self.wavelets.column(index)
    }

    /// The refinement matrix `P`.
    #[must_use]
    pub fn refinement(&self) -> &Refinement {
        &self.refinement
    }

    /// Where each wavelet sits: the mean of the Greville abscissae under it, weighted by the squares of its
    /// coefficients and the norms of their functions.
    #[must_use]
    pub fn centres(&self) -> Vec<f64> {
        let p = self.fine.degree();
        let greville = self.fine.greville();
        let centre = |j: usize| {
            let (first, column) = self.wavelets.column(j);
            let (mut sum, mut total) = (0.0, 0.0);
            for (i, q) in (first..).zip(column) {
                let weight = q * q * self.gram[i * (2 * p + 1) + p];
                sum += weight * greville[i];
                total += weight;
            }
            sum / total
        };
        (0..self.wavelets.count()).map(centre).collect()
    }

    /// Splits control points into base and detail.
    ///
    /// # Errors
    /// [`WaveletError::CountMismatch`].
    pub fn split<const D: usize>(&self, controls: &[[f64; D]]) -> Result<Split<D>, WaveletError> {
        let (n, m, k) = (self.fine.n_basis(), self.coarse.n_basis(), self.ends);
        if controls.len() != n {
            return Err(WaveletError::CountMismatch { expected: n, found: controls.len() });
        }
        let mut base = vec![[0.0; D]; m];
        base[..k].copy_from_slice(&controls[..k]);
        base[m - k..].copy_from_slice(&controls[n - k..]);
        let weighed = self.weighed(&self.rest(controls, &base));
        let mut inner = self.refinement.apply_transposed(&weighed)[k..m - k].to_vec();
        self.base_factor.solve(&mut inner);
        base[k..m - k].copy_from_slice(&inner);
        let weighed = self.weighed(&self.rest(controls, &base));
        let mut detail: Vec<[f64; D]> = (0..self.wavelets.count())
            .map(|j| {
                let (first, column) = self.wavelets.column(j);
                combination(column, &weighed[first..])
            })
            .collect();
        self.detail_factor.solve(&mut detail);
        Ok((base, detail))
    }

    /// Joins base and detail to control points over the fine knots.
    ///
    /// # Panics
    /// When there are fewer points than coarse control points, or rows of detail than wavelets.
    #[must_use]
    pub fn join<const D: usize>(&self, base: &[[f64; D]], detail: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut controls = self.refinement.apply(base);
        for (j, row) in detail.iter().enumerate().take(self.wavelets.count()) {
            let (first, column) = self.wavelets.column(j);
            for (factor, point) in column.iter().zip(&mut controls[first..]) {
                for (c, d) in point.iter_mut().zip(row) {
                    *c += factor * d;
                }
            }
        }
        controls
    }

    /// `c - P b`.
    fn rest<const D: usize>(&self, controls: &[[f64; D]], base: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut rest = self.refinement.apply(base);
        for (r, c) in rest.iter_mut().zip(controls) {
            for (r, c) in r.iter_mut().zip(c) {
                *r = c - *r;
            }
        }
        rest
    }

    /// `G c`.
    fn weighed<const D: usize>(&self, controls: &[[f64; D]]) -> Vec<[f64; D]> {
        let (p, n) = (self.fine.degree(), self.fine.n_basis());
        let row = |i: usize| {
            let (low, high) = (i.saturating_sub(p), (i + p + 1).min(n));
            let start = i * (2 * p + 1) + low + p - i;
            combination(&self.gram[start..start + high - low], &controls[low..high])
        };
        (0..n).map(row).collect()
    }
}

/// Base and detail.
type Split<const D: usize> = (Vec<[f64; D]>, Vec<[f64; D]>);

fn combination<const D: usize>(factors: &[f64], points: &[[f64; D]]) -> [f64; D] {
    let mut sum = [0.0; D];
    for (factor, point) in factors.iter().zip(points) {
        for (s, c) in sum.iter_mut().zip(point) {
            *s += factor * c;
        }
    }
    sum
}

/// Factor of the Gram matrix of the coarse functions without the first and last `ends`.
fn base_factor(coarse: &KnotVector, ends: usize) -> Result<BandedCholesky, NotPositiveDefinite> {
    let (p, m) = (coarse.degree(), coarse.n_basis());
    let gram = gram_band(coarse, 0, 0);
    let mut band = Vec::with_capacity((m - 2 * ends) * (p + 1));
    for i in ends..m - ends {
        // What lies left of the inner block belongs to functions that are held.
        let row = &gram[i * (2 * p + 1)..i * (2 * p + 1) + p + 1];
        band.extend(row.iter().enumerate().map(|(at, v)| if i + at >= p + ends { *v } else { 0.0 }));
    }
    BandedCholesky::new(p, band)
}

/// Factor of `Qᵀ G Q`.
fn detail_factor(p: usize, wavelets: &Wavelets, gram: &[f64]) -> Result<BandedCholesky, NotPositiveDefinite> {
    let count = wavelets.count();
    let last = |j: usize| {
        let (first, column) = wavelets.column(j);
        first + column.len() - 1
    };
    // The greatest last row of all wavelets up to each: where overlaps with later ones end.
    let mut half = 0;
    let mut reach: Vec<usize> = (0..count).map(last).collect();
    for j in 1..count {
        reach[j] = reach[j].max(reach[j - 1]);
    }
    for j in 0..count {
        let first = wavelets.column(j).0;
        half = half.max(j - reach.partition_point(|&r| r + p < first).min(j));
    }
    let mut band = vec![0.0; count * (half + 1)];
    for j in 0..count {
        let (first, column) = wavelets.column(j);
        for i in j.saturating_sub(half)..=j {
            let (other, entries) = wavelets.column(i);
            band[j * (half + 1) + half - (j - i)] = product(p, gram, (first, column), (other, entries));
        }
    }
    BandedCholesky::new(half, band)
}

/// `aᵀ G b` of two columns.
fn product(p: usize, gram: &[f64], a: (usize, &[f64]), b: (usize, &[f64])) -> f64 {
    let mut sum = 0.0;
    for (i, left) in (a.0..).zip(a.1) {
        let low = i.saturating_sub(p).max(b.0);
        let high = (i + p + 1).min(b.0 + b.1.len());
        for k in low..high {
            sum += left * b.1[k - b.0] * gram[i * (2 * p + 1) + k + p - i];
        }
    }
    sum
}
