//! Which faces are scaled, and whether they may be without tearing others.

use std::collections::BTreeSet;

use crate::brep::{FaceId, ShellId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::model::Model;
use crate::ops::OperationError;
pub(super) use crate::ops::net::layout::face_name;

/// Faces to scale.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// All faces of all bodies, and curves that belong to none.
    Part,
    /// Some faces.
    Faces(Vec<FaceId>),
}

impl Scope {
    /// The faces, ascending.
    pub(super) fn faces(&self, model: &Model) -> BTreeSet<FaceId> {
        match self {
            Self::Part => model.brep.faces.ids().collect(),
            Self::Faces(faces) => faces.iter().copied().collect(),
        }
    }
}

/// Refuses a scope of which a face shares an edge with a face outside it.
pub(super) fn refuse_torn_neighbours(model: &Model, scope: &BTreeSet<FaceId>) -> Result<(), OperationError> {
    let uses = model.brep.faces_of_edges();
    let (mut faces, mut neighbours) = (BTreeSet::new(), BTreeSet::new());
    for (_, users) in uses.iter() {
        let outside = users.iter().filter(|f| !scope.contains(f)).copied();
        let inside: Vec<FaceId> = users.iter().filter(|f| scope.contains(f)).copied().collect();
        if !inside.is_empty() {
            let before = neighbours.len();
            neighbours.extend(outside);
            if neighbours.len() > before {
                faces.extend(inside);
            }
        }
    }
    if neighbours.is_empty() {
        return Ok(());
    }
    let names = |set: BTreeSet<FaceId>| set.into_iter().map(|f| face_name(model, f)).collect();
    Err(OperationError::NeighboursOutside { faces: names(faces), neighbours: names(neighbours) })
}

/// Faces of a shell that a note names; the rest is counted.
const NAMED: usize = 8;

/// A warning when scaled bodies are components of an assembly: the definition is scaled once, and the
/// placements of its occurrences stay.
pub(super) fn placed(model: &Model, scope: &BTreeSet<FaceId>) -> Option<Diagnostic> {
    let products: BTreeSet<usize> =
        scope.iter().filter_map(|&face| model.bodies[model.body_of(face)].product).collect();
    let placed = model.occurrences.iter().filter(|occurrence| products.contains(&occurrence.child)).count();
    (placed > 0).then(|| Diagnostic {
        code: "scale.occurrences-stay",
        severity: Severity::Warning,
        entity: None,
        span: None,
        message: format!(
            "{placed} occurrences in assemblies show the scaled definitions at the places and in the \
             orientations that they had: distances between components are not scaled"
        ),
    })
}

/// One note for each shell of which some faces are scaled and some stay.
pub(super) fn staying(model: &Model, scope: &BTreeSet<FaceId>) -> Vec<Diagnostic> {
    let shells: BTreeSet<ShellId> = scope.iter().map(|&f| model.brep.faces[f].shell).collect();
    let mut notes = Vec::new();
    for shell in shells {
        let faces = &model.brep.shells[shell].faces;
        let stay: Vec<String> =
            faces.iter().filter(|f| !scope.contains(f)).map(|&f| face_name(model, f)).collect();
        if stay.is_empty() {
            continue;
        }
        let more =
            if stay.len() > NAMED { format!(" and {} more", stay.len() - NAMED) } else { String::new() };
        let named = stay[..stay.len().min(NAMED)].join(", ");
        notes.push(Diagnostic {
            code: "scale.faces-stayed",
            severity: Severity::Note,
            entity: Some(model.origins.shells[shell].to_string()),
            span: None,
            message: format!("{} of {} faces stay as they are: {named}{more}", stay.len(), faces.len()),
        });
    }
    notes
}
