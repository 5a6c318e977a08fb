//! What a file states of the volume, area and centroid of its parts, and whether it is so.
//!
//! What is to be stated once the shape has changed is [`restate`](crate::job::restate)'s concern.
//!
//! Only statements about bodies, products and uses of products that the file holds in full. What other programs measured
//! with is not known: a difference counts when no rounding or gap explains it.

use std::collections::BTreeMap;

use crate::brep::BodyId;
use crate::brep::mass_properties::Quadrature;
use crate::diagnostic::Severity;
use crate::document::Document;
use crate::job::report::finding::OwnFinding;
use crate::math::Point3;
use crate::model::{Annotation, AnnotationKind, Element, Mass, Measure, Model, Origin, Subject};

/// Stable name of the fact that a statement does not hold.
pub const STALE: &str = "stale-validation-property";

/// Relative difference of volume or area that counts, and of the centroid against the root of the area. Programs
/// that measure by triangles state figures that are off by some ten-thousandths.
pub(super) const DIFFERS: f64 = 1e-3;

/// Difference up to which a quick measure tells that a statement holds: well below what counts, and well above what such a
/// measure is off by.
const PLAINLY: f64 = 2e-4;

/// What statements speak of, with its mass.
struct Measured {
    subject: Subject,
    mass: Mass,
    /// Whether the mass is as good as any judgement needs.
    well: bool,
}

impl Measured {
    /// How far off the worst of some items is.
    fn worst(&self, items: &[Item]) -> f64 {
        let off = items.iter().filter_map(|item| item.difference(&self.mass, self.subject.unit.metres));
        off.fold(0.0, f64::max)
    }
}

/// Statements that differ from what the faces give, in file order. The centroid of an assembly is not judged: it may be
/// that of the mass, and materials are not known here.
#[must_use]
pub fn stale_properties(
    document: &Document,
    model: &Model,
    tolerance: &dyn Fn(BodyId) -> f64,
) -> Vec<OwnFinding> {
    let mut findings = Vec::new();
    let mut known: BTreeMap<&[Element], Option<Measured>> = BTreeMap::new();
    for annotation in statements(model) {
        let mut items = items(annotation);
        items.retain(|item| item.quantity != Quantity::Other);
        if items.is_empty() {
            continue;
        }
        let found = known.entry(&annotation.on).or_insert_with(|| {
            let subject = Subject::of(model, &annotation.on).filter(|subject| !subject.bodies.is_empty())?;
            let mass = subject.mass(model, |body| Quadrature::plain(tolerance(body))).ok()?;
            Some(Measured { subject, mass, well: false })
        });
        let Some(measured) = found else { continue };
        if measured.subject.has_components {
            items.retain(|item| item.quantity != Quantity::Centroid);
        }
        let mut worst = measured.worst(&items);
        if worst > PLAINLY && !measured.well {
            let Ok(mass) = measured.subject.mass(model, |body| Quadrature::good(tolerance(body))) else {
                continue;
            };
            (measured.mass, measured.well) = (mass, true);
            worst = measured.worst(&items);
        }
        let mass = &measured.mass;
        if worst > DIFFERS {
            findings.push(OwnFinding {
                code: STALE.to_owned(),
                severity: Severity::Error.as_str().to_owned(),
                fails_a_change: false,
                entity: annotation.origin.to_string(),
                line: document.line_of(annotation.origin),
                place: mass.centroid.unwrap_or_else(Point3::origin).coords.into(),
                size: Some(worst),
            });
        }
    }
    findings
}

pub(super) fn statements(model: &Model) -> impl Iterator<Item = &Annotation> {
    model.annotations.iter().filter(|annotation| annotation.kind == AnnotationKind::ValidationProperty)
}

/// What a statement gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Volume,
    Area,
    Centroid,
    /// Something of the shape that is not measured here.
    Other,
}

/// By the names that the recommended practice for geometric validation properties gives; `None` for what is no
/// statement about a shape.
fn quantity(name: &str) -> Option<Quantity> {
    let name = name.trim().to_ascii_lowercase();
    let other = ["bounding box", "sampling point", "curve length", "curve centre", "independent"];
    match name.as_str() {
        "volume" | "volume measure" => Some(Quantity::Volume),
        "surface area" | "surface area measure" | "wetted area measure" | "affected area" => {
            Some(Quantity::Area)
        }
        "centre point" | "centroid" => Some(Quantity::Centroid),
        _ => other.iter().any(|word| name.contains(word)).then_some(Quantity::Other),
    }
}

/// One number or point that a statement gives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Item {
    pub quantity: Quantity,
    pub name: String,
    pub origin: Origin,
    values: Vec<f64>,
    /// How many square or cubic metres one is, where the file says so.
    metres: Option<f64>,
}

/// What a statement gives of a shape, item by item.
pub(super) fn items(annotation: &Annotation) -> Vec<Item> {
    let of_one = annotation.values.chunk_by(|a, b| a.origin == b.origin);
    let item = |measures: &[Measure]| {
        let first = measures.first()?;
        Some(Item {
            quantity: quantity(&first.name)?,
            name: first.name.clone(),
            origin: first.origin,
            values: measures.iter().map(|measure| measure.value).collect(),
            metres: first.metres,
        })
    };
    of_one.filter_map(item).collect()
}

impl Item {
    /// The numbers that it must give of a mass whose unit has so many metres; `None` where the mass has none.
    pub fn expected(&self, mass: &Mass, metres: f64) -> Option<Vec<f64>> {
        let scaled = |own: f64, power: i32| {
            let unit = metres.powi(power);
            vec![own * self.metres.map_or(1.0, |stated| unit / stated)]
        };
        match self.quantity {
            Quantity::Volume => Some(scaled(mass.volume?, 3)),
            Quantity::Area => Some(scaled(mass.area, 2)),
            Quantity::Centroid => Some(<[f64; 3]>::from(mass.centroid?.coords).to_vec()),
            Quantity::Other => None,
        }
    }

    /// How far it is from that, in parts of the whole.
    pub fn difference(&self, mass: &Mass, metres: f64) -> Option<f64> {
        let expected = self.expected(mass, metres)?;
        if expected.len() != self.values.len() {
            return None;
        }
        let squares = expected.iter().zip(&self.values).map(|(own, stated)| (own - stated).powi(2));
        let whole = match self.quantity {
            Quantity::Centroid => mass.area.sqrt(),
            _ => expected.iter().fold(0.0, |most, own| f64::max(most, own.abs())),
        };
        Some(squares.sum::<f64>().sqrt() / whole.max(f64::MIN_POSITIVE))
    }
}
