//! Two models compared: structure, and faces and free curves by their geometry.
//!
//! Names of records do not count: what has the same shape at the same place is the same, whatever it is called and
//! however it is written. Knows no files and judges nothing beyond the tolerance that it is given.

mod attribute;
mod certified;
mod curve;
mod distance;
mod exact;
mod matching;
mod motion;
mod placed;
mod structure;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::brep::FaceId;
use crate::math::{Affine, Point3};
use crate::model::Model;
pub use placed::{PlacedFace, Side};
pub use structure::StructureChange;

/// What differs between two models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Version of this form: 1.
    pub version: u32,
    /// Whether nothing differs.
    pub equal: bool,
    /// Unit of all lengths: that of the first model's first context.
    pub unit: String,
    /// Distance within which points count as one.
    pub tolerance: f64,
    /// Faces by what became of them.
    pub faces: FaceCounts,
    /// Products, names, looks, units, annotations.
    pub structure: Vec<StructureChange>,
    /// Faces that differ.
    pub changes: Vec<FaceChange>,
    /// Free curves that differ.
    pub curves: Vec<FaceChange>,
    /// Faces that stand for each other.
    #[serde(skip)]
    pub pairs: Vec<Pair>,
    /// What could not be compared, and what differs without being a difference.
    pub notes: Vec<String>,
}

/// How many faces came to what.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct FaceCounts {
    /// Faces of the first model.
    pub before: usize,
    /// Faces of the second.
    pub after: usize,
    /// With the same numbers, in whatever records.
    pub identical: usize,
    /// With other numbers and within the tolerance.
    pub same: usize,
    /// With the same shape elsewhere.
    pub moved: usize,
    /// With another shape.
    pub changed: usize,
    /// Only in the second.
    pub added: usize,
    /// Only in the first.
    pub removed: usize,
}

/// What became of a face or a free curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// The same shape elsewhere.
    Moved,
    /// Another shape.
    Changed,
    /// Only in the second.
    Added,
    /// Only in the first.
    Removed,
}

impl Change {
    /// The word in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Moved => "moved",
            Self::Changed => "changed",
            Self::Added => "added",
            Self::Removed => "removed",
        }
    }
}

/// A face or free curve as its file has it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Named {
    /// Its record.
    pub id: String,
    /// Its name; empty when the file gives none.
    pub name: String,
    /// Kind of its surface or curve, or the entity that is not read.
    pub kind: String,
    /// Names of the products from the root down to it.
    pub product: String,
}

/// One face or free curve that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaceChange {
    /// What became of it.
    pub change: Change,
    /// As the first file has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<Named>,
    /// As the second has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<Named>,
    /// Greatest distance that was found, either way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled: Option<Sampled>,
    /// Distance from the first face's surface that no point of the second face exceeds, proved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certified: Option<f64>,
    /// How it was moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
}

/// A greatest distance over samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sampled {
    /// The distance.
    pub distance: f64,
    /// Where it was found.
    pub at: [f64; 3],
    /// Points that were measured.
    pub points: usize,
}

/// A rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Motion {
    /// Shift of the middle of the face's samples.
    pub shift: [f64; 3],
    /// Angle of the turn in degrees.
    pub degrees: f64,
    /// Greatest distance of a sample from where the motion takes it.
    pub residual: f64,
}

/// Faces of both models that stand for each other: indices into the sides' faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// In the first.
    pub before: usize,
    /// In the second.
    pub after: usize,
    /// What kind of pair.
    pub kin: Kin,
}

/// How two faces stand for each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kin {
    /// The same numbers.
    Identical,
    /// The same points within the tolerance.
    Same,
    /// Moved or changed.
    Differing,
}

/// Compares two models. `tolerance` is in the unit of the first model's first context.
#[must_use]
pub fn compare(before: &Side<'_>, after: &Side<'_>, tolerance: f64) -> Difference {
    let matched = matching::matched(before, after, tolerance);
    let mut counts = FaceCounts {
        before: before.faces.len(),
        after: after.faces.len(),
        added: matched.added.len(),
        removed: matched.removed.len(),
        same: matched.divided,
        ..FaceCounts::default()
    };
    let mut changes = Vec::new();
    for pair in &matched.pairs {
        match pair.kin {
            Kin::Identical => counts.identical += 1,
            Kin::Same => counts.same += 1,
            Kin::Differing => changes.push(differing(before, after, pair, tolerance)),
        }
    }
    counts.moved = changes.iter().filter(|change| change.change == Change::Moved).count();
    counts.changed = changes.len() - counts.moved;
    changes.extend(matched.removed.iter().map(|&at| alone(Change::Removed, before, at)));
    changes.extend(matched.added.iter().map(|&at| alone(Change::Added, after, at)));
    changes.sort_by_key(|change| change.change);
    let mut structure = structure::differences(before.model, after.model);
    structure.extend(attribute::differences(before, after, &matched.pairs));
    let curves = curve::differences(before, after, tolerance);
    let mut notes = structure::notes(before.model, after.model);
    notes.extend(before.notes("first").chain(after.notes("second")));
    Difference {
        version: 1,
        equal: structure.is_empty() && changes.is_empty() && curves.is_empty(),
        unit: before.unit.name.clone(),
        tolerance,
        faces: counts,
        structure,
        changes,
        curves,
        pairs: matched.pairs,
        notes,
    }
}

fn differing(before: &Side<'_>, after: &Side<'_>, pair: &Pair, tolerance: f64) -> FaceChange {
    let (a, b) = (&before.faces[pair.before], &after.faces[pair.after]);
    let motion = motion::between(before, a, after, b).filter(|motion| motion.residual <= tolerance);
    FaceChange {
        change: if motion.is_some() { Change::Moved } else { Change::Changed },
        before: Some(before.named(a)),
        after: Some(after.named(b)),
        sampled: distance::either_way(before, a, after, b),
        certified: certified::bound(before, a, after, b),
        motion,
    }
}

fn alone(change: Change, side: &Side<'_>, at: usize) -> FaceChange {
    let named = Some(side.named(&side.faces[at]));
    let (before, after) = if change == Change::Removed { (named, None) } else { (None, named) };
    FaceChange { change, before, after, sampled: None, certified: None, motion: None }
}

/// Distances of points of the second model from the faces that theirs stand for.
pub struct Deviations<'a> {
    faces: BTreeMap<FaceId, (Affine, Option<distance::Target<'a>>)>,
}

impl<'a> Deviations<'a> {
    /// Of each face at the first of its places.
    #[must_use]
    pub fn new(before: &'a Side<'_>, after: &Side<'_>, difference: &Difference) -> Self {
        let mut faces = BTreeMap::new();
        for pair in &difference.pairs {
            let placed = &after.faces[pair.after];
            faces.entry(placed.face).or_insert_with(|| {
                let differs = pair.kin == Kin::Differing;
                let target = differs.then(|| distance::Target::new(before, &before.faces[pair.before]));
                (placed.transform, target)
            });
        }
        Self { faces }
    }

    /// For points of a face in its body's coordinates; `None` for a face that is only in the second model.
    #[must_use]
    pub fn of(&self, face: FaceId, points: &[Point3<f64>]) -> Option<Vec<f64>> {
        let (transform, target) = self.faces.get(&face)?;
        let distance = |point| target.as_ref().map_or(0.0, |target| target.distance(&transform.point(point)));
        Some(points.iter().map(distance).collect())
    }
}

/// Kind of a face's surface, or the entity that is not read.
fn kind_of(model: &Model, face: FaceId) -> String {
    placed::kind(model.brep.surface_of(face), crate::geometry::Surface::kind)
}
