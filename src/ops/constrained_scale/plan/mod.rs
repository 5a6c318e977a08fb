//! From a model and parameters to a change set: which element gets which motion.
//!
//! Faces with held loops are fixed and stretched; what hangs on a held loop moves rigidly with it; all else in the
//! scope gets its exact affine image. Each shared edge and vertex is moved once. Faces outside the scope stay, and
//! a face of the scope may not share an edge with them.
//!
//! Pure: no I/O. All or nothing.

mod assemble;
mod hold;
mod report;
mod rigid;
mod scope;
mod stretch;

use crate::ops::net::layout;
pub use crate::ops::net::layout::inner_loops;
pub use report::{FaceMeasures, GroupMeasures, LoopMeasures, Measures, SkinMeasures};
pub use scope::Scope;

use super::scaling::{Hold, Scaling};
use crate::brep::{EdgeId, LoopId};
use crate::diagnostic::Diagnostic;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;

/// What is to be held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum HoldTarget {
    /// All inner loops of the B-spline faces in scope.
    InnerLoops,
    /// One loop.
    Loop(LoopId),
    /// The inner loop that an edge belongs to.
    Edge(EdgeId),
}

/// Parameters of the operation on a model. Lengths are in file units.
#[derive(Debug, Clone, PartialEq)]
pub struct Params {
    /// Factors, centre, energy and the like.
    pub scaling: Scaling,
    /// Faces to scale.
    pub scope: Scope,
    /// Loops to hold; none for plain scaling.
    pub hold: Vec<HoldTarget>,
    /// How they are held.
    pub mode: Hold,
}

/// What is to be done, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// New geometry; empty for the identity.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
    /// Facts worth telling: loops that were held by propagation, faces that stayed.
    pub notes: Vec<Diagnostic>,
}

/// Plans a constrained scaling.
///
/// # Errors
/// See [`OperationError`]; each names the elements concerned.
pub fn plan(model: &Model, params: &Params) -> Result<Plan, OperationError> {
    let plain = params.scaling.affine()?;
    let faces = params.scope.faces(model);
    scope::refuse_torn_neighbours(model, &faces)?;
    let mut notes = scope::staying(model, &faces);
    notes.extend(scope::placed(model, &faces));
    let held = hold::find(model, &faces, params, &mut notes)?;
    let moves = matches!(params.mode, Hold::Pinned(Some(_))) && !held.bases.is_empty();
    if plain.is_identity() && !moves {
        return Ok(Plan { change_set: ChangeSet::default(), measures: Measures::default(), notes });
    }
    let stretched = stretch::stretch(model, &held, params)?;
    let measures = report::measure(model, &held, &stretched)?;
    let change_set =
        assemble::change_set(model, &faces, &held, &stretched, &plain, &mut notes, &params.scope)?;
    Ok(Plan { change_set, measures, notes })
}
