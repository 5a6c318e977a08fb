//! States anew what a file says of the volume, area and centroid of parts that a job has changed.
//!
//! A number is measured anew only when the old one was what the faces of the part before give: otherwise it means something
//! that is not understood here, such as a centroid of masses. Neither finds nor judges statements otherwise.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::brep::mass_properties::Quadrature;
use crate::brep::{BodyId, FaceId};
use crate::job::report::finding::tolerance;
use crate::job::validation_property::{DIFFERS, Item, Quantity, items, statements};
use crate::model::{Annotation, ChangeSet, Element, Mass, Model, Origin, Subject};

/// What became of a statement about a changed shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Restated {
    /// Record of the property.
    pub entity: String,
    /// The same, to be found again.
    #[serde(skip)]
    pub origin: Option<Origin>,
    /// Its description.
    pub name: String,
    /// What was done.
    pub outcome: Outcome,
    /// Numbers before: a value, or the coordinates of a point.
    pub before: Vec<f64>,
    /// Numbers that were measured anew.
    pub after: Vec<f64>,
    /// Why it went or was kept, or what of it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// What was done with a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Measured again, and written.
    Recomputed,
    /// Taken away, since nobody can say what it would be.
    Removed,
    /// Left as it was, and stale: it was not understood, or other records need it.
    Kept,
}

impl Restated {
    /// A property that was to go, and that other records need.
    pub fn was_kept(&mut self) {
        self.outcome = Outcome::Kept;
        self.reason = Some("other records refer to it".to_owned());
    }
}

/// Faces that a job changed, by their records.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Changed {
    /// Faces with a new surface or border.
    pub faces: BTreeSet<Origin>,
    /// Bodies with such a face.
    pub bodies: BTreeSet<Origin>,
}

impl Changed {
    /// Adds changed faces of a model.
    pub fn add(&mut self, model: &Model, faces: &BTreeSet<FaceId>) {
        self.faces.extend(faces.iter().map(|&face| model.origins.faces[face]));
        self.bodies.extend(faces.iter().map(|&face| model.origins.bodies[model.body_of(face)]));
    }

    fn concern(&self, model: &Model, subject: &Subject) -> bool {
        let of_body = |body: BodyId| self.bodies.contains(&model.origins.bodies[body]);
        let of_face = |face: FaceId| self.faces.contains(&model.origins.faces[face]);
        subject.bodies.iter().any(|(body, _)| of_body(*body))
            || subject.faces.iter().any(|&face| of_face(face))
    }
}

/// New statements for a changed part: the change that states them, and what is to be told.
#[must_use]
pub fn restated(before: &Model, after: &Model, changed: &Changed) -> (ChangeSet, Vec<Restated>) {
    let old: BTreeMap<Origin, &Annotation> = statements(before).map(|a| (a.origin, a)).collect();
    let mut known: BTreeMap<&[Element], Known> = BTreeMap::new();
    let mut changes = ChangeSet::default();
    let mut told = Vec::new();
    for annotation in statements(after).filter(|annotation| !items(annotation).is_empty()) {
        let was = old.get(&annotation.origin).copied().unwrap_or(annotation);
        let on = known
            .entry(&annotation.on)
            .or_insert_with(|| Known::of((before, was), (after, annotation), changed));
        if matches!(on, Known::Unchanged) {
            continue;
        }
        let numbers = numbers(annotation, was, on).and_then(|(numbers, left)| {
            let fits = |(origin, values): &(Origin, Vec<f64>)| {
                changes.stated.get(origin).is_none_or(|other| other == values)
            };
            let shared = || Unknown::kept("another property gives its value");
            if numbers.iter().all(fits) { Ok((numbers, left)) } else { Err(shared()) }
        });
        let (outcome, numbers, reason) = match numbers {
            Ok((numbers, left)) => (Outcome::Recomputed, numbers, left),
            Err(Unknown { outcome, reason }) => (outcome, Vec::new(), Some(reason)),
        };
        told.push(Restated {
            entity: annotation.origin.to_string(),
            origin: Some(annotation.origin),
            name: annotation.name.clone(),
            outcome,
            before: annotation.values.iter().map(|measure| measure.value).collect(),
            after: numbers.iter().flat_map(|(_, values)| values).copied().collect(),
            reason,
        });
        changes.stated.extend(numbers);
        if outcome == Outcome::Removed {
            changes.unstated.insert(annotation.origin);
        }
    }
    (changes, told)
}

/// What is known of the elements that a statement is on.
enum Known {
    /// They did not change.
    Unchanged,
    /// They may have changed, and nobody can say what they measure.
    Nothing(String),
    /// They did change: metres of their unit, and masses before and after.
    Masses(f64, [Mass; 2]),
}

impl Known {
    fn of(before: (&Model, &Annotation), after: (&Model, &Annotation), changed: &Changed) -> Self {
        let Some(subject) = Subject::of(after.0, &after.1.on) else {
            return if changed.faces.is_empty() { Self::Unchanged } else { Self::Nothing(String::new()) };
        };
        if !changed.concern(after.0, &subject) {
            return Self::Unchanged;
        }
        let old = Subject::of(before.0, &before.1.on);
        let masses = old.ok_or_else(|| "what it spoke of is not known".to_owned()).and_then(|old| {
            let of = |model: &Model, subject: &Subject| {
                let quadrature = |body| Quadrature::exact(tolerance(model, body));
                subject.mass(model, quadrature).map_err(|error| error.to_string())
            };
            Ok([of(before.0, &old)?, of(after.0, &subject)?])
        });
        masses.map_or_else(Self::Nothing, |masses| Self::Masses(subject.unit.metres, masses))
    }
}

/// Why a statement cannot be measured.
struct Unknown {
    /// Removed when it is understood so far that it is known not to hold any more, else kept.
    outcome: Outcome,
    reason: String,
}

impl Unknown {
    fn gone(reason: impl Into<String>) -> Self {
        Self { outcome: Outcome::Removed, reason: reason.into() }
    }

    fn kept(reason: impl Into<String>) -> Self {
        Self { outcome: Outcome::Kept, reason: reason.into() }
    }
}

/// New numbers by their records, and what of the statement could not be measured.
type Numbers = (Vec<(Origin, Vec<f64>)>, Option<String>);

fn numbers(annotation: &Annotation, was: &Annotation, on: &Known) -> Result<Numbers, Unknown> {
    let (others, measured): (Vec<Item>, Vec<Item>) =
        items(annotation).into_iter().partition(|item| item.quantity == Quantity::Other);
    let (metres, [before, after]) = match on {
        Known::Masses(metres, masses) => (*metres, masses),
        Known::Nothing(reason) if reason.is_empty() => {
            return Err(Unknown::kept("what it speaks of is nothing that the file holds in full"));
        }
        Known::Nothing(reason) => return Err(Unknown::gone(reason)),
        Known::Unchanged => return Ok((Vec::new(), None)),
    };
    if measured.is_empty() {
        return Err(Unknown::gone("what it gives is not measured here"));
    }
    let lacks = || Unknown::gone("not all that it speaks of has what it gives");
    let mut numbers = Vec::with_capacity(measured.len());
    for item in measured {
        let old = items(was).into_iter().find(|old| old.origin == item.origin);
        let off = old.unwrap_or_else(|| item.clone()).difference(before, metres).ok_or_else(lacks)?;
        if off > DIFFERS {
            return Err(Unknown::kept(format!(
                "before the change its '{}' differed from the faces by {off:.1e} of the whole",
                item.name
            )));
        }
        numbers.push((item.origin, item.expected(after, metres).ok_or_else(lacks)?));
    }
    let names: Vec<String> = others.iter().map(|item| format!("'{}'", item.name)).collect();
    let left = (!names.is_empty()).then(|| format!("{} is not measured here and kept", names.join(", ")));
    Ok((numbers, left))
}
