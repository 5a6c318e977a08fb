//! Constrained scaling: the vectors b1 to b6 of its specification, its invariants, and its figures on car panels.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test when it cannot go on")]

mod certified;
mod errors;
mod files;
mod invariants;
mod methods;
mod models;
mod panels;
mod parts;
mod plan;
mod thin_solid;
mod vectors;

#[path = "../support/nets.rs"]
mod nets;
