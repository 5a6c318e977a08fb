//! What `inspect` tells of a part.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::brep::FaceId;
use crate::job::file::selector::Selector;
use crate::job::operate::select;
use crate::job::report::measure::{BodyMeasures, FaceMeasures, Figures, kind};
use crate::model::{Instances, Model, Node, instance_counts};

/// What is inside a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contents {
    /// Counts and sizes.
    #[serde(flatten)]
    pub figures: Figures,
    /// Products in file order.
    pub products: Vec<ProductEntry>,
    /// The product tree: each instance before its components.
    pub tree: Vec<TreeEntry>,
    /// Whether the tree goes on beyond [`TREE_ENTRIES`].
    pub tree_cut: bool,
    /// Faces by what they have in common, each with a selector that finds them.
    pub groups: Vec<GroupEntry>,
    /// Counts of dimensions, tolerances, datums, presentations, validation properties and tessellations.
    pub annotations: BTreeMap<&'static str, usize>,
    /// Volume, area and centroid of each body, where they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyMeasures>,
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
    /// How often it stands in the unfolded assembly.
    pub instances: u64,
    /// Unit of its coordinates, when it has a shape.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Other files that its shape stands in; they are not opened.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external: Vec<String>,
}

/// A product where the assembly has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TreeEntry {
    /// Uses above it: 0 for a root.
    pub depth: usize,
    /// Name of its product.
    pub product: String,
    /// Record of its product's definition.
    pub id: String,
    /// Name of the use.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occurrence: Option<String>,
    /// Records of the bodies of its own shape.
    pub bodies: Vec<String>,
    /// Images of the three axes and the origin of its coordinates within the root, in the unit of the first context.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placement: Option<[[f64; 3]; 4]>,
}

/// Faces that a selector finds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct GroupEntry {
    /// As in a job file.
    pub selector: String,
    /// How many it finds.
    pub faces: usize,
}

/// Entries of the tree at most: what people and programs still read.
pub const TREE_ENTRIES: usize = 5000;

/// Groups of each kind at most.
const GROUPS: usize = 24;

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
    /// What it measures, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<FaceMeasures>,
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
    let counts = instance_counts(model);
    let products = model.products.iter().enumerate().map(|(at, product)| {
        let uses = model.occurrences.iter().filter(|occurrence| occurrence.child == at);
        ProductEntry {
            id: product.origin.to_string(),
            name: product.name.clone(),
            used_in: uses.map(|occurrence| model.products[occurrence.parent].name.clone()).collect(),
            instances: counts[at],
            unit: product.unit.as_ref().map(|unit| unit.name.clone()),
            external: product.external.clone(),
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
            measured: None,
            area: shape.as_ref().map(|shape| shape.area),
            bounds: shape.map(|shape| shape.bounds),
            neighbours: neighbours(face).into_iter().map(|f| model.origins.faces[f].to_string()).collect(),
        }
    };
    let (tree, tree_cut) = tree(model);
    let mut annotations = BTreeMap::new();
    for annotation in &model.annotations {
        *annotations.entry(annotation.kind.as_str()).or_insert(0) += 1;
    }
    Contents {
        figures: Figures::of(model),
        products: products.collect(),
        tree,
        tree_cut,
        groups: groups(model),
        annotations,
        bodies: Vec::new(),
        faces: faces.iter().map(face_entry).collect(),
    }
}

fn tree(model: &Model) -> (Vec<TreeEntry>, bool) {
    let Some(context) = model.contexts.first() else { return (Vec::new(), false) };
    let instances = Instances::of(model, &context.length, TREE_ENTRIES);
    let mut entries: Vec<TreeEntry> = instances.nodes.iter().map(|node| tree_entry(model, node)).collect();
    for placed in &instances.bodies {
        if let Some(node) = placed.node.and_then(|node| entries.get_mut(node)) {
            node.bodies.push(model.origins.bodies[placed.body].to_string());
        }
    }
    (entries, instances.cut)
}

fn tree_entry(model: &Model, node: &Node) -> TreeEntry {
    let product = &model.products[node.product];
    let transform = &node.transform;
    let columns = || {
        let axis = |k: usize| transform.linear.column(k).into_owned().into();
        [axis(0), axis(1), axis(2), transform.translation.into()]
    };
    TreeEntry {
        depth: node.depth,
        product: product.name.clone(),
        id: product.origin.to_string(),
        occurrence: node.occurrence.map(|at| model.occurrences[at].name.clone()),
        bodies: Vec::new(),
        placement: node.occurrence.map(|_| columns()),
    }
}

/// Selectors by surface, product, colour and layer that find some face, with how many.
fn groups(model: &Model) -> Vec<GroupEntry> {
    let mut words: [BTreeMap<String, usize>; 4] = Default::default();
    for face in model.brep.faces.ids() {
        let mut add = |at: usize, word: String| *words[at].entry(word).or_insert(0) += 1;
        add(0, format!("surface = \"{}\"", kind(model.brep.surface_of(face))));
        if let Some(product) = model.product_of(face).filter(|product| !product.name.is_empty()) {
            add(1, format!("product = {}", quoted(&globset::escape(&product.name))));
        }
        if let Some(colour) = model.colour_of(face) {
            add(2, format!("colour = \"{}\"", select::hex(select::bytes(colour))));
        }
        for layer in select::layers(model, face) {
            add(3, format!("layer = {}", quoted(&globset::escape(&layer))));
        }
    }
    let mut groups = Vec::new();
    for words in words {
        for word in words.into_keys().take(GROUPS) {
            let selector = format!("{{ {word} }}");
            // What the selector finds is asked of the selector: a name may be that of several products.
            let found = selector.parse::<Selector>().ok().and_then(|s| select::faces(model, &s).ok());
            if let Some(found) = found {
                groups.push(GroupEntry { selector, faces: found.len() });
            }
        }
    }
    groups
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
