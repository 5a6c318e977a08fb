//! Triangles for bodies and faces.
//!
//! Every edge is divided once, and every face takes the points of its edges as they are, so neighbours
//! meet exactly and a closed shell gives a closed mesh. Within a face: constrained Delaunay triangulation of
//! the parameter plane, refined until the triangles lie on the surface. The same B-rep and tolerances
//! give the same mesh.
//!
//! Does not repair: a shell that is open, or whose faces do not share their edges, gives an open mesh, which
//! [`Integrity`](super::Integrity) states.

mod boundary;
mod edges;
mod lattice;
mod region;

use super::Mesh;
use crate::brep::{BodyId, Brep, EdgeId, FaceId, ParameterLoopError, VertexId};
use crate::geometry::{Carried, Curve, Surface};
use crate::math::{Point3, Vector3};
use boundary::{Context, SharedEdge};
use region::{Corner, Region, RegionError};
use std::collections::BTreeMap;

/// How far triangles may be from the surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Greatest distance of a side's or a triangle's middle from its curve or surface, in file units.
    pub chord: f64,
    /// Greatest turn of the tangent along a side, in radians.
    pub angle: f64,
}

impl Tolerances {
    /// Most vertices of one mesh: a tolerance far too small for its part ends here and not with all memory.
    pub const MOST_VERTICES: usize = 4_000_000;

    /// Tolerances for a part of the given size: chord 1/1000 of it, angle 20°.
    #[must_use]
    pub fn for_size(diagonal: f64) -> Self {
        Self { chord: 1e-3 * diagonal, angle: 20f64.to_radians() }
    }

    /// Tolerances for edges that cross as polygons. By the chord alone, since two arcs that touch in a cusp
    /// keep their order when each is divided by its own bend, and lose it when divided by equal angles.
    fn finer(self) -> Self {
        Self { chord: 0.125 * self.chord, angle: f64::INFINITY }
    }
}

/// Why there is no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TessellateError {
    /// A tolerance is not a positive number.
    #[error("chord tolerance {chord} or angle tolerance {angle} is not a positive number")]
    Tolerances {
        /// Chord tolerance.
        chord: f64,
        /// Angle tolerance.
        angle: f64,
    },
    /// A face's surface was not read.
    #[error("surface {entity} cannot be tessellated: {reason}")]
    Surface {
        /// The face.
        face: FaceId,
        /// Entity name in the file.
        entity: String,
        /// Why it was not read.
        reason: String,
    },
    /// An edge's curve was not read.
    #[error("curve {entity} cannot be tessellated: {reason}")]
    Curve {
        /// The edge.
        edge: EdgeId,
        /// Entity name in the file.
        entity: String,
        /// Why it was not read.
        reason: String,
    },
    /// The ends of an edge have no parameters on its curve.
    #[error("the ends of an edge have no finite parameters on its curve")]
    EdgeRange {
        /// The edge.
        edge: EdgeId,
    },
    /// The bounds of a face have no parameters on its surface.
    #[error("bounds of a face: {source}")]
    Bounds {
        /// The face.
        face: FaceId,
        /// Why.
        source: ParameterLoopError,
    },
    /// Bounds wind around a closed surface and are not two of opposite sense.
    #[error("bounds wind around a closed surface and do not enclose a band of it")]
    WindingBounds {
        /// The face.
        face: FaceId,
    },
    /// A face's bounds enclose nothing in the parameter plane of its surface.
    #[error("the bounds of a face on a {kind} enclose no region of its parameters")]
    DegenerateFace {
        /// The face.
        face: FaceId,
        /// Kind of its surface.
        kind: &'static str,
    },
    /// Two vertices of a face stand at one place of its surface's parameters.
    #[error("two vertices of a face on a {kind} are one place near ({:.6}, {:.6}, {:.6})", .place.x, .place.y, .place.z)]
    CoincidentVertices {
        /// The face.
        face: FaceId,
        /// Kind of its surface.
        kind: &'static str,
        /// Where, in file units.
        place: Point3<f64>,
    },
    /// Bounds of a face cross or touch, also when sampled finely.
    #[error("bounds of a face on a {kind} cross or touch near ({:.6}, {:.6}, {:.6})", .place.x, .place.y, .place.z)]
    CrossingBounds {
        /// The face.
        face: FaceId,
        /// Kind of its surface.
        kind: &'static str,
        /// Where, in file units.
        place: Point3<f64>,
    },
    /// The tolerances ask for too many vertices.
    #[error("the mesh would have more than {} vertices", Tolerances::MOST_VERTICES)]
    TooManyVertices,
}

impl TessellateError {
    /// The face that the error is about, where it is one.
    #[must_use]
    pub fn face(&self) -> Option<FaceId> {
        match self {
            Self::Surface { face, .. }
            | Self::Bounds { face, .. }
            | Self::WindingBounds { face }
            | Self::DegenerateFace { face, .. }
            | Self::CoincidentVertices { face, .. }
            | Self::CrossingBounds { face, .. } => Some(*face),
            Self::Tolerances { .. } | Self::Curve { .. } | Self::EdgeRange { .. } | Self::TooManyVertices => {
                None
            }
        }
    }

    /// The edge that the error is about, where it is one.
    #[must_use]
    pub fn edge(&self) -> Option<EdgeId> {
        match self {
            Self::Curve { edge, .. } | Self::EdgeRange { edge } => Some(*edge),
            _ => None,
        }
    }

    fn curve(edge: EdgeId, curve: &Carried<Curve>) -> Self {
        let (entity, reason) = unread(curve);
        Self::Curve { edge, entity, reason }
    }

    fn surface(face: FaceId, surface: &Carried<Surface>) -> Self {
        let (entity, reason) = unread(surface);
        Self::Surface { face, entity, reason }
    }
}

fn unread<G>(carried: &Carried<G>) -> (String, String) {
    match carried {
        Carried::Read(_) => Default::default(),
        Carried::Unread { entity, reason } => (entity.clone(), reason.clone()),
    }
}

/// Times that bounds that cross are sampled more finely: two curved bounds close together may cross as
/// polygons and not as curves.
const ATTEMPTS: usize = 3;

/// Triangles of all faces of some bodies. See [`tessellate_faces`].
///
/// # Errors
/// As [`tessellate_faces`].
pub fn tessellate_bodies(
    brep: &Brep,
    bodies: &[BodyId],
    tolerances: &Tolerances,
) -> Result<Mesh, TessellateError> {
    let shells = bodies.iter().flat_map(|&body| brep.bodies[body].shells.iter());
    let faces: Vec<FaceId> = shells.flat_map(|&shell| brep.shells[shell].faces.iter().copied()).collect();
    tessellate_faces(brep, &faces, tolerances)
}

/// Triangles of some faces in the given order, with normals; faces that share edges share vertices.
///
/// Bounds are the loops of the face under the even-odd rule, so their sense does not matter. Triangles face
/// where the face's normal does: by the surface, the face's sense and the shell's.
///
/// # Errors
/// The first face or edge that cannot be tessellated, and why.
pub fn tessellate_faces(
    brep: &Brep,
    faces: &[FaceId],
    tolerances: &Tolerances,
) -> Result<Mesh, TessellateError> {
    let Tolerances { chord, angle } = *tolerances;
    if !(chord.is_finite() && chord > 0.0 && angle.is_finite() && angle > 0.0) {
        return Err(TessellateError::Tolerances { chord, angle });
    }
    let mut now = *tolerances;
    let mut result = attempt(brep, faces, tolerances, &now);
    for _ in 1..ATTEMPTS {
        if !matches!(result, Err(TessellateError::CrossingBounds { .. })) {
            break;
        }
        now = now.finer();
        result = attempt(brep, faces, tolerances, &now);
    }
    result
}

fn attempt(
    brep: &Brep,
    faces: &[FaceId],
    tolerances: &Tolerances,
    edge_tolerances: &Tolerances,
) -> Result<Mesh, TessellateError> {
    let mut builder =
        Builder { brep, mesh: Mesh::default(), vertices: BTreeMap::new(), edges: BTreeMap::new() };
    for &face in faces {
        let carried = brep.surface_of(face);
        let surface = carried.read().ok_or_else(|| TessellateError::surface(face, carried))?;
        for coedge in brep.coedges_of(face) {
            builder.add_edge(brep.coedges[coedge].edge, edge_tolerances)?;
        }
        let domain = Wrapped::of(surface);
        let loops = builder.loops(face, &domain, tolerances)?;
        let budget = Tolerances::MOST_VERTICES.saturating_sub(builder.mesh.vertices.len());
        let evaluate = |u: f64, v: f64| domain.derivatives(u, v);
        let region = region::triangulate(&loops, tolerances, budget, &evaluate).map_err(|error| {
            let kind = surface.kind();
            match error {
                RegionError::Degenerate => TessellateError::DegenerateFace { face, kind },
                RegionError::Crossing(place) => TessellateError::CrossingBounds { face, kind, place },
                RegionError::Coincident(place) => TessellateError::CoincidentVertices { face, kind, place },
                RegionError::TooMany => TessellateError::TooManyVertices,
            }
        })?;
        builder.add_region(face, &region, &domain);
    }
    Ok(builder.mesh)
}

/// A surface whose closed directions go on past the ends of the domain.
struct Wrapped<'a> {
    surface: &'a Surface,
    /// Start and length of the domain in each direction that is closed.
    turns: [Option<(f64, f64)>; 2],
}

impl<'a> Wrapped<'a> {
    fn of(surface: &'a Surface) -> Self {
        let (domain, periods) = (surface.domain(), surface.periods());
        let turn = |start: f64, period: Option<f64>| period.map(|period| (start, period));
        Self { surface, turns: [turn(domain.0.0, periods.0), turn(domain.1.0, periods.1)] }
    }

    fn derivatives(&self, u: f64, v: f64) -> crate::geometry::nurbs::SurfaceDerivatives {
        let wrap = |at: f64, turn: Option<(f64, f64)>| match turn {
            Some((start, period)) if !(start..=start + period).contains(&at) => {
                start + (at - start).rem_euclid(period)
            }
            _ => at,
        };
        self.surface.derivatives(wrap(u, self.turns[0]), wrap(v, self.turns[1]))
    }
}

/// A mesh in the making.
struct Builder<'a> {
    brep: &'a Brep,
    mesh: Mesh,
    vertices: BTreeMap<VertexId, u32>,
    edges: BTreeMap<EdgeId, SharedEdge>,
}

impl Builder<'_> {
    fn push(&mut self, point: Point3<f64>) -> Result<u32, TessellateError> {
        let count = self.mesh.vertices.len();
        if count >= Tolerances::MOST_VERTICES {
            return Err(TessellateError::TooManyVertices);
        }
        self.mesh.vertices.push(point);
        u32::try_from(count).map_err(|_| TessellateError::TooManyVertices)
    }

    fn vertex(&mut self, vertex: VertexId) -> Result<u32, TessellateError> {
        if let Some(&known) = self.vertices.get(&vertex) {
            return Ok(known);
        }
        let index = self.push(self.brep.vertices[vertex].point)?;
        self.vertices.insert(vertex, index);
        Ok(index)
    }

    fn add_edge(&mut self, edge: EdgeId, tolerances: &Tolerances) -> Result<(), TessellateError> {
        if self.edges.contains_key(&edge) {
            return Ok(());
        }
        let samples = edges::divide(self.brep, edge, tolerances)?;
        let last = samples.len() - 1;
        let mut vertices = Vec::with_capacity(samples.len());
        for (at, sample) in samples.iter().enumerate() {
            let vertex = match at {
                0 => self.vertex(self.brep.edges[edge].start)?,
                _ if at == last => self.vertex(self.brep.edges[edge].end)?,
                _ => self.push(sample.point)?,
            };
            vertices.push(vertex);
        }
        self.edges.insert(edge, SharedEdge { samples, vertices });
        Ok(())
    }

    fn loops(
        &mut self,
        face: FaceId,
        surface: &Wrapped,
        tolerances: &Tolerances,
    ) -> Result<Vec<Vec<Corner>>, TessellateError> {
        let brep = self.brep;
        let mut vertex_loops = Vec::new();
        for vertex in brep.faces[face].loops.iter().filter_map(|&bound| brep.loops[bound].vertex) {
            let point = brep.vertices[vertex].point;
            vertex_loops.push(Corner { uv: [0.0; 2], vertex: self.vertex(vertex)?, point });
        }
        let edges = std::mem::take(&mut self.edges);
        let mut push = |point| self.push(point);
        let (edges_given, vertex_loops) = (&edges, vertex_loops.as_slice());
        let mut context =
            Context { brep, face, surface, tolerances, edges: edges_given, vertex_loops, push: &mut push };
        let loops = boundary::loops(&mut context);
        self.edges = edges;
        loops
    }

    fn add_region(&mut self, face: FaceId, region: &Region, surface: &Wrapped) {
        let brep = self.brep;
        let forward = brep.faces[face].same_sense == brep.shells[brep.faces[face].shell].forward;
        let first = self.mesh.vertices.len();
        let inner = region.nodes.iter().filter(|node| node.vertex.is_none());
        self.mesh.vertices.extend(inner.map(|node| node.point));
        let mut next = u32::try_from(first).expect("the budget of vertices is far below 2^32");
        let indices: Vec<u32> = region
            .nodes
            .iter()
            .map(|node| {
                node.vertex.unwrap_or_else(|| {
                    next += 1;
                    next - 1
                })
            })
            .collect();
        let normals: Vec<Option<Vector3<f64>>> = region
            .nodes
            .iter()
            .map(|node| surface.derivatives(node.uv[0], node.uv[1]).normal())
            .map(|normal| normal.map(|n| if forward { n } else { -n }))
            .collect();
        for corners in &region.triangles {
            let corners = if forward { *corners } else { [corners[0], corners[2], corners[1]] };
            let triangle = corners.map(|node| indices[node as usize]);
            let [a, b, c] = triangle;
            if a == b || b == c || c == a {
                // Two corners at a pole: the sides to the third are one.
                continue;
            }
            let [a, b, c] = triangle.map(|at| self.mesh.vertices[at as usize]);
            let flat = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            self.mesh.triangles.push(triangle);
            self.mesh.faces.push(face);
            self.mesh.normals.push(corners.map(|node| normals[node as usize].unwrap_or(flat)));
        }
    }
}
