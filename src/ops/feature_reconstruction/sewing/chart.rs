//! From points on the primary to the parameters of its face.

use super::super::Closure;
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsCurve2, NurbsSurface, Wrap, open_cubic, periodic_cubic};
use crate::math::Point3;

/// How points of the working surface get the parameters of the face.
#[derive(Debug, Clone, Copy)]
pub enum Chart<'a> {
    /// The working surface has the face's own parameters; it may be longer.
    Same(&'a NurbsSurface),
    /// It has others: the face's surface tells.
    Other(&'a Surface),
}

/// Part of a period, or of the domain, within which the end of a closed line meets its start.
const CLOSES: f64 = 1e-6;

impl Chart<'_> {
    /// Parameters of a point near some others.
    #[must_use]
    pub fn place(&self, point: &Point3<f64>, near: Option<[f64; 2]>) -> [f64; 2] {
        match self {
            Self::Same(surface) => {
                let found = match near {
                    Some(near) => surface.closest_from(point, (near[0], near[1]), Wrap::default()),
                    None => {
                        crate::geometry::nurbs::SurfaceLocator::new(surface, Wrap::default()).closest(point)
                    }
                };
                [found.u, found.v]
            }
            Self::Other(surface) => surface.parameters_of(point, near.map(|[u, v]| (u, v))).into(),
        }
    }

    /// Point of some parameters.
    #[must_use]
    pub fn point(&self, at: [f64; 2]) -> Point3<f64> {
        match self {
            Self::Same(surface) => surface.point(at[0], at[1]),
            Self::Other(surface) => surface.point(at[0], at[1]),
        }
    }

    /// Lengths of `u` and of `v` after which the surface repeats.
    #[must_use]
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Same(_) => [None; 2],
            Self::Other(surface) => surface.periods().into(),
        }
    }

    /// First parameters of the domain.
    #[must_use]
    pub fn starts(&self) -> [f64; 2] {
        let (u, v) = match self {
            Self::Same(surface) => surface.domain(),
            Self::Other(surface) => surface.domain(),
        };
        [u.0, v.0]
    }

    /// The cubic through the places of points at even steps of a line. `None` for a closed line that runs round the
    /// surface, or parameters that are not finite.
    #[must_use]
    pub fn curve(
        &self,
        points: &[Point3<f64>],
        closure: Closure,
        start: Option<[f64; 2]>,
    ) -> Option<NurbsCurve2> {
        let mut places: Vec<[f64; 2]> = Vec::with_capacity(points.len());
        for point in points {
            places.push(self.place(point, places.last().copied().or(start)));
        }
        let first = *places.first()?;
        if closure == Closure::Closed {
            let last = self.place(&points[0], places.last().copied());
            let size = [0, 1].map(|k| self.periods()[k].unwrap_or(1.0 + first[k].abs()));
            if (0..2).any(|k| (last[k] - first[k]).abs() > CLOSES * size[k]) {
                return None;
            }
        }
        if !places.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        let (knots, rows) = match closure {
            Closure::Closed => periodic_cubic(places.as_flattened(), 2),
            Closure::Open => open_cubic(places.as_flattened(), 2),
        };
        NurbsCurve2::new(knots, rows.chunks_exact(2).map(|p| [p[0], p[1], 1.0]).collect()).ok()
    }
}
