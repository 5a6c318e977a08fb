//! Solids, surface models and free curves (ISO 10303-42).

use super::super::exchange_structure::InstanceName;
use super::super::lower::LowerError;
use super::super::lower::compose::{Inherited, Value, parametric_context, verbatim};
use super::{FromModelError, Writer, list, logical, text, to};
use crate::brep::{
    BodyId, BodyKind, CoedgeId, CurveId, EdgeId, FaceId, LoopId, ShellId, SurfaceId, VertexId,
};
use crate::geometry::{Carried, Curve, Curve2d};
use crate::model::{Loss, Origin};

/// A record that new ones stand for, where there is none.
const NONE: InstanceName = InstanceName(0);

impl Writer<'_, '_> {
    /// Writes all bodies.
    pub(super) fn bodies(&mut self) -> Result<(), FromModelError> {
        for body in self.model.brep.bodies.ids() {
            if let Some(name) = self.body(body)? {
                self.bodies.insert(body, name);
            }
        }
        Ok(())
    }

    fn body(&mut self, body: BodyId) -> Result<Option<InstanceName>, FromModelError> {
        let brep = &self.model.brep;
        let name = text(&self.model.bodies[body].own.name);
        let shells = &brep.bodies[body].shells;
        let Some(&outer) = shells.first() else { return Ok(None) };
        let closed = shells.iter().all(|&shell| brep.shells[shell].closed);
        if brep.bodies[body].kind == BodyKind::Surface || !closed {
            if brep.bodies[body].kind == BodyKind::Solid {
                let message = "its shell is open; it is written as surfaces";
                Loss::OpenSolid.report(self.model.origins.bodies[body], message, self.sink);
            }
            let mut members = Vec::with_capacity(shells.len());
            for &shell in shells {
                members.push(self.shell(shell)?);
            }
            return self.add("SHELL_BASED_SURFACE_MODEL", vec![name, list(members)]).map(Some);
        }
        let bound = self.shell(outer)?;
        if shells.len() == 1 {
            return self.add("MANIFOLD_SOLID_BREP", vec![name, to(bound)]).map(Some);
        }
        let mut voids = Vec::with_capacity(shells.len() - 1);
        for &shell in &shells[1..] {
            let forward = brep.shells[shell].forward;
            let of = self.plain_shell(shell)?;
            voids.push(self.oriented("ORIENTED_CLOSED_SHELL", of, forward)?);
        }
        self.add("BREP_WITH_VOIDS", vec![name, to(bound), list(voids)]).map(Some)
    }

    fn shell(&mut self, shell: ShellId) -> Result<InstanceName, FromModelError> {
        let of = self.plain_shell(shell)?;
        let shell = &self.model.brep.shells[shell];
        if shell.forward {
            return Ok(of);
        }
        let keyword = if shell.closed { "ORIENTED_CLOSED_SHELL" } else { "ORIENTED_OPEN_SHELL" };
        self.oriented(keyword, of, false)
    }

    fn oriented(
        &mut self,
        keyword: &'static str,
        of: InstanceName,
        forward: bool,
    ) -> Result<InstanceName, FromModelError> {
        self.add(keyword, vec![text(""), verbatim("*"), to(of), logical(forward)])
    }

    fn plain_shell(&mut self, shell: ShellId) -> Result<InstanceName, FromModelError> {
        let shell = &self.model.brep.shells[shell];
        let mut faces = Vec::with_capacity(shell.faces.len());
        for &face in &shell.faces {
            let name = self.face(face)?;
            self.faces.insert(face, name);
            faces.push(name);
        }
        let keyword = if shell.closed { "CLOSED_SHELL" } else { "OPEN_SHELL" };
        self.add(keyword, vec![text(""), list(faces)])
    }

    fn face(&mut self, face: FaceId) -> Result<InstanceName, FromModelError> {
        let of = &self.model.brep.faces[face];
        let origin = self.model.origins.faces[face];
        if of.loops.is_empty() {
            return Err(FromModelError::Unbounded { origin });
        }
        let surface = self.surface(of.surface)?;
        let mut outer = of.loops.iter().copied().find(|&bound| self.model.brep.loops[bound].outer);
        let mut bounds = Vec::with_capacity(of.loops.len());
        for &bound in &of.loops {
            let keyword = if outer == Some(bound) { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
            outer = outer.filter(|&outer| outer != bound);
            bounds.push(self.bound(keyword, bound)?);
        }
        let name = text(&self.model.faces[face].name);
        self.add("ADVANCED_FACE", vec![name, list(bounds), to(surface), logical(of.same_sense)])
    }

    fn bound(&mut self, keyword: &'static str, bound: LoopId) -> Result<InstanceName, FromModelError> {
        let of = &self.model.brep.loops[bound];
        let around = match of.vertex.filter(|_| of.coedges.is_empty()) {
            Some(vertex) => {
                let vertex = self.vertex(vertex)?;
                self.add("VERTEX_LOOP", vec![text(""), to(vertex)])?
            }
            None => {
                let mut uses = Vec::with_capacity(of.coedges.len());
                for &coedge in &of.coedges {
                    let coedge = &self.model.brep.coedges[coedge];
                    let edge = self.edge(coedge.edge)?;
                    let [nothing, sense] = [verbatim("*"), logical(coedge.forward)];
                    let values = vec![text(""), nothing.clone(), nothing, to(edge), sense];
                    uses.push(self.add("ORIENTED_EDGE", values)?);
                }
                self.add("EDGE_LOOP", vec![text(""), list(uses)])?
            }
        };
        self.add(keyword, vec![text(""), to(around), logical(of.forward)])
    }

    fn vertex(&mut self, vertex: VertexId) -> Result<InstanceName, FromModelError> {
        if let Some(&known) = self.vertices.get(&vertex) {
            return Ok(known);
        }
        let point = self.lowering.append_point(self.model.brep.vertices[vertex].point.coords.as_slice())?;
        let name = self.add("VERTEX_POINT", vec![text(""), to(point)])?;
        self.vertices.insert(vertex, name);
        Ok(name)
    }

    fn edge(&mut self, edge: EdgeId) -> Result<InstanceName, FromModelError> {
        if let Some(&known) = self.edges.get(&edge) {
            return Ok(known);
        }
        let of = &self.model.brep.edges[edge];
        let [start, end] = [self.vertex(of.start)?, self.vertex(of.end)?];
        let curve = self.curve(of.curve, "")?;
        let pcurves = self.pcurves(edge)?;
        let geometry = if pcurves.is_empty() {
            curve
        } else {
            let master = verbatim(".CURVE_3D.");
            self.add("SURFACE_CURVE", vec![text(""), to(curve), list(pcurves), master])?
        };
        let values = vec![text(""), to(start), to(end), to(geometry), logical(of.same_sense)];
        let name = self.add("EDGE_CURVE", values)?;
        self.edges.insert(edge, name);
        Ok(name)
    }

    /// Curves of an edge in the parameters of its faces, two at most. A seam gets none: which of the two is whose is
    /// better found anew than told wrongly.
    fn pcurves(&mut self, edge: EdgeId) -> Result<Vec<InstanceName>, FromModelError> {
        let brep = &self.model.brep;
        let uses = self.uses[edge].clone();
        let face_of = |coedge: &CoedgeId| brep.loops[brep.coedges[*coedge].in_loop].face;
        let mut faces: Vec<FaceId> = uses.iter().map(face_of).collect();
        faces.sort_unstable();
        faces.dedup();
        if faces.len() != uses.len() || uses.len() > 2 {
            return Ok(Vec::new());
        }
        let mut found = Vec::new();
        for coedge in uses {
            let Some(curve) = brep.coedges[coedge].pcurve.as_ref().filter(|curve| is_written(curve)) else {
                continue;
            };
            let surface = self.surface(brep.faces[face_of(&coedge)].surface)?;
            let curve = self.lowering.append_curve2d(NONE, curve, &Inherited::nothing())?;
            let context = match self.parameters {
                Some(context) => context,
                None => *self.parameters.insert(self.lowering.append(&parametric_context())?),
            };
            let values = vec![text(""), list([curve]), to(context)];
            let representation = self.add("DEFINITIONAL_REPRESENTATION", values)?;
            found.push(self.add("PCURVE", vec![text(""), to(surface), to(representation)])?);
        }
        Ok(found)
    }

    fn surface(&mut self, surface: SurfaceId) -> Result<InstanceName, FromModelError> {
        if let Some(&known) = self.surfaces.get(&surface) {
            return Ok(known);
        }
        let origin = self.model.origins.surfaces[surface];
        let read = read(&self.model.brep.surfaces[surface], origin)?;
        let body = self.lowering.surface_body(NONE, read, 1.0, &Inherited::nothing());
        let body = body.map_err(|error| at(error, origin))?;
        let name = self.lowering.append(&body)?;
        self.surfaces.insert(surface, name);
        Ok(name)
    }

    fn curve(&mut self, curve: CurveId, name: &str) -> Result<InstanceName, FromModelError> {
        if let Some(&known) = self.curves.get(&curve) {
            return Ok(known);
        }
        let origin = self.model.origins.curves[curve];
        let read: &Curve = read(&self.model.brep.curves[curve], origin)?;
        let inherited = Inherited { name: super::string::encode(name), ..Inherited::nothing() };
        let name = self.lowering.append_curve(NONE, read, &inherited).map_err(|error| at(error, origin))?;
        self.curves.insert(curve, name);
        Ok(name)
    }

    /// The set of all free curves; none where there are none.
    pub(super) fn free_curves(&mut self) -> Result<Option<InstanceName>, FromModelError> {
        let mut members = Vec::with_capacity(self.model.free_curves.len());
        for (&curve, name) in self.model.free_curves.iter().zip(&self.model.free_curve_names) {
            members.push(self.curve(curve, name)?);
        }
        if members.is_empty() {
            return Ok(None);
        }
        self.add("GEOMETRIC_CURVE_SET", vec![text(""), list(members)]).map(Some)
    }
}

/// Whether a curve in parameters has an entity that says all of it.
fn is_written(curve: &Curve2d) -> bool {
    match curve {
        Curve2d::Line { .. } | Curve2d::Nurbs(_) => true,
        Curve2d::Ellipse { x, y, .. } => x.perp(y) > 0.0,
        _ => false,
    }
}

fn read<T>(carried: &Carried<T>, origin: Origin) -> Result<&T, FromModelError> {
    match carried {
        Carried::Read(geometry) => Ok(geometry),
        Carried::Unread { reason, .. } => Err(FromModelError::Unread { origin, reason: reason.clone() }),
    }
}

/// The error of an element, by its own name.
fn at(error: LowerError, origin: Origin) -> FromModelError {
    match error {
        LowerError::Unwritable { kind, .. } => FromModelError::Unwritable { origin, kind },
        other => other.into(),
    }
}

/// What a representation is called by what it holds.
pub(super) fn representation_kind(items: &[Value], solids: usize, surfaces: usize) -> &'static str {
    let only = |count: usize| count > 0 && count + 1 == items.len();
    if only(solids) {
        "ADVANCED_BREP_SHAPE_REPRESENTATION"
    } else if only(surfaces) {
        "MANIFOLD_SURFACE_SHAPE_REPRESENTATION"
    } else {
        "SHAPE_REPRESENTATION"
    }
}
