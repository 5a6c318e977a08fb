//! Solids, shells, faces, loops, edges and vertices (IGES 5.3 sections 4.49 and 4.143 to 4.147).
//!
//! Edges and vertices are members of lists; each gives one element, however many loops use it.

use std::collections::{HashMap, HashSet};

use super::builder::{Builder, NewCoedge, bound, member, of_body, on_surface};
use super::code::ModelCode;
use super::curve::{self, in_entity};
use super::curve2d::Piece2d;
use super::error::ReadError;
use super::pcurve;
use super::presentation::attributes;
use super::roots::Roots;
use super::scope::{MAX_PARTS, small};
use super::surface::{self, SurfaceRead};
use crate::brep::{BodyId, EdgeId, FaceId, LoopId, ShellId, SurfaceId, VertexId};
use crate::geometry::{Carried, Curve2d};
use crate::iges::{Entity, EntryNumber, Fields};
use crate::math::{Affine, Point3};

/// What the shells of one body share.
pub(super) struct Shared {
    within: Affine,
    vertices: HashMap<(EntryNumber, usize), VertexId>,
    /// Points of each list, read once.
    points: HashMap<EntryNumber, Result<Vec<Point3<f64>>, ReadError>>,
    edges: HashMap<(EntryNumber, usize), Result<EdgeId, ReadError>>,
    /// Members of each list, read once.
    lists: HashMap<EntryNumber, Result<Vec<EdgeItem>, ReadError>>,
    surfaces: HashMap<EntryNumber, (SurfaceId, Option<SurfaceRead>)>,
}

/// A member of an edge list.
#[derive(Debug, Clone, Copy, PartialEq)]
struct EdgeItem {
    curve: EntryNumber,
    start: (EntryNumber, i64),
    end: (EntryNumber, i64),
}

impl Shared {
    pub(super) fn new(within: Affine) -> Self {
        Self {
            within,
            vertices: HashMap::new(),
            points: HashMap::new(),
            edges: HashMap::new(),
            lists: HashMap::new(),
            surfaces: HashMap::new(),
        }
    }
}

/// Shells that bodies hold already.
pub(super) type Taken = HashSet<EntryNumber>;

impl Builder<'_, '_> {
    /// Reads the shells of a solid, the outer one first; those that cannot be read are reported.
    pub(super) fn solid(
        &mut self,
        number: EntryNumber,
        body: BodyId,
        roots: &Roots,
        taken: &mut Taken,
    ) -> Result<Vec<ShellId>, ReadError> {
        let view = self.scope.view_of(number, Entity::ManifoldSolid, "MANIFOLD_SOLID_B_REP_OBJECT")?;
        let fields = view.fields();
        let mut members = vec![(fields.pointer("shell")?, fields.integer("sense")? != 0)];
        small(fields, "void_count", MAX_PARTS)?;
        for hollow in fields.group("voids")? {
            members.push((hollow.pointer("shell")?, hollow.integer("sense")? != 0));
        }
        let mut shared = Shared::new(self.scope.matrix(view.instance())?);
        let mut shells = Vec::new();
        for (shell, forward) in members {
            shells.extend(self.shell(shell, body, forward, roots, &mut shared, taken));
        }
        Ok(shells)
    }

    /// Reads a shell; `None`, and a diagnostic, when it is none or another body has it.
    pub(super) fn shell(
        &mut self,
        number: EntryNumber,
        body: BodyId,
        forward: bool,
        roots: &Roots,
        shared: &mut Shared,
        taken: &mut Taken,
    ) -> Option<ShellId> {
        let members = match self.faces_of(number) {
            Ok(members) => members,
            Err(error) => {
                self.report_topology(number, &error);
                return None;
            }
        };
        if !taken.insert(number) {
            let message = "another body, or the same one, holds this shell already".to_owned();
            self.report(ModelCode::SharedShell, number, message);
            return None;
        }
        let closed = self.scope.file.instance(number).is_some_and(|shell| shell.entry().form != OPEN);
        let id = self.push_shell(number, of_body(body, closed, forward));
        let outer = shared.within;
        if let Ok(instance) = self.scope.instance(number) {
            shared.within = self.scope.placed(instance, &outer).unwrap_or(outer);
        }
        let mut listed = HashSet::new();
        for (face, sense) in members {
            if !listed.insert(face) {
                let message = format!("lists the face {face} more than once; it counts once");
                self.report(ModelCode::RepeatedFace, number, message);
                continue;
            }
            match self.face(face, sense, id, roots, shared) {
                Ok(face) => self.brep.shells[id].faces.push(face),
                Err(error) => self.report_topology(face, &error),
            }
        }
        shared.within = outer;
        self.settle_loops(number, id);
        Some(id)
    }

    /// Loops run as seen against the normal of their surface, whatever the shell makes of the face. Some writers let them
    /// run as seen against that of the face; where only so the uses of edges are opposite, these are believed.
    fn settle_loops(&mut self, number: EntryNumber, shell: ShellId) {
        let loops: Vec<LoopId> = self.brep.shells[shell]
            .faces
            .iter()
            .flat_map(|face| self.brep.faces[*face].loops.iter().copied())
            .collect();
        let by_surface = self.opposite_uses(&loops, |of| self.brep.loops[of].forward);
        if by_surface >= self.opposite_uses(&loops, |_| true) {
            return;
        }
        for of in loops {
            self.brep.loops[of].forward = true;
        }
        let message = "the loops of its faces run as seen from the shell, not from their surfaces; \
                       so are they taken";
        self.report(ModelCode::ReversedBoundary, number, message.to_owned());
    }

    /// How many edges two loops use in opposite directions.
    fn opposite_uses(&self, loops: &[LoopId], forward: impl Fn(LoopId) -> bool) -> usize {
        let mut uses: HashMap<EdgeId, (usize, i32)> = HashMap::new();
        for &of in loops {
            for coedge in &self.brep.loops[of].coedges {
                let coedge = &self.brep.coedges[*coedge];
                let (count, sum) = uses.entry(coedge.edge).or_default();
                *count += 1;
                *sum += if coedge.forward == forward(of) { 1 } else { -1 };
            }
        }
        uses.values().filter(|use_of| **use_of == (2, 0)).count()
    }

    fn faces_of(&self, number: EntryNumber) -> Result<Vec<(EntryNumber, bool)>, ReadError> {
        let view = self.scope.view_of(number, Entity::Shell, "SHELL")?;
        small(view.fields(), "count", MAX_PARTS * 100)?;
        let faces = view.fields().group("faces")?;
        faces.iter().map(|face| Ok((face.pointer("face")?, face.integer("sense")? != 0))).collect()
    }

    fn face(
        &mut self,
        number: EntryNumber,
        sense: bool,
        shell: ShellId,
        roots: &Roots,
        shared: &mut Shared,
    ) -> Result<FaceId, ReadError> {
        let view = self.scope.view_of(number, Entity::Face, "FACE")?;
        let on = view.fields().pointer("surface")?;
        small(view.fields(), "count", MAX_PARTS)?;
        let loops = view.fields().pointers_of("loops")?;
        let outer_first = view.fields().integer("outer_first")? != 0;
        let attributes = attributes(&self.scope, roots, view.instance(), self.sink);
        let (surface, read) = self.surface(on, number, shared);
        let turned = read.as_ref().is_some_and(|read| read.turned);
        let face = self.push_face(number, on_surface(surface, sense != turned, shell), attributes);
        let mut broken = None;
        for (at, bound) in loops.into_iter().enumerate() {
            match self.bound(bound, face, outer_first && at == 0, read.as_ref(), shared) {
                // The loop runs with the face to its left as seen against the face's own normal in the file: that of the
                // surface as the file counts, whatever the shell makes of it.
                Ok(id) => {
                    self.brep.loops[id].forward = sense;
                    self.brep.faces[face].loops.push(id);
                }
                Err(error) => {
                    self.report_topology(bound, &error);
                    broken.get_or_insert(error);
                }
            }
        }
        if let Some(error) = broken {
            let unread = self.push_unread(on, &error);
            self.brep.faces[face].surface = unread;
        }
        Ok(face)
    }

    /// The surface of a face; read once for a body.
    fn surface(
        &mut self,
        number: EntryNumber,
        user: EntryNumber,
        shared: &mut Shared,
    ) -> (SurfaceId, Option<SurfaceRead>) {
        if let Some(known) = shared.surfaces.get(&number) {
            return known.clone();
        }
        let found = match surface::read(&self.scope, number, &shared.within) {
            Ok(read) => (self.push_read(number, &read), Some(read)),
            Err(error) => {
                self.report_geometry(number, user, &error);
                (self.push_unread(number, &error), None)
            }
        };
        shared.surfaces.insert(number, found.clone());
        found
    }

    /// Reads one loop. Nothing of a loop with an error is kept but its edges and vertices.
    fn bound(
        &mut self,
        number: EntryNumber,
        face: FaceId,
        outer: bool,
        on: Option<&SurfaceRead>,
        shared: &mut Shared,
    ) -> Result<LoopId, ReadError> {
        let view = self.scope.view_of(number, Entity::Loop, "LOOP")?;
        small(view.fields(), "count", MAX_PARTS)?;
        let members = view.fields().group("edges")?;
        let mut coedges = Vec::new();
        let mut pole = None;
        for (at, use_of) in members.iter().enumerate() {
            let list = use_of.pointer("list")?;
            let index = use_of.integer("index")?;
            if use_of.integer("kind")? == VERTEX {
                pole = Some(self.vertex(list, index, shared)?);
                continue;
            }
            let edge = self.edge(list, index, shared)?;
            let pcurve = on.and_then(|on| self.pcurve(use_of, edge, on));
            let forward = use_of.integer("sense")? != 0;
            coedges.push(NewCoedge { edge, forward, origin: member(number, at + 1), pcurve });
        }
        let mut around = bound(face, outer);
        if coedges.is_empty() {
            around.vertex = Some(pole.ok_or(ReadError::Empty("edges"))?);
        }
        Ok(self.push_loop(number, around, coedges))
    }

    /// The parameter-space curve of an edge's use, where the file has exactly one that lies on the edge.
    fn pcurve(
        &mut self,
        use_of: &Fields<'_>,
        edge: EdgeId,
        on: &SurfaceRead,
    ) -> Option<(EntryNumber, Curve2d)> {
        if on.parameters.is_empty() {
            return None;
        }
        let given = use_of.group("pcurves").ok()?;
        let [only] = given.as_slice() else { return None };
        let number = only.optional_pointer("curve")?;
        let piece = self.edge_piece(edge)?;
        let read = curve::pieces(&self.scope, number, &Affine::identity());
        let flat = read.and_then(|pieces| match pieces.as_slice() {
            [(_, piece)] => Piece2d::flat(piece),
            _ => Err(ReadError::KindNotReadYet("a curve in parameters that is made of several")),
        });
        let found =
            flat.map(|flat| pcurve::fit(on, &flat, &piece, self.scope.resolution).map(|fit| fit.curve));
        match found {
            Ok(Some(curve)) => return Some((number, curve)),
            Ok(None) => {
                let message = format!("its image is nowhere near {}, which stands", self.origins.edges[edge]);
                self.report(ModelCode::BadPcurve, number, message);
            }
            Err(error) => self.report(ModelCode::BadPcurve, number, error.to_string()),
        }
        None
    }

    /// The piece of its curve that an edge is.
    fn edge_piece(&self, edge: EdgeId) -> Option<curve::Piece> {
        let curve = self.brep.curve_of(edge).read()?.clone();
        let range = crate::brep::edge_range(&self.brep, edge)?;
        Some(curve::Piece { curve, range: (range.start, range.end) })
    }

    fn edge(&mut self, list: EntryNumber, index: i64, shared: &mut Shared) -> Result<EdgeId, ReadError> {
        let item = self.edge_item(list, index, shared)?;
        let at = usize::try_from(index).unwrap_or(0);
        if let Some(known) = shared.edges.get(&(list, at)) {
            return known.clone();
        }
        let edge = self.read_edge(list, at, item, shared);
        shared.edges.insert((list, at), edge.clone());
        edge
    }

    fn edge_item(
        &mut self,
        list: EntryNumber,
        index: i64,
        shared: &mut Shared,
    ) -> Result<EdgeItem, ReadError> {
        let items = shared.lists.entry(list).or_insert_with(|| self.edge_items(list));
        let items = items.as_ref().map_err(|error| error.clone())?;
        let found = usize::try_from(index).ok().and_then(|at| items.get(at.checked_sub(1)?)).copied();
        found.ok_or(ReadError::Index { field: "index", index, list, count: items.len() })
    }

    fn edge_items(&self, list: EntryNumber) -> Result<Vec<EdgeItem>, ReadError> {
        let view = self.scope.view_of(list, Entity::EdgeList, "EDGE_LIST")?;
        small(view.fields(), "count", MAX_PARTS * 100)?;
        let item = |edge: Fields<'_>| {
            Ok(EdgeItem {
                curve: edge.pointer("curve")?,
                start: (edge.pointer("start_list")?, edge.integer("start")?),
                end: (edge.pointer("end_list")?, edge.integer("end")?),
            })
        };
        view.fields().group("edges")?.into_iter().map(item).collect()
    }

    fn read_edge(
        &mut self,
        list: EntryNumber,
        at: usize,
        item: EdgeItem,
        shared: &mut Shared,
    ) -> Result<EdgeId, ReadError> {
        let start = self.vertex(item.start.0, item.start.1, shared)?;
        let end = self.vertex(item.end.0, item.end.1, shared)?;
        let within = match self.scope.instance(list) {
            Ok(instance) => self.scope.placed(instance, &shared.within)?,
            Err(_) => shared.within,
        };
        let piece = curve::read(&self.scope, item.curve, &within)
            .map_err(|e| in_entity(&self.scope, "curve", item.curve, e))?;
        let curve = self.push_curve(item.curve, Carried::Read(piece.curve));
        Ok(self.push_edge(member(list, at), curve, [start, end]))
    }

    fn vertex(&mut self, list: EntryNumber, index: i64, shared: &mut Shared) -> Result<VertexId, ReadError> {
        if !shared.points.contains_key(&list) {
            let points = self.points(list, &shared.within);
            shared.points.insert(list, points);
        }
        let points = shared.points[&list].as_ref().map_err(Clone::clone)?;
        let count = points.len();
        let at = usize::try_from(index).ok().filter(|at| (1..=count).contains(at));
        let at = at.ok_or(ReadError::Index { field: "vertex", index, list, count })?;
        if let Some(&known) = shared.vertices.get(&(list, at)) {
            return Ok(known);
        }
        let vertex = self.push_vertex(member(list, at), points[at - 1]);
        shared.vertices.insert((list, at), vertex);
        Ok(vertex)
    }

    fn points(&self, list: EntryNumber, within: &Affine) -> Result<Vec<Point3<f64>>, ReadError> {
        let view = self.scope.view_of(list, Entity::VertexList, "VERTEX_LIST")?;
        let placed = self.scope.placed(view.instance(), within)?;
        let numbers = view.fields().reals("vertices")?;
        Ok(numbers.as_chunks::<3>().0.iter().map(|&p| placed.point(&Point3::from(p))).collect())
    }
}

/// Form of an open shell.
const OPEN: i32 = 2;
/// Kind of a loop's member that is a vertex.
const VERTEX: i64 = 1;
