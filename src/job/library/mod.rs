//! Libraries: features and curve detail kept as JSON files, without the part that they came from.

pub mod detail;
pub mod feature;
