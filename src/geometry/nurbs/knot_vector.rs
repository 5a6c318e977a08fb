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
}

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
}
