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
            if was != is && !(what == "colour" && are_near(colour_of(before, a), colour_of(after, b))) {
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
    colour_of(side, face).map(hex).unwrap_or_default()
}

fn colour_of(side: &Side<'_>, face: &PlacedFace) -> Option<Colour> {
    side.instances.colour(side.model, &side.instances.bodies[face.placed], face.face)
}

/// Part of the range of a colour's parts within which two are one: files write them with as few as two decimals.
const ONE_COLOUR: f64 = 0.006;

fn are_near(a: Option<Colour>, b: Option<Colour>) -> bool {
    a.zip(b).is_some_and(|(a, b)| {
        let parts = [(a.red, b.red), (a.green, b.green), (a.blue, b.blue)];
        parts.iter().all(|(a, b)| (a - b).abs() <= ONE_COLOUR)
    })
}

/// Two hexadecimal digits of each part.
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
