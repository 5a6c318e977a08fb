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
