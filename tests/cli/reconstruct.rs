//! Jobs of `feature_reconstruction`: from the samples' clouds to blended features, and what is refused.

use serde_json::Value;

use crate::Fixture;
use crate::scan::{Kind, Part, cloud, ply};

/// The one operation's measures, and the part's report, of a sample's job.
fn reconstructed(name: &str) -> (Value, Value) {
    let files = ["step", "ply", "toml"].map(|extension| format!("scan/{name}.{extension}"));
    let fixture = files.iter().fold(Fixture::new(), |fixture, file| fixture.sample(file));
    let said = fixture.run(&["run", &format!("{name}.toml"), "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{said}");
    let text = std::fs::read_to_string(fixture.path("report.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let part = report["parts"][0].clone();
    (part["operations"][0]["measures"].clone(), part)
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Contacts within a quarter of the specification's half degree, the mean error at the noise's own mean.
fn assert_fair(measures: &Value, noise: f64) {
    for line in measures["lines"].as_array().expect("lines") {
        assert!(number(&line["angle"]) < 0.05, "{line}");
    }
    let mean = number(&measures["secondary"]["deviation"]["mean"]);
    assert!(mean < 0.81 * noise, "{mean}");
}

/// The pad's cloud is not sorted; the solid gets a secondary and a blend, and stays one.
#[test]
fn a_pad_comes_out_of_an_unsorted_cloud() {
    let (measures, part) = reconstructed("pad");
    let radius = number(&measures["lines"][0]["ball"]);
    assert!((radius - 5.0).abs() < 0.03 * 5.0, "{radius}");
    assert_fair(&measures, 0.05);
    assert_eq!(part["after"]["counts"]["faces"], 8);
    assert_eq!(part["after"]["counts"]["solids"], 1);
}

/// The groove runs out over both borders and parts the sheet in two.
#[test]
fn a_groove_runs_from_border_to_border() {
    let (measures, part) = reconstructed("groove");
    let lines = measures["lines"].as_array().expect("lines");
    assert_eq!(lines.len(), 2);
    for line in lines {
        let radius = number(&line["ball"]);
        assert!((radius - 6.0).abs() < 0.03 * 6.0, "{radius}");
    }
    assert_fair(&measures, 0.05);
    // Two pieces of the primary, two blends and the secondary.
    assert_eq!(part["after"]["counts"]["faces"], 5);
}

/// All forty features of the membrane from one cloud, folded onto one.
#[test]
fn forty_features_of_a_ring_are_one_job() {
    let (measures, part) = reconstructed("diaphragm");
    assert_eq!(measures["features"], 40);
    let radius = number(&measures["lines"][0]["ball"]);
    assert!((radius - 0.06).abs() < 0.03 * 0.06, "{radius}");
    assert_fair(&measures, 0.0005);
    assert_eq!(part["after"]["counts"]["faces"], 81);
}

/// Code of what a pad's job with another cloud or other words says; nothing may be written.
fn refused(file: &str, bytes: &[u8], words: &str) -> String {
    let job = format!(
        "version = 1\ninputs = [\"pad.step\"]\noutput = \"out/{{stem}}.{{ext}}\"\n\n[[operation]]\n\
         kind = \"feature_reconstruction\"\nprimary = {{ face = {{ name = \"OUTER_SKIN\" }} }}\n{words}\n"
    );
    let fixture = Fixture::new().sample("scan/pad.step").file(file, bytes).file("job.toml", job);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(!fixture.path("out/pad.step").exists(), "{said}");
    said
}

#[test]
fn what_is_no_scan_of_the_part_is_refused() {
    let labelled =
        "cloud = { file = \"c.ply\", labels = { column = \"label\", objective = [1], blend = [2] }";
    let cloud = Part::new(Kind::Pad).cloud(3000, 0.05, 1);
    let scaled = |factor: f64, up: f64| {
        let points = cloud.points.iter().map(|p| [factor * p[0], factor * p[1], factor * p[2] + up]);
        ply::write(&cloud::Cloud { points: points.collect(), ..cloud.clone() })
    };
    let of = |count: usize| {
        let points = cloud.points.iter().step_by(cloud.points.len() / count).copied().collect();
        let labels = cloud.labels.iter().step_by(cloud.points.len() / count).copied().collect();
        ply::write(&cloud::Cloud { points, labels, ..cloud.clone() })
    };
    let plain = format!("{labelled} }}");
    let inches = format!("{labelled}, unit = \"1 in\" }}");
    let other = plain.replace("[2]", "[7]");
    let cases: [(&str, Vec<u8>, &str, &str); 9] = [
        ("c.ply", scaled(1.0 / 25.4, 0.0), &plain, "cloud.wrong-unit"),
        ("c.ply", scaled(1000.0, 0.0), &plain, "cloud.wrong-unit"),
        ("c.ply", scaled(1.0, 0.0), &inches, "cloud.wrong-unit"),
        ("c.ply", scaled(1.0, 9000.0), &plain, "cloud.far-from-part"),
        ("c.ply", of(60), &plain, "reconstruct.cloud-too-small"),
        ("c.ply", Vec::new(), &plain, "cloud.empty"),
        ("c.ply", scaled(1.0, 0.0), &other, "cloud.empty"),
        ("c.xyz", b"1 2 3\n1 nan 3\n".to_vec(), "cloud = { file = \"c.xyz\" }", "cloud.not-finite"),
        ("c.ply", scaled(1.0, 0.0), &format!("{plain}\nblend = \"60 mm\""), "reconstruct.ball-does-not-fit"),
    ];
    for (file, bytes, words, code) in cases {
        let said = refused(file, &bytes, words);
        assert!(said.contains(code), "{code}: {said}");
    }
}

#[test]
fn words_that_contradict_are_refused_before_anything_is_read() {
    let cases = [
        ("cloud = { objective = \"c.ply\" }", "expected `objective` and `blend`, or `file`"),
        ("cloud = { file = \"c.ply\" }\nblend = -2", "is not a radius"),
        ("cloud = { file = \"c.ply\" }\nblend = \"conical\"", "\"tested\", \"constant\", \"linear\""),
        ("cloud = { file = \"c.ply\" }\nlines = { backbone = \"spine\" }", "`fit`"),
        ("cloud = { file = \"c.ply\" }\nlines = { spans = [0, 4] }", "lines.spans"),
    ];
    for (words, said) in cases {
        let found = refused("c.ply", b"ply", words);
        assert!(found.starts_with("exit code: 2") && found.contains(said), "{said}: {found}");
    }
}
