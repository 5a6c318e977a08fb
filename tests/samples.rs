//! The committed sample parts are what their generator writes, byte for byte.

#[path = "../samples/generate/mod.rs"]
mod generate;

use std::path::Path;

#[test]
fn samples_are_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    for sample in generate::all() {
        let committed = std::fs::read_to_string(root.join(sample.path)).unwrap_or_default();
        assert!(
            committed == sample.text,
            "samples/{} is stale: write it again with `cargo run --example make-samples`",
            sample.path
        );
    }
}
