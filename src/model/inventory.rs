//! What is in a model, counted.
//!
//! Counts elements of the model, each once: a part that an assembly uses five times counts once. Measures
//! nothing that needs an integral; volume and area are the mesh's and the validators' knowledge.

use std::collections::{BTreeMap, BTreeSet};

use super::{Context, Model};
use crate::brep::{BodyKind, VertexId};
use crate::geometry::Carried;
use crate::math::Point3;

/// Counts of one model.
#[derive(Debug, Clone, PartialEq)]
pub struct Inventory {
    /// Schema names of the header.
    pub schema: Vec<String>,
    /// Distinct contexts, in the order of their first use.
    pub contexts: Vec<Context>,
    /// Product definitions.
    pub products: usize,
    /// Uses of products in each other.
    pub occurrences: usize,
    /// Solid bodies.
    pub solids: usize,
    /// Bodies of surfaces without an inside.
    pub surface_bodies: usize,
    /// Shells.
    pub shells: usize,
    /// Faces.
    pub faces: usize,
    /// Edges that a loop uses.
    pub edges: usize,
    /// Vertices that a used edge or a vertex loop has.
    pub vertices: usize,
    /// Curves that belong to no edge.
    pub curves: usize,
    /// Faces by the kind of their surface; those of unread surfaces are in `unread_surfaces`.
    pub surfaces: BTreeMap<&'static str, usize>,
    /// Faces whose surface or bounds are only carried, by the surface's entity name; an empty name where the
    /// file has no such record.
    pub unread_surfaces: BTreeMap<String, usize>,
    /// Used edges and free curves that are only carried, by entity name.
    pub unread_curves: BTreeMap<String, usize>,
    /// Least and greatest coordinates of the used vertices, in file units. Curved edges and faces may reach
    /// further. `None` without vertices, or when bodies of different length units meet.
    pub vertex_extents: Option<[Point3<f64>; 2]>,
}

impl Inventory {
    /// Counts a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let brep = &model.brep;
        let solids = brep.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Solid).count();
        let mut inventory = Self {
            schema: model.schema.clone(),
            contexts: distinct(&model.contexts),
            products: model.products.len(),
            occurrences: model.occurrences.len(),
            solids,
            surface_bodies: brep.bodies.len() - solids,
            shells: brep.shells.len(),
            faces: brep.faces.len(),
            edges: 0,
            vertices: 0,
            curves: model.free_curves.len(),
            surfaces: BTreeMap::new(),
            unread_surfaces: BTreeMap::new(),
            unread_curves: BTreeMap::new(),
            vertex_extents: None,
        };
        inventory.count_surfaces(model);
        inventory.count_curves(model);
        inventory.measure(model);
        inventory
    }

    fn count_surfaces(&mut self, model: &Model) {
        for face in model.brep.faces.ids() {
            match model.brep.surface_of(face) {
                Carried::Read(surface) => *self.surfaces.entry(surface.kind()).or_insert(0) += 1,
                Carried::Unread { entity, .. } => {
                    *self.unread_surfaces.entry(entity.clone()).or_insert(0) += 1;
                }
            }
        }
    }

    fn count_curves(&mut self, model: &Model) {
        let brep = &model.brep;
        let edges: BTreeSet<_> = brep.coedges.iter().map(|(_, coedge)| coedge.edge).collect();
        self.edges = edges.len();
        let curves =
            edges.iter().map(|&edge| brep.edges[edge].curve).chain(model.free_curves.iter().copied());
        for curve in curves {
            if let Carried::Unread { entity, .. } = &brep.curves[curve] {
                *self.unread_curves.entry(entity.clone()).or_insert(0) += 1;
            }
        }
    }

    fn measure(&mut self, model: &Model) {
        let vertices = used_vertices(model);
        self.vertices = vertices.len();
        let unit = |body: &usize| model.contexts[*body].length.metres.to_bits();
        let units: BTreeSet<u64> = model.body_context.iter().map(|(_, context)| unit(context)).collect();
        if units.len() > 1 {
            return;
        }
        for vertex in vertices {
            let point = model.brep.vertices[vertex].point;
            let [low, high] = self.vertex_extents.get_or_insert([point, point]);
            *low = low.inf(&point);
            *high = high.sup(&point);
        }
    }
}

fn used_vertices(model: &Model) -> BTreeSet<VertexId> {
    let brep = &model.brep;
    let of_edges = brep.coedges.iter().map(|(_, coedge)| &brep.edges[coedge.edge]);
    let of_loops = brep.loops.iter().filter_map(|(_, bound)| bound.vertex);
    of_edges.flat_map(|edge| [edge.start, edge.end]).chain(of_loops).collect()
}

fn distinct(contexts: &[Context]) -> Vec<Context> {
    let mut kept: Vec<Context> = Vec::new();
    for context in contexts {
        if !kept.contains(context) {
            kept.push(context.clone());
        }
    }
    kept
}
