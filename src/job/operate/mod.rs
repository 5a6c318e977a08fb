//! From the words of a job to an operation on a model.

pub(in crate::job) mod deform;
pub(in crate::job) mod detail;
pub(in crate::job) mod paste;
pub(in crate::job) mod reconstruct;
pub(in crate::job) mod scale;
pub mod select;
pub(in crate::job) mod select_curve;

use std::path::Path;

use crate::diagnostic::Diagnostic;
use crate::job::file::Operation;
use crate::job::operate::select::SelectError;
use crate::job::part::Read;
use crate::job::report::{DiagnosticReport, OperationReport};
use crate::model::{ChangeSet, Model, Origin};
use crate::ops::OperationError;
use crate::ops::constrained_scale::plan::HeldPiece;
use crate::source::Source;

/// An operation cannot be done on this part.
#[derive(Debug, thiserror::Error)]
pub enum OperateError {
    /// The selector does not fit the part.
    #[error("face: {0}")]
    Face(SelectError),
    /// The selector of the target curve does not fit the part.
    #[error("target.curve: {0}")]
    TargetCurve(SelectError),
    /// The selector of the source curve does not fit its part.
    #[error("source.curve: {0}")]
    SourceCurve(SelectError),
    /// The selector of the target does not fit the part.
    #[error("target.face: {0}")]
    TargetFace(SelectError),
    /// The selector of the primary does not fit the part.
    #[error("primary.face: {0}")]
    PrimaryFace(SelectError),
    /// A cloud cannot be used.
    #[error("cloud: {file}: {reason}")]
    CloudFile {
        /// The file.
        file: String,
        /// Stable code.
        code: &'static str,
        /// Why.
        reason: String,
    },
    /// The selector of the source does not fit its part.
    #[error("source.face: {0}")]
    SourceFace(SelectError),
    /// The file of the source cannot be used.
    #[error("source.file: {file}: {reason}")]
    SourceFile {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// The file of a library's feature cannot be used.
    #[error("source.feature: {file}: {reason}")]
    FeatureFile {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// The file of a library's detail cannot be used.
    #[error("source.detail: {file}: {reason}")]
    DetailFile {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// No curve has the name.
    #[error("source.region.curve: {name} is no curve that was read")]
    NoCurve {
        /// Its record.
        name: Origin,
    },
    /// A line of a deformation cannot be had.
    #[error("{key}: {reason}")]
    Line {
        /// The key: `lines[0].from`.
        key: String,
        /// Why.
        reason: String,
    },
    /// A hold does not fit the part.
    #[error("hold: {0}")]
    Hold(String),
    /// The operation refuses.
    #[error(transparent)]
    Operation(#[from] OperationError),
    /// The part has no face.
    #[error("the part has no face that was read")]
    NoFace,
}

impl OperateError {
    /// The stable code.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Face(SelectError::Several { .. })
            | Self::TargetCurve(SelectError::SeveralCurves { .. })
            | Self::SourceCurve(SelectError::SeveralCurves { .. })
            | Self::TargetFace(SelectError::Several { .. })
            | Self::PrimaryFace(SelectError::Several { .. })
            | Self::SourceFace(SelectError::Several { .. }) => "select.several",
            Self::Face(_)
            | Self::TargetFace(_)
            | Self::PrimaryFace(_)
            | Self::SourceFace(_)
            | Self::TargetCurve(_)
            | Self::SourceCurve(_) => "select.no-match",
            Self::SourceFile { .. } => "job.source-file",
            Self::DetailFile { .. } => "job.detail-file",
            Self::FeatureFile { .. } => "job.feature-file",
            Self::NoCurve { .. } => "paste.no-curve",
            Self::Line { .. } => "deform.no-line",
            Self::Hold(_) => "select.no-hold",
            Self::Operation(error) => error.code(),
            Self::CloudFile { code, .. } => code,
            Self::NoFace => "select.no-face",
        }
    }
}

/// What an operation wants changed, and what it tells.
#[derive(Debug)]
pub struct Operated {
    /// The changes.
    pub changes: ChangeSet,
    /// What is to be told.
    pub report: OperationReport,
    /// What it holds.
    pub held: Vec<HeldPiece>,
}

/// Plans one operation on a model.
///
/// # Errors
/// [`OperateError`]; the model is as before in every case.
pub fn operate(model: &Model, source: &Source, operation: &Operation) -> Result<Operated, OperateError> {
    match operation {
        Operation::ConstrainedScale(words) => {
            let planned = crate::job::operate::scale::planned(model, words)?;
            let (changes, measures) = (planned.change_set, &planned.measures);
            let operated = reported("constrained_scale", changes, measures, &planned.notes, source);
            Ok(Operated { held: planned.held, ..operated })
        }
        Operation::Deform(words) => {
            let planned = crate::job::operate::deform::planned(model, words)?;
            Ok(reported("deform", planned.change_set, &planned.measures, &[], source))
        }
        Operation::DetailTransfer(words) => {
            let planned = crate::job::operate::detail::planned(model, words)?;
            Ok(reported("detail_transfer", planned.change_set, &planned.measures, &planned.notes, source))
        }
        Operation::FeaturePaste(words) => {
            let planned = crate::job::operate::paste::planned(model, words)?;
            Ok(reported("feature_paste", planned.change_set, &planned.measures, &planned.notes, source))
        }
        Operation::FeatureReconstruction(words) => {
            let planned = crate::job::operate::reconstruct::planned(model, words)?;
            Ok(reported(
                "feature_reconstruction",
                planned.change_set,
                &planned.measures,
                &planned.notes,
                source,
            ))
        }
        Operation::Simplify(words) => {
            let planned = words.planned(model)?;
            Ok(reported("simplify", planned.change_set, &planned.measures, &[], source))
        }
    }
}

/// A plan with its report.
fn reported(
    kind: &str,
    changes: ChangeSet,
    measures: &impl serde::Serialize,
    notes: &[Diagnostic],
    source: &Source,
) -> Operated {
    let report = OperationReport {
        kind: kind.to_owned(),
        changed: changed(&changes),
        measures: serde_json::to_value(measures).unwrap_or_default(),
        notes: notes.iter().map(|note| DiagnosticReport::new(note, source)).collect(),
    };
    Operated { changes, report, held: Vec::new() }
}

/// The model of another file, whole or not at all.
pub(in crate::job) fn other_file(file: &str) -> Result<Model, OperateError> {
    let fault = |reason: String| OperateError::SourceFile { file: file.to_owned(), reason };
    let mut read = Read::file(Path::new(file)).map_err(|error| fault(error.to_string()))?;
    read.refuse_damage().map_err(|error| fault(error.to_string()))?;
    let model = read.model();
    read.refuse_errors().map_err(|error| fault(error.to_string()))?;
    Ok(model)
}

fn changed(changes: &ChangeSet) -> std::collections::BTreeMap<String, usize> {
    let counts = [
        ("surfaces", changes.surfaces.len()),
        ("curves", changes.curves.len()),
        ("pcurves", changes.pcurves.len()),
        ("points", changes.points.len()),
        ("free_curves", changes.free_curves.len()),
        ("new_bounds", changes.new_bounds.values().map(Vec::len).sum()),
        ("new_faces", changes.new_faces.len()),
        ("removed_bounds", changes.removed_bounds.len()),
        ("removed_faces", changes.removed_faces.len()),
    ];
    counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect()
}
