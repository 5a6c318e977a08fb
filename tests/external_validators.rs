//! The validators: error paths with programs that misbehave (always run), and the real programs where they
//! are installed. With `RESURF_REQUIRE_VALIDATORS=1` a missing program is a failure.

use resurf::math::Point3;
use resurf::mesh::{Mesh, off, stl};
use resurf::validate::{Request, ValidateError, Validator, Verdict, ask_freecad, ask_openscad};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A cube of the given edge; OFF and STL are written beside each other.
fn cube(edge: f64) -> Mesh {
    let vertices = (0..8u32)
        .map(|k| Point3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * edge)
        .collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { vertices, triangles, ..Mesh::default() }
}

fn write_off(mesh: &Mesh, directory: &Path) -> PathBuf {
    let mut bytes = Vec::new();
    off::write(mesh, &mut bytes).expect("a vector takes all bytes");
    let path = directory.join("given.off");
    std::fs::write(&path, bytes).expect("the directory is ours");
    path
}

fn scratch() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

/// Gives the verdict, or `None` when the program is not installed and need not be.
fn or_missing(verdict: Result<Verdict, ValidateError>) -> Option<Verdict> {
    match verdict {
        Err(ValidateError::Missing { .. }) if std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_none() => None,
        verdict => Some(verdict.expect("a verdict")),
    }
}

fn request<'a>(file: &'a Path, scratch: &'a Path) -> Request<'a> {
    Request { file, scratch, timeout: Duration::from_secs(120), program: None }
}

/// An open shell of one triangular plane face, in millimetres (ISO 10303-21, AP214).
fn triangle_step() -> String {
    let mut text = String::from(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n\
         #1=APPLICATION_CONTEXT('automotive design');\n\
         #2=PRODUCT_CONTEXT('',#1,'mechanical');\n#3=PRODUCT('t','t','',(#2));\n\
         #4=PRODUCT_DEFINITION_FORMATION('','',#3);\n#5=PRODUCT_DEFINITION_CONTEXT('',#1,'design');\n\
         #6=PRODUCT_DEFINITION('','',#4,#5);\n#7=PRODUCT_DEFINITION_SHAPE('','',#6);\n\
         #8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #10=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n\
         #11=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#8,'distance_accuracy_value','');\n\
         #12=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#11))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#8,#9,#10))REPRESENTATION_CONTEXT('',''));\n\
         #13=SHAPE_DEFINITION_REPRESENTATION(#7,#14);\n\
         #14=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#15,#20),#12);\n\
         #15=SHELL_BASED_SURFACE_MODEL('',(#16));\n#16=OPEN_SHELL('',(#17));\n\
         #17=ADVANCED_FACE('',(#18),#19,.T.);\n#18=FACE_OUTER_BOUND('',#24,.T.);\n#19=PLANE('',#20);\n\
         #20=AXIS2_PLACEMENT_3D('',#31,#21,#22);\n#21=DIRECTION('',(0.,0.,1.));\n#22=DIRECTION('',(1.,0.,0.));\n\
         #24=EDGE_LOOP('',(#25,#26,#27));\n",
    );
    let corners: [[f64; 2]; 3] = [[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]];
    for k in 0..3 {
        let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % 3]);
        let [point, vertex, edge, line, vector, direction] = [31, 41, 51, 61, 71, 81].map(|base| base + k);
        let next = 41 + (k + 1) % 3;
        let use_of = 25 + k;
        let length = (bx - ax).hypot(by - ay);
        text += &format!(
            "#{use_of}=ORIENTED_EDGE('',*,*,#{edge},.T.);\n#{point}=CARTESIAN_POINT('',({ax:?},{ay:?},0.));\n\
             #{vertex}=VERTEX_POINT('',#{point});\n#{edge}=EDGE_CURVE('',#{vertex},#{next},#{line},.T.);\n\
             #{line}=LINE('',#{point},#{vector});\n#{vector}=VECTOR('',#{direction},1.);\n\
             #{direction}=DIRECTION('',({:?},{:?},0.));\n",
            (bx - ax) / length,
            (by - ay) / length
        );
    }
    text + "ENDSEC;\nEND-ISO-10303-21;\n"
}

#[test]
fn freecad_measures_a_triangle_of_legs_3_and_4() {
    let directory = scratch();
    let file = directory.path().join("part ü'1.stp");
    std::fs::write(&file, triangle_step()).expect("the directory is ours");
    let Some(verdict) = or_missing(ask_freecad(&request(&file, directory.path()))) else { return };
    assert!(verdict.accepted, "{verdict:?}");
    let figures = verdict.figures;
    assert_eq!((figures.faces, figures.edges, figures.solids), (Some(1), Some(3), Some(0)));
    assert_eq!((figures.format.as_str(), figures.valid), ("step", Some(true)));
    assert!((figures.area.expect("an area") - 6.0).abs() < 1e-6);
    let extents = figures.extents.expect("extents");
    assert!((extents.max[0] - 4.0).abs() < 1e-3 && (extents.max[1] - 3.0).abs() < 1e-3);
}

#[test]
fn freecad_does_not_accept_what_it_cannot_read() {
    let directory = scratch();
    let file = directory.path().join("cut.stp");
    std::fs::write(&file, &triangle_step()[..900]).expect("the directory is ours");
    let Some(verdict) = or_missing(ask_freecad(&request(&file, directory.path()))) else { return };
    assert!(!verdict.accepted && !verdict.messages.is_empty(), "{verdict:?}");
}

#[test]
fn openscad_accepts_a_closed_cube_in_both_formats() {
    let directory = scratch();
    let mesh = cube(2.5);
    let mut bytes = Vec::new();
    stl::write_binary(&mesh, "cube", &mut bytes).expect("a vector takes all bytes");
    let as_stl = directory.path().join("cube.STL");
    std::fs::write(&as_stl, bytes).expect("the directory is ours");
    for file in [write_off(&mesh, directory.path()), as_stl] {
        let Some(verdict) = or_missing(ask_openscad(&request(&file, directory.path()))) else { return };
        assert!(verdict.accepted, "{verdict:?}");
        assert_eq!(verdict.figures.triangles, Some(12));
        assert!((verdict.figures.volume.expect("a volume") - 15.625).abs() < 1e-3);
        assert_eq!(verdict.figures.extents.expect("extents").max, [2.5; 3]);
    }
}

#[test]
fn openscad_does_not_accept_an_open_turned_or_empty_mesh() {
    let damages: [fn(&mut Mesh); 3] = [
        |mesh| mesh.triangles.truncate(11),
        |mesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)),
        |mesh| mesh.triangles.clear(),
    ];
    for damage in damages {
        let directory = scratch();
        let mut mesh = cube(1.0);
        damage(&mut mesh);
        let file = write_off(&mesh, directory.path());
        let Some(verdict) = or_missing(ask_openscad(&request(&file, directory.path()))) else { return };
        assert!(!verdict.accepted && !verdict.messages.is_empty(), "{verdict:?}");
    }
}

#[test]
fn a_missing_program_names_the_command_that_installs_it() {
    let directory = scratch();
    let file = write_off(&cube(1.0), directory.path());
    let program = Some(OsStr::new("no-such-program-anywhere"));
    let request = Request { program, ..request(&file, directory.path()) };
    for (error, package) in [
        (ask_freecad(&request).expect_err("not there"), "freecad"),
        (ask_openscad(&request).expect_err("not there"), "openscad"),
    ] {
        assert!(matches!(error, ValidateError::Missing { .. }), "{error}");
        assert!(
            error.to_string().contains("apt-get install") && error.to_string().contains(package),
            "{error}"
        );
    }
}

#[test]
fn a_file_that_is_not_there_or_not_a_mesh_is_named() {
    let directory = scratch();
    let missing = directory.path().join("none.stp");
    let error = ask_freecad(&request(&missing, directory.path())).expect_err("not there");
    assert!(error.to_string().contains("none.stp"), "{error}");
    let garbage = directory.path().join("garbage.off");
    std::fs::write(&garbage, "garbage").expect("the directory is ours");
    let error = ask_openscad(&request(&garbage, directory.path())).expect_err("not a mesh");
    assert!(matches!(error, ValidateError::NotAMesh { .. }), "{error}");
}

#[test]
fn the_words_of_the_two_programs_are_those_of_the_job_file() {
    assert_eq!(serde_json::to_string(&Validator::FreeCad).expect("a word"), "\"freecad\"");
    assert_eq!(serde_json::to_string(&Validator::OpenScad).expect("a word"), "\"openscad\"");
    assert_eq!((Validator::FreeCad.as_str(), Validator::OpenScad.as_str()), ("freecad", "openscad"));
}

#[cfg(unix)]
mod programs_that_misbehave {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::sync::{Mutex, PoisonError};

    /// One script at a time: a script cannot be run while any process of ours still holds it open for
    /// writing, and each spawn copies the open files of all threads for a moment.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

    type Ask = fn(&Request) -> Result<Verdict, ValidateError>;

    fn ask(ask: Ask, script: &str, timeout: Duration) -> Result<Verdict, ValidateError> {
        let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let directory = scratch();
        let program = directory.path().join("program");
        std::fs::write(&program, format!("#!/bin/sh\n{script}\n")).expect("the directory is ours");
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("the file is ours");
        let file = write_off(&cube(1.0), directory.path());
        let program = Some(program.as_os_str());
        ask(&Request { file: &file, scratch: directory.path(), timeout, program })
    }

    const BOTH: [Ask; 2] = [ask_freecad, ask_openscad];
    const AMPLE: Duration = Duration::from_secs(60);

    #[test]
    fn a_hanging_program_is_killed_in_time() {
        for validator in BOTH {
            let begin = std::time::Instant::now();
            let verdict = ask(validator, "echo waiting; exec sleep 60", Duration::from_millis(300));
            let Err(ValidateError::Timeout { output, .. }) = &verdict else { panic!("{verdict:?}") };
            assert_eq!(output, "waiting");
            assert!(begin.elapsed() < Duration::from_secs(30));
        }
    }

    #[test]
    fn a_child_that_holds_the_output_open_does_not_hold_us() {
        let begin = std::time::Instant::now();
        let verdict = ask(ask_freecad, "sleep 60 & exit 0", AMPLE);
        assert!(matches!(verdict, Err(ValidateError::NoSentinel { .. })), "{verdict:?}");
        assert!(begin.elapsed() < Duration::from_secs(30));
    }

    #[test]
    fn a_crash_gives_the_last_words() {
        for validator in BOTH {
            let verdict = ask(validator, "echo segmentation >&2; kill -SEGV $$", AMPLE);
            let Err(ValidateError::Crashed { output, .. }) = &verdict else { panic!("{verdict:?}") };
            assert_eq!(output, "segmentation");
        }
    }

    #[test]
    fn exit_code_0_without_an_answer_is_no_verdict() {
        for validator in BOTH {
            let verdict = ask(validator, "echo all is well; exit 0", AMPLE);
            let Err(ValidateError::NoSentinel { output, .. }) = &verdict else { panic!("{verdict:?}") };
            assert_eq!(output, "all is well");
        }
    }

    #[test]
    fn a_garbled_answer_is_no_verdict() {
        let freecad = r#"echo '{"read": true, "mess' > "$RESURF_SENTINEL""#;
        let openscad = "echo FFO > result.off";
        let huge = r#"head -c 2000000 /dev/zero > "$RESURF_SENTINEL""#;
        for (validator, script) in [(BOTH[0], freecad), (BOTH[1], openscad), (BOTH[0], huge)] {
            let verdict = ask(validator, script, AMPLE);
            assert!(matches!(verdict, Err(ValidateError::NoSentinel { .. })), "{verdict:?}");
        }
    }

    #[test]
    fn a_sentinel_that_says_nothing_is_a_refusal() {
        let script = r#"echo '{"read": false, "messages": []}' > "$RESURF_SENTINEL""#;
        let verdict = ask(ask_freecad, script, AMPLE).expect("a sentinel");
        assert!(!verdict.accepted && !verdict.messages.is_empty());
    }

    #[test]
    fn a_flood_of_output_is_cut_to_its_end() {
        let verdict = ask(ask_freecad, "yes flood | head -c 3000000; echo; echo last", AMPLE);
        let Err(ValidateError::NoSentinel { output, .. }) = &verdict else { panic!("{verdict:?}") };
        assert!(output.len() < 100_000 && output.ends_with("last"));
    }

    #[test]
    fn a_csg_result_of_other_volume_or_without_a_triangle_is_a_refusal() {
        for result in ["OFF 0 0 0", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3"] {
            let script = format!("printf '{}' > result.off", result.replace('\n', "\\n"));
            let verdict = ask(ask_openscad, &script, AMPLE).expect("a result");
            assert!(!verdict.accepted, "{verdict:?}");
        }
    }

    #[test]
    fn a_program_that_may_not_run_is_named() {
        let directory = scratch();
        let file = write_off(&cube(1.0), directory.path());
        let verdict =
            ask_freecad(&Request { program: Some(file.as_os_str()), ..request(&file, directory.path()) });
        assert!(matches!(verdict, Err(ValidateError::NotRunnable { .. })), "{verdict:?}");
    }
}
