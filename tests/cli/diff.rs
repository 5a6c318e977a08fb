//! What `diff` says of parts that are the same, of parts that an operation changed, and of parts that were moved.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use super::Fixture;

fn sample(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name))
        .expect("a sample")
}

/// The JSON of `diff` and the exit code.
fn diff(fixture: &Fixture, arguments: &[&str]) -> (Value, i32) {
    let said = fixture.run(&[&["diff", "--json"], arguments].concat());
    let code = said.lines().next().and_then(|line| line.rsplit(' ').next()?.parse().ok()).expect("a code");
    let json = said.split("--- stdout\n").nth(1).and_then(|rest| rest.split("--- stderr").next());
    (serde_json::from_str(json.expect("standard output")).unwrap_or_else(|e| panic!("{e}: {said}")), code)
}

/// Records of a file: name, and text without comments.
fn records(text: &str) -> BTreeMap<u64, String> {
    let data = text.split_once("DATA;").expect("a data section").1;
    let (mut records, mut record, mut quoted) = (BTreeMap::new(), String::new(), false);
    for letter in data.chars().filter(|c| !c.is_control()) {
        quoted ^= letter == '\'';
        if letter != ';' || quoted {
            record.push(letter);
            continue;
        }
        if let Some((name, rest)) = record.trim().strip_prefix('#').and_then(|rest| rest.split_once('=')) {
            records.insert(name.trim().parse().expect("an instance name"), rest.trim().to_owned());
        }
        record.clear();
    }
    records
}

/// A record with all that it refers to written out, names of records and curves in parameters left away: an independent
/// idea of what the shape of a face is.
fn written_out(records: &BTreeMap<u64, String>, name: u64, known: &mut BTreeMap<u64, String>) -> String {
    if let Some(known) = known.get(&name) {
        return known.clone();
    }
    let record = records.get(&name).map(String::as_str).unwrap_or_default();
    let mut out = String::new();
    if !record.starts_with("PCURVE") {
        let (mut rest, mut quoted) = (record, false);
        while let Some(letter) = rest.chars().next() {
            quoted ^= letter == '\'';
            let digits = rest[1..].chars().take_while(char::is_ascii_digit).count();
            if letter == '#' && !quoted && digits > 0 {
                out += &written_out(records, rest[1..=digits].parse().expect("a number"), known);
                rest = &rest[digits + 1..];
            } else {
                out.push(letter);
                rest = &rest[letter.len_utf8()..];
            }
        }
    }
    known.insert(name, out.clone());
    out
}

/// Faces of both texts whose records do not say the same.
fn faces_that_differ(before: &str, after: &str) -> BTreeSet<String> {
    let (before, after) = (records(before), records(after));
    let (mut known_before, mut known_after) = (BTreeMap::new(), BTreeMap::new());
    let mut differ = BTreeSet::new();
    for (name, _) in before.iter().filter(|(_, record)| record.starts_with("ADVANCED_FACE")) {
        let was = written_out(&before, *name, &mut known_before);
        if was != written_out(&after, *name, &mut known_after) {
            differ.insert(format!("#{name}"));
        }
    }
    differ
}

/// A job of `samples/` and the part of it that is compared, without their common folder.
struct Golden {
    job: &'static str,
    input: &'static str,
    output: &'static str,
    /// Files that the job reads beside the part.
    others: &'static [&'static str],
}

const FEATURES: &[&str] = &["features/symbol.step", "features/bump.step", "features/groove.step"];

/// Every sample job that changes faces.
const GOLDEN: [Golden; 10] = [
    Golden {
        job: "door/job.toml",
        input: "door/door.step",
        output: "door/out/door-scaled.step",
        others: &[],
    },
    Golden {
        job: "hood/job.toml",
        input: "hood/hood.step",
        output: "hood/out/hood-scaled.step",
        others: &[],
    },
    Golden {
        job: "trunk/job.toml",
        input: "trunk/trunk.step",
        output: "trunk/out/trunk-scaled.step",
        others: &[],
    },
    Golden {
        job: "door-solid/job.toml",
        input: "door-solid/door-solid.step",
        output: "door-solid/out/door-solid-scaled.step",
        others: &[],
    },
    Golden {
        job: "assembly/job.toml",
        input: "assembly/assembly.step",
        output: "assembly/out/assembly-scaled.step",
        others: &[],
    },
    Golden {
        job: "plate/job.toml",
        input: "plate/plate.step",
        output: "plate/out/plate-marked.step",
        others: FEATURES,
    },
    Golden {
        job: "vamp/job.toml",
        input: "vamp/vamp.step",
        output: "vamp/out/vamp-marked.step",
        others: FEATURES,
    },
    Golden {
        job: "vase/job.toml",
        input: "vase/vase.step",
        output: "vase/out/vase-bumps.step",
        others: FEATURES,
    },
    Golden {
        job: "vase/rim.toml",
        input: "vase/vase.step",
        output: "vase/out/vase-rim.step",
        others: &["curves/sources.step"],
    },
    Golden {
        job: "crease/job.toml",
        input: "door-solid/door-solid.step",
        output: "crease/out/door-with-crease.step",
        others: &["crease/lines.step"],
    },
];

/// Runs a job without its validators, and holds that `diff` names just the faces whose records differ.
fn names_what_a_job_changed(golden: &Golden) {
    let Golden { job: name, input, output, .. } = *golden;
    let job = name;
    let mut text = sample(job);
    if let Some(start) = text.find("[validate]") {
        let end = text[start..].find("\n[[").map_or(text.len(), |end| start + end);
        text.replace_range(start..end, "");
    }
    let parts = golden.others.iter().chain([&golden.input]);
    let fixture = parts.fold(Fixture::new(), |f, part| f.file(part, sample(part)));
    let fixture = fixture.file(name, text);
    let said = fixture.run(&["run", name]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    let read = |name: &str| std::fs::read_to_string(fixture.path(name)).expect("a part");
    let expected = faces_that_differ(&read(input), &read(output));
    let (difference, code) = diff(&fixture, &[input, output, "--only", "geometry"]);
    assert!(!expected.is_empty() && code == 1, "{job}: {difference:#}");
    let mut named = BTreeSet::new();
    for change in difference["changes"].as_array().expect("changes") {
        let [before, after] =
            ["before", "after"].map(|side| change[side]["id"].as_str().expect("both sides"));
        assert_eq!(before, after, "{job}: {change:#}");
        let sampled = change["sampled"]["distance"].as_f64().expect("a distance");
        assert!(sampled > 0.0, "{job}: {change:#}");
        if let Some(certified) = change["certified"].as_f64() {
            // What is found includes the way back, from the first face to the second.
            assert!(certified >= 0.0 && certified.is_finite(), "{job}: {change:#}");
        }
        named.insert(before.to_owned());
    }
    assert_eq!(named, expected, "{job}");
}

#[test]
fn faces_that_jobs_changed_are_named_and_no_others() {
    GOLDEN.iter().for_each(names_what_a_job_changed);
}

#[test]
fn a_part_does_not_differ_from_itself() {
    for name in ["assembly/assembly.step", "plate/plate.step", "curves/sources.step"] {
        let fixture = Fixture::new().sample(name);
        let part = Path::new(name).file_name().expect("a name").to_string_lossy().into_owned();
        let (difference, code) = diff(&fixture, &[&part, &part]);
        assert!(code == 0 && difference["equal"] == true, "{name}: {difference:#}");
        assert_eq!(difference["faces"]["identical"], difference["faces"]["before"]);
    }
}

#[test]
fn other_names_and_colours_are_told_and_are_no_geometry() {
    let text = sample("plate/plate.step");
    let renamed = text.replace("'TOP'", "'LID'");
    assert_ne!(text, renamed);
    let fixture = Fixture::new().file("a.step", &text).file("b.step", renamed);
    let (difference, code) = diff(&fixture, &["a.step", "b.step"]);
    assert_eq!(code, 1);
    let structure = difference["structure"].as_array().expect("a list");
    assert_eq!(structure.len(), 1, "{difference:#}");
    assert_eq!(structure[0]["what"], "name");
    let message = structure[0]["message"].as_str().expect("a text");
    assert!(message.contains("`TOP` before, `LID` after"), "{message}");
    assert_eq!(diff(&fixture, &["a.step", "b.step", "--only", "geometry"]).1, 0);
}

#[test]
fn what_was_moved_is_told_with_its_shift() {
    // The placement of the bracket in the assembly, read from the file itself, goes 2.5 further along x.
    let text = sample("assembly/assembly.step");
    let fixture = Fixture::new().file("a.step", &text);
    let inspected = fixture.run(&["inspect", "a.step", "--json"]);
    let json = inspected.split("--- stdout\n").nth(1).and_then(|rest| rest.split("--- stderr").next());
    let tree: Value = serde_json::from_str(json.expect("standard output")).expect("JSON");
    let node = tree["tree"].as_array().expect("a tree").iter().find(|node| node["product"] == "bracket");
    let [x, y, z] =
        [0, 1, 2].map(|k| node.expect("a bracket")["placement"][3][k].as_f64().expect("a number"));
    let point = records(&text).into_iter().find(|(_, record)| {
        record.strip_prefix("CARTESIAN_POINT('',(").is_some_and(|rest| {
            let numbers: Vec<f64> =
                rest.trim_end_matches(')').split(',').filter_map(|n| n.parse().ok()).collect();
            numbers == [x, y, z]
        })
    });
    let (name, record) = point.expect("the point of the placement");
    let line = |record: &str| format!("#{name}={record};");
    assert!(text.contains(&line(&record)));
    let moved =
        text.replace(&line(&record), &line(&format!("CARTESIAN_POINT('',({:?},{y:?},{z:?}))", x + 2.5)));
    let fixture = fixture.file("b.step", moved);
    let (difference, code) = diff(&fixture, &["a.step", "b.step"]);
    assert_eq!(code, 1);
    let changes = difference["changes"].as_array().expect("changes");
    assert_eq!(changes.len(), 6, "{difference:#}");
    for change in changes {
        assert_eq!(change["change"], "moved", "{change:#}");
        let shift = [0, 1, 2].map(|k| change["motion"]["shift"][k].as_f64().expect("a number"));
        let error = [shift[0] - 2.5, shift[1], shift[2]].into_iter().map(f64::abs).fold(0.0, f64::max);
        assert!(error < 1e-9, "{shift:?}");
    }
}

#[test]
fn a_lifted_control_point_lifts_the_surface_by_less_and_the_proof_lies_between() {
    let text = sample("door/door.step");
    let (fixture, all) = (Fixture::new().file("a.step", &text), records(&text));
    let net = all.values().find(|record| record.contains("B_SPLINE_SURFACE")).expect("a net");
    let used: BTreeSet<u64> = net
        .split('#')
        .skip(1)
        .filter_map(|rest| rest.chars().take_while(char::is_ascii_digit).collect::<String>().parse().ok())
        .collect();
    let middle = *used.iter().nth(used.len() / 2).expect("control points");
    let record = &all[&middle];
    let numbers: Vec<f64> = record
        .trim_start_matches("CARTESIAN_POINT('',(")
        .trim_end_matches(')')
        .split(',')
        .filter_map(|number| number.parse().ok())
        .collect();
    let [x, y, z] = numbers[..] else { panic!("{record}") };
    let lifted = format!("CARTESIAN_POINT('',({x:?},{y:?},{:?}))", z + 0.5);
    let fixture = fixture
        .file("b.step", text.replace(&format!("#{middle}={record};"), &format!("#{middle}={lifted};")));
    let (difference, _) = diff(&fixture, &["a.step", "b.step", "--only", "geometry"]);
    let change = &difference["changes"][0];
    assert_eq!(change["change"], "changed", "{difference:#}");
    let [sampled, certified] =
        [&change["sampled"]["distance"], &change["certified"]].map(|v| v.as_f64().expect("a number"));
    // The surface moves by the point's basis function, whose peak is between the square of 4/9 and 1 for cubics.
    assert!(sampled > 0.5 * 0.19 && sampled <= certified * (1.0 + 1e-9), "{sampled} and {certified}");
    assert!(certified <= 0.5 * 1.06, "{certified}");
}

/// Parts written again by Open CASCADE (OCP 8): other records, other order, other digits, the same geometry. Needs a Python
/// with OCP, in `PATH` or named by `RESURF_OCC_PYTHON`; silent without one, unless `RESURF_REQUIRE_OCC=1`.
#[test]
fn what_open_cascade_writes_again_has_the_same_geometry() {
    use std::process::Command;
    let python = std::env::var_os("RESURF_OCC_PYTHON").unwrap_or_else(|| "python3".into());
    let can =
        Command::new(&python).args(["-c", "import OCP"]).output().is_ok_and(|output| output.status.success());
    let required = std::env::var_os("RESURF_REQUIRE_OCC").is_some_and(|value| value == "1");
    assert!(can || !required, "no OCP");
    if !can {
        return;
    }
    let samples = ["assembly/assembly.step", "wheel/wheel.step", "vamp/vamp.step", "wheel/cone.step"];
    let fixture = samples.iter().fold(Fixture::new(), |f, name| f.sample(name));
    let names: Vec<&str> = samples.iter().filter_map(|name| name.rsplit('/').next()).collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/reexport.py");
    let pairs = names.iter().flat_map(|name| [(*name).to_owned(), format!("again-{name}")]);
    let output =
        Command::new(python).arg(script).args(pairs).current_dir(fixture.path("")).output().expect("python");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in names {
        let (difference, code) = diff(&fixture, &[name, &format!("again-{name}"), "--only", "geometry"]);
        assert_eq!(code, 0, "{name}: {difference:#}");
        assert!(difference["faces"]["same"].as_u64() > Some(0), "{name}: nothing was written in another way");
    }
}

#[test]
fn faces_turned_inside_out_are_no_equal_part() {
    let before = sample("door-solid/door-solid.step");
    let turned: String = before
        .split_inclusive('\n')
        .map(|line| {
            if line.contains("=ADVANCED_FACE(") { line.replace(",.T.);", ",.F.);") } else { line.to_owned() }
        })
        .collect();
    assert_ne!(before, turned);
    let fixture = Fixture::new().file("a.step", before).file("b.step", turned);
    let (difference, code) = diff(&fixture, &["a.step", "b.step"]);
    assert_eq!((code, &difference["equal"]), (1, &Value::Bool(false)), "{difference:#}");
    let told = difference["structure"].as_array().expect("a list");
    assert!(told.iter().any(|change| change["what"] == "outer side"), "{difference:#}");
}
