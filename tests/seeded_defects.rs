//! Defects planted one at a time into good files, each of which the check must call by its name; and good files,
//! which it must not accuse.
//!
//! `tests/defects/drilled.step` is a block of 40 x 30 x 10 with a hole of radius 5: seven faces, each record with a
//! name. Its volume, area and centroid stand in it, in centimetres, from the formulas.

use std::collections::BTreeSet;
use std::path::Path;

use resurf::diagnostic::Diagnostics;
use resurf::document::Document;
use resurf::job::own_check::{OwnFinding, own_findings};

#[path = "support/mod.rs"]
#[allow(dead_code, reason = "shared with other test binaries")]
mod support;

fn text(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(path).expect("a file of the project")
}

/// What our check says of a file; `None` when it cannot be read as one.
fn findings(bytes: Vec<u8>, extension: &str) -> Option<Vec<OwnFinding>> {
    let mut diagnostics = Diagnostics::default();
    let document = Document::open(bytes, extension, &mut diagnostics).ok()?;
    let model = document.model(&mut diagnostics);
    Some(own_findings(&document, &model, 1.0))
}

fn codes(text: String) -> BTreeSet<String> {
    let found = findings(text.into_bytes(), "step").expect("it still reads");
    found.into_iter().map(|finding| finding.code).collect()
}

/// A change of one record: its name, what stands there, and what stands there instead. Record 0 is a new one.
type Edit = (u32, &'static str, &'static str);

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut text = text.to_owned();
    for &(record, from, to) in edits {
        if record == 0 {
            text = text.replacen("ENDSEC;\nEND-ISO", &format!("{to}\nENDSEC;\nEND-ISO"), 1);
            continue;
        }
        let start = text.find(&format!("\n#{record}=")).expect("a record of that name") + 1;
        let end = start + text[start..].find(";\n").expect("an end");
        let old = &text[start..end];
        assert_eq!(old.matches(from).count(), 1, "#{record}: {from} in {old}");
        let new = old.replacen(from, to, 1);
        text.replace_range(start..end, &new);
    }
    text
}

struct Seed {
    what: &'static str,
    code: &'static str,
    edits: &'static [Edit],
}

const fn seed(what: &'static str, code: &'static str, edits: &'static [Edit]) -> Seed {
    Seed { what, code, edits }
}

const DRILLED: &str = "tests/defects/drilled.step";
const DOOR: &str = "samples/door/door.step";
const VASE: &str = "samples/vase/vase.step";

const ON_DRILLED: [Seed; 40] = [
    seed("a corner moved off its edges", "vertex-off-edge", &[(30, "(40.,0.,10.)", "(40.,0.,10.5)")]),
    seed("the hole's vertex moved", "vertex-off-edge", &[(36, "(25.,15.,10.)", "(25.,15.,11.)")]),
    seed("a face's sense turned", "reversed-loop", &[(509, "#402,.T.", "#402,.F.")]),
    seed("a bound turned", "turned-face", &[(525, ".T.", ".F.")]),
    seed("another bound turned", "one-way-edge", &[(546, ".T.", ".F.")]),
    seed("a face removed from the shell", "open-shell", &[(600, "#526,", "")]),
    seed("the hole's face removed", "free-edge", &[(600, ",#554", "")]),
    seed(
        "a face twice in the shell",
        "crowded-edge",
        &[(600, "#554)", "#554,#900)"), (0, "", "#900=ADVANCED_FACE('twin',(#525),#422,.T.);")],
    ),
    seed("an edge removed from a loop", "open-loop", &[(531, "#528,", "")]),
    seed("edges of a loop in another order", "open-loop", &[(524, "#520,#521,#522", "#521,#520,#522")]),
    seed("a use of an edge turned", "open-loop", &[(520, ".T.", ".F.")]),
    seed("a wrong edge in a loop", "open-loop", &[(522, "#104", "#128")]),
    seed("an edge's vertices swapped", "open-loop", &[(104, "#29,#31", "#31,#29")]),
    seed("a bound removed from a face", "free-edge", &[(509, "#505,#508", "#505")]),
    seed("another unit of length", "stale-validation-property", &[(8, ".MILLI.", "$")]),
    seed("a unit of another name", "stale-validation-property", &[(8, ".MILLI.", ".CENTI.")]),
    seed("another volume stated", "stale-validation-property", &[(706, "(11.2", "(11.4")]),
    seed("another area stated", "stale-validation-property", &[(710, "(39.", "(38.")]),
    seed("another centroid stated", "stale-validation-property", &[(714, "(20.,15.,5.)", "(20.,15.,5.2)")]),
    seed("a deeper block than was measured", "stale-validation-property", &[(706, "(11.", "(12.")]),
    seed("a pcurve shifted", "pcurve-off-edge", &[(105, "(0.,0.)", "(0.,0.25)")]),
    seed("a pcurve that runs another way", "pcurve-off-edge", &[(106, "(1.,0.)", "(0.8,0.6)")]),
    seed(
        "outer and inner bound swapped",
        "reversed-loop",
        &[(505, "FACE_OUTER_BOUND", "FACE_BOUND"), (508, "FACE_BOUND", "FACE_OUTER_BOUND")],
    ),
    seed("a hole's bound turned", "reversed-loop", &[(508, ".T.", ".F.")]),
    seed("a circle of the other sense", "reversed-loop", &[(261, "#260,.T.", "#260,.F.")]),
    seed(
        "a hole outside of its face",
        "overlapping-bounds",
        &[(256, "(20.,15.,10.)", "(80.,15.,10.)"), (36, "(25.,15.,10.)", "(85.,15.,10.)")],
    ),
    seed(
        "a hole across the border",
        "overlapping-bounds",
        &[(256, "(20.,15.,10.)", "(38.,15.,10.)"), (36, "(25.,15.,10.)", "(43.,15.,10.)")],
    ),
    seed("a cylinder of another radius", "edge-off-surface", &[(464, "5.)", "5.1)")]),
    seed("a circle of another radius", "edge-off-surface", &[(260, "5.)", "4.9)")]),
    seed("a plane moved", "edge-off-surface", &[(400, "(0.,0.,10.)", "(0.,0.,10.2)")]),
    seed("a plane tilted", "edge-off-surface", &[(403, "(0.,0.,1.)", "(0.,0.01,1.)")]),
    seed("an axis tilted", "edge-off-surface", &[(461, "(0.,0.,1.)", "(0.02,0.,1.)")]),
    seed("a line moved past its vertices", "gap", &[(100, "(0.,0.,10.)", "(0.,0.,10.05)")]),
    seed("a corner on top of the next", "degenerate-edge", &[(30, "(40.,0.,10.)", "(0.0000005,0.,10.)")]),
    seed(
        "two corners swapped with their edges",
        "self-crossing-loop",
        &[
            (32, "(40.,30.,10.)", "(0.,30.,10.)"),
            (34, "(0.,30.,10.)", "(40.,30.,10.)"),
            (113, "(0.,1.,0.)", "(-0.8,0.6,0.)"),
            (136, "(0.,30.,10.)", "(40.,30.,10.)"),
            (137, "(0.,-1.,0.)", "(-0.8,-0.6,0.)"),
        ],
    ),
    seed("an uncertainty wider than a face", "sliver-face", &[(10, "0.000001", "12.")]),
    seed("a seam and a bound removed", "missing-seam", &[(552, "#548,#549,#550,#551", "#548")]),
    seed(
        "a sense that two bounds contradict",
        "inconsistent-sense",
        &[
            (552, "#548,#549,#550,#551", "#548"),
            (554, "(#553),#464,.F.", "(#553,#902),#464,.T."),
            (0, "", "#901=EDGE_LOOP('',(#550));\n#902=FACE_BOUND('',#901,.T.);"),
        ],
    ),
    seed(
        "a shell turned inside out",
        "solid-inside-out",
        &[(601, "#600", "#900"), (0, "", "#900=ORIENTED_CLOSED_SHELL('',*,#600,.F.);")],
    ),
    seed("an edge moved off its face's plane", "edge-off-surface", &[(148, "(0.,0.,0.)", "(0.,0.1,0.)")]),
];

#[test]
fn every_planted_defect_is_called_by_its_name() {
    let good = text(DRILLED);
    assert_eq!(codes(good.clone()), BTreeSet::new());
    let mut missed = Vec::new();
    for Seed { what, code, edits } in ON_DRILLED {
        let found = codes(edited(&good, edits));
        if !found.contains(code) {
            missed.push(format!("{what}: {code} is not among {found:?}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn a_hole_between_two_bounds_without_a_seam_is_good() {
    let edits: [Edit; 3] = [
        (552, "#548,#549,#550,#551", "#548"),
        (554, "(#553),#464,.F.", "(#553,#902),#464,.F."),
        (0, "", "#901=EDGE_LOOP('',(#550));\n#902=FACE_BOUND('',#901,.T.);"),
    ];
    assert_eq!(codes(edited(&text(DRILLED), &edits)), BTreeSet::new());
}

/// The first of some numbers in a record that follow a word, by another.
fn with(file: &str, from: &str, to: &str) -> BTreeSet<String> {
    let good = text(file);
    assert!(good.contains(from), "{file}: {from}");
    codes(good.replacen(from, to, 1))
}

#[test]
fn defects_of_freeform_faces_are_called_by_their_names() {
    for file in [DOOR, VASE] {
        assert_eq!(codes(text(file)), BTreeSet::new(), "{file}");
    }
    let spline = "B_SPLINE_CURVE_WITH_KNOTS('',3,(#106,#107,#108";
    let swapped = with(DOOR, spline, "B_SPLINE_CURVE_WITH_KNOTS('',3,(#106,#108,#107");
    assert!(swapped.contains("edge-off-surface"), "control points swapped: {swapped:?}");
    let surface = text(DOOR);
    let knots = "0.3333333333333333,0.5,";
    assert!(surface.contains(knots));
    let moved = codes(surface.replacen(knots, "0.3333333333333333,0.55,", 1));
    assert!(
        moved.contains("edge-off-surface") || moved.contains("pcurve-off-edge"),
        "a knot moved: {moved:?}"
    );
    let bounds = with(DOOR, "(#819,#820,#821,#822)", "(#820,#821,#822)");
    assert!(!bounds.is_empty(), "the outer bound removed: {bounds:?}");
    let seam = with(VASE, "(#664,#665,#666,#667)", "(#665)");
    assert!(seam.contains("missing-seam"), "seam and a bound removed: {seam:?}");
    let turned = with(VASE, "'WALL',(#669),#541,.T.", "'WALL',(#669),#541,.F.");
    assert!(turned.contains("reversed-loop"), "the sense turned: {turned:?}");
    let vertex = with(VASE, "VERTEX_POINT('',#542)", "VERTEX_POINT('',#300)");
    assert!(vertex.iter().any(|code| code == "vertex-off-edge" || code == "gap"), "{vertex:?}");
}

/// Sound by Open CASCADE's checker, which takes any gap that it has widened a tolerance for, and accused by us: two
/// edges are 0.08 mm off their cylinders in a file that claims 0.005 mm.
/// In the other, two arcs leave a vertex side by side and cross again 0.17 mm further.
const ACCUSED: [(&str, &str); 2] =
    [("HEAD_BACK.stp", "edge-off-surface"), ("flipping_joystick_assembly.stp", "self-crossing-loop")];

#[test]
fn no_good_file_is_accused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut files: Vec<_> = walkdir::WalkDir::new(root)
        .into_iter()
        .filter_map(|entry| entry.ok().map(walkdir::DirEntry::into_path))
        .filter(|path| path.extension().is_some_and(|extension| extension == "step"))
        .collect();
    files.extend(
        support::corpus_files(support::STEP)
            .into_iter()
            .filter(|path| path.iter().any(|part| part == "step")),
    );
    files.sort();
    let mut accused = BTreeSet::new();
    for path in &files {
        let bytes = std::fs::read(path).expect("a file");
        // The largest take minutes without optimisation.
        if bytes.len() > LARGEST {
            continue;
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for finding in findings(bytes, "step").into_iter().flatten().filter(OwnFinding::is_error) {
            accused.insert((name.clone(), finding.code));
        }
    }
    let known: BTreeSet<(String, String)> =
        ACCUSED.iter().map(|(file, code)| ((*file).to_owned(), (*code).to_owned())).collect();
    let strange: Vec<_> = accused.difference(&known).collect();
    assert!(strange.is_empty(), "{strange:?}");
    assert!(files.len() >= 17, "{}", files.len());
}

/// Bytes of the largest file that a test without optimisation checks.
const LARGEST: usize = 600_000;
