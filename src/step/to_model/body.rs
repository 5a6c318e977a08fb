//! Bodies and free curves, and the representation that holds each: ISO 10303-42 chapter 6, ISO 10303-43.
//!
//! Each body is built once, however many representations hold it; the first gives its units and product.

use std::collections::{HashMap, HashSet};

use super::assembly::{Items, mapped_representation};
use super::code::ModelCode;
use super::curve::Trims;
use super::product::Products;
use super::roots::{Root, Roots};
use super::scope::Scope;
use super::topology::Builder;
use super::units::Contexts;
use super::{curve, placement, scope};
use crate::brep::{Arena, Body, BodyId, BodyKind, CurveId};
use crate::diagnostic::Sink;
use crate::model::{Attributes, BodyAttributes, Origin};
use crate::step::entity::Entity;
use crate::step::view::{EntityView, list};
use crate::step::{InstanceName, Parameters};

/// Which representation holds each body or shell, and what else shape representations hold.
pub(super) struct Holders {
    representation: HashMap<InstanceName, InstanceName>,
    /// What representations hold that an assembly is made of.
    pub(super) items: Items,
    /// Curves, and sets of them, with their representation; in file order.
    curves: Vec<(InstanceName, InstanceName)>,
    /// Faces, edges and the like, which should be part of a body too.
    elements: Vec<InstanceName>,
}

impl Holders {
    pub(super) fn find(
        scope: Scope<'_>,
        roots: &Roots,
        products: &mut Products,
        sink: &mut dyn Sink,
    ) -> Self {
        let mut holders = Self {
            representation: HashMap::new(),
            items: Items::default(),
            curves: Vec::new(),
            elements: Vec::new(),
        };
        let bodies = roots.of(Root::Body).iter();
        let known: HashSet<InstanceName> = bodies.chain(roots.of(Root::Shell)).copied().collect();
        for &name in roots.of(Root::Representation) {
            let Ok(view) = scope.view(name) else { continue };
            let Ok(items) = view.references("items") else {
                let message = format!("{}: items is no list", view.entity());
                sink.report(ModelCode::BadReference.at(scope.file, name, message));
                continue;
            };
            let shape =
                view.is(Entity::ShapeRepresentation) && view.entity() != Entity::ShapeDimensionRepresentation;
            for item in items {
                if known.contains(&item) {
                    holders.representation.entry(item).or_insert(name);
                    holders.items.bodies.entry(name).or_default().push(item);
                } else if shape {
                    holders.other_item(scope, item, name, products, sink);
                }
            }
        }
        holders
    }

    /// An item of a shape representation that is no body.
    fn other_item(
        &mut self,
        scope: Scope<'_>,
        item: InstanceName,
        representation: InstanceName,
        products: &mut Products,
        sink: &mut dyn Sink,
    ) {
        let mut report = |code: ModelCode, message| sink.report(code.at(scope.file, item, message));
        let Some(instance) = scope.file.instance(item) else {
            return report(ModelCode::Dangling, format!("an item of {representation} is not in the file"));
        };
        let unread = || format!("{}: not read yet", scope::entity_name(instance));
        let Some(view) = EntityView::of(instance) else { return report(ModelCode::NotReadYet, unread()) };
        if view.is(Entity::MappedItem) {
            let mapped = mapped_representation(scope, &view);
            match mapped {
                Some(mapped) => {
                    products.relate_mapping(representation, mapped);
                    self.items.mapped.entry(representation).or_default().push(item);
                }
                None => report(ModelCode::BadReference, "MAPPED_ITEM: no mapped representation".to_owned()),
            }
        } else if view.is(Entity::GeometricSet) || view.is(Entity::Curve) {
            self.curves.push((item, representation));
        } else if view.is(Entity::Axis2Placement3d) {
            if let Err(error) = placement::frame(scope, item) {
                report(error.geometry_code(), format!("{}: {error}", view.entity()));
            }
        } else if view.is(Entity::TopologicalRepresentationItem) {
            self.elements.push(item);
        } else if !view.is(Entity::Placement) && !view.is(Entity::Point) {
            report(ModelCode::NotReadYet, unread());
        }
    }
}

/// The bodies that were built, beside the topology in the builder.
pub(super) struct Bodies<'p> {
    pub(super) attributes: Arena<BodyId, BodyAttributes>,
    pub(super) context: Arena<BodyId, usize>,
    pub(super) contexts: Contexts,
    pub(super) free_curves: Vec<CurveId>,
    pub(super) free_curve_names: Vec<String>,
    products: &'p Products,
    pub(super) holders: Holders,
}

impl<'p> Bodies<'p> {
    pub(super) fn new(products: &'p Products, holders: Holders) -> Self {
        Self {
            attributes: Arena::default(),
            context: Arena::default(),
            contexts: Contexts::default(),
            free_curves: Vec::new(),
            free_curve_names: Vec::new(),
            products,
            holders,
        }
    }

    /// Builds every body, then the shells that none of them holds, then the free curves.
    pub(super) fn build(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots) {
        for &name in roots.of(Root::Body) {
            if let Ok(view) = builder.scope.view(name) {
                self.body(builder, &view);
            }
        }
        for &name in roots.of(Root::Shell) {
            if !builder.shells.contains_key(&name) {
                self.loose_shell(builder, name);
            }
        }
        self.curves(builder);
        self.loose_elements(builder);
        if self.contexts.all.is_empty() {
            for &name in roots.of(Root::Context) {
                self.contexts.of(builder.scope, name, builder.sink);
            }
        }
    }

    fn body(&mut self, builder: &mut Builder<'_, '_>, view: &EntityView<'_>) {
        let kind = if view.is(Entity::SolidModel) { BodyKind::Solid } else { BodyKind::Surface };
        let id = self.open(builder, view.name(), kind);
        self.attributes[id].own.name = view.text("name").into_owned();
        let [outer, voids, shells, faces] = view.fields(["outer", "voids", "sbsm_boundary", "fbsm_faces"]);
        let mut members: Vec<InstanceName> = outer.iter().filter_map(|p| p.as_reference()).collect();
        for (field, attribute) in [(voids, "voids"), (shells, "sbsm_boundary"), (faces, "fbsm_faces")] {
            if field.is_some() {
                members.extend(list(field, attribute).into_iter().flat_map(references));
            }
        }
        if members.is_empty() {
            let message = format!("{}: no shell", view.entity());
            builder.report(ModelCode::BadTopology, view.name(), message);
        }
        let shells = members.into_iter().filter_map(|member| builder.shell(member, id)).collect();
        builder.brep.bodies[id].shells = shells;
    }

    /// A face set that no body holds becomes a surface body of its own.
    fn loose_shell(&mut self, builder: &mut Builder<'_, '_>, name: InstanceName) {
        let id = self.open(builder, name, BodyKind::Surface);
        if let Ok(view) = builder.scope.view(name) {
            self.attributes[id].own.name = view.text("name").into_owned();
        }
        let shell = builder.shell(name, id);
        builder.brep.bodies[id].shells.extend(shell);
    }

    /// Says which faces, edges and the like stand in a representation and in no body.
    fn loose_elements(&self, builder: &mut Builder<'_, '_>) {
        let origins = &builder.origins;
        let faces = origins.faces.iter().map(|(_, origin)| *origin);
        let edges = origins.edges.iter().map(|(_, origin)| *origin);
        let vertices = origins.vertices.iter().map(|(_, origin)| *origin);
        let elements = &self.holders.elements;
        if elements.is_empty() {
            return;
        }
        let built: HashSet<Origin> = faces.chain(edges).chain(vertices).collect();
        for &name in elements.iter().filter(|name| !built.contains(&Origin::Instance(name.0))) {
            if let Ok(instance) = builder.scope.instance(name) {
                let message = format!("{} outside of any body: not read yet", scope::entity_name(instance));
                builder.report(ModelCode::NotReadYet, name, message);
            }
        }
    }

    /// Adds a body without shells, in the context of its representation.
    fn open(&mut self, builder: &mut Builder<'_, '_>, name: InstanceName, kind: BodyKind) -> BodyId {
        let representation = self.holders.representation.get(&name).copied();
        if representation.is_none() {
            let message = "no representation holds this body: its units are assumed to be the file's first";
            builder.report(ModelCode::LooseBody, name, message.to_owned());
        }
        let context = self.enter(builder, representation);
        self.context.push(context);
        let product = representation.and_then(|representation| self.products.of(representation));
        self.attributes.push(BodyAttributes { own: Attributes::default(), product });
        builder.origins.bodies.push(Origin::Instance(name.0));
        builder.brep.bodies.push(Body { kind, shells: Vec::new() })
    }

    /// Makes the units of a representation those of what is read next.
    fn enter(&mut self, builder: &mut Builder<'_, '_>, representation: Option<InstanceName>) -> usize {
        let scope = builder.scope;
        let context = representation.and_then(|name| {
            let context = scope.view(name).ok()?.reference("context_of_items").ok()?;
            Some(self.contexts.of(scope, context, builder.sink))
        });
        let context = context.unwrap_or_else(|| self.contexts.assumed());
        builder.scope.radians = self.contexts.all[context].angle.radians;
        context
    }

    fn curves(&mut self, builder: &mut Builder<'_, '_>) {
        let mut seen = HashSet::new();
        for (item, representation) in std::mem::take(&mut self.holders.curves) {
            self.enter(builder, Some(representation));
            let Ok(view) = builder.scope.view(item) else { continue };
            let members: Vec<InstanceName> = match view.references("elements") {
                Ok(members) if view.is(Entity::GeometricSet) => members.collect(),
                _ => vec![item],
            };
            for member in members {
                let set = if member == item { None } else { Some(&view) };
                self.free_curve(builder, member, set, &mut seen);
            }
        }
    }

    fn free_curve(
        &mut self,
        builder: &mut Builder<'_, '_>,
        name: InstanceName,
        set: Option<&EntityView<'_>>,
        seen: &mut HashSet<InstanceName>,
    ) {
        let Some(instance) = builder.scope.file.instance(name) else {
            let message = "an element of a geometric set is not in the file".to_owned();
            return builder.report(ModelCode::Dangling, name, message);
        };
        let view = EntityView::of(instance);
        if view.is_some_and(|view| view.is(Entity::Point)) {
            return;
        }
        if !view.is_some_and(|view| view.is(Entity::Curve)) {
            let message = format!("{}: not read yet", scope::entity_name(instance));
            return builder.report(ModelCode::NotReadYet, name, message);
        }
        match curve::resolve(builder.scope, name, Trims::Keep) {
            Ok((inner, _)) if seen.insert(inner) => {
                let own = [name, inner]
                    .map(|name| builder.scope.view(name).map(|view| view.text("name").into_owned()));
                let own = own.into_iter().flatten().find(|name| !name.is_empty());
                let of_set = || set.map(|set| set.text("name").into_owned());
                self.free_curve_names.push(own.or_else(of_set).unwrap_or_default());
                self.free_curves.push(builder.curve(inner, inner));
            }
            Ok(_) => {}
            Err(error) => builder.report(error.geometry_code(), name, error.to_string()),
        }
    }
}

fn references(members: Parameters<'_>) -> impl Iterator<Item = InstanceName> {
    members.filter_map(|member| member.as_reference())
}
