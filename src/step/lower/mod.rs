//! A change set lowered to byte edits on the exchange structure it came from.
//!
//! Works from the top down: surfaces and curves first, then placements and vectors, then points and
//! directions, because each level decides which records of the next one lose their users. At each
//! level a record is edited in place when everything that refers to it asks for the same new content;
//! otherwise the new content is appended as a fresh record and only the references that asked for it
//! are turned to it. A record that loses its last user goes.
//!
//! Does not decide what to change, and does not touch the bytes of a value that keeps its bits.
//!
//! INVARIANTS: no instance name changes its meaning for a user that did not ask; fresh names lie above the
//! highest; the same change set gives the same edits.

mod access;
mod bound;
pub(super) mod compose;
mod curve;
mod derived_curve;
mod edge;
mod face;
mod list;
mod placement;
mod point;
mod request;
mod statement;
mod surface;

use std::collections::{BTreeMap, BTreeSet};

use super::edit;
use super::exchange_structure::{ExchangeStructure, InstanceName};
use super::reverse_index::ReverseIndex;
use super::write::RecordWriter;
use crate::brep::FaceId;
use crate::exchange::{Edit, NameAllocator, Patch, PatchError};
use crate::model::{ChangeSet, Model, Origin};
use crate::source::{LineEnding, Span};
use request::Requests;

/// Why a change set cannot be written into this file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LowerError {
    /// The element did not come from a STEP record.
    #[error("{origin} is no entity instance of this file")]
    ForeignOrigin {
        /// Where the model says that it came from.
        origin: String,
    },
    /// A record has no such attribute, or one of another kind than the schema asks for.
    #[error("{name}: attribute {attribute} is missing or malformed")]
    Attribute {
        /// The record.
        name: InstanceName,
        /// Attribute in the words of the schema.
        attribute: &'static str,
    },
    /// Two elements ask for different content at one place of the file.
    #[error(
        "{name} is asked to become two different things at one place: an edge curve shares it with another"
    )]
    Conflict {
        /// The record whose attribute is contested.
        name: InstanceName,
    },
    /// The new geometry has no entity that this writer knows.
    #[error("{name}: a {kind} cannot be written")]
    Unwritable {
        /// The record that it should replace.
        name: InstanceName,
        /// Kind of the new geometry.
        kind: &'static str,
    },
    /// A reference to a record that the file does not have.
    #[error("{name} is not defined in this file")]
    Unresolved {
        /// The missing record.
        name: InstanceName,
    },
    /// A record that should go is what another one is about.
    #[error("{name} cannot go: {user} ({entity}, line {line}) is about it")]
    StillNeeded {
        /// The record that should go.
        name: InstanceName,
        /// The record that refers to it.
        user: InstanceName,
        /// Keyword of that one.
        entity: String,
        /// Its line, from 1.
        line: usize,
    },
    /// A new edge with a curve of its own has no curve in the parameters of any face.
    #[error("a new edge has no curve in the parameters of a face")]
    NoFaceOfEdge,
    /// A new number beyond what a file can say.
    #[error("a number of the result is beyond every finite one")]
    NotFinite,
    /// New records have no place to go.
    #[error("the file has no data section for new records")]
    NoDataSection,
    /// New records have no name.
    #[error(transparent)]
    Names(#[from] crate::exchange::NamesExhausted),
    /// A record would be changed twice, in two ways.
    #[error(
        "{name} (line {line}) would be changed twice: two faces or shells of the part share it; \
         give each a record of its own"
    )]
    ChangedTwice {
        /// The record.
        name: InstanceName,
        /// Its line, from 1.
        line: usize,
    },
    /// The edits do not fit the file, which is a fault of this module.
    #[error(transparent)]
    Patch(#[from] PatchError),
}

/// Edits a STEP file so that it says what the change set asks for.
///
/// The empty change set gives the empty patch.
///
/// # Errors
/// See [`LowerError`]; nothing is partly lowered.
pub fn lower(structure: &ExchangeStructure, model: &Model, changes: &ChangeSet) -> Result<Patch, LowerError> {
    let mut lowering = Lowering::new(structure, model);
    if changes.is_empty() {
        return lowering.finish();
    }
    lowering.surfaces(changes)?;
    lowering.topology(changes)?;
    lowering.request_edge_curves(changes)?;
    lowering.request_pcurves(changes)?;
    lowering.request_free_curves(changes)?;
    lowering.request_vertices(changes)?;
    lowering.curves()?;
    lowering.placements()?;
    lowering.vectors()?;
    lowering.directions()?;
    lowering.points()?;
    lowering.state(changes)?;
    lowering.unstate(changes)?;
    lowering.remove_orphans();
    lowering.finish()
}

/// Everything that grows while a change set is lowered.
pub(super) struct Lowering<'a> {
    structure: &'a ExchangeStructure,
    model: &'a Model,
    users: ReverseIndex,
    names: NameAllocator,
    edits: Vec<Edit>,
    appended: Vec<String>,
    /// References that went away, for each record referred to.
    lost: BTreeMap<InstanceName, usize>,
    /// References of new records to old ones, for each record referred to.
    gained: BTreeMap<InstanceName, usize>,
    /// Records that go whoever used them.
    retired: BTreeSet<InstanceName>,
    /// Lists whose members change.
    lists: list::ListEdits,
    /// References that a record makes more than once, for each record that was asked.
    repeated: BTreeMap<u32, BTreeMap<InstanceName, usize>>,
    ending: LineEnding,
    /// Faces whose surface was appended, with its name.
    own_surfaces: BTreeMap<FaceId, InstanceName>,
    curves: Requests<request::NewCurve>,
    placements: Requests<request::NewPlacement>,
    vectors: Requests<request::NewVector>,
    points: Requests<request::Coordinates>,
    directions: Requests<request::Coordinates>,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(structure: &'a ExchangeStructure, model: &'a Model) -> Self {
        Self {
            structure,
            model,
            users: ReverseIndex::build(structure),
            names: NameAllocator::above(structure.greatest_name().map(|name| name.0)),
            edits: Vec::new(),
            appended: Vec::new(),
            lost: BTreeMap::new(),
            gained: BTreeMap::new(),
            retired: BTreeSet::new(),
            lists: list::ListEdits::default(),
            repeated: BTreeMap::new(),
            ending: LineEnding::of(structure.source().bytes()),
            own_surfaces: BTreeMap::new(),
            curves: Requests::default(),
            placements: Requests::default(),
            vectors: Requests::default(),
            points: Requests::default(),
            directions: Requests::default(),
        }
    }

    pub(super) fn finish(mut self) -> Result<Patch, LowerError> {
        let appended = edit::append(self.structure, self.appended).ok_or(LowerError::NoDataSection)?;
        self.edits.extend(appended);
        Patch::new(self.structure.source().bytes().len(), self.edits)
            .map_err(|error| changed_twice(self.structure, error))
    }

    /// Replaces the text of a span.
    fn edit(&mut self, span: Span, text: String) {
        self.edits.push(Edit::replace(span, text));
    }

    /// One reference to `target` is no more.
    fn lose(&mut self, target: InstanceName) {
        *self.lost.entry(target).or_insert(0) += 1;
    }

    /// A new record refers to `target`.
    fn gain(&mut self, target: InstanceName) {
        *self.gained.entry(target).or_insert(0) += 1;
    }

    /// The record of an element that a new record refers to.
    fn used(&mut self, origin: Origin) -> Result<InstanceName, LowerError> {
        let name = instance_name(origin)?;
        self.gain(name);
        Ok(name)
    }

    /// Turns one reference token from `old` to `new`.
    fn repoint(&mut self, token: Span, old: InstanceName, new: InstanceName) {
        self.edit(token, new.to_string());
        self.lose(old);
    }

    /// Appends a record `#n=body;` and gives its name.
    pub(super) fn append(&mut self, body: &compose::Body) -> Result<InstanceName, LowerError> {
        if !body.is_finite() {
            return Err(LowerError::NotFinite);
        }
        let name = InstanceName(self.names.allocate()?);
        let mut writer = RecordWriter::instance(name, self.ending);
        body.write(&mut writer);
        self.appended.push(writer.finish());
        Ok(name)
    }
}

/// Edits that overlap, told by the record that they change.
fn changed_twice(structure: &ExchangeStructure, error: PatchError) -> LowerError {
    let PatchError::Overlap { second, .. } = error else { return error.into() };
    let holds = |span: Span| span.start <= second.start && second.start < span.end;
    match structure.instances().find(|instance| holds(instance.span())) {
        Some(instance) => {
            let line = structure.source().position(instance.span().start).line;
            LowerError::ChangedTwice { name: instance.name(), line }
        }
        None => error.into(),
    }
}

fn instance_name(origin: Origin) -> Result<InstanceName, LowerError> {
    let foreign = || LowerError::ForeignOrigin { origin: origin.to_string() };
    origin.instance().map(InstanceName).ok_or_else(foreign)
}
