//! Where a feature may come from, in which units, and what each word of the job changes.

use serde_json::Value;

use crate::Fixture;
use crate::paste::{job, model, spline, with_features};

const ON_VAMP: &str = "target = { face = { name = \"OUTER_SKIN\" }, at = [170, 8, 75] }";

/// Runs one operation on the vamp; gives the result's bytes and the figures of the only place.
fn pasted(fixture: Fixture, operation: &str) -> (Vec<u8>, Value) {
    let fixture = fixture.file("job.toml", job("vamp.step", "", &[operation]));
    let said = fixture.run(&["run", "job.toml", "--report", "report.json"]);
    assert!(said.starts_with("exit code: 0"), "{operation}: {said}");
    let report: Value =
        serde_json::from_slice(&std::fs::read(fixture.path("report.json")).expect("a report")).expect("JSON");
    let place = report["parts"][0]["operations"][0]["measures"]["places"][0].clone();
    (std::fs::read(fixture.path("out/vamp.step")).expect("a result"), place)
}

fn vamp() -> Fixture {
    with_features("vamp/vamp.step")
}

fn bump_text() -> String {
    std::fs::read_to_string(vamp().path("bump.step")).expect("a sample")
}

#[test]
fn each_word_of_the_method_changes_the_result() {
    let source = "source = { file = \"symbol.step\" }\nscale = [0.6, 0.6, 1.0]\n";
    let run = |words: &str| pasted(vamp(), &format!("{source}{words}\n{ON_VAMP}")).0;
    let poisson = "method = \"poisson\"\nexisting = \"replace\"\n";
    let words = [
        String::new(),
        "margin = 8".to_owned(),
        "rule = \"rows_and_columns\"".to_owned(),
        "existing = \"replace\"".to_owned(),
        "method = \"biharmonic\"".to_owned(),
        "existing = \"stronger\"".to_owned(),
        "method = \"fit\"\ntolerance = 0.1".to_owned(),
        poisson.to_owned(),
        format!("{poisson}turn = \"normal\""),
        format!("{poisson}turn = \"none\""),
        format!("{poisson}edge_weights = \"uniform\""),
    ];
    let results: Vec<Vec<u8>> = words.iter().map(|w| run(w)).collect();
    for (at, result) in results.iter().enumerate() {
        let same = results[..at].iter().position(|other| other == result);
        assert_eq!(same, None, "`{}` gives what another does", words[at]);
    }
}

/// A circle as a curve of the source's file, in the plane of the sheet, and the polygon of its points.
#[test]
fn a_curve_of_the_file_is_a_contour_like_its_points() {
    let text = bump_text();
    let context = text.split("REPRESENTATION('',(#").nth(1).is_some();
    assert!(context, "the sample has a representation");
    let free = "#9001=CARTESIAN_POINT('',(0.,0.,9.));\n#9002=DIRECTION('',(0.,0.,1.));\n#9003=DIRECTION('',(1.,0.,0.));\n\
                #9004=AXIS2_PLACEMENT_3D('',#9001,#9002,#9003);\n#9005=CIRCLE('',#9004,24.);\n";
    let polygon: Vec<String> = (0..64)
        .map(|k| std::f64::consts::TAU * f64::from(k) / 64.0)
        .map(|t| format!("[{:?}, {:?}, 9.0]", 24.0 * t.cos(), 24.0 * t.sin()))
        .collect();
    let set = add_free_curve(&text, free, 9005);
    let by = |region: &str| {
        let fixture = vamp().file("ring.step", &set);
        let source = format!("source = {{ file = \"ring.step\", region = {{ {region} }} }}\nscale = 0.5");
        pasted(fixture, &format!("{source}\n{ON_VAMP}")).1
    };
    let (curve, contour) = (by("curve = \"#9005\""), by(&format!("contour = [{}]", polygon.join(", "))));
    assert_eq!(curve["changed"], contour["changed"]);
    let heights = [&curve, &contour].map(|place| place["height"].as_f64().expect("a height"));
    assert!(heights[0] > 1.0 && (heights[0] - heights[1]).abs() < 1e-9, "{heights:?}");
    let whole = pasted(vamp(), &format!("source = {{ file = \"bump.step\" }}\nscale = 0.5\n{ON_VAMP}")).1;
    assert!(curve["changed"].as_u64() < whole["changed"].as_u64());
}

/// The file with a curve set in the context of its shape.
fn add_free_curve(text: &str, records: &str, curve: u32) -> String {
    let shape = text.split("SHAPE_REPRESENTATION('',(").nth(1).expect("a shape");
    let context = shape.split(')').nth(1).and_then(|rest| rest.strip_prefix(",#")).expect("a context");
    let context: String = context.chars().take_while(char::is_ascii_digit).collect();
    let more = format!(
        "{records}#9010=GEOMETRIC_CURVE_SET('',(#{curve}));\n\
         #9011=GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(#9010),#{context});\n"
    );
    let end = text.rfind("ENDSEC;").expect("an end");
    format!("{}{more}{}", &text[..end], &text[end..])
}

#[test]
fn an_open_curve_is_no_contour() {
    let line = "#9001=CARTESIAN_POINT('',(0.,0.,9.));\n#9002=DIRECTION('',(1.,0.,0.));\n#9003=VECTOR('',#9002,1.);\n\
                #9004=LINE('',#9001,#9003);\n#9005=TRIMMED_CURVE('',#9004,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(20.)),\
                .T.,.PARAMETER.);\n";
    let fixture = vamp().file("open.step", add_free_curve(&bump_text(), line, 9005)).file(
        "job.toml",
        job(
            "vamp.step",
            "",
            &[&format!("source = {{ file = \"open.step\", region = {{ curve = \"#9005\" }} }}\n{ON_VAMP}")],
        ),
    );
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 4") && said.contains("paste.contour-open"), "{said}");
    assert!(!fixture.left().iter().any(|name| name.starts_with("out")), "nothing is written");
}

#[test]
fn an_inner_loop_of_the_source_is_a_region() {
    let source = "source = { file = \"door.step\", region = { loop = 1 } }\nscale = 0.1";
    let (_, place) = pasted(vamp().sample("door/door.step"), &format!("{source}\n{ON_VAMP}"));
    assert!(place["changed"].as_u64().expect("a count") > 10, "{place}");
    // The panel bulges a little under its hole, and a tenth of that arrives.
    let height = place["height"].as_f64().expect("a height");
    assert!(height > 1e-6 && height < 1.0, "{height}");
}

/// The same sheet drawn in metres, a thousand times too large, and pasted at a thousandth of the scale.
#[test]
fn a_source_in_other_units_is_the_same_feature() {
    let metres = bump_text().replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)");
    assert!(metres != bump_text(), "the sample is in millimetres");
    let fixture = vamp().file("metres.step", metres);
    let (large, _) =
        pasted(fixture, &format!("source = {{ file = \"metres.step\" }}\nscale = 0.0005\n{ON_VAMP}"));
    let (small, _) = pasted(vamp(), &format!("source = {{ file = \"bump.step\" }}\nscale = 0.5\n{ON_VAMP}"));
    let net = |bytes: Vec<u8>| {
        let fixture = Fixture::new().file("part.step", bytes);
        let model = model(&fixture, "part.step");
        let face = model.faces.iter().find(|(_, a)| a.name == "OUTER_SKIN").expect("the skin").0;
        spline(&model, face).expect("a B-spline").control_points().collect::<Vec<_>>()
    };
    let (large, small) = (net(large), net(small));
    assert_eq!(large.len(), small.len());
    let apart = large.iter().zip(&small).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart}");
}

/// The bump's surface with weights: the record becomes a complex one.
fn weighted(weight: impl Fn(usize) -> &'static str) -> String {
    let text = bump_text();
    let start = text.find("B_SPLINE_SURFACE_WITH_KNOTS('bump',").expect("the surface");
    let end = start + text[start..].find(';').expect("its end");
    let inner = text[start..end].strip_prefix("B_SPLINE_SURFACE_WITH_KNOTS('bump',").expect("a name");
    let (net, knots) = inner.split_once(".F.,.F.,.F.,").expect("flags");
    let knots = knots.strip_suffix(")").expect("a bracket");
    let row = |i: usize| {
        let weights: Vec<&str> = (0..19).map(|j| weight(19 * i + j)).collect();
        format!("({})", weights.join(","))
    };
    let rows: Vec<String> = (0..19).map(row).collect();
    format!(
        "{}(BOUNDED_SURFACE()B_SPLINE_SURFACE({net}.F.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS({knots})\
         GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))REPRESENTATION_ITEM('bump')SURFACE()){}",
        &text[..start],
        rows.join(","),
        &text[end..]
    )
}

#[test]
fn weights_that_are_all_alike_change_nothing_and_one_of_zero_or_below_is_refused() {
    let source = "source = { file = \"weighted.step\" }\nscale = 0.5\n";
    let place = |text: String| {
        pasted(vamp().file("weighted.step", text), &format!("{source}{ON_VAMP}")).1["height"].as_f64()
    };
    let plain = pasted(vamp(), &format!("source = {{ file = \"bump.step\" }}\nscale = 0.5\n{ON_VAMP}")).1;
    let (threes, plain) =
        (place(weighted(|_| "3.")).expect("a height"), plain["height"].as_f64().expect("a height"));
    assert!((threes - plain).abs() < 1e-9, "{threes} against {plain}");
    for bad in ["0.", "-1."] {
        let text = weighted(|k| if k == 180 { bad } else { "1." });
        let fixture = vamp().file("weighted.step", text);
        let fixture = fixture.file("job.toml", job("vamp.step", "", &[&format!("{source}{ON_VAMP}")]));
        let said = fixture.run(&["run", "job.toml"]);
        assert!(said.starts_with("exit code: 4") && said.contains("weight"), "{said}");
        assert!(said.contains("#377") && said.contains("line"), "the record and its line: {said}");
        assert!(!fixture.left().iter().any(|name| name.starts_with("out")), "nothing is written");
    }
}
