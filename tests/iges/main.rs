//! IGES: what every file must survive, what edits may touch, and what files mean.

mod edits;
mod lowered;
mod structure;
#[path = "../support/mod.rs"]
mod support;
