//! Outlines: the borders of faces, holes in another colour than the rest.

use super::camera::{Place, Projected};
use super::raster::Raster;
use crate::mesh::Mesh;
use std::collections::BTreeMap;
use tiny_skia::{LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Depth in pixels by which a line may lie behind the surface and still count as on it.
const BIAS: f64 = 3.0;

/// Draws what can be seen of the borders of all faces.
pub(super) fn draw(
    mesh: &Mesh,
    projected: &[Projected],
    raster: &Raster,
    place: &Place,
    pixmap: &mut Pixmap,
) {
    let chains = chains(&borders(mesh));
    let outer = longest(&chains, projected);
    for (at, chain) in chains.iter().enumerate() {
        let (colour, width) = if Some(at) == outer { ([70, 78, 92], 1.4) } else { ([214, 48, 36], 2.0) };
        stroke(chain, projected, raster, place, pixmap, colour, width);
    }
}

/// Directed edges that have no neighbour of the same face.
fn borders(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut uses: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (at, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            uses.entry([from, to]).or_default().push(at);
        }
    }
    let face = |at: usize| mesh.faces.get(at).copied();
    let same_face = |at: usize, other: &Vec<usize>| other.iter().any(|&o| face(o) == face(at));
    let is_border =
        |edge: &[u32; 2], at: usize| !uses.get(&[edge[1], edge[0]]).is_some_and(|o| same_face(at, o));
    let lone = uses.iter().filter(|(edge, triangles)| triangles.iter().any(|&at| is_border(edge, at)));
    lone.map(|(edge, _)| *edge).collect()
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

/// The chain with the greatest length in the picture: the outer border, when the view is one face.
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
        let visible = |[x, y, depth]: Projected| depth + BIAS >= raster.depth(x, y);
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
