//! A change set lowered to byte edits on the IGES file it came from; `docs/decisions/iges-patching.md` has the rules.
//!
//! What changes asks for new content of the entities that it came from, through the pointers that lead there. An entity is
//! edited in place when every pointer to it asks for the same; otherwise those that ask get one of their own. What loses
//! its last user becomes a null entity.
//!
//! Does not decide what to change, and does not touch the bytes of a value that keeps its bits.
//!
//! INVARIANTS: no entry changes its number; an entity that others use, who did not ask, keeps its content; the same
//! change set gives the same edits.

pub(super) mod compose_curve;
mod compose_surface;
mod curve;
pub(super) mod draft;
mod extent;
mod ground;
pub(super) mod lift;
mod loose;
mod orphan;
mod planar;
pub(super) mod record;
mod slot;
mod solid;
mod surface;
mod topology;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::edit::{Changes, EditError};
use super::to_model::scope::Scope;
use super::{EntryNumber, ExchangeStructure, Parameter};
use crate::brep::{BodyId, FaceId};
use crate::exchange::{Patch, PatchError};
use crate::model::change_set::NewEdgeId;
use crate::model::{ChangeSet, Model, Origin};
use draft::Draft;
use ground::Ground;
use slot::Slot;

/// Why a change set cannot be written into this file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LowerError {
    /// The element did not come from an IGES entity of this file.
    #[error("{origin} is no entity of this file")]
    ForeignOrigin {
        /// Where the model says that it came from.
        origin: String,
    },
    /// An entity on the way to what changes cannot be read again.
    #[error("{number}: {reason}")]
    Unreadable {
        /// The entity.
        number: EntryNumber,
        /// Why.
        reason: String,
    },
    /// The new geometry has no entity that this writer knows.
    #[error("{number}: a {kind} cannot be written")]
    Unwritable {
        /// The entity that it should replace.
        number: EntryNumber,
        /// Kind of the new geometry.
        kind: &'static str,
    },
    /// Two elements ask for different content of one entity that cannot be parted.
    #[error("{number} is asked to become two different things")]
    Conflict {
        /// The entity.
        number: EntryNumber,
    },
    /// A face whose bounds are not those of curves.
    #[error("{number}: its bounds are its surface's own, which cannot be {change}")]
    NaturalBounds {
        /// The face.
        number: EntryNumber,
        /// What was asked for.
        change: &'static str,
    },
    /// Statements about the shape, which the format does not have.
    #[error("the format has no statements about the shape")]
    Statements,
    /// A new number beyond what a file can say.
    #[error("a number of the result is beyond every finite one")]
    NotFinite,
    /// New cards have no place to go.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The edits do not fit the file, which is a fault of this module.
    #[error(transparent)]
    Patch(#[from] PatchError),
}

/// The changes of an IGES file that make it say what a change set asks for; none for the empty change set.
///
/// # Errors
/// See [`LowerError`]; nothing is partly lowered.
pub fn lower(
    structure: &ExchangeStructure,
    model: &Model,
    changes: &ChangeSet,
) -> Result<Changes, LowerError> {
    if !(changes.stated.is_empty() && changes.unstated.is_empty()) {
        return Err(LowerError::Statements);
    }
    if changes.is_empty() {
        return Ok(Changes::default());
    }
    let mut lowering = Lowering::new(structure, model, changes);
    lowering.surfaces()?;
    lowering.edges()?;
    lowering.vertices()?;
    lowering.free_curves()?;
    lowering.curves()?;
    lowering.topology()?;
    lowering.remove_orphans();
    lowering.draft.finish(structure)
}

/// The byte edits of [`Changes`] as a patch.
///
/// # Errors
/// [`LowerError::Edit`] and [`LowerError::Patch`].
pub fn patch(structure: &ExchangeStructure, changes: &Changes) -> Result<Patch, LowerError> {
    Ok(Patch::new(structure.source().bytes().len(), changes.edits(structure)?)?)
}

/// Everything that grows while a change set is lowered.
pub(super) struct Lowering<'a> {
    scope: Scope<'a>,
    model: &'a Model,
    changes: &'a ChangeSet,
    pub(super) draft: Draft<'a>,
    /// What faces lie on, as far as that was asked for.
    grounds: BTreeMap<FaceId, Ground>,
    /// Curves that are asked for.
    requests: BTreeMap<EntryNumber, Vec<curve::Request>>,
    /// Entities copied for the sake of one face: of the face, and which.
    copies: HashMap<(EntryNumber, EntryNumber), EntryNumber>,
    /// Pointers of edge lists to their curves; looked up once.
    edge_lists: HashMap<EntryNumber, Vec<Option<Slot>>>,
    /// Coordinates of vertex lists; looked up once.
    vertex_lists: HashMap<EntryNumber, Vec<Parameter<'a>>>,
    /// Bounds in whose place another stands already.
    replaced: BTreeSet<EntryNumber>,
    /// New edges of shells, by the body that lists them.
    new_members: BTreeMap<(BodyId, NewEdgeId), solid::Member>,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(structure: &'a ExchangeStructure, model: &'a Model, changes: &'a ChangeSet) -> Self {
        let uncertainty = model.contexts.first().and_then(|context| context.uncertainty.as_ref());
        let resolution = uncertainty.map_or(1e-6, |uncertainty| uncertainty.0);
        Self {
            scope: Scope::new(structure, resolution),
            model,
            changes,
            draft: Draft::new(structure),
            grounds: BTreeMap::new(),
            requests: BTreeMap::new(),
            copies: HashMap::new(),
            edge_lists: HashMap::new(),
            vertex_lists: HashMap::new(),
            replaced: BTreeSet::new(),
            new_members: BTreeMap::new(),
        }
    }
}

/// The entity of an element.
fn entry_of(origin: Origin) -> Result<EntryNumber, LowerError> {
    match origin {
        Origin::DirectoryEntry(number) => Ok(EntryNumber(number)),
        _ => Err(LowerError::ForeignOrigin { origin: origin.to_string() }),
    }
}

/// The list of an element, and its place there from 1.
fn member_of(origin: Origin) -> Result<(EntryNumber, usize), LowerError> {
    match origin {
        Origin::Member { entry, index } => Ok((EntryNumber(entry), index as usize)),
        _ => Err(LowerError::ForeignOrigin { origin: origin.to_string() }),
    }
}
