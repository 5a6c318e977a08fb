//! Names, colours and layers before and after a job, as Open CASCADE reads them: what a patch must not lose.
//!
//! Open CASCADE is asked through its Python binding (`cadquery-ocp`): `RESURF_OCC_PYTHON` names the interpreter, or
//! else `python3` is tried. Without it the test is silent, unless `RESURF_REQUIRE_OCC=1`.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

mod held;
mod made;
mod measures;
mod referee;

#[path = "../support/occ.rs"]
#[allow(dead_code, reason = "shared with other test binaries")]
mod occ;
#[path = "../support/mod.rs"]
#[allow(dead_code, reason = "shared with other test binaries")]
mod support;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The interpreter that has Open CASCADE.
fn python() -> Option<PathBuf> {
    occ::open_cascade("occ_attributes.py")
}

/// What Open CASCADE reads of a file beside its geometry.
fn attributes(python: &Path, file: &Path) -> Value {
    let script = root().join("tests/external/occ_attributes.py");
    let output = Command::new(python).arg(script).arg(file).output().expect("the interpreter starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {:?} {said}", file.display(), output.status);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let answer = text.trim_end().lines().next_back().unwrap_or_default();
    serde_json::from_str(answer).unwrap_or_else(|error| panic!("{}: {error}: {text}", file.display()))
}

/// Runs a job on a copy of a part, and compares what Open CASCADE reads of both.
fn keeps_attributes(python: &Path, part: &Path, operation: &str) -> Value {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    std::fs::copy(part, place("in.step")).expect("a part");
    let job = format!(
        "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
         [[operation]]\nkind = \"constrained_scale\"\n{operation}\n"
    );
    std::fs::write(place("job.toml"), job).expect("a job");
    let program = assert_cmd::cargo::cargo_bin!("resurf");
    let run = Command::new(program).arg("run").arg(place("job.toml")).output().expect("the program starts");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{}: {said}", part.display());
    let bytes = |name| std::fs::read(place(name)).expect("a file");
    assert!(bytes("in.step") != bytes("out.step"), "{}: the job changes nothing", part.display());
    let (before, after) = (attributes(python, &place("in.step")), attributes(python, &place("out.step")));
    assert_eq!(before, after, "{}", part.display());
    after
}

const HOLD: &str = "hold = [{ loops = \"inner\" }]";

#[test]
fn the_door_keeps_name_colour_and_layer() {
    let Some(python) = python() else { return };
    let operation = format!("factors = [1.1, 1.2, 1.25]\n{HOLD}");
    let found = keeps_attributes(&python, &root().join("samples/door/door.step"), &operation);
    // What the generator of the samples writes: one red face on one layer.
    assert_eq!(found["face_count"], 1);
    assert_eq!(found["faces"][0]["layers"], serde_json::json!(["outer skin"]));
    assert!(found["faces"][0]["colours"]["surface"].is_array(), "{found}");
    let names: Vec<&Value> = found["labels"].as_array().expect("a list").iter().map(|l| &l["name"]).collect();
    assert_eq!(names, ["OUTER_SKIN", "door"]);
}

#[test]
fn the_assembly_keeps_names_and_colours_of_both_parts() {
    let Some(python) = python() else { return };
    let operation = format!("factors = [1.1, 1.2, 1.25]\nface = {{ product = \"door\" }}\n{HOLD}");
    let found = keeps_attributes(&python, &root().join("samples/assembly/assembly.step"), &operation);
    assert_eq!(found["face_count"], 7);
    let coloured = |list: &Value| {
        let entries = list.as_array().expect("a list").iter();
        entries.filter(|entry| entry["colours"]["surface"].is_array()).count()
    };
    assert_eq!((coloured(&found["faces"]), coloured(&found["solids"])), (1, 1), "{found}");
}

#[test]
fn the_thin_solid_and_the_other_edition_keep_theirs() {
    let Some(python) = python() else { return };
    for sample in ["door/door-ap242.step", "hood/hood.step", "trunk/trunk.step"] {
        keeps_attributes(
            &python,
            &root().join("samples").join(sample),
            &format!("factors = [1.1, 1.2, 1.25]\n{HOLD}"),
        );
    }
}

#[test]
fn parts_of_the_corpus_keep_theirs() {
    let (Some(python), Some(corpus)) = (python(), support::corpus()) else { return };
    // Faces as the corpus's catalogue counts them for Open CASCADE.
    let parts = [
        ("s1-c5-214/FOOT_BACK_000.stp", 13),
        ("issue153.stp", 38),
        ("as1_pe_203.stp", 53),
        ("trj3_as1-tc-214.stp", 53),
        ("io1-cm-214.stp", 29),
    ];
    for (part, faces) in parts {
        let found = keeps_attributes(&python, &corpus.join("step").join(part), "factors = [0.5, 0.5, 0.5]");
        assert_eq!(found["face_count"], faces, "{part}");
    }
}
