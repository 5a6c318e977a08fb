//! Names, colours, levels and blank status (IGES 5.3 sections 2.2.4.4 and 4.93 and the name property).

use super::code::ModelCode;
use super::roots::Roots;
use super::scope::{Scope, kind};
use crate::diagnostic::Sink;
use crate::iges::{Entity, EntityView, EntryNumber, Instance};
use crate::model::{Appearance, Attributes, Colour};

/// Form of the property that names an entity.
const NAME: i32 = 15;
/// Form of the property that lists levels.
const LEVELS: i32 = 1;

/// What an entity says of itself beside its shape.
pub(super) fn attributes(
    scope: &Scope<'_>,
    roots: &Roots,
    instance: Instance<'_>,
    sink: &mut dyn Sink,
) -> Attributes {
    Attributes {
        name: name(scope, instance),
        appearance: Appearance {
            colour: colour(scope, instance, sink),
            transparency: None,
            hidden: instance.entry().status.blank == 1,
        },
        layers: layers(scope, roots, instance),
    }
}

/// The name by a property, or else the label.
pub(super) fn name(scope: &Scope<'_>, instance: Instance<'_>) -> String {
    let properties = EntityView::of(instance).map(|view| view.trailing().properties).unwrap_or_default();
    let text = |number: EntryNumber| {
        let property = scope.file.instance(number)?;
        let is_name = kind(property) == Some(Entity::Property) && property.entry().form == NAME;
        is_name.then(|| EntityView::of(property).map(|view| view.fields().text("name")))?
    };
    let named = properties.into_iter().filter_map(text).find(|name| !name.is_empty());
    named.unwrap_or_else(|| instance.entry().label_text())
}

/// Colours by number, from 1 (IGES 5.3 section 2.2.4.4.13).
const COLOURS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

fn colour(scope: &Scope<'_>, instance: Instance<'_>, sink: &mut dyn Sink) -> Option<Colour> {
    let number = instance.entry().colour;
    if number == 0 {
        return None;
    }
    let of = |[red, green, blue]: [f64; 3]| Colour { red, green, blue };
    let known = usize::try_from(number).ok().and_then(|number| COLOURS.get(number - 1));
    if let Some(colour) = known {
        return Some(of(*colour));
    }
    let definition = EntryNumber::from_pointer(-i64::from(number));
    let parts = definition.and_then(|definition| {
        let view = scope.view_of(definition, Entity::ColourDefinition, "COLOUR_DEFINITION").ok()?;
        let part = |field| view.fields().real(field).ok().map(|percent| (percent / 100.0).clamp(0.0, 1.0));
        Some([part("red")?, part("green")?, part("blue")?])
    });
    if parts.is_none() {
        let message = format!("colour {number} is neither a colour's number nor a colour definition");
        sink.report(ModelCode::BadReference.at(scope.file, instance.number(), message));
    }
    parts.map(of)
}

fn layers(scope: &Scope<'_>, roots: &Roots, instance: Instance<'_>) -> Vec<String> {
    let level = instance.entry().level;
    let listed = || {
        let list = EntryNumber::from_pointer(-i64::from(level))?;
        let view = scope.view_of(list, Entity::Property, "PROPERTY").ok()?;
        let levels = view.fields().list("levels").filter_map(|level| level.as_i64());
        (view.instance().entry().form == LEVELS).then(|| levels.collect::<Vec<_>>())
    };
    let levels = if level > 0 { vec![i64::from(level)] } else { listed().unwrap_or_default() };
    let mut names = Vec::new();
    for level in levels {
        names.push(level.to_string());
        let given = i32::try_from(level).ok().and_then(|level| roots.levels.get(&level));
        names.extend(given.cloned());
    }
    names
}
