//! Products, their shapes and their uses in each other: ISO 10303-41 and -44.
//!
//! Parts keep their own coordinates: where an assembly puts them is not looked at.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::code::ModelCode;
use super::error::ReadError;
use super::roots::Roots;
use super::scope::Scope;
use crate::diagnostic::Sink;
use crate::model::{Occurrence, Origin, Product};
use crate::step::entity::Entity;
use crate::step::{InstanceName, ParameterKind, string};

/// Representations that are looked at to find the product of one: real files need two or three.
const MAX_RELATED_REPRESENTATIONS: usize = 64;

/// Products of a file, and which representation is a shape of which.
pub(super) struct Products {
    pub(super) all: Vec<Product>,
    index: BTreeMap<InstanceName, usize>,
    /// Product of a representation that a shape definition names.
    of_representation: BTreeMap<InstanceName, usize>,
    /// Equivalent representations, both ways.
    related: BTreeMap<InstanceName, Vec<InstanceName>>,
}

impl Products {
    /// Reads all product definitions with their shapes.
    pub(super) fn read(scope: Scope<'_>, roots: &Roots, sink: &mut dyn Sink) -> Self {
        let mut products = Self {
            all: Vec::new(),
            index: BTreeMap::new(),
            of_representation: BTreeMap::new(),
            related: BTreeMap::new(),
        };
        for &name in &roots.products {
            let product = product(scope, name, sink).unwrap_or_else(|error| {
                let message = format!("PRODUCT_DEFINITION: {error}");
                sink.report(ModelCode::BadReference.at(scope.file, name, message));
                Product { id: String::new(), name: String::new(), origin: Origin::Instance(name.0) }
            });
            products.index.insert(name, products.all.len());
            products.all.push(product);
        }
        for &name in &roots.shape_definitions {
            if let Some((representation, product)) = products.shape(scope, name) {
                products.of_representation.entry(representation).or_insert(product);
            }
        }
        for &name in &roots.relationships {
            if let Ok((a, b)) = pair(scope, name, "rep_1", "rep_2") {
                products.related.entry(a).or_default().push(b);
                products.related.entry(b).or_default().push(a);
            }
        }
        products
    }

    /// Lets a representation that maps another stand for its product, where nothing nearer does.
    pub(super) fn relate_mapping(&mut self, mapping: InstanceName, mapped: InstanceName) {
        self.related.entry(mapped).or_default().push(mapping);
    }

    /// Product that a representation is a shape of, itself or by the nearest related representation.
    pub(super) fn of(&self, representation: InstanceName) -> Option<usize> {
        let mut seen = BTreeSet::from([representation]);
        let mut queue = VecDeque::from([representation]);
        while let Some(current) = queue.pop_front() {
            if let Some(&product) = self.of_representation.get(&current) {
                return Some(product);
            }
            for &next in self.related.get(&current).into_iter().flatten() {
                if seen.len() < MAX_RELATED_REPRESENTATIONS && seen.insert(next) {
                    queue.push_back(next);
                }
            }
        }
        None
    }

    /// The uses of products in each other.
    pub(super) fn occurrences(
        &self,
        scope: Scope<'_>,
        roots: &Roots,
        sink: &mut dyn Sink,
    ) -> Vec<Occurrence> {
        let mut occurrences = Vec::new();
        for &name in &roots.occurrences {
            let ends = pair(scope, name, "relating_product_definition", "related_product_definition");
            let known = ends.ok().and_then(|(a, b)| Some((*self.index.get(&a)?, *self.index.get(&b)?)));
            let Some((parent, child)) = known else {
                let message = "NEXT_ASSEMBLY_USAGE_OCCURRENCE: its product definitions are not in the file";
                sink.report(ModelCode::BadReference.at(scope.file, name, message.to_owned()));
                continue;
            };
            let text = scope.view(name).map(|view| view.text("name").into_owned()).unwrap_or_default();
            occurrences.push(Occurrence { parent, child, name: text });
        }
        occurrences
    }

    /// Representation and product of a shape definition representation; none when it defines the shape of
    /// an aspect or of an occurrence.
    fn shape(&self, scope: Scope<'_>, name: InstanceName) -> Option<(InstanceName, usize)> {
        let (definition, representation) = pair(scope, name, "definition", "used_representation").ok()?;
        let property = scope.view_of(definition, Entity::PropertyDefinition).ok()?;
        let product = self.index.get(&property.reference("definition").ok()?)?;
        Some((representation, *product))
    }
}

fn pair(
    scope: Scope<'_>,
    name: InstanceName,
    first: &'static str,
    second: &'static str,
) -> Result<(InstanceName, InstanceName), ReadError> {
    let view = scope.view(name)?;
    Ok((view.reference(first)?, view.reference(second)?))
}

fn product(scope: Scope<'_>, definition: InstanceName, sink: &mut dyn Sink) -> Result<Product, ReadError> {
    let view = scope.view(definition)?;
    let formation = scope.view_of(view.reference("formation")?, Entity::ProductDefinitionFormation)?;
    let product = scope.view_of(formation.reference("of_product")?, Entity::Product)?;
    for attribute in ["id", "name"] {
        if let Some(text) = product.get(attribute)
            && text.kind() == ParameterKind::String
            && string::decode(text.text()).lossy
        {
            let message = format!("PRODUCT: {attribute} has bytes that are not UTF-8, shown as ISO 8859-1");
            sink.report(ModelCode::RawString.at(scope.file, product.name(), message));
        }
    }
    Ok(Product {
        id: product.text("id").into_owned(),
        name: product.text("name").into_owned(),
        origin: Origin::Instance(definition.0),
    })
}
