//! From models to change sets.

use resurf::brep::id::Id;
use resurf::brep::parameter_loop::{LoopSampling, parameter_loops};
use resurf::brep::{EdgeId, FaceId, LoopId};
use resurf::geometry::{Carried, Curve, Surface};
use resurf::math::{Frame, Point3, Vector3};
use resurf::model::Model;
use resurf::ops::OperationError;
use resurf::ops::constrained_scale::plan::{HoldTarget, LoopFilter, Params, Plan, Scope, Wall, plan};
use resurf::ops::constrained_scale::{Hold, Scaling};

use super::models::{BOTTOM, FIRST_WALL, Hole, TOP, applied, polygon_hole, round_hole, thin_solid};
use super::parts::{door, hood, part, small, trunk};

const GROW: [f64; 3] = [1.1, 1.2, 1.25];

fn flat() -> resurf::geometry::nurbs::NurbsSurface {
    part([3, 3], [6, 6], |x, y| [400.0 * x, 300.0 * y, 0.0])
}

fn flat_solid() -> Model {
    let holes = [round_hole(120.0, 150.0, 25.0), round_hole(280.0, 150.0, 25.0)];
    thin_solid(&flat(), &holes, None)
}

fn curved_solid() -> Model {
    let holes: Vec<Hole> =
        [[0.3, 0.5], [0.7, 0.5]].iter().map(|c| polygon_hole(&small(), *c, [0.06, 0.08])).collect();
    thin_solid(&small(), &holes, None)
}

fn params(factors: [f64; 3]) -> Params {
    Params {
        scaling: Scaling::new(factors),
        scope: Scope::Part,
        hold: vec![HoldTarget::InnerLoops(LoopFilter::default())],
        mode: Hold::Rigid,
        wall: Wall::Rigid,
        stop: Vec::new(),
    }
}

fn planned(model: &Model, params: &Params) -> Plan {
    plan(model, params).unwrap()
}

fn refused(model: &Model, params: &Params) -> OperationError {
    plan(model, params).map(|_| ()).unwrap_err()
}

fn face(k: usize) -> FaceId {
    FaceId::from_index(k)
}

fn surface(model: &Model, k: usize) -> &Surface {
    model.brep.surface_of(face(k)).read().unwrap()
}

/// Greatest distance of any edge from any surface that it bounds, and of any vertex from the ends of its edges.
fn gap(model: &Model) -> f64 {
    let mut worst = 0.0_f64;
    for face in model.brep.faces.ids() {
        for found in parameter_loops(&model.brep, face, &LoopSampling::of_tolerance(1e-3)).unwrap() {
            worst = worst.max(found.gap);
        }
    }
    for edge in model.brep.edges.ids() {
        let curve = model.brep.curve_of(edge).read().unwrap();
        let ends = &model.brep.edges[edge];
        for vertex in [ends.start, ends.end] {
            let point = model.brep.vertices[vertex].point;
            let t = curve.parameter_of(&point, None);
            worst = worst.max((curve.point_at(t) - point).norm());
        }
    }
    worst
}

#[test]
fn a_thin_solid_stays_closed_and_its_hole_walls_rigid() {
    for (model, factors) in [(curved_solid(), GROW), (curved_solid(), [2.0; 3]), (flat_solid(), GROW)] {
        let plan = planned(&model, &params(factors));
        let (before, after) = (gap(&model), gap(&applied(&model, &plan.change_set)));
        // Edges that are approximate polygons scale with the part at worst.
        assert!(after <= 2.5 * before + 1e-9, "{before:.3e} became {after:.3e}");
        assert_eq!(plan.measures.groups.len(), 2);
        for group in &plan.measures.groups {
            assert_eq!(group.loops.len(), 2, "both ends of the hole");
            assert!(group.loops.iter().all(|l| l.rigid_deviation <= 1e-12));
        }
        assert_eq!(plan.measures.faces.len(), 2);
        assert!(plan.notes.is_empty());
    }
}

#[test]
fn door_trunk_lid_and_hood_stay_closed_as_solids() {
    let centers = [[[0.25, 0.7], [0.72, 0.62]], [[0.22, 0.35], [0.78, 0.35]], [[0.3, 0.5], [0.7, 0.5]]];
    for ((top, _), centers) in [door(), trunk(), hood()].into_iter().zip(centers) {
        let holes = centers.map(|center| polygon_hole(&top, center, [0.05, 0.05]));
        let model = thin_solid(&top, &holes, None);
        let before = gap(&model);
        for factors in [GROW, [2.0; 3]] {
            let plan = planned(&model, &params(factors));
            let scaled = applied(&model, &plan.change_set);
            // Edges that are polygons scale with the part at worst.
            let after = gap(&scaled);
            assert!(after <= 2.0 * before + 1e-9, "{before:.3e} became {after:.3e}");
            assert_eq!(plan.measures.groups.len(), 2);
            for held in plan.measures.groups.iter().flat_map(|group| &group.loops) {
                assert!(held.rigid_deviation <= 1e-12, "{held:?}");
            }
            let [pair] = plan.measures.skins.as_slice() else { panic!("{:?}", plan.measures.skins) };
            assert!(pair.least_ratio > 0.8, "{pair:?}");
        }
    }
}

#[test]
fn circles_and_cylinders_of_held_holes_keep_their_radii_to_the_bit() {
    let model = flat_solid();
    let plan = planned(&model, &params(GROW));
    let mut circles = 0;
    for (edge, curve) in &plan.change_set.curves {
        if let Some(Curve::Circle { .. }) = model.brep.curve_of(*edge).read() {
            let Curve::Circle { radius, .. } = curve else { panic!("a circle became a {}", curve.kind()) };
            assert_eq!(radius.to_bits(), 25.0_f64.to_bits());
            circles += 1;
        }
    }
    assert_eq!(circles, 4);
    for wall in [FIRST_WALL, FIRST_WALL + 1] {
        let Surface::Cylinder { radius, frame } = &plan.change_set.surfaces[&face(wall)] else { panic!() };
        assert_eq!(radius.to_bits(), 25.0_f64.to_bits());
        // Pivot of the upper loop scaled; both loops of the hole share it.
        let x = if wall == FIRST_WALL { 120.0 } else { 280.0 };
        assert!((frame.origin - Point3::new(1.1 * x, 1.2 * 150.0, frame.origin.z)).norm() < 1e-9);
    }
}

#[test]
fn what_is_not_held_gets_its_exact_affine_image() {
    let model = curved_solid();
    let plan = planned(&model, &params(GROW));
    let scaling = Scaling::new(GROW).affine().unwrap();
    let new = applied(&model, &plan.change_set);
    // Border edges are the first twelve of the model's edges.
    for k in 0..12 {
        let edge = EdgeId::from_index(k);
        let expected = model.brep.curve_of(edge).read().unwrap().transformed(&scaling).unwrap();
        assert_eq!(new.brep.curve_of(edge).read(), Some(&expected));
    }
    for k in 2..FIRST_WALL {
        assert_eq!(surface(&new, k), &surface(&model, k).transformed(&scaling).unwrap());
    }
}

#[test]
fn the_identity_changes_nothing() {
    let plan = planned(&flat_solid(), &params([1.0; 3]));
    assert!(plan.change_set.is_empty());
}

#[test]
fn an_element_whose_image_is_itself_is_not_in_the_change_set() {
    // Growth along z alone leaves the side walls' planes of constant x and y, but not the lower skin.
    let plan = planned(&flat_solid(), &Params { hold: Vec::new(), ..params([1.0, 1.0, 2.0]) });
    assert!(!plan.change_set.surfaces.contains_key(&face(TOP)), "the plane z = 0 is its own image");
    assert!(plan.change_set.surfaces.contains_key(&face(BOTTOM)));
}

#[test]
fn a_cylinder_across_which_factors_differ_is_extruded_from_an_ellipse() {
    let model = flat_solid();
    let plan = planned(&model, &Params { hold: Vec::new(), ..params(GROW) });
    let map = Scaling::new(GROW).affine().unwrap();
    for wall in [FIRST_WALL, FIRST_WALL + 1] {
        let image = &plan.change_set.surfaces[&face(wall)];
        assert_eq!(image.kind(), "linear_extrusion");
        // 1.2 > 1.1: the ellipse counts its angle from the other axis.
        for k in 0..16 {
            let (u, v) = (0.4 * f64::from(k), -0.2 * f64::from(k));
            let expected = map.point(&surface(&model, wall).point(u, v));
            let found = image.point(u - std::f64::consts::FRAC_PI_2, 1.25 * v);
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
    }
    // Equal factors keep them.
    let plan = planned(&model, &Params { hold: Vec::new(), ..params([2.0; 3]) });
    let Surface::Cylinder { radius, .. } = plan.change_set.surfaces[&face(FIRST_WALL)] else { panic!() };
    assert!((radius - 50.0).abs() < 1e-12);
}

#[test]
fn plain_scaling_refuses_what_has_no_exact_image_and_names_it() {
    let mut model = flat_solid();
    let id = model.brep.faces[face(FIRST_WALL)].surface;
    let basis = Box::new(surface(&model, FIRST_WALL).clone());
    model.brep.surfaces[id] = Carried::Read(Surface::Offset { basis, distance: 0.0 });
    let found = refused(&model, &Params { hold: Vec::new(), ..params(GROW) });
    let OperationError::CannotFollow { obstacles } = &found else { panic!("{found}") };
    let named: Vec<_> = obstacles.iter().map(|o| (o.entity.as_str(), o.kind.as_str())).collect();
    assert_eq!(named, [("#1006", "offset")]);
}

#[test]
fn geometry_that_was_not_read_is_named() {
    let mut model = flat_solid();
    let id = model.brep.faces[face(3)].surface;
    model.brep.surfaces[id] =
        Carried::Unread { entity: "OFFSET_SURFACE".to_owned(), reason: "not read yet".to_owned() };
    let found = refused(&model, &params(GROW));
    assert_eq!(found.to_string(), "1 element cannot follow: #1003 (OFFSET_SURFACE): not read yet");
    assert_eq!(found.code(), "scale.cannot-follow");
}

#[test]
fn a_face_alone_is_refused_and_its_neighbours_are_named() {
    let only_top = Params { scope: Scope::Faces(vec![face(TOP)]), ..params(GROW) };
    let found = refused(&curved_solid(), &only_top);
    let OperationError::NeighboursOutside { faces, neighbours } = &found else { panic!("{found}") };
    assert_eq!(faces, &["#1000"]);
    assert_eq!(neighbours, &["#1002", "#1003", "#1004", "#1005", "#1006", "#1007"]);
}

#[test]
fn a_hold_on_one_end_of_a_hole_spreads_to_the_other() {
    let model = curved_solid();
    let first_hole = model.brep.faces[face(TOP)].loops[1];
    let one = Params { hold: vec![HoldTarget::Loop(first_hole)], ..params(GROW) };
    // The other hole is scaled, and its wall with it.
    let plan = planned(&model, &one);
    assert_eq!(plan.measures.groups.len(), 1);
    assert_eq!(plan.measures.groups[0].loops.len(), 2);
    let spread: Vec<_> = plan.notes.iter().filter(|n| n.code == "scale.held-by-propagation").collect();
    assert_eq!(spread.len(), 1);
    let other = model.brep.faces[face(BOTTOM)].loops[1];
    assert_eq!(spread[0].entity.as_deref(), Some(model.origins.loops[other].to_string().as_str()));
    let (before, after) = (gap(&model), gap(&applied(&model, &plan.change_set)));
    assert!(after <= 2.5 * before + 1e-9, "{before:.3e} became {after:.3e}");
    // By an edge of the loop: the same.
    let edge = model.brep.coedges[model.brep.loops[first_hole].coedges[0]].edge;
    let by_edge = planned(&model, &Params { hold: vec![HoldTarget::Edge(edge)], ..params(GROW) });
    assert_eq!(by_edge.change_set, plan.change_set);
}

#[test]
fn a_hole_that_ends_on_a_plane_is_where_the_plane_is() {
    let frame =
        Frame { origin: Point3::new(0.0, 0.0, -3.0), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() };
    let model = thin_solid(&flat(), &[round_hole(200.0, 150.0, 30.0)], Some(Surface::Plane(frame)));
    let plan = planned(&model, &params(GROW));
    let new = applied(&model, &plan.change_set);
    let circles = |model: &Model| {
        let mut heights = Vec::new();
        for edge in model.brep.edges.ids() {
            if let Some(Curve::Circle { frame, radius }) = model.brep.curve_of(edge).read() {
                assert_eq!(*radius, 30.0);
                heights.push(frame.origin.z);
            }
        }
        heights
    };
    // The lower plane goes down to -3.75, and the wall keeps its length of 3.
    assert_eq!(circles(&model), [0.0, -3.0]);
    let near = |found: &[f64], expected: [f64; 2], room: f64| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= room), "{found:?} {expected:?}");
    };
    near(&circles(&new), [-0.75, -3.75], 1e-14);
    assert!(gap(&new) <= gap(&model) + 1e-9);
    assert_eq!(plan.measures.faces.len(), 1, "only the upper skin is stretched");
    // A wall that slides has both ends where the skins are.
    let plan = planned(&model, &Params { wall: Wall::Slide, ..params(GROW) });
    let new = applied(&model, &plan.change_set);
    near(&circles(&new), [0.0, -3.75], 1e-9);
}

/// A face that hangs on a held loop, or one that was named, is held to the bit where nothing has to move it.
#[test]
fn a_named_wall_is_held_with_both_its_ends() {
    let model = flat_solid();
    let wall = HoldTarget::Faces(vec![face(FIRST_WALL)]);
    let named = planned(&model, &Params { hold: vec![wall], ..params(GROW) });
    assert_eq!(named.measures.groups.len(), 1);
    assert_eq!(named.measures.groups[0].loops.len(), 2);
    let loops = [TOP, BOTTOM].map(|k| model.brep.faces[face(k)].loops[1]);
    let by_loop = planned(&model, &Params { hold: vec![HoldTarget::Loop(loops[0])], ..params(GROW) });
    assert_eq!(named.change_set, by_loop.change_set);
    // The other hole's walls follow the scaling.
    assert_eq!(named.change_set.surfaces[&face(FIRST_WALL + 1)].kind(), "linear_extrusion");
    let found = refused(&model, &Params { hold: vec![HoldTarget::Faces(vec![face(2)])], ..params(GROW) });
    assert_eq!(found.code(), "scale.hold-not-separated");
    let stopped = Params { stop: vec![face(FIRST_WALL)], ..params(GROW) };
    assert_eq!(refused(&model, &stopped).code(), "scale.hold-not-separated");
}

#[test]
fn inner_loops_are_chosen_by_face_and_by_width() {
    let holes = [round_hole(120.0, 150.0, 25.0), round_hole(280.0, 150.0, 10.0)];
    let model = thin_solid(&flat(), &holes, None);
    let groups = |filter: LoopFilter| {
        let chosen = Params { hold: vec![HoldTarget::InnerLoops(filter)], ..params(GROW) };
        plan(&model, &chosen).map(|plan| plan.measures.groups.len())
    };
    assert_eq!(groups(LoopFilter { on: None, up_to: Some(20.0 + 1e-9) }).unwrap(), 1);
    assert_eq!(groups(LoopFilter { on: None, up_to: Some(50.0 + 1e-9) }).unwrap(), 2);
    assert_eq!(groups(LoopFilter { on: Some(vec![face(TOP)]), up_to: None }).unwrap(), 2);
    let none = groups(LoopFilter { on: Some(vec![face(2)]), up_to: None }).unwrap_err();
    assert_eq!(none.code(), "scale.nothing-to-hold");
}

#[test]
fn loops_that_cannot_be_held() {
    let model = curved_solid();
    let outer: LoopId = model.brep.faces[face(TOP)].loops[0];
    let found = refused(&model, &Params { hold: vec![HoldTarget::Loop(outer)], ..params(GROW) });
    assert_eq!(found.code(), "scale.held-loop-not-inner");
    let of_wall: LoopId = model.brep.faces[face(FIRST_WALL)].loops[0];
    let found = refused(&model, &Params { hold: vec![HoldTarget::Loop(of_wall)], ..params(GROW) });
    assert_eq!(found.code(), "scale.held-loop-not-inner");
    let found = refused(&thin_solid(&small(), &[], None), &params(GROW));
    assert_eq!(found.code(), "scale.nothing-to-hold");
}

#[test]
fn a_pinned_hole_stays_where_it_is() {
    let model = flat_solid();
    let pinned = planned(&model, &Params { mode: Hold::Pinned(None), ..params(GROW) });
    for wall in [FIRST_WALL, FIRST_WALL + 1] {
        assert!(!pinned.change_set.surfaces.contains_key(&face(wall)), "a pinned wall does not move");
    }
    for edge in pinned.change_set.curves.keys() {
        assert!(edge.index() < 12, "only the border moves");
    }
}

#[test]
fn a_change_outside_reach_of_a_bad_factor_is_refused_first() {
    assert_eq!(refused(&flat_solid(), &params([1.0, f64::NAN, 1.0])).code(), "scale.bad-scale");
}

#[test]
fn the_same_model_gives_the_same_bits() {
    let model = curved_solid();
    assert_eq!(planned(&model, &params(GROW)).change_set, planned(&model, &params(GROW)).change_set);
}
