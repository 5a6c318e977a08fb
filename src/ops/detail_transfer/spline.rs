//! Splines without weights: what wavelets work on.

use crate::geometry::bspline_wavelet::Refinement;
use crate::geometry::nurbs::{KnotVector, NurbsCurve3};
use crate::math::{Vector3, quadrature::gauss_legendre};

/// A clamped B-spline in space without weights.
///
/// INVARIANT: as many points as the knots ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// Knots, clamped.
    pub knots: KnotVector,
    /// Control points.
    pub points: Vec<[f64; 3]>,
}

/// Gauss points for the length of a quarter of a span.
const LENGTH_NODES: usize = 8;
/// Pieces of a span for its length.
const LENGTH_PIECES: usize = 4;

impl Spline {
    /// The curve over its control points; `None` when it is rational.
    #[must_use]
    pub fn of(curve: &NurbsCurve3) -> Option<Self> {
        if curve.is_rational() {
            return None;
        }
        let clamped = curve.clamped();
        let points = clamped.control_points().map(|p| p.coords.into()).collect();
        Some(Self { knots: clamped.knots().clone(), points })
    }

    /// As a B-spline curve; `None` when a coordinate is not finite.
    #[must_use]
    pub fn to_nurbs(&self) -> Option<NurbsCurve3> {
        let points = self.points.iter().map(|[x, y, z]| [*x, *y, *z, 1.0]).collect();
        NurbsCurve3::new(self.knots.clone(), points).ok()
    }

    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        self.knots.domain()
    }

    /// Point and first derivative.
    #[must_use]
    pub fn at(&self, t: f64) -> [Vector3<f64>; 2] {
        let basis = self.knots.basis_derivatives(t, 1);
        let points = &self.points[basis.first()..];
        [0, 1].map(|order| {
            let terms = basis.derivatives(order).iter().zip(points);
            terms.fold(Vector3::zeros(), |sum, (factor, point)| sum + Vector3::from(*point) * *factor)
        })
    }

    /// The same curve run the other way over the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { knots: self.knots.reversed(), points: self.points.iter().rev().copied().collect() }
    }

    /// The same curve with at least the given degree; `None` above the highest degree.
    #[must_use]
    pub fn elevated(&self, degree: usize) -> Option<Self> {
        if degree <= self.knots.degree() {
            return Some(self.clone());
        }
        Self::of(&self.to_nurbs()?.elevated(degree).ok()?)
    }

    /// The same curve over knots that hold all of its own.
    #[must_use]
    pub fn over(&self, knots: &KnotVector) -> Self {
        Self { knots: knots.clone(), points: Refinement::new(&self.knots, knots).apply(&self.points) }
    }

    /// Non-empty pieces between knots.
    #[must_use]
    pub fn span_count(&self) -> usize {
        self.knots.spans().count()
    }

    /// Length between two parameters: Gauss quadrature on four pieces of each span.
    #[must_use]
    pub fn length(&self, from: f64, to: f64) -> f64 {
        let (nodes, weights) = gauss_legendre(LENGTH_NODES);
        let spans = self.knots.spans().map(|k| (self.knots.knots()[k], self.knots.knots()[k + 1]));
        let mut sum = 0.0;
        for (low, high) in spans {
            let (low, high) = (low.max(from), high.min(to));
            if low >= high {
                continue;
            }
            let half = 0.5 * (high - low) / LENGTH_PIECES as f64;
            for piece in 0..LENGTH_PIECES {
                let middle = low + half * (2 * piece + 1) as f64;
                for (x, w) in nodes.iter().zip(&weights) {
                    sum += half * w * self.at(middle + half * x)[1].norm();
                }
            }
        }
        sum
    }

    /// The parameter up to which the curve has a part of its whole length; 0 gives the start, 1 the end.
    #[must_use]
    pub fn parameter_at_length(&self, part: f64) -> f64 {
        let (start, end) = self.domain();
        if part <= 0.0 {
            return start;
        }
        if part >= 1.0 {
            return end;
        }
        let wanted = part * self.length(start, end);
        let (mut low, mut high, mut before) = (start, end, 0.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let more = self.length(low, middle);
            if before + more < wanted {
                (low, before) = (middle, before + more);
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Greatest coordinate difference of the control points.
    #[must_use]
    pub fn size(&self) -> f64 {
        let extent = |c: usize| {
            let values = self.points.iter().map(|p| p[c]);
            values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
        };
        (0..3).map(extent).fold(0.0, f64::max)
    }

    /// Whether the ends meet within a part of the size.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        (Vector3::from(first) - Vector3::from(last)).norm() <= CLOSED * self.size()
    }
}

/// Halvings of the domain when a length is looked for: down to the spacing of doubles.
const BISECTIONS: usize = 52;
/// Distance of the ends, relative to the size, at which a curve counts as closed, as elsewhere.
const CLOSED: f64 = 1e-7;
