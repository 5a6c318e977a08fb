//! Our own verdict on a part: the facts of [`brep::check`](crate::brep::check), by entity and line.
//!
//! A finding says what the file says; it is compared, never repaired.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::brep::check::{self, Finding};
use crate::diagnostic::Severity;
use crate::document::Document;
use crate::model::{Model, Origin};

/// Distance below which points count as one in a file that does not say: a micrometre, finer than any
/// exporter's habit and coarser than the digits that they write.
const UNCERTAINTY_METRES: f64 = 1e-6;

/// Factor within which two measurements of one gap agree: samples of an edge fall on other places once its
/// curve or surface is written with other knots.
const SAME_SIZE: f64 = 1.25;

/// A fact that a part violates.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct OwnFinding {
    /// Stable name of the fact: `edge-off-surface`.
    pub code: String,
    /// `error`, or `warning` for what a sound part may have.
    pub severity: String,
    /// Entity concerned, as the file names it.
    pub entity: String,
    /// Line of its record, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Where it is worst, in file units.
    pub place: [f64; 3],
    /// By how much, in file units, where the fact is one of distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
}

impl OwnFinding {
    /// Whether programs stumble over it.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error.as_str()
    }
}

impl std::fmt::Display for OwnFinding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.place;
        write!(f, "{} {}", self.entity, self.code)?;
        if let Some(line) = self.line {
            write!(f, " (line {line})")?;
        }
        if let Some(size) = self.size {
            write!(f, ": {size:.3e}")?;
        }
        write!(f, " at ({x:.6}, {y:.6}, {z:.6})")
    }
}

/// Checks a model against the uncertainty of its contexts, times `growth`: an affine image of a part
/// stretches its gaps with everything else.
#[must_use]
pub fn own_findings(document: &Document, model: &Model, growth: f64) -> Vec<OwnFinding> {
    let tolerance = |body| {
        let context = &model.contexts[model.body_context[body]];
        let said = context.uncertainty.map(|tolerance| tolerance.0);
        growth * said.unwrap_or(UNCERTAINTY_METRES / context.length.metres)
    };
    let findings = check::check(&model.brep, &tolerance);
    findings.iter().map(|finding| describe(document, model, finding)).collect()
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
        Finding::SolidInsideOut(f) => origins.bodies[f.body],
    }
}
