//! What several test binaries need: files of the corpus, which is not part of the project.

use std::path::{Path, PathBuf};

/// The corpus folder: `RESURF_CORPUS`, or `../shared/corpus` beside the project. `None` when there is none.
pub fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus");
    std::env::var_os("RESURF_CORPUS")
        .map_or(Some(beside), |set| Some(set.into()))
        .filter(|folder| folder.is_dir())
}

/// Extensions of STEP files, compressed ones included.
#[allow(dead_code, reason = "each test binary looks at the formats that it is about")]
pub const STEP: &[&str] = &["stp", "step", "p21", "stpz"];
/// Extensions of IGES files.
#[allow(dead_code, reason = "each test binary looks at the formats that it is about")]
pub const IGES: &[&str] = &["igs", "iges"];

/// Every file of the corpus with one of the extensions, variants included, in the order of their paths. Empty without
/// a corpus.
pub fn corpus_files(extensions: &[&str]) -> Vec<PathBuf> {
    let Some(corpus) = corpus() else { return Vec::new() };
    let mut files: Vec<PathBuf> = walkdir::WalkDir::new(corpus)
        .into_iter()
        .filter_map(|entry| entry.ok().map(walkdir::DirEntry::into_path))
        .filter(|path| {
            let extension =
                path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
            extensions.contains(&extension.as_str())
        })
        .collect();
    files.sort();
    files
}
