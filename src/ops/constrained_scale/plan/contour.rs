//! A loop in space: centre, length and vector area from the curves of its edges, which depend neither on a surface's
//! parameters nor on which face the loop is seen from.

use crate::brep::{EdgeId, LoopId, edge_range};
use crate::math::{Point3, Vector3};
use crate::model::Model;
use crate::ops::{Obstacle, OperationError};

/// Chords of each edge: any fixed count will do, as long as both ends of a hole get the same.
const CHORDS: usize = 48;

/// A loop as a closed polygon.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpaceLoop {
    /// Points in the order of the coedges, without the first repeated.
    pub points: Vec<Point3<f64>>,
    /// Sum of the middles of the sides, each times its length.
    pub weighted: Vector3<f64>,
    /// Length.
    pub length: f64,
    /// Vector area; which side it points to is the loop's sense.
    pub area: Vector3<f64>,
}

impl SpaceLoop {
    /// Samples a loop.
    ///
    /// # Errors
    /// [`OperationError::CannotFollow`] names the edges whose curves are not read.
    pub fn of(model: &Model, id: LoopId) -> Result<Self, OperationError> {
        let mut points = Vec::new();
        for &coedge in &model.brep.loops[id].coedges {
            let use_of = &model.brep.coedges[coedge];
            let mut along = Self::points_of(model, use_of.edge)?;
            if !use_of.forward {
                along.reverse();
            }
            along.pop();
            points.extend(along);
        }
        Ok(Self::of_points(points))
    }

    /// Points along an edge from its start to its end, both included.
    ///
    /// # Errors
    /// [`OperationError::CannotFollow`] when its curve is not read.
    pub fn points_of(model: &Model, edge: EdgeId) -> Result<Vec<Point3<f64>>, OperationError> {
        let curve = model.brep.curve_of(edge).read();
        let (Some(curve), Some(range)) = (curve, edge_range(&model.brep, edge)) else {
            return Err(unread(model, edge));
        };
        let at = |k: usize| range.start + (range.end - range.start) * (k as f64 / CHORDS as f64);
        Ok((0..=CHORDS).map(|k| curve.point_wrapped(at(k))).collect())
    }

    fn of_points(points: Vec<Point3<f64>>) -> Self {
        let (mut weighted, mut length, mut area) = (Vector3::zeros(), 0.0, Vector3::zeros());
        let origin = points.first().copied().unwrap_or_else(Point3::origin);
        for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
            let side = (b - a).norm();
            weighted += (a.coords + b.coords) * (0.5 * side);
            length += side;
            area += 0.5 * (a - origin).cross(&(b - origin));
        }
        Self { points, weighted, length, area }
    }

    /// Centre by length; the first point of a loop without length.
    pub fn center(&self) -> Point3<f64> {
        if self.length > 0.0 {
            return Point3::from(self.weighted / self.length);
        }
        self.points.first().copied().unwrap_or_else(Point3::origin)
    }

    /// Diameter of the sphere round the centre that holds the loop.
    pub fn width(&self) -> f64 {
        let center = self.center();
        2.0 * self.points.iter().map(|p| (p - center).norm()).fold(0.0, f64::max)
    }
}

fn unread(model: &Model, edge: EdgeId) -> OperationError {
    let entity = model.origins.edges[edge].to_string();
    let reason = "its curve was not read".to_owned();
    OperationError::CannotFollow { obstacles: vec![Obstacle { entity, kind: "edge".to_owned(), reason }] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_has_its_centre_area_and_diagonal() {
        let corners = [[0.0, 0.0, 5.0], [4.0, 0.0, 5.0], [4.0, 3.0, 5.0], [0.0, 3.0, 5.0]];
        let found = SpaceLoop::of_points(corners.map(|[x, y, z]| Point3::new(x, y, z)).to_vec());
        assert_eq!(found.length, 14.0);
        assert!((found.center() - Point3::new(2.0, 1.5, 5.0)).norm() < 1e-15);
        assert!((found.area - Vector3::new(0.0, 0.0, 12.0)).norm() < 1e-15);
        assert!((found.width() - 5.0).abs() < 1e-15);
    }
}
