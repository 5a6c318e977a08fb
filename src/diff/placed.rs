//! The faces of a model where its assembly has them, in a common unit, with the triangles that stand for them.

use std::collections::{BTreeMap, BTreeSet};

use super::Named;
use crate::brep::{BodyId, EdgeSampling, FaceId, sample_edge};
use crate::geometry::Carried;
use crate::math::{Affine, BoundingBox, Point3};
use crate::mesh::{Mesh, Tolerances, tessellate_faces};
use crate::model::{Instances, Model, PlacedBody};
use crate::units::LengthUnit;

/// Something of each face and of points on it, in its body's coordinates.
pub type OverFace<'a, T> = dyn Fn(FaceId, &[Point3<f64>]) -> T + 'a;

/// One of the two models.
#[derive(Debug)]
pub struct Side<'a> {
    /// The model.
    pub model: &'a Model,
    /// Unit of everything that is compared.
    pub unit: LengthUnit,
    /// Its assembly, unfolded.
    pub instances: Instances,
    /// Every face at every place.
    pub faces: Vec<PlacedFace>,
    meshes: BTreeMap<FaceId, Mesh>,
    missing: Vec<FaceId>,
}

/// A face where the assembly has it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedFace {
    /// The face.
    pub face: FaceId,
    /// Its placed body: an index into the instances' bodies.
    pub placed: usize,
    /// From the body's coordinates to the common ones.
    pub transform: Affine,
    /// Area of its triangles.
    pub area: f64,
    /// Centroid of its triangles; of its vertices where there are none.
    pub middle: Point3<f64>,
    /// Box of its triangles and vertices.
    pub bounds: BoundingBox,
}

impl<'a> Side<'a> {
    /// Unfolds a model in a unit.
    #[must_use]
    pub fn new(model: &'a Model, unit: &LengthUnit) -> Self {
        let instances = Instances::of(model, unit, Instances::LIMIT);
        let (mut meshes, mut missing) = (BTreeMap::new(), Vec::new());
        let bodies: BTreeSet<BodyId> = instances.bodies.iter().map(|placed| placed.body).collect();
        for body in bodies {
            mesh_body(model, body, &mut meshes, &mut missing);
        }
        let mut side = Self { model, unit: unit.clone(), instances, faces: Vec::new(), meshes, missing };
        let places: Vec<(usize, PlacedBody)> = side.instances.bodies.iter().cloned().enumerate().collect();
        for (at, placed) in places {
            let faces = faces_of(model, placed.body);
            let placed_faces = faces.map(|face| side.place(face, at, &placed.transform)).collect::<Vec<_>>();
            side.faces.extend(placed_faces);
        }
        side
    }

    fn place(&self, face: FaceId, placed: usize, transform: &Affine) -> PlacedFace {
        let vertices = || vertices(self.model, face).map(|p| transform.point(&p));
        let mut bounds = BoundingBox::EMPTY;
        vertices().for_each(|point| bounds.include(&point));
        let (mut area, mut moment) = (0.0, crate::math::Vector3::zeros());
        for [a, b, c] in self.meshes.get(&face).into_iter().flat_map(Mesh::corners) {
            let [a, b, c] = [a, b, c].map(|p| transform.point(&p));
            let part = 0.5 * (b - a).cross(&(c - a)).norm();
            area += part;
            moment += (a.coords + b.coords + c.coords) * (part / 3.0);
            [a, b, c].iter().for_each(|point| bounds.include(point));
        }
        let middle = if area > 0.0 {
            Point3::from(moment / area)
        } else {
            let count = vertices().count().max(1) as f64;
            Point3::from(vertices().map(|p| p.coords).sum::<crate::math::Vector3<f64>>() / count)
        };
        PlacedFace { face, placed, transform: *transform, area, middle, bounds }
    }

    /// Its triangles in the body's coordinates; `None` where it has none.
    pub(super) fn mesh(&self, face: &PlacedFace) -> Option<&Mesh> {
        self.meshes.get(&face.face)
    }

    /// Triangles of everything at its place, with the face of each triangle.
    #[must_use]
    pub fn whole_mesh(&self) -> Mesh {
        let mut whole = Mesh::default();
        for face in &self.faces {
            if let Some(mesh) = self.mesh(face) {
                whole.append(&mesh.transformed(&face.transform));
            }
        }
        whole
    }

    /// A number at each vertex of [`whole_mesh`](Self::whole_mesh): `values` gets a face and points in its body's coordinates.
    #[must_use]
    pub fn over_whole_mesh(&self, values: &OverFace<Vec<f64>>) -> Vec<f64> {
        let meshes = self.faces.iter().filter_map(|face| Some((face.face, self.mesh(face)?)));
        meshes.flat_map(|(face, mesh)| values(face, &mesh.vertices)).collect()
    }

    /// How its file names it.
    pub(super) fn named(&self, face: &PlacedFace) -> Named {
        Named {
            id: self.model.origins.faces[face.face].to_string(),
            name: self.model.faces[face.face].name.clone(),
            kind: super::kind_of(self.model, face.face),
            product: self.product_path(self.instances.bodies[face.placed].node),
        }
    }

    /// Names of the products from the root down to a node.
    pub(super) fn product_path(&self, node: Option<usize>) -> String {
        let name = |node: usize| self.model.products[self.instances.nodes[node].product].name.as_str();
        let path = node.map(|node| self.instances.path(node)).unwrap_or_default();
        path.into_iter().map(name).collect::<Vec<_>>().join(" / ")
    }

    /// What could not be looked at.
    pub(super) fn notes(&self, which: &'static str) -> impl Iterator<Item = String> + '_ {
        let names = self.missing.iter().take(5).map(|&face| self.model.origins.faces[face].to_string());
        let names = names.collect::<Vec<_>>().join(", ");
        let faces = (!self.missing.is_empty()).then(|| {
            let count = self.missing.len();
            format!("{count} faces of the {which} part have no triangles and were compared by their numbers alone: {names}")
        });
        let cut =
            self.instances.cut.then(|| format!("the {which} assembly has more places than are compared"));
        faces.into_iter().chain(cut)
    }
}

fn faces_of(model: &Model, body: BodyId) -> impl Iterator<Item = FaceId> + '_ {
    model.brep.bodies[body].shells.iter().flat_map(|&shell| model.brep.shells[shell].faces.iter().copied())
}

pub(super) fn vertices(model: &Model, face: FaceId) -> impl Iterator<Item = Point3<f64>> + '_ {
    let brep = &model.brep;
    let edges = brep.coedges_of(face).map(|coedge| &brep.edges[brep.coedges[coedge].edge]);
    edges.flat_map(|edge| [edge.start, edge.end]).map(|vertex| brep.vertices[vertex].point)
}

/// Triangles of the faces of a body, each by itself and as fine as its own size asks: a small face of a large body would
/// else be all chord.
fn mesh_body(model: &Model, body: BodyId, meshes: &mut BTreeMap<FaceId, Mesh>, missing: &mut Vec<FaceId>) {
    for face in faces_of(model, body) {
        let size = size(model, face);
        let tolerances = Tolerances::for_size(if size > 0.0 { size } else { 1.0 });
        match tessellate_faces(&model.brep, &[face], &tolerances) {
            Ok(mesh) => drop(meshes.insert(face, mesh)),
            Err(_) => missing.push(face),
        }
    }
}

/// Diagonal of the box of the bounds of a face: a closed edge has one vertex and is no point.
fn size(model: &Model, face: FaceId) -> f64 {
    let brep = &model.brep;
    let edges = brep.coedges_of(face).map(|coedge| brep.coedges[coedge].edge);
    let points = edges.filter_map(|edge| sample_edge(brep, edge, &EdgeSampling::default())).flatten();
    let points: Vec<Point3<f64>> = points.map(|at| at.point).collect();
    BoundingBox::of(&points).diagonal()
}

/// Word for carried geometry: its kind, or the entity that is not read.
pub(super) fn kind<G>(carried: &Carried<G>, word: impl Fn(&G) -> &'static str) -> String {
    match carried {
        Carried::Read(geometry) => word(geometry).to_owned(),
        Carried::Unread { entity, .. } => entity.clone(),
    }
}
