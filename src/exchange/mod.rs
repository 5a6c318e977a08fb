//! Byte edits on a file: order, overlap check, application, fresh names; and who uses whom.
//!
//! Knows no grammar.

mod name_allocator;
mod patch;
mod users;

pub use name_allocator::{NameAllocator, NamesExhausted};
pub use patch::{Edit, EditCounts, Patch, PatchError};
pub use users::Users;
