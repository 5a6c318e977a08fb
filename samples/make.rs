//! Writes the sample parts again: `cargo run --example make-samples`.
//!
//! The parts come from formulas, so that anybody can check what stands in them. `tests/samples.rs` holds
//! the committed files against this generator, byte for byte.

mod generate;

fn main() -> std::io::Result<()> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    for sample in generate::all() {
        let path = root.join(sample.path);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(path, sample.bytes)?;
    }
    Ok(())
}
