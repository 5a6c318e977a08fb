//! Pictures beside the output: which are written, what the report says of them, and when there are none.

use serde_json::Value;

use crate::Fixture;
use crate::paste::with_features;

fn job(words: &str) -> String {
    format!(
        "version = 1\ninputs = [\"plate.step\"]\noutput = \"out/{{stem}}.{{ext}}\"\n{words}\n[[operation]]\n\
         kind = \"feature_paste\"\nsource = {{ file = \"symbol.step\" }}\n\
         target = {{ face = {{ name = \"TOP\" }}, at = [75, 80, 12] }}\n"
    )
}

fn report(fixture: &Fixture) -> Value {
    serde_json::from_slice(&std::fs::read(fixture.path("report.json")).expect("a report")).expect("JSON")
}

#[test]
fn pictures_of_the_changed_face_stand_beside_the_output() {
    let words = "pictures = [\"highlight\", \"curvature\", \"deviation\"]";
    let fixture = with_features("plate/plate.step").file("job.toml", job(words));
    let dry = fixture.run(&["run", "job.toml", "--dry-run"]);
    assert!(dry.starts_with("exit code: 0") && !fixture.path("out").exists(), "{dry}");
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let part = &report(&fixture)["parts"][0];
    let pictures = part["pictures"].as_array().expect("a list");
    let kinds: Vec<_> = pictures.iter().map(|p| p["kind"].as_str().unwrap_or_default()).collect();
    assert_eq!(kinds, ["highlight", "curvature", "deviation"]);
    for kind in kinds {
        let bytes = std::fs::read(fixture.path(&format!("out/plate.{kind}.png"))).expect("a picture");
        let map = tiny_skia::Pixmap::decode_png(&bytes).expect("a PNG");
        let colours: std::collections::BTreeSet<_> =
            map.pixels().iter().map(|p| (p.red(), p.green(), p.blue())).collect();
        assert!(map.width() >= 800 && colours.len() > 20, "{kind}: {} colours", colours.len());
    }
    // The feature is what differs, so its height has the full colour.
    let full = pictures[2]["full_colour"].as_f64().expect("a number");
    let height = part["operations"][0]["measures"]["places"][0]["height"].as_f64().expect("a height");
    assert!((full - height).abs() < 0.02 * height, "{full} against {height}");
}

#[test]
fn without_a_changed_face_there_is_no_picture_and_the_report_says_so() {
    let text =
        "version = 1\ninputs = [\"plate.step\"]\noutput = \"out/{stem}.{ext}\"\npictures = [\"deviation\"]\n";
    let fixture = with_features("plate/plate.step").file("job.toml", text);
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    assert_eq!(report(&fixture)["parts"][0]["losses"][0]["code"], "picture.no-face");
    assert!(!fixture.path("out/plate.deviation.png").exists());
}

#[test]
fn a_job_that_fails_leaves_no_picture_and_an_unknown_kind_is_refused() {
    let words = "pictures = [\"highlight\"]";
    let far = job(words).replace("[75, 80, 12]", "[36, 80, 12]");
    let fixture = with_features("plate/plate.step").file("job.toml", far);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && !fixture.path("out").exists(), "{said}");
    let fixture = with_features("plate/plate.step").file("job.toml", job("pictures = [\"depth\"]"));
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 2") && said.contains("`highlight`"), "{said}");
}
