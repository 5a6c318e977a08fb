//! Counts and sizes of a model, for reports and for comparing a part before and after.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::brep::BodyKind;
use crate::geometry::{Carried, Surface};
use crate::model::Model;

/// What is inside a part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Figures {
    /// Names of the application protocol, as the file writes them.
    pub schema: Vec<String>,
    /// Units of length, one for each context: `mm`.
    pub units: Vec<String>,
    /// Counts of `products`, `solids`, `shells`, `faces`, `edges`, `vertices`, `curves`.
    pub counts: BTreeMap<String, usize>,
    /// Count of surfaces by kind; those that are not read yet by the name of their entity.
    pub surfaces: BTreeMap<String, usize>,
    /// Least and greatest coordinates of the vertices, in file units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertex_extents: Option<[[f64; 3]; 2]>,
}

impl Figures {
    /// Counts a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let brep = &model.brep;
        let solids = brep.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Solid).count();
        let counts = [
            ("products", model.products.len()),
            ("bodies", brep.bodies.len()),
            ("solids", solids),
            ("shells", brep.shells.len()),
            ("faces", brep.faces.len()),
            ("edges", brep.edges.len()),
            ("vertices", brep.vertices.len()),
            ("curves", brep.curves.len()),
        ];
        let mut surfaces = BTreeMap::new();
        for face in brep.faces.ids() {
            *surfaces.entry(kind(brep.surface_of(face))).or_insert(0) += 1;
        }
        Self {
            schema: model.schema.clone(),
            units: model.contexts.iter().map(|context| context.length.name.clone()).collect(),
            counts: counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect(),
            surfaces,
            vertex_extents: vertex_extents(model),
        }
    }

    /// How much greater the diagonal of `after` is than this one's: at least 1.
    #[must_use]
    pub fn growth(&self, after: &Self) -> f64 {
        let diagonal = |figures: &Self| {
            let [low, high] = figures.vertex_extents?;
            Some((0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt())
        };
        match (diagonal(self), diagonal(after)) {
            (Some(before), Some(after)) if before > 0.0 => (after / before).max(1.0),
            _ => 1.0,
        }
    }

    /// Names of the counts in which two parts differ, with both counts.
    #[must_use]
    pub fn differing_counts(&self, other: &Self) -> Vec<(String, usize, usize)> {
        let count = |figures: &Self, name: &str| figures.counts.get(name).copied().unwrap_or(0);
        let differing = self.counts.keys().map(|name| (name.clone(), count(self, name), count(other, name)));
        differing.filter(|(_, before, after)| before != after).collect()
    }
}

/// Word for a face's surface: its kind, or the entity that is not read.
#[must_use]
pub fn kind(surface: &Carried<Surface>) -> String {
    match surface {
        Carried::Read(surface) => surface.kind().to_owned(),
        Carried::Unread { entity, .. } if entity.is_empty() => "missing".to_owned(),
        Carried::Unread { entity, .. } => entity.clone(),
    }
}

fn vertex_extents(model: &Model) -> Option<[[f64; 3]; 2]> {
    let mut extents: Option<[[f64; 3]; 2]> = None;
    for (_, vertex) in model.brep.vertices.iter() {
        let point = [vertex.point.x, vertex.point.y, vertex.point.z];
        let [least, greatest] = extents.get_or_insert([point, point]);
        for k in 0..3 {
            least[k] = least[k].min(point[k]);
            greatest[k] = greatest[k].max(point[k]);
        }
    }
    extents
}
