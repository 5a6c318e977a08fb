//! Dimensions, tolerances, datums, what is drawn of them, validation properties and tessellations: ISO 10303-47,
//! -1309, -42 clause 9, and the recommended practices that tie them to faces.
//!
//! An annotation names an aspect of the shape; usages tie the aspect, or what it is composed of, to items.

use std::collections::{BTreeSet, HashMap, HashSet, VecDeque};

use super::product::Products;
use super::roots::{Root, Roots};
use super::scope::{self, Scope};
use super::topology::Builder;
use super::units;
use crate::model::{Annotation, AnnotationKind, Element, Measure, Occurrence, Origin};
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::EntityView;

/// Aspects of a shape that are followed from one annotation: the greatest patterns have some hundred.
const MAX_ASPECTS: usize = 4096;

/// Elements of one annotation.
const MAX_ELEMENTS: usize = 4096;

/// Reads the annotations of a file.
pub(super) fn annotations(
    builder: &Builder<'_, '_>,
    roots: &Roots,
    products: &Products,
    occurrences: &[Occurrence],
) -> Vec<Annotation> {
    let links = Links::of(builder, roots, products, occurrences);
    let kinds = [
        (Root::Dimension, AnnotationKind::Dimension),
        (Root::Tolerance, AnnotationKind::Tolerance),
        (Root::Datum, AnnotationKind::Datum),
        (Root::Presentation, AnnotationKind::Presentation),
        (Root::Property, AnnotationKind::ValidationProperty),
        (Root::Tessellation, AnnotationKind::Tessellation),
    ];
    let mut all: Vec<(u32, Annotation)> = Vec::new();
    for (root, kind) in kinds {
        for &name in roots.of(root) {
            let Ok(view) = builder.scope.view(name) else { continue };
            if kind == AnnotationKind::ValidationProperty && !is_validation(&view) {
                continue;
            }
            all.push((view.instance().position(), links.annotation(kind, &view)));
        }
    }
    all.sort_by_key(|(position, _)| *position);
    all.into_iter().map(|(_, annotation)| annotation).collect()
}

/// Geometric, assembly, attribute and PMI validation properties all say so in their name.
fn is_validation(property: &EntityView<'_>) -> bool {
    property.text("name").to_ascii_lowercase().contains("validation property")
}

/// What ties annotations to elements.
struct Links<'a, 'm> {
    scope: Scope<'a>,
    products: &'m Products,
    /// Elements of the records that have any.
    elements: HashMap<InstanceName, Element>,
    /// Items, or representations, of each aspect.
    items: HashMap<InstanceName, Vec<InstanceName>>,
    /// Aspects that an aspect is composed of.
    below: HashMap<InstanceName, Vec<InstanceName>>,
    /// Aspects that relate to an aspect: the features of a datum.
    above: HashMap<InstanceName, Vec<InstanceName>>,
    /// What a callout, or an occurrence in one, presents.
    presented: HashMap<InstanceName, Vec<InstanceName>>,
    /// Representations of dimensions and properties.
    values: HashMap<InstanceName, Vec<InstanceName>>,
}

impl<'a, 'm> Links<'a, 'm> {
    fn of(
        builder: &Builder<'a, '_>,
        roots: &Roots,
        products: &'m Products,
        occurrences: &[Occurrence],
    ) -> Self {
        let mut links = Self {
            scope: builder.scope,
            products,
            elements: elements(builder, occurrences),
            items: HashMap::new(),
            below: HashMap::new(),
            above: HashMap::new(),
            presented: HashMap::new(),
            values: HashMap::new(),
        };
        roots.of(Root::ItemUsage).iter().for_each(|&name| links.usage(name));
        for &name in roots.of(Root::ShapeDefinition) {
            if let Some((aspect, representation)) = links.aspect_shape(name) {
                links.items.entry(aspect).or_default().push(representation);
            }
        }
        for &name in roots.of(Root::AspectRelationship) {
            if let Some((above, below)) = links.pair(name, "relating_shape_aspect", "related_shape_aspect") {
                links.below.entry(above).or_default().push(below);
                links.above.entry(below).or_default().push(above);
            }
        }
        for &name in roots.of(Root::DimensionValue) {
            if let Some((dimension, value)) = links.pair(name, "dimension", "representation") {
                links.values.entry(dimension).or_default().push(value);
            }
        }
        for &name in roots.of(Root::PropertyRepresentation) {
            if let Some((property, value)) = links.pair(name, "definition", "used_representation") {
                links.values.entry(property).or_default().push(value);
            }
        }
        roots.of(Root::Presentation).iter().for_each(|&name| links.contents(name));
        links
    }

    fn pair(
        &self,
        name: InstanceName,
        first: &'static str,
        second: &'static str,
    ) -> Option<(InstanceName, InstanceName)> {
        let view = self.scope.view(name).ok()?;
        Some((view.reference(first).ok()?, view.reference(second).ok()?))
    }

    /// An item of an aspect, or the callout of a definition.
    fn usage(&mut self, name: InstanceName) {
        let Ok(view) = self.scope.view(name) else { return };
        let Ok(definition) = view.reference("definition") else { return };
        // A set of items is written `SET_REPRESENTATION_ITEM((…))`.
        let Some(field) = view.get("identified_item").map(|field| field.untyped()) else { return };
        let one = field.as_reference().into_iter();
        let many = field.as_list().into_iter().flatten().filter_map(|member| member.as_reference());
        let identified: Vec<InstanceName> = one.chain(many).collect();
        if view.is(Entity::DraughtingModelItemAssociation) {
            for item in identified {
                self.presented.entry(item).or_default().push(definition);
            }
        } else {
            self.items.entry(definition).or_default().extend(identified);
        }
    }

    /// What a callout holds presents what the callout does.
    fn contents(&mut self, name: InstanceName) {
        let Some(presented) = self.presented.get(&name).cloned() else { return };
        let Ok(view) = self.scope.view(name) else { return };
        for content in view.references("contents").into_iter().flatten() {
            self.presented.entry(content).or_insert_with(|| presented.clone());
        }
    }

    /// An aspect and the representation of its shape.
    fn aspect_shape(&self, name: InstanceName) -> Option<(InstanceName, InstanceName)> {
        let (property, representation) = self.pair(name, "definition", "used_representation")?;
        let aspect = self.scope.view(property).ok()?.reference("definition").ok()?;
        self.scope.view_of(aspect, Entity::ShapeAspect).ok()?;
        Some((aspect, representation))
    }

    fn annotation(&self, kind: AnnotationKind, view: &EntityView<'_>) -> Annotation {
        let entity = match kind {
            AnnotationKind::Tolerance => tolerance_name(view),
            _ => scope::entity_name(view.instance()),
        };
        let name = match kind {
            AnnotationKind::Datum if view.is(Entity::DatumTarget) => view.text("target_id"),
            AnnotationKind::Datum => view.text("identification"),
            AnnotationKind::ValidationProperty => view.text("description"),
            _ => view.text("name"),
        };
        Annotation {
            kind,
            entity,
            name: name.into_owned(),
            values: self.values_of(kind, view),
            origin: Origin::Instance(view.name().0),
            on: self.on(&[view.name()]),
        }
    }

    /// Elements that some definitions speak of: aspects, dimensions, tolerances, properties, callouts.
    fn on(&self, definitions: &[InstanceName]) -> Vec<Element> {
        let mut queue: VecDeque<InstanceName> = definitions.iter().copied().collect();
        let mut seen: HashSet<InstanceName> = HashSet::new();
        let mut found: BTreeSet<Element> = BTreeSet::new();
        let mut ordered = Vec::new();
        while let Some(name) = queue.pop_front() {
            if seen.len() >= MAX_ASPECTS || ordered.len() >= MAX_ELEMENTS || !seen.insert(name) {
                continue;
            }
            if let Some(&element) = self.elements.get(&name) {
                if found.insert(element) {
                    ordered.push(element);
                }
                continue;
            }
            self.next(name, &mut queue);
        }
        // A product is the answer only when nothing nearer is.
        if ordered.is_empty() {
            let products = seen.iter().filter_map(|name| self.products.index(*name)).min();
            ordered.extend(products.map(Element::Product));
        }
        ordered
    }

    /// What a record leads to.
    fn next(&self, name: InstanceName, queue: &mut VecDeque<InstanceName>) {
        queue.extend(self.presented.get(&name).into_iter().flatten());
        let Ok(view) = self.scope.view(name) else { return };
        let mut follow = |attribute: &'static str| queue.extend(view.reference(attribute).ok());
        if view.is(Entity::DimensionalSize) {
            follow("applies_to");
        } else if view.is(Entity::DimensionalLocation) {
            follow("relating_shape_aspect");
            follow("related_shape_aspect");
        } else if view.is(Entity::GeometricTolerance) {
            follow("toleranced_shape_aspect");
        } else if view.is(Entity::PropertyDefinition) {
            follow("definition");
        } else if view.is(Entity::TessellatedItem) {
            follow("geometric_link");
            follow("topological_link");
        }
        if view.is(Entity::ShapeAspect) {
            queue.extend(self.items.get(&name).into_iter().flatten());
            queue.extend(self.below.get(&name).into_iter().flatten());
            if view.is(Entity::Datum) || view.is(Entity::DatumTarget) {
                queue.extend(self.above.get(&name).into_iter().flatten());
            }
        } else if view.is(Entity::Representation) {
            // The shape of an aspect: its bodies.
            let items = view.references("items").into_iter().flatten();
            queue.extend(items.filter(|item| self.elements.contains_key(item)));
        }
    }

    fn values_of(&self, kind: AnnotationKind, view: &EntityView<'_>) -> Vec<Measure> {
        if kind == AnnotationKind::Tolerance {
            let magnitude = view.reference("magnitude").ok();
            return magnitude.into_iter().flat_map(|name| self.measures(name)).collect();
        }
        let representations = self.values.get(&view.name()).into_iter().flatten();
        let items = representations
            .filter_map(|&name| self.scope.view(name).ok()?.references("items").ok())
            .flatten();
        items.flat_map(|item| self.measures(item)).take(MAX_ELEMENTS).collect()
    }

    /// The number of a measure, or the coordinates of a point.
    fn measures(&self, name: InstanceName) -> Vec<Measure> {
        let Ok(view) = self.scope.view(name) else { return Vec::new() };
        let origin = Origin::Instance(view.name().0);
        if view.is(Entity::CartesianPoint) {
            let coordinates = view.list("coordinates").into_iter().flatten();
            let numbers = coordinates.filter_map(|number| number.as_f64());
            let name = view.text("name").into_owned();
            let point =
                |value| Measure { name: name.clone(), value, metres: None, unit: String::new(), origin };
            return numbers.take(3).map(point).collect();
        }
        let Ok(value) = view.real("value_component") else { return Vec::new() };
        let unit = view.reference("unit_component").ok();
        let metres = unit.and_then(|unit| units::metres_of(self.scope, unit));
        let unit = unit.map(|unit| units::name_of(self.scope, unit)).unwrap_or_default();
        vec![Measure { name: view.text("name").into_owned(), value, metres, unit, origin }]
    }
}

/// The element of each record.
fn elements(builder: &Builder<'_, '_>, occurrences: &[Occurrence]) -> HashMap<InstanceName, Element> {
    let mut elements = HashMap::new();
    let mut add = |origin: Origin, element: Element| {
        if let Origin::Instance(name) = origin {
            elements.entry(InstanceName(name)).or_insert(element);
        }
    };
    let origins = &builder.origins;
    origins.faces.iter().for_each(|(face, &origin)| add(origin, Element::Face(face)));
    origins.edges.iter().for_each(|(edge, &origin)| add(origin, Element::Edge(edge)));
    origins.bodies.iter().for_each(|(body, &origin)| add(origin, Element::Body(body)));
    for (shell, &origin) in origins.shells.iter() {
        add(origin, Element::Body(builder.brep.shells[shell].body));
    }
    occurrences.iter().enumerate().for_each(|(at, used)| add(used.origin, Element::Occurrence(at)));
    elements
}

/// The partial type of a tolerance that says what kind it is.
fn tolerance_name(view: &EntityView<'_>) -> String {
    let keywords = view.instance().records().map(|record| record.keyword().to_ascii_uppercase());
    let telling = keywords.filter(|keyword| {
        keyword.ends_with(b"_TOLERANCE")
            && !keyword.starts_with(b"GEOMETRIC_")
            && !keyword.starts_with(b"MODIFIED_")
    });
    let name = telling.last().map(|keyword| String::from_utf8_lossy(&keyword).into_owned());
    name.unwrap_or_else(|| view.entity().name().to_owned())
}
