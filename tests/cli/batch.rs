//! Runs over many parts: what dies, what is passed over, what is left behind.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::Fixture;

const DOOR: &str = include_str!("../../samples/door/door.step");

/// The door with a word in a comment, for a validator that acts on it.
pub fn door(word: &str) -> String {
    DOOR.replacen("ISO-10303-21;", &format!("ISO-10303-21;/*{word}*/"), 1)
}

/// A program in the place of FreeCAD that reads the word: it ends the worker that asks it, stops it for ever, refuses
/// the part or accepts it.
pub const JUDGE: &str = r#"#!/bin/sh
case "$(head -c 40 "$RESURF_PART")" in
  *crash*) kill -ABRT $PPID ;;
  *hang*) kill -STOP $PPID; sleep 100 ;;
  *refused*) printf '{"read":true,"messages":["the shell is open"],"solids":1,"faces":1,"edges":4,"valid":false}' >"$RESURF_SENTINEL" ;;
  *) printf '{"read":true,"messages":[],"solids":1,"faces":1,"edges":4,"valid":true}' >"$RESURF_SENTINEL" ;;
esac
"#;

pub fn executable(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).expect("a script");
}

/// A packed part that is a few kilobytes on the disk and half a gigabyte in memory.
fn bomb() -> Vec<u8> {
    use std::io::Write;
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let mut state = 1;
    for _ in 0..500 {
        // Not too blank: what unfolds to two hundred times its size is refused for that.
        let block: Vec<u8> =
            (0..1 << 20).map(|at| if at % 64 == 0 { random(&mut state) as u8 } else { b' ' }).collect();
        packed.write_all(&block).expect("into memory");
    }
    packed.finish().expect("into memory")
}

fn json(fixture: &Fixture, name: &str) -> serde_json::Value {
    let text = std::fs::read_to_string(fixture.path(name)).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

/// Code and word of the failure of each part, by the stem of its name.
fn outcomes(report: &serde_json::Value) -> Vec<(String, u64, String)> {
    let parts = report["parts"].as_array().expect("parts");
    let word = |part: &serde_json::Value| part["failure"]["code"].as_str().unwrap_or("").to_owned();
    let stem = |part: &serde_json::Value| {
        let input = Path::new(part["input"].as_str().expect("an input"));
        input.file_stem().expect("a name").to_string_lossy().into_owned()
    };
    parts.iter().map(|part| (stem(part), part["code"].as_u64().expect("a code"), word(part))).collect()
}

const PASS: &str = "version = 1\ninputs = [\"parts/*.st*\"]\noutput = \"out/{stem}.step\"\n";

#[test]
fn what_kills_a_worker_is_one_line_in_the_report() {
    let job = format!("{PASS}[validate]\nwith = [\"freecad\"]\nrequire = true\n");
    let fixture = Fixture::new().file("job.toml", job).file("judge", JUDGE).file("parts/bomb.stpz", bomb());
    let fixture = ["crash", "fine", "hang", "refused"]
        .into_iter()
        .fold(fixture, |f, word| f.file(&format!("parts/{word}.step"), door(word)))
        .file("parts/cut.step", &DOOR[..DOOR.len() / 2]);
    executable(&fixture.path("judge"));
    let judge = fixture.path("judge");
    let fixture = fixture.variable("RESURF_FREECADCMD", &judge.to_string_lossy());
    let run =
        ["run", "job.toml", "--report", "r.json", "--timeout", "6", "--memory", "300 MB", "--jobs", "2"];
    let said = fixture.run(&run);
    let expected = [
        ("bomb", 6, "resource.memory"),
        ("crash", 70, "internal.crash"),
        ("cut", 3, "document.damaged"),
        ("fine", 0, ""),
        ("hang", 6, "resource.time"),
        ("refused", 1, "validate.refused"),
    ];
    let expected = expected.map(|(stem, code, word)| (stem.to_owned(), code, word.to_owned()));
    assert_eq!(outcomes(&json(&fixture, "r.json")), expected, "{said}");
    // More memory or time may help two of them: that is what the scheduler is told.
    assert!(said.starts_with("exit code: 6\n"), "{said}");
    assert!(said.contains("stopped after 6 s while writing and validating"), "{said}");
    let outputs: Vec<String> = fixture.left().into_iter().filter(|name| name.starts_with("out/")).collect();
    // Remembered are the part that is done and those that would fail again.
    let records = ["cut", "fine", "refused"].map(|stem| format!("out/.resurf/{stem}.step.json"));
    let expected: Vec<String> = records.into_iter().chain(["out/fine.step".to_owned()]).collect();
    assert_eq!(outputs, expected);
}

#[test]
fn a_second_run_does_only_what_has_changed() {
    let fixture =
        Fixture::new().file("job.toml", PASS).file("parts/a.step", door("a")).file("parts/b.step", door("b"));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.contains("2 parts: 2 done, 0 failed\n"), "{said}");
    let said = fixture.run(&["run", "job.toml", "--report", "r.json"]);
    assert!(said.starts_with("exit code: 0\n") && said.contains("nothing was done"), "{said}");
    assert!(json(&fixture, "r.json")["parts"][0]["unchanged"] == true);

    // An input, an output, the job: each has its parts done again.
    std::fs::write(fixture.path("parts/a.step"), door("c")).expect("written");
    assert!(fixture.run(&["run", "job.toml"]).contains("1 unchanged since the last run"));
    assert_eq!(std::fs::read_to_string(fixture.path("out/a.step")).expect("an output"), door("c"));
    std::fs::write(fixture.path("out/b.step"), "by another hand").expect("written");
    assert!(fixture.run(&["run", "job.toml"]).contains("1 unchanged since the last run"));
    assert_eq!(std::fs::read_to_string(fixture.path("out/b.step")).expect("an output"), door("b"));
    std::fs::write(fixture.path("job.toml"), format!("name = \"x\"\n{PASS}")).expect("written");
    assert!(!fixture.run(&["run", "job.toml"]).contains("since the last run"));
    assert!(!fixture.run(&["run", "job.toml", "--fresh"]).contains("since the last run"));
    // A record that is garbage is none.
    std::fs::write(fixture.path("out/.resurf/a.step.json"), "{").expect("written");
    assert!(fixture.run(&["run", "job.toml"]).contains("1 unchanged since the last run"));
}

#[test]
fn one_worker_and_two_give_the_same_bytes() {
    let job = "version = 1\ninputs = [\"*.step\"]\noutput = \"out/{stem}.{ext}\"\nalso = [\"stl\"]\n\
        [[operation]]\nkind = \"constrained_scale\"\nfactors = [1.1, 1.2, 1.25]\n";
    let run = |jobs: &str| {
        let fixture = Fixture::new().file("job.toml", job);
        let fixture =
            ["door/door.step", "hood/hood.step", "trunk/trunk.step"].iter().fold(fixture, |f, s| f.sample(s));
        let said = fixture.run(&["run", "job.toml", "--jobs", jobs]);
        assert!(said.starts_with("exit code: 0\n"), "{said}");
        let outputs =
            fixture.left().into_iter().filter(|name| name.starts_with("out/") && !name.contains(".resurf"));
        outputs.map(|name| (std::fs::read(fixture.path(&name)).expect("an output"), name)).collect::<Vec<_>>()
    };
    let one = run("1");
    assert_eq!(one.len(), 6);
    assert!(one == run("2"));
}

#[test]
fn shares_cover_the_parts_and_merge_into_one_report() {
    let fixture = Fixture::new().file("job.toml", PASS);
    let fixture = ["a", "b", "c", "d"]
        .iter()
        .fold(fixture, |f, name| f.file(&format!("parts/{name}.step"), door(name)));
    let run =
        |share: &str, report: &str| fixture.run(&["run", "job.toml", "--shard", share, "--report", report]);
    assert!(run("1/2", "1.json").starts_with("exit code: 0\n"));
    assert!(run("2/2", "2.json").starts_with("exit code: 0\n"));
    let outputs =
        fixture.left().into_iter().filter(|name| name.starts_with("out/") && !name.contains(".resurf"));
    assert_eq!(outputs.count(), 4);
    let [one, two] = ["1.json", "2.json"].map(|name| outcomes(&json(&fixture, name)));
    assert_eq!((one.len(), two.len()), (2, 2));

    let said = fixture.run(&["report", "merge", "2.json", "1.json", "-o", "all.json", "--junit", "all.xml"]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    assert_eq!(outcomes(&json(&fixture, "all.json")).len(), 4);
    let junit = std::fs::read_to_string(fixture.path("all.xml")).expect("written");
    assert!(junit.contains("tests=\"4\" failures=\"0\" errors=\"0\""), "{junit}");
    for (reports, words) in [
        (&["1.json"][..], "the reports of shares 2 of 2 are missing"),
        (&["1.json", "1.json"], "share 1 stands in two reports"),
    ] {
        let said = fixture.run(&[&["report", "merge"], reports].concat());
        assert!(said.starts_with("exit code: 2\n") && said.contains(words), "{said}");
    }
    let said = run("auto/2", "3.json");
    assert!(said.starts_with("exit code: 2\n") && said.contains("JOB_COMPLETION_INDEX"), "{said}");
    let fixture = fixture.variable("JOB_COMPLETION_INDEX", "1");
    assert!(
        fixture
            .run(&["run", "job.toml", "--shard", "auto/2", "--report", "3.json"])
            .contains("nothing was done")
    );
    assert_eq!(outcomes(&json(&fixture, "3.json")), two);
}

#[test]
fn a_disk_that_is_full_and_a_folder_that_cannot_be_are_told_and_leave_nothing() {
    let fixture = Fixture::new().file("job.toml", PASS).file("parts/a.step", door("a"));
    // No file may grow beyond a few blocks, and the signal that would tell of it is ignored: what a full disk is like.
    let program = assert_cmd::cargo::cargo_bin!("resurf");
    let script = format!("trap '' XFSZ; ulimit -f 16; exec {} run job.toml", program.display());
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(fixture.path("")).output().expect("a shell");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(7), "{said}");
    assert!(said.contains("the output cannot be written: out/a.step: File too large"), "{said}");
    assert_eq!(fixture.left(), ["job.toml", "parts/a.step"]);

    let fixture = fixture.file("out", "a file in the place of the folder");
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 7\n") && said.contains("out/a.step: "), "{said}");
    assert_eq!(fixture.left(), ["job.toml", "out", "parts/a.step"]);
}

#[test]
fn an_interrupted_run_ends_at_once_and_goes_on_later() {
    let job = format!("{PASS}[validate]\nwith = [\"freecad\"]\nrequire = true\n");
    let fixture = Fixture::new()
        .file("job.toml", job)
        .file("judge", JUDGE)
        .file("parts/a.step", door("fine"))
        .file("parts/b.step", door("hang") + &" ".repeat(9));
    executable(&fixture.path("judge"));
    let program = assert_cmd::cargo::cargo_bin!("resurf");
    let mut child = Command::new(program)
        .args(["run", "job.toml", "--jobs", "2", "--report", "r.json", "--timeout", "90"])
        .current_dir(fixture.path(""))
        .env("RESURF_FREECADCMD", fixture.path("judge"))
        // The date is an input as well.
        .env("SOURCE_DATE_EPOCH", "0")
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let begin = Instant::now();
    while !fixture.path("out/.resurf/a.step.json").exists() {
        assert!(begin.elapsed() < Duration::from_secs(60), "the first part is not done");
        std::thread::sleep(Duration::from_millis(20));
    }
    let process = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(process, rustix::process::Signal::INT).expect("it is there");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    let expected =
        [("a", 0, ""), ("b", 130, "run.interrupted")].map(|(s, c, w)| (s.to_owned(), c, w.to_owned()));
    assert_eq!(outcomes(&json(&fixture, "r.json")), expected);
    assert!(!fixture.left().iter().any(|name| name.contains("/.resurf-")), "{:?}", fixture.left());

    std::fs::write(fixture.path("parts/b.step"), door("fine")).expect("written");
    let judge = fixture.path("judge").to_string_lossy().into_owned();
    let said = fixture.variable("RESURF_FREECADCMD", &judge).run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0\n") && said.contains("1 unchanged"), "{said}");
}

/// Numbers that look random and are the same on every run.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *state >> 33
}

#[test]
fn a_run_that_is_killed_at_any_moment_leaves_whole_files_only() {
    let parts = ["a", "b", "c", "d"];
    let content = |name: &str| door(name) + &"/* as long as a real part */\n".repeat(20_000);
    let fixture = parts.iter().fold(Fixture::new().file("job.toml", PASS), |f, name| {
        f.file(&format!("parts/{name}.step"), content(name))
    });
    let program = assert_cmd::cargo::cargo_bin!("resurf");
    let whole = |must: bool| {
        for name in parts {
            match std::fs::read_to_string(fixture.path(&format!("out/{name}.step"))) {
                Ok(text) => assert!(text == content(name), "{name} is not whole"),
                Err(error) => assert!(!must, "{name}: {error}"),
            }
        }
    };
    let begin = Instant::now();
    assert!(fixture.run(&["run", "job.toml"]).starts_with("exit code: 0\n"));
    let whole_run = begin.elapsed().as_micros() as u64;
    let mut state = 9;
    for round in 0..200 {
        if round % 4 == 0 {
            let _ = std::fs::remove_dir_all(fixture.path("out"));
        }
        let mut child = Command::new(program)
            .args(["run", "job.toml", "--fresh"])
            .current_dir(fixture.path(""))
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        std::thread::sleep(Duration::from_micros(random(&mut state) % (whole_run + 1000)));
        // Fails when it came to its end before: that is a moment too.
        let _ = child.kill();
        let _ = child.wait();
        whole(false);
    }
    // Workers of the last run end by themselves, soon after it.
    std::thread::sleep(Duration::from_millis(200));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    whole(true);
    let left = fixture.left();
    assert!(!left.iter().any(|name| name.contains(".resurf-")), "left behind: {left:?}");
}

/// The whole corpus as one run, where it is there.
#[test]
fn every_part_of_the_corpus_comes_through_or_is_a_named_failure() {
    let files = super::support::corpus_files(super::support::STEP);
    if files.is_empty() {
        return;
    }
    let inputs: Vec<String> = files.iter().map(|path| format!("{:?}", path.to_string_lossy())).collect();
    let job = |output: &str| {
        format!("version = 1\ninputs = [{}]\noutput = \"{output}/{{stem}}-{{ext}}.stp\"\n", inputs.join(", "))
    };
    let fixture = Fixture::new();
    let run = |jobs: &str, report: &str| {
        fixture.run(&["run", &format!("job-{jobs}.toml"), "--jobs", jobs, "--report", report])
    };
    for jobs in ["1", "2"] {
        std::fs::write(fixture.path(&format!("job-{jobs}.toml")), job(&format!("out-{jobs}")))
            .expect("written");
        let said = run(jobs, "first.json");
        let report = json(&fixture, "first.json");
        assert_eq!(outcomes(&report).len(), files.len(), "{said}");
        for (stem, code, word) in outcomes(&report) {
            assert!((code == 0) == word.is_empty() && code != 70, "{stem}: {code} {word}");
        }
        assert!(said.starts_with("exit code: 1\n"), "some of the odd files are damaged: {said}");
        let said = run(jobs, "second.json");
        assert!(said.starts_with("exit code: 1\n") && said.contains("nothing was done"), "{said}");
        assert_eq!(outcomes(&json(&fixture, "second.json")), outcomes(&report));
    }
    let written = |jobs: &str| {
        let prefix = format!("out-{jobs}/");
        let names = fixture
            .left()
            .into_iter()
            .filter(|name| name.starts_with(&prefix) && !name.contains("/.resurf/"));
        names
            .map(|name| {
                (name[prefix.len()..].to_owned(), std::fs::read(fixture.path(&name)).expect("an output"))
            })
            .collect::<Vec<_>>()
    };
    assert!(written("1") == written("2") && written("1").len() > files.len() / 2);
}

#[test]
fn a_report_over_a_file_of_the_run_is_refused() {
    let job = "version = 1\ninputs = [\"a.step\"]\noutput = \"out/a.step\"\n";
    let door = include_str!("../../samples/door/door.step");
    let fixture = Fixture::new().file("a.step", door).file("job.toml", job);
    for words in [["--report", "a.step"], ["--junit", "job.toml"], ["--html", "out/a.step"]] {
        let said = fixture.run(&["run", "job.toml", words[0], words[1]]);
        assert!(said.starts_with("exit code: 2\n") && said.contains("another file of the run"), "{said}");
    }
    let said = fixture.run(&["run", "job.toml", "--report", "r", "--junit", "r"]);
    assert!(said.starts_with("exit code: 2\n"), "{said}");
    assert_eq!(std::fs::read_to_string(fixture.path("a.step")).expect("the part"), door);
    assert!(!fixture.path("out").exists());
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_a_part_that_fails_by_its_name() {
    let job = "version = 1\ninputs = [\"*.step\"]\noutput = \"out/{stem}.step\"\n";
    let door = include_str!("../../samples/door/door.step");
    let fixture = Fixture::new().file("a.step", door).file("job.toml", job);
    std::os::unix::fs::symlink("nowhere.step", fixture.path("b.step")).expect("a link");
    let said = fixture.run(&["run", "job.toml"]);
    assert!(!said.starts_with("exit code: 0\n") && said.contains("b.step"), "{said}");
    assert!(fixture.path("out/a.step").exists());
}

#[test]
fn shares_that_cannot_be_are_not_merged() {
    let job = "version = 1\ninputs = [\"a.step\"]\noutput = \"out/a.step\"\n";
    let door = include_str!("../../samples/door/door.step");
    let fixture = Fixture::new().file("a.step", door).file("job.toml", job);
    fixture.run(&["run", "job.toml", "--shard", "1/1", "--report", "1.json"]);
    let report = std::fs::read_to_string(fixture.path("1.json")).expect("a report");
    for (index, count) in [("0", "1"), ("9", "1"), ("1", "1000000000000")] {
        let other = report.replace("\"index\": 1", &format!("\"index\": {index}"));
        let other = other.replace("\"count\": 1", &format!("\"count\": {count}"));
        std::fs::write(fixture.path("2.json"), other).expect("a file");
        let said = fixture.run(&["report", "merge", "2.json"]);
        assert!(said.starts_with("exit code: 2\n"), "{index} of {count}: {said}");
    }
}

#[test]
fn a_share_of_one_bad_part_is_a_share_with_a_failed_part() {
    let job = "version = 1\ninputs = [\"*.step\"]\noutput = \"out/{stem}.step\"\n";
    let fixture = Fixture::new().file("a.step", &DOOR[..DOOR.len() / 2]).file("job.toml", job);
    let said = fixture.run(&["run", "job.toml", "--shard", "1/1"]);
    assert!(said.starts_with("exit code: 1\n"), "{said}");
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 3\n"), "{said}");
}

#[test]
fn the_page_of_a_part_is_its_own_when_its_place_among_the_parts_has_changed() {
    let job = "version = 1\ninputs = [\"*/x.step\"]\noutput = \"{dir}/out/x.step\"\n";
    let plate = include_str!("../../samples/plate/plate.step");
    let fixture = Fixture::new()
        .file("a/x.step", plate)
        .file("b/x.step", DOOR)
        .file("job.toml", job.replace("*/", "?/"));
    let run = || {
        let said = fixture.run(&["run", "job.toml", "--html", "r.html"]);
        assert!(said.starts_with("exit code: 0\n"), "{said}");
    };
    run();
    let page =
        |number: &str| std::fs::read(fixture.path(&format!("r-parts/{number}-x.html"))).expect("a page");
    let (plate_page, door_page) = (page("0001"), page("0002"));
    assert_ne!(plate_page, door_page);
    std::fs::remove_dir_all(fixture.path("a")).expect("a folder");
    run();
    assert_eq!(page("0001").len(), door_page.len());
}
