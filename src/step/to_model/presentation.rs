//! Colours and layers: ISO 10303-46.
//!
//! Reads surface colours of faces, shells and bodies. Styles of curves, transparency and styles that hold in
//! one assembly context only are carried.

use std::collections::{HashMap, VecDeque};

use super::code::ModelCode;
use super::roots::Roots;
use super::scope::Scope;
use super::topology::Builder;
use crate::brep::{Arena, BodyId, FaceId};
use crate::model::{Attributes, BodyAttributes, Colour, Origin};
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::EntityView;

/// Records that are looked at to find the colour of one style: a plain one takes seven.
const MAX_STYLE_RECORDS: usize = 64;

/// What a style or a layer can be put on.
#[derive(Clone, Copy)]
enum Target {
    Face(FaceId),
    Body(BodyId),
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

    fn get(&self, name: InstanceName) -> &[Target] {
        self.0.get(&name).map_or(&[], Vec::as_slice)
    }
}

/// Puts colours and layers on the faces and bodies that were built.
pub(super) fn apply(
    builder: &mut Builder<'_, '_>,
    roots: &Roots,
    bodies: &mut Arena<BodyId, BodyAttributes>,
) {
    if roots.styled_items.is_empty() && roots.layers.is_empty() {
        return;
    }
    let targets = Targets::of(builder);
    let (over_riding, plain): (Vec<_>, Vec<_>) = roots
        .styled_items
        .iter()
        .filter_map(|&name| builder.scope.view(name).ok())
        .partition(|view| view.is(Entity::OverRidingStyledItem));
    for view in plain.iter().chain(&over_riding) {
        style(builder, view, &targets, bodies);
    }
    for &name in &roots.layers {
        layer(builder, name, &targets, bodies);
    }
}

fn style(
    builder: &mut Builder<'_, '_>,
    view: &EntityView<'_>,
    targets: &Targets,
    bodies: &mut Arena<BodyId, BodyAttributes>,
) {
    let Ok(item) = view.reference("item") else {
        let message = format!("{}: no item", view.entity());
        return builder.report(ModelCode::BadReference, view.name(), message);
    };
    let targets = targets.get(item);
    if targets.is_empty() {
        return;
    }
    let Some(colour) = colour_of(builder.scope, view) else { return };
    let over_rides = view.is(Entity::OverRidingStyledItem);
    for &target in targets {
        let own = attributes(builder, bodies, target);
        if over_rides || own.colour.is_none() {
            own.colour = Some(colour);
        }
    }
}

fn attributes<'m>(
    builder: &'m mut Builder<'_, '_>,
    bodies: &'m mut Arena<BodyId, BodyAttributes>,
    target: Target,
) -> &'m mut Attributes {
    match target {
        Target::Face(face) => &mut builder.faces[face],
        Target::Body(body) => &mut bodies[body].own,
    }
}

fn layer(
    builder: &mut Builder<'_, '_>,
    name: InstanceName,
    targets: &Targets,
    bodies: &mut Arena<BodyId, BodyAttributes>,
) {
    let scope = builder.scope;
    let Ok(view) = scope.view(name) else { return };
    let Ok(items) = view.references("assigned_items") else {
        let message = "PRESENTATION_LAYER_ASSIGNMENT: no items".to_owned();
        return builder.report(ModelCode::BadReference, name, message);
    };
    let text = view.text("name").into_owned();
    for item in items {
        // A layer may name the styled item instead of what it styles.
        let styled = scope.view_of(item, Entity::StyledItem).ok().and_then(|v| v.reference("item").ok());
        for &target in targets.get(styled.unwrap_or(item)) {
            let layers = &mut attributes(builder, bodies, target).layers;
            if !layers.contains(&text) {
                layers.push(text.clone());
            }
        }
    }
}

/// The first surface colour among the styles of a styled item, breadth first.
fn colour_of(scope: Scope<'_>, item: &EntityView<'_>) -> Option<Colour> {
    let mut queue: VecDeque<InstanceName> = item.references("styles").ok()?.collect();
    for _ in 0..MAX_STYLE_RECORDS {
        let Some(view) = scope.view(queue.pop_front()?).ok() else { continue };
        let next = match view.entity() {
            Entity::ColourRgb => return rgb(&view),
            Entity::DraughtingPreDefinedColour | Entity::PreDefinedColour => {
                return pre_defined(&view.text("name"));
            }
            Entity::SurfaceStyleUsage => "style",
            Entity::SurfaceStyleFillArea => "fill_area",
            Entity::FillAreaStyleColour => "fill_colour",
            Entity::SurfaceStyleRendering | Entity::SurfaceStyleRenderingWithProperties => "surface_colour",
            Entity::PresentationStyleAssignment | Entity::PresentationStyleByContext => {
                queue.extend(view.references("styles").ok()?);
                continue;
            }
            Entity::SurfaceSideStyle => {
                queue.extend(view.references("styles").ok()?);
                continue;
            }
            Entity::FillAreaStyle => {
                queue.extend(view.references("fill_styles").ok()?);
                continue;
            }
            _ => continue,
        };
        queue.extend(view.reference(next).ok());
    }
    None
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
