//! Parts of the corpus from eight systems, scaled with features held, as Open CASCADE finds them: valid, closed, with every
//! face, and of the volume and centroid that the plain scaling and the held cylinders together must give.

use std::process::Command;

use serde_json::Value;

use super::{python, root, support};

/// Factors of all runs: three different ones, so that what is not held does not stay a cylinder by chance.
const FACTORS: [f64; 3] = [1.1, 1.2, 1.25];

/// What must come out.
#[derive(Debug, Clone, Copy)]
enum Expect {
    /// Only full turns of cylinders between planes are held: the volume follows from them, within this part of it, and
    /// centroids and the areas of all other faces with it.
    Cylinders(f64),
    /// Cones, fillets, slots or skins change as well: volume and centroid within this part only.
    About(f64),
}

use Expect::{About, Cylinders};

/// Rounding where planes and cylinders are exact in both programs.
const EXACT: f64 = 1e-7;
/// Where Open CASCADE bounds freeform faces by curves that it fits.
const FITTED: f64 = 2e-5;
/// Part of the root of the area within which centroids agree.
const CENTROID: f64 = 1e-4;
/// Part of the area that all faces without anything held may differ by from their affine images.
const AREAS: f64 = 2e-4;

const INNER: &str = "hold = [{ loops = \"inner\" }]";
const SLID: &str = "wall = \"slide\"\nhold = [{ loops = \"inner\" }]";

fn on(face: &str) -> String {
    format!("hold = [{{ loops = \"inner\", on = \"{face}\" }}]")
}

fn wall(face: &str) -> String {
    format!("hold = [{{ face = \"{face}\" }}]")
}

/// Parts, each with its holds and what must come out.
fn parts() -> Vec<(&'static str, [(String, Expect); 3])> {
    let inner = || INNER.to_owned();
    let hood = "Amazing Hand Parts - R-Top_Shell.step";
    let finger = "Amazing Hand Parts - Proximal_Shell.step";
    vec![
        // A boss with a rounded foot.
        (
            "s1-c5-214/FOOT_BACK_000.stp",
            [(inner(), About(0.15)), (SLID.to_owned(), About(0.15)), (wall("#353"), About(0.15))],
        ),
        (
            "s1-c5-214/MAINBODY_BACK.stp",
            [
                (inner(), Cylinders(FITTED)),
                (on("#161"), Cylinders(FITTED)),
                (wall("#192"), Cylinders(FITTED)),
            ],
        ),
        (
            "io1-cm-214.stp",
            [(inner(), Cylinders(EXACT)), (on("#1580"), Cylinders(EXACT)), (wall("#420"), Cylinders(EXACT))],
        ),
        (
            "as1_pe_203.stp",
            [(inner(), Cylinders(EXACT)), (on("#521"), Cylinders(EXACT)), (wall("#536"), Cylinders(EXACT))],
        ),
        (
            "trj3_as1-tc-214.stp",
            [(inner(), Cylinders(EXACT)), (on("#380"), Cylinders(EXACT)), (wall("#484"), Cylinders(EXACT))],
        ),
        // Text and slots stand on the face that bears the holes.
        (
            "featuretype.STEP",
            [(inner(), About(0.05)), (on("#965"), About(0.05)), (wall("#8"), Cylinders(EXACT))],
        ),
        // Pockets with corners.
        (
            "ANC101.stp",
            [(on("#243"), About(0.25)), (on("#473"), About(3e-3)), (wall("#767"), Cylinders(FITTED))],
        ),
        (
            finger,
            [
                (format!("wall = \"slide\"\n{}", on("#417")), About(0.02)),
                (on("#419"), About(0.02)),
                (wall("#415"), About(0.02)),
            ],
        ),
        (
            hood,
            [
                (SLID.to_owned(), About(0.02)),
                (on("#1581"), Cylinders(FITTED)),
                (on("#1583"), Cylinders(FITTED)),
            ],
        ),
        (
            "ExpansionCard_ThreadedInsert.stp",
            [(inner(), About(0.03)), (on("#1020"), Cylinders(FITTED)), (wall("#1035"), Cylinders(FITTED))],
        ),
        (
            "hole_model.stp",
            [(on("#327"), Cylinders(FITTED)), (on("#331"), About(5e-5)), (wall("#338"), Cylinders(FITTED))],
        ),
    ]
}

#[test]
fn parts_keep_what_is_held_and_scale_the_rest() {
    let (Some(python), Some(corpus)) = (python(), support::corpus()) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut rows = Vec::new();
    let mut files = Vec::new();
    for (part, holds) in parts() {
        for (hold, expect) in holds {
            let own = folder.path().join(rows.len().to_string());
            std::fs::create_dir(&own).expect("a folder");
            std::fs::copy(corpus.join("step").join(part), own.join("in.step")).expect("a part");
            let job = format!(
                "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
                 [[operation]]\nkind = \"constrained_scale\"\nfactors = {FACTORS:?}\n{hold}\n"
            );
            std::fs::write(own.join("job.toml"), job).expect("a job");
            let program = assert_cmd::cargo::cargo_bin!("resurf");
            let run = Command::new(program).arg("run").arg(own.join("job.toml")).output().expect("it starts");
            assert!(run.status.success(), "{part} {hold}: {}", String::from_utf8_lossy(&run.stderr));
            files.extend([own.join("in.step"), own.join("out.step")]);
            rows.push((part, hold, expect));
        }
    }
    let script = root().join("tests/external/occ_held.py");
    let factors = FACTORS.map(|factor| factor.to_string());
    let output = Command::new(python).arg(script).args(factors).args(files).output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with('[')).collect();
    assert_eq!(lines.len(), rows.len());
    for ((part, hold, expect), line) in rows.into_iter().zip(lines) {
        let found: Value = serde_json::from_str(line).expect("JSON");
        let solids = found.as_array().expect("solids");
        assert!(!solids.is_empty() && solids.iter().any(|solid| solid["kept"] != 0), "{part} {hold}");
        solids.iter().for_each(|solid| check(&format!("{part} {hold}"), expect, solid));
    }
}

fn check(what: &str, expect: Expect, solid: &Value) {
    let number = |key: &str| solid[key].as_f64().unwrap_or_else(|| panic!("{what}: {key}"));
    let place = |key: &str| [0, 1, 2].map(|k| solid[key][k].as_f64().expect("a number"));
    assert!(solid["valid"] == true && solid["closed"] == true, "{what}: {solid}");
    assert_eq!(solid["faces"][0], solid["faces"][1], "{what}");
    let volume = (number("volume") / number("expected_volume") - 1.0).abs();
    let (a, b) = (place("centroid"), place("expected_centroid"));
    let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt() / number("area").sqrt();
    match expect {
        Cylinders(within) => {
            assert!(volume <= within && apart <= CENTROID, "{what}: {volume:.1e} {apart:.1e}");
            let stray = number("stray") / number("area");
            assert!(stray <= AREAS, "{what}: areas off by {stray:.1e}");
        }
        About(within) => assert!(volume <= within && apart <= within, "{what}: {volume:.1e} {apart:.1e}"),
    }
}
