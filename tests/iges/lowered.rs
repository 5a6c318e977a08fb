//! Change sets written into a solid: which cards change, what becomes null, and what the result is read as.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use resurf::brep::FaceId;
use resurf::diagnostic::Diagnostics;
use resurf::geometry::Surface;
use resurf::iges::{EntryNumber, ExchangeStructure, lower, to_model};
use resurf::math::Point3;
use resurf::model::{ChangeSet, Model, Origin};
use resurf::source::Source;

fn read(bytes: Vec<u8>) -> (ExchangeStructure, Model) {
    let mut sink = Diagnostics::default();
    let structure = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
    structure.unresolved_pointers(&mut sink);
    structure.damaged_records(&mut sink);
    let model = to_model(&structure, &mut sink);
    assert_eq!(sink.kept(), []);
    (structure, model)
}

fn solid() -> (ExchangeStructure, Model) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/solid.igs");
    read(std::fs::read(path).expect("the seed is there"))
}

fn changed(structure: &ExchangeStructure, model: &Model, changes: &ChangeSet) -> Vec<u8> {
    let changes = lower(structure, model, changes).expect("can be written");
    let patch = resurf::iges::lower::patch(structure, &changes).expect("disjoint");
    patch.apply(structure.source().bytes())
}

/// Columns 1 to 64 of the parameter cards of each entry.
fn cards(bytes: &[u8]) -> BTreeMap<u32, Vec<String>> {
    let mut of: BTreeMap<u32, Vec<String>> = BTreeMap::new();
    let text = String::from_utf8(bytes.to_vec()).expect("ASCII");
    for line in text.lines().filter(|line| &line[72..73] == "P") {
        let back = line[64..72].trim().parse().expect("a pointer");
        of.entry(back).or_default().push(line[..64].to_owned());
    }
    of
}

/// Entries whose cards differ.
fn touched(before: &[u8], after: &[u8]) -> BTreeSet<u32> {
    let (before, after) = (cards(before), cards(after));
    let numbers = before.keys().chain(after.keys()).copied();
    numbers.filter(|number| before.get(number) != after.get(number)).collect()
}

#[test]
fn no_change_is_no_edit() {
    let (structure, model) = solid();
    assert_eq!(changed(&structure, &model, &ChangeSet::default()), structure.source().bytes());
}

#[test]
fn a_surface_of_another_kind_keeps_its_entry_and_what_it_was_made_of_becomes_null() {
    let (structure, model) = solid();
    let face: FaceId = model.brep.faces.ids().next().expect("a face");
    let plane = model.brep.surface_of(face).read().expect("read");
    assert!(matches!(plane, Surface::Plane(_)));
    let spline = plane.to_nurbs((-500.0, 500.0), (-500.0, 500.0)).expect("a spline");
    let changes = ChangeSet { surfaces: [(face, Surface::Nurbs(spline))].into(), ..ChangeSet::default() };
    let bytes = changed(&structure, &model, &changes);
    let Origin::DirectoryEntry(number) = model.origins.surfaces[model.brep.faces[face].surface] else {
        panic!("no entry")
    };
    let parts: BTreeSet<u32> = structure
        .instance(EntryNumber(number))
        .and_then(resurf::iges::EntityView::of)
        .expect("a view")
        .parts()
        .into_iter()
        .map(|(part, _)| part.0)
        .collect();
    assert_eq!(parts.len(), 3);
    let (again, after) = read(bytes.clone());
    assert_eq!(again.instance(EntryNumber(number)).expect("still there").entry().entity_type, 128);
    for part in &parts {
        let entry = *again.instance(EntryNumber(*part)).expect("still there").entry();
        assert_eq!((entry.entity_type, entry.form), (0, 0));
    }
    let expected: BTreeSet<u32> = parts.into_iter().chain([number]).collect();
    assert_eq!(touched(structure.source().bytes(), &bytes), expected);
    assert_eq!(again.len(), structure.len());
    assert_eq!(after.brep.faces.len(), model.brep.faces.len());
    let Some(Surface::Nurbs(written)) = after.brep.surface_of(face).read() else { panic!("no spline") };
    for (u, v) in [(0.0, 0.0), (12.5, -30.0), (499.0, 499.0)] {
        assert!((written.point(u, v) - plane.point(u, v)).norm() < 1e-12);
    }
}

#[test]
fn a_vertex_moves_in_its_list_alone() {
    let (structure, model) = solid();
    let vertex = model.brep.vertices.ids().next().expect("a vertex");
    let place = Point3::new(0.125, -3.0, 1.0 / 3.0);
    let changes = ChangeSet { points: [(vertex, place)].into(), ..ChangeSet::default() };
    let bytes = changed(&structure, &model, &changes);
    let (again, after) = read(bytes.clone());
    assert_eq!(after.brep.vertices[vertex].point, place);
    // Its edges are lines, whose ends move with it.
    let kinds = touched(structure.source().bytes(), &bytes)
        .into_iter()
        .map(|number| again.instance(EntryNumber(number)).expect("there").entry().entity_type);
    let kinds: BTreeSet<i32> = kinds.collect();
    assert!(kinds.contains(&502) && kinds.iter().all(|kind| [110, 502].contains(kind)), "{kinds:?}");
    for (id, other) in model.brep.vertices.iter().filter(|(id, _)| *id != vertex) {
        assert_eq!(after.brep.vertices[id].point, other.point);
    }
}
