//! From a model and parameters to a change set: which element gets which motion.
//!
//! In order: `target` names loops and faces, `flood` finds what hangs on them, `base` lays out the faces that bear
//! them, `piece` gives every feature its motion, cut at a `wall` where its ends must part, `stretch` runs the
//! numeric core on the faces between, `follow` says which element follows which motion, `clear` and `opposite` look
//! whether they stay clear of each other, and `assemble` makes each element's `image` once, however many faces share it.
//!
//! Faces outside the scope stay, and a face of the scope may not share an edge with them.
//!
//! Pure: no I/O. All or nothing.

mod assemble;
mod base;
mod carrier;
mod clear;
mod contour;
mod flood;
mod follow;
mod held;
mod image;
mod opposite;
mod pcurve;
mod piece;
mod report;
mod rigid;
mod scope;
mod stretch;
mod target;
mod wall;
mod winding;

use crate::ops::net::layout;
pub use crate::ops::net::layout::inner_loops;
pub use report::{FaceMeasures, GroupMeasures, LoopMeasures, Measures, SkinMeasures};
pub use scope::Scope;
pub use target::{HoldTarget, LoopFilter};

use super::scaling::{Hold, Scaling};
use crate::brep::{EdgeId, FaceId, VertexId};
use crate::diagnostic::Diagnostic;
use crate::math::Affine;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;

/// What becomes of the walls between the ends of a held feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wall {
    /// They keep their lengths, and with them the thickness of the material at the feature; between two planes that
    /// the scaling moves apart the longest straight wall is made longer.
    #[default]
    Rigid,
    /// As rigid, but two planes that the scaling moves apart are refused.
    Strict,
    /// They keep their cross-section and are made longer, so that the material is as thick as the scaling makes it.
    Slide,
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
    /// What becomes of walls.
    pub wall: Wall,
    /// Faces that must stay scaled: a hold that spreads to one is refused.
    pub stop: Vec<FaceId>,
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
    /// What kept its shape.
    pub held: Vec<HeldPiece>,
}

/// Elements that kept their shape, with the rigid motion that they share.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPiece {
    /// The motion.
    pub motion: Affine,
    /// Faces; not those of walls that became longer.
    pub faces: Vec<FaceId>,
    /// Edges.
    pub edges: Vec<EdgeId>,
    /// Their vertices.
    pub vertices: Vec<VertexId>,
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
    let held = flood::find(model, &faces, params, &mut notes)?;
    let moves = matches!(params.mode, Hold::Pinned(Some(_))) && !held.bases.is_empty();
    if plain.is_identity() && !moves {
        let (change_set, measures) = (ChangeSet::default(), Measures::default());
        return Ok(Plan { change_set, measures, notes, held: follow::unmoved(model, &held) });
    }
    let stretched = stretch::stretch(model, &held, params, &plain)?;
    notes.extend(report::notes(model, &held, &stretched, params.wall));
    let follow = follow::follow(model, &held, &stretched)?;
    clear::refuse_overlaps(model, &held, &follow, &plain)?;
    notes.extend(opposite::refuse_too_close(model, &held, &stretched, &follow, &plain)?);
    let mut change_set = assemble::change_set(model, &faces, &held, &stretched, &follow, &plain)?;
    let measures = report::measure(model, &held, &stretched, &change_set)?;
    assemble::free_curves(model, &params.scope, &plain, &mut change_set, &mut notes);
    let held = follow.held_pieces(&stretched);
    Ok(Plan { change_set, measures, notes, held })
}
