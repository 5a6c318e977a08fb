//! The model's topology while it grows: every element with the entity that it comes from.

use super::code::ModelCode;
use super::curve::Piece;
use super::error::ReadError;
use super::scope::Scope;
use super::surface::SurfaceRead;
use crate::brep::{
    Arena, BodyId, Brep, Coedge, CoedgeId, CurveId, Edge, EdgeId, Face, FaceId, Loop, LoopId, Shell, ShellId,
    SurfaceId, Vertex, VertexId,
};
use crate::diagnostic::Sink;
use crate::geometry::{Carried, Curve, Curve2d, Surface};
use crate::iges::EntryNumber;
use crate::math::Point3;
use crate::model::{Attributes, Origin, Origins};

/// The growing topology.
pub(super) struct Builder<'a, 's> {
    pub(super) scope: Scope<'a>,
    pub(super) sink: &'s mut dyn Sink,
    pub(super) brep: Brep,
    pub(super) origins: Origins,
    pub(super) faces: Arena<FaceId, Attributes>,
}

/// An entity as an origin.
pub(super) fn origin(number: EntryNumber) -> Origin {
    Origin::DirectoryEntry(number.0)
}

/// A member of a list entity as an origin, counted from 1 as in the file.
pub(super) fn member(list: EntryNumber, index: usize) -> Origin {
    Origin::Member { entry: list.0, index: u32::try_from(index).unwrap_or(u32::MAX) }
}

/// A use of an edge that is to be made.
pub(super) struct NewCoedge {
    pub(super) edge: EdgeId,
    pub(super) forward: bool,
    pub(super) origin: Origin,
    pub(super) pcurve: Option<(EntryNumber, Curve2d)>,
}

impl<'a, 's> Builder<'a, 's> {
    pub(super) fn new(scope: Scope<'a>, sink: &'s mut dyn Sink) -> Self {
        Self { scope, sink, brep: Brep::default(), origins: Origins::default(), faces: Arena::default() }
    }

    pub(super) fn report(&mut self, code: ModelCode, number: EntryNumber, message: String) {
        self.sink.report(code.at(self.scope.file, number, message));
    }

    /// Reports an error of geometry at the entity, or at its user when the file does not have it.
    pub(super) fn report_geometry(&mut self, number: EntryNumber, user: EntryNumber, error: &ReadError) {
        let at = if self.scope.file.instance(number).is_some() { number } else { user };
        let message = format!("{}: {error}", self.scope.name(at));
        self.report(error.geometry_code(), at, message);
    }

    pub(super) fn report_topology(&mut self, number: EntryNumber, error: &ReadError) {
        let message = match self.scope.name(number) {
            "" => error.to_string(),
            name => format!("{name}: {error}"),
        };
        self.report(error.topology_code(), number, message);
    }

    pub(super) fn push_curve(&mut self, number: EntryNumber, curve: Carried<Curve>) -> CurveId {
        self.origins.curves.push(origin(number));
        self.brep.curves.push(curve)
    }

    pub(super) fn push_surface(&mut self, number: EntryNumber, surface: Carried<Surface>) -> SurfaceId {
        self.origins.surfaces.push(origin(number));
        self.brep.surfaces.push(surface)
    }

    /// A surface as it is read; one that is near its entity's only is reported.
    pub(super) fn push_read(&mut self, number: EntryNumber, read: &SurfaceRead) -> SurfaceId {
        if let Some(off) = read.off {
            let message = format!(
                "no kind of geometry is this surface; a B-spline within {off:.1e} of it stands in for it"
            );
            self.report(ModelCode::ApproximatedSurface, number, message);
        }
        self.push_surface(number, Carried::Read(read.surface.clone()))
    }

    /// A surface that is carried only.
    pub(super) fn push_unread(&mut self, number: EntryNumber, error: &ReadError) -> SurfaceId {
        let entity = self.scope.name(number).to_owned();
        self.push_surface(number, Carried::Unread { entity, reason: error.to_string() })
    }

    pub(super) fn push_vertex(&mut self, from: Origin, point: Point3<f64>) -> VertexId {
        self.origins.vertices.push(from);
        self.brep.vertices.push(Vertex { point })
    }

    /// An edge that runs as its curve does.
    pub(super) fn push_edge(&mut self, from: Origin, curve: CurveId, ends: [VertexId; 2]) -> EdgeId {
        self.origins.edges.push(from);
        self.brep.edges.push(Edge { curve, start: ends[0], end: ends[1], same_sense: true })
    }

    /// An edge on a curve of its own.
    pub(super) fn push_piece(&mut self, number: EntryNumber, piece: &Piece, ends: [VertexId; 2]) -> EdgeId {
        let curve = self.push_curve(number, Carried::Read(piece.curve.clone()));
        self.push_edge(origin(number), curve, ends)
    }

    pub(super) fn push_loop(&mut self, from: EntryNumber, bound: Loop, coedges: Vec<NewCoedge>) -> LoopId {
        let in_loop = self.brep.loops.next_id();
        let coedges = coedges.into_iter().map(|coedge| self.push_coedge(coedge, in_loop)).collect();
        self.origins.loops.push(origin(from));
        self.brep.loops.push(Loop { coedges, ..bound })
    }

    fn push_coedge(&mut self, new: NewCoedge, in_loop: LoopId) -> CoedgeId {
        let (record, pcurve) = match new.pcurve {
            Some((number, curve)) => (Some(origin(number)), Some(curve)),
            None => (None, None),
        };
        self.origins.coedges.push(new.origin);
        self.origins.pcurves.push(record);
        self.brep.coedges.push(Coedge { edge: new.edge, in_loop, forward: new.forward, pcurve })
    }

    pub(super) fn push_face(&mut self, from: EntryNumber, face: Face, attributes: Attributes) -> FaceId {
        self.origins.faces.push(origin(from));
        self.faces.push(attributes);
        self.brep.faces.push(face)
    }

    pub(super) fn push_shell(&mut self, from: EntryNumber, shell: Shell) -> ShellId {
        self.origins.shells.push(origin(from));
        self.brep.shells.push(shell)
    }
}

/// A loop before its coedges are known.
pub(super) fn bound(face: FaceId, outer: bool) -> Loop {
    Loop { face, outer, forward: true, coedges: Vec::new(), vertex: None }
}

/// A face before its loops are known.
pub(super) fn on_surface(surface: SurfaceId, same_sense: bool, shell: ShellId) -> Face {
    Face { surface, same_sense, loops: Vec::new(), shell }
}

/// A shell before its faces are known.
pub(super) fn of_body(body: BodyId, closed: bool, forward: bool) -> Shell {
    Shell { faces: Vec::new(), closed, forward, body }
}
