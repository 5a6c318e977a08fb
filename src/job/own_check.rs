//! Our own verdict on a part: the facts of [`brep::check`](crate::brep::check), by entity and line.
//!
//! A finding says what the file says; it is compared, never repaired.

use std::collections::{BTreeMap, BTreeSet};

use crate::brep::check::{self, Finding};
use crate::brep::{Arena, FaceId, VertexId};
use crate::document::Document;
pub use crate::job::report::finding::OwnFinding;
use crate::job::report::finding::tolerance;
use crate::job::validation_property::stale_properties;
use crate::model::{ChangeSet, Model, Origin};

/// Factor within which two measurements of one gap agree: samples of an edge fall on other places once its
/// curve or surface is written with other knots.
const SAME_SIZE: f64 = 1.25;

/// Checks a model against the uncertainty of its contexts, times `growth`: an affine image of a part
/// stretches its gaps with everything else.
#[must_use]
pub fn own_findings(document: &Document, model: &Model, growth: f64) -> Vec<OwnFinding> {
    let tolerance = |body| growth * tolerance(model, body);
    let findings = check::check(&model.brep, &tolerance);
    let mut all: Vec<OwnFinding> =
        findings.iter().map(|finding| describe(document, model, finding)).collect();
    all.extend(stale_properties(document, model, &tolerance));
    all
}

/// As [`own_findings`], of some faces and their shells: for what an operation has changed.
#[must_use]
pub fn findings_of_faces(
    document: &Document,
    model: &Model,
    faces: &BTreeSet<Origin>,
    growth: f64,
) -> Vec<OwnFinding> {
    let chosen = model.origins.faces.iter().filter(|(_, origin)| faces.contains(origin));
    let chosen: BTreeSet<FaceId> = chosen.map(|(face, _)| face).collect();
    let findings = check::check_faces(&model.brep, &chosen, &|body| growth * tolerance(model, body));
    findings.iter().map(|finding| describe(document, model, finding)).collect()
}

/// Faces whose geometry or border a change set touches.
#[must_use]
pub fn changed_faces(model: &Model, changes: &ChangeSet) -> BTreeSet<FaceId> {
    let brep = &model.brep;
    let faces_of_edges = brep.faces_of_edges();
    let mut uses: Arena<VertexId, Vec<FaceId>> = brep.vertices.iter().map(|_| Vec::new()).collect();
    if !changes.points.is_empty() {
        for (edge, of) in brep.edges.iter() {
            for vertex in [of.start, of.end] {
                uses[vertex].extend(&faces_of_edges[edge]);
            }
        }
    }
    let mut faces: BTreeSet<FaceId> = changes.surfaces.keys().copied().collect();
    faces.extend(changes.new_bounds.keys().chain(&changes.removed_faces));
    faces.extend(changes.new_faces.iter().map(|face| face.beside));
    faces.extend(changes.removed_bounds.iter().map(|&bound| brep.loops[bound].face));
    faces.extend(changes.curves.keys().flat_map(|&edge| &faces_of_edges[edge]));
    faces.extend(changes.pcurves.keys().map(|&coedge| brep.loops[brep.coedges[coedge].in_loop].face));
    faces.extend(changes.points.keys().flat_map(|&vertex| &uses[vertex]));
    faces
}

/// The records of some faces and of those that share an edge with them.
#[must_use]
pub fn with_neighbours(model: &Model, mut faces: BTreeSet<FaceId>) -> BTreeSet<Origin> {
    let brep = &model.brep;
    let faces_of_edges = brep.faces_of_edges();
    let neighbours: Vec<FaceId> = faces
        .iter()
        .flat_map(|&face| brep.coedges_of(face))
        .flat_map(|coedge| faces_of_edges[brep.coedges[coedge].edge].iter().copied())
        .collect();
    faces.extend(neighbours);
    faces.into_iter().map(|face| model.origins.faces[face]).collect()
}

/// Findings of a result that its input does not have: another fact, the same on another record, or one that
/// grew by more than `growth`, by which the operation stretched the part.
pub fn new_findings<'a>(
    before: &'a [OwnFinding],
    after: &'a [OwnFinding],
    growth: f64,
) -> impl Iterator<Item = &'a OwnFinding> {
    let mut known: BTreeMap<(&str, &str), Vec<f64>> = BTreeMap::new();
    for finding in before {
        let sizes = known.entry((&finding.code, &finding.entity)).or_default();
        sizes.push(finding.size.unwrap_or(0.0));
    }
    known.values_mut().for_each(|sizes| sizes.sort_by(f64::total_cmp));
    after.iter().filter(move |finding| {
        let size = finding.size.unwrap_or(0.0);
        let sizes = known.entry((&finding.code, &finding.entity)).or_default();
        let excused = sizes.iter().position(|&was| size <= was * growth * SAME_SIZE);
        if let Some(at) = excused {
            sizes.remove(at);
        }
        excused.is_none()
    })
}

fn describe(document: &Document, model: &Model, finding: &Finding) -> OwnFinding {
    let origin = origin(model, finding);
    let place = finding.place();
    OwnFinding {
        code: finding.code().to_owned(),
        severity: finding.severity().as_str().to_owned(),
        fails_a_change: finding.fails_a_change(),
        entity: origin.to_string(),
        line: document.line_of(origin),
        place: [place.x, place.y, place.z],
        size: finding.size(),
    }
}

fn origin(model: &Model, finding: &Finding) -> Origin {
    let origins = &model.origins;
    match finding {
        Finding::OpenLoop(f) => origins.loops[f.bound],
        Finding::EdgeOffSurface(f) => origins.coedges[f.coedge],
        Finding::VertexOffEdge(f) => origins.edges[f.edge],
        Finding::PcurveOffEdge(f) => origins.pcurves[f.coedge].unwrap_or(origins.coedges[f.coedge]),
        Finding::ReversedLoop(f) => origins.loops[f.bound],
        Finding::FreeEdge(f) => origins.edges[f.edge],
        Finding::OneWayEdge(f) => origins.edges[f.edge],
        Finding::CrowdedEdge(f) => origins.edges[f.edge],
        Finding::OpenShell(f) => origins.shells[f.shell],
        Finding::TurnedFace(f) => origins.faces[f.face],
        Finding::Gap(f) => origins.coedges[f.coedge],
        Finding::DegenerateEdge(f) => origins.edges[f.edge],
        Finding::SelfCrossingLoop(f) => origins.loops[f.bound],
        Finding::OverlappingBounds(f) => origins.loops[f.bound],
        Finding::SliverFace(f) => origins.faces[f.face],
        Finding::MissingSeam(f) => origins.faces[f.face],
        Finding::InconsistentSense(f) => origins.faces[f.face],
        Finding::SolidInsideOut(f) => origins.shells[f.shell],
    }
}
