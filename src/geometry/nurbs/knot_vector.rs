//! Knot vectors: the one holder of knots in the crate.
//!
//! INVARIANT: degree at least 1, knots finite and non-decreasing, clamped or not; the domain
//! `[knots[p], knots[n]]` is not empty; an interior knot occurs at most `degree + 1` times.

/// A degree with its knots.
#[derive(Debug, Clone, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
}

/// Why a list of numbers is no knot vector.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KnotVectorError {
    /// Degree 0 or above [`KnotVector::MAX_DEGREE`].
    #[error("degree {degree} is outside 1 to {}", KnotVector::MAX_DEGREE)]
    Degree {
        /// Degree given.
        degree: usize,
    },
    /// Fewer than `2 (degree + 1)` knots.
    #[error("at least {expected} knots expected for degree {degree}, found {found}")]
    TooFew {
        /// Degree given.
        degree: usize,
        /// Least count.
        expected: usize,
        /// Count given.
        found: usize,
    },
    /// A knot is smaller than the one before, NaN or infinite.
    #[error("knot {index} is {value}, which is not a finite number at or above the knot before it")]
    Decreasing {
        /// Index in the full knot vector.
        index: usize,
        /// Value found.
        value: f64,
    },
    /// An interior knot occurs more than `degree + 1` times.
    #[error("knot {value} occurs more than {} times for degree {degree}", degree + 1)]
    Multiplicity {
        /// Degree given.
        degree: usize,
        /// The knot.
        value: f64,
    },
    /// First and last knot of the domain coincide.
    #[error("the parameter domain is empty")]
    EmptyDomain,
    /// The lists of knots and multiplicities differ in length, or a multiplicity is zero.
    #[error("{knots} knots with {multiplicities} multiplicities, all of which must be positive")]
    Multiplicities {
        /// Count of distinct knots.
        knots: usize,
        /// Count of multiplicities.
        multiplicities: usize,
    },
    /// A knot to be inserted lies outside the domain or is not a number.
    #[error("knot {value} to be inserted lies outside the domain")]
    OutsideDomain {
        /// The knot.
        value: f64,
    },
    /// A scale of the parameter is zero, negative or not finite.
    #[error("the parameter cannot be scaled by {factor}")]
    Scale {
        /// The factor.
        factor: f64,
    },
}

/// Knots closer than this part of the whole range count as one.
pub const COINCIDENT: f64 = 1e-10;

/// Part of a span by which it may be longer than asked before it is cut once more.
const ROUNDED: f64 = 1e-9;

impl KnotVector {
    /// Highest degree accepted: above it, double precision loses the curve.
    pub const MAX_DEGREE: usize = 25;

    /// Checks and takes a degree with a full knot vector of `n + degree + 1` knots.
    ///
    /// # Errors
    /// See [`KnotVectorError`].
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, KnotVectorError> {
        if degree == 0 || degree > Self::MAX_DEGREE {
            return Err(KnotVectorError::Degree { degree });
        }
        let expected = 2 * (degree + 1);
        if knots.len() < expected {
            return Err(KnotVectorError::TooFew { degree, expected, found: knots.len() });
        }
        let mut last = f64::NEG_INFINITY;
        for (index, &value) in knots.iter().enumerate() {
            if !value.is_finite() || value < last {
                return Err(KnotVectorError::Decreasing { index, value });
            }
            last = value;
        }
        if let Some(window) = knots.windows(degree + 2).find(|w| w[0] >= w[degree + 1]) {
            return Err(KnotVectorError::Multiplicity { degree, value: window[0] });
        }
        let n = knots.len() - degree - 1;
        if knots[degree] >= knots[n] {
            return Err(KnotVectorError::EmptyDomain);
        }
        Ok(Self { degree, knots })
    }

    /// From distinct knots and their multiplicities, as ISO 10303-42 writes them.
    ///
    /// # Errors
    /// See [`KnotVectorError`].
    pub fn from_multiplicities(
        degree: usize,
        knots: &[f64],
        multiplicities: &[usize],
    ) -> Result<Self, KnotVectorError> {
        let fits = knots.len() == multiplicities.len()
            && multiplicities.iter().all(|&m| m > 0 && m <= Self::MAX_DEGREE + 1);
        if !fits {
            return Err(KnotVectorError::Multiplicities {
                knots: knots.len(),
                multiplicities: multiplicities.len(),
            });
        }
        let full = knots.iter().zip(multiplicities).flat_map(|(&k, &m)| std::iter::repeat_n(k, m));
        Self::new(degree, full.collect())
    }

    /// Clamped, with equal spans over `[start, end]`.
    ///
    /// # Errors
    /// [`KnotVectorError::EmptyDomain`] for no span or an empty interval.
    pub fn clamped_uniform(
        degree: usize,
        n_spans: usize,
        start: f64,
        end: f64,
    ) -> Result<Self, KnotVectorError> {
        if n_spans == 0 {
            return Err(KnotVectorError::EmptyDomain);
        }
        let inner = (1..n_spans).map(|i| start + (end - start) * (i as f64 / n_spans as f64));
        let mut knots = vec![start; degree + 1];
        knots.extend(inner);
        knots.extend(std::iter::repeat_n(end, degree + 1));
        Self::new(degree, knots)
    }

    /// Degree `p`.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All `n + p + 1` knots.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Count `n` of basis functions, and so of control points.
    #[must_use]
    pub fn n_basis(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// First and last parameter, `(knots[p], knots[n])`.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.n_basis()])
    }

    /// Whether the first and the last `p + 1` knots are equal, so that the ends are control points.
    #[must_use]
    pub fn is_clamped(&self) -> bool {
        let (start, end) = self.domain();
        self.knots[0] >= start && self.knots[self.knots.len() - 1] <= end
    }

    /// Index of the span that holds `u` (The NURBS Book A2.1): the last `k` in `p ..= n - 1` with
    /// `knots[k] <= u` and a span that is not empty.
    ///
    /// The end of the domain belongs to the last span; parameters outside the domain to the nearest one.
    #[must_use]
    pub fn span(&self, u: f64) -> usize {
        let (p, n) = (self.degree, self.n_basis());
        let mut k = self.knots.partition_point(|&knot| knot <= u).saturating_sub(1).clamp(p, n - 1);
        while k > p && self.knots[k] >= self.knots[k + 1] {
            k -= 1;
        }
        while k + 1 < n && self.knots[k] >= self.knots[k + 1] {
            k += 1;
        }
        k
    }

    /// Indices `k` of the spans `[knots[k], knots[k + 1]]` of the domain that are not empty.
    pub fn spans(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree..self.n_basis()).filter(|&k| self.knots[k] < self.knots[k + 1])
    }

    /// Greville abscissae `(knots[i + 1] + … + knots[i + p]) / p`, one for each control point.
    #[must_use]
    pub fn greville(&self) -> Vec<f64> {
        let p = self.degree;
        let mean = |i: usize| self.knots[i + 1..=i + p].iter().sum::<f64>() / p as f64;
        let (start, end) = (self.knots[0], self.knots[self.knots.len() - 1]);
        (0..self.n_basis()).map(|i| mean(i).clamp(start, end)).collect()
    }

    /// Distinct knots with multiplicities; knots within `1e-10` of the range of the first of a group
    /// join it.
    #[must_use]
    pub fn distinct(&self) -> (Vec<f64>, Vec<usize>) {
        let tolerance = COINCIDENT * (self.knots[self.knots.len() - 1] - self.knots[0]);
        let (mut values, mut counts): (Vec<f64>, Vec<usize>) = (Vec::new(), Vec::new());
        for &knot in &self.knots {
            match (values.last(), counts.last_mut()) {
                (Some(&last), Some(count)) if knot - last <= tolerance => *count += 1,
                _ => {
                    values.push(knot);
                    counts.push(1);
                }
            }
        }
        (values, counts)
    }

    /// Distinct knots and how often each occurs, as ISO 10303-42 writes them: the inverse of
    /// [`from_multiplicities`](Self::from_multiplicities). Only equal bits count as one knot.
    #[must_use]
    pub fn to_multiplicities(&self) -> (Vec<f64>, Vec<usize>) {
        let runs = || self.knots.chunk_by(|a, b| a.to_bits() == b.to_bits());
        (runs().map(|run| run[0]).collect(), runs().map(<[f64]>::len).collect())
    }

    /// How often exactly `u` occurs.
    #[must_use]
    pub fn multiplicity(&self, u: f64) -> usize {
        self.knots.partition_point(|&k| k <= u) - self.knots.partition_point(|&k| k < u)
    }

    /// The knot of the domain within [`COINCIDENT`] of the range from `u`, or else `u` itself: a knot a rounding error
    /// beside another would make a span of no length.
    #[must_use]
    pub fn snapped(&self, u: f64) -> f64 {
        let (start, end) = self.domain();
        let near = |k: &&f64| (*k - u).abs() <= COINCIDENT * (end - start);
        self.knots[self.degree..=self.n_basis()].iter().find(near).copied().unwrap_or(u)
    }

    /// Knots that cut each span longer than `1 / n` of the domain into equal parts at most that long.
    ///
    /// # Errors
    /// [`KnotVectorError::EmptyDomain`] for no part.
    pub fn cuts(&self, n: usize) -> Result<Vec<f64>, KnotVectorError> {
        if n == 0 {
            return Err(KnotVectorError::EmptyDomain);
        }
        let (start, end) = self.domain();
        let longest = (end - start) / n as f64;
        let mut cuts = Vec::new();
        for k in self.spans() {
            let (low, high) = (self.knots[k], self.knots[k + 1]);
            let parts = ((high - low) / longest - ROUNDED).ceil().max(1.0) as usize;
            cuts.extend((1..parts).map(|i| low + (high - low) * (i as f64 / parts as f64)));
        }
        Ok(cuts)
    }

    /// With further knots, in any order, each within the domain.
    ///
    /// # Errors
    /// [`KnotVectorError::OutsideDomain`]; [`KnotVectorError::Multiplicity`] above `degree + 1`.
    pub fn with_inserted(&self, more: &[f64]) -> Result<Self, KnotVectorError> {
        let (start, end) = self.domain();
        if let Some(&value) = more.iter().find(|&&x| !(x >= start && x <= end)) {
            return Err(KnotVectorError::OutsideDomain { value });
        }
        let mut knots = self.knots.clone();
        knots.extend_from_slice(more);
        knots.sort_by(f64::total_cmp);
        Self::new(self.degree, knots)
    }

    /// Knots `factor · k + shift`, for an affine change of the parameter.
    ///
    /// # Errors
    /// [`KnotVectorError::Scale`] unless `factor` is positive; others when knots fall together or overflow.
    pub fn affine(&self, factor: f64, shift: f64) -> Result<Self, KnotVectorError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(KnotVectorError::Scale { factor });
        }
        Self::new(self.degree, self.knots.iter().map(|k| factor * k + shift).collect())
    }

    /// Knots mirrored in the middle of the domain, which stays.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let (start, end) = self.domain();
        let mirror = |&k: &f64| {
            // The ends swap exactly, whatever `start + end` rounds to.
            if k == start {
                end
            } else if k == end {
                start
            } else {
                start + (end - k)
            }
        };
        let mut knots: Vec<f64> = self.knots.iter().rev().map(mirror).collect();
        // Rounding may turn two knots an ulp apart round; it never moves one further.
        for i in 1..knots.len() {
            knots[i] = knots[i].max(knots[i - 1]);
        }
        Self { degree: self.degree, knots }
    }

    /// The elevated knot vector: `more` degrees higher, every exactly distinct knot that much oftener.
    ///
    /// # Errors
    /// [`KnotVectorError::Degree`] above [`Self::MAX_DEGREE`].
    pub fn elevated(&self, more: usize) -> Result<Self, KnotVectorError> {
        let mut knots = Vec::with_capacity(self.knots.len() * (1 + more));
        for group in self.knots.chunk_by(|a, b| a == b) {
            knots.extend(std::iter::repeat_n(group[0], group.len() + more));
        }
        if self.is_clamped() {
            return Self::new(self.degree + more, knots);
        }
        // Outside the domain only `degree` knots on each side count: drop what elevation added beyond.
        let (start, end) = self.domain();
        let degree = self.degree + more;
        let first = knots.partition_point(|&k| k <= start).saturating_sub(degree + 1);
        let last = (knots.partition_point(|&k| k < end) + degree + 1).min(knots.len());
        Self::new(degree, knots[first..last].to_vec())
    }

    /// Wraps `u` by the length of the domain into it.
    #[must_use]
    pub fn wrapped(&self, u: f64) -> f64 {
        let (start, end) = self.domain();
        if u >= start && u <= end {
            return u;
        }
        (start + (u - start).rem_euclid(end - start)).clamp(start, end)
    }
}
