//! An IGES file made of a model that came from another format: global section, bodies, curves, looks, subfigures.
//!
//! Solids become B-rep objects (186), sheets trimmed surfaces (144); every value is written as it is, nothing is scaled or
//! approximated. What the format, or this writer, has no place for is reported by [`Loss`]; what would make the part
//! another one is refused.

mod element;
mod presentation;
mod product;
mod shell;
mod trimmed;

use std::collections::{BTreeMap, HashMap};

use super::directory_entry::Status;
use super::lower::draft::Look;
use super::lower::record::Record;
use super::lower::{LowerError, Lowering};
use super::to_model::units::UNITS;
use super::write::{self, NewEntity, ParameterText};
use super::{DirectoryEntry, EntryNumber, ExchangeStructure, Global};
use crate::brep::{BodyId, SurfaceId};
use crate::diagnostic::Sink;
use crate::geometry::ParameterMap;
use crate::model::{ChangeSet, Loss, Model, Origin};
use crate::source::{Source, SourceTooLarge};
use crate::units::LengthUnit;
use presentation::Looks;
use product::Products;

/// What faces of solids are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solids {
    /// Manifold solid B-rep objects: edges shared, insides known.
    #[default]
    Brep,
    /// Trimmed surfaces, as sheets are, for readers that know nothing else.
    Trimmed,
}

/// What the global section of a new file says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Name of the file.
    pub name: String,
    /// ISO 8601 time without zone.
    pub time: String,
    /// Name and version of the program that writes it.
    pub preprocessor: String,
    /// What faces of solids are written as.
    pub solids: Solids,
}

/// Why no file is made of a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FromModelError {
    /// Geometry that was not read.
    #[error("{origin}: its geometry was not read")]
    Unread {
        /// The element.
        origin: Origin,
    },
    /// Geometry that this writer has no entity for.
    #[error("{origin}: a {kind} cannot be written")]
    Unwritable {
        /// The element.
        origin: Origin,
        /// Kind of its geometry.
        kind: &'static str,
    },
    /// A use of a product, or of a body, that mirrors or stretches it.
    #[error("{origin}: a use that mirrors or stretches cannot be written")]
    Placement {
        /// The use, or the body.
        origin: Origin,
    },
    /// A unit of length that the format does not know.
    #[error("the unit of length, {name}, is none of IGES 5.3")]
    Unit {
        /// Its name.
        name: String,
    },
    /// Nothing to write: a file of this format has at least one entity.
    #[error("the part has neither bodies nor curves nor uses of products")]
    Empty,
    /// Products within products beyond any real part.
    #[error("products are nested more than {MAX_NESTING} deep")]
    Nesting,
    /// A global section beyond what a file can have.
    #[error(transparent)]
    Header(#[from] SourceTooLarge),
    /// By the writer of records.
    #[error(transparent)]
    Lower(#[from] LowerError),
}

/// The bytes of an IGES file that says what a model is; each loss goes to the sink.
///
/// # Errors
/// [`FromModelError`].
pub fn from_model(model: &Model, header: &Header, sink: &mut dyn Sink) -> Result<Vec<u8>, FromModelError> {
    let unit = product::unit(model);
    let global = global(model, header, &unit)?;
    // New entities are put together as those of a changed file are; this one has none yet.
    let empty = write::file(&[], &global, &[]);
    let source = Source::new(empty)?;
    let structure = ExchangeStructure::parse(source, &mut Vec::new());
    let nothing = ChangeSet::default();
    let mut writer = Writer {
        model,
        sink,
        solids: header.solids,
        lowering: Lowering::new(&structure, model, &nothing),
        looks: Looks::default(),
        surfaces: HashMap::new(),
        bodies: BTreeMap::new(),
        products: Products::of(model),
    };
    writer.products(&unit)?;
    writer.losses();
    let entities: Vec<NewEntity> = writer.lowering.draft.into_added();
    if entities.is_empty() {
        return Err(FromModelError::Empty);
    }
    Ok(write::file(&["made from another format"], &global, &entities))
}

/// Everything that grows while a file is made.
struct Writer<'a, 's> {
    model: &'a Model,
    sink: &'s mut dyn Sink,
    solids: Solids,
    lowering: Lowering<'a>,
    looks: Looks,
    /// Surfaces of shells, with the way from the file's parameters to the model's.
    surfaces: HashMap<SurfaceId, (EntryNumber, ParameterMap)>,
    /// What each body became: what a product lists.
    bodies: BTreeMap<BodyId, Vec<EntryNumber>>,
    products: Products,
}

/// Products within products that are followed: real assemblies have a dozen.
const MAX_NESTING: usize = 200;

/// Whether something is a part of something else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rank {
    /// It stands by itself.
    Own,
    /// It is a part, in space.
    Part,
    /// It defines something else.
    Definition,
}

impl Rank {
    fn status(self) -> Status {
        match self {
            Self::Own => Status::default(),
            Self::Part => Status { subordinate: 1, ..Status::default() },
            Self::Definition => Status { usage: 2, ..Status::default() },
        }
    }
}

impl Writer<'_, '_> {
    /// A new entity without a look.
    fn add(&mut self, record: &Record, rank: Rank) -> Result<EntryNumber, FromModelError> {
        self.add_as(record, &DirectoryEntry::default(), rank, &[])
    }

    /// A new entity with level and colour of an entry, and pointers behind its fields.
    fn add_as(
        &mut self,
        record: &Record,
        entry: &DirectoryEntry,
        rank: Rank,
        behind: &[ParameterText],
    ) -> Result<EntryNumber, FromModelError> {
        Ok(self.lowering.draft.add(record, Look { from: entry, status: rank.status() }, behind)?)
    }

    /// Reports what stays behind.
    fn losses(&mut self) {
        let model = self.model;
        Loss::of_annotations(model, self.sink);
        for (face, attributes) in model.faces.iter() {
            Loss::of_transparency(&attributes.appearance, model.origins.faces[face], self.sink);
        }
        for (body, attributes) in model.bodies.iter() {
            Loss::of_transparency(&attributes.own.appearance, model.origins.bodies[body], self.sink);
        }
    }
}

/// The global section, with the units, the resolution and the greatest coordinate of the model.
fn global(model: &Model, header: &Header, unit: &LengthUnit) -> Result<Global, FromModelError> {
    let known = UNITS.iter().find(|known| (known.3 - unit.metres).abs() <= SAME_UNIT * unit.metres);
    let known = known.ok_or_else(|| FromModelError::Unit { name: unit.name.clone() })?;
    let digits: String = header.time.chars().filter(char::is_ascii_digit).collect();
    let time = format!("{}.{}", digits.get(..8).unwrap_or("19700101"), digits.get(8..14).unwrap_or("000000"));
    let uncertainty = model.contexts.first().and_then(|context| context.uncertainty);
    let greatest =
        model.brep.vertices.iter().map(|(_, vertex)| vertex.point.coords.amax()).fold(0.0, f64::max);
    if !greatest.is_finite() {
        return Err(LowerError::NotFinite.into());
    }
    let name = product::root_name(model).unwrap_or_else(|| header.name.clone());
    Ok(Global {
        sender_product: name.clone(),
        file_name: header.name.clone(),
        native_system: header.preprocessor.clone(),
        preprocessor_version: header.preprocessor.clone(),
        integer_bits: Some(32),
        single_precision: [Some(38), Some(6)],
        double_precision: [Some(308), Some(15)],
        receiver_product: name,
        scale: Some(1.0),
        unit_flag: Some(known.0),
        unit_name: known.1[0].to_owned(),
        line_weights: Some(1),
        line_width: Some(0.0),
        written: time.clone(),
        resolution: Some(uncertainty.map_or(UNSTATED, |uncertainty| uncertainty.0)),
        greatest_coordinate: Some(greatest),
        version: Some(11),
        drafting_standard: Some(0),
        changed: time,
        ..Global::default()
    })
}

/// Resolution of a model that states none, in its units.
const UNSTATED: f64 = 1e-6;
/// Part of a unit by which a product of what a file says of it is rounded.
const SAME_UNIT: f64 = 1e-14;
