//! From divided edges and the triangles of single faces to one mesh: shared vertices, faces that contradict
//! their neighbours, and chords that two faces have in common.

use super::boundary::{OWN, SharedEdge};
use super::region::{Node, Region, Shape};
use super::{ATTEMPTS, TessellateError, Tolerances, Wrapped, edges};
use crate::brep::{Brep, EdgeId, FaceId, VertexId};
use crate::math::{Point3, Vector3};
use crate::mesh::Mesh;
use std::collections::{BTreeMap, BTreeSet};

/// Stands for the index of a vertex that the mesh does not have yet: above all others.
const NOT_YET: u32 = u32::MAX;

/// A mesh in the making.
pub(super) struct Work<'a> {
    brep: &'a Brep,
    tolerances: &'a Tolerances,
    /// Points of vertices and edges; those of edges that were divided again stay and are not used.
    points: Vec<Point3<f64>>,
    pub vertices: BTreeMap<VertexId, u32>,
    pub edges: BTreeMap<EdgeId, SharedEdge>,
    /// How often an edge was divided.
    levels: BTreeMap<EdgeId, u32>,
    regions: BTreeMap<FaceId, Region>,
    uses: BTreeMap<EdgeId, Vec<FaceId>>,
    total: usize,
}

impl<'a> Work<'a> {
    pub(super) fn new(brep: &'a Brep, tolerances: &'a Tolerances) -> Self {
        Self {
            brep,
            tolerances,
            points: Vec::new(),
            vertices: BTreeMap::new(),
            edges: BTreeMap::new(),
            levels: BTreeMap::new(),
            regions: BTreeMap::new(),
            uses: BTreeMap::new(),
            total: 0,
        }
    }

    /// Divides the edges of some faces, in their order.
    pub(super) fn divide_edges(&mut self, faces: &[FaceId]) -> Result<(), TessellateError> {
        let brep = self.brep;
        for &face in faces {
            let carried = brep.surface_of(face);
            carried.read().ok_or_else(|| TessellateError::surface(face, carried))?;
            for coedge in brep.coedges_of(face) {
                let edge = brep.coedges[coedge].edge;
                let uses = self.uses.entry(edge).or_default();
                let known = !uses.is_empty();
                uses.push(face);
                if !known {
                    self.levels.insert(edge, 1);
                    self.divide(edge, self.tolerances)?;
                }
            }
            for vertex in brep.faces[face].loops.iter().filter_map(|&bound| brep.loops[bound].vertex) {
                self.vertex(vertex)?;
            }
        }
        Ok(())
    }

    fn divide(&mut self, edge: EdgeId, tolerances: &Tolerances) -> Result<(), TessellateError> {
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

    fn push(&mut self, point: Point3<f64>) -> Result<u32, TessellateError> {
        let count = self.points.len();
        if count >= Tolerances::MOST_VERTICES {
            return Err(TessellateError::TooManyVertices);
        }
        self.points.push(point);
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

    /// Divides the edges of a face more finely, and forgets the faces that they bound; false when that was
    /// done often enough.
    pub(super) fn refine(&mut self, face: FaceId) -> Result<bool, TessellateError> {
        let brep = self.brep;
        let mut changed = false;
        for coedge in brep.coedges_of(face) {
            let edge = brep.coedges[coedge].edge;
            let level = self.levels.get_mut(&edge).expect("the edges of all faces are divided");
            // An edge that a neighbour made finer in this round already counts as done.
            if *level >= ATTEMPTS {
                continue;
            }
            *level += 1;
            changed = true;
            let mut finer = *self.tolerances;
            for _ in 1..*level {
                finer = finer.finer();
            }
            self.divide(edge, &finer)?;
            for user in self.uses.get(&edge).into_iter().flatten() {
                self.regions.remove(user);
            }
        }
        Ok(changed)
    }

    pub(super) fn keep(&mut self, face: FaceId, region: Region) -> Result<(), TessellateError> {
        self.total += region.nodes.len();
        if self.total > 2 * Tolerances::MOST_VERTICES {
            return Err(TessellateError::TooManyVertices);
        }
        self.regions.insert(face, region);
        Ok(())
    }

    pub(super) fn has(&self, face: FaceId) -> bool {
        // A region over edges that were divided again since is gone.
        self.regions.contains_key(&face)
    }

    /// The mesh of all faces in the given order.
    pub(super) fn finish(mut self, faces: &[FaceId]) -> Result<Mesh, TessellateError> {
        self.part_common_chords(faces);
        let forward = self.orientations(faces);
        let mut mesh = Mesh::default();
        let mut places = vec![NOT_YET; self.points.len()];
        for (&face, forward) in faces.iter().zip(forward) {
            let Some(region) = self.regions.get(&face) else { continue };
            add_region(&mut mesh, &mut places, face, region, forward)?;
        }
        Ok(mesh)
    }

    /// Divides chords across faces that others use as well: two faces may meet in two vertices that a chord of
    /// each joins, and four triangles cannot share it.
    fn part_common_chords(&mut self, faces: &[FaceId]) {
        let regions = faces.iter().filter_map(|face| self.regions.get(face));
        let mut sides: Vec<(u32, u32)> = regions.flat_map(Region::shared_sides).collect();
        sides.sort_unstable();
        let mut crowded =
            sides.chunk_by(|a, b| a == b).filter(|run| run.len() > 2).map(|run| run[0]).peekable();
        if crowded.peek().is_none() {
            return;
        }
        let crowded: BTreeSet<(u32, u32)> = crowded.collect();
        for &face in faces {
            let Some(surface) = self.brep.surface_of(face).read() else { continue };
            let domain = Wrapped::of(surface);
            if let Some(region) = self.regions.get_mut(&face) {
                region.part_chords(&|side| crowded.contains(&side), &|uv| domain.tangents(uv[0], uv[1]));
            }
        }
    }

    /// Whether the triangles of each face run as in the parameter plane. As the surface's normal and the senses
    /// of face and shell say; but a face whose loops say the opposite is turned over when its neighbours agree
    /// with the loops.
    fn orientations(&self, faces: &[FaceId]) -> Vec<bool> {
        let brep = self.brep;
        let shell = |face: FaceId| brep.shells[brep.faces[face].shell].forward;
        let said: Vec<bool> = faces.iter().map(|&f| brep.faces[f].same_sense == shell(f)).collect();
        let doubtful = |face: FaceId| {
            let area = self.regions.get(&face).map_or(0.0, |region| region.turning);
            area != 0.0 && (area > 0.0) != brep.faces[face].same_sense
        };
        if !faces.iter().any(|&face| doubtful(face)) {
            return said;
        }
        let mut ways: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        let way = |(a, b): (u32, u32), forward: bool| {
            ((a.min(b), a.max(b)), if (a < b) == forward { 1 } else { -1 })
        };
        for (&face, &forward) in faces.iter().zip(&said).filter(|(face, _)| !doubtful(**face)) {
            for side in self.regions.get(&face).into_iter().flat_map(Region::directed_sides) {
                let (key, sign) = way(side, forward);
                *ways.entry(key).or_default() += sign;
            }
        }
        let turned = |face: FaceId, forward: bool| {
            let sides = self.regions.get(&face).into_iter().flat_map(Region::directed_sides);
            let votes = sides.map(|side| {
                let (key, sign) = way(side, forward);
                ways.get(&key).map_or(0, |w| w.signum() * sign)
            });
            votes.sum::<i32>() > 0
        };
        faces.iter().zip(said).map(|(&f, forward)| forward != (doubtful(f) && turned(f, forward))).collect()
    }
}

/// Appends the triangles of a face.
fn add_region(
    mesh: &mut Mesh,
    places: &mut [u32],
    face: FaceId,
    region: &Region,
    forward: bool,
) -> Result<(), TessellateError> {
    let mut own: BTreeMap<u32, u32> = BTreeMap::new();
    let mut indices = Vec::with_capacity(region.nodes.len());
    for node in &region.nodes {
        let next = u32::try_from(mesh.vertices.len()).map_err(|_| TessellateError::TooManyVertices)?;
        let index = match node.vertex {
            None => next,
            Some(vertex) if vertex & OWN != 0 => *own.entry(vertex).or_insert(next),
            Some(vertex) => {
                let place = &mut places[vertex as usize];
                *place = (*place).min(next);
                *place
            }
        };
        if index == next {
            mesh.vertices.push(node.point);
        }
        indices.push(index);
    }
    if mesh.vertices.len() > Tolerances::MOST_VERTICES {
        return Err(TessellateError::TooManyVertices);
    }
    let normal = |node: &Node| node.normal().map(|n| if forward { n } else { -n });
    let normals: Vec<Option<Vector3<f64>>> = region.nodes.iter().map(normal).collect();
    for corners in &region.triangles {
        let corners = if forward { *corners } else { [corners[0], corners[2], corners[1]] };
        let triangle = corners.map(|node| indices[node as usize]);
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            // Two corners at a pole: the sides to the third are one.
            continue;
        }
        let [a, b, c] = triangle.map(|at| mesh.vertices[at as usize]);
        let flat = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        mesh.triangles.push(triangle);
        mesh.faces.push(face);
        mesh.normals.push(corners.map(|node| normals[node as usize].unwrap_or(flat)));
    }
    Ok(())
}
