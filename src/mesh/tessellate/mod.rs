//! Triangles for bodies and faces.
//!
//! Every edge is divided once, and every face takes the points of its edges as they are, so neighbours
//! meet exactly and a closed shell gives a closed mesh. Within a face: constrained Delaunay triangulation of
//! the parameter plane, refined until the triangles lie on the surface. The same B-rep and tolerances
//! give the same mesh.
//!
//! Does not repair: a shell that is open, or whose faces do not share their edges, gives an open mesh, which
//! [`Integrity`](super::Integrity) states.

mod assemble;
mod boundary;
mod edges;
mod flat;
mod lattice;
mod region;
mod untangle;

use super::Mesh;
use crate::brep::{BodyId, Brep, EdgeId, FaceId, ParameterLoopError, VertexId};
use crate::geometry::nurbs::KnotVector;
use crate::geometry::{Carried, Curve, Surface, SurfaceDerivatives};
use crate::math::Point3;
use boundary::{Context, SharedEdge};
use lattice::SAMPLES;
use rayon::prelude::*;
use region::{Corner, Region, RegionError, Shape, Tangents};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

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

    /// Whether the bounds of a face meet where they should not, which finer edges may mend.
    fn is_crossing(&self) -> bool {
        matches!(self, Self::CrossingBounds { .. } | Self::CoincidentVertices { .. })
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

/// Times that bounds that cross are divided at most, the first included: two curved bounds close together may
/// cross as polygons and not as curves.
const ATTEMPTS: u32 = 3;

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
    let mut work = assemble::Work::new(brep, tolerances);
    work.divide_edges(faces)?;
    let mut waiting: Vec<FaceId> = faces.to_vec();
    while !waiting.is_empty() {
        let done: Vec<_> = waiting
            .par_iter()
            .map(|&face| region_of(brep, face, tolerances, &work.edges, &work.vertices))
            .collect();
        let mut crossing = Vec::new();
        for (face, result) in waiting.into_iter().zip(done) {
            match result {
                Ok(region) => work.keep(face, region)?,
                Err(error) if error.is_crossing() => crossing.push((face, error)),
                Err(error) => return Err(error),
            }
        }
        for (face, error) in crossing {
            if !work.refine(face)? {
                return Err(error);
            }
        }
        waiting = faces.iter().copied().filter(|&face| !work.has(face)).collect();
    }
    work.finish(faces)
}

/// Triangles of one face over the shared points of its edges. Where the bounds cross, as they may by less
/// than the data's tolerance where edges meet, they are untangled in the parameter plane.
fn region_of(
    brep: &Brep,
    face: FaceId,
    tolerances: &Tolerances,
    edges: &BTreeMap<EdgeId, SharedEdge>,
    vertices: &BTreeMap<VertexId, u32>,
) -> Result<Region, TessellateError> {
    let carried = brep.surface_of(face);
    let surface = carried.read().ok_or_else(|| TessellateError::surface(face, carried))?;
    let domain = Wrapped::of(surface);
    let vertex_loops: Vec<Corner> = brep.faces[face]
        .loops
        .iter()
        .filter_map(|&bound| brep.loops[bound].vertex)
        .filter_map(|vertex| {
            let point = brep.vertices[vertex].point;
            Some(Corner { uv: [0.0; 2], vertex: *vertices.get(&vertex)?, point })
        })
        .collect();
    let vertex_loops = vertex_loops.as_slice();
    let mut context = Context { brep, face, surface: &domain, tolerances, edges, vertex_loops, own: 0 };
    let mut loops = boundary::loops(&mut context)?;
    let run =
        |loops: &[Vec<Corner>]| region::triangulate(loops, tolerances, Tolerances::MOST_VERTICES, &domain);
    let mut result = run(&loops);
    if matches!(result, Err(RegionError::Crossing(_) | RegionError::Coincident(_))) {
        for corners in &mut loops {
            untangle::untangle(corners);
        }
        result = run(&loops);
    }
    let kind = surface.kind();
    result.map_err(|error| match error {
        RegionError::Degenerate => TessellateError::DegenerateFace { face, kind },
        RegionError::Crossing(place) => TessellateError::CrossingBounds { face, kind, place },
        RegionError::Coincident(place) => TessellateError::CoincidentVertices { face, kind, place },
        RegionError::TooMany => TessellateError::TooManyVertices,
    })
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

    fn wrapped(&self, u: f64, v: f64) -> (f64, f64) {
        (wrap(u, self.turns[0]), wrap(v, self.turns[1]))
    }
}

/// A parameter within a domain of the given start and length, where there is one.
fn wrap(at: f64, turn: Option<(f64, f64)>) -> f64 {
    match turn {
        Some((start, period)) if !(start..=start + period).contains(&at) => {
            start + (at - start).rem_euclid(period)
        }
        _ => at,
    }
}

/// Samples a side for a surface that bends evenly, or a single span of a B-spline.
const FEWEST_SAMPLES: usize = 5;

/// Samples for each further span of a B-spline.
const SPAN_SAMPLES: usize = 3;

/// Spans of a B-spline that a cubic may stand for.
const REACH_SPANS: f64 = 1.5;

/// A length of the parameter within which a B-spline bends steadily; zero where a tangent may break.
fn span_reach(knots: &KnotVector) -> f64 {
    let (values, counts) = knots.distinct();
    let inner = counts.get(1..counts.len().saturating_sub(1)).unwrap_or_default();
    let breaks = knots.degree() < 2 || inner.iter().any(|&count| count >= knots.degree());
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return 0.0 };
    #[expect(clippy::cast_precision_loss, reason = "a count of knots")]
    let mean = (last - first) / (inner.len() + 1) as f64;
    match (breaks, inner.is_empty()) {
        // One polynomial; of a high degree it may wind.
        (_, true) => {
            if knots.degree() <= 3 {
                last - first
            } else {
                0.5 * (last - first)
            }
        }
        (true, false) => 0.0,
        (false, false) => REACH_SPANS * mean,
    }
}

impl Shape for Wrapped<'_> {
    fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let (u, v) = self.wrapped(u, v);
        self.surface.derivatives(u, v)
    }

    fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let (u, v) = self.wrapped(u, v);
        self.surface.point(u, v)
    }

    fn tangents(&self, u: f64, v: f64) -> Tangents {
        let (u, v) = self.wrapped(u, v);
        let (point, du, dv) = match self.surface {
            // Without second derivatives.
            Surface::Nurbs(nurbs) => nurbs.first_derivatives(u, v),
            surface => {
                let SurfaceDerivatives { point, du, dv, .. } = surface.derivatives(u, v);
                (point, du, dv)
            }
        };
        Tangents { point, du, dv }
    }

    fn tangents_on(&self, us: &[f64], vs: &[f64], places: &[[usize; 2]]) -> Vec<Tangents> {
        let Surface::Nurbs(nurbs) = self.surface else {
            return places.iter().map(|&[i, j]| self.tangents(us[i], vs[j])).collect();
        };
        let wrapped = |at: &[f64], turn| -> Vec<f64> { at.iter().map(|&at| wrap(at, turn)).collect() };
        let (us, vs) = (wrapped(us, self.turns[0]), wrapped(vs, self.turns[1]));
        let all = nurbs.grid_tangents(&us, &vs, places).into_iter();
        all.map(|(point, du, dv)| Tangents { point, du, dv }).collect()
    }

    fn reach(&self) -> [f64; 2] {
        match self.surface {
            Surface::Plane(_) => [f64::INFINITY; 2],
            Surface::Cylinder { .. } | Surface::Cone { .. } => [FRAC_PI_2, f64::INFINITY],
            Surface::Sphere { .. } | Surface::Torus { .. } => [FRAC_PI_2; 2],
            Surface::Nurbs(nurbs) => [nurbs.knots_u(), nurbs.knots_v()].map(span_reach),
            _ => [0.0; 2],
        }
    }

    fn is_flat(&self) -> bool {
        matches!(self.surface, Surface::Plane(_))
    }

    fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<SurfaceDerivatives> {
        let wrapped = |at: &[f64], turn| -> Vec<f64> { at.iter().map(|&at| wrap(at, turn)).collect() };
        let (us, vs) = (wrapped(us, self.turns[0]), wrapped(vs, self.turns[1]));
        match self.surface {
            Surface::Nurbs(nurbs) => nurbs.grid_derivatives(&us, &vs),
            surface => us
                .iter()
                .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
                .map(|(u, v)| surface.derivatives(u, v))
                .collect(),
        }
    }

    fn samples(&self, [low, high]: [[f64; 2]; 2]) -> [usize; 2] {
        let spans = |knots: &KnotVector, k: usize| {
            let all = knots.distinct().0;
            // Over a seam the knots stand elsewhere: then all of them count.
            let beyond = all.first().is_some_and(|&first| low[k] < first)
                || all.last().is_some_and(|&last| high[k] > last);
            let inner = all.iter().filter(|&&knot| beyond || (low[k] < knot && knot < high[k])).count();
            (SPAN_SAMPLES * inner + FEWEST_SAMPLES).min(SAMPLES)
        };
        match self.surface {
            Surface::Plane(_) => [1; 2],
            // The bend is the same all along, or changes with one parameter steadily.
            Surface::Cylinder { .. }
            | Surface::Cone { .. }
            | Surface::Sphere { .. }
            | Surface::Torus { .. } => [FEWEST_SAMPLES; 2],
            Surface::Nurbs(nurbs) => [spans(nurbs.knots_u(), 0), spans(nurbs.knots_v(), 1)],
            _ => [SAMPLES; 2],
        }
    }
}
