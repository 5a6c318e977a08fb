//! Wavelets of B-splines and the transfer of detail between curves: vectors of another program, laws, and jobs.

mod curves;
mod filters;
mod transfers;

use resurf::geometry::nurbs::KnotVector;
use serde_json::Value;
use std::path::Path;

/// A file of `tests/vectors`.
pub fn vector(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(name);
    let bytes = std::fs::read(path).expect("a vector file");
    serde_json::from_slice(&bytes).expect("valid JSON")
}

/// The list under a key.
pub fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().expect("a list")
}

/// The numbers of a list.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

/// Rows of three numbers.
pub fn rows(value: &Value) -> Vec<[f64; 3]> {
    let row = |v: &Value| numbers(v).try_into().expect("three numbers");
    value.as_array().expect("a list").iter().map(row).collect()
}

/// Knots under a key.
pub fn knots(value: &Value, key: &str, degree: usize) -> KnotVector {
    KnotVector::new(degree, numbers(&value[key])).expect("good knots")
}

/// A whole number under a key.
pub fn whole(value: &Value, key: &str) -> usize {
    value[key].as_u64().expect("a whole number") as usize
}

/// Greatest difference of two lists of rows.
pub fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many rows");
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
