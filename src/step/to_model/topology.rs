//! Vertices, edges, loops, faces and shells: ISO 10303-42 chapter 5.
//!
//! Each record gives one element, however many others share it. An element that cannot be built keeps
//! its place where it can: a face with a broken bound stays, but counts as unread.

use std::collections::{HashMap, HashSet};

use super::code::ModelCode;
use super::curve::{self, Trims};
use super::curve2d;
use super::error::ReadError;
use super::placement::point3;
use super::scope::{Scope, entity_name};
use super::surface;
use crate::brep::{
    Arena, BodyId, Brep, Coedge, CoedgeId, CurveId, Edge, EdgeId, Face, FaceId, Loop, LoopId, Shell, ShellId,
    SurfaceId, Vertex, VertexId,
};
use crate::diagnostic::Sink;
use crate::geometry::{Carried, Curve, Surface};
use crate::math::Point3;
use crate::model::{Attributes, Origin, Origins};
use crate::step::entity::Entity;
use crate::step::view::{EntityView, boolean, list, reference};
use crate::step::{InstanceName, Parameters};

/// Oriented elements around oriented elements that are followed before the chain counts as a cycle.
const MAX_NESTED_ORIENTATIONS: usize = 64;

/// The model's topology while it grows.
pub(super) struct Builder<'a, 's> {
    pub(super) scope: Scope<'a>,
    pub(super) sink: &'s mut dyn Sink,
    pub(super) brep: Brep,
    pub(super) origins: Origins,
    pub(super) faces: Arena<FaceId, Attributes>,
    vertices: HashMap<InstanceName, Result<VertexId, ReadError>>,
    edges: HashMap<InstanceName, Result<EdgeId, ReadError>>,
    curves: HashMap<InstanceName, CurveId>,
    surfaces: HashMap<InstanceName, SurfaceId>,
    /// Basis surface and record of the parameter-space curves of an edge.
    pcurves: HashMap<EdgeId, Vec<(InstanceName, InstanceName)>>,
    /// Edges between the points of poly loops, by the smaller and the greater vertex.
    straight: HashMap<(VertexId, VertexId), EdgeId>,
    pub(super) shells: HashMap<InstanceName, ShellId>,
}

fn origin(name: InstanceName) -> Origin {
    Origin::Instance(name.0)
}

impl<'a, 's> Builder<'a, 's> {
    pub(super) fn new(scope: Scope<'a>, sink: &'s mut dyn Sink) -> Self {
        Self {
            scope,
            sink,
            brep: Brep::default(),
            origins: Origins::default(),
            faces: Arena::default(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            curves: HashMap::new(),
            surfaces: HashMap::new(),
            pcurves: HashMap::new(),
            straight: HashMap::new(),
            shells: HashMap::new(),
        }
    }

    pub(super) fn report(&mut self, code: ModelCode, name: InstanceName, message: String) {
        self.sink.report(code.at(self.scope.file, name, message));
    }

    /// Reports at the geometry, or at its user when the geometry's record does not exist.
    fn report_geometry(&mut self, name: InstanceName, user: InstanceName, error: &ReadError) {
        let at = if self.scope.file.instance(name).is_some() { name } else { user };
        let entity = self.entity_name(at);
        self.report(error.geometry_code(), at, format!("{entity}: {error}"));
    }

    fn report_topology(&mut self, name: InstanceName, error: &ReadError) {
        let message = match self.entity_name(name) {
            entity if entity.is_empty() => error.to_string(),
            entity => format!("{entity}: {error}"),
        };
        self.report(error.topology_code(), name, message);
    }

    fn entity_name(&self, name: InstanceName) -> String {
        self.scope.file.instance(name).map(entity_name).unwrap_or_default()
    }

    /// The curve of a record that is no surface curve; read once.
    pub(super) fn curve(&mut self, name: InstanceName, user: InstanceName) -> CurveId {
        if let Some(&id) = self.curves.get(&name) {
            return id;
        }
        let curve = match curve::read(self.scope, name) {
            Ok(curve) => Carried::Read(curve),
            Err(error) => {
                let entity = self.entity_name(name);
                self.report_geometry(name, user, &error);
                Carried::Unread { entity, reason: error.to_string() }
            }
        };
        self.origins.curves.push(origin(name));
        let id = self.brep.curves.push(curve);
        self.curves.insert(name, id);
        id
    }

    fn surface(&mut self, name: InstanceName, user: InstanceName) -> SurfaceId {
        if let Some(&id) = self.surfaces.get(&name) {
            return id;
        }
        let surface = match surface::read(self.scope, name) {
            Ok(surface) => Carried::Read(surface),
            Err(error) => {
                let entity = self.entity_name(name);
                self.report_geometry(name, user, &error);
                Carried::Unread { entity, reason: error.to_string() }
            }
        };
        let id = self.push_surface(name, surface);
        self.surfaces.insert(name, id);
        id
    }

    fn push_surface(&mut self, name: InstanceName, surface: Carried<Surface>) -> SurfaceId {
        self.origins.surfaces.push(origin(name));
        self.brep.surfaces.push(surface)
    }

    fn vertex(&mut self, name: InstanceName) -> Result<VertexId, ReadError> {
        if let Some(known) = self.vertices.get(&name) {
            return known.clone();
        }
        let point = || {
            let view = self.scope.view_of(name, Entity::VertexPoint)?;
            point3(self.scope, view.reference("vertex_geometry")?)
        };
        let vertex = point().map(|point| self.push_vertex(name, point));
        self.vertices.insert(name, vertex.clone());
        vertex
    }

    fn push_vertex(&mut self, name: InstanceName, point: Point3<f64>) -> VertexId {
        self.origins.vertices.push(origin(name));
        self.brep.vertices.push(Vertex { point })
    }

    fn edge(&mut self, name: InstanceName) -> Result<EdgeId, ReadError> {
        if let Some(known) = self.edges.get(&name) {
            return known.clone();
        }
        let edge = self.read_edge(name);
        self.edges.insert(name, edge.clone());
        edge
    }

    fn read_edge(&mut self, name: InstanceName) -> Result<EdgeId, ReadError> {
        let view = self.scope.view_of(name, Entity::Edge)?;
        let [start, end] = view.fields(["edge_start", "edge_end"]);
        let start = self.vertex(reference(start, "edge_start")?)?;
        let end = self.vertex(reference(end, "edge_end")?)?;
        let [geometry, same_sense] = self.edge_curve(view)?.fields(["edge_geometry", "same_sense"]);
        let (curve_name, around) =
            curve::resolve(self.scope, reference(geometry, "edge_geometry")?, Trims::Follow)?;
        let same_sense = boolean(same_sense, "same_sense")?;
        let curve = self.curve(curve_name, name);
        self.origins.edges.push(origin(name));
        let id = self.brep.edges.push(Edge { curve, start, end, same_sense });
        if let Some(surface_curve) = around {
            let pcurves = self.pcurves_of(&surface_curve);
            if !pcurves.is_empty() {
                self.pcurves.insert(id, pcurves);
            }
        }
        Ok(id)
    }

    /// The edge curve of an edge: itself, or the parent of a subedge.
    fn edge_curve(&self, edge: EntityView<'a>) -> Result<EntityView<'a>, ReadError> {
        let mut view = edge;
        for _ in 0..MAX_NESTED_ORIENTATIONS {
            if view.is(Entity::EdgeCurve) {
                return Ok(view);
            }
            if !view.is(Entity::Subedge) {
                let found = view.entity().name().to_owned();
                return Err(ReadError::WrongEntity { name: view.name(), found, expected: "EDGE_CURVE" });
            }
            view = self.scope.view_of(view.reference("parent_edge")?, Entity::Edge)?;
        }
        Err(ReadError::Cycle(edge.name()))
    }

    fn pcurves_of(&self, surface_curve: &EntityView<'a>) -> Vec<(InstanceName, InstanceName)> {
        let Ok(members) = surface_curve.references("associated_geometry") else { return Vec::new() };
        members
            .filter_map(|member| {
                let view = self.scope.view_of(member, Entity::Pcurve).ok()?;
                Some((view.reference("basis_surface").ok()?, member))
            })
            .collect()
    }

    /// The edge of an oriented edge and whether it is used from start to end.
    fn oriented_edge(&mut self, name: InstanceName) -> Result<(EdgeId, bool), ReadError> {
        let mut current = name;
        let mut forward = true;
        for _ in 0..MAX_NESTED_ORIENTATIONS {
            if self.edges.contains_key(&current) {
                return Ok((self.edge(current)?, forward));
            }
            let view = self.scope.view_of(current, Entity::Edge)?;
            if !view.is(Entity::OrientedEdge) {
                return Ok((self.edge(current)?, forward));
            }
            let [element, orientation] = view.fields(["edge_element", "orientation"]);
            forward = forward == boolean(orientation, "orientation")?;
            current = reference(element, "edge_element")?;
        }
        Err(ReadError::Cycle(name))
    }

    /// Reads one bound of a face. Nothing of a bound with an error is kept but its edges and vertices.
    fn bound(&mut self, name: InstanceName, face: FaceId, on: &FaceSurface) -> Result<LoopId, ReadError> {
        let view = self.scope.view_of(name, Entity::FaceBound)?;
        let [bound, orientation] = view.fields(["bound", "orientation"]);
        let forward = boolean(orientation, "orientation")?;
        let outer = view.is(Entity::FaceOuterBound);
        let path = self.scope.view_of(reference(bound, "bound")?, Entity::Loop)?;
        let mut vertex = None;
        let uses = match path.entity() {
            Entity::VertexLoop => {
                vertex = Some(self.vertex(path.reference("loop_vertex")?)?);
                Vec::new()
            }
            Entity::PolyLoop => self.poly_loop(&path)?,
            _ => self.edge_loop(&path)?,
        };
        let in_loop = self.brep.loops.next_id();
        let coedges = uses.into_iter().map(|edge_use| self.coedge(edge_use, in_loop, on)).collect();
        self.origins.loops.push(origin(name));
        Ok(self.brep.loops.push(Loop { face, outer, forward, coedges, vertex }))
    }

    fn edge_loop(&mut self, path: &EntityView<'a>) -> Result<Vec<EdgeUse>, ReadError> {
        let mut uses = Vec::new();
        for name in path.references("edge_list")? {
            let (edge, forward) = self.oriented_edge(name)?;
            uses.push(EdgeUse { name, edge, forward });
        }
        if uses.is_empty() {
            return Err(ReadError::Empty { attribute: "edge_list" });
        }
        Ok(uses)
    }

    fn coedge(&mut self, edge_use: EdgeUse, in_loop: LoopId, on: &FaceSurface) -> CoedgeId {
        let EdgeUse { name, edge, forward } = edge_use;
        let record = self.pcurve_record(edge, forward, on.name);
        let mut pcurve = None;
        if let (Some(record), Some(scale)) = (record, on.scale) {
            match curve2d::read(self.scope, record, scale) {
                Ok(curve) => pcurve = Some(curve),
                Err(error) => self.report(ModelCode::BadPcurve, record, format!("PCURVE: {error}")),
            }
        }
        self.origins.coedges.push(origin(name));
        self.origins.pcurves.push(pcurve.as_ref().and(record).map(origin));
        self.brep.coedges.push(Coedge { edge, in_loop, forward, pcurve })
    }

    /// The parameter-space curve of a coedge: the one on the face's surface; of a seam's two the first for
    /// the forward use.
    fn pcurve_record(&self, edge: EdgeId, forward: bool, surface: InstanceName) -> Option<InstanceName> {
        let mut on_surface = self.pcurves.get(&edge)?.iter().filter(|(basis, _)| *basis == surface);
        let first = on_surface.next()?.1;
        let second = on_surface.next().map(|(_, record)| *record);
        Some(if forward { first } else { second.unwrap_or(first) })
    }

    /// Straight edges between the points of a poly loop, shared with its neighbours.
    fn poly_loop(&mut self, path: &EntityView<'a>) -> Result<Vec<EdgeUse>, ReadError> {
        let mut corners = Vec::new();
        for point in path.references("polygon")? {
            let vertex = match self.vertices.get(&point) {
                Some(known) => known.clone()?,
                None => {
                    let at = point3(self.scope, point)?;
                    let vertex = self.push_vertex(point, at);
                    self.vertices.insert(point, Ok(vertex));
                    vertex
                }
            };
            corners.push(vertex);
        }
        if corners.is_empty() {
            return Err(ReadError::Empty { attribute: "polygon" });
        }
        let mut uses = Vec::with_capacity(corners.len());
        for (index, &start) in corners.iter().enumerate() {
            let end = corners[(index + 1) % corners.len()];
            let key = (start.min(end), start.max(end));
            let edge = match self.straight.get(&key) {
                Some(&edge) => edge,
                None => self.straight_edge(path.name(), key)?,
            };
            uses.push(EdgeUse { name: path.name(), edge, forward: start == key.0 });
        }
        Ok(uses)
    }

    fn straight_edge(
        &mut self,
        path: InstanceName,
        (start, end): (VertexId, VertexId),
    ) -> Result<EdgeId, ReadError> {
        let from = self.brep.vertices[start].point;
        let direction = self.brep.vertices[end].point - from;
        if direction.norm() == 0.0 {
            return Err(ReadError::ZeroDirection(path));
        }
        self.origins.curves.push(origin(path));
        let curve = self.brep.curves.push(Carried::Read(Curve::Line { origin: from, direction }));
        self.origins.edges.push(origin(path));
        let edge = self.brep.edges.push(Edge { curve, start, end, same_sense: true });
        self.straight.insert((start, end), edge);
        Ok(edge)
    }

    /// Reads one face of a shell; `None`, and a diagnostic, when the record is no face at all.
    fn face(&mut self, name: InstanceName, shell: ShellId) -> Option<FaceId> {
        let record = match self.face_record(name) {
            Ok(record) => record,
            Err(error) => {
                self.report_topology(name, &error);
                return None;
            }
        };
        let surface = self.surface(record.geometry, record.view.name());
        let read = self.brep.surfaces[surface].read();
        let scale = read.map(|surface| curve2d::parameter_scale(surface, self.scope.radians));
        let on = FaceSurface { name: record.geometry, scale };
        let face = self.brep.faces.next_id();
        let (loops, broken) = self.bounds(&record, face, &on);
        let surface = match broken {
            Some(reason) => {
                let entity = self.entity_name(record.geometry);
                self.push_surface(record.geometry, Carried::Unread { entity, reason })
            }
            None => surface,
        };
        let text = record.view.text("name").into_owned();
        self.faces.push(Attributes { name: text, ..Attributes::default() });
        self.origins.faces.push(origin(record.view.name()));
        Some(self.brep.faces.push(Face { surface, same_sense: record.same_sense, loops, shell }))
    }

    fn face_record(&self, name: InstanceName) -> Result<FaceRecord<'a>, ReadError> {
        let (view, forward) = self.underlying_face(name)?;
        let [bounds, geometry, same_sense] = view.fields(["bounds", "face_geometry", "same_sense"]);
        let bounds = list(bounds, "bounds")?;
        let geometry = reference(geometry, "face_geometry")?;
        let same_sense = boolean(same_sense, "same_sense")? == forward;
        Ok(FaceRecord { view, bounds, geometry, same_sense, forward })
    }

    /// Loops of a face, and why one of its bounds cannot be built.
    fn bounds(
        &mut self,
        record: &FaceRecord<'a>,
        face: FaceId,
        on: &FaceSurface,
    ) -> (Vec<LoopId>, Option<String>) {
        let mut loops = Vec::new();
        let mut broken = None;
        for bound in record.bounds.clone().filter_map(|member| member.as_reference()) {
            match self.bound(bound, face, on) {
                Ok(bound) => {
                    self.brep.loops[bound].forward ^= !record.forward;
                    loops.push(bound);
                }
                Err(error) => {
                    self.report_topology(bound, &error);
                    broken.get_or_insert_with(|| format!("bound {bound} cannot be built: {error}"));
                }
            }
        }
        (loops, broken)
    }

    /// The face inside oriented faces, and whether it keeps its sense.
    fn underlying_face(&self, name: InstanceName) -> Result<(EntityView<'a>, bool), ReadError> {
        let mut current = name;
        let mut forward = true;
        for _ in 0..MAX_NESTED_ORIENTATIONS {
            let view = self.scope.view_of(current, Entity::Face)?;
            if !view.is(Entity::OrientedFace) {
                return Ok((view, forward));
            }
            forward = forward == view.boolean("orientation")?;
            current = view.reference("face_element")?;
        }
        Err(ReadError::Cycle(name))
    }

    /// Reads a shell of a body; `None`, and a diagnostic, when the record is none or another body has it.
    pub(super) fn shell(&mut self, name: InstanceName, body: BodyId) -> Option<ShellId> {
        let (view, forward) = match self.underlying_shell(name) {
            Ok(found) => found,
            Err(error) => {
                self.report_topology(name, &error);
                return None;
            }
        };
        if self.shells.contains_key(&view.name()) {
            let message = "another body, or the same one, holds this shell already".to_owned();
            self.report(ModelCode::SharedShell, view.name(), message);
            return None;
        }
        let closed = view.is(Entity::ClosedShell);
        self.origins.shells.push(origin(view.name()));
        let id = self.brep.shells.push(Shell { faces: Vec::new(), closed, forward, body });
        self.shells.insert(view.name(), id);
        match view.references("cfs_faces") {
            Ok(members) => {
                let mut listed = HashSet::new();
                for member in members {
                    if listed.insert(member) {
                        let face = self.face(member, id);
                        self.brep.shells[id].faces.extend(face);
                    } else {
                        let message = format!("lists the face {member} more than once; it counts once");
                        self.report(ModelCode::RepeatedFace, view.name(), message);
                    }
                }
            }
            Err(error) => self.report_topology(view.name(), &error.into()),
        }
        Some(id)
    }

    /// The face set inside oriented shells, and whether its faces count as they are.
    fn underlying_shell(&self, name: InstanceName) -> Result<(EntityView<'a>, bool), ReadError> {
        let mut current = name;
        let mut forward = true;
        for _ in 0..MAX_NESTED_ORIENTATIONS {
            let view = self.scope.view_of(current, Entity::ConnectedFaceSet)?;
            let element = match view.entity() {
                Entity::OrientedClosedShell => "closed_shell_element",
                Entity::OrientedOpenShell => "open_shell_element",
                _ => return Ok((view, forward)),
            };
            forward = forward == view.boolean("orientation")?;
            current = view.reference(element)?;
        }
        Err(ReadError::Cycle(name))
    }
}

/// What a face says of itself.
struct FaceRecord<'a> {
    view: EntityView<'a>,
    bounds: Parameters<'a>,
    geometry: InstanceName,
    /// With the orientation of the oriented faces around it.
    same_sense: bool,
    /// Whether the oriented faces around it leave it as it is.
    forward: bool,
}

/// The surface of the face that is being built.
struct FaceSurface {
    name: InstanceName,
    /// Model parameters per file parameter; `None` when the surface was not read.
    scale: Option<[f64; 2]>,
}

/// An edge as a loop uses it, and the record that says so.
struct EdgeUse {
    name: InstanceName,
    edge: EdgeId,
    forward: bool,
}
