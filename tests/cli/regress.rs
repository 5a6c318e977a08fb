//! A folder of parts and jobs against its baseline.

use serde_json::Value;

use super::Fixture;
use super::batch::{JUDGE, door, executable};

const JOB: &str = "version = 1\ninputs = [\"plate.step\"]\noutput = \"out/{stem}.{ext}\"\n\n\
    [[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 2]\n";

fn regress(fixture: &Fixture, arguments: &[&str]) -> (Vec<Value>, String) {
    let said = fixture.run(&[&["regress", "parts", "--baseline", "base.toml", "--json"], arguments].concat());
    let json = said.split("--- stdout\n").nth(1).and_then(|rest| rest.split("--- stderr").next());
    let value = serde_json::from_str(json.unwrap_or_default()).unwrap_or(Value::Null);
    (value.as_array().cloned().unwrap_or_default(), said)
}

fn outcomes(parts: &[Value]) -> Vec<(String, String)> {
    let word = |outcome: &Value| {
        let renamed = outcome.as_object().and_then(|object| object.keys().next().cloned());
        outcome.as_str().map(str::to_owned).or(renamed).expect("an outcome")
    };
    parts
        .iter()
        .map(|part| (part["part"].as_str().expect("a name").to_owned(), word(&part["outcome"])))
        .collect()
}

#[test]
fn a_folder_is_measured_and_each_change_is_named() {
    let sample = |name: &str| {
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name))
            .expect("a sample")
    };
    let plate = sample("plate/plate.step");
    let fixture = Fixture::new()
        .file("parts/plate.step", &plate)
        .file("parts/job.toml", JOB)
        .file("parts/sub/cut.step", &plate[..plate.len() / 2])
        .file("parts/sub/wheel.step", sample("wheel/wheel.step"))
        .file("parts/out/plate.step", "an output of the job is no part");
    let (_, said) = regress(&fixture, &[]);
    assert!(said.starts_with("exit code: 2\n") && said.contains("`--update` writes the first one"), "{said}");
    let (parts, said) = regress(&fixture, &["--update"]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    assert!(outcomes(&parts).iter().all(|(_, outcome)| outcome == "new"), "{said}");
    let (parts, said) = regress(&fixture, &[]);
    let names = ["job.toml: plate.step", "plate.step", "sub/cut.step", "sub/wheel.step"];
    let same: Vec<(String, String)> =
        names.iter().map(|name| ((*name).to_owned(), "same".to_owned())).collect();
    assert!(said.starts_with("exit code: 0\n") && outcomes(&parts) == same, "{said}");

    // Twice the size is eight times the volume: what the job made was measured, not its input.
    let text = std::fs::read_to_string(fixture.path("base.toml")).expect("a baseline");
    let baseline: toml::Table = text.parse().expect("TOML");
    let volume = |name: &str| baseline["part"][name]["volume"].as_float().expect("a number");
    let ratio = volume("job.toml: plate.step") / volume("plate.step");
    assert!((ratio - 8.0).abs() < 1e-9, "{ratio}");
    assert_eq!(baseline["part"]["sub/cut.step"]["outcome"].as_str(), Some("document.damaged"));
    assert!(!fixture.path("parts/out/plate.step.json").exists());

    std::fs::write(fixture.path("parts/job.toml"), JOB.replace("[2, 2, 2]", "[2, 2, 2.5]")).expect("written");
    std::fs::rename(fixture.path("parts/sub/wheel.step"), fixture.path("parts/tyre.step")).expect("moved");
    std::fs::remove_file(fixture.path("parts/sub/cut.step")).expect("gone");
    std::fs::write(fixture.path("parts/fresh.step"), sample("door/door.step")).expect("written");
    let (parts, said) = regress(&fixture, &["--junit", "r.xml"]);
    assert!(said.starts_with("exit code: 1\n"), "{said}");
    let expected = [
        ("fresh.step", "new"),
        ("job.toml: plate.step", "changed"),
        ("plate.step", "same"),
        ("sub/cut.step", "missing"),
        ("tyre.step", "renamed"),
    ];
    assert_eq!(outcomes(&parts), expected.map(|(name, outcome)| (name.to_owned(), outcome.to_owned())));
    let changes: Vec<&str> = parts[1]["changes"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|c| c["measure"].as_str())
        .collect();
    assert_eq!(
        changes,
        ["area", "centroid", "extents.max", "extents.min", "volume"]
            .into_iter()
            .filter(|name| changes.contains(name))
            .collect::<Vec<_>>()
    );
    assert!(changes.contains(&"volume") && changes.contains(&"area"), "{changes:?}");
    let junit = std::fs::read_to_string(fixture.path("r.xml")).expect("written");
    assert!(junit.contains("tests=\"5\" failures=\"4\" errors=\"0\""), "{junit}");

    // What did not change keeps its lines: the difference of versions shows what did.
    assert!(regress(&fixture, &["--update"]).1.starts_with("exit code: 0\n"));
    let updated = std::fs::read_to_string(fixture.path("base.toml")).expect("a baseline");
    let section = |text: &str| {
        text.split("[part.\"plate.step\"]")
            .nth(1)
            .map(|rest| rest.split("\n[").next().unwrap_or("").to_owned())
    };
    assert_eq!(section(&updated), section(&text));
    assert!(regress(&fixture, &[]).1.starts_with("exit code: 0\n"));
}

#[test]
fn a_baseline_that_is_none_is_placed() {
    let fixture =
        Fixture::new().file("parts/a.step", "x").file("base.toml", "version = 1\n[tolerance]\nvolum = 1\n");
    let (_, said) = regress(&fixture, &[]);
    assert!(said.starts_with("exit code: 2\n") && said.contains("base.toml:3"), "{said}");
    let said = fixture.run(&["regress", "nowhere", "--baseline", "base2.toml", "--update"]);
    assert!(said.starts_with("exit code: 2\n"), "{said}");
}

#[test]
fn the_night_of_the_samples_is_one_command() {
    use std::process::Command;
    let samples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let names = [
        "nightly/night.toml",
        "nightly/baseline.toml",
        "nightly/nightly",
        "plate/plate.step",
        "wheel/wheel.step",
        "vamp/vamp.step",
    ];
    let fixture = names.iter().fold(Fixture::new(), |fixture, name| {
        fixture.file(name, std::fs::read(samples.join(name)).expect("a sample"))
    });
    let night = || {
        let output = Command::new("sh")
            .arg(fixture.path("nightly/nightly"))
            .env("RESURF", assert_cmd::cargo::cargo_bin!("resurf"))
            .output()
            .expect("a shell");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = night();
    assert!(said.contains("3 parts: 3 done, 0 failed") && said.contains("3 parts: 0 differ"), "{said}");
    for name in
        ["report.html", "report.json", "report.xml", "regress.xml", "report-parts/0001-plate-mould.html"]
    {
        assert!(fixture.path("nightly/out").join(name).is_file(), "{name}");
    }
    assert!(night().contains("nothing was done"));
}

#[cfg(unix)]
#[test]
fn what_a_limit_stopped_is_no_measure() {
    let fixture = Fixture::new().file("judge", JUDGE).file("parts/door.step", door("hang"));
    executable(&fixture.path("judge"));
    let judge = fixture.path("judge");
    let fixture = fixture.variable("RESURF_FREECADCMD", &judge.to_string_lossy());
    let stopped = ["--with", "freecad", "--timeout", "1"];
    let (_, said) = regress(&fixture, &[&["--update"], &stopped[..]].concat());
    assert!(said.starts_with("exit code: 6\n") && said.contains("door.step"), "{said}");
    assert!(!fixture.path("base.toml").exists());
    let fixture = fixture.file("parts/door.step", door("fine"));
    let (_, said) = regress(&fixture, &["--update", "--with", "freecad"]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    let fixture = fixture.file("parts/door.step", door("hang"));
    let (parts, said) = regress(&fixture, &stopped);
    assert!(said.starts_with("exit code: 6\n") && parts.len() == 1, "{said}");
}

#[cfg(unix)]
#[test]
fn links_are_parts_and_jobs_that_cannot_be_read_are_named() {
    let door = include_str!("../../samples/door/door.step");
    let fixture = Fixture::new().file("door.step", door).file("parts/job.toml", b"version = 1 # caf\xe9\n");
    std::os::unix::fs::symlink("../door.step", fixture.path("parts/linked.step")).expect("a link");
    std::os::unix::fs::symlink("../nowhere.step", fixture.path("parts/lost.step")).expect("a link");
    let (_, said) = regress(&fixture, &["--update"]);
    assert!(said.starts_with("exit code: 7\n") && said.contains("lost.step"), "{said}");
    std::fs::remove_file(fixture.path("parts/lost.step")).expect("a link");
    let (parts, said) = regress(&fixture, &["--update"]);
    let names: Vec<&str> = parts.iter().filter_map(|part| part["part"].as_str()).collect();
    assert_eq!(names, ["job.toml", "linked.step"], "{said}");
}
