//! ISO 10303-21 exchange files and the entities of AP203, AP214 and AP242 that carry geometry.

mod alphabet;
pub mod code;
pub mod edit;
pub mod entity;
pub mod exchange_structure;
pub mod from_model;
mod index;
pub mod lower;
mod name_table;
pub mod parameter;
pub mod proof;
pub mod reverse_index;
pub mod schema;
pub mod section;
pub mod string;
pub mod syntax;
pub mod to_model;
pub mod view;
pub mod write;

pub use code::Code;
pub use entity::Entity;
pub use exchange_structure::{ExchangeStructure, Instance, InstanceName, SimpleRecord};
pub use lower::{LowerError, lower};
pub use parameter::{Parameter, ParameterKind, Parameters};
pub use reverse_index::ReverseIndex;
pub use section::{Section, SectionKind};
pub use to_model::to_model;
pub use view::EntityView;
