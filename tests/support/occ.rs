//! Open CASCADE, asked through its Python binding.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A Python that has Open CASCADE, `cadquery-ocp`, as one of the scripts under `tests/external` says of itself:
/// `RESURF_OCC_PYTHON` names it, else `python3` is tried. `None` without it, unless `RESURF_REQUIRE_OCC=1`.
pub fn open_cascade(script: &str) -> Option<PathBuf> {
    let python = PathBuf::from(std::env::var_os("RESURF_OCC_PYTHON").unwrap_or_else(|| "python3".into()));
    let script = external(script);
    let can = Command::new(&python).arg(script).arg("--can").output();
    let can = can.is_ok_and(|output| output.status.success());
    let required = std::env::var("RESURF_REQUIRE_OCC").is_ok_and(|value| value == "1");
    assert!(can || !required, "{} has no OCP: `pip install cadquery-ocp`", python.display());
    can.then_some(python)
}

fn external(script: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/external").join(script)
}

/// What Open CASCADE says of parts before and after their jobs, in order; nothing without it.
pub fn occ_compared(pairs: &[(PathBuf, PathBuf)]) -> Vec<serde_json::Value> {
    let script = "occ_compare.py";
    let Some(python) = open_cascade(script).filter(|_| !pairs.is_empty()) else { return Vec::new() };
    let files = pairs.iter().flat_map(|(before, after)| [before, after]);
    let output =
        Command::new(python).arg(external(script)).args(files).output().expect("the interpreter starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{pairs:?}: {said}");
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    let found: Vec<_> = lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(found.len(), pairs.len());
    found
}
