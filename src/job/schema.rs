//! JSON Schema of the job file, of the report, of features, details and proof sheets, generated from their types.

use crate::job::file::Job;
use crate::job::library::detail::DetailFile;
use crate::job::library::feature::FeatureFile;
use crate::job::report::Report;
use crate::job::side::proof::ProofSheet;

/// The schema of the job file, with a line feed behind it.
#[must_use]
pub fn job() -> String {
    text(&schemars::schema_for!(Job))
}

/// The schema of the report, with a line feed behind it.
#[must_use]
pub fn report() -> String {
    text(&schemars::schema_for!(Report))
}

/// The schema of a feature of a library, with a line feed behind it.
#[must_use]
pub fn feature() -> String {
    text(&schemars::schema_for!(FeatureFile))
}

/// The schema of the detail of a library, with a line feed behind it.
#[must_use]
pub fn detail() -> String {
    text(&schemars::schema_for!(DetailFile))
}

/// The schema of a proof sheet, with a line feed behind it.
#[must_use]
pub fn proof() -> String {
    text(&schemars::schema_for!(ProofSheet))
}

fn text(schema: &schemars::Schema) -> String {
    let mut text = serde_json::to_string_pretty(schema).expect("a schema is a tree of texts and numbers");
    text.push('\n');
    text
}
