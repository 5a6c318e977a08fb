//! What `inspect` tells of a part.

use std::collections::BTreeSet;

use serde::Serialize;

use super::measure::{Figures, kind};
use super::select;
use crate::brep::FaceId;
use crate::model::Model;

/// What is inside a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contents {
    /// Counts and sizes.
    #[serde(flatten)]
    pub figures: Figures,
    /// Products in file order.
    pub products: Vec<ProductEntry>,
    /// Faces that were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<FaceEntry>,
}

/// A product.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProductEntry {
    /// Record of its definition.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Names of the products that it is used in, once for each use.
    pub used_in: Vec<String>,
}

/// A face.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaceEntry {
    /// Its record.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Kind of its surface, or the entity that is not read.
    pub surface: String,
    /// Its own or its body's colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
    /// Layers that it lies on.
    pub layers: Vec<String>,
    /// Its product.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub product: Option<String>,
    /// Count of bounds.
    pub loops: usize,
    /// Area of its triangulation, in square file units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Least and greatest coordinates of its triangulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Faces that share an edge with it.
    pub neighbours: Vec<String>,
}

/// The contents of a model, with the given faces in detail.
#[must_use]
pub fn contents(model: &Model, faces: &[FaceId]) -> Contents {
    let products = model.products.iter().enumerate().map(|(at, product)| {
        let uses = model.occurrences.iter().filter(|occurrence| occurrence.child == at);
        ProductEntry {
            id: product.origin.to_string(),
            name: product.name.clone(),
            used_in: uses.map(|occurrence| model.products[occurrence.parent].name.clone()).collect(),
        }
    });
    let users = if faces.is_empty() { None } else { Some(model.brep.faces_of_edges()) };
    let neighbours = |face: FaceId| -> BTreeSet<FaceId> {
        let edges = model.brep.coedges_of(face).map(|coedge| model.brep.coedges[coedge].edge);
        let users = users.iter();
        edges
            .flat_map(|edge| users.clone().flat_map(move |u| u[edge].clone()))
            .filter(|&f| f != face)
            .collect()
    };
    let face_entry = |&face: &FaceId| {
        let shape = select::shape(model, face);
        FaceEntry {
            id: model.origins.faces[face].to_string(),
            name: model.faces[face].name.clone(),
            surface: kind(model.brep.surface_of(face)),
            colour: model.colour_of(face).map(|colour| select::hex(select::bytes(colour))),
            layers: select::layers(model, face),
            product: model.product_of(face).map(|product| product.name.clone()),
            loops: model.brep.faces[face].loops.len(),
            area: shape.as_ref().map(|shape| shape.area),
            bounds: shape.map(|shape| shape.bounds),
            neighbours: neighbours(face).into_iter().map(|f| model.origins.faces[f].to_string()).collect(),
        }
    };
    Contents {
        figures: Figures::of(model),
        products: products.collect(),
        faces: faces.iter().map(face_entry).collect(),
    }
}
