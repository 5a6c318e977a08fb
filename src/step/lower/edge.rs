//! New vertices and edges: each with its curve in space and one curve in parameters for each face that uses it.

use super::super::exchange_structure::InstanceName;
use super::compose::{self, Body, Inherited, Value, verbatim};
use super::{LowerError, Lowering};
use crate::brep::{Arena, FaceId};
use crate::geometry::{Curve, Curve2d};
use crate::model::ChangeSet;
use crate::model::change_set::{EdgeCurve, EdgeRef, NewBound, NewEdge, NewEdgeId, NewVertexId, VertexRef};

/// A face that gets a new bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'a> {
    /// Which face it is.
    pub(super) owner: Owner,
    /// Record of its surface.
    pub(super) surface: InstanceName,
    /// A face of the model in whose context it is written.
    pub(super) face: FaceId,
    /// Its surface; `None` when it was not read.
    pub(super) geometry: Option<&'a crate::geometry::Surface>,
}

/// A face of the model by its id, or a new one by its place in the change set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    Old(FaceId),
    New(usize),
}

/// The use of a new edge that has a curve in the parameters of a face.
#[derive(Debug)]
pub(super) struct PcurveUse<'a> {
    ground: Ground<'a>,
    curve: &'a Curve2d,
    forward: bool,
}

/// Curves in parameters for each new edge, in the order of their uses.
pub(super) type PcurveUses<'a> = Arena<NewEdgeId, Vec<PcurveUse<'a>>>;

/// Adds what the bounds of one face say.
pub(super) fn gather<'a>(uses: &mut PcurveUses<'a>, ground: Ground<'a>, bounds: &'a [NewBound]) {
    for coedge in bounds.iter().flat_map(|bound| &bound.coedges) {
        if let (EdgeRef::New(edge), Some(curve)) = (coedge.edge, &coedge.pcurve) {
            uses[edge].push(PcurveUse { ground, curve, forward: coedge.forward });
        }
    }
}

impl Lowering<'_> {
    /// Appends the new vertices.
    pub(super) fn new_vertices(
        &mut self,
        changes: &ChangeSet,
    ) -> Result<Arena<NewVertexId, InstanceName>, LowerError> {
        let mut names = Arena::default();
        for (_, point) in changes.new_vertices.iter() {
            let point = self.append_point(point.coords.as_slice())?;
            let body = Body::simple("VERTEX_POINT", vec![Value::empty_name(), Value::Reference(point)]);
            names.push(self.append(&body)?);
        }
        Ok(names)
    }

    /// Appends the new edges, with their curves.
    pub(super) fn new_edges(
        &mut self,
        changes: &ChangeSet,
        uses: &PcurveUses<'_>,
    ) -> Result<Arena<NewEdgeId, InstanceName>, LowerError> {
        let vertices = self.new_vertices(changes)?;
        let mut names = Arena::default();
        for (id, edge) in changes.new_edges.iter() {
            let mut ends = Vec::new();
            for end in [edge.start, edge.end] {
                ends.push(Value::Reference(match end {
                    VertexRef::New(vertex) => vertices[vertex],
                    VertexRef::Kept(vertex) => self.used(self.model.origins.vertices[vertex])?,
                }));
            }
            let (curve, sense) = self.edge_curve(edge, &uses[id])?;
            let values = [vec![Value::empty_name()], ends, vec![Value::Reference(curve), sense]].concat();
            names.push(self.append(&Body::simple("EDGE_CURVE", values))?);
        }
        Ok(names)
    }

    /// Record of an edge's curve, and whether the edge runs as it does.
    fn edge_curve(
        &mut self,
        edge: &NewEdge,
        uses: &[PcurveUse<'_>],
    ) -> Result<(InstanceName, Value), LowerError> {
        match &edge.curve {
            EdgeCurve::Own(curve) => Ok((self.surface_curve(curve, uses)?, verbatim(".T."))),
            EdgeCurve::Of(old) => {
                let name = super::instance_name(self.model.origins.edges[*old])?;
                let (_, curve) = self.reference(name, "edge_geometry")?;
                self.gain(curve);
                let sense = self.model.brep.edges[*old].same_sense;
                Ok((curve, verbatim(if sense { ".T." } else { ".F." })))
            }
        }
    }

    /// Appends a curve with its curves in parameters; a seam when one face uses it on both sides.
    fn surface_curve(&mut self, curve: &Curve, uses: &[PcurveUse<'_>]) -> Result<InstanceName, LowerError> {
        let Some(first) = uses.first() else {
            return Err(LowerError::NoFaceOfEdge);
        };
        let old = super::instance_name(self.model.origins.faces[first.ground.face])?;
        let space = self.append_curve(old, curve, &Inherited::nothing())?;
        let seam = matches!(uses, [a, b] if a.ground.owner == b.ground.owner);
        let mut order: Vec<&PcurveUse<'_>> = uses.iter().collect();
        if seam {
            // The first belongs to the use along the edge (ISO 10303-42, `seam_curve`).
            order.sort_by_key(|one| !one.forward);
        }
        let mut pcurves = Vec::new();
        for one in order {
            pcurves.push(Value::Reference(self.pcurve(one)?));
        }
        let keyword = if seam { "SEAM_CURVE" } else { "SURFACE_CURVE" };
        let space = Value::Reference(space);
        let values = vec![Value::empty_name(), space, Value::List(pcurves), verbatim(".CURVE_3D.")];
        self.append(&Body::simple(keyword, values))
    }

    fn pcurve(&mut self, one: &PcurveUse<'_>) -> Result<InstanceName, LowerError> {
        let old = super::instance_name(self.model.origins.faces[one.ground.face])?;
        let unit = self.parameters_in_file(one.ground.face, one.ground.geometry);
        let curve = super::curve::in_file(one.curve, &unit, old)?;
        let flat = self.append_curve2d(old, &curve, &Inherited::nothing())?;
        let context = self.append(&compose::parametric_context())?;
        let values =
            vec![Value::empty_name(), Value::List(vec![Value::Reference(flat)]), Value::Reference(context)];
        let holder = self.append(&Body::simple("DEFINITIONAL_REPRESENTATION", values))?;
        let values =
            vec![Value::empty_name(), Value::Reference(one.ground.surface), Value::Reference(holder)];
        self.append(&Body::simple("PCURVE", values))
    }
}
