//! Two parts compared: the tolerance that their files ask for, the page and the words that tell of what differs.

use std::collections::BTreeMap;

use crate::diff::{self, Change, Deviations, Difference, FaceChange, Named, Side};
use crate::job::run::program;
use crate::math::BoundingBox;
use crate::mesh::Mesh;
use crate::model::Model;
use crate::units::{Length, LengthUnit};
use crate::view::{Overlay, Page, page_with};

/// Part of the size of a part within which two kernels write one shape: above the rounding of single-precision
/// viewers and far below what is made.
const OF_SIZE: f64 = 1e-6;

/// Two models in the unit of the first, compared.
#[derive(Debug)]
pub struct Compared<'a> {
    before: Side<'a>,
    after: Side<'a>,
    /// What differs.
    pub difference: Difference,
}

impl<'a> Compared<'a> {
    /// Compares two models. Without a tolerance it is the greatest of the files' own uncertainties and a millionth of the
    /// first part's size.
    #[must_use]
    pub fn new(before: &'a Model, after: &'a Model, tolerance: Option<Length>) -> Self {
        let unit =
            before.contexts.first().map_or_else(LengthUnit::millimetre, |context| context.length.clone());
        let (before, after) = (Side::new(before, &unit), Side::new(after, &unit));
        let tolerance =
            tolerance.map_or_else(|| default_tolerance(&before, &after), |length| length.in_unit(&unit));
        let difference = diff::compare(&before, &after, tolerance);
        Self { before, after, difference }
    }

    /// Triangles of both parts, in the unit of the first.
    #[must_use]
    pub fn meshes(&self) -> (Mesh, Mesh) {
        (self.before.whole_mesh(), self.after.whole_mesh())
    }

    /// The distance from the first part at each vertex of the second one's triangles; 0 on faces that are only there.
    #[must_use]
    pub fn distances(&self) -> Vec<f64> {
        let deviations = Deviations::new(&self.before, &self.after, &self.difference);
        self.after.over_whole_mesh(&|face, points| {
            deviations.of(face, points).unwrap_or_else(|| vec![0.0; points.len()])
        })
    }

    /// A page that shows the second part with the distances from the first as colours.
    #[must_use]
    pub fn page(&self, title: &str) -> Page {
        let deviations = Deviations::new(&self.before, &self.after, &self.difference);
        let distances = self.difference.changes.iter().filter_map(|change| change.sampled);
        let most = distances.map(|sampled| sampled.distance).fold(self.difference.tolerance, f64::max);
        let mut notes: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for change in &self.difference.changes {
            if let Some(after) = &change.after {
                notes.entry(after.id.clone()).or_default().push(words(change, &self.difference.unit));
            }
        }
        let overlay = Overlay {
            label: format!(
                "Distance from the first part in {}; green: only in the second",
                self.difference.unit
            ),
            most,
            values: &|face, points| deviations.of(face, points),
            notes,
            lines: lines(&self.difference),
        };
        page_with(self.after.model, title, &overlay)
    }
}

fn default_tolerance(before: &Side<'_>, after: &Side<'_>) -> f64 {
    let said = |side: &Side<'_>| {
        let contexts = side.model.contexts.iter();
        let own = contexts
            .filter_map(|context| Some(context.uncertainty?.0 * context.length.metres / side.unit.metres));
        own.fold(0.0, f64::max)
    };
    let mut bounds = BoundingBox::EMPTY;
    before.faces.iter().for_each(|face| bounds.merge(&face.bounds));
    said(before).max(said(after)).max(OF_SIZE * bounds.diagonal())
}

/// What differs, line by line; a line on the faces first.
#[must_use]
pub fn lines(difference: &Difference) -> Vec<String> {
    let faces = &difference.faces;
    let (unit, tolerance) = (&difference.unit, difference.tolerance);
    let mut lines = vec![format!(
        "faces: {} before, {} after: {} identical, {} the same within {tolerance:.3e} {unit}, {} moved, {} changed, {} added, {} removed",
        faces.before,
        faces.after,
        faces.identical,
        faces.same,
        faces.moved,
        faces.changed,
        faces.added,
        faces.removed
    )];
    lines.extend(difference.structure.iter().map(|change| format!("{}: {}", change.what, change.message)));
    lines.extend(difference.changes.iter().map(|change| words(change, unit)));
    lines.extend(difference.curves.iter().map(|change| format!("curve {}", words(change, unit))));
    lines.extend(difference.notes.iter().map(|note| format!("note: {note}")));
    lines
}

fn named(named: &Named) -> String {
    let name = if named.name.is_empty() { String::new() } else { format!(" \"{}\"", named.name) };
    let product = if named.product.is_empty() { String::new() } else { format!(" of {}", named.product) };
    format!("{}{name} {}{product}", named.id, named.kind)
}

fn point([x, y, z]: [f64; 3]) -> String {
    format!("({x:.6}, {y:.6}, {z:.6})")
}

/// One change in words.
fn words(change: &FaceChange, unit: &str) -> String {
    let mut text = change.change.as_str().to_owned();
    match (&change.before, &change.after) {
        (Some(before), Some(after)) if before.id != after.id => {
            text += &format!(" {} to {}", named(before), named(after))
        }
        (_, Some(either)) | (Some(either), None) => text += &format!(" {}", named(either)),
        (None, None) => {}
    }
    if let Some(motion) = &change.motion {
        text += &format!(": by {} {unit}", point(motion.shift));
        if motion.degrees > 1e-6 {
            text += &format!(" and {:.6} degrees", motion.degrees);
        }
    } else if let Some(sampled) = &change.sampled {
        text += &format!(": {:.6e} {unit} found at {}", sampled.distance, point(sampled.at));
        if let Some(certified) = change.certified {
            text += &format!(", at most {certified:.6e} {unit} from the first one's surface by proof");
        }
    } else if change.change == Change::Changed {
        text += ": its distance is not known";
    }
    text
}

/// The difference as JSON, with the program's name and a line end.
#[must_use]
pub fn json(difference: &Difference, before: &str, after: &str) -> String {
    let mut value = serde_json::to_value(difference).expect("a difference is a tree of texts and numbers");
    if let Some(table) = value.as_object_mut() {
        table.insert("program".to_owned(), program().into());
        table.insert("before".to_owned(), before.into());
        table.insert("after".to_owned(), after.into());
    }
    format!("{value:#}\n")
}
