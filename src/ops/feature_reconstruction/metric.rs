//! The parameters of a surface as lengths, and lines in them.

use super::Closure;
use super::feet::Foot;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::Point3;

/// Parameters times the mean lengths of the derivatives: a plane in which distances are roughly those on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metric([f64; 2]);

impl Metric {
    /// The metric round some feet.
    #[must_use]
    pub fn around(surface: &NurbsSurface, feet: &[Foot]) -> Self {
        let mut sums = [0.0; 2];
        for foot in feet {
            let (_, du, dv) = surface.first_derivatives(foot.at[0], foot.at[1]);
            sums[0] += du.norm();
            sums[1] += dv.norm();
        }
        Self(sums.map(|sum| sum / feet.len().max(1) as f64))
    }

    /// Lengths of parameters.
    #[must_use]
    pub fn lengths(&self, at: [f64; 2]) -> [f64; 2] {
        [at[0] * self.0[0], at[1] * self.0[1]]
    }

    /// Parameters of lengths.
    #[must_use]
    pub fn parameters(&self, x: [f64; 2]) -> [f64; 2] {
        [x[0] / self.0[0], x[1] / self.0[1]]
    }
}

/// A line of parameters on a surface, dense enough to be straight between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterLine {
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Whether it is closed; its first point is not repeated then.
    pub closure: Closure,
}

impl ParameterLine {
    /// `n` points at even steps by the length on the surface, both ends among them when the line is open; and the
    /// length.
    #[must_use]
    pub fn resampled(&self, surface: &NurbsSurface, n: usize) -> (Self, f64) {
        let mut points = self.points.clone();
        if self.closure == Closure::Closed {
            points.extend(self.points.first());
        }
        let places: Vec<Point3<f64>> = points.iter().map(|[u, v]| surface.point(*u, *v)).collect();
        let mut lengths = vec![0.0];
        for pair in places.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let whole = lengths[lengths.len() - 1];
        let steps = match self.closure {
            Closure::Closed => n,
            Closure::Open => n.saturating_sub(1).max(1),
        };
        let at = |k: usize| {
            let wanted = whole * k as f64 / steps as f64;
            let i = lengths.partition_point(|l| *l < wanted).clamp(1, lengths.len() - 1);
            let part = lengths[i] - lengths[i - 1];
            let share = if part > 0.0 { ((wanted - lengths[i - 1]) / part).clamp(0.0, 1.0) } else { 0.0 };
            [0, 1].map(|c| points[i - 1][c] + share * (points[i][c] - points[i - 1][c]))
        };
        (Self { points: (0..n).map(at).collect(), closure: self.closure }, whole)
    }
}
