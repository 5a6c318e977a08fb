//! Names, colours and layers of faces that stand for each other.

use std::collections::BTreeMap;

use super::Pair;
use super::placed::{PlacedFace, Side};
use super::structure::StructureChange;
use crate::model::Colour;

/// How a word of a face is read off.
type Word = fn(&Side<'_>, &PlacedFace) -> String;

const WORDS: [(&str, Word); 5] = [
    ("name", name),
    ("colour", colour),
    ("transparency", transparency),
    ("layer", layer),
    ("hidden", hidden),
];

/// One line for each kind of change, with how many faces it is about and the first of them.
pub(super) fn differences(before: &Side<'_>, after: &Side<'_>, pairs: &[Pair]) -> Vec<StructureChange> {
    let mut found: BTreeMap<(&'static str, String, String), (usize, String)> = BTreeMap::new();
    for pair in pairs {
        let (a, b) = (&before.faces[pair.before], &after.faces[pair.after]);
        for (what, word) in WORDS {
            let (was, is) = (word(before, a), word(after, b));
            if was != is {
                let first = after.model.origins.faces[b.face].to_string();
                found.entry((what, was, is)).or_insert((0, first)).0 += 1;
            }
        }
    }
    let change = |((what, was, is), (count, first)): ((&'static str, String, String), (usize, String))| {
        let faces =
            if count == 1 { format!("face {first}") } else { format!("{count} faces, the first {first}") };
        StructureChange { what, message: format!("{faces}: `{was}` before, `{is}` after") }
    };
    found.into_iter().map(change).collect()
}

fn name(side: &Side<'_>, face: &PlacedFace) -> String {
    side.model.faces[face.face].name.clone()
}

fn colour(side: &Side<'_>, face: &PlacedFace) -> String {
    let placed = &side.instances.bodies[face.placed];
    side.instances.colour(side.model, placed, face.face).map(hex).unwrap_or_default()
}

/// Two hexadecimal digits of each part: files write colours with as few as two decimals.
fn hex(colour: Colour) -> String {
    let part = |part: f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    format!("#{:02x}{:02x}{:02x}", part(colour.red), part(colour.green), part(colour.blue))
}

fn transparency(side: &Side<'_>, face: &PlacedFace) -> String {
    format!("{:.3}", side.model.transparency_of(face.face))
}

fn layer(side: &Side<'_>, face: &PlacedFace) -> String {
    side.model.layers_of(face.face).collect::<Vec<_>>().join(", ")
}

fn hidden(side: &Side<'_>, face: &PlacedFace) -> String {
    side.model.is_hidden(face.face).to_string()
}
