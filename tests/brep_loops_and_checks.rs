//! Loops in the parameter plane and checks, on solids built by hand with known areas and known faults.

#![expect(clippy::unwrap_used, reason = "builders of fixtures stop at what cannot be built")]

use resurf::brep::check::{BoundKind, Finding, check};
use resurf::brep::{
    Body, BodyKind, Brep, Coedge, Edge, EdgeId, Face, FaceId, Loop, LoopSampling, ParameterLoop, Shell,
    ShellId, Vertex, VertexId, parameter_loops,
};
use resurf::geometry::nurbs::{KnotVector, NurbsCurve2, NurbsSurface};
use resurf::geometry::{Carried, Curve, Curve2d, Surface};
use resurf::math::{Frame, Point2, Point3, Vector2, Vector3};
use std::f64::consts::{PI, TAU};

const TOLERANCE: f64 = 1e-6;

fn frame(origin: Point3<f64>, z: Vector3<f64>, x: Vector3<f64>) -> Frame {
    Frame::from_axis(origin, z, Some(x)).unwrap()
}

/// One body with one shell that is said to be closed.
struct Builder {
    brep: Brep,
    shell: ShellId,
}

impl Builder {
    fn new() -> Self {
        let mut brep = Brep::default();
        let body = brep.bodies.next_id();
        let shell = brep.shells.push(Shell { faces: Vec::new(), closed: true, forward: true, body });
        brep.bodies.push(Body { kind: BodyKind::Solid, shells: vec![shell] });
        Self { brep, shell }
    }

    fn vertex(&mut self, point: Point3<f64>) -> VertexId {
        self.brep.vertices.push(Vertex { point })
    }

    fn edge(&mut self, curve: Curve, start: VertexId, end: VertexId) -> EdgeId {
        let curve = self.brep.curves.push(Carried::Read(curve));
        self.brep.edges.push(Edge { curve, start, end, same_sense: true })
    }

    fn line(&mut self, start: VertexId, end: VertexId) -> EdgeId {
        let (origin, to) = (self.brep.vertices[start].point, self.brep.vertices[end].point);
        self.edge(Curve::Line { origin, direction: to - origin }, start, end)
    }

    fn face(&mut self, surface: Surface, same_sense: bool, loops: &[&[(EdgeId, bool)]]) -> FaceId {
        let surface = self.brep.surfaces.push(Carried::Read(surface));
        let face = self.brep.faces.push(Face { surface, same_sense, loops: Vec::new(), shell: self.shell });
        for (i, coedges) in loops.iter().enumerate() {
            let id = self.brep.loops.next_id();
            let coedges = coedges
                .iter()
                .map(|&(edge, forward)| {
                    self.brep.coedges.push(Coedge { edge, in_loop: id, forward, pcurve: None })
                })
                .collect();
            self.brep.loops.push(Loop { face, outer: i == 0, forward: true, coedges, vertex: None });
            self.brep.faces[face].loops.push(id);
        }
        self.brep.shells[self.shell].faces.push(face);
        face
    }

    fn findings(&self) -> Vec<Finding> {
        check(&self.brep, &|_| TOLERANCE)
    }
}

/// A closed cylinder of radius 2 from z = 0 to 5, its side given as any surface over the same axis.
fn cylinder_with(side: Surface) -> Builder {
    let mut b = Builder::new();
    let (low, high) = (Point3::origin(), Point3::new(0.0, 0.0, 5.0));
    let (a, c) = (b.vertex(Point3::new(2.0, 0.0, 0.0)), b.vertex(Point3::new(2.0, 0.0, 5.0)));
    let circle = |at| Curve::Circle { frame: frame(at, Vector3::z(), Vector3::x()), radius: 2.0 };
    let bottom = b.edge(circle(low), a, a);
    let top = b.edge(circle(high), c, c);
    let seam = b.line(a, c);
    b.face(side, true, &[&[(bottom, true), (seam, true), (top, false), (seam, false)]]);
    b.face(Surface::Plane(frame(low, -Vector3::z(), Vector3::x())), true, &[&[(bottom, false)]]);
    b.face(Surface::Plane(frame(high, Vector3::z(), Vector3::x())), true, &[&[(top, true)]]);
    b
}

fn cylinder() -> Builder {
    cylinder_with(Surface::Cylinder {
        frame: frame(Point3::new(0.0, 0.0, 1.0), Vector3::z(), Vector3::y()),
        radius: 2.0,
    })
}

/// The same side as a closed rational B-spline: nine points round, `u` over [0, 4], `v` over [0, 1].
fn spline_side() -> NurbsSurface {
    let h = 0.5_f64.sqrt();
    let ring =
        [(1., 0.), (1., 1.), (0., 1.), (-1., 1.), (-1., 0.), (-1., -1.), (0., -1.), (1., -1.), (1., 0.)];
    let ku = KnotVector::from_multiplicities(2, &[0.0, 1.0, 2.0, 3.0, 4.0], &[3, 2, 2, 2, 3]).unwrap();
    let kv = KnotVector::clamped_uniform(1, 1, 0.0, 1.0).unwrap();
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (i, (x, y)) in ring.into_iter().enumerate() {
        for z in [0.0, 5.0] {
            points.push(Point3::new(2.0 * x, 2.0 * y, z));
            weights.push(if i % 2 == 1 { h } else { 1.0 });
        }
    }
    NurbsSurface::from_points(ku, kv, &points, Some(&weights)).unwrap()
}

fn loops(b: &Builder, face: usize) -> Vec<ParameterLoop> {
    let face = b.brep.faces.ids().nth(face).unwrap();
    parameter_loops(&b.brep, face, &LoopSampling::of_tolerance(TOLERANCE)).unwrap()
}

/// Area of the regular polygon of `n` corners in a circle of radius `r`.
fn polygon_area(n: f64, r: f64) -> f64 {
    0.5 * n * r * r * (TAU / n).sin()
}

fn assert_on_surface(b: &Builder, face: usize, found: &[ParameterLoop]) {
    let face = b.brep.faces.ids().nth(face).unwrap();
    let surface = b.brep.surface_of(face).read().unwrap();
    let ((u0, u1), (v0, v1)) = surface.domain();
    for point in found.iter().flat_map(|l| &l.points) {
        assert!(point.u >= u0 - 1e-9 && point.u <= u1 + 1e-9 && point.v >= v0 - 1e-9 && point.v <= v1 + 1e-9);
        assert!((surface.point(point.u, point.v) - point.point).norm() < 1e-9);
    }
}

#[test]
fn the_side_of_a_cylinder_unrolls_to_a_rectangle() {
    let b = cylinder();
    let found = loops(&b, 0);
    assert_eq!(found[0].winding, (0.0, 0.0));
    assert!((found[0].signed_area().unwrap() - TAU * 5.0).abs() < 1e-9);
    assert!(found[0].gap < 1e-12);
    // Four quarters of eight chords on each circle, eight on each way along the seam.
    assert_eq!(found[0].points.len(), 32 + 8 + 32 + 8);
    // The seam stands a quarter turn before this placement's own axis.
    let (low, high) = found[0].points.iter().fold((9.0_f64, -9.0_f64), |(a, b), p| (a.min(p.u), b.max(p.u)));
    assert!((high - low - TAU).abs() < 1e-12);
}

#[test]
fn the_side_of_a_spline_cylinder_unrolls_to_its_domain() {
    let b = cylinder_with(Surface::Nurbs(spline_side()));
    let found = loops(&b, 0);
    assert!((found[0].signed_area().unwrap() - 4.0).abs() < 1e-9);
    assert!(found[0].gap < 1e-12);
    assert_on_surface(&b, 0, &found);
    assert_eq!(b.findings(), []);
}

#[test]
fn a_loop_round_a_cylinder_without_a_seam_winds_once() {
    let mut b = Builder::new();
    let a = b.vertex(Point3::new(2.0, 0.0, 0.0));
    let c = b.vertex(Point3::new(2.0, 0.0, 5.0));
    let circle =
        |z| Curve::Circle { frame: frame(Point3::new(0.0, 0.0, z), Vector3::z(), Vector3::x()), radius: 2.0 };
    let (bottom, top) = (b.edge(circle(0.0), a, a), b.edge(circle(5.0), c, c));
    let side = Surface::Cylinder { frame: frame(Point3::origin(), Vector3::z(), Vector3::x()), radius: 2.0 };
    b.face(side, true, &[&[(bottom, true)], &[(top, false)]]);
    let found = loops(&b, 0);
    assert!((found[0].winding.0 - TAU).abs() < 1e-12 && (found[1].winding.0 + TAU).abs() < 1e-12);
    assert_eq!(found[0].signed_area(), None);
}

#[test]
fn caps_have_the_area_of_their_polygons() {
    let b = cylinder();
    for face in [1, 2] {
        let found = loops(&b, face);
        assert!((found[0].signed_area().unwrap() - polygon_area(32.0, 2.0)).abs() < 1e-12);
    }
    assert_eq!(b.findings(), []);
}

#[test]
fn a_whole_sphere_bounded_by_its_seam_fills_its_domain() {
    let mut b = Builder::new();
    let (south, north) = (b.vertex(Point3::new(0.0, 0.0, -3.0)), b.vertex(Point3::new(0.0, 0.0, 3.0)));
    // The half circle from the south pole over +x to the north pole.
    let meridian =
        Curve::Circle { frame: frame(Point3::origin(), -Vector3::y(), -Vector3::z()), radius: 3.0 };
    let seam = b.edge(meridian, south, north);
    for same_sense in [true, false] {
        let sphere =
            Surface::Sphere { frame: frame(Point3::origin(), Vector3::z(), Vector3::x()), radius: 3.0 };
        b.face(sphere, same_sense, &[&[(seam, true), (seam, false)]]);
    }
    for (face, sign) in [(0, 1.0), (1, -1.0)] {
        let found = loops(&b, face);
        let area = found[0].signed_area().unwrap();
        assert!((area - sign * TAU * PI).abs() < 1e-6, "{area}");
        assert!(found[0].gap < 1e-12);
        assert_on_surface(&b, face, &found);
    }
}

/// A flat spline face 40 x 30 with an uneven parametrisation, its four border edges and a round hole.
fn panel_with_hole(hole_center: Point3<f64>, hole_forward: bool) -> Builder {
    let mut b = Builder::new();
    b.brep.shells[b.shell].closed = false;
    let corners =
        [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0)].map(|(x, y)| b.vertex(Point3::new(x, y, 0.0)));
    let border: Vec<(EdgeId, bool)> =
        (0..4).map(|i| (b.line(corners[i], corners[(i + 1) % 4]), true)).collect();
    let k = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.2, 1.0, 1.0, 1.0]).unwrap();
    let mut points = Vec::new();
    for x in [0.0, 5.0, 15.0, 40.0] {
        points.extend([0.0, 12.0, 25.0, 30.0].map(|y| Point3::new(x, y, 0.0)));
    }
    let surface = NurbsSurface::from_points(k.clone(), k, &points, None).unwrap();
    let circle = Curve::Circle { frame: frame(hole_center, Vector3::z(), Vector3::x()), radius: 4.0 };
    let at = b.vertex(hole_center + Vector3::x() * 4.0);
    let hole = b.edge(circle, at, at);
    b.face(Surface::Nurbs(surface), true, &[&border, &[(hole, hole_forward)]]);
    b
}

#[test]
fn a_trimmed_spline_face_has_its_border_and_its_hole() {
    let b = panel_with_hole(Point3::new(20.0, 15.0, 0.0), false);
    let found = loops(&b, 0);
    assert!((found[0].signed_area().unwrap() - 1.0).abs() < 1e-12);
    assert!(found[1].signed_area().unwrap() < 0.0);
    assert_on_surface(&b, 0, &found);
    assert_eq!(b.findings(), []);
}

#[test]
fn the_parameter_chord_bound_holds() {
    let b = panel_with_hole(Point3::new(20.0, 15.0, 0.0), false);
    let face = b.brep.faces.ids().next().unwrap();
    let coarse = parameter_loops(&b.brep, face, &LoopSampling::of_tolerance(TOLERANCE)).unwrap();
    let sampling = LoopSampling { parameter_chord: (1e-5, 1e-5), ..LoopSampling::of_tolerance(TOLERANCE) };
    let fine = parameter_loops(&b.brep, face, &sampling).unwrap();
    assert!(fine[1].points.len() > coarse[1].points.len());
    let surface = b.brep.surface_of(face).read().unwrap();
    for pair in fine[1].points.windows(2) {
        let middle = Point3::new(20.0, 15.0, 0.0)
            + Vector3::new((0.5 * (pair[0].t + pair[1].t)).cos(), (0.5 * (pair[0].t + pair[1].t)).sin(), 0.0)
                * 4.0;
        let (u, v) = surface.parameters_of(&middle, Some((pair[0].u, pair[0].v)));
        assert!((u - 0.5 * (pair[0].u + pair[1].u)).abs() <= 1.01e-5);
        assert!((v - 0.5 * (pair[0].v + pair[1].v)).abs() <= 1.01e-5);
    }
}

#[test]
fn a_pcurve_that_agrees_is_used_and_one_that_does_not_is_found() {
    let mut b = cylinder();
    let coedge = b.brep.coedges_of(b.brep.faces.ids().nth(2).unwrap()).next().unwrap();
    let pcurve = |r| Curve2d::Ellipse {
        center: Point2::origin(),
        x: Vector2::x(),
        y: Vector2::y(),
        semi_axis_1: r,
        semi_axis_2: r,
    };
    b.brep.coedges[coedge].pcurve = Some(pcurve(2.0));
    assert_eq!(b.findings(), []);
    b.brep.coedges[coedge].pcurve = Some(pcurve(2.1));
    let findings = b.findings();
    assert_eq!(findings.iter().map(Finding::code).collect::<Vec<_>>(), ["pcurve-off-edge"]);
    assert!((findings[0].size().unwrap() - 0.1).abs() < 1e-12);
    // The loop follows the edge all the same.
    assert!((loops(&b, 2)[0].signed_area().unwrap() - polygon_area(32.0, 2.0)).abs() < 1e-12);
}

#[test]
fn a_pcurve_over_another_interval_is_compared_end_to_end() {
    let mut b = panel_with_hole(Point3::new(20.0, 15.0, 0.0), false);
    let coedge = b.brep.coedges_of(b.brep.faces.ids().next().unwrap()).next().unwrap();
    let knots = KnotVector::clamped_uniform(1, 1, 3.0, 7.0).unwrap();
    let line = |y| NurbsCurve2::from_points(knots.clone(), &[Point2::new(0.0, y), Point2::new(1.0, y)], None);
    b.brep.coedges[coedge].pcurve = Some(Curve2d::Nurbs(line(0.0).unwrap()));
    assert_eq!(b.findings(), []);
    b.brep.coedges[coedge].pcurve = Some(Curve2d::Nurbs(line(0.1).unwrap()));
    assert_eq!(b.findings().iter().map(Finding::code).collect::<Vec<_>>(), ["pcurve-off-edge"]);
}

#[test]
fn a_hole_off_the_surface_is_found_with_its_distance() {
    let b = panel_with_hole(Point3::new(20.0, 15.0, 0.25), false);
    let findings = b.findings();
    assert_eq!(findings.len(), 1);
    assert_eq!(findings[0].code(), "edge-off-surface");
    assert!((findings[0].size().unwrap() - 0.25).abs() < 1e-12);
    assert!((findings[0].place().z - 0.25).abs() < 1e-12);
}

#[test]
fn a_reversed_hole_is_found() {
    let findings = panel_with_hole(Point3::new(20.0, 15.0, 0.0), true).findings();
    assert!(
        matches!(&findings[..], [Finding::ReversedLoop(f)] if f.kind == BoundKind::Inner),
        "{findings:?}"
    );
}

#[test]
fn a_turned_bound_counts_with_its_own_orientation() {
    let mut b = panel_with_hole(Point3::new(20.0, 15.0, 0.0), true);
    let hole = b.brep.loops.ids().nth(1).unwrap();
    b.brep.loops[hole].forward = false;
    assert_eq!(b.findings(), []);
}

#[test]
fn a_displaced_vertex_opens_the_loop_and_leaves_its_edges() {
    let mut b = panel_with_hole(Point3::new(20.0, 15.0, 0.0), false);
    let stray = b.vertex(Point3::new(40.0, 0.01, 0.0));
    let second = b.brep.edges.ids().nth(1).unwrap();
    b.brep.edges[second].start = stray;
    // The vertex slid along its own edge: the edge is shorter, the loop open by 0.01.
    let findings = b.findings();
    assert!(matches!(&findings[..], [Finding::OpenLoop(f)] if (f.gap - 0.01).abs() < 1e-12), "{findings:?}");
    b.brep.vertices[stray].point = Point3::new(40.02, 0.0, 0.0);
    let codes: Vec<_> = b.findings().iter().map(Finding::code).collect();
    assert_eq!(codes, ["vertex-off-edge", "open-loop"]);
}

#[test]
fn a_missing_cap_leaves_a_free_edge_and_a_turned_one_a_one_way_edge() {
    let mut b = cylinder();
    let cap = b.brep.shells[b.shell].faces.pop().unwrap();
    assert_eq!(b.findings().iter().map(Finding::code).collect::<Vec<_>>(), ["free-edge", "open-shell"]);
    b.brep.shells[b.shell].faces.push(cap);
    let coedge = b.brep.coedges_of(cap).next().unwrap();
    b.brep.coedges[coedge].forward = false;
    let codes: Vec<_> = b.findings().iter().map(Finding::code).collect();
    assert_eq!(codes, ["turned-face", "one-way-edge", "reversed-loop"]);
    b.brep.coedges[coedge].forward = true;
    b.brep.shells[b.shell].faces.push(cap);
    assert!(b.findings().iter().any(|f| f.code() == "crowded-edge"));
}

#[test]
fn geometry_that_was_not_read_is_passed_over() {
    let mut b = cylinder();
    let curve = b.brep.curves.ids().next().unwrap();
    b.brep.curves[curve] = Carried::Unread { entity: "HYPERBOLA".into(), reason: "not read yet".into() };
    assert_eq!(b.findings(), []);
    let face = b.brep.faces.ids().next().unwrap();
    assert!(parameter_loops(&b.brep, face, &LoopSampling::of_tolerance(TOLERANCE)).is_err());
}

/// Adds the faces of a closed cylinder from z = 1 to 3 as a shell of its own.
fn add_void(b: &mut Builder, forward: bool) {
    let body = b.brep.bodies.ids().next().unwrap();
    b.shell = b.brep.shells.push(Shell { faces: Vec::new(), closed: true, forward, body });
    b.brep.bodies[body].shells.push(b.shell);
    let (low, high) = (Point3::new(0.0, 0.0, 1.0), Point3::new(0.0, 0.0, 3.0));
    let (a, c) = (b.vertex(Point3::new(1.0, 0.0, 1.0)), b.vertex(Point3::new(1.0, 0.0, 3.0)));
    let circle = |at| Curve::Circle { frame: frame(at, Vector3::z(), Vector3::x()), radius: 1.0 };
    let (bottom, top) = (b.edge(circle(low), a, a), b.edge(circle(high), c, c));
    let seam = b.line(a, c);
    let side = Surface::Cylinder { frame: frame(low, Vector3::z(), Vector3::x()), radius: 1.0 };
    b.face(side, true, &[&[(bottom, true), (seam, true), (top, false), (seam, false)]]);
    b.face(Surface::Plane(frame(low, -Vector3::z(), Vector3::x())), true, &[&[(bottom, false)]]);
    b.face(Surface::Plane(frame(high, Vector3::z(), Vector3::x())), true, &[&[(top, true)]]);
}

#[test]
fn a_shell_that_is_turned_inside_out_is_found_the_outer_one_or_that_of_a_void() {
    let mut b = cylinder();
    add_void(&mut b, false);
    assert_eq!(b.findings(), []);
    let mut b = cylinder();
    add_void(&mut b, true);
    let findings = b.findings();
    let [Finding::SolidInsideOut(found)] = &findings[..] else { panic!("{findings:?}") };
    assert!(found.shell == b.shell && (found.volume - TAU).abs() < 0.01 * TAU, "{found:?}");
    let mut b = cylinder();
    b.brep.shells[b.shell].forward = false;
    let findings = b.findings();
    let [Finding::SolidInsideOut(found)] = &findings[..] else { panic!("{findings:?}") };
    assert!((found.volume + 20.0 * PI).abs() < 0.2 * PI, "{found:?}");
}
