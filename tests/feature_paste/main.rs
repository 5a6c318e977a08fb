//! Feature paste: the vectors p1 to p7 of its specification, its invariants, and its errors.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test when it cannot go on")]

mod errors;
mod fairness;
mod invariants;
mod parts;
mod sweep;
mod vectors;

#[path = "../support/nets.rs"]
mod nets;
