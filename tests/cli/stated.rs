//! What a file states of its volume, area and centroid after a job: measured again, taken away, or kept and told.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Fixture, support};

/// The drilled block with some texts replaced.
fn drilled(edits: &[(&str, &str)]) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/defects/drilled.step");
    let mut text = std::fs::read_to_string(path).expect("a file of the project");
    for (from, to) in edits {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text = text.replace(from, to);
    }
    text
}

/// Scales a part by 2, 2 and 3: the output and its part of the report.
fn scaled(part: impl AsRef<[u8]>) -> (String, Value) {
    let job = "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
               [[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 3]\n";
    run(part, job)
}

fn run(part: impl AsRef<[u8]>, job: &str) -> (String, Value) {
    let fixture = Fixture::new().file("in.step", part).file("job.toml", job);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let checked = fixture.run(&["check", "out.step"]);
    assert!(!checked.contains("reference"), "{checked}");
    let report = std::fs::read(fixture.path("report.json")).expect("a report");
    let report: Value = serde_json::from_slice(&report).expect("JSON");
    let output = std::fs::read(fixture.path("out.step")).expect("an output");
    (String::from_utf8_lossy(&output).into_owned(), report["parts"][0].clone())
}

/// Numbers within the parentheses that follow a text.
fn numbers_after(text: &str, lead: &str) -> Vec<f64> {
    let at = text.find(lead).unwrap_or_else(|| panic!("{lead} is not there")) + lead.len();
    let list = &text[at..at + text[at..].find(')').expect("an end")];
    list.split(',').map(|number| number.trim().parse().expect("a number")).collect()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * b.abs().max(1.0);
    assert!(found.iter().zip(expected).all(near), "{found:?}, expected {expected:?}");
}

fn outcomes(part: &Value) -> Vec<(String, String)> {
    let all = part["restated"].as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    all.iter().map(|told| (text(&told["entity"]), text(&told["outcome"]))).collect()
}

fn losses(part: &Value) -> Vec<String> {
    let all = part["losses"].as_array().cloned().unwrap_or_default();
    all.iter().map(|loss| loss["code"].as_str().unwrap_or_default().to_owned()).collect()
}

#[test]
fn volume_area_and_centroid_follow_the_shape() {
    let (text, part) = scaled(drilled(&[]));
    // A block of 80 x 60 x 30 with a hole of radius 10, stated in centimetres but for the centroid.
    let (volume, ring) = (80.0 * 60.0 * 30.0 - PI * 100.0 * 30.0, 80.0 * 60.0 - PI * 100.0);
    let area = 2.0 * ring + 2.0 * (80.0 + 60.0) * 30.0 + 2.0 * PI * 10.0 * 30.0;
    assert_close(&numbers_after(&text, "VOLUME_MEASURE("), &[volume / 1000.0]);
    assert_close(&numbers_after(&text, "AREA_MEASURE("), &[area / 100.0]);
    assert_close(&numbers_after(&text, "'centre point',("), &[40.0, 30.0, 15.0]);
    let all = ["#705", "#709", "#713"].map(|name| (name.to_owned(), "recomputed".to_owned()));
    assert_eq!(outcomes(&part), all);
    assert!(losses(&part).is_empty(), "{:?}", losses(&part));
}

#[test]
fn a_job_that_changes_nothing_states_nothing() {
    let job = "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
               [[operation]]\nkind = \"constrained_scale\"\nfactors = [1, 1, 1]\n";
    let (text, part) = run(drilled(&[]), job);
    assert!(text == drilled(&[]) && outcomes(&part).is_empty());
}

#[test]
fn what_is_not_measured_goes_with_all_that_only_it_used() {
    let more = "#720=PROPERTY_DEFINITION('geometric validation property','box',#7);\n\
                #721=CARTESIAN_POINT('bounding box corner point',(0.,0.,0.));\n\
                #722=REPRESENTATION('bounding box',(#721),#11);\n\
                #723=PROPERTY_DEFINITION_REPRESENTATION(#720,#722);\nENDSEC;\nEND-ISO";
    let (text, part) = scaled(drilled(&[("ENDSEC;\nEND-ISO", more)]));
    assert!(["#720", "#721", "#722", "#723"].iter().all(|name| !text.contains(name)), "{text}");
    assert!(outcomes(&part).contains(&("#720".to_owned(), "removed".to_owned())));
    assert_eq!(losses(&part), ["validation-property.removed"]);
    let needed = more.replace(
        "ENDSEC;",
        "#724=GENERAL_PROPERTY('','','');\n#725=GENERAL_PROPERTY_ASSOCIATION('','',#724,#720);\nENDSEC;",
    );
    let (text, part) = scaled(drilled(&[("ENDSEC;\nEND-ISO", &needed)]));
    assert!(text.contains("#720=") && text.contains("#722="));
    assert!(outcomes(&part).contains(&("#720".to_owned(), "kept".to_owned())));
    assert_eq!(losses(&part), ["validation-property.stale"]);
}

#[test]
fn what_was_not_so_before_is_not_understood_and_kept() {
    let (text, part) = scaled(drilled(&[("VOLUME_MEASURE(11.2146018366)", "VOLUME_MEASURE(11.4)")]));
    assert!(text.contains("VOLUME_MEASURE(11.4)"));
    assert_eq!(outcomes(&part)[0], ("#705".to_owned(), "kept".to_owned()));
    assert_eq!(losses(&part), ["validation-property.stale"]);
}

#[test]
fn one_representation_may_give_several_quantities() {
    let edits = [
        ("REPRESENTATION('volume',(#706),#11)", "REPRESENTATION('all',(#706,#710,#726,#714),#11)"),
        (
            "ENDSEC;\nEND-ISO",
            "#726=MEASURE_REPRESENTATION_ITEM('curve length measure',LENGTH_MEASURE(7.),#700);\nENDSEC;\nEND-ISO",
        ),
    ];
    let (text, part) = scaled(drilled(&edits));
    assert_close(&numbers_after(&text, "'centre point',("), &[40.0, 30.0, 15.0]);
    assert!(text.contains("LENGTH_MEASURE(7.)"));
    assert_eq!(outcomes(&part)[0], ("#705".to_owned(), "recomputed".to_owned()));
    // The length is neither measured nor alone: the rest is stated, and this is told.
    assert_eq!(losses(&part), ["validation-property.stale"]);
}

#[test]
fn a_centre_that_is_a_point_of_the_shape_too_gets_one_of_its_own() {
    let vertex = "#726=VERTEX_POINT('',#714);\nENDSEC;\nEND-ISO";
    let (text, _) = scaled(drilled(&[("ENDSEC;\nEND-ISO", vertex)]));
    assert!(text.contains("#714=CARTESIAN_POINT('centre point',(20.,15.,5.))"));
    let fresh = text.rfind("=CARTESIAN_POINT('centre point',(40.,30.,15.))").expect("a point of its own");
    let name = &text[text[..fresh].rfind('#').expect("a name")..fresh];
    assert!(text.contains(&format!("#715=REPRESENTATION('centroid',({name}),#11)")), "{name}");
}

/// A file of the corpus, where it is there.
fn corpus(name: &str) -> Option<PathBuf> {
    support::corpus().map(|folder| folder.join(name)).filter(|path| path.exists())
}

/// The whole corpus file of an assembly in inches: definitions, uses and the assembly are stated anew.
#[test]
fn an_assembly_is_stated_anew_at_every_level() {
    let Some(path) = corpus("step/dm1-id-214.stp") else { return };
    let job = "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
               [[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 2]\n";
    let (_, part) = run(std::fs::read(path).expect("a corpus file"), job);
    let told = |entity: &str| {
        let all = part["restated"].as_array().expect("statements");
        all.iter().find(|told| told["entity"] == entity).expect("a property").clone()
    };
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().expect("numbers").iter().map(|n| n.as_f64().expect("a number")).collect()
    };
    // Each definition is scaled once; the assembly's volume is the sum over uses that stay where they were.
    for (entity, factor) in [("#506", 8.0), ("#526", 4.0), ("#578", 8.0), ("#598", 4.0), ("#1146", 8.0)] {
        let told = told(entity);
        let (before, after) = (numbers(&told["before"])[0], numbers(&told["after"])[0]);
        assert!((after / before - factor).abs() <= 1e-3, "{told}");
    }
    // The centre of a bolt in the assembly: its own centre, doubled, from the place that the bolt keeps.
    let (own, used) = (numbers(&told("#522")["after"]), told("#162"));
    let place = [0.395870445849482, -0.334645669291338, 2.559055118110237];
    let expected: Vec<f64> = (0..3).map(|k| place[k] + own[k]).collect();
    let found = numbers(&used["after"]);
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-9), "{used}, expected {expected:?}");
    // The assembly's centroid was one of masses: it is left alone, and told.
    assert_eq!(told("#594")["outcome"], "kept");
}

#[test]
fn dimensions_and_tolerances_on_changed_faces_are_kept_and_named() {
    let Some(path) = corpus("step/nist_ftc_06.step") else { return };
    let job = "version = 1\ninputs = [\"in.step\"]\noutput = \"out.step\"\n\
               [[operation]]\nkind = \"constrained_scale\"\nfactors = [2, 2, 2]\n";
    let (_, part) = run(std::fs::read(path).expect("a corpus file"), job);
    let named = losses(&part).iter().filter(|code| *code == "pmi.on-changed-face").count();
    assert!(named > 5, "{named}");
    let body = outcomes(&part).into_iter().find(|(entity, _)| entity == "#9691");
    assert_eq!(body.expect("the volume of the part").1, "recomputed");
}
