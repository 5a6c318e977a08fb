//! From the words of a job to an operation on a model.

use std::path::Path;

use super::file::{self, ConstrainedScale, Operation};
use super::part::Read;
use super::report::{DiagnosticReport, OperationReport};
use super::select::{self, SelectError, point_in};
use crate::brep::{EdgeId, FaceId, LoopId};
use crate::diagnostic::Diagnostic;
use crate::math::{Matrix3, Point3, Vector3};
use crate::model::{ChangeSet, Model, Origin};
use crate::ops::OperationError;
use crate::ops::constrained_scale::{
    Continuity, Energy, Freedom, Hold, Scaling,
    plan::{HoldTarget, Params, Scope, inner_loops, plan},
};
use crate::source::Source;
use crate::units::LengthUnit;

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
            | Self::SourceFace(SelectError::Several { .. }) => "select.several",
            Self::Face(_)
            | Self::TargetFace(_)
            | Self::SourceFace(_)
            | Self::TargetCurve(_)
            | Self::SourceCurve(_) => "select.no-match",
            Self::SourceFile { .. } => "job.source-file",
            Self::DetailFile { .. } => "job.detail-file",
            Self::FeatureFile { .. } => "job.feature-file",
            Self::NoCurve { .. } => "paste.no-curve",
            Self::Hold(_) => "select.no-hold",
            Self::Operation(error) => error.code(),
            Self::NoFace => "select.no-face",
        }
    }
}

/// What an operation wants changed, and what it tells.
pub type Operated = (ChangeSet, OperationReport);

/// Plans one operation on a model.
///
/// # Errors
/// [`OperateError`]; the model is as before in every case.
pub fn operate(model: &Model, source: &Source, operation: &Operation) -> Result<Operated, OperateError> {
    match operation {
        Operation::ConstrainedScale(settings) => scale(model, source, settings),
        Operation::DetailTransfer(words) => {
            let planned = super::detail_operate::planned(model, words)?;
            Ok(reported("detail_transfer", planned.change_set, &planned.measures, &planned.notes, source))
        }
        Operation::FeaturePaste(words) => {
            let planned = super::paste_operate::planned(model, words)?;
            Ok(reported("feature_paste", planned.change_set, &planned.measures, &planned.notes, source))
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
    (changes, report)
}

fn scale(model: &Model, source: &Source, settings: &ConstrainedScale) -> Result<Operated, OperateError> {
    let params = params(model, settings)?;
    let planned = plan(model, &params)?;
    Ok(reported("constrained_scale", planned.change_set, &planned.measures, &planned.notes, source))
}

/// The model of another file, whole or not at all.
pub(super) fn other_file(file: &str) -> Result<Model, OperateError> {
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

fn params(model: &Model, settings: &ConstrainedScale) -> Result<Params, OperateError> {
    let (scope, faces) = match &settings.face {
        Some(selector) => {
            let faces = select::faces(model, selector).map_err(OperateError::Face)?;
            (Scope::Faces(faces.clone()), faces)
        }
        None => (Scope::Part, model.brep.faces.ids().collect()),
    };
    let first = *faces.first().ok_or(OperateError::NoFace)?;
    let unit = &model.context_of(first).length;
    let mut hold = Vec::new();
    for wanted in &settings.hold {
        hold.push(target(model, &faces, wanted, unit)?);
    }
    Ok(Params { scaling: scaling(settings, unit), scope, hold, mode: mode(settings) })
}

fn scaling(settings: &ConstrainedScale, unit: &LengthUnit) -> Scaling {
    let mut scaling = Scaling::new(settings.factors.0);
    if let Some(center) = &settings.center {
        scaling.center = point_in(center, unit);
    }
    if let Some(axes) = &settings.axes {
        scaling.axes = Matrix3::from_columns(&axes.0.map(Vector3::from));
    }
    scaling.continuity = match settings.continuity {
        file::Continuity::Position => Continuity::Position,
        file::Continuity::Tangent => Continuity::Tangent,
        file::Continuity::Curvature => Continuity::Curvature,
    };
    scaling.energy = match settings.energy {
        file::Energy::Slide => Energy::Slide,
        file::Energy::Published => Energy::Published,
    };
    scaling.freedom = match settings.motion {
        file::Motion::Normal => Freedom::Normal,
        file::Motion::Free => Freedom::Free,
    };
    scaling
}

fn mode(settings: &ConstrainedScale) -> Hold {
    match settings.mode {
        file::HoldMode::Rigid => Hold::Rigid,
        file::HoldMode::Pinned => Hold::Pinned(None),
        file::HoldMode::Axes => Hold::Axes(
            [file::Axis::X, file::Axis::Y, file::Axis::Z].map(|axis| settings.held_axes.contains(&axis)),
        ),
    }
}

fn target(
    model: &Model,
    faces: &[FaceId],
    hold: &file::Hold,
    unit: &LengthUnit,
) -> Result<HoldTarget, OperateError> {
    match hold {
        file::Hold::Inner => Ok(HoldTarget::InnerLoops),
        file::Hold::Near(point) => {
            let at = point_in(point, unit);
            let loops = faces.iter().flat_map(|&face| inner_loops(model, face));
            let nearest = loops.min_by(|&a, &b| {
                distance_to_loop(model, a, &at).total_cmp(&distance_to_loop(model, b, &at)).then(a.cmp(&b))
            });
            nearest
                .map(HoldTarget::Loop)
                .ok_or_else(|| OperateError::Hold("the faces have no inner loop".to_owned()))
        }
        file::Hold::Index(index) => by_index(model, faces, *index),
        file::Hold::Edge(name) => by_edge(model, faces, *name),
    }
}

fn by_index(model: &Model, faces: &[FaceId], index: usize) -> Result<HoldTarget, OperateError> {
    let [face] = faces else {
        return Err(OperateError::Hold(format!(
            "`index` needs one face in scope, and there are {}",
            faces.len()
        )));
    };
    let loops = inner_loops(model, *face);
    let Some(&found) = loops.get(index) else {
        let count = loops.len();
        return Err(OperateError::Hold(format!(
            "the face has {count} inner loops, counted from 0; found {index}"
        )));
    };
    Ok(HoldTarget::Loop(found))
}

fn by_edge(model: &Model, faces: &[FaceId], origin: Origin) -> Result<HoldTarget, OperateError> {
    let edges = |face: FaceId| model.brep.coedges_of(face).map(|c| (c, model.brep.coedges[c].edge));
    let names = |(coedge, edge)| {
        let oriented = model.origins.coedges[coedge] == origin;
        let found: Option<EdgeId> = (oriented || model.origins.edges[edge] == origin).then_some(edge);
        found
    };
    let found = faces.iter().flat_map(|&face| edges(face)).find_map(names);
    found
        .map(HoldTarget::Edge)
        .ok_or_else(|| OperateError::Hold(format!("no edge of the faces in scope is `{origin}`")))
}

/// Distance of a point from the middle of a loop's vertices and curve points: of two loops, the one
/// around the point is the nearer.
fn distance_to_loop(model: &Model, of: LoopId, at: &Point3<f64>) -> f64 {
    let brep = &model.brep;
    let mut sum = Vector3::zeros();
    let mut count = 0.0;
    for &coedge in &brep.loops[of].coedges {
        let edge = brep.coedges[coedge].edge;
        for point in crate::brep::sample_edge(brep, edge, &EDGE_SAMPLING).unwrap_or_default() {
            sum += point.point.coords;
            count += 1.0;
        }
    }
    if count > 0.0 { (Point3::from(sum / count) - at).norm() } else { f64::INFINITY }
}

/// Enough to tell loops apart.
const EDGE_SAMPLING: crate::brep::EdgeSampling =
    crate::brep::EdgeSampling { chord: f64::INFINITY, per_span: 8 };
