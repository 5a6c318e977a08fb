//! IGES files, versions up to 5.3, and their entities that carry geometry.

pub mod card;
pub mod code;
mod compressed;
mod compressed_edit;
pub mod directory_entry;
pub mod edit;
pub mod entity;
pub mod exchange_structure;
pub mod from_model;
pub mod global;
mod index;
mod layout;
pub mod lower;
mod overflow;
pub mod parameter;
pub mod reverse_index;
pub mod schema;
pub mod section;
pub mod string;
pub mod syntax;
pub mod to_model;
pub mod view;
pub mod write;

pub use code::Code;
pub use directory_entry::{DirectoryEntry, EntryNumber, Field, Label, Status};
pub use entity::Entity;
pub use exchange_structure::{ExchangeStructure, Instance};
pub use global::Global;
pub use lower::lower;
pub use overflow::may_overflow;
pub use parameter::{Delimiters, Parameter, ParameterKind, Parameters};
pub use reverse_index::ReverseIndex;
pub use section::{Form, SectionKind, Sections};
pub use to_model::to_model;
pub use view::{EntityView, FieldError, Fields};
