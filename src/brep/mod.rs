//! Boundary representation: bodies, shells, faces, loops, edges and vertices with typed ids.
//!
//! Read-only once built. Knows nothing of files: where an element came from is the model's knowledge.
//! Repairs nothing; `check` states facts.

pub mod check;
pub mod edge_samples;
pub mod id;
pub mod mass_properties;
pub mod parameter_loop;

use crate::geometry::{Carried, Curve, Curve2d, Surface};
use crate::math::Point3;
pub use edge_samples::{
    EdgePoint, EdgeRange, EdgeSampling, edge_range, inner_breaks, sample_curve, sample_edge,
};
pub use id::{Arena, BodyId, CoedgeId, CurveId, EdgeId, FaceId, LoopId, ShellId, SurfaceId, VertexId};
pub use parameter_loop::{
    LoopPoint, LoopSampling, ParameterLoop, ParameterLoopError, parameter_loops, parameter_loops_with,
};

/// All topology and geometry of one model.
#[derive(Debug, Clone, Default)]
pub struct Brep {
    /// Curves, each once however many edges share it.
    pub curves: Arena<CurveId, Carried<Curve>>,
    /// Surfaces, each once however many faces share it.
    pub surfaces: Arena<SurfaceId, Carried<Surface>>,
    /// Vertices.
    pub vertices: Arena<VertexId, Vertex>,
    /// Edges.
    pub edges: Arena<EdgeId, Edge>,
    /// Uses of edges by loops.
    pub coedges: Arena<CoedgeId, Coedge>,
    /// Loops.
    pub loops: Arena<LoopId, Loop>,
    /// Faces.
    pub faces: Arena<FaceId, Face>,
    /// Shells.
    pub shells: Arena<ShellId, Shell>,
    /// Bodies.
    pub bodies: Arena<BodyId, Body>,
}

/// A point where edges end.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Position, in file units.
    pub point: Point3<f64>,
}

/// A piece of a curve between two vertices; the whole closed curve when they are the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The curve.
    pub curve: CurveId,
    /// Vertex at the edge's start.
    pub start: VertexId,
    /// Vertex at the edge's end.
    pub end: VertexId,
    /// Whether the edge runs as its curve does.
    pub same_sense: bool,
}

/// The use of an edge by a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Coedge {
    /// The edge.
    pub edge: EdgeId,
    /// Loop that it belongs to.
    pub in_loop: LoopId,
    /// Whether the loop runs along the edge from start to end, before the bound's own orientation.
    pub forward: bool,
    /// Curve in the parameters of the face's surface, where the file has one; it runs as the edge's
    /// curve does.
    pub pcurve: Option<Curve2d>,
}

/// A closed chain of coedges, or a single vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Face that it bounds.
    pub face: FaceId,
    /// Whether the file calls it the outer bound.
    pub outer: bool,
    /// Whether the face is to the left of the loop as its coedges run; when false the loop counts reversed.
    pub forward: bool,
    /// Coedges in order; empty for a vertex loop.
    pub coedges: Vec<CoedgeId>,
    /// The vertex of a vertex loop.
    pub vertex: Option<VertexId>,
}

/// A bounded piece of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// The surface.
    pub surface: SurfaceId,
    /// Whether the face's normal is the surface's.
    pub same_sense: bool,
    /// Bounds in file order; the outer one need not be first.
    pub loops: Vec<LoopId>,
    /// Shell that it belongs to.
    pub shell: ShellId,
}

/// A connected set of faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// Faces in file order.
    pub faces: Vec<FaceId>,
    /// Whether the file calls it closed.
    pub closed: bool,
    /// Whether the faces count as they are; false for an oriented shell that turns them.
    pub forward: bool,
    /// Body that it belongs to.
    pub body: BodyId,
}

/// What kind of body a set of shells bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyKind {
    /// One outer closed shell and any number of voids.
    Solid,
    /// Shells without an inside.
    Surface,
}

/// A solid or a set of surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Solid or surfaces.
    pub kind: BodyKind,
    /// Shells; a solid's outer one first.
    pub shells: Vec<ShellId>,
}

impl Brep {
    /// Surface of a face.
    #[must_use]
    pub fn surface_of(&self, face: FaceId) -> &Carried<Surface> {
        &self.surfaces[self.faces[face].surface]
    }

    /// Curve of an edge.
    #[must_use]
    pub fn curve_of(&self, edge: EdgeId) -> &Carried<Curve> {
        &self.curves[self.edges[edge].curve]
    }

    /// Coedges of a face, loop by loop.
    pub fn coedges_of(&self, face: FaceId) -> impl Iterator<Item = CoedgeId> + '_ {
        self.faces[face].loops.iter().flat_map(|&l| self.loops[l].coedges.iter().copied())
    }

    /// Whether a face lies on both sides of every edge that it has: its bounds only cut its surface open, and it is all of
    /// that.
    #[must_use]
    pub fn bounds_are_seams(&self, face: FaceId) -> bool {
        let mut edges: Vec<EdgeId> = self.coedges_of(face).map(|coedge| self.coedges[coedge].edge).collect();
        edges.sort_unstable();
        !edges.is_empty() && edges.chunk_by(|a, b| a == b).all(|uses| uses.len() == 2)
    }

    /// Faces that use each edge, in face order; a face that uses an edge twice (a seam) stands twice.
    #[must_use]
    pub fn faces_of_edges(&self) -> Arena<EdgeId, Vec<FaceId>> {
        let mut uses: Arena<EdgeId, Vec<FaceId>> = self.edges.iter().map(|_| Vec::new()).collect();
        for (_, coedge) in self.coedges.iter() {
            uses[coedge.edge].push(self.loops[coedge.in_loop].face);
        }
        uses
    }
}
