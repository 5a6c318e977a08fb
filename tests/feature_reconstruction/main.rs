//! Feature reconstruction: readers of clouds, segmentation, and the numeric stages on parts that are known from formulas.

#![expect(clippy::unwrap_used, reason = "builders of fixtures stop at what cannot be built")]

mod blends;
mod cloud_files;
mod lines;
mod parts;
#[path = "../../samples/generate/scan/mod.rs"]
mod scan;
mod secondaries;
mod segmentation;
#[expect(dead_code, reason = "this binary needs a part of it")]
#[path = "../support/mod.rs"]
mod support;
