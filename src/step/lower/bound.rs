//! New bounds of faces: holes with vertices, edges and curves in parameters of their own.

use super::super::exchange_structure::InstanceName;
use super::compose::{self, Body, Inherited, Value};
use super::{LowerError, Lowering};
use crate::brep::FaceId;
use crate::model::ChangeSet;
use crate::model::change_set::{NewBound, NewEdge};
use crate::source::Span;

fn verbatim(text: &str) -> Value {
    Value::Verbatim(text.to_owned())
}

impl Lowering<'_> {
    /// Appends the new bounds and adds them to their faces. The surfaces must be decided already.
    pub(super) fn bounds(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&face, bounds) in &changes.bounds {
            let mut names = Vec::new();
            for bound in bounds {
                names.push(self.append_bound(face, bound)?);
            }
            let user = super::instance_name(self.model.origins.faces[face])?;
            let list = self.attribute_span(user, "bounds")?;
            // Before the list's closing parenthesis.
            let end = list.end - 1;
            let text: String = names.iter().map(|name| format!(",{name}")).collect();
            self.edit(Span { start: end, end }, text);
        }
        Ok(())
    }

    fn append_bound(&mut self, face: FaceId, bound: &NewBound) -> Result<InstanceName, LowerError> {
        let surface = match self.own_surfaces.get(&face) {
            Some(name) => *name,
            None => super::instance_name(self.model.origins.surfaces[self.model.brep.faces[face].surface])?,
        };
        let mut vertices = Vec::new();
        for edge in &bound.edges {
            let point = self.append_point(edge.start.coords.as_slice())?;
            let body = Body::simple("VERTEX_POINT", vec![Value::empty_name(), Value::Reference(point)]);
            vertices.push(self.append(&body)?);
        }
        let mut uses = Vec::new();
        for (k, edge) in bound.edges.iter().enumerate() {
            let ends = [vertices[k], vertices[(k + 1) % vertices.len()]];
            let curve = self.append_edge(face, surface, edge, ends)?;
            let sense = verbatim(if bound.forward { ".T." } else { ".F." });
            let any = || verbatim("*");
            let values = vec![Value::empty_name(), any(), any(), Value::Reference(curve), sense];
            uses.push(Value::Reference(self.append(&Body::simple("ORIENTED_EDGE", values))?));
        }
        if !bound.forward {
            uses.reverse();
        }
        let around = self.append(&Body::simple("EDGE_LOOP", vec![Value::empty_name(), Value::List(uses)]))?;
        let values = vec![Value::empty_name(), Value::Reference(around), verbatim(".T.")];
        self.append(&Body::simple("FACE_BOUND", values))
    }

    fn append_edge(
        &mut self,
        face: FaceId,
        surface: InstanceName,
        edge: &NewEdge,
        [start, end]: [InstanceName; 2],
    ) -> Result<InstanceName, LowerError> {
        let old = super::instance_name(self.model.origins.faces[face])?;
        let space = self.append_curve(old, &edge.curve, &Inherited::nothing())?;
        let flat = self.append_curve2d(old, &edge.pcurve, &Inherited::nothing())?;
        let context = self.append(&compose::parametric_context())?;
        let values =
            vec![Value::empty_name(), Value::List(vec![Value::Reference(flat)]), Value::Reference(context)];
        let holder = self.append(&Body::simple("DEFINITIONAL_REPRESENTATION", values))?;
        let values = vec![Value::empty_name(), Value::Reference(surface), Value::Reference(holder)];
        let pcurve = self.append(&Body::simple("PCURVE", values))?;
        let values = vec![
            Value::empty_name(),
            Value::Reference(space),
            Value::List(vec![Value::Reference(pcurve)]),
            verbatim(".CURVE_3D."),
        ];
        let curve = self.append(&Body::simple("SURFACE_CURVE", values))?;
        let ends = [start, end].map(Value::Reference);
        let values =
            [vec![Value::empty_name()], ends.to_vec(), vec![Value::Reference(curve), verbatim(".T.")]];
        self.append(&Body::simple("EDGE_CURVE", values.concat()))
    }
}
