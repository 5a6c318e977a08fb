//! Byte edits on a file: order, overlap check, application, fresh names.
//!
//! Knows no grammar.

mod name_allocator;
mod patch;

pub use name_allocator::{NameAllocator, NamesExhausted};
pub use patch::{Edit, EditCounts, Patch, PatchError};
