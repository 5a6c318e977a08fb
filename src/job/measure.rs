//! Counts and sizes of a model, for reports and for comparing a part before and after.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::geometry::{Carried, Surface};
use crate::model::{Context, Inventory, Model};

/// What is inside a part.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Figures {
    /// Names of the application protocol, as the file writes them.
    pub schema: Vec<String>,
    /// Units of length of the contexts, each once: `mm`.
    pub units: Vec<String>,
    /// Counts of `products`, `solids`, `surface_bodies`, `shells`, `faces`, `edges`, `vertices`, and `curves`
    /// that belong to no edge.
    pub counts: BTreeMap<String, usize>,
    /// Count of surfaces by kind; those that are not read yet by the name of their entity.
    pub surfaces: BTreeMap<String, usize>,
    /// Least and greatest coordinates of the vertices, in file units; absent when units differ within the
    /// file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertex_extents: Option<[[f64; 3]; 2]>,
}

impl Figures {
    /// Counts a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let inventory = Inventory::of(model);
        let Inventory { schema, contexts, surfaces, unread_surfaces, vertex_extents, .. } = &inventory;
        let counts = [
            ("products", inventory.products),
            ("solids", inventory.solids),
            ("surface_bodies", inventory.surface_bodies),
            ("shells", inventory.shells),
            ("faces", inventory.faces),
            ("edges", inventory.edges),
            ("vertices", inventory.vertices),
            ("curves", inventory.curves),
        ];
        let read = surfaces.iter().map(|(kind, count)| ((*kind).to_owned(), *count));
        let unread = unread_surfaces.iter().map(|(entity, count)| (unread_kind(entity), *count));
        Self {
            schema: schema.clone(),
            units: distinct_units(contexts),
            counts: counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect(),
            surfaces: read.chain(unread).collect(),
            vertex_extents: vertex_extents.map(|corners| corners.map(|corner| corner.coords.into())),
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

fn distinct_units(contexts: &[Context]) -> Vec<String> {
    let mut units: Vec<String> = Vec::new();
    for context in contexts {
        if !units.contains(&context.length.name) {
            units.push(context.length.name.clone());
        }
    }
    units
}

/// Word for a face's surface: its kind, or the entity that is not read.
#[must_use]
pub fn kind(surface: &Carried<Surface>) -> String {
    match surface {
        Carried::Read(surface) => surface.kind().to_owned(),
        Carried::Unread { entity, .. } => unread_kind(entity),
    }
}

fn unread_kind(entity: &str) -> String {
    if entity.is_empty() { "missing".to_owned() } else { entity.to_owned() }
}
