//! Byte edits on a file: order, overlap check, application, fresh names.
//!
//! Knows no grammar.
