//! Triangles of one face: constrained Delaunay in the scaled parameter plane, refined until the triangles
//! lie on the surface.
//!
//! The boundary is given and never divided here: its points belong to the neighbours, too.

use super::Tolerances;
use super::boundary::OWN;
use super::flat::turn_flat;
use super::lattice::{Lattice, SAMPLES};
use crate::geometry::nurbs::SurfaceDerivatives;
use crate::math::{Point3, Vector3};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, PositionInTriangulation, Triangulation};
use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};

/// Rounds of refinement. Each at least halves the triangles that need it, so the sag falls to 1/4 or less;
/// what is left after so many rounds is not curvature but a gap or a fold in the data.
const ROUNDS: usize = 6;

/// Distance from the boundary, in cells, within which no inner point is set: closer ones make slivers.
const CLEARANCE: f64 = 0.35;

/// Triangles with no side longer than this many chord tolerances are left alone however steep they stand:
/// the gap between an edge and its surface would be refined for ever.
const SMALLEST: f64 = 4.0;

/// Shares of the chord tolerance between which the bend of a side by its ends' tangents is not taken at its word:
/// the surface is asked for the middle then.
const DOUBT: [f64; 2] = [0.5, 1.5];

/// A point with its first derivatives by both parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangents {
    pub point: Point3<f64>,
    pub du: Vector3<f64>,
    pub dv: Vector3<f64>,
}

/// What a region lies on, over the plane of its parameters.
pub(super) trait Shape {
    /// Point and derivatives to second order.
    fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives;

    /// The point alone, which is often much cheaper.
    fn point(&self, u: f64, v: f64) -> Point3<f64> {
        self.derivatives(u, v).point
    }

    /// Point and first derivatives.
    fn tangents(&self, u: f64, v: f64) -> Tangents {
        let SurfaceDerivatives { point, du, dv, .. } = self.derivatives(u, v);
        Tangents { point, du, dv }
    }

    /// As [`tangents`](Self::tangents) at places `(i, j)` of the grid `us × vs`.
    fn tangents_on(&self, us: &[f64], vs: &[f64], places: &[[usize; 2]]) -> Vec<Tangents> {
        places.iter().map(|&[i, j]| self.tangents(us[i], vs[j])).collect()
    }

    /// Lengths along both parameters within which a cubic with the tangents of its ends follows the surface; zeros where
    /// nothing of the kind is known.
    fn reach(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Whether it is a plane.
    fn is_flat(&self) -> bool {
        false
    }

    /// As [`derivatives`](Self::derivatives) over the grid `us × vs`, row by row in `u`.
    fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<SurfaceDerivatives> {
        us.iter().flat_map(|&u| vs.iter().map(move |&v| self.derivatives(u, v))).collect()
    }

    /// Samples in each direction that show how it bends between two corners; at least one.
    fn samples(&self, _: [[f64; 2]; 2]) -> [usize; 2] {
        [SAMPLES; 2]
    }
}

impl<F: Fn(f64, f64) -> SurfaceDerivatives> Shape for F {
    fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        self(u, v)
    }
}

/// A point of the boundary: parameters on this face, and the mesh's vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub uv: [f64; 2],
    pub vertex: u32,
    pub point: Point3<f64>,
}

/// A point of the triangulated region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub uv: [f64; 2],
    pub point: Point3<f64>,
    /// The mesh's vertex; `None` for a point within the face.
    pub vertex: Option<u32>,
    /// Derivatives of the surface by both parameters.
    pub tangents: [Vector3<f64>; 2],
}

impl Node {
    /// The unit normal; `None` where the parametrisation is singular.
    pub(super) fn normal(&self) -> Option<Vector3<f64>> {
        self.tangents[0].cross(&self.tangents[1]).try_normalize(0.0)
    }
}

/// Triangles over nodes, counter-clockwise in the parameter plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Region {
    pub nodes: Vec<Node>,
    pub triangles: Vec<[u32; 3]>,
    /// Area that the loops enclose in the parameter plane, as they run: negative where they run clockwise.
    pub turning: f64,
}

impl Region {
    /// Sides of triangles as they run, by the mesh's vertices; only those between two of these.
    pub(super) fn directed_sides(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let sides = self.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        sides.filter_map(|(a, b)| {
            let (a, b) = (self.shared(a)?, self.shared(b)?);
            (a != b).then_some((a, b))
        })
    }

    /// Sides of triangles between two of the mesh's vertices, the lower first.
    pub(super) fn shared_sides(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.directed_sides().map(|(a, b)| (a.min(b), a.max(b)))
    }

    fn shared(&self, node: u32) -> Option<u32> {
        self.nodes[node as usize].vertex.filter(|vertex| vertex & OWN == 0)
    }

    /// Divides the chords between two of the mesh's vertices that a condition picks, in their middle.
    pub(super) fn part_chords(
        &mut self,
        picks: &dyn Fn((u32, u32)) -> bool,
        tangents: &dyn Fn([f64; 2]) -> Tangents,
    ) {
        while self.part_some_chords(picks, tangents) {}
    }

    /// Divides picked chords of which no two have a triangle in common; whether there was any. Each round
    /// leaves fewer picked chords and makes none.
    fn part_some_chords(
        &mut self,
        picks: &dyn Fn((u32, u32)) -> bool,
        tangents: &dyn Fn([f64; 2]) -> Tangents,
    ) -> bool {
        let mut users: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
        for (at, &[a, b, c]) in self.triangles.iter().enumerate() {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let Some((from, to)) = self.shared(a).zip(self.shared(b)) else { continue };
                if from != to && picks((from.min(to), from.max(to))) {
                    users.entry((a.min(b), a.max(b))).or_default().push(at);
                }
            }
        }
        let mut touched = BTreeSet::new();
        for ((a, b), triangles) in users {
            // A side of one triangle is the boundary itself.
            let [first, second] = triangles[..] else { continue };
            let Ok(middle) = u32::try_from(self.nodes.len()) else { return false };
            if touched.contains(&first) || touched.contains(&second) {
                continue;
            }
            touched.extend([first, second]);
            let (from, to) = (self.nodes[a as usize], self.nodes[b as usize]);
            let uv = [0, 1].map(|k| 0.5 * (from.uv[k] + to.uv[k]));
            let Tangents { point, du, dv } = tangents(uv);
            self.nodes.push(Node { uv, point, vertex: None, tangents: [du, dv] });
            for at in [first, second] {
                let corners = self.triangles[at];
                self.triangles[at] = corners.map(|corner| if corner == a { middle } else { corner });
                self.triangles.push(corners.map(|corner| if corner == b { middle } else { corner }));
            }
        }
        !touched.is_empty()
    }
}

/// Why a region cannot be triangulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RegionError {
    /// The boundary has no extent in the parameter plane, or is not finite.
    Degenerate,
    /// Two vertices of the mesh stand at one place of the parameter plane.
    Coincident(Point3<f64>),
    /// Two pieces of the boundary cross near the point.
    Crossing(Point3<f64>),
    /// More points than the budget allows.
    TooMany,
}

#[derive(Debug, Clone, Copy)]
struct Site {
    position: Point2<f64>,
    node: u32,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// A region in the making.
struct Work<'a, E> {
    nodes: Vec<Node>,
    cdt: ConstrainedDelaunayTriangulation<Site>,
    /// For each undirected edge whether an odd number of boundary pieces run there. Such edges are never turned, so they
    /// keep their numbers; edges with higher numbers came later.
    walls: Vec<bool>,
    lattice: Lattice,
    shape: &'a E,
    budget: usize,
    /// For each undirected edge of the triangulation the nodes that it last had, and how far their side is off the
    /// surface: at an edge that was turned since, other nodes stand.
    sides: Vec<([u32; 2], f64)>,
}

/// A place where a triangle wants a point, and a corner of the triangle, from where the way to it is short.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    uv: [f64; 2],
    near: FixedVertexHandle,
}

/// Triangulates what lies inside an odd number of loops.
///
/// Points at one place of the parameter plane with different vertices count as crossing boundaries.
pub(super) fn triangulate<E: Shape>(
    loops: &[Vec<Corner>],
    tolerances: &Tolerances,
    budget: usize,
    shape: &E,
) -> Result<Region, RegionError> {
    let corners = || loops.iter().flatten();
    let first = corners().next().ok_or(RegionError::Degenerate)?.uv;
    let bounds = corners().fold([first; 2], |[low, high], corner| {
        [[0, 1].map(|k| low[k].min(corner.uv[k])), [0, 1].map(|k| high[k].max(corner.uv[k]))]
    });
    let lattice = Lattice::new(bounds, tolerances, shape).ok_or(RegionError::Degenerate)?;
    let cdt = ConstrainedDelaunayTriangulation::new();
    let mut work =
        Work { nodes: Vec::new(), cdt, walls: Vec::new(), lattice, shape, budget, sides: Vec::new() };
    let inner = work.lattice_points(loops);
    work.load(loops, inner)?;
    if !shape.is_flat() {
        work.refine(tolerances)?;
    }
    let mut triangles = work.inner_triangles();
    if !shape.is_flat() {
        turn_flat(&mut triangles, &work.nodes);
    }
    let area = |corners: &Vec<Corner>| -> f64 {
        let ends = corners.iter().skip(1).chain(corners.first());
        corners.iter().zip(ends).map(|(a, b)| a.uv[0] * b.uv[1] - b.uv[0] * a.uv[1]).sum()
    };
    let turning = loops.iter().map(area).sum();
    Ok(Region { nodes: work.nodes, triangles, turning })
}

impl<E: Shape> Work<'_, E> {
    fn position(&self, uv: [f64; 2]) -> Point2<f64> {
        let tidy = |k: usize| {
            let scaled = uv[k] * self.lattice.scale[k];
            // The library refuses numbers nearer to zero than this.
            if scaled.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { scaled }
        };
        Point2::new(tidy(0), tidy(1))
    }

    /// Triangulates the corners of the boundary together with points within, and puts up the walls.
    fn load(&mut self, loops: &[Vec<Corner>], inner: Vec<([f64; 2], Tangents)>) -> Result<(), RegionError> {
        let mut pieces = Vec::new();
        let mut sites: Vec<Site> = Vec::new();
        let mut known: HashMap<[u64; 2], usize> = HashMap::new();
        for corners in loops {
            let mut places = Vec::with_capacity(corners.len());
            for corner in corners {
                let position = self.position(corner.uv);
                // Zero added, since -0 and 0 are one place.
                let place = [position.x, position.y].map(|c| (c + 0.0).to_bits());
                if let Some(&at) = known.get(&place) {
                    if self.nodes[sites[at].node as usize].vertex != Some(corner.vertex) {
                        return Err(RegionError::Coincident(corner.point));
                    }
                    places.push(at);
                    continue;
                }
                let at = Tangents { point: corner.point, du: Vector3::zeros(), dv: Vector3::zeros() };
                let node = self.push_node(corner.uv, &at, Some(corner.vertex))?;
                known.insert(place, sites.len());
                places.push(sites.len());
                sites.push(Site { position, node });
            }
            let ends = places.iter().skip(1).chain(places.first());
            pieces.extend(places.iter().zip(ends).map(|(&a, &b)| (a, b)));
        }
        for (uv, at) in inner {
            let position = self.position(uv);
            let node = self.push_node(uv, &at, None)?;
            sites.push(Site { position, node });
        }
        // All at once is much faster than one after the other.
        let count = sites.len();
        self.cdt = Triangulation::bulk_load(sites).map_err(|_| RegionError::Degenerate)?;
        let mut handles: Vec<_> = self.cdt.vertices().map(|v| (v.data().node, v.fix())).collect();
        handles.sort_unstable_by_key(|(node, _)| *node);
        if handles.len() != count {
            return Err(RegionError::Degenerate);
        }
        let pieces = pieces.into_iter().map(|(a, b)| (handles[a].1, handles[b].1));
        self.put_up_walls(pieces)?;
        for node in self.nodes.iter_mut().filter(|node| node.vertex.is_some()) {
            let at = self.shape.tangents(node.uv[0], node.uv[1]);
            node.tangents = [at.du, at.dv];
        }
        Ok(())
    }

    fn put_up_walls(
        &mut self,
        pieces: impl Iterator<Item = (FixedVertexHandle, FixedVertexHandle)>,
    ) -> Result<(), RegionError> {
        for (from, to) in pieces.filter(|(from, to)| from != to) {
            let edges = self.cdt.try_add_constraint(from, to);
            if edges.is_empty() {
                let node = self.cdt.vertex(from).data().node as usize;
                return Err(RegionError::Crossing(self.nodes[node].point));
            }
            for edge in edges {
                let at = edge.as_undirected().index();
                if self.walls.len() <= at {
                    self.walls.resize(at + 1, false);
                }
                self.walls[at] ^= true;
            }
        }
        Ok(())
    }

    fn push_node(&mut self, uv: [f64; 2], at: &Tangents, vertex: Option<u32>) -> Result<u32, RegionError> {
        if self.nodes.len() >= self.budget {
            return Err(RegionError::TooMany);
        }
        let node = u32::try_from(self.nodes.len()).map_err(|_| RegionError::TooMany)?;
        self.nodes.push(Node { uv, point: at.point, vertex, tangents: [at.du, at.dv] });
        Ok(node)
    }

    /// Adds a point within the face, unless it falls on a boundary or another point.
    fn add_inner(&mut self, wanted: &Wanted) -> Result<Option<FixedVertexHandle>, RegionError> {
        let position = self.position(wanted.uv);
        let near = match self.cdt.locate_with_hint(position, wanted.near) {
            PositionInTriangulation::OnFace(face) => self.cdt.face(face).vertices()[0].fix(),
            PositionInTriangulation::OnEdge(edge) if !self.cdt.is_constraint_edge(edge.as_undirected()) => {
                self.cdt.directed_edge(edge).from().fix()
            }
            _ => return Ok(None),
        };
        let at = self.shape.tangents(wanted.uv[0], wanted.uv[1]);
        if !at.point.iter().all(|c| c.is_finite()) {
            return Ok(None);
        }
        let node = self.push_node(wanted.uv, &at, None)?;
        let vertex = self.cdt.insert_with_hint(Site { position, node }, near);
        vertex.map(Some).map_err(|_| RegionError::Degenerate)
    }

    /// The lattice's points that lie inside and clear of the boundary, line by line.
    fn lattice_points(&self, loops: &[Vec<Corner>]) -> Vec<([f64; 2], Tangents)> {
        let Lattice { us, vs, scale } = &self.lattice;
        let scaled = |corner: &Corner| [corner.uv[0] * scale[0], corner.uv[1] * scale[1]];
        let segments: Vec<[[f64; 2]; 2]> = loops
            .iter()
            .flat_map(|l| l.iter().zip(l.iter().skip(1).chain(l.first())))
            .map(|(a, b)| [scaled(a), scaled(b)])
            .collect();
        let mut places = Vec::new();
        for (j, &v) in vs.iter().enumerate() {
            let y = v * scale[1];
            let reached =
                |[a, b]: &&[[f64; 2]; 2]| a[1].min(b[1]) - CLEARANCE <= y && y <= a[1].max(b[1]) + CLEARANCE;
            let near: Vec<_> = segments.iter().filter(reached).collect();
            let mut crossings: Vec<f64> = near
                .iter()
                .filter(|[a, b]| (a[1] <= y) != (b[1] <= y))
                .map(|[a, b]| a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for (i, &u) in us.iter().enumerate() {
                let x = u * scale[0];
                let inside = crossings.partition_point(|&c| c < x) % 2 == 1;
                let beside =
                    |[a, b]: &[[f64; 2]; 2]| x < a[0].min(b[0]) - CLEARANCE || a[0].max(b[0]) + CLEARANCE < x;
                if inside && near.iter().all(|side| beside(side) || distance([x, y], side) > CLEARANCE) {
                    places.push([i, j]);
                }
            }
        }
        let points = self.shape.tangents_on(us, vs, &places).into_iter();
        let points = points.zip(&places).map(|(at, &[i, j])| ([us[i], vs[j]], at));
        points.filter(|(_, at)| at.point.iter().all(|c| c.is_finite())).collect()
    }

    /// Adds points until the triangles lie on the surface, or enough was done.
    fn refine(&mut self, tolerances: &Tolerances) -> Result<(), RegionError> {
        let inside = self.inside();
        let inner = self.cdt.inner_faces().map(|face| face.fix());
        let mut open: Vec<_> = inner.filter(|face| inside[face.index()]).collect();
        let mut rounds = Vec::new();
        for round in 0..ROUNDS {
            let wanted = self.too_coarse(&open, tolerances);
            open.clear();
            let mut added = Vec::new();
            for wanted in &wanted {
                added.extend(self.add_inner(wanted)?);
            }
            // Only triangles at a new point are new; and what lies round it lies inside, as it does itself.
            rounds.resize(self.cdt.num_all_faces(), 0);
            for vertex in added {
                let around = self.cdt.vertex(vertex).out_edges();
                for face in around.filter_map(|edge| edge.face().as_inner()).map(|face| face.fix()) {
                    if std::mem::replace(&mut rounds[face.index()], round + 1) != round + 1 {
                        open.push(face);
                    }
                }
            }
            if open.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// Which faces of the triangulation lie inside an odd number of loops.
    fn inside(&self) -> Vec<bool> {
        let mut inside: Vec<Option<bool>> = vec![None; self.cdt.num_all_faces()];
        let outer = self.cdt.outer_face().fix().index();
        inside[outer] = Some(false);
        let mut queue = VecDeque::new();
        let wall = |edge: spade::handles::DirectedEdgeHandle<'_, Site, (), spade::CdtEdge<()>, ()>| {
            self.walls.get(edge.fix().as_undirected().index()).is_some_and(|&wall| wall)
        };
        for edge in self.cdt.convex_hull() {
            // Of the two sides of a hull edge one is the outer face.
            for side in [edge, edge.rev()] {
                let face = side.face().fix().index();
                if inside[face].is_none() {
                    inside[face] = Some(wall(side));
                    queue.extend(side.face().as_inner().map(|face| face.fix()));
                }
            }
        }
        while let Some(face) = queue.pop_front() {
            let here = inside[face.index()].unwrap_or(false);
            for edge in self.cdt.face(face).adjacent_edges() {
                let neighbour = edge.rev().face();
                if inside[neighbour.fix().index()].is_none() {
                    inside[neighbour.fix().index()] = Some(here ^ wall(edge));
                    queue.extend(neighbour.as_inner().map(|face| face.fix()));
                }
            }
        }
        inside.into_iter().map(|side| side.unwrap_or(false)).collect()
    }

    fn inner_triangles(&self) -> Vec<[u32; 3]> {
        let inside = self.inside();
        let inner = self.cdt.inner_faces().filter(|face| inside[face.fix().index()]);
        inner.map(|face| face.vertices().map(|v| v.data().node)).collect()
    }

    /// Where a triangle or a side between two triangles is off the surface by more than the chord tolerance: for
    /// each of the given triangles the worst place.
    fn too_coarse(&mut self, open: &[FixedFaceHandle<InnerTag>], tolerances: &Tolerances) -> Vec<Wanted> {
        let mut wanted = Vec::new();
        let reach = self.shape.reach();
        let Self { cdt, nodes, sides: known, shape, .. } = self;
        known.resize(cdt.num_undirected_edges(), ([u32::MAX; 2], 0.0));
        let chord = tolerances.chord;
        let in_doubt = |off: f64| off > DOUBT[0] * chord && off < DOUBT[1] * chord;
        for &face in open {
            let face = cdt.face(face);
            let vertices = face.vertices();
            let [a, b, c] = vertices.map(|v| &nodes[v.data().node as usize]);
            let lengths =
                [(b.point - a.point).norm(), (c.point - b.point).norm(), (a.point - c.point).norm()];
            if lengths.iter().all(|&length| length < SMALLEST * chord) {
                continue;
            }
            let middle = [0, 1].map(|k| (a.uv[k] + b.uv[k] + c.uv[k]) / 3.0);
            let normal = (b.point - a.point).cross(&(c.point - a.point)).try_normalize(0.0);
            let bulge = [(a, b), (b, c), (c, a)].map(|(a, b)| bulge(a, b, reach));
            let mut off = match bulge {
                // Of what vanishes at the corners and is quadratic, 4/9 of the sum at the sides' middles.
                [Some(first), Some(second), Some(third)] => {
                    normal.map_or(0.0, |n| 4.0 / 9.0 * (first + second + third).dot(&n).abs())
                }
                _ => chord,
            };
            if in_doubt(off) {
                off = normal.map_or(0.0, |n| (shape.point(middle[0], middle[1]) - a.point).dot(&n).abs());
            }
            let mut worst = (off, middle);
            for edge in face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge()) {
                let mut ends = edge.vertices().map(|v| v.data().node);
                ends.sort_unstable();
                let [from, to] = ends.map(|node| &nodes[node as usize]);
                let middle = [0, 1].map(|k| 0.5 * (from.uv[k] + to.uv[k]));
                let slot = &mut known[edge.fix().as_undirected().index()];
                if slot.0 != ends {
                    let mut off = off_chord(from, to, reach).unwrap_or(chord);
                    if in_doubt(off) {
                        off = off_segment(&shape.point(middle[0], middle[1]), &from.point, &to.point);
                    }
                    *slot = (ends, off);
                }
                if slot.1 > worst.0 {
                    worst = (slot.1, middle);
                }
            }
            if worst.0 > chord {
                wanted.push(Wanted { uv: worst.1, near: vertices[0].fix() });
            }
        }
        wanted
    }
}

/// Whether a cubic with the tangents of its ends says anything of the surface between two nodes.
fn is_within(from: &Node, to: &Node, reach: [f64; 2]) -> bool {
    (0..2).all(|k| (to.uv[k] - from.uv[k]).abs() <= reach[k])
}

/// Tangents of the surface at two nodes along the straight way from one to the other in the parameter plane.
fn along(from: &Node, to: &Node) -> [Vector3<f64>; 2] {
    let way = [0, 1].map(|k| to.uv[k] - from.uv[k]);
    [from, to].map(|node| node.tangents[0] * way[0] + node.tangents[1] * way[1])
}

/// The middle of the cubic between two nodes, less the middle of its chord.
fn bulge(from: &Node, to: &Node, reach: [f64; 2]) -> Option<Vector3<f64>> {
    is_within(from, to, reach).then(|| {
        let [first, last] = along(from, to);
        (first - last) / 8.0
    })
}

/// Greatest distance of the cubic between two nodes from its chord, at its quarters.
fn off_chord(from: &Node, to: &Node, reach: [f64; 2]) -> Option<f64> {
    if !is_within(from, to, reach) {
        return None;
    }
    let [first, last] = along(from, to);
    let chord = to.point - from.point;
    let square = chord.norm_squared();
    // Hermite's cubic in Bernstein's form, without what lies along the chord.
    let quarters = [(9.0, 3.0), (8.0, 8.0), (3.0, 9.0)].map(|(a, b)| (first * a - last * b) / 64.0);
    let across = |off: Vector3<f64>| {
        if square > 0.0 { off.norm_squared() - off.dot(&chord).powi(2) / square } else { off.norm_squared() }
    };
    Some(quarters.map(across).into_iter().fold(0.0, f64::max).sqrt())
}

/// Distance of a point of the plane from a segment.
fn distance([x, y]: [f64; 2], [a, b]: &[[f64; 2]; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let t = if square > 0.0 { (((x - a[0]) * dx + (y - a[1]) * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a[0] + t * dx - x).hypot(a[1] + t * dy - y)
}

/// Distance of a point in space from a segment.
fn off_segment(point: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let along = to - from;
    let square = along.norm_squared();
    let t = if square > 0.0 { ((point - from).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (from + along * t - point).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const TOLERANCES: Tolerances = Tolerances { chord: 0.01, angle: 0.3 };

    fn plane(u: f64, v: f64) -> SurfaceDerivatives {
        let zero = Vector3::zeros();
        let (du, dv) = (Vector3::x(), Vector3::y());
        SurfaceDerivatives { point: Point3::new(u, v, 0.0), du, dv, duu: zero, duv: zero, dvv: zero }
    }

    /// `(r cos u, r sin u, v)`.
    fn cylinder(u: f64, v: f64) -> SurfaceDerivatives {
        let (sin, cos) = u.sin_cos();
        let zero = Vector3::zeros();
        SurfaceDerivatives {
            point: Point3::new(5.0 * cos, 5.0 * sin, v),
            du: Vector3::new(-5.0 * sin, 5.0 * cos, 0.0),
            dv: Vector3::z(),
            duu: Vector3::new(-5.0 * cos, -5.0 * sin, 0.0),
            duv: zero,
            dvv: zero,
        }
    }

    /// The graph of `z = (u² + v²) / 2`.
    fn bowl(u: f64, v: f64) -> SurfaceDerivatives {
        SurfaceDerivatives {
            point: Point3::new(u, v, 0.5 * (u * u + v * v)),
            du: Vector3::new(1.0, 0.0, u),
            dv: Vector3::new(0.0, 1.0, v),
            duu: Vector3::z(),
            duv: Vector3::zeros(),
            dvv: Vector3::z(),
        }
    }

    fn corners(
        evaluate: impl Fn(f64, f64) -> SurfaceDerivatives,
        first: u32,
        uvs: &[[f64; 2]],
    ) -> Vec<Corner> {
        let corner =
            |(&uv, vertex): (&[f64; 2], u32)| Corner { uv, vertex, point: evaluate(uv[0], uv[1]).point };
        uvs.iter().zip(first..).map(corner).collect()
    }

    fn circle(count: u32, radius: f64, center: [f64; 2]) -> Vec<[f64; 2]> {
        let angle = |k| TAU * f64::from(k) / f64::from(count);
        (0..count)
            .map(|k| [center[0] + radius * angle(k).cos(), center[1] + radius * angle(k).sin()])
            .collect()
    }

    fn area(region: &Region) -> f64 {
        let corner = |at: u32| region.nodes[at as usize].point;
        let area = |[a, b, c]: [Point3<f64>; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
        region.triangles.iter().map(|t| area(t.map(corner))).sum()
    }

    #[test]
    fn a_plane_with_holes_needs_no_inner_points_and_has_its_area() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
        let hole = circle(40, 0.5, [1.0, 1.0]);
        let mut loops = vec![corners(plane, 0, &square), corners(plane, 4, &hole)];
        let polygon = 0.5 * 40.0 * 0.25 * (TAU / 40.0).sin();
        for _ in 0..2 {
            let region = triangulate(&loops, &TOLERANCES, 1000, &plane).expect("a good region");
            assert!((area(&region) - (12.0 - polygon)).abs() < 1e-12);
            assert_eq!(region.nodes.len(), 44);
            // n points, h holes: n + 2 h - 2 triangles.
            assert_eq!(region.triangles.len(), 44);
            loops[1].reverse();
        }
    }

    #[test]
    fn an_island_in_a_hole_is_inside_and_a_slit_is_not_a_wall() {
        let outer = circle(30, 3.0, [0.0, 0.0]);
        let loops: Vec<_> =
            [(outer, 0), (circle(30, 2.0, [0.0, 0.0]), 30), (circle(30, 1.0, [0.0, 0.0]), 60)]
                .map(|(uvs, first)| corners(plane, first, &uvs))
                .into();
        let region = triangulate(&loops, &TOLERANCES, 1000, &plane).expect("a good region");
        let polygon = |r: f64| 15.0 * r * r * (TAU / 30.0).sin();
        assert!((area(&region) - (polygon(3.0) - polygon(2.0) + polygon(1.0))).abs() < 1e-12);
        // A square with a slit from its first corner to the middle and back.
        let slit = [[0.0, 0.0], [1.0, 1.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mut slit = corners(plane, 0, &slit);
        slit[2].vertex = 0;
        let region = triangulate(&[slit], &TOLERANCES, 1000, &plane).expect("a good region");
        assert!((area(&region) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_curved_face_keeps_the_chord_tolerance() {
        let rectangle = |count: u32, [width, height]: [f64; 2]| -> Vec<[f64; 2]> {
            let share = |k: u32| f64::from(k) / f64::from(count);
            let bottom = (0..count).map(|k| [width * share(k), 0.0]);
            let top = (0..count).map(|k| [width * (1.0 - share(k)), height]);
            let sides = [[width, 0.0], [0.0, height]].into_iter();
            let mut all: Vec<_> =
                bottom.chain(sides.clone().take(1)).chain(top).chain(sides.skip(1)).collect();
            all.dedup();
            all
        };
        let side = corners(cylinder, 0, &rectangle(60, [PI, 7.0]));
        let region = triangulate(&[side], &TOLERANCES, 10_000, &cylinder).expect("a good region");
        let exact = PI * 5.0 * 7.0;
        assert!((area(&region) - exact).abs() < 2e-3 * exact, "{}", area(&region));
        // Three points lie on the cylinder, so the greatest distance is the sagitta of the longest angle.
        for triangle in &region.triangles {
            let us = triangle.map(|at| region.nodes[at as usize].uv[0]);
            let angle = us.iter().fold(0.0, |a: f64, u| a.max((u - us[0]).abs()));
            assert!(5.0 * (1.0 - (0.5 * angle).cos()) <= 0.0101);
        }
        let disc = corners(bowl, 0, &circle(100, 2.0, [0.0, 0.0]));
        let region = triangulate(&[disc], &TOLERANCES, 10_000, &bowl).expect("a good region");
        let exact = TAU / 3.0 * (5f64.powf(1.5) - 1.0);
        assert!((area(&region) - exact).abs() < 5e-3 * exact, "{} {exact}", area(&region));
        for triangle in &region.triangles {
            let uv =
                [0, 1].map(|k| triangle.iter().map(|&at| region.nodes[at as usize].uv[k]).sum::<f64>() / 3.0);
            let plane = triangle.iter().map(|&at| region.nodes[at as usize].point.z).sum::<f64>() / 3.0;
            // Distance along the surface's normal, to first order.
            let slope = (1.0 + uv[0] * uv[0] + uv[1] * uv[1]).sqrt();
            assert!((plane - bowl(uv[0], uv[1]).point.z) / slope < 0.0101);
        }
        assert!(region.triangles.len() < 3000, "{}", region.triangles.len());
    }

    #[test]
    fn crossing_degenerate_and_too_many_are_told_apart() {
        let bow_tie = corners(plane, 0, &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        let result = triangulate(&[bow_tie], &TOLERANCES, 1000, &plane);
        assert!(matches!(result, Err(RegionError::Crossing(_))), "{result:?}");
        let line = corners(plane, 0, &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
        assert_eq!(triangulate(&[line], &TOLERANCES, 1000, &plane), Err(RegionError::Degenerate));
        let nan = corners(plane, 0, &[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]);
        assert!(triangulate(&[nan], &TOLERANCES, 1000, &plane).is_err());
        assert_eq!(triangulate(&[], &TOLERANCES, 1000, &plane), Err(RegionError::Degenerate));
        let disc = corners(bowl, 0, &circle(100, 2.0, [0.0, 0.0]));
        assert_eq!(triangulate(&[disc], &TOLERANCES, 101, &bowl), Err(RegionError::TooMany));
    }
}
