//! Where products stand in each other, and where bodies stand in products: ISO 10303-43 and -44.
//!
//! Representations make a graph: equivalent ones are related, a mapped item places one in another. Following
//! it from a product's own representations gives the bodies of its shape; a use of a product gives the
//! transformation between two products' representations.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet, VecDeque};

use super::code::ModelCode;
use super::error::ReadError;
use super::product::Products;
use super::roots::{Root, Roots};
use super::scope::Scope;
use super::transformation::{placing, placing_back};
use super::units::Contexts;
use crate::brep::BodyId;
use crate::diagnostic::Sink;
use crate::math::Affine;
use crate::model::{Instances, Occurrence, Origin, PlacedShape, assembly, instance_counts};
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::EntityView;

/// Representations visited for the shape of one product at most: maps of maps double with each level.
const MAX_VISITS: usize = 100_000;

/// Mapped items within mapped items that are followed: real files need two or three.
const MAX_NESTED_MAPS: usize = 64;

/// The items of representations that place shapes.
#[derive(Default)]
pub(super) struct Items {
    /// Bodies and shells of each representation.
    pub(super) bodies: HashMap<InstanceName, Vec<InstanceName>>,
    /// Mapped items of each shape representation.
    pub(super) mapped: HashMap<InstanceName, Vec<InstanceName>>,
}

/// A relationship of two representations.
#[derive(Clone, Copy)]
struct Relation {
    name: InstanceName,
    ends: [InstanceName; 2],
}

/// The graph of representations, with what is needed to follow it.
pub(super) struct Assembler<'a, 'm> {
    scope: Scope<'a>,
    products: &'m mut Products,
    items: &'m Items,
    bodies: &'m BTreeMap<InstanceName, BodyId>,
    contexts: &'m mut Contexts,
    sink: &'m mut dyn Sink,
    /// Metres per unit of each representation that was asked for.
    metres: HashMap<InstanceName, f64>,
    /// All items of a representation, for those that were asked for.
    members: HashMap<InstanceName, HashSet<InstanceName>>,
    relations: HashMap<InstanceName, Vec<Relation>>,
    /// Relationship and representation of each use of a product.
    placed_by: HashMap<InstanceName, InstanceName>,
}

/// What is needed beside the graph.
pub(super) struct Given<'a, 'm> {
    pub(super) scope: Scope<'a>,
    pub(super) roots: &'m Roots,
    pub(super) items: &'m Items,
    pub(super) bodies: &'m BTreeMap<InstanceName, BodyId>,
}

/// The uses of products in each other.
pub(super) struct Assembly {
    pub(super) occurrences: Vec<Occurrence>,
    /// The use that each relationship of representations places: an index into `occurrences`.
    pub(super) placed: HashMap<InstanceName, usize>,
}

/// Places bodies in products and products in each other.
pub(super) fn assemble(
    given: &Given<'_, '_>,
    products: &mut Products,
    contexts: &mut Contexts,
    sink: &mut dyn Sink,
) -> Assembly {
    let mut assembler = Assembler {
        scope: given.scope,
        products,
        items: given.items,
        bodies: given.bodies,
        contexts,
        sink,
        metres: HashMap::new(),
        members: HashMap::new(),
        relations: HashMap::new(),
        placed_by: HashMap::new(),
    };
    assembler.relate(given.roots);
    let mut occurrences = assembler.occurrences(given.roots);
    assembler.shapes(&occurrences);
    assembler.place(&mut occurrences);
    let relation = |(at, used): (usize, &Occurrence)| {
        Some((*assembler.placed_by.get(&InstanceName(used.origin.instance()?))?, at))
    };
    let placed = occurrences.iter().enumerate().filter_map(relation).collect();
    Assembly { occurrences, placed }
}

impl Assembler<'_, '_> {
    /// Finds which relationships place uses of products, and lets the others relate representations.
    fn relate(&mut self, roots: &Roots) {
        let mut placing = HashSet::new();
        for &name in roots.of(Root::ContextDependentShape) {
            let Ok(view) = self.scope.view(name) else { continue };
            let relation = view.reference("representation_relation");
            let shape = view.reference("represented_product_relation");
            let (Ok(relation), Ok(shape)) = (relation, shape) else {
                let message = "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION: a reference is missing".to_owned();
                self.report(name, message);
                continue;
            };
            placing.insert(relation);
            let usage = self.scope.view(shape).and_then(|shape| Ok(shape.reference("definition")?));
            if let Ok(usage) = usage {
                self.placed_by.entry(usage).or_insert(relation);
            }
        }
        let relations = roots.of(Root::Relationship).iter().chain(roots.of(Root::TransformedRelationship));
        for &name in relations.filter(|name| !placing.contains(name)) {
            let Ok(view) = self.scope.view(name) else { continue };
            if let (Ok(first), Ok(second)) = (view.reference("rep_1"), view.reference("rep_2")) {
                let relation = Relation { name, ends: [first, second] };
                self.relations.entry(first).or_default().push(relation);
                self.relations.entry(second).or_default().push(relation);
            }
        }
    }

    fn report(&mut self, name: InstanceName, message: String) {
        self.sink.report(ModelCode::BadReference.at(self.scope.file, name, message));
    }

    /// The uses of products in each other, not placed yet; those that close a circle are left out.
    fn occurrences(&mut self, roots: &Roots) -> Vec<Occurrence> {
        let mut occurrences = Vec::new();
        for &name in roots.of(Root::Occurrence) {
            match self.occurrence(name) {
                Some(occurrence) => occurrences.push(occurrence),
                None => {
                    let message =
                        "NEXT_ASSEMBLY_USAGE_OCCURRENCE: its product definitions are not in the file";
                    self.report(name, message.to_owned());
                }
            }
        }
        let pairs: Vec<(usize, usize)> = occurrences.iter().map(|used| (used.parent, used.child)).collect();
        for &at in assembly::circular_occurrences(self.products.all.len(), &pairs).iter().rev() {
            let Origin::Instance(name) = occurrences.remove(at).origin else { continue };
            let message = "NEXT_ASSEMBLY_USAGE_OCCURRENCE: puts a product into itself; it is left out";
            self.sink.report(ModelCode::Cycle.at(self.scope.file, InstanceName(name), message.to_owned()));
        }
        occurrences
    }

    fn occurrence(&self, name: InstanceName) -> Option<Occurrence> {
        let view = self.scope.view(name).ok()?;
        let end = |attribute| self.products.index(view.reference(attribute).ok()?);
        Some(Occurrence {
            parent: end("relating_product_definition")?,
            child: end("related_product_definition")?,
            id: view.text("id").into_owned(),
            name: view.text("name").into_owned(),
            placement: None,
            overrides: Vec::new(),
            origin: Origin::Instance(name.0),
        })
    }

    /// Unit of a representation in metres.
    fn metres(&mut self, representation: InstanceName) -> f64 {
        if let Some(&known) = self.metres.get(&representation) {
            return known;
        }
        let context = self.scope.view(representation).ok().and_then(|v| v.reference("context_of_items").ok());
        let metres = context.map_or(1e-3, |context| {
            let at = self.contexts.of(self.scope, context, self.sink);
            self.contexts.all[at].length.metres
        });
        self.metres.insert(representation, metres);
        metres
    }

    /// Finds the bodies of every product's shape.
    fn shapes(&mut self, occurrences: &[Occurrence]) {
        let uses: BTreeSet<(usize, usize)> =
            occurrences.iter().map(|used| (used.parent, used.child)).collect();
        for product in 0..self.products.all.len() {
            let own = self.products.representations[product].clone();
            let Some(&first) = own.first() else { continue };
            let metres = self.metres(first);
            let context = self.contexts.all.iter().find(|c| c.length.metres.to_bits() == metres.to_bits());
            self.products.all[product].unit = context.map(|context| context.length.clone());
            let shapes = self.shape_of(product, &own, &uses);
            self.products.all[product].shapes = shapes;
        }
    }

    /// Bodies that the representations of a product hold, with those that are related to them or mapped into
    /// them; not those of other products that it uses.
    fn shape_of(
        &mut self,
        product: usize,
        own: &[InstanceName],
        uses: &BTreeSet<(usize, usize)>,
    ) -> Vec<PlacedShape> {
        let unit = self.metres(own[0]);
        let mut shapes: Vec<PlacedShape> = Vec::new();
        let mut held: HashMap<BodyId, usize> = HashMap::new();
        // Each map opens a space of its own, in which a representation counts once.
        let mut seen: HashSet<(usize, InstanceName)> = HashSet::new();
        let mut spaces = 1;
        let mut ahead: VecDeque<(InstanceName, usize, usize, Affine)> = VecDeque::new();
        for &representation in own {
            let factor = self.metres(representation) / unit;
            ahead.push_back((representation, 0, 0, Affine::scale(factor)));
        }
        let mut visits = 0;
        while let Some((representation, space, depth, transform)) = ahead.pop_front() {
            if !seen.insert((space, representation)) {
                continue;
            }
            visits += 1;
            if visits > MAX_VISITS || depth > MAX_NESTED_MAPS {
                let message = "representations map each other without end, or too often".to_owned();
                self.sink.report(ModelCode::Cycle.at(self.scope.file, representation, message));
                break;
            }
            for item in self.items.bodies.get(&representation).into_iter().flatten() {
                let Some(&body) = self.bodies.get(item) else { continue };
                // A body that several representations of one shape hold is there once.
                let known = held.get(&body).is_some_and(|&before| before == space);
                if !known {
                    held.insert(body, space);
                    shapes.push(PlacedShape { body, transform });
                }
            }
            for relation in self.relations.get(&representation).cloned().unwrap_or_default() {
                if let Some((other, step)) = self.step(relation, representation)
                    && self.products.of_representation(other).is_none_or(|owner| owner == product)
                {
                    ahead.push_back((other, space, depth, transform.after(&step)));
                }
            }
            for &item in self.items.mapped.get(&representation).into_iter().flatten() {
                let Some((mapped, step)) = self.mapping(item, representation) else { continue };
                let owner = self.products.of(mapped);
                if owner.is_none_or(|owner| owner == product || !uses.contains(&(product, owner))) {
                    ahead.push_back((mapped, spaces, depth + 1, transform.after(&step)));
                    spaces += 1;
                }
            }
        }
        shapes
    }

    /// The other end of a relationship, and the transformation from its coordinates to this end's.
    fn step(&mut self, relation: Relation, from: InstanceName) -> Option<(InstanceName, Affine)> {
        let [first, second] = relation.ends;
        let other = if first == from { second } else { first };
        if other == from {
            return None;
        }
        let forward = self.transformation(relation);
        let transform = forward.and_then(|forward| {
            let singular = ReadError::Coordinates(relation.name);
            if first == other { Ok(forward) } else { forward.inverse().ok_or(singular) }
        });
        match transform {
            Ok(transform) => Some((other, transform)),
            Err(error) => {
                self.report(relation.name, format!("REPRESENTATION_RELATIONSHIP: {error}"));
                None
            }
        }
    }

    /// From the coordinates of a relationship's first representation to those of its second.
    fn transformation(&mut self, relation: Relation) -> Result<Affine, ReadError> {
        let [first, second] = relation.ends;
        let factor = Affine::scale(self.metres(first) / self.metres(second));
        let view = self.scope.view(relation.name)?;
        if !view.is(Entity::RepresentationRelationshipWithTransformation) {
            return Ok(factor);
        }
        let operator = view.reference("transformation_operator")?;
        let Ok(items) = self.scope.view_of(operator, Entity::ItemDefinedTransformation) else {
            return Ok(placing(self.scope, operator)?.after(&factor));
        };
        let mut ends = [items.reference("transform_item_1")?, items.reference("transform_item_2")?];
        // Some writers give the items against the order of the representations that hold them, and one item may
        // be held by both: the order that more memberships speak for counts.
        let straight = usize::from(self.holds(first, ends[0])) + usize::from(self.holds(second, ends[1]));
        let crossed = usize::from(self.holds(first, ends[1])) + usize::from(self.holds(second, ends[0]));
        if crossed > straight {
            ends.reverse();
        }
        let [from, to] = ends;
        Ok(placing(self.scope, to)?.after(&factor).after(&placing_back(self.scope, from)?))
    }

    /// Whether an item is one of a representation's.
    fn holds(&mut self, representation: InstanceName, item: InstanceName) -> bool {
        let scope = self.scope;
        let members = self.members.entry(representation).or_insert_with(|| {
            let items = scope.view(representation).and_then(|view| Ok(view.references("items")?));
            items.map(Iterator::collect).unwrap_or_default()
        });
        members.contains(&item)
    }

    /// The representation that a mapped item maps, and the transformation from its coordinates to those of
    /// the representation that the item is in.
    fn mapping(&mut self, item: InstanceName, within: InstanceName) -> Option<(InstanceName, Affine)> {
        let found = (|| {
            let view = self.scope.view_of(item, Entity::MappedItem)?;
            let map = self.scope.view_of(view.reference("mapping_source")?, Entity::RepresentationMap)?;
            let mapped = map.reference("mapped_representation")?;
            let target = placing(self.scope, view.reference("mapping_target")?)?;
            let origin = placing_back(self.scope, map.reference("mapping_origin")?)?;
            let factor = Affine::scale(self.metres(mapped) / self.metres(within));
            Ok::<_, ReadError>((mapped, target.after(&factor).after(&origin)))
        })();
        match found {
            Ok(found) => Some(found),
            Err(error) => {
                self.report(item, format!("MAPPED_ITEM: {error}"));
                None
            }
        }
    }

    /// Gives each use its placement, and says which have none.
    fn place(&mut self, occurrences: &mut [Occurrence]) {
        let mut mapped = self.mapped_uses(occurrences);
        for occurrence in occurrences.iter_mut() {
            let Origin::Instance(name) = occurrence.origin else { continue };
            let name = InstanceName(name);
            let (parent, child) = (occurrence.parent, occurrence.child);
            let placement = match self.placed_by.get(&name).copied() {
                Some(relation) => self.related_placement(relation, parent, child),
                None => {
                    let own = self.products.of_occurrence.get(&name).copied();
                    let own = own.and_then(|own| Some((*self.items.mapped.get(&own)?.first()?, own)));
                    let own = own.and_then(|(item, own)| self.mapping(item, own));
                    let taken = || mapped.get_mut(&(parent, child)).and_then(VecDeque::pop_front);
                    Ok(own.map(|(_, transform)| transform).or_else(taken))
                }
            };
            match placement {
                Ok(placement) => occurrence.placement = placement,
                Err(error) => {
                    self.report(name, format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE: its placement: {error}"));
                }
            }
            if occurrence.placement.is_none() && !self.products.all[child].shapes.is_empty() {
                let message =
                    "NEXT_ASSEMBLY_USAGE_OCCURRENCE: nothing says where the component is".to_owned();
                self.report(name, message);
            }
        }
    }

    /// Placements by mapped items alone, as older files write them: for each pair of products in file order.
    fn mapped_uses(&mut self, occurrences: &[Occurrence]) -> HashMap<(usize, usize), VecDeque<Affine>> {
        let mut uses: HashMap<(usize, usize), VecDeque<Affine>> = HashMap::new();
        let by_relation = |used: &Occurrence| {
            used.origin.instance().is_some_and(|name| self.placed_by.contains_key(&InstanceName(name)))
        };
        let parents: BTreeSet<usize> =
            occurrences.iter().filter(|used| !by_relation(used)).map(|used| used.parent).collect();
        for parent in parents {
            for representation in self.products.representations[parent].clone() {
                for &item in self.items.mapped.get(&representation).into_iter().flatten() {
                    let Some((mapped, transform)) = self.mapping(item, representation) else { continue };
                    if let Some(child) = self.products.of(mapped) {
                        uses.entry((parent, child)).or_default().push_back(transform);
                    }
                }
            }
        }
        uses
    }

    /// Placement by a relationship of the component's representation with the assembly's. Files write the
    /// two in either order; the use says which is which.
    fn related_placement(
        &mut self,
        name: InstanceName,
        parent: usize,
        child: usize,
    ) -> Result<Option<Affine>, ReadError> {
        let view = self.scope.view(name)?;
        let relation = Relation { name, ends: [view.reference("rep_1")?, view.reference("rep_2")?] };
        let [first, second] = relation.ends;
        let owners = [self.products.of(first), self.products.of(second)];
        let forward = self.transformation(relation)?;
        let reversed = owners == [Some(parent), Some(child)] && parent != child;
        let (from, to, placement) = if reversed {
            (second, first, forward.inverse().ok_or(ReadError::Coordinates(name))?)
        } else {
            (first, second, forward)
        };
        let unit =
            |products: &Products, product: usize| products.all[product].unit.as_ref().map(|u| u.metres);
        let (from, to) = (self.metres(from), self.metres(to));
        let child = unit(self.products, child).unwrap_or(from);
        let parent = unit(self.products, parent).unwrap_or(to);
        Ok(Some(Affine::scale(to / parent).after(&placement).after(&Affine::scale(child / from))))
    }
}

/// Says when an assembly has more instances than a walk gives.
pub(super) fn report_size(model: &crate::model::Model, scope: Scope<'_>, sink: &mut dyn Sink) {
    let counts = instance_counts(model);
    let total = counts.iter().fold(0u64, |sum, &count| sum.saturating_add(count));
    if total > Instances::LIMIT as u64
        && let Some(Origin::Instance(name)) = model.products.first().map(|product| product.origin)
    {
        let message =
            format!("the assembly has {total} instances of products: only {} are walked", Instances::LIMIT);
        sink.report(ModelCode::TooManyInstances.at(scope.file, InstanceName(name), message));
    }
}

/// The representation that a mapped item maps.
pub(super) fn mapped_representation(scope: Scope<'_>, item: &EntityView<'_>) -> Option<InstanceName> {
    let map = scope.view_of(item.reference("mapping_source").ok()?, Entity::RepresentationMap).ok()?;
    map.reference("mapped_representation").ok()
}

#[cfg(test)]
mod tests;
