//! Names, colours, layers and outer sides of faces that stand for each other.

use std::collections::BTreeMap;

use super::placed::{PlacedFace, Side};
use super::structure::StructureChange;
use super::{Kin, Pair};
use crate::math::{Point3, Vector3};
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
        if pair.kin != Kin::Differing && are_turned(before, a, after, b) {
            let first = after.model.origins.faces[b.face].to_string();
            let (was, is) = ("one side".to_owned(), "the other".to_owned());
            found.entry(("outer side", was, is)).or_insert((0, first)).0 += 1;
        }
    }
    let change = |((what, was, is), (count, first)): ((&'static str, String, String), (usize, String))| {
        let faces =
            if count == 1 { format!("face {first}") } else { format!("{count} faces, the first {first}") };
        StructureChange { what, message: format!("{faces}: `{was}` before, `{is}` after") }
    };
    found.into_iter().map(change).collect()
}

/// Whether two faces of one shape have their material on different sides.
fn are_turned(before: &Side<'_>, a: &PlacedFace, after: &Side<'_>, b: &PlacedFace) -> bool {
    let Some(point) = before.mesh(a).and_then(|mesh| mesh.corners().next()) else { return false };
    let corners = point.map(|corner| a.transform.point(&corner).coords);
    let point = Point3::from((corners[0] + corners[1] + corners[2]) / 3.0);
    let normals = outward(before, a, &point).zip(outward(after, b, &point));
    normals.is_some_and(|(a, b)| a.dot(&b) < 0.0)
}

/// Normal out of the material at the foot of a point; `None` where the surface has none.
fn outward(side: &Side<'_>, face: &PlacedFace, point: &Point3<f64>) -> Option<Vector3<f64>> {
    let brep = &side.model.brep;
    let surface = brep.surface_of(face.face).read()?;
    let (u, v) = surface.parameters_of(&face.transform.inverse()?.point(point), None);
    let normal = face.transform.vector(&surface.normal(u, v)?);
    let topology = &brep.faces[face.face];
    let out = topology.same_sense == brep.shells[topology.shell].forward;
    Some(if out { normal } else { -normal })
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
