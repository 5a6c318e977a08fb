//! Feet of points on a surface, with signed heights: for whole clouds, in parallel.
//!
//! A grid of samples gives each point its start, Newton's method the rest. A foot is unique only while the height times the
//! surface's curvature stays below 1; how many come near that is told.

use crate::cloud::Neighbours;
use crate::geometry::nurbs::{KnotVector, NurbsSurface, Wrap};
use crate::math::{Point3, Vector3};
use rayon::prelude::*;

/// A point as the surface sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Parameters of the foot.
    pub at: [f64; 2],
    /// The foot.
    pub point: Point3<f64>,
    /// Distance of the point, positive on the side of `du x dv`.
    pub height: f64,
}

/// A surface made ready for many projections.
#[derive(Debug, Clone)]
pub struct Projector<'a> {
    surface: &'a NurbsSurface,
    wrap: Wrap,
    samples: Neighbours,
    places: Vec<[f64; 2]>,
}

/// Least count of samples along each direction.
const SAMPLES: usize = 96;
/// Samples of each span.
const PER_SPAN: usize = 3;
/// Greatest count of samples along each direction.
const MOST_SAMPLES: usize = 768;

impl<'a> Projector<'a> {
    /// Samples a surface; `wrap` names the directions in which it is closed.
    #[must_use]
    pub fn new(surface: &'a NurbsSurface, wrap: Wrap) -> Self {
        let places = |knots: &KnotVector| {
            let count = (PER_SPAN * knots.spans().count()).clamp(SAMPLES, MOST_SAMPLES);
            let (low, high) = knots.domain();
            (0..count).map(|k| low + (high - low) * (k as f64 / (count - 1) as f64)).collect::<Vec<f64>>()
        };
        let (us, vs) = (places(surface.knots_u()), places(surface.knots_v()));
        let samples = Neighbours::new(&surface.grid(&us, &vs));
        let places = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v])).collect();
        Self { surface, wrap, samples, places }
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &'a NurbsSurface {
        self.surface
    }

    /// The foot of a point.
    #[must_use]
    pub fn foot(&self, point: &Point3<f64>) -> Foot {
        let nearest = self.samples.nearest(point).map_or(0, |(k, _)| self.samples.origin()[k] as usize);
        let seed = self.places[nearest];
        let found = self.surface.closest_from(point, (seed[0], seed[1]), self.wrap);
        let away = point - found.point;
        let normal = self.surface.normal(found.u, found.v).unwrap_or_else(Vector3::zeros);
        let height = if away.dot(&normal) < 0.0 { -found.distance } else { found.distance };
        Foot { at: [found.u, found.v], point: found.point, height }
    }

    /// The feet of points, in their order.
    #[must_use]
    pub fn feet(&self, points: &[Point3<f64>]) -> Vec<Foot> {
        points.par_iter().map(|point| self.foot(point)).collect()
    }

    /// Share of the feet at which the height times the surface's greatest curvature is beyond a limit.
    #[must_use]
    pub fn share_beyond(&self, feet: &[Foot], limit: f64) -> f64 {
        let beyond = |foot: &&Foot| {
            let curvature = self.surface.derivatives(foot.at[0], foot.at[1]).greatest_curvature();
            curvature.is_none_or(|k| k * foot.height.abs() > limit)
        };
        feet.iter().filter(beyond).count() as f64 / feet.len().max(1) as f64
    }
}
