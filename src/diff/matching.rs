//! Which face of one model stands for which of the other.
//!
//! From the certain to the likely: the same numbers, the same points within the tolerance, the same points divided into
//! other faces, and then what is left: by record where both files share their records, by name, by where it is.

use std::collections::{BTreeMap, BTreeSet};

use super::distance::{Target, are_same, bound_samples, inner_samples};
use super::exact;
use super::placed::{PlacedFace, Side};
use super::{Kin, Pair};
use crate::model::Origin;

/// Faces that stand for each other, and those that stand alone.
#[derive(Debug, Default)]
pub(super) struct Matched {
    pub pairs: Vec<Pair>,
    /// Faces of the second model whose points are those of several of the first.
    pub divided: usize,
    pub removed: Vec<usize>,
    pub added: Vec<usize>,
}

/// What has no partner yet, on both sides.
struct Left {
    before: BTreeSet<usize>,
    after: BTreeSet<usize>,
}

impl Left {
    fn take(&mut self, pairs: &mut Vec<Pair>, before: usize, after: usize, kin: Kin) {
        self.before.remove(&before);
        self.after.remove(&after);
        pairs.push(Pair { before, after, kin });
    }

    fn is_done(&self) -> bool {
        self.before.is_empty() || self.after.is_empty()
    }
}

pub(super) fn matched(before: &Side<'_>, after: &Side<'_>, tolerance: f64) -> Matched {
    let mut left =
        Left { before: (0..before.faces.len()).collect(), after: (0..after.faces.len()).collect() };
    let mut pairs = Vec::new();
    identical(before, after, &mut left, &mut pairs);
    same(before, after, tolerance, &mut left, &mut pairs);
    let divided = divided(before, after, tolerance, &mut left);
    if share_records(before, after, &pairs, &left) {
        by_key(before, after, &mut left, &mut pairs, |side, face| {
            Some(Key::Record(side.model.origins.faces[face.face]))
        });
    }
    by_key(before, after, &mut left, &mut pairs, |side, face| {
        let name = &side.model.faces[face.face].name;
        (!name.is_empty()).then(|| Key::Name(name.clone()))
    });
    by_place(before, after, &mut left, &mut pairs);
    pairs.sort_by_key(|pair| (pair.before, pair.after));
    Matched {
        pairs,
        divided,
        removed: left.before.into_iter().collect(),
        added: left.after.into_iter().collect(),
    }
}

fn identical(before: &Side<'_>, after: &Side<'_>, left: &mut Left, pairs: &mut Vec<Pair>) {
    let mut known: BTreeMap<u128, Vec<usize>> = BTreeMap::new();
    for (at, face) in after.faces.iter().enumerate().rev() {
        known.entry(exact::of_face(after, face)).or_default().push(at);
    }
    for (at, face) in before.faces.iter().enumerate() {
        if let Some(other) = known.get_mut(&exact::of_face(before, face)).and_then(Vec::pop) {
            left.take(pairs, at, other, Kin::Identical);
        }
    }
}

/// Further faces that are looked at for each: beyond that they are too many on one place to be told apart by it.
const CANDIDATES: usize = 8;

/// Part of the size within which the triangles of one face, made from two forms of it, have their middles.
const MIDDLES: f64 = 4e-3;

fn same(before: &Side<'_>, after: &Side<'_>, tolerance: f64, left: &mut Left, pairs: &mut Vec<Pair>) {
    for at in left.before.clone() {
        let face = &before.faces[at];
        let near = |other: &PlacedFace| {
            let reach = MIDDLES * face.bounds.diagonal().max(other.bounds.diagonal()) + tolerance;
            let alike = (face.area - other.area).abs() <= 0.05 * face.area.max(other.area);
            let middles = (face.middle - other.middle).norm();
            (middles <= reach && alike).then_some(middles)
        };
        let mut candidates: Vec<(f64, usize)> =
            left.after.iter().filter_map(|&other| Some((near(&after.faces[other])?, other))).collect();
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let found = candidates
            .into_iter()
            .take(CANDIDATES)
            .find(|&(_, other)| are_same(before, face, after, &after.faces[other], tolerance));
        if let Some((_, other)) = found {
            left.take(pairs, at, other, Kin::Same);
        }
    }
}

/// Takes away faces whose points all lie on faces of the other side that are left: another kernel cuts a closed face in
/// two, or joins two. Gives the count of the second side's.
fn divided(before: &Side<'_>, after: &Side<'_>, tolerance: f64, left: &mut Left) -> usize {
    let covered = |side: &Side<'_>, faces: &BTreeSet<usize>, by: &Side<'_>, others: &BTreeSet<usize>| {
        let lies = |&at: &usize| {
            let face = &side.faces[at];
            let near: Vec<Target<'_>> = others
                .iter()
                .map(|&other| &by.faces[other])
                .filter(|other| touch(face, other, tolerance))
                .map(|other| Target::new(by, other))
                .collect();
            let points = inner_samples(side, face).into_iter().chain(bound_samples(side, face));
            !near.is_empty() && { points }
                .all(|point| near.iter().any(|target| target.distance(&point) <= tolerance))
        };
        faces.iter().copied().filter(lies).collect::<BTreeSet<usize>>()
    };
    if left.is_done() {
        return 0;
    }
    let of_before = covered(before, &left.before, after, &left.after);
    let of_after = covered(after, &left.after, before, &of_before);
    let of_before = covered(before, &of_before, after, &of_after);
    left.before.retain(|at| !of_before.contains(at));
    left.after.retain(|at| !of_after.contains(at));
    of_after.len()
}

fn touch(a: &PlacedFace, b: &PlacedFace, tolerance: f64) -> bool {
    (0..3).all(|k| {
        a.bounds.min[k] <= b.bounds.max[k] + tolerance && b.bounds.min[k] <= a.bounds.max[k] + tolerance
    })
}

/// Part of the faces that must have the same record on both sides, for a record to tell anything.
const MOST: f64 = 0.9;

/// Whether one file comes from the other by edits: the faces that are the same have the same records, and those that are
/// left too.
fn share_records(before: &Side<'_>, after: &Side<'_>, pairs: &[Pair], left: &Left) -> bool {
    let origin = |side: &Side<'_>, at: usize| side.model.origins.faces[side.faces[at].face];
    let equal = pairs.iter().filter(|pair| origin(before, pair.before) == origin(after, pair.after)).count();
    let known: BTreeSet<Origin> = left.after.iter().map(|&at| origin(after, at)).collect();
    let there = left.before.iter().filter(|&&at| known.contains(&origin(before, at))).count();
    equal as f64 >= MOST * pairs.len() as f64
        && (there as f64 >= MOST * left.before.len() as f64 || !pairs.is_empty())
}

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Record(Origin),
    Name(String),
}

/// Pairs what has the same key, once on each side and in each place of the assembly.
fn by_key(
    before: &Side<'_>,
    after: &Side<'_>,
    left: &mut Left,
    pairs: &mut Vec<Pair>,
    key: impl Fn(&Side<'_>, &PlacedFace) -> Option<Key>,
) {
    let listed = |side: &Side<'_>, faces: &BTreeSet<usize>| {
        let mut known: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        for &at in faces {
            if let Some(key) = key(side, &side.faces[at]) {
                known.entry(key).or_default().push(at);
            }
        }
        known
    };
    let (mut of_before, of_after) = (listed(before, &left.before), listed(after, &left.after));
    for (key, others) in of_after {
        // The places of one part are walked in one order, so that equal counts are equal places.
        let own = of_before.remove(&key).unwrap_or_default();
        if own.len() == others.len() && (own.len() == 1 || matches!(key, Key::Record(_))) {
            for (at, other) in own.into_iter().zip(others) {
                left.take(pairs, at, other, Kin::Differing);
            }
        }
    }
}

/// Distance of the middles, in sizes of the faces, and part of the areas, beyond which two faces have nothing to do with
/// each other.
const FAR: f64 = 0.5;

/// Pairs what is nearest to each other, the likeliest first.
fn by_place(before: &Side<'_>, after: &Side<'_>, left: &mut Left, pairs: &mut Vec<Pair>) {
    let mut candidates = Vec::new();
    for &at in &left.before {
        for &other in &left.after {
            let (a, b) = (&before.faces[at], &after.faces[other]);
            let size = a.bounds.diagonal().max(b.bounds.diagonal());
            if size > 0.0 && a.area > 0.0 && b.area > 0.0 {
                let cost = (a.middle - b.middle).norm() / size + (a.area / b.area).ln().abs();
                if cost < FAR {
                    candidates.push((cost, at, other));
                }
            }
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    for (_, at, other) in candidates {
        if left.before.contains(&at) && left.after.contains(&other) {
            left.take(pairs, at, other, Kin::Differing);
        }
    }
}
