//! What two models say beside their geometry: products, units, annotations.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::model::{Instances, Model};

/// A difference that is not one of shape.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StructureChange {
    /// Stable word: `product`, `unit`, `annotation`, `name`, `colour`, `layer`, `transparency`, `hidden`, `body`.
    pub what: &'static str,
    /// What is where.
    pub message: String,
}

/// Something of a model that is counted by name.
type CountsOf = fn(&Model) -> BTreeMap<String, usize>;

pub(super) fn differences(before: &Model, after: &Model) -> Vec<StructureChange> {
    let mut changes = Vec::new();
    let counted: [(&'static str, CountsOf); 4] =
        [("product", products), ("unit", units), ("annotation", annotations), ("body", bodies)];
    for (what, count) in counted {
        let (a, b) = (count(before), count(after));
        let names: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        for name in names {
            let of = |counts: &BTreeMap<String, usize>| counts.get(name).copied().unwrap_or(0);
            if of(&a) != of(&b) {
                let message = format!("{name}: {} before, {} after", of(&a), of(&b));
                changes.push(StructureChange { what, message });
            }
        }
    }
    changes
}

/// What differs without being a difference.
pub(super) fn notes(before: &Model, after: &Model) -> Vec<String> {
    let schema = |model: &Model| model.schema.join(", ");
    let differs = schema(before) != schema(after);
    differs
        .then(|| format!("schema: {} before, {} after", schema(before), schema(after)))
        .into_iter()
        .collect()
}

/// Paths of the product tree with how often each is there.
fn products(model: &Model) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    let Some(context) = model.contexts.first() else { return counts };
    let instances = Instances::of(model, &context.length, Instances::LIMIT);
    for at in 0..instances.nodes.len() {
        let name = |node: usize| model.products[instances.nodes[node].product].name.as_str();
        let path: Vec<&str> = instances.path(at).into_iter().map(name).collect();
        *counts.entry(format!("\"{}\"", path.join(" / "))).or_insert(0) += 1;
    }
    counts
}

/// Units in use: of the contexts that bodies have.
fn units(model: &Model) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    for (_, &context) in model.body_context.iter() {
        found.insert(model.contexts[context].length.name.clone(), 1);
    }
    found
}

fn annotations(model: &Model) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for annotation in &model.annotations {
        *counts.entry(annotation.kind.as_str().to_owned()).or_insert(0) += 1;
    }
    counts
}

fn bodies(model: &Model) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for (_, body) in model.brep.bodies.iter() {
        let kind = match body.kind {
            crate::brep::BodyKind::Solid => "solids",
            crate::brep::BodyKind::Surface => "sets of surfaces",
        };
        *counts.entry(kind.to_owned()).or_insert(0) += 1;
    }
    counts
}
