//! Colours, transparency, visibility and layers: ISO 10303-46.
//!
//! Reads the look of faces, shells, bodies and whole shapes, and what one use in an assembly changes of it.
//! Styles of curves and points are carried.

use std::collections::{HashMap, VecDeque};

use super::assembly::mapped_representation;
use super::code::ModelCode;
use super::product::Products;
use super::roots::{Root, Roots};
use super::scope::Scope;
use super::topology::Builder;
use crate::brep::{Arena, BodyId, FaceId};
use crate::model::{
    Appearance, Attributes, BodyAttributes, Colour, Occurrence, Origin, Override, OverrideTarget,
};
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::EntityView;

/// Records that are looked at to find the colour of one style: a plain one takes seven.
const MAX_STYLE_RECORDS: usize = 64;

/// What a style or a layer can be put on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Target {
    Face(FaceId),
    Body(BodyId),
    /// The whole shape of a product.
    Product(usize),
}

/// The elements of each record that may have a style or lie on a layer.
struct Targets(HashMap<InstanceName, Vec<Target>>);

impl Targets {
    fn of(builder: &Builder<'_, '_>) -> Self {
        let mut targets: HashMap<InstanceName, Vec<Target>> = HashMap::new();
        let mut add = |origin: Origin, target: Target| {
            if let Origin::Instance(name) = origin {
                targets.entry(InstanceName(name)).or_default().push(target);
            }
        };
        for (face, &origin) in builder.origins.faces.iter() {
            add(origin, Target::Face(face));
        }
        for (body, &origin) in builder.origins.bodies.iter() {
            add(origin, Target::Body(body));
        }
        for (shell, &origin) in builder.origins.shells.iter() {
            let shell = &builder.brep.shells[shell];
            let origin_of_body = builder.origins.bodies[shell.body];
            if origin == origin_of_body {
                continue;
            }
            // A body with one shell is styled by it; else the faces are, one by one.
            if builder.brep.bodies[shell.body].shells.len() == 1 {
                add(origin, Target::Body(shell.body));
            } else {
                shell.faces.iter().for_each(|&face| add(origin, Target::Face(face)));
            }
        }
        Self(targets)
    }

    /// What a record stands for: itself, what a styled item styles, or the shape that it is or maps.
    fn of_item(&self, scope: Scope<'_>, products: &Products, name: InstanceName) -> Vec<Target> {
        if let Some(targets) = self.0.get(&name) {
            return targets.clone();
        }
        let Ok(view) = scope.view(name) else { return Vec::new() };
        let representation = if view.is(Entity::MappedItem) {
            mapped_representation(scope, &view)
        } else {
            view.is(Entity::Representation).then_some(name)
        };
        let product = representation.and_then(|representation| products.of(representation));
        product.map(Target::Product).into_iter().collect()
    }
}

/// What looks are put on.
pub(super) struct Styled<'m> {
    pub(super) products: &'m mut Products,
    pub(super) bodies: &'m mut Arena<BodyId, BodyAttributes>,
    pub(super) occurrences: &'m mut [Occurrence],
    /// The use that each relationship of representations places.
    pub(super) placed: &'m HashMap<InstanceName, usize>,
}

/// Puts looks and layers on what was built.
pub(super) fn apply(builder: &mut Builder<'_, '_>, roots: &Roots, styled: &mut Styled<'_>) {
    let targets = Targets::of(builder);
    let (over_riding, plain): (Vec<_>, Vec<_>) = roots
        .of(Root::StyledItem)
        .iter()
        .filter_map(|&name| builder.scope.view(name).ok())
        .partition(|view| view.is(Entity::OverRidingStyledItem));
    for view in plain.iter().chain(&over_riding) {
        style(builder, view, &targets, styled);
    }
    for &name in roots.of(Root::Layer) {
        layer(builder, name, &targets, styled);
    }
    for &name in roots.of(Root::Invisibility) {
        hide(builder, name, &targets, styled);
    }
}

fn style(builder: &mut Builder<'_, '_>, view: &EntityView<'_>, targets: &Targets, styled: &mut Styled<'_>) {
    let Ok(item) = view.reference("item") else {
        let message = format!("{}: no item", view.entity());
        return builder.report(ModelCode::BadReference, view.name(), message);
    };
    let found = targets.of_item(builder.scope, styled.products, item);
    if found.is_empty() {
        return;
    }
    let Some(look) = look_of(builder.scope, view) else { return };
    if view.is(Entity::ContextDependentOverRidingStyledItem) {
        return in_context(builder.scope, view, &found, look.colour, styled);
    }
    let over_rides = view.is(Entity::OverRidingStyledItem);
    for target in found {
        let own = appearance(builder, styled, target);
        if over_rides || own.colour.is_none() {
            own.colour = look.colour.or(own.colour);
            own.transparency = look.transparency;
        }
    }
}

/// A style that holds in one use of a product: the first of its contexts that places one.
fn in_context(
    scope: Scope<'_>,
    view: &EntityView<'_>,
    found: &[Target],
    colour: Option<Colour>,
    styled: &mut Styled<'_>,
) {
    let contexts: Vec<InstanceName> = view.references("style_context").into_iter().flatten().collect();
    let relation = |name: &InstanceName| {
        let shape = scope.view_of(*name, Entity::ContextDependentShapeRepresentation).ok();
        shape.and_then(|shape| shape.reference("representation_relation").ok()).unwrap_or(*name)
    };
    let used = contexts.iter().find_map(|name| styled.placed.get(&relation(name)).copied());
    let (Some(used), Some(colour)) = (used, colour) else { return };
    for target in found {
        let target = match *target {
            Target::Face(face) => OverrideTarget::Face(face),
            Target::Body(body) => OverrideTarget::Body(body),
            Target::Product(_) => OverrideTarget::Component,
        };
        styled.occurrences[used].overrides.push(Override { target, colour });
    }
}

fn attributes<'m>(
    builder: &'m mut Builder<'_, '_>,
    styled: &'m mut Styled<'_>,
    target: Target,
) -> Option<&'m mut Attributes> {
    match target {
        Target::Face(face) => Some(&mut builder.faces[face]),
        Target::Body(body) => Some(&mut styled.bodies[body].own),
        Target::Product(_) => None,
    }
}

fn appearance<'m>(
    builder: &'m mut Builder<'_, '_>,
    styled: &'m mut Styled<'_>,
    target: Target,
) -> &'m mut Appearance {
    match target {
        Target::Face(face) => &mut builder.faces[face].appearance,
        Target::Body(body) => &mut styled.bodies[body].own.appearance,
        Target::Product(product) => &mut styled.products.all[product].appearance,
    }
}

fn layer(builder: &mut Builder<'_, '_>, name: InstanceName, targets: &Targets, styled: &mut Styled<'_>) {
    let scope = builder.scope;
    let Ok(view) = scope.view(name) else { return };
    let Ok(items) = view.references("assigned_items") else {
        let message = "PRESENTATION_LAYER_ASSIGNMENT: no items".to_owned();
        return builder.report(ModelCode::BadReference, name, message);
    };
    let text = view.text("name").into_owned();
    for item in items {
        for target in targets.of_item(scope, styled.products, styled_by(scope, item)) {
            let Some(own) = attributes(builder, styled, target) else { continue };
            if !own.layers.contains(&text) {
                own.layers.push(text.clone());
            }
        }
    }
}

/// What a styled item styles; anything else stands for itself.
fn styled_by(scope: Scope<'_>, item: InstanceName) -> InstanceName {
    let styled = scope.view_of(item, Entity::StyledItem).ok().and_then(|view| view.reference("item").ok());
    styled.unwrap_or(item)
}

/// An `INVISIBILITY`: of styled items, layers and whole representations.
fn hide(builder: &mut Builder<'_, '_>, name: InstanceName, targets: &Targets, styled: &mut Styled<'_>) {
    let scope = builder.scope;
    let Ok(items) = scope.view(name).and_then(|view| Ok(view.references("invisible_items")?)) else {
        let message = "INVISIBILITY: no items".to_owned();
        return builder.report(ModelCode::BadReference, name, message);
    };
    for item in items {
        let layer = scope.view_of(item, Entity::PresentationLayerAssignment).ok();
        let members: Vec<InstanceName> = match layer.and_then(|layer| layer.references("assigned_items").ok())
        {
            Some(members) => members.collect(),
            None => vec![item],
        };
        for member in members {
            for target in targets.of_item(scope, styled.products, styled_by(scope, member)) {
                appearance(builder, styled, target).hidden = true;
            }
        }
    }
}

/// The first surface colour among the styles of a styled item, breadth first, and the transparency beside it.
fn look_of(scope: Scope<'_>, item: &EntityView<'_>) -> Option<Appearance> {
    let mut queue: VecDeque<InstanceName> = item.references("styles").ok()?.collect();
    let mut look = Appearance::default();
    for _ in 0..MAX_STYLE_RECORDS {
        let Some(name) = queue.pop_front() else { break };
        let Some(view) = scope.view(name).ok() else { continue };
        let next = match view.entity() {
            Entity::ColourRgb | Entity::DraughtingPreDefinedColour | Entity::PreDefinedColour => {
                look.colour = look.colour.or_else(|| colour(&view));
                if look.colour.is_some() {
                    break;
                }
                continue;
            }
            Entity::SurfaceStyleTransparent => {
                look.transparency = view.real("transparency").ok().map(|t| t.clamp(0.0, 1.0));
                continue;
            }
            Entity::SurfaceStyleUsage => "style",
            Entity::SurfaceStyleFillArea => "fill_area",
            Entity::FillAreaStyleColour => "fill_colour",
            Entity::SurfaceStyleRendering | Entity::SurfaceStyleRenderingWithProperties => {
                // What is beside the colour is looked at before it.
                queue.extend(view.references("properties").into_iter().flatten());
                "surface_colour"
            }
            Entity::PresentationStyleAssignment
            | Entity::PresentationStyleByContext
            | Entity::SurfaceSideStyle => {
                queue.extend(view.references("styles").into_iter().flatten());
                continue;
            }
            Entity::FillAreaStyle => {
                queue.extend(view.references("fill_styles").into_iter().flatten());
                continue;
            }
            _ => continue,
        };
        queue.extend(view.reference(next).ok());
    }
    (look != Appearance::default()).then_some(look)
}

fn colour(view: &EntityView<'_>) -> Option<Colour> {
    if view.entity() == Entity::ColourRgb { rgb(view) } else { pre_defined(&view.text("name")) }
}

fn rgb(view: &EntityView<'_>) -> Option<Colour> {
    let part = |name| view.real(name).ok().map(|part| part.clamp(0.0, 1.0));
    Some(Colour { red: part("red")?, green: part("green")?, blue: part("blue")? })
}

/// The colours that ISO 10303-101 names.
fn pre_defined(name: &str) -> Option<Colour> {
    let (red, green, blue) = match name.trim().to_ascii_lowercase().as_str() {
        "red" => (1.0, 0.0, 0.0),
        "green" => (0.0, 1.0, 0.0),
        "blue" => (0.0, 0.0, 1.0),
        "yellow" => (1.0, 1.0, 0.0),
        "magenta" => (1.0, 0.0, 1.0),
        "cyan" => (0.0, 1.0, 1.0),
        "black" => (0.0, 0.0, 0.0),
        "white" => (1.0, 1.0, 1.0),
        _ => return None,
    };
    Some(Colour { red, green, blue })
}
