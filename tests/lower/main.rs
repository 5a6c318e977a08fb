//! Change sets lowered to byte edits, seen from the file that comes out: it is read again and compared.
//!
//! The expected geometry is the affine image that was asked for; everything else must be as it was.

mod block;
#[path = "../support/mod.rs"]
mod support;
mod topology;

use std::collections::BTreeMap;

use resurf::brep::FaceId;
use resurf::brep::id::Id;
use resurf::diagnostic::Diagnostics;
use resurf::exchange::Patch;
use resurf::geometry::{Curve, Surface};
use resurf::math::{Affine, Matrix3, Point3, Vector3};
use resurf::model::{ChangeSet, Model};
use resurf::source::Source;
use resurf::step::reverse_index::ReverseIndex;
use resurf::step::{ExchangeStructure, lower, to_model};

struct Part {
    structure: ExchangeStructure,
    model: Model,
}

fn read(bytes: Vec<u8>) -> Part {
    let mut diagnostics = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut diagnostics);
    let model = to_model(&structure, &mut diagnostics);
    Part { structure, model }
}

fn sample(path: &str) -> Part {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(path);
    read(std::fs::read(path).expect("a committed sample"))
}

fn patched(part: &Part, changes: &ChangeSet) -> (Patch, Part) {
    let patch = lower(&part.structure, &part.model, changes).expect("every change can be written");
    let after = read(patch.apply(part.structure.source().bytes()));
    (patch, after)
}

/// The image of faces with their edges, vertices and parameter curves; `None` when a kind cannot follow.
fn image(model: &Model, faces: &[FaceId], map: &Affine) -> Option<ChangeSet> {
    let brep = &model.brep;
    let mut changes = ChangeSet::default();
    for &face in faces {
        let surface = brep.surface_of(face).read()?;
        changes.surfaces.insert(face, surface.transformed(map).ok()?);
        let parameters = surface.parameter_map(map).ok()?;
        for coedge in brep.coedges_of(face) {
            let edge = brep.coedges[coedge].edge;
            changes.curves.insert(edge, brep.curve_of(edge).read()?.transformed(map).ok()?);
            for vertex in [brep.edges[edge].start, brep.edges[edge].end] {
                changes.points.insert(vertex, map.point(&brep.vertices[vertex].point));
            }
            if let (Some(pcurve), false) = (&brep.coedges[coedge].pcurve, parameters.is_identity()) {
                changes.pcurves.insert(coedge, pcurve.transformed(&parameters).ok()?);
            }
        }
    }
    Some(changes)
}

fn all_faces(model: &Model) -> Vec<FaceId> {
    model.brep.faces.ids().collect()
}

fn stretch() -> Affine {
    Affine::about(&Point3::new(10.0, -3.0, 5.0), Matrix3::from_diagonal(&Vector3::new(1.1, 1.2, 1.25)))
}

/// How often each text of a record without its name and numbers stands in the file: a picture of what it holds.
fn keywords(part: &Part) -> BTreeMap<Vec<u8>, usize> {
    let mut counts = BTreeMap::new();
    for instance in part.structure.instances() {
        for record in instance.records() {
            *counts.entry(record.keyword().to_vec()).or_insert(0) += 1;
        }
    }
    counts
}

fn assert_nothing_dangles(after: &Part) {
    let mut diagnostics = Diagnostics::default();
    after.structure.unresolved_references(&mut diagnostics);
    assert_eq!(diagnostics.kept(), [], "every reference of the result has its record");
}

/// Records that nobody uses, by keyword: the operation must leave none behind.
fn unused(part: &Part) -> BTreeMap<Vec<u8>, usize> {
    let users = ReverseIndex::build(&part.structure);
    let mut counts = BTreeMap::new();
    for instance in part.structure.instances() {
        if users.users_at(instance.position()).is_empty() {
            let keyword = instance.records().next().map_or(&b""[..], |record| record.keyword());
            *counts.entry(keyword.to_vec()).or_insert(0) += 1;
        }
    }
    counts
}

/// Largest distance between the geometry that was asked for and the geometry that the file now says.
fn deviation(changes: &ChangeSet, after: &Model) -> f64 {
    let brep = &after.brep;
    let mut worst = 0.0_f64;
    for (&face, wanted) in &changes.surfaces {
        let found = brep.surface_of(face).read().expect("the new surface is read");
        assert_eq!(found.kind(), wanted.kind());
        let ((u0, u1), (v0, v1)) = match wanted {
            Surface::Nurbs(spline) => spline.domain(),
            _ => ((0.0, 1.0), (0.0, 1.0)),
        };
        for (a, b) in [(0.1, 0.2), (0.5, 0.5), (0.9, 0.3), (0.7, 0.8)] {
            let (u, v) = (u0 + a * (u1 - u0), v0 + b * (v1 - v0));
            worst = worst.max((found.point(u, v) - wanted.point(u, v)).norm());
        }
    }
    for (&edge, wanted) in &changes.curves {
        let found = brep.curve_of(edge).read().expect("the new curve is read");
        let (start, end) = match wanted {
            Curve::Nurbs(spline) => spline.domain(),
            _ => (0.0, 1.0),
        };
        for share in [0.0, 0.3, 0.8] {
            let t = start + share * (end - start);
            worst = worst.max((found.point_at(t) - wanted.point_at(t)).norm());
        }
    }
    for (&vertex, wanted) in &changes.points {
        worst = worst.max((brep.vertices[vertex].point - wanted).norm());
    }
    worst
}

#[test]
fn the_empty_change_set_is_the_empty_patch() {
    for path in ["door/door.step", "door-solid/door-solid.step", "assembly/assembly.step"] {
        let part = sample(path);
        let (patch, _) = patched(&part, &ChangeSet::default());
        assert!(patch.is_empty());
    }
}

#[test]
fn scaled_samples_say_what_was_asked_and_keep_everything_else() {
    for path in
        ["door/door.step", "hood/hood-ap242.step", "door-solid/door-solid.step", "assembly/assembly.step"]
    {
        let part = sample(path);
        let changes =
            image(&part.model, &all_faces(&part.model), &stretch()).expect("samples follow every map");
        let (patch, after) = patched(&part, &changes);
        assert!(!patch.is_empty());
        assert!(deviation(&changes, &after.model) <= 1e-11, "{path}: to rounding on a part of 1.2 m");
        assert_eq!(keywords(&part), keywords(&after), "{path}: same records, other numbers");
        assert_eq!(unused(&part), unused(&after), "{path}");
        assert_nothing_dangles(&after);
        for face in part.model.brep.faces.ids() {
            assert_eq!(part.model.faces[face], after.model.faces[face], "{path}: name, colour, layers");
            assert_eq!(part.model.origins.faces[face], after.model.origins.faces[face], "{path}");
        }
    }
}

#[test]
fn a_refined_net_takes_the_place_of_the_old_one_and_leaves_no_orphan() {
    let part = sample("door/door.step");
    let face = FaceId::from_index(0);
    let Some(Surface::Nurbs(net)) = part.model.brep.surface_of(face).read() else { panic!("a spline face") };
    let refined = net.refined_u(&[0.11, 0.57]).expect("inside the domain");
    let mut changes = ChangeSet::default();
    changes.surfaces.insert(face, Surface::Nurbs(refined));
    let (patch, after) = patched(&part, &changes);
    assert!(deviation(&changes, &after.model) <= 1e-12);
    assert_eq!(unused(&part), unused(&after));
    assert_nothing_dangles(&after);
    let points = |part: &Part| keywords(part)[&b"CARTESIAN_POINT"[..]];
    let (rows, columns) = net.shape();
    // Corners of the net may be shared with vertices and edges, which stay on the old points.
    let gained = points(&after) - points(&part);
    assert!((2 * columns..=2 * columns + 2 * (rows + columns)).contains(&gained), "gained {gained}");
    assert_eq!(part.model.origins.surfaces, after.model.origins.surfaces, "the surface keeps its name");
    assert!(patch.counts().bytes_untouched * 10 > part.structure.source().bytes().len() * 7);
}

#[test]
fn a_shared_point_is_split_when_one_user_moves() {
    let text = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
        FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
        #1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=CARTESIAN_POINT('',(1.,0.,0.));\n\
        #3=DIRECTION('',(1.,0.,0.));\n#4=VECTOR('',#3,1.);\n#5=LINE('',#1,#4);\n\
        #6=VERTEX_POINT('',#1);\n#7=VERTEX_POINT('',#2);\n#8=EDGE_CURVE('',#6,#7,#5,.T.);\n\
        #9=ORIENTED_EDGE('',*,*,#8,.T.);\n#10=EDGE_LOOP('',(#9));\n#11=FACE_OUTER_BOUND('',#10,.T.);\n\
        #12=DIRECTION('',(0.,0.,1.));\n#13=AXIS2_PLACEMENT_3D('',#1,#12,#3);\n#14=PLANE('',#13);\n\
        #15=ADVANCED_FACE('',(#11),#14,.T.);\n#16=OPEN_SHELL('',(#15));\n\
        #17=SHELL_BASED_SURFACE_MODEL('',(#16));\nENDSEC;\nEND-ISO-10303-21;\n";
    let part = read(text.as_bytes().to_vec());
    let mut changes = ChangeSet::default();
    let vertex = part.model.brep.edges[resurf::brep::EdgeId::from_index(0)].start;
    changes.points.insert(vertex, Point3::new(0.5, 0.0, 0.0));
    let (patch, after) = patched(&part, &changes);
    let out = String::from_utf8(patch.apply(text.as_bytes())).expect("ASCII");
    let expected = text
        .replace("#6=VERTEX_POINT('',#1);", "#6=VERTEX_POINT('',#18);")
        .replace("ENDSEC;\nEND-ISO", "#18=CARTESIAN_POINT('',(0.5,0.,0.));\nENDSEC;\nEND-ISO");
    assert_eq!(out, expected, "line and placement stay on the shared point");
    assert_eq!(after.model.brep.vertices[vertex].point, Point3::new(0.5, 0.0, 0.0));
}

/// A file with one free curve: degree 2 over knots that are not clamped, so that the model's net is not the
/// file's.
const UNCLAMPED: &str = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n\
    #1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=CARTESIAN_POINT('',(1.,2.,0.));\n\
    #3=CARTESIAN_POINT('',(3.,2.,1.));\n#4=CARTESIAN_POINT('',(4.,0.,1.));\n\
    #5=B_SPLINE_CURVE_WITH_KNOTS('c',2,(#1,#2,#3,#4),.UNSPECIFIED.,.F.,.F.,(1,1,1,1,1,1,1),\
    (0.,1.,2.,3.,4.,5.,6.),.UNSPECIFIED.);\n#6=GEOMETRIC_CURVE_SET('',(#5));\n\
    #7=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#8,#9))REPRESENTATION_CONTEXT('',''));\n\
    #8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
    #9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
    #10=SHAPE_REPRESENTATION('',(#6),#7);\nENDSEC;\nEND-ISO-10303-21;\n";

#[test]
fn a_curve_with_unclamped_knots_is_written_with_knots_that_fit_its_points() {
    let part = read(UNCLAMPED.as_bytes().to_vec());
    let [curve] = part.model.free_curves[..] else { panic!("one free curve") };
    let old = part.model.brep.curves[curve].read().expect("read");
    // By the blending of the middle span, C(2.5) = (P0 + 6 P1 + P2) / 8.
    let middle = Point3::new(9.0 / 8.0, 14.0 / 8.0, 1.0 / 8.0);
    assert!((old.point_at(2.5) - middle).norm() <= 1e-15);
    let half = Affine::about(&Point3::origin(), Matrix3::identity() * 0.5);
    let mut changes = ChangeSet::default();
    changes.free_curves.insert(curve, old.transformed(&half).expect("a spline follows every map"));
    let (_, after) = patched(&part, &changes);
    let new = after.model.brep.curves[after.model.free_curves[0]].read().expect("read again");
    assert!((new.point_at(2.5) - Point3::from(middle.coords * 0.5)).norm() <= 1e-15);
    assert_nothing_dangles(&after);
}

#[test]
fn corpus_parts_follow_a_rigid_motion_and_come_back_alike() {
    let angle = 0.3_f64;
    let (s, c) = angle.sin_cos();
    let turn = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let map = Affine::about(&Point3::new(0.02, 0.01, 0.0), turn)
        .after(&Affine::translation(Vector3::new(0.5, 0.0, 1.0)));
    for path in support::corpus_files(support::STEP) {
        let part = read(std::fs::read(&path).expect("a file of the corpus"));
        let Some(changes) = image(&part.model, &all_faces(&part.model), &map) else { continue };
        if changes.is_empty() {
            continue;
        }
        let Ok(patch) = lower(&part.structure, &part.model, &changes) else {
            panic!("{}: {:?}", path.display(), lower(&part.structure, &part.model, &changes).err());
        };
        let after = read(patch.apply(part.structure.source().bytes()));
        let size = part.model.brep.vertices.iter().map(|(_, v)| v.point.coords.norm()).fold(1.0, f64::max);
        let worst = deviation(&changes, &after.model);
        assert!(worst <= 1e-9 * size, "{}: {worst}", path.display());
        assert_eq!(part.model.brep.faces.len(), after.model.brep.faces.len(), "{}", path.display());
        assert_nothing_dangles(&after);
    }
}
