//! Outlines: the borders of faces, holes in another colour than the rest.

use super::camera::{Place, Projected};
use super::raster::Raster;
use crate::brep::FaceId;
use crate::mesh::Mesh;
use std::collections::{BTreeMap, BTreeSet};
use tiny_skia::{LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Depth in pixels by which a line may lie behind the surface and still count as on it.
const BIAS: f64 = 3.0;

/// Draws what can be seen of the borders of all faces, holes last.
pub(super) fn draw(
    mesh: &Mesh,
    projected: &[Projected],
    raster: &Raster,
    place: &Place,
    pixmap: &mut Pixmap,
) {
    let mut outer = Vec::new();
    let mut holes = Vec::new();
    for borders in borders(mesh).values() {
        let mut chains = chains(borders);
        if let Some(longest) = longest(&chains, projected) {
            outer.push(chains.swap_remove(longest));
        }
        holes.extend(chains);
    }
    for chain in outer {
        stroke(&chain, projected, raster, place, pixmap, [70, 78, 92], 1.4);
    }
    for chain in holes {
        stroke(&chain, projected, raster, place, pixmap, [214, 48, 36], 2.0);
    }
}

/// Directed edges of each face that have no neighbour of the same face.
fn borders(mesh: &Mesh) -> BTreeMap<Option<FaceId>, Vec<[u32; 2]>> {
    let face = |at: usize| mesh.faces.get(at).copied();
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let mut uses = BTreeSet::new();
    for (at, &corners) in mesh.triangles.iter().enumerate() {
        uses.extend(sides(corners).map(|[from, to]| (face(at), from, to)));
    }
    let mut borders: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for &(face, from, to) in uses.iter().filter(|&&(face, from, to)| !uses.contains(&(face, to, from))) {
        borders.entry(face).or_default().push([from, to]);
    }
    borders
}

/// Joins directed edges end to start, as long as they go on.
fn chains(borders: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for [from, to] in borders {
        next.entry(*from).or_default().push(*to);
    }
    let mut chains = Vec::new();
    for [start, _] in borders {
        let mut chain = vec![*start];
        let mut at = *start;
        while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
            chain.push(to);
            at = to;
        }
        if chain.len() > 1 {
            chains.push(chain);
        }
    }
    chains
}

/// The chain with the greatest length in the picture: a face's outer border.
fn longest(chains: &[Vec<u32>], projected: &[Projected]) -> Option<usize> {
    let length = |chain: &Vec<u32>| -> f64 {
        let step = |pair: &[u32]| {
            let [[x, y, _], [u, v, _]] = [projected[pair[0] as usize], projected[pair[1] as usize]];
            (x - u).hypot(y - v)
        };
        chain.windows(2).map(step).sum()
    };
    (0..chains.len()).max_by(|&a, &b| length(&chains[a]).total_cmp(&length(&chains[b])))
}

#[expect(clippy::cast_possible_truncation, reason = "pixels in single precision are exact enough to draw")]
fn stroke(
    chain: &[u32],
    projected: &[Projected],
    raster: &Raster,
    place: &Place,
    pixmap: &mut Pixmap,
    [r, g, b]: [u8; 3],
    width: f32,
) {
    let mut path = PathBuilder::new();
    let mut drawing = false;
    for pair in chain.windows(2) {
        let [from, to] = [projected[pair[0] as usize], projected[pair[1] as usize]];
        let within = |x: f64, size: u32| x >= 0.0 && x <= f64::from(size);
        let visible = |[x, y, depth]: Projected| {
            within(x, place.width) && within(y, place.height) && depth + BIAS >= raster.depth(x, y)
        };
        if !(visible(from) && visible(to)) {
            drawing = false;
            continue;
        }
        let at = |p: Projected| (p[0] as f32 + place.left as f32, p[1] as f32 + place.top as f32);
        if !drawing {
            let (x, y) = at(from);
            path.move_to(x, y);
        }
        let (x, y) = at(to);
        path.line_to(x, y);
        drawing = true;
    }
    let Some(path) = path.finish() else { return };
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint.anti_alias = true;
    let (line_cap, line_join) = (LineCap::Round, LineJoin::Round);
    let stroke = Stroke { width, line_cap, line_join, ..Stroke::default() };
    pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}
