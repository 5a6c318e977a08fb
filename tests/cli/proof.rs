//! The proof sheet: what a run claims of what it held, and that false claims do not pass.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::{Fixture, support};

const DOOR: &str = "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\nalso = [\"proof\"]\n\
    [[operation]]\nkind = \"constrained_scale\"\nfactors = [1.1, 1.2, 1.25]\nhold = [{ loops = \"inner\" }]\n";

/// Runs a job on a part; the sheet stands beside the output.
fn proved(part: impl AsRef<[u8]>, job: &str) -> Fixture {
    let fixture = Fixture::new().file("in.step", part).file("job.toml", job);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    fixture
}

fn sample(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)).expect("a sample")
}

fn text(fixture: &Fixture, name: &str) -> String {
    String::from_utf8(std::fs::read(fixture.path(name)).expect("a file")).expect("text")
}

fn sheet(fixture: &Fixture) -> Value {
    serde_json::from_str(&text(fixture, "out.proof.json")).expect("JSON")
}

const VERIFY: [&str; 4] = ["verify", "out.proof.json", "in.step", "out.step"];

/// What the verifier without any of our code says; `None` without Python.
fn foreign(fixture: &Fixture) -> Option<bool> {
    let python = std::env::var_os("RESURF_OCC_PYTHON").unwrap_or_else(|| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/external/verify_proof.py");
    let files = ["out.proof.json", "in.step", "out.step"].map(|name| fixture.path(name));
    let output = Command::new(python).arg(script).args(files).output().ok()?;
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("proved"), "{said}");
    Some(output.status.success())
}

/// Both verifiers agree that the sheet holds, or that it does not.
fn assert_verdict(fixture: &Fixture, holds: bool, what: &str) {
    let said = fixture.run(&VERIFY);
    let code = if holds { "exit code: 0" } else { "exit code: 1" };
    assert!(said.starts_with(code), "{what}: {said}");
    if let Some(foreign) = foreign(fixture) {
        assert_eq!(foreign, holds, "{what}");
    }
}

/// Replaces a text in a file, and in the sheet the file's digest if `also_digest`.
fn tamper(fixture: &Fixture, name: &str, from: &str, to: &str) {
    let old = text(fixture, name);
    assert!(old.contains(from), "{from}");
    std::fs::write(fixture.path(name), old.replacen(from, to, 1)).expect("a file");
}

#[test]
fn a_door_with_its_holes_held_is_proved_by_both() {
    let fixture = proved(sample("door-solid/door-solid.step"), DOOR);
    assert_verdict(&fixture, true, "as written");
    let sheet = sheet(&fixture);
    let groups = sheet["groups"].as_array().expect("groups");
    let entities = |group: &Value| group["entities"].as_array().expect("entities").clone();
    assert!(!groups.is_empty() && groups.iter().all(|group| entities(group).len() >= 3), "{groups:?}");
    // Features moved, so that nothing is the same to the bit.
    assert!(groups.iter().flat_map(entities).all(|entity| entity["before"] != entity["after"]));
    let verified: Value = {
        let said = fixture.run(&["verify", "out.proof.json", "in.step", "out.step", "--json"]);
        let json = said.split("--- stdout\n").nth(1).and_then(|rest| rest.split("--- stderr").next());
        serde_json::from_str(json.expect("standard output")).expect("JSON")
    };
    for group in verified["groups"].as_array().expect("groups") {
        assert!(group["distances"].as_f64().expect("a number") <= 1e-12, "{group}");
        assert!(group["pairs"].as_u64().expect("a count") > 0, "{group}");
    }
}

#[test]
fn what_stays_has_the_same_digest() {
    let job = DOOR.replace("[1.1, 1.2, 1.25]", "[1, 1, 1]");
    let fixture = proved(sample("door-solid/door-solid.step"), &job);
    assert_verdict(&fixture, true, "unmoved");
    let sheet = sheet(&fixture);
    let entities = sheet["groups"][0]["entities"].as_array().expect("entities").clone();
    assert!(!entities.is_empty() && entities.iter().all(|entity| entity["before"] == entity["after"]));
    let said = fixture.run(&VERIFY);
    assert!(said.contains(&format!("proved: {0} entities, {0} unmoved", entities.len())), "{said}");
}

#[test]
fn features_that_are_pinned_stay_to_the_bit() {
    let job = format!("{DOOR}mode = \"pinned\"\n");
    let fixture = proved(sample("door/door.step"), &job);
    assert_verdict(&fixture, true, "pinned");
    let said = fixture.run(&VERIFY);
    let counts = said.split("proved: ").nth(1).expect("a verdict");
    let counts: Vec<usize> = counts.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(counts[0] > 0 && counts[0] == counts[1], "{said}");
}

/// The sheet with the digests of files that were tampered with put right: only the entities can give it away.
fn excused(fixture: &Fixture) {
    let files = ["in.step", "out.step"].map(|name| std::fs::read(fixture.path(name)).expect("a file"));
    let [before, after] = files.map(|bytes| resurf::digest::sha256(&bytes).to_string());
    let mut sheet = sheet(fixture);
    sheet["before"]["sha256"] = before.into();
    sheet["after"]["sha256"] = after.into();
    std::fs::write(fixture.path("out.proof.json"), sheet.to_string()).expect("a sheet");
}

#[test]
fn false_claims_do_not_pass() {
    let fixture = proved(sample("door-solid/door-solid.step"), DOOR);
    let original = [text(&fixture, "out.step"), text(&fixture, "out.proof.json")];
    let restore = |fixture: &Fixture| {
        std::fs::write(fixture.path("out.step"), &original[0]).expect("a file");
        std::fs::write(fixture.path("out.proof.json"), &original[1]).expect("a file");
    };
    // Another file altogether.
    tamper(&fixture, "out.step", "ENDSEC;", "/* touched */ENDSEC;");
    assert_verdict(&fixture, false, "a comment in the file");
    excused(&fixture);
    assert_verdict(&fixture, true, "a comment is no entity");
    restore(&fixture);
    // A held record that was changed behind the sheet's back.
    let sheet_of = sheet(&fixture);
    let entities = sheet_of["groups"][0]["entities"].as_array().expect("entities").clone();
    let vertex = entities.iter().find_map(|entity| {
        let record = entity["record"].as_str()?;
        let at = original[0].find(&format!("\n{record}=VERTEX_POINT"))?;
        original[0][at + 1..].lines().next()
    });
    let vertex = vertex.expect("a held vertex");
    let point = vertex.rsplit('#').next().and_then(|rest| rest.strip_suffix(");")).expect("its point");
    let at = original[0].find(&format!("\n#{point}=CARTESIAN_POINT")).expect("a record") + 1;
    let line = original[0][at..].lines().next().expect("a line");
    let moved = line.replacen(",(", ",(1.", 1);
    tamper(&fixture, "out.step", line, &moved);
    excused(&fixture);
    assert_verdict(&fixture, false, "a moved vertex");
    restore(&fixture);
    // A motion that is not the one.
    let mut changed = sheet(&fixture);
    let t = &mut changed["groups"][0]["motion"]["translation"][0];
    *t = (t.as_f64().expect("a number") + 1e-6).into();
    std::fs::write(fixture.path("out.proof.json"), changed.to_string()).expect("a sheet");
    assert_verdict(&fixture, false, "another motion");
    // A sheet that claims a scaled face.
    restore(&fixture);
    let mut changed = sheet(&fixture);
    let scaled =
        original[0].lines().filter_map(|line| line.split_once("=ADVANCED_FACE(")).map(|(name, _)| name);
    let known: Vec<String> = changed["groups"]
        .as_array()
        .expect("groups")
        .iter()
        .flat_map(|group| group["entities"].as_array().cloned().unwrap_or_default())
        .filter_map(|entity| entity["record"].as_str().map(str::to_owned))
        .collect();
    let scaled = scaled.into_iter().find(|name| !known.contains(&(*name).to_owned())).expect("a scaled face");
    changed["groups"][0]["entities"][0]["record"] = scaled.into();
    std::fs::write(fixture.path("out.proof.json"), changed.to_string()).expect("a sheet");
    assert_verdict(&fixture, false, "a scaled face");
    // A sheet that claims nothing proves nothing.
    changed["groups"] = serde_json::json!([]);
    std::fs::write(fixture.path("out.proof.json"), changed.to_string()).expect("a sheet");
    assert_verdict(&fixture, false, "no claim");
}

#[test]
fn a_proof_of_nothing_is_refused_before_anything_is_read() {
    let job = DOOR.replace("hold = [{ loops = \"inner\" }]\n", "");
    let fixture = Fixture::new().file("in.step", "no part at all").file("job.toml", job);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(
        said.starts_with("exit code: 2") && said.contains("no operation of the job has a `hold`"),
        "{said}"
    );
}

#[test]
fn sheets_and_files_that_are_none_are_told() {
    let fixture = Fixture::new().file("in.step", "x").file("out.proof.json", "{}").file("out.step", "y");
    let said = fixture.run(&VERIFY);
    assert!(said.starts_with("exit code: 3") && said.contains("missing field"), "{said}");
}

#[test]
fn what_a_later_operation_changes_is_no_claim() {
    // The second scaling holds nothing: what the first held is scaled away.
    let job = format!("{DOOR}[[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 2]\n");
    let fixture = Fixture::new().file("in.step", sample("door-solid/door-solid.step")).file("job.toml", &job);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("claims nothing"), "{said}");
    // Held twice, the motions add up.
    let twice =
        format!("{DOOR}[[operation]]\n{}", DOOR.split("[[operation]]\n").nth(1).expect("an operation"));
    let fixture = proved(sample("door-solid/door-solid.step"), &twice);
    assert_verdict(&fixture, true, "held twice");
}

#[test]
fn a_corpus_part_is_proved() {
    let part = support::corpus().map(|folder: PathBuf| folder.join("step/ANC101-ill.stp"));
    let Some(part) = part.filter(|path| path.exists()) else { return };
    let fixture = proved(std::fs::read(part).expect("a corpus file"), DOOR);
    assert_verdict(&fixture, true, "a corpus part");
}
