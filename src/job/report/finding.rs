//! A fact that a part violates, in a form for reports, and the tolerance by which facts are judged.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::brep::BodyId;
use crate::diagnostic::Severity;
use crate::model::Model;

/// Distance below which points count as one in a file that does not say: a micrometre, finer than any
/// exporter's habit and coarser than the digits that they write.
const UNCERTAINTY_METRES: f64 = 1e-6;

/// A fact that a part violates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OwnFinding {
    /// Stable name of the fact: `edge-off-surface`.
    pub code: String,
    /// `error`, or `warning` for what a sound part may have.
    pub severity: String,
    /// Whether an operation that adds it has failed.
    #[serde(skip)]
    pub fails_a_change: bool,
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

/// Distance within which points of a body count as one, in its file units.
#[must_use]
pub fn tolerance(model: &Model, body: BodyId) -> f64 {
    let context = &model.contexts[model.body_context[body]];
    let said = context.uncertainty.map(|tolerance| tolerance.0);
    said.unwrap_or(UNCERTAINTY_METRES / context.length.metres)
}
