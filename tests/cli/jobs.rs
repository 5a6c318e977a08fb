//! Job files, good and bad.

use super::{Fixture, door_job};

/// Runs a job on the door and holds that a refused job leaves nothing.
fn refused(operation: &str) -> String {
    let fixture = Fixture::new().sample("door/door.step").file("job.toml", door_job(operation));
    let said = fixture.run(&["run", "job.toml"]);
    assert_eq!(fixture.left(), ["door.step", "job.toml"]);
    said
}

#[test]
fn an_unknown_key_is_placed_and_the_nearest_named() {
    insta::assert_snapshot!(refused("factors = [1, 2, 3]\nholds = []"));
}

#[test]
fn a_missing_key_is_named() {
    insta::assert_snapshot!(refused("center = [0, 0, 0]"));
}

#[test]
fn an_impossible_value_is_placed() {
    insta::assert_snapshot!(refused("factors = [1, -2, 3]"));
}

#[test]
fn an_unknown_operation_is_placed() {
    let job = door_job("").replace("constrained_scale", "constrained_scal");
    let fixture = Fixture::new().sample("door/door.step").file("job.toml", job);
    insta::assert_snapshot!(fixture.run(&["run", "job.toml"]));
}

#[test]
fn a_length_of_an_unknown_unit_is_placed() {
    insta::assert_snapshot!(refused("factors = [1, 2, 3]\ncenter = [\"1 furlong\", 0, 0]"));
}

#[test]
fn a_selector_that_matches_nothing_names_what_there_is() {
    insta::assert_snapshot!(refused("factors = [2, 2, 2]\nface = { name = \"OUTER_SKINN\" }"));
}

#[test]
fn a_surface_that_the_part_lacks_is_refused() {
    insta::assert_snapshot!(refused("factors = [2, 2, 2]\nface = { surface = \"plane\" }"));
}

#[test]
fn json_with_the_same_keys_is_read_and_its_errors_placed() {
    let job = "{\n  \"version\": 1,\n  \"inputs\": [\"door.step\"],\n  \"output\": \"o.step\",\n  \"validte\": {}\n}\n";
    let fixture = Fixture::new().sample("door/door.step").file("job.json", job);
    insta::assert_snapshot!(fixture.run(&["run", "job.json"]));
}

#[test]
fn inputs_that_match_nothing_are_refused() {
    let fixture =
        Fixture::new().sample("door/door.step").file("job.toml", door_job("").replace("door.", "dor."));
    let job = door_job("factors = [1, 1, 1]").replace("door.", "dor.");
    let fixture = fixture.file("job.toml", job);
    insta::assert_snapshot!(fixture.run(&["run", "job.toml"]));
}

#[test]
fn a_required_validator_that_is_missing_ends_with_5_and_writes_nothing() {
    let job = door_job("factors = [1, 1, 1]") + "\n[validate]\nwith = [\"freecad\"]\nrequire = true\n";
    let fixture = Fixture::new()
        .sample("door/door.step")
        .file("job.toml", job)
        .variable("RESURF_FREECADCMD", "/nowhere/freecadcmd");
    insta::assert_snapshot!(fixture.run(&["run", "job.toml"]));
    assert_eq!(fixture.left(), ["door.step", "job.toml"]);
}

#[test]
fn factors_of_one_give_the_same_bytes() {
    let fixture = Fixture::new()
        .sample("door/door.step")
        .file("job.toml", door_job("factors = [1, 1, 1]\nhold = [{ loops = \"inner\" }]"));
    insta::assert_snapshot!(fixture.run(&["run", "job.toml"]));
    let bytes = |name| std::fs::read(fixture.path(name)).expect("a file");
    assert!(bytes("door.step") == bytes("out/door.step"));
}

#[test]
fn a_dry_run_writes_nothing() {
    let fixture = Fixture::new().sample("door/door.step").file("job.toml", door_job("factors = [2, 2, 2]"));
    insta::assert_snapshot!(fixture.run(&["run", "--dry-run", "job.toml"]));
    assert_eq!(fixture.left(), ["door.step", "job.toml"]);
}

#[test]
fn the_same_job_gives_the_same_bytes_and_changes_only_its_records() {
    let job = door_job("factors = [1.1, 1.2, 1.25]\nhold = [{ loops = \"inner\" }]");
    let run = || {
        let fixture = Fixture::new().sample("door/door.step").file("job.toml", &job);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 0\n"), "{said}");
        std::fs::read_to_string(fixture.path("out/door.step")).expect("the output")
    };
    let first = run();
    assert!(first == run());
    // Product structure, colours, layers and units are in lines that stay.
    let input = include_str!("../../samples/door/door.step");
    for word in ["PRODUCT", "COLOUR_RGB", "STYLED_ITEM", "LAYER", "SI_UNIT", "ADVANCED_FACE", "FILE_SCHEMA"] {
        let lines = |text: &str| -> Vec<String> {
            text.lines().filter(|line| line.contains(word)).map(str::to_owned).collect()
        };
        assert!(!lines(input).is_empty(), "the sample has {word}");
        assert_eq!(lines(input), lines(&first), "{word}");
    }
}

/// The door's job with a key, which must be refused with exit code 2 and these words, key and line.
fn says(operation: &str, words: &[&str]) {
    let said = refused(&format!("factors = [1, 2, 3]\n{operation}"));
    assert!(said.starts_with("exit code: 2\n"), "{operation}: {said}");
    for word in words.iter().chain(&["job.toml:"]) {
        assert!(said.contains(word), "{operation}: {word} is not in {said}");
    }
}

#[test]
fn axes_that_are_none_are_refused_by_key() {
    says(
        "axes = [[1, 0, 0], [0, 2, 0], [0, 0, 1]]",
        &["operation[0].axes", "axis 1 (from 0) has the length 2"],
    );
    says("axes = [[1, 0, 0], [0.6, 0.8, 0], [0, 0, 1]]", &["operation[0].axes", "axes 0 and 1", "53.13"]);
    says("axes = [[0, 1, 0], [1, 0, 0], [0, 0, 1]]", &["operation[0].axes", "left-handed"]);
    says("axes = [[nan, 0, 0], [0, 1, 0], [0, 0, 1]]", &["operation[0].axes", "axis 0"]);
    says("axes = []", &["operation[0].axes"]);
}

#[test]
fn lengths_and_factors_that_are_none_are_refused_by_key() {
    for (key, value) in [("factors", "[0, 1, 1]"), ("factors", "[1, inf, 1]"), ("center", "[nan, 0, 0]")] {
        let said = refused(&format!("factors = [1, 1, 1]\n{key} = {value}").replacen(
            if key == "factors" { "factors = [1, 1, 1]\n" } else { "\n\n" },
            "",
            1,
        ));
        assert!(
            said.starts_with("exit code: 2\n") && said.contains(&format!("operation[0].{key}")),
            "{said}"
        );
    }
    for value in ["0", "-1", "\"-1 mm\"", "inf", "\"nan mm\"", "\"1e400 mm\""] {
        let job = format!("{}\n[tolerance]\nlength = {value}\n", door_job("factors = [1, 1, 1]"));
        let fixture = Fixture::new().sample("door/door.step").file("job.toml", job);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 2\n") && said.contains("tolerance.length"), "{value}: {said}");
        assert_eq!(fixture.left(), ["door.step", "job.toml"]);
    }
}

#[test]
fn a_mesh_tolerance_that_does_not_fit_the_part_is_the_jobs_fault() {
    // A tolerance a billion times smaller than the part would fill any memory; one larger than it means nothing.
    for value in ["\"1e-9 mm\"", "1e-300", "\"10 m\"", "1e300"] {
        let job =
            format!("also = [\"stl\"]\n{}\n[tolerance]\nlength = {value}\n", door_job("factors = [1, 1, 1]"));
        let fixture = Fixture::new().sample("door/door.step").file("job.toml", job);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 2\n") && said.contains("`tolerance.length`"), "{value}: {said}");
        assert!(said.contains("expected a length from"), "{said}");
        assert_eq!(fixture.left(), ["door.step", "job.toml"]);
        let value = value.trim_matches('"');
        let said = fixture.run(&["convert", "door.step", "-o", "door.stl", "--tolerance", value]);
        assert!(said.starts_with("exit code: 2\n") && said.contains("`--tolerance`"), "{value}: {said}");
    }
}

#[test]
fn job_files_that_are_none_say_what_they_must_be() {
    let fixture = Fixture::new()
        .sample("door/door.step")
        .file("list.json", "[]")
        .file("number.json", "3")
        .file("blank.json", " \n")
        .file("blank.toml", "")
        .file("folder.d/x", "")
        .file("deep.toml", "version = 1\ninputs = [\"folder.d\"]\noutput = \"o.step\"\n");
    let cases = [
        ("list.json", "expected a table with keys of `version`, `name`, `inputs`"),
        ("list.json", "found a list"),
        ("number.json", "found a number"),
        ("blank.json", "the job file is empty; it needs at least `version`"),
        ("blank.toml", "the job file is empty; it needs at least `version`"),
        ("folder.d", "job file folder.d is a folder"),
        ("deep.toml", "input `folder.d` is a folder; name the files in it, such as `folder.d/*.step`"),
    ];
    for (job, words) in cases {
        let said = fixture.run(&["run", job]);
        assert!(said.starts_with("exit code: 2\n") && said.contains(words), "{job}: {said}");
    }
}

#[test]
fn a_part_converts_to_formats_with_names_and_colours() {
    let fixture = Fixture::new().sample("door/door.step");
    for (name, magic) in [("door.3mf", &b"PK\x03\x04"[..]), ("door.glb", b"glTF"), ("door.stl", b"resurf")] {
        let said = fixture.run(&["convert", "door.step", "-o", name]);
        assert!(said.starts_with("exit code: 0\n"), "{said}");
        let bytes = std::fs::read(fixture.path(name)).expect("written");
        assert!(bytes.starts_with(magic), "{name}");
    }
}

#[test]
fn slips_in_factors_and_patterns_are_told_before_any_part_is_touched() {
    for (key, value) in [
        ("factors = [1e300, 1, 1]", "operation[0].factors"),
        ("factors = [1, 1e-300, 1]", "operation[0].factors"),
        ("factors = [1, 1, 1]\nface = { name = \"[!\" }", "is no pattern of names"),
    ] {
        let job = format!(
            "version = 1\ninputs = [\"door.step\"]\noutput = \"out/{{stem}}.step\"\n\
             [[operation]]\nkind = \"constrained_scale\"\n{key}\n"
        );
        let fixture = Fixture::new().sample("door/door.step").file("job.toml", job);
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 2\n") && said.contains(value), "{key}: {said}");
        assert!(!fixture.path("out").exists(), "{key}");
    }
}
