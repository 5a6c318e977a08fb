//! Fact: the volume, area and centroid that a file states of a body are those of its faces.
//!
//! Only of statements about a body, or about a product that has shapes of its own and no components. What other
//! programs measured with is not known: a difference counts when no rounding or gap explains it.

use super::finding::OwnFinding;
use crate::brep::mass_properties::{MassProperties, Quadrature, middle, of_body};
use crate::brep::{BodyId, BodyKind};
use crate::diagnostic::Severity;
use crate::document::Document;
use crate::math::{Point3, Vector3};
use crate::model::{Annotation, AnnotationKind, Element, Measure, Model};

/// Stable name of the fact.
pub const STALE: &str = "stale-validation-property";

/// Relative difference of volume or area that counts, and of the centroid against the root of the area. Programs
/// that measure by triangles state figures that are off by some ten-thousandths.
const DIFFERS: f64 = 1e-3;

/// Statements that differ from what the faces give, in file order.
#[must_use]
pub fn stale_properties(
    document: &Document,
    model: &Model,
    tolerance: &dyn Fn(BodyId) -> f64,
) -> Vec<OwnFinding> {
    let mut findings = Vec::new();
    let mut known: Vec<(Vec<BodyId>, Option<Whole>)> = Vec::new();
    for annotation in &model.annotations {
        if annotation.kind != AnnotationKind::ValidationProperty || !states_mass(annotation) {
            continue;
        }
        let bodies = bodies_of(model, annotation);
        if bodies.is_empty() {
            continue;
        }
        let at = known.iter().position(|(of, _)| *of == bodies).unwrap_or_else(|| {
            known.push((bodies.clone(), Whole::of(model, &bodies, tolerance)));
            known.len() - 1
        });
        let Some(whole) = &known[at].1 else { continue };
        if let Some(size) = whole.differs(annotation) {
            findings.push(OwnFinding {
                code: STALE.to_owned(),
                severity: Severity::Error.as_str().to_owned(),
                fails_a_change: false,
                entity: annotation.origin.to_string(),
                line: document.line_of(annotation.origin),
                place: whole.centroid.coords.into(),
                size: Some(size),
            });
        }
    }
    findings
}

/// What a measure is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Volume,
    Area,
}

/// By the names that the recommended practice for geometric validation properties gives.
fn quantity(measure: &Measure) -> Option<Quantity> {
    match measure.name.trim().to_ascii_lowercase().as_str() {
        "volume" | "volume measure" => Some(Quantity::Volume),
        "surface area" | "surface area measure" | "wetted area measure" => Some(Quantity::Area),
        _ => None,
    }
}

/// The coordinates of a stated centroid.
fn centre(annotation: &Annotation) -> Option<Point3<f64>> {
    let names = |measure: &Measure| {
        matches!(measure.name.trim().to_ascii_lowercase().as_str(), "centre point" | "centroid")
    };
    match annotation.values.as_slice() {
        [x, y, z] if names(x) => Some(Point3::new(x.value, y.value, z.value)),
        _ => None,
    }
}

fn states_mass(annotation: &Annotation) -> bool {
    centre(annotation).is_some() || annotation.values.iter().any(|measure| quantity(measure).is_some())
}

/// Bodies that a statement is about; none where components would have to be counted too.
fn bodies_of(model: &Model, annotation: &Annotation) -> Vec<BodyId> {
    match annotation.on.as_slice() {
        [Element::Product(at)] => {
            let product = &model.products[*at];
            let has_components = model.occurrences.iter().any(|occurrence| occurrence.parent == *at);
            let stays = product.shapes.iter().all(|shape| shape.transform.is_identity());
            if has_components || !stays || !product.external.is_empty() {
                return Vec::new();
            }
            product.shapes.iter().map(|shape| shape.body).collect()
        }
        elements => {
            let body = |element: &Element| match element {
                Element::Body(body) => Some(*body),
                _ => None,
            };
            elements.iter().map(body).collect::<Option<Vec<_>>>().unwrap_or_default()
        }
    }
}

/// What some solids measure together, in the file's unit.
struct Whole {
    volume: f64,
    area: f64,
    centroid: Point3<f64>,
    metres: f64,
}

impl Whole {
    /// `None` where not all are solids that can be measured.
    fn of(model: &Model, bodies: &[BodyId], tolerance: &dyn Fn(BodyId) -> f64) -> Option<Self> {
        let reference = middle(&model.brep, bodies[0]);
        let (mut volume, mut area, mut moment) = (0.0, 0.0, Vector3::zeros());
        for &body in bodies {
            if model.brep.bodies[body].kind != BodyKind::Solid {
                return None;
            }
            let found: MassProperties =
                of_body(&model.brep, body, &Quadrature::good(tolerance(body))).ok()?;
            volume += found.volume();
            area += found.area();
            moment += (found.centroid() - reference) * found.volume();
        }
        let metres = model.contexts[model.body_context[bodies[0]]].length.metres;
        let centroid = if volume == 0.0 { reference } else { reference + moment / volume };
        Some(Self { volume, area, centroid, metres })
    }

    /// The greatest difference of a statement in parts of the whole, where it counts.
    fn differs(&self, annotation: &Annotation) -> Option<f64> {
        let mut worst = 0.0f64;
        for measure in &annotation.values {
            let (own, power) = match quantity(measure) {
                Some(Quantity::Volume) => (self.volume, 3),
                Some(Quantity::Area) => (self.area, 2),
                None => continue,
            };
            let unit = self.metres.powi(power);
            let stated = measure.value * measure.metres.unwrap_or(unit) / unit;
            worst = worst.max((stated - own).abs() / own.abs().max(f64::MIN_POSITIVE));
        }
        if let Some(stated) = centre(annotation) {
            worst = worst.max((stated - self.centroid).norm() / self.area.sqrt().max(f64::MIN_POSITIVE));
        }
        (worst > DIFFERS).then_some(worst)
    }
}
