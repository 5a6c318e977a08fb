//! Walls that can be made longer: prismatic sets of held faces, and which of them to cut a hold at so that its ends may
//! follow the scaling each for itself.
//!
//! Decides on topology and kinds alone; how far the ends part is for [`piece`](super::piece).

use std::collections::{BTreeMap, BTreeSet};

use crate::brep::{EdgeId, FaceId, edge_range};
use crate::geometry::{Curve, Surface};
use crate::math::Vector3;
use crate::model::Model;

/// Sine of the angle, and part of a length, within which directions and chords are one.
const PARALLEL: f64 = 1e-9;
/// Rings of one feature of which all subsets are tried, smallest first.
const MOST_RINGS: usize = 12;
/// Points of an end edge that tell how long a wall is.
const END_SAMPLES: usize = 9;

/// A wall that keeps its carriers when it is lengthened: held faces on cylinders, extrusions and planes along one
/// direction, joined over straight edges along it.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    /// Direction, of unit length.
    pub axis: Vector3<f64>,
    /// Its faces.
    pub faces: BTreeSet<FaceId>,
    /// Straight edges along the direction, between its faces.
    pub generators: BTreeSet<EdgeId>,
    /// All its other edges.
    pub ends: BTreeSet<EdgeId>,
    /// Extent of the ends along the direction.
    length: f64,
}

/// Which faces use an edge, and which held loops.
pub(super) struct Uses<'a> {
    pub model: &'a Model,
    /// Faces by edge.
    pub faces: BTreeMap<EdgeId, BTreeSet<FaceId>>,
}

impl<'a> Uses<'a> {
    /// Of the edges of some faces: all faces of the model that use them.
    pub fn new(model: &'a Model) -> Self {
        let mut faces: BTreeMap<EdgeId, BTreeSet<FaceId>> = BTreeMap::new();
        for (_, coedge) in model.brep.coedges.iter() {
            faces.entry(coedge.edge).or_default().insert(model.brep.loops[coedge.in_loop].face);
        }
        Self { model, faces }
    }

    pub fn edges_of(&self, face: FaceId) -> impl Iterator<Item = EdgeId> + '_ {
        self.model.brep.coedges_of(face).map(|c| self.model.brep.coedges[c].edge)
    }
}

fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() < PARALLEL
}

/// Direction of an edge that is straight.
fn straight(model: &Model, edge: EdgeId) -> Option<Vector3<f64>> {
    let curve = model.brep.curve_of(edge).read()?;
    if let Curve::Line { direction, .. } = curve {
        return direction.try_normalize(0.0);
    }
    let range = edge_range(&model.brep, edge)?;
    let at = |part: f64| curve.point_wrapped(range.start + (range.end - range.start) * part);
    let (start, end) = (at(0.0), at(1.0));
    let length = (end - start).norm();
    // Two inner points: an S-curve passes through the middle of its chord.
    let on = |part: f64| (at(part) - (start + (end - start) * part)).norm() <= PARALLEL * length;
    (length > 0.0 && on(0.5) && on(0.25)).then(|| (end - start) / length)
}

/// The direction along which a surface goes on straight by itself.
fn ruling(surface: &Surface) -> Option<Vector3<f64>> {
    match surface {
        Surface::Cylinder { frame, .. } => Some(frame.z),
        Surface::LinearExtrusion { direction, .. } => direction.try_normalize(0.0),
        _ => None,
    }
}

/// Whether a face may be part of a wall along a direction.
fn goes_along(model: &Model, face: FaceId, axis: &Vector3<f64>) -> bool {
    match model.brep.surface_of(face).read() {
        Some(Surface::Plane(frame)) => frame.z.dot(axis).abs() < PARALLEL,
        Some(surface) => ruling(surface).is_some_and(|own| parallel(&own, axis)),
        None => false,
    }
}

/// Walls among the faces of one feature, longest first.
fn rings(uses: &Uses<'_>, faces: &BTreeSet<FaceId>) -> Vec<Ring> {
    let model = uses.model;
    let mut axes = distinct(faces.iter().filter_map(|&f| ruling(model.brep.surface_of(f).read()?)));
    if axes.is_empty() {
        let edges: BTreeSet<EdgeId> = faces.iter().flat_map(|&f| uses.edges_of(f)).collect();
        axes = distinct(edges.iter().filter_map(|&e| straight(model, e)));
    }
    let mut found: Vec<Ring> = axes.iter().flat_map(|axis| rings_along(uses, faces, axis)).collect();
    found.sort_by(|a, b| b.length.total_cmp(&a.length));
    found
}

/// Directions of which no two are parallel.
fn distinct(all: impl Iterator<Item = Vector3<f64>>) -> Vec<Vector3<f64>> {
    let mut axes: Vec<Vector3<f64>> = Vec::new();
    for axis in all {
        if !axes.iter().any(|known| parallel(known, &axis)) {
            axes.push(axis);
        }
    }
    axes
}

fn rings_along(uses: &Uses<'_>, faces: &BTreeSet<FaceId>, axis: &Vector3<f64>) -> Vec<Ring> {
    let model = uses.model;
    let along = |edge: EdgeId| straight(model, edge).is_some_and(|own| parallel(&own, axis));
    // A plane is no wall by itself: the floor of a counterbore lies along every direction in it.
    let alone = |face: FaceId| {
        let flat = matches!(model.brep.surface_of(face).read(), Some(Surface::Plane(_)));
        flat && !uses.edges_of(face).any(along)
    };
    let fit: BTreeSet<FaceId> =
        faces.iter().copied().filter(|&f| goes_along(model, f, axis) && !alone(f)).collect();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for &first in &fit {
        if !seen.insert(first) {
            continue;
        }
        let mut ring = BTreeSet::from([first]);
        let mut work = vec![first];
        while let Some(face) = work.pop() {
            for edge in uses.edges_of(face).filter(|&e| along(e)) {
                for &other in uses.faces[&edge].intersection(&fit) {
                    if ring.insert(other) {
                        seen.insert(other);
                        work.push(other);
                    }
                }
            }
        }
        let edges: BTreeSet<EdgeId> = ring.iter().flat_map(|&f| uses.edges_of(f)).collect();
        let (generators, ends): (BTreeSet<EdgeId>, BTreeSet<EdgeId>) =
            edges.into_iter().partition(|&e| along(e));
        if generators.iter().all(|e| uses.faces[e].is_subset(&ring)) {
            let length = extent(model, &ends, axis);
            found.push(Ring { axis: *axis, faces: ring, generators, ends, length });
        }
    }
    found
}

fn extent(model: &Model, edges: &BTreeSet<EdgeId>, axis: &Vector3<f64>) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for &edge in edges {
        for point in end_points(model, edge) {
            let height = point.coords.dot(axis);
            (low, high) = (low.min(height), high.max(height));
        }
    }
    high - low
}

/// A few points of an edge.
pub(super) fn end_points(model: &Model, edge: EdgeId) -> Vec<crate::math::Point3<f64>> {
    let (Some(curve), Some(range)) = (model.brep.curve_of(edge).read(), edge_range(&model.brep, edge)) else {
        return Vec::new();
    };
    let step = (range.end - range.start) / (END_SAMPLES - 1) as f64;
    (0..END_SAMPLES).map(|k| curve.point_wrapped(range.start + step * k as f64)).collect()
}

/// Faces and loops that stay one rigid piece.
#[derive(Debug, Clone, Default)]
pub(super) struct RigidPart {
    pub faces: BTreeSet<FaceId>,
    /// Held loops by number.
    pub loops: Vec<usize>,
}

/// A feature cut at some of its walls.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    pub rings: Vec<Ring>,
    pub parts: Vec<RigidPart>,
}

/// The held loops of a feature with their edges.
pub(super) type LoopEdges = BTreeMap<usize, BTreeSet<EdgeId>>;

/// Parts of a feature that are connected over shared edges once some faces are taken away.
pub(super) fn connected(
    uses: &Uses<'_>,
    faces: &BTreeSet<FaceId>,
    loops: &LoopEdges,
    without: &BTreeSet<FaceId>,
) -> Vec<RigidPart> {
    let mut union = Union::default();
    let mut owner: BTreeMap<EdgeId, usize> = BTreeMap::new();
    let kept: Vec<FaceId> = faces.difference(without).copied().collect();
    let of_faces = kept.iter().map(|&face| uses.edges_of(face).collect::<Vec<EdgeId>>());
    let of_loops = loops.values().map(|edges| edges.iter().copied().collect());
    for (item, edges) in of_faces.chain(of_loops).enumerate() {
        union.add();
        for edge in edges {
            let first = *owner.entry(edge).or_insert(item);
            union.join(first, item);
        }
    }
    let mut parts: BTreeMap<usize, RigidPart> = BTreeMap::new();
    for (item, &face) in kept.iter().enumerate() {
        parts.entry(union.root(item)).or_default().faces.insert(face);
    }
    for (item, &number) in loops.keys().enumerate() {
        parts.entry(union.root(kept.len() + item)).or_default().loops.push(number);
    }
    let mut parts: Vec<RigidPart> = parts.into_values().collect();
    parts.sort_by(|a, b| a.loops.cmp(&b.loops).then_with(|| a.faces.cmp(&b.faces)));
    parts
}

/// Items in sets that can be joined.
#[derive(Debug, Default)]
struct Union {
    parent: Vec<usize>,
}

impl Union {
    fn add(&mut self) {
        self.parent.push(self.parent.len());
    }

    fn root(&self, mut item: usize) -> usize {
        while self.parent[item] != item {
            item = self.parent[item];
        }
        item
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}

/// The fewest walls at which a feature can be cut so that all its parts are good, longer walls first among as many;
/// `None` when there are none such.
pub(super) fn cut(
    uses: &Uses<'_>,
    faces: &BTreeSet<FaceId>,
    loops: &LoopEdges,
    good: &dyn Fn(&RigidPart, &Vector3<f64>) -> bool,
) -> Option<Cut> {
    let mut all = rings(uses, faces);
    let axis = all.first()?.axis;
    all.retain(|ring| parallel(&ring.axis, &axis));
    all.truncate(MOST_RINGS);
    for count in 1..=all.len() {
        for chosen in combinations(all.len(), count) {
            let without: BTreeSet<FaceId> =
                chosen.iter().flat_map(|&k| all[k].faces.iter().copied()).collect();
            let parts = connected(uses, faces, loops, &without);
            if parts.iter().all(|part| !part.loops.is_empty() && good(part, &axis)) {
                return Some(Cut { rings: chosen.iter().map(|&k| all[k].clone()).collect(), parts });
            }
        }
    }
    None
}

/// Ascending choices of `count` among `n`, in lexicographic order.
fn combinations(n: usize, count: usize) -> Vec<Vec<usize>> {
    let mut found = vec![Vec::new()];
    for _ in 0..count {
        let longer = found.iter().flat_map(|choice: &Vec<usize>| {
            let next = choice.last().map_or(0, |last| last + 1);
            (next..n).map(move |k| [choice.as_slice(), &[k]].concat())
        });
        found = longer.collect();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_are_all_and_in_order() {
        assert_eq!(combinations(3, 2), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!(combinations(4, 4), [[0, 1, 2, 3]]);
    }
}
