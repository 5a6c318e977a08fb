//! Placements and vectors: origins and axes requested from points and directions.

use super::super::exchange_structure::InstanceName;
use super::compose::{Body, Value};
use super::request::{Coordinates, NewPlacement, NewVector, group_equal};
use super::{LowerError, Lowering};
use crate::math::{Frame, Point2, Vector2, Vector3};

/// Difference of unit vectors that rounding alone explains: a few units in the last place, from
/// normalising what the file wrote with all its digits. A direction nearer than this keeps its bytes.
const SAME_DIRECTION: f64 = 8.0 * f64::EPSILON;

impl Lowering<'_> {
    /// Decides all placements.
    pub(super) fn placements(&mut self) -> Result<(), LowerError> {
        let all = self.placements.take().map_err(|name| LowerError::Conflict { name })?;
        for of_one in all.chunk_by(|a, b| a.0 == b.0) {
            let target = of_one[0].0;
            let groups = group_equal(of_one);
            if groups.len() == 1 && self.is_covered(target, of_one.len()) {
                self.edit_placement(target, groups[0].0)?;
                continue;
            }
            for (content, tokens) in groups {
                let new = self.append_placement(content)?;
                for token in tokens {
                    self.repoint(token, target, new);
                }
            }
        }
        Ok(())
    }

    /// Decides all vectors.
    pub(super) fn vectors(&mut self) -> Result<(), LowerError> {
        let all = self.vectors.take().map_err(|name| LowerError::Conflict { name })?;
        for of_one in all.chunk_by(|a, b| a.0 == b.0) {
            let target = of_one[0].0;
            let groups = group_equal(of_one);
            if groups.len() == 1 && self.is_covered(target, of_one.len()) {
                let vector = *groups[0].0;
                self.edit_real(target, "magnitude", vector.magnitude)?;
                self.request_direction(target, "orientation", vector.direction)?;
                continue;
            }
            for (vector, tokens) in groups {
                let new = self.append_vector(vector)?;
                for token in tokens {
                    self.repoint(token, target, new);
                }
            }
        }
        Ok(())
    }

    fn edit_placement(&mut self, target: InstanceName, content: &NewPlacement) -> Result<(), LowerError> {
        match content {
            NewPlacement::Space { old, new } => {
                self.request_location(target, Coordinates::Three(new.origin.coords.into()))?;
                self.request_axis(target, "axis", old.map(|f| f.z), new.z)?;
                self.request_axis(target, "ref_direction", old.map(|f| f.x), new.x)
            }
            NewPlacement::Axis { old, new } => {
                self.request_location(target, Coordinates::Three(new.origin.coords.into()))?;
                self.request_axis(target, "axis", old.map(|f| f.z), new.z)
            }
        }
    }

    fn request_location(&mut self, target: InstanceName, coordinates: Coordinates) -> Result<(), LowerError> {
        let (token, point) = self.reference(target, "location")?;
        self.points.add(point, token, coordinates);
        Ok(())
    }

    /// Requests an axis unless it is what the file already says, written or by default.
    fn request_axis(
        &mut self,
        target: InstanceName,
        attribute: &'static str,
        old: Option<Vector3<f64>>,
        new: Vector3<f64>,
    ) -> Result<(), LowerError> {
        if old.is_some_and(|old| (old - new).amax() <= SAME_DIRECTION) {
            return Ok(());
        }
        self.request_direction(target, attribute, Coordinates::Three(new.into()))
    }

    fn request_direction(
        &mut self,
        user: InstanceName,
        attribute: &'static str,
        ratios: Coordinates,
    ) -> Result<(), LowerError> {
        if let Some((token, target)) = self.optional_reference(user, attribute)? {
            if !self.points_along(target, ratios) {
                self.directions.add(target, token, ratios);
            }
            return Ok(());
        }
        let token = self.attribute_span(user, attribute)?;
        let new = self.append_direction(ratios.as_slice())?;
        self.edit(token, new.to_string());
        Ok(())
    }

    /// Whether a direction record, once normalised, is `ratios`.
    fn points_along(&self, target: InstanceName, ratios: Coordinates) -> bool {
        let Some(written) = self.reals(target, "direction_ratios") else { return false };
        let norm = written.iter().map(|c| c * c).sum::<f64>().sqrt();
        let wanted = ratios.as_slice();
        written.len() == wanted.len()
            && norm > 0.0
            && written.iter().zip(wanted).all(|(w, n)| (w / norm - n).abs() <= SAME_DIRECTION)
    }

    /// Appends a placement with its point and directions.
    pub(super) fn append_placement(&mut self, content: &NewPlacement) -> Result<InstanceName, LowerError> {
        match content {
            NewPlacement::Space { new, .. } => self.append_frame(new),
            NewPlacement::Axis { new, .. } => {
                let location = self.append_point(new.origin.coords.as_slice())?;
                let axis = self.append_direction(new.z.as_slice())?;
                self.append_referring("AXIS1_PLACEMENT", &[location, axis])
            }
        }
    }

    /// Appends an `AXIS2_PLACEMENT_3D`.
    pub(in crate::step) fn append_frame(&mut self, frame: &Frame) -> Result<InstanceName, LowerError> {
        let location = self.append_point(frame.origin.coords.as_slice())?;
        let axis = self.append_direction(frame.z.as_slice())?;
        let x = self.append_direction(frame.x.as_slice())?;
        self.append_referring("AXIS2_PLACEMENT_3D", &[location, axis, x])
    }

    /// Appends an `AXIS2_PLACEMENT_2D`.
    pub(super) fn append_frame2(
        &mut self,
        origin: &Point2<f64>,
        x: &Vector2<f64>,
    ) -> Result<InstanceName, LowerError> {
        let location = self.append_point(origin.coords.as_slice())?;
        let x = self.append_direction(x.as_slice())?;
        self.append_referring("AXIS2_PLACEMENT_2D", &[location, x])
    }

    /// Appends a `VECTOR`.
    pub(super) fn append_vector(&mut self, vector: &NewVector) -> Result<InstanceName, LowerError> {
        let direction = Value::Reference(self.append_direction(vector.direction.as_slice())?);
        let values = vec![Value::empty_name(), direction, Value::Real(vector.magnitude)];
        self.append(&Body::simple("VECTOR", values))
    }

    fn append_referring(
        &mut self,
        keyword: &'static str,
        references: &[InstanceName],
    ) -> Result<InstanceName, LowerError> {
        let references = references.iter().map(|&name| Value::Reference(name));
        let values = std::iter::once(Value::empty_name()).chain(references).collect();
        self.append(&Body::simple(keyword, values))
    }
}
