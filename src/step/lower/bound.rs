//! Bounds that faces of the model get and lose.

use super::super::exchange_structure::InstanceName;
use super::compose::{Body, Value, verbatim};
use super::{LowerError, Lowering};
use crate::brep::{Arena, FaceId};
use crate::model::ChangeSet;
use crate::model::change_set::{EdgeRef, NewBound, NewCoedge, NewEdgeId};

impl Lowering<'_> {
    /// Adds the new bounds of faces of the model and takes away those that go.
    pub(super) fn bounds_of_old_faces(
        &mut self,
        changes: &ChangeSet,
        edges: &Arena<NewEdgeId, InstanceName>,
    ) -> Result<(), LowerError> {
        for (&face, bounds) in &changes.new_bounds {
            let user = super::instance_name(self.model.origins.faces[face])?;
            let (position, list) = self.list(user, "bounds")?;
            // In a turned face bounds count reversed.
            let sense = self.is_turned(face, user)?;
            for bound in bounds {
                let name = self.append_bound(bound, sense, edges)?;
                self.lists.add(position, list, name);
            }
        }
        for &bound in &changes.removed_bounds {
            let name = super::instance_name(self.model.origins.loops[bound])?;
            let user = super::instance_name(self.model.origins.faces[self.model.brep.loops[bound].face])?;
            self.leave(user, name)?;
        }
        Ok(())
    }

    /// Whether the face stands in an oriented face that turns it.
    fn is_turned(&self, face: FaceId, name: InstanceName) -> Result<bool, LowerError> {
        let written = self.attribute(name, "same_sense")?.as_bool();
        let written = written.ok_or(LowerError::Attribute { name, attribute: "same_sense" })?;
        Ok(written != self.model.brep.faces[face].same_sense)
    }

    /// Appends a bound; `turned` writes it to count reversed.
    pub(super) fn append_bound(
        &mut self,
        bound: &NewBound,
        turned: bool,
        edges: &Arena<NewEdgeId, InstanceName>,
    ) -> Result<InstanceName, LowerError> {
        let mut uses = Vec::new();
        for coedge in &bound.coedges {
            uses.push(Value::Reference(self.oriented_edge(coedge, edges)?));
        }
        let around = self.append(&Body::simple("EDGE_LOOP", vec![Value::empty_name(), Value::List(uses)]))?;
        let sense = verbatim(if turned { ".F." } else { ".T." });
        let keyword = if bound.outer { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
        self.append(&Body::simple(keyword, vec![Value::empty_name(), Value::Reference(around), sense]))
    }

    fn oriented_edge(
        &mut self,
        coedge: &NewCoedge,
        edges: &Arena<NewEdgeId, InstanceName>,
    ) -> Result<InstanceName, LowerError> {
        let edge = match coedge.edge {
            EdgeRef::New(edge) => edges[edge],
            EdgeRef::Kept(edge) => self.used(self.model.origins.edges[edge])?,
        };
        let sense = verbatim(if coedge.forward { ".T." } else { ".F." });
        let any = || verbatim("*");
        let values = vec![Value::empty_name(), any(), any(), Value::Reference(edge), sense];
        self.append(&Body::simple("ORIENTED_EDGE", values))
    }
}
