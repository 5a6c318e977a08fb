//! Faces, edges and bounds that come and go: a pocket drilled into a block and filled again, a notch across its
//! border. Volumes are those of the solids by their formulas.

use std::f64::consts::{PI, TAU};

use resurf::brep::check::check;
use resurf::brep::mass_properties::{Quadrature, of_body};
use resurf::brep::{BodyId, Brep, EdgeId, FaceId, LoopId};
use resurf::geometry::{Curve, Curve2d, Surface};
use resurf::math::{Frame, Point2, Point3, Vector2, Vector3};
use resurf::model::change_set::{
    EdgeCurve, EdgeRef, NewBound, NewCoedge, NewEdge, NewEdgeId, NewFace, NewSurface, NewVertexId, VertexRef,
};
use resurf::model::{Balance, ChangeSet, Model};
use resurf::step::lower::{LowerError, lower};

use super::block::{Block, TOP};
use super::{Part, assert_nothing_dangles, keywords, patched, read, unused};
use resurf::brep::id::Id;

const SIZE: [f64; 3] = [40.0, 30.0, 10.0];
const RADIUS: f64 = 5.0;
const DEPTH: f64 = 4.0;

fn block(degrees: bool) -> Part {
    read(Block { size: SIZE, degrees, dimension: false }.step().into_bytes())
}

fn top(model: &Model) -> FaceId {
    model.faces.iter().find(|(_, face)| face.name == TOP).expect("the top face").0
}

fn volume(model: &Model) -> f64 {
    of_body(&model.brep, BodyId::from_index(0), &Quadrature::exact(1e-6)).expect("measured").volume()
}

fn findings(brep: &Brep) -> Vec<String> {
    check(brep, &|_| 1e-6).iter().map(|finding| format!("{finding:?}")).collect()
}

fn frame(origin: Point3<f64>, x: Vector3<f64>, z: Vector3<f64>) -> Frame {
    Frame { origin, x, y: z.cross(&x), z }
}

fn own(curve: Curve, at: VertexRef) -> NewEdge {
    NewEdge { curve: EdgeCurve::Own(curve), start: at, end: at }
}

fn circle2(center: Point2<f64>, radius: f64, turned: bool) -> Curve2d {
    let (x, y) = (Vector2::x(), if turned { -Vector2::y() } else { Vector2::y() });
    Curve2d::Ellipse { center, x, y, semi_axis_1: radius, semi_axis_2: radius }
}

/// A round pocket in the top face: two circles, a seam, a wall and a floor.
fn pocket(model: &Model) -> ChangeSet {
    let (face, up) = (top(model), Vector3::z());
    let mut changes = ChangeSet::default();
    let middle = Point3::new(20.0, 15.0, SIZE[2]);
    let floor = middle - up * DEPTH;
    let [upper, lower] = [middle, floor].map(|p| changes.new_vertices.push(p + Vector3::x() * RADIUS));
    let circle = |origin| Curve::Circle { frame: frame(origin, Vector3::x(), up), radius: RADIUS };
    let rim = changes.new_edges.push(own(circle(middle), VertexRef::New(upper)));
    let foot = changes.new_edges.push(own(circle(floor), VertexRef::New(lower)));
    let line = Curve::Line { origin: floor + Vector3::x() * RADIUS, direction: up * DEPTH };
    let [start, end] = [lower, upper].map(VertexRef::New);
    let seam = changes.new_edges.push(NewEdge { curve: EdgeCurve::Own(line), start, end });
    let coedge =
        |edge, forward, pcurve| NewCoedge { edge: EdgeRef::New(edge), forward, pcurve: Some(pcurve) };
    // The top's own frame has x and y of space; the rim runs clockwise about the normal there.
    let on_top = circle2(Point2::new(middle.x, middle.y), RADIUS, false);
    let hole = NewBound { outer: false, coedges: vec![coedge(rim, false, on_top)] };
    changes.new_bounds.insert(face, vec![hole]);
    let level = |v: f64| Curve2d::Line { origin: Point2::new(0.0, v), direction: Vector2::x() };
    let side = |u: f64| Curve2d::Line { origin: Point2::new(u, 0.0), direction: Vector2::y() * DEPTH };
    // The wall's normal looks to its axis, against the cylinder's.
    let around = vec![
        coedge(rim, true, level(DEPTH)),
        coedge(seam, false, side(TAU)),
        coedge(foot, false, level(0.0)),
        coedge(seam, true, side(0.0)),
    ];
    let surface =
        NewSurface::Own(Surface::Cylinder { frame: frame(floor, Vector3::x(), up), radius: RADIUS });
    let bounds = vec![NewBound { outer: true, coedges: around }];
    changes.new_faces.push(NewFace { beside: face, surface, same_sense: false, bounds });
    let on_floor = coedge(foot, true, circle2(Point2::origin(), RADIUS, false));
    let bounds = vec![NewBound { outer: true, coedges: vec![on_floor] }];
    let surface = NewSurface::Own(Surface::Plane(frame(floor, Vector3::x(), up)));
    changes.new_faces.push(NewFace { beside: face, surface, same_sense: true, bounds });
    changes
}

fn counts(model: &Model) -> [isize; 3] {
    let inventory = resurf::model::Inventory::of(model);
    [inventory.faces, inventory.edges, inventory.vertices].map(|n| n as isize)
}

fn assert_balance(before: &Model, changes: &ChangeSet, after: &Model) {
    let Balance { faces, edges, vertices } = Balance::of(before, changes);
    let was = counts(before);
    assert_eq!(counts(after), [was[0] + faces, was[1] + edges, was[2] + vertices]);
}

#[test]
fn a_pocket_has_the_volume_of_its_formula_and_the_look_of_its_face() {
    for degrees in [false, true] {
        let part = block(degrees);
        assert_eq!(findings(&part.model.brep), Vec::<String>::new());
        let changes = pocket(&part.model);
        let (patch, after) = patched(&part, &changes);
        assert_eq!(findings(&after.model.brep), Vec::<String>::new(), "degrees: {degrees}");
        let expected = SIZE.iter().product::<f64>() - PI * RADIUS * RADIUS * DEPTH;
        assert!((volume(&after.model) - expected).abs() <= 1e-9 * expected);
        assert_balance(&part.model, &changes, &after.model);
        assert_nothing_dangles(&after);
        assert_eq!(unused(&part), unused(&after));
        // Only insertions: no byte of the block is lost.
        assert_eq!(patch.counts().bytes_untouched, part.structure.source().bytes().len());
        let looks: Vec<_> = after.model.faces.iter().filter(|(_, face)| face.name == TOP).collect();
        assert_eq!(looks.len(), 3);
        assert!(looks.iter().all(|(_, face)| *face == looks[0].1 && face.layers == ["12"]));
        assert!(looks[0].1.appearance.colour.is_some());
    }
}

#[test]
fn curves_in_parameters_come_back_as_they_were_given_whatever_the_unit_of_angle() {
    for degrees in [false, true] {
        let part = block(degrees);
        let changes = pocket(&part.model);
        let (_, after) = patched(&part, &changes);
        let brep = &after.model.brep;
        let wall =
            brep.faces.ids().find(|&f| brep.surface_of(f).read().is_some_and(|s| s.kind() == "cylinder"));
        let written = &changes.new_faces[0].bounds[0].coedges;
        for (coedge, wanted) in brep.coedges_of(wall.expect("the wall")).zip(written) {
            let found = brep.coedges[coedge].pcurve.as_ref().expect("a curve in parameters");
            for t in [0.0, 0.3, 1.0] {
                let wanted = wanted.pcurve.as_ref().expect("given").point_at(t);
                assert!((found.point_at(t) - wanted).norm() <= 1e-14, "degrees: {degrees}");
            }
        }
    }
}

#[test]
fn a_filled_pocket_leaves_the_records_of_the_block() {
    let part = block(true);
    let (_, drilled) = patched(&part, &pocket(&part.model));
    let model = &drilled.model;
    let mut changes = ChangeSet::default();
    let named = |&(_, face): &(FaceId, &resurf::model::Attributes)| face.name == TOP;
    let faces: Vec<FaceId> = model.faces.iter().filter(named).map(|(id, _)| id).collect();
    let hole = model.brep.faces[faces[0]].loops.iter().find(|&&l| !model.brep.loops[l].outer);
    changes.removed_bounds.insert(*hole.expect("the pocket's rim"));
    changes.removed_faces.extend(&faces[1..]);
    let (_, filled) = patched(&drilled, &changes);
    assert_eq!(findings(&filled.model.brep), Vec::<String>::new());
    assert_eq!(volume(&filled.model), volume(&part.model));
    assert_balance(model, &changes, &filled.model);
    assert_eq!(keywords(&filled), keywords(&part), "nothing of the pocket is left");
    let text = |part: &Part| part.structure.source().bytes().to_vec();
    assert_eq!(text(&filled), text(&part), "the lists, too, are as they were");
}

/// A slot in the top that is open at the wall y = 0: an edge of the border is cut into two pieces, which the top and
/// the wall share with the slot's own edges between them.
struct Slot<'m> {
    model: &'m Model,
    changes: ChangeSet,
    /// Corners: bit 0 the far x, bit 1 the far y, bit 2 the top.
    corners: Vec<NewVertexId>,
}

const SLOT: [[f64; 2]; 3] = [[10.0, 25.0], [0.0, 12.0], [SIZE[2] - 3.0, SIZE[2]]];

impl<'m> Slot<'m> {
    fn new(model: &'m Model) -> Self {
        let mut changes = ChangeSet::default();
        let corner = |bits: usize| Point3::from([0, 1, 2].map(|k| SLOT[k][bits >> k & 1]));
        let corners = (0..8).map(|bits| changes.new_vertices.push(corner(bits))).collect();
        Self { model, changes, corners }
    }

    fn edge(&mut self, from: usize, to: usize) -> NewEdgeId {
        let [a, b] = [from, to].map(|bits| self.changes.new_vertices[self.corners[bits]]);
        let curve = EdgeCurve::Own(Curve::Line { origin: a, direction: b - a });
        let [start, end] = [from, to].map(|bits| VertexRef::New(self.corners[bits]));
        self.changes.new_edges.push(NewEdge { curve, start, end })
    }

    /// The use of an edge on a plane, with its line in the plane's own coordinates.
    fn on(&self, ground: &Frame, edge: NewEdgeId, forward: bool) -> NewCoedge {
        let EdgeCurve::Own(Curve::Line { origin, direction }) = &self.changes.new_edges[edge].curve else {
            return NewCoedge { edge: EdgeRef::New(edge), forward, pcurve: None };
        };
        let flat = |v: &Vector3<f64>| Vector2::new(v.dot(&ground.x), v.dot(&ground.y));
        let origin = Point2::from(flat(&(origin - ground.origin)));
        let pcurve = Some(Curve2d::Line { origin, direction: flat(direction) });
        NewCoedge { edge: EdgeRef::New(edge), forward, pcurve }
    }

    fn add_face(&mut self, ground: Frame, ring: [(NewEdgeId, bool); 4]) {
        let coedges = ring.map(|(edge, forward)| self.on(&ground, edge, forward)).to_vec();
        let bounds = vec![NewBound { outer: true, coedges }];
        let surface = NewSurface::Own(Surface::Plane(ground));
        self.changes.new_faces.push(NewFace { beside: top(self.model), surface, same_sense: true, bounds });
    }

    /// Puts a chain of new edges, given along the split edge, in its place in a bound.
    fn splice(&mut self, owner: FaceId, split: EdgeId, chain: Vec<(NewEdgeId, bool)>) {
        let brep = &self.model.brep;
        let Some(Surface::Plane(ground)) = brep.surface_of(owner).read() else { panic!("a plane") };
        let bound: LoopId = brep.faces[owner].loops[0];
        let mut coedges = Vec::new();
        for &id in &brep.loops[bound].coedges {
            let coedge = &brep.coedges[id];
            if coedge.edge != split {
                let edge = EdgeRef::Kept(coedge.edge);
                coedges.push(NewCoedge { edge, forward: coedge.forward, pcurve: None });
                continue;
            }
            let along = chain.iter().map(|&(edge, forward)| self.on(ground, edge, forward == coedge.forward));
            let mut along: Vec<_> = along.collect();
            if !coedge.forward {
                along.reverse();
            }
            coedges.extend(along);
        }
        self.changes.removed_bounds.insert(bound);
        self.changes.new_bounds.insert(owner, vec![NewBound { outer: true, coedges }]);
    }
}

fn slot(model: &Model) -> ChangeSet {
    let brep = &model.brep;
    let mut slot = Slot::new(model);
    // Edges of the slot by their corners; those along y, z and x.
    let [y0, y1, y4, y5] = [0, 1, 4, 5].map(|bits| slot.edge(bits, bits | 2));
    let [z0, z1, z2, z3] = [0, 1, 2, 3].map(|bits| slot.edge(bits, bits | 4));
    let [x0, x2, x6] = [0, 2, 6].map(|bits| slot.edge(bits, bits | 1));
    let at = |bits: usize| Point3::from([0, 1, 2].map(|k| SLOT[k][bits >> k & 1]));
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    slot.add_face(frame(at(0), x, z), [(x0, true), (y1, true), (x2, false), (y0, false)]);
    slot.add_face(frame(at(0), y, x), [(y0, true), (z2, true), (y4, false), (z0, false)]);
    slot.add_face(frame(at(1), z, -x), [(z1, true), (y5, true), (z3, false), (y1, false)]);
    slot.add_face(frame(at(2), z, -y), [(z2, false), (x2, true), (z3, true), (x6, false)]);
    let ends = |edge: EdgeId| [brep.edges[edge].start, brep.edges[edge].end].map(|v| brep.vertices[v].point);
    let border = |edge: &EdgeId| ends(*edge).iter().all(|p| p.y == 0.0 && p.z == SIZE[2]);
    let split = brep.edges.ids().find(border).expect("the top's edge at y = 0");
    assert!(ends(split)[0].x < ends(split)[1].x);
    let [left, right] = [slot.corners[4], slot.corners[5]].map(VertexRef::New);
    let mut piece =
        |start, end| slot.changes.new_edges.push(NewEdge { curve: EdgeCurve::Of(split), start, end });
    let first = piece(VertexRef::Kept(brep.edges[split].start), left);
    let last = piece(right, VertexRef::Kept(brep.edges[split].end));
    let on_top = vec![(first, true), (y4, true), (x6, true), (y5, false), (last, true)];
    slot.splice(top(model), split, on_top);
    let users = brep.faces_of_edges();
    let wall = users[split].iter().find(|&&face| face != top(model)).expect("the wall");
    slot.splice(*wall, split, vec![(first, true), (z0, false), (x0, true), (z1, true), (last, true)]);
    slot.changes
}

#[test]
fn a_slot_that_opens_at_the_border_splits_an_edge_of_two_faces() {
    let part = block(false);
    let changes = slot(&part.model);
    let (_, after) = patched(&part, &changes);
    assert_eq!(findings(&after.model.brep), Vec::<String>::new());
    let slot: f64 = SLOT.iter().map(|[low, high]| high - low).product();
    let expected = SIZE.iter().product::<f64>() - slot;
    assert!((volume(&after.model) - expected).abs() <= 1e-12 * expected);
    assert_balance(&part.model, &changes, &after.model);
    assert_nothing_dangles(&after);
    assert_eq!(unused(&part), unused(&after));
    let edges = |part: &Part| keywords(part)[&b"EDGE_CURVE"[..]];
    assert_eq!(edges(&after), edges(&part) - 1 + 2 + 11, "the split edge is gone, its line is not");
}

#[test]
fn a_face_that_a_dimension_is_about_cannot_go() {
    let part = read(Block { size: SIZE, degrees: false, dimension: true }.step().into_bytes());
    let mut changes = ChangeSet::default();
    changes.removed_faces.insert(top(&part.model));
    let error = lower(&part.structure, &part.model, &changes).expect_err("refused");
    let LowerError::StillNeeded { entity, line, .. } = &error else { panic!("{error}") };
    assert_eq!(entity, "GEOMETRIC_ITEM_SPECIFIC_USAGE");
    let text = String::from_utf8(part.structure.source().bytes().to_vec()).expect("ASCII");
    let place = text.lines().position(|line| line.contains("GEOMETRIC_ITEM_SPECIFIC_USAGE"));
    assert_eq!(Some(*line), place.map(|at| at + 1));
}
