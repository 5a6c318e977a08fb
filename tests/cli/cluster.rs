//! The workflow of `samples/cluster`, really run: several jobs, one that is killed, and a restart.
//!
//! Needs `snakemake`, in `PATH` or named by `RESURF_SNAKEMAKE`; without it the test passes over it, unless
//! `RESURF_REQUIRE_VALIDATORS=1`.

use std::path::Path;
use std::process::{Command, Output};

use super::Fixture;

/// In the place of the program: the first three times that the second share is asked for, it is killed with SIGKILL on its
/// way, as by a node that goes away.
const KILLER: &str = r#"#!/bin/sh
case "$*" in
  *"--shard 2/3"*)
    echo x >>kills
    if [ "$(wc -l <kills)" -le 3 ]; then
      PROGRAM "$@" & sleep 0.02; kill -KILL $!; exit 137
    fi ;;
esac
exec PROGRAM "$@"
"#;

fn snakemake(fixture: &Fixture) -> Option<Output> {
    let program = std::env::var_os("RESURF_SNAKEMAKE").unwrap_or_else(|| "snakemake".into());
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/cluster/Snakefile");
    let output = Command::new(program)
        .arg("--snakefile")
        .arg(sample)
        .args([
            "--cores",
            "2",
            "--rerun-incomplete",
            "--config",
            "job=job.toml",
            "shares=3",
            "resurf=./resurf",
        ])
        .current_dir(fixture.path(""))
        .env("HOME", fixture.path(""))
        .output();
    if output.is_err() {
        let required = std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_some_and(|value| value == "1");
        assert!(!required, "snakemake: {output:?}");
    }
    output.ok()
}

#[test]
fn a_workflow_goes_on_after_a_job_was_killed() {
    use std::os::unix::fs::PermissionsExt;
    let door = include_str!("../../samples/door/door.step");
    let job = "version = 1\ninputs = [\"parts/*.step\"]\noutput = \"out/{stem}.step\"\n";
    let part =
        |n: usize| door.replacen("ISO-10303-21;", &format!("ISO-10303-21;/*{n}*/"), 1) + &" ".repeat(n);
    let fixture =
        (0..6).fold(Fixture::new().file("job.toml", job), |f, n| f.file(&format!("parts/{n}.step"), part(n)));
    let program = assert_cmd::cargo::cargo_bin!("resurf").display().to_string();
    let fixture = fixture.file("resurf", KILLER.replace("PROGRAM", &program));
    std::fs::set_permissions(fixture.path("resurf"), std::fs::Permissions::from_mode(0o755))
        .expect("a script");

    let Some(first) = snakemake(&fixture) else { return };
    let said = String::from_utf8_lossy(&first.stderr).into_owned();
    assert!(!first.status.success() && !fixture.path("report.json").exists(), "{said}");
    for n in 0..6 {
        let written = std::fs::read_to_string(fixture.path(&format!("out/{n}.step")));
        assert!(written.is_err() || written.is_ok_and(|text| text == part(n)), "{n} is not whole");
    }
    let second = snakemake(&fixture).expect("it was there before");
    assert!(second.status.success(), "{}", String::from_utf8_lossy(&second.stderr));
    let text = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((report["code"].as_u64(), report["parts"].as_array().map(Vec::len)), (Some(0), Some(6)));
    for n in 0..6 {
        assert_eq!(
            std::fs::read_to_string(fixture.path(&format!("out/{n}.step"))).expect("an output"),
            part(n)
        );
    }
    // Three attempts of the first run and one of the second.
    assert_eq!(std::fs::read_to_string(fixture.path("kills")).expect("a count").lines().count(), 4);
}
