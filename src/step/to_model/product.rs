//! Products, which representations are shapes of them, and other files that they stand in: ISO 10303-41.
//!
//! Where an assembly puts them is `assembly`'s knowledge.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::code::ModelCode;
use super::error::ReadError;
use super::roots::{Root, Roots};
use super::scope::Scope;
use crate::diagnostic::Sink;
use crate::model::{Appearance, Origin, Product};
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
    /// Representations that shape definitions name, by product.
    pub(super) representations: Vec<Vec<InstanceName>>,
    /// Representation of a use of a product, where a shape definition names one.
    pub(super) of_occurrence: BTreeMap<InstanceName, InstanceName>,
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
            representations: Vec::new(),
            of_occurrence: BTreeMap::new(),
            related: BTreeMap::new(),
        };
        for &name in roots.of(Root::Product) {
            let product = product(scope, name, sink).unwrap_or_else(|error| {
                let message = format!("PRODUCT_DEFINITION: {error}");
                sink.report(ModelCode::BadReference.at(scope.file, name, message));
                named(name, String::new(), String::new())
            });
            products.index.insert(name, products.all.len());
            products.all.push(product);
        }
        products.representations = vec![Vec::new(); products.all.len()];
        for &name in roots.of(Root::ShapeDefinition) {
            products.shape(scope, name);
        }
        for &name in roots.of(Root::Relationship) {
            if let Ok((a, b)) = pair(scope, name, "rep_1", "rep_2") {
                products.related.entry(a).or_default().push(b);
                products.related.entry(b).or_default().push(a);
            }
        }
        products.documents(scope, roots);
        products
    }

    /// Index of a product definition.
    pub(super) fn index(&self, definition: InstanceName) -> Option<usize> {
        self.index.get(&definition).copied()
    }

    /// Product of a representation that a shape definition names.
    pub(super) fn of_representation(&self, representation: InstanceName) -> Option<usize> {
        self.of_representation.get(&representation).copied()
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

    /// Takes in a shape definition representation: of a product, or of a use of one. Aspects of shapes are
    /// passed over.
    fn shape(&mut self, scope: Scope<'_>, name: InstanceName) -> Option<()> {
        let (definition, representation) = pair(scope, name, "definition", "used_representation").ok()?;
        let property = scope.view_of(definition, Entity::PropertyDefinition).ok()?;
        let definition = property.reference("definition").ok()?;
        if let Some(&product) = self.index.get(&definition) {
            self.of_representation.entry(representation).or_insert(product);
            if !self.representations[product].contains(&representation) {
                self.representations[product].push(representation);
            }
        } else if scope.view_of(definition, Entity::NextAssemblyUsageOccurrence).is_ok() {
            self.of_occurrence.entry(definition).or_insert(representation);
        }
        Some(())
    }

    /// Names of the files that products stand in: documents of a kind that is a file.
    fn documents(&mut self, scope: Scope<'_>, roots: &Roots) {
        let views = || roots.of(Root::Document).iter().filter_map(|&name| scope.view(name).ok());
        let mut names: BTreeMap<InstanceName, String> = BTreeMap::new();
        for view in views().filter(|v| v.entity() == Entity::AppliedExternalIdentificationAssignment) {
            for item in view.references("items").into_iter().flatten() {
                names.entry(item).or_insert_with(|| view.text("assigned_id").into_owned());
            }
        }
        let mut of_formation: BTreeMap<InstanceName, Vec<usize>> = BTreeMap::new();
        for (&definition, &product) in &self.index {
            if let Some(formation) = scope.view(definition).ok().and_then(|v| v.reference("formation").ok()) {
                of_formation.entry(formation).or_default().push(product);
            }
        }
        for view in views().filter(|view| view.entity() == Entity::AppliedDocumentReference) {
            let Ok(document) = view.reference("assigned_document") else { continue };
            let Ok(file) = scope.view_of(document, Entity::DocumentFile) else { continue };
            let given = names.get(&document).filter(|name| !name.trim().is_empty()).cloned();
            let name = given.unwrap_or_else(|| file.text("id").into_owned());
            for item in view.references("items").into_iter().flatten() {
                // A file is that of a product definition, or of every one of a formation.
                let products =
                    self.index.get(&item).into_iter().chain(of_formation.get(&item).into_iter().flatten());
                for &product in products {
                    let external = &mut self.all[product].external;
                    if !external.contains(&name) {
                        external.push(name.clone());
                    }
                }
            }
        }
    }
}

fn named(definition: InstanceName, id: String, name: String) -> Product {
    Product {
        id,
        name,
        origin: Origin::Instance(definition.0),
        unit: None,
        shapes: Vec::new(),
        appearance: Appearance::default(),
        external: Vec::new(),
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
    Ok(named(definition, product.text("id").into_owned(), product.text("name").into_owned()))
}
