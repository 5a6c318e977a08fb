//! Rules of the house that no compiler knows: who may import whom, how long things may be, which names
//! and files must agree.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Layer of each room, as the table of `docs/architecture.md` has it. A room imports rooms of lower layers only.
fn layers() -> BTreeMap<String, u8> {
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| ")?.split(" | ");
        let layer = cells.next()?.trim().parse().ok()?;
        Some((cells.next()?.trim().trim_matches('`').to_owned(), layer))
    };
    let plan = read(Path::new("docs/architecture.md"));
    let table: BTreeMap<String, u8> = plan.lines().filter_map(row).collect();
    assert!(table.len() > 10, "the table of rooms was not found");
    table
}

/// Production lines of a file: beyond the hard limit it is two files.
const FILE_LINES: usize = 900;
/// Files that may be longer, each with its reason.
const LONG_FILES: [(&str, &str); 0] = [];
/// Names that say nothing.
const EMPTY_NAMES: [&str; 6] = ["util", "utils", "helper", "helpers", "common", "misc"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below a folder with one of the extensions, sorted, as paths from the root.
fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let walk = walkdir::WalkDir::new(root().join(folder)).sort_by_file_name();
    let files = walk.into_iter().filter_map(Result::ok).filter(|entry| entry.file_type().is_file());
    let known = |path: &PathBuf| path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x));
    let relative = |path: PathBuf| path.strip_prefix(root()).map(Path::to_path_buf).unwrap_or(path);
    files.map(walkdir::DirEntry::into_path).filter(known).map(relative).collect()
}

fn read(path: &Path) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Lines before the tests of a file, with their numbers.
fn production(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .take_while(|line| !line.starts_with("#[cfg(test)]"))
        .enumerate()
        .map(|(n, line)| (n + 1, line))
}

fn is_test(path: &Path) -> bool {
    path.components().any(|part| part.as_os_str() == "tests") || path.ends_with("tests.rs")
}

fn room(path: &Path) -> String {
    let name = path.components().nth(1).map(|part| part.as_os_str().to_string_lossy().into_owned());
    name.unwrap_or_default().trim_end_matches(".rs").to_owned()
}

/// First names behind `crate::` in a line of code.
fn imports(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    let mut names = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let group = rest.strip_prefix('{').map(|inner| inner.split('}').next().unwrap_or_default());
        for part in group.unwrap_or(rest).split(if group.is_some() { ',' } else { ';' }) {
            let name: String =
                part.trim().chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
            names.push(name);
        }
    }
    names
}

#[test]
fn arrows_point_down_only() {
    let layers = layers();
    let mut faults = Vec::new();
    for path in files("src", &["rs"]).iter().filter(|path| !is_test(path)) {
        let from = room(path);
        if from == "lib" {
            continue;
        }
        let Some(layer) = layers.get(&from) else {
            faults.push(format!("{}: the room `{from}` has no layer", path.display()));
            continue;
        };
        for (number, line) in production(&read(path)) {
            for to in imports(line).into_iter().filter(|to| *to != from) {
                if layers.get(&to).is_some_and(|other| other >= layer) {
                    faults.push(format!("{}:{number}: `{from}` imports `{to}`", path.display()));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn files_keep_to_their_budget_and_have_telling_names() {
    let mut faults = Vec::new();
    for path in files("src", &["rs"]).iter().filter(|path| !is_test(path)) {
        let lines = production(&read(path)).count();
        let allowed = LONG_FILES.iter().any(|(long, _)| Path::new(long) == path);
        if lines > FILE_LINES && !allowed {
            faults.push(format!("{}: {lines} lines, at most {FILE_LINES}", path.display()));
        }
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        if EMPTY_NAMES.contains(&stem.as_str()) {
            faults.push(format!("{}: the name says nothing", path.display()));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_module_says_what_it_is_for() {
    let without: Vec<String> = files("src", &["rs"])
        .iter()
        .filter(|path| !is_test(path) && !read(path).starts_with("//!"))
        .map(|path| path.display().to_string())
        .collect();
    assert!(without.is_empty(), "no `//!` at the top of {}", without.join(", "));
}

#[test]
fn only_the_command_line_prints() {
    let words = ["println!", "eprintln!", "print!(", "dbg!", "stdout()", "stderr()"];
    let mut faults = Vec::new();
    for path in files("src", &["rs"]).iter().filter(|path| room(path) != "cli" && !is_test(path)) {
        for (number, line) in production(&read(path)) {
            let code = line.split("//").next().unwrap_or_default();
            if words.iter().any(|word| code.contains(word)) {
                faults.push(format!("{}:{number}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn only_the_job_uses_the_file_system() {
    let mut faults = Vec::new();
    for path in files("src", &["rs"]).iter().filter(|path| !is_test(path)) {
        // Validators get a folder of their own from the job; the command line reads the job file.
        if ["job", "batch", "regress", "cli", "validate"].contains(&room(path).as_str()) {
            continue;
        }
        for (number, line) in production(&read(path)) {
            let code = line.split("//").next().unwrap_or_default();
            if code.contains("std::fs") || code.contains("File::open") || code.contains("std::env") {
                faults.push(format!("{}:{number}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn schemas_are_up_to_date() {
    let schemas = [
        ("schemas/job.v1.schema.json", resurf::job::schema::job()),
        ("schemas/report.v1.schema.json", resurf::job::schema::report()),
        ("schemas/feature.v1.schema.json", resurf::job::schema::feature()),
        ("schemas/detail.v1.schema.json", resurf::job::schema::detail()),
        ("schemas/proof.v1.schema.json", resurf::job::schema::proof()),
    ];
    for (path, generated) in schemas {
        let committed = fs::read_to_string(root().join(path)).unwrap_or_default();
        let word = path.trim_start_matches("schemas/").split('.').next().unwrap_or_default();
        assert!(committed == generated, "{path} is stale: `cargo run -- schema {word} > {path}`");
    }
}

#[test]
fn jobs_of_the_samples_are_valid() {
    let jobs = files("samples", &["toml"]);
    assert!(jobs.len() >= 6, "the samples lack jobs");
    for path in jobs.into_iter().filter(|path| !path.ends_with("baseline.toml")) {
        let job = resurf::job::text::read(&read(&path), resurf::job::text::Syntax::Toml);
        assert!(job.is_ok(), "{}: {job:?}", path.display());
    }
}

#[test]
fn paths_that_the_documents_name_exist() {
    let mut faults = Vec::new();
    let mut documents = files("docs", &["md"]);
    documents.push(PathBuf::from("README.md"));
    for path in documents {
        let text = read(&path);
        for word in text.split('`').skip(1).step_by(2) {
            let folders =
                ["src/", "tests/", "docs/", "samples/", "schemas/", "benches/", "fuzz/", "scripts/"];
            let named = folders.iter().any(|folder| word.starts_with(folder));
            let plain = !word.contains([' ', '*', '{', '<', '\n']);
            if named && plain && !word.contains("/out/") && !root().join(word).exists() {
                faults.push(format!("{}: `{word}`", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "named and not there:\n{}", faults.join("\n"));
}

#[test]
fn every_dependency_has_its_reason() {
    let manifest: toml::Table = read(Path::new("Cargo.toml")).parse().expect("Cargo.toml is TOML");
    let reasons = read(Path::new("docs/decisions/dependencies.md"));
    for kind in ["dependencies", "dev-dependencies"] {
        let crates = manifest.get(kind).and_then(toml::Value::as_table).expect("a table of dependencies");
        for name in crates.keys() {
            assert!(reasons.contains(&format!("| {name} |")), "docs/decisions/dependencies.md lacks {name}");
        }
    }
}
