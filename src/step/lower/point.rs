//! Points and directions: the last level, where coordinates become text.

use super::super::exchange_structure::InstanceName;
use super::compose;
use super::request::{Coordinates, Request, Requests, group_equal};
use super::{LowerError, Lowering};
use crate::brep::VertexId;
use crate::model::ChangeSet;

impl Lowering<'_> {
    /// Requests the new points of vertices.
    pub(super) fn request_vertices(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&vertex, point) in &changes.points {
            self.request_vertex(vertex, Coordinates::Three([point.x, point.y, point.z]))?;
        }
        Ok(())
    }

    fn request_vertex(&mut self, vertex: VertexId, coordinates: Coordinates) -> Result<(), LowerError> {
        let name = super::instance_name(self.model.origins.vertices[vertex])?;
        let (token, target) = self.reference(name, "vertex_geometry")?;
        self.points.add(target, token, coordinates);
        Ok(())
    }

    /// Decides all points.
    pub(super) fn points(&mut self) -> Result<(), LowerError> {
        let mut requests = std::mem::take(&mut self.points);
        self.coordinates(&mut requests, "CARTESIAN_POINT", "coordinates")
    }

    /// Decides all directions.
    pub(super) fn directions(&mut self) -> Result<(), LowerError> {
        let mut requests = std::mem::take(&mut self.directions);
        self.coordinates(&mut requests, "DIRECTION", "direction_ratios")
    }

    fn coordinates(
        &mut self,
        requests: &mut Requests<Coordinates>,
        keyword: &'static str,
        attribute: &'static str,
    ) -> Result<(), LowerError> {
        let all = requests.take().map_err(|name| LowerError::Conflict { name })?;
        for of_one in all.chunk_by(|a, b| a.0 == b.0) {
            self.decide_coordinates(of_one, keyword, attribute)?;
        }
        Ok(())
    }

    fn decide_coordinates(
        &mut self,
        requests: &[(InstanceName, Request<Coordinates>)],
        keyword: &'static str,
        attribute: &'static str,
    ) -> Result<(), LowerError> {
        let target = requests[0].0;
        let groups = group_equal(requests);
        if groups.len() == 1 && self.is_covered(target, requests.len()) {
            return self.edit_reals(target, attribute, groups[0].0.as_slice());
        }
        for (coordinates, tokens) in groups {
            if self.reads_as(target, attribute, coordinates.as_slice()) {
                continue;
            }
            let new = self.append(&compose::coordinates(keyword, coordinates.as_slice()))?;
            for token in tokens {
                self.repoint(token, target, new);
            }
        }
        Ok(())
    }

    /// Appends a point in space.
    pub(in crate::step) fn append_point(&mut self, coordinates: &[f64]) -> Result<InstanceName, LowerError> {
        self.append(&compose::coordinates("CARTESIAN_POINT", coordinates))
    }

    /// Appends a direction.
    pub(super) fn append_direction(&mut self, ratios: &[f64]) -> Result<InstanceName, LowerError> {
        self.append(&compose::coordinates("DIRECTION", ratios))
    }
}
