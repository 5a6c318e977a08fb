//! A text of the numbers of a face or curve that is equal just where they are: what a file needs no geometry for.

use std::fmt::Write;

use super::placed::{PlacedFace, Side};
use crate::brep::EdgeId;
use crate::math::Affine;
use crate::model::Model;

/// Hash of a text that is never held whole: nets have megabytes of it. FNV-1a, 128 bits wide, so that no two texts of
/// one part meet by chance.
struct Hash(u128);

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
        for byte in text.bytes() {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(PRIME);
        }
        Ok(())
    }
}

const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;

/// The numbers of a face at its place: surface, sense, loops with their edges and vertices. Curves in parameters say
/// nothing of their own, nor does the direction in which an edge is stored.
pub(super) fn of_face(side: &Side<'_>, placed: &PlacedFace) -> u128 {
    let brep = &side.model.brep;
    let face = &brep.faces[placed.face];
    let mut hash = hash_of(&(&placed.transform, brep.surface_of(placed.face), face.same_sense));
    let mut loops: Vec<u128> = face.loops.iter().map(|&id| of_loop(side.model, id)).collect();
    loops.sort_unstable();
    for found in loops {
        hash = hash_of(&(hash, found));
    }
    hash
}

/// A loop without its starting point: edges in a cycle are the same wherever the file begins.
fn of_loop(model: &Model, id: crate::brep::LoopId) -> u128 {
    let brep = &model.brep;
    let bound = &brep.loops[id];
    let vertex = bound.vertex.map(|vertex| &brep.vertices[vertex].point);
    let edges = bound.coedges.iter().map(|&coedge| {
        let coedge = &brep.coedges[coedge];
        hash_of(&(of_edge(model, coedge.edge), coedge.forward == bound.forward))
    });
    let mut edges: Vec<u128> = edges.collect();
    let first = (0..edges.len()).min_by_key(|&at| edges[at]).unwrap_or(0);
    edges.rotate_left(first);
    hash_of(&(vertex, edges))
}

fn of_edge(model: &Model, id: EdgeId) -> u128 {
    let edge = &model.brep.edges[id];
    let point = |vertex| &model.brep.vertices[vertex].point;
    hash_of(&(model.brep.curve_of(id), edge.same_sense, point(edge.start), point(edge.end)))
}

/// The numbers of a free curve, in its unit.
pub(super) fn of_curve(model: &Model, curve: crate::brep::CurveId, transform: &Affine) -> u128 {
    hash_of(&(transform, &model.brep.curves[curve]))
}

fn hash_of(value: &impl std::fmt::Debug) -> u128 {
    let mut hash = Hash(START);
    // The hash takes any text, so writing does not fail.
    let _ = write!(hash, "{value:?}");
    hash.0
}
