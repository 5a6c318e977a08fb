//! What a file draws and says of faces that a job has changed: kept as it was, and named.
//!
//! Whether a dimension or a tolerance still holds is for people to say. Validation properties are
//! [`validation_property`](crate::job::validation_property)'s concern.

use std::collections::{BTreeMap, BTreeSet};

use crate::brep::EdgeId;
use crate::document::Document;
use crate::job::report::DiagnosticReport;
use crate::job::restate::Changed;
use crate::model::{Annotation, AnnotationKind, Element, Model};

/// Annotations of one kind that are named singly; the rest is counted.
const NAMED: usize = 20;

/// A warning for each annotation on a changed face or on an edge of one, in file order.
#[must_use]
pub fn flagged(document: &Document, model: &Model, changed: &Changed) -> Vec<DiagnosticReport> {
    let edges: BTreeSet<EdgeId> = model
        .brep
        .faces
        .ids()
        .filter(|&face| changed.faces.contains(&model.origins.faces[face]))
        .flat_map(|face| model.brep.coedges_of(face))
        .map(|coedge| model.brep.coedges[coedge].edge)
        .collect();
    let on_change = |element: &Element| match element {
        Element::Face(face) => changed.faces.contains(&model.origins.faces[*face]),
        Element::Edge(edge) => edges.contains(edge),
        Element::Body(_) | Element::Product(_) | Element::Occurrence(_) => false,
    };
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    let mut told = Vec::new();
    for annotation in model.annotations.iter().filter(|a| a.on.iter().any(on_change)) {
        let Some((code, message)) = text(annotation) else { continue };
        let count = counts.entry(code).or_insert(0);
        *count += 1;
        if *count <= NAMED {
            let entity = Some(annotation.origin.to_string());
            told.push(warning(code, entity, document.line_of(annotation.origin), message));
        }
    }
    for (code, count) in counts.into_iter().filter(|(_, count)| *count > NAMED) {
        let message = format!("{} more that are not named here", count - NAMED);
        told.push(warning(code, None, None, message));
    }
    told
}

fn text(annotation: &Annotation) -> Option<(&'static str, String)> {
    let Annotation { kind, entity, name, .. } = annotation;
    let named = if name.is_empty() { entity.clone() } else { format!("{entity} '{name}'") };
    match kind {
        AnnotationKind::ValidationProperty => None,
        AnnotationKind::Tessellation => {
            Some(("tessellation.stale", format!("{named} shows a changed face as it was; it is kept")))
        }
        AnnotationKind::Dimension
        | AnnotationKind::Tolerance
        | AnnotationKind::Datum
        | AnnotationKind::Presentation => {
            Some(("pmi.on-changed-face", format!("{named} speaks of a changed face; it is kept")))
        }
    }
}

fn warning(
    code: &'static str,
    entity: Option<String>,
    line: Option<usize>,
    message: String,
) -> DiagnosticReport {
    DiagnosticReport { code: code.to_owned(), severity: "warning".to_owned(), entity, line, message }
}
