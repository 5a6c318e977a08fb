use super::*;
use crate::brep::{Body, BodyKind, Coedge, CurveId, Edge, EdgeId, Face, Loop, Shell, Vertex, VertexId};
use crate::geometry::nurbs::{KnotVector, NurbsCurve3, NurbsSurface};
use crate::geometry::{Carried, Curve};
use crate::math::{Frame, Matrix3, Vector3};
use std::f64::consts::{PI, SQRT_2, TAU};

const EXACT: Quadrature = Quadrature {
    tolerance: 1e-6,
    target: Quadrature::EXACT,
    pieces: usize::MAX,
    points: usize::MAX,
    between: Between::Feet,
};

/// Builds one solid face by face.
struct Builder {
    brep: Brep,
    shell: ShellId,
    body: BodyId,
}

impl Builder {
    fn new() -> Self {
        let mut brep = Brep::default();
        let body = brep.bodies.next_id();
        let shell = brep.shells.push(Shell { faces: vec![], closed: true, forward: true, body });
        brep.bodies.push(Body { kind: BodyKind::Solid, shells: vec![shell] });
        Self { brep, shell, body }
    }

    fn vertex(&mut self, x: f64, y: f64, z: f64) -> VertexId {
        self.brep.vertices.push(Vertex { point: Point3::new(x, y, z) })
    }

    fn edge(&mut self, curve: Curve, start: VertexId, end: VertexId) -> EdgeId {
        let curve: CurveId = self.brep.curves.push(Carried::Read(curve));
        self.brep.edges.push(Edge { curve, start, end, same_sense: true })
    }

    fn line(&mut self, start: VertexId, end: VertexId) -> EdgeId {
        let [from, to] = [start, end].map(|v| self.brep.vertices[v].point);
        self.edge(Curve::Line { origin: from, direction: to - from }, start, end)
    }

    fn circle(&mut self, z: f64, radius: f64) -> EdgeId {
        let at = self.vertex(radius, 0.0, z);
        self.edge(Curve::Circle { frame: upright(z), radius }, at, at)
    }

    fn face(&mut self, surface: Surface, same_sense: bool, loops: &[&[(EdgeId, bool)]]) -> FaceId {
        let surface = self.brep.surfaces.push(Carried::Read(surface));
        let face = self.brep.faces.push(Face { surface, same_sense, loops: vec![], shell: self.shell });
        for (at, edges) in loops.iter().enumerate() {
            let in_loop = self.brep.loops.next_id();
            let uses = edges.iter().map(|&(edge, forward)| Coedge { edge, in_loop, forward, pcurve: None });
            let coedges = uses.map(|coedge| self.brep.coedges.push(coedge)).collect();
            self.brep.loops.push(Loop { face, outer: at == 0, forward: true, coedges, vertex: None });
            self.brep.faces[face].loops.push(in_loop);
        }
        self.brep.shells[self.shell].faces.push(face);
        face
    }

    /// A bound that is a single vertex.
    fn vertex_bound(&mut self, face: FaceId, vertex: VertexId) {
        let bound = Loop { face, outer: false, forward: true, coedges: vec![], vertex: Some(vertex) };
        let bound = self.brep.loops.push(bound);
        self.brep.faces[face].loops.push(bound);
    }

    /// Area, volume, height of the centroid and inertia about the axes against closed forms.
    fn assert(&self, area: f64, volume: f64, height: f64, inertia: [f64; 3]) {
        let found = of_body(&self.brep, self.body, &EXACT).expect("it is measured");
        let rough = of_body(&self.brep, self.body, &Quadrature::of_sign(1e-6)).expect("it is measured");
        assert!((rough.volume() - volume).abs() < 0.01 * volume.abs(), "{} {volume}", rough.volume());
        let near = |found: f64, expected: f64, what: &str| {
            let off = (found - expected).abs();
            assert!(off <= 1e-8 * expected.abs().max(1.0), "{what}: {found}, expected {expected}");
        };
        near(found.area(), area, "area");
        near(found.volume(), volume, "volume");
        near((found.centroid() - Point3::new(0.0, 0.0, height)).norm(), 0.0, "centroid");
        let off = found.inertia() - Matrix3::from_diagonal(&Vector3::from(inertia));
        let part = off.norm() / Vector3::from(inertia).norm();
        assert!(part <= 1e-7, "inertia: {part}");
        assert!((found.area() - area).abs() <= found.area_error() + 1e-12 * area);
        assert!((found.volume() - volume).abs() <= found.volume_error() + 1e-12 * volume);
        assert!(found.volume_error() <= 1e-7 * volume, "{}", found.volume_error());
    }
}

fn upright(z: f64) -> Frame {
    Frame::from_axis(Point3::new(0.0, 0.0, z), Vector3::z(), Some(Vector3::x())).expect("axes")
}

fn downward(z: f64) -> Frame {
    Frame::from_axis(Point3::new(0.0, 0.0, z), -Vector3::z(), Some(Vector3::x())).expect("axes")
}

#[test]
fn a_box() {
    let mut b = Builder::new();
    let (x, y, z) = (1.0, 2.0, 3.0);
    let corner = |i: usize| [i & 1, (i >> 1) & 1, i >> 2].map(|bit| bit as f64 - 0.5);
    let corners: Vec<VertexId> = (0..8)
        .map(|i| {
            let [a, b_, c] = corner(i);
            b.vertex(a * x, b_ * y, c * z)
        })
        .collect();
    let mut edges = std::collections::BTreeMap::new();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for side in sides {
        let mut uses = Vec::new();
        for i in 0..4 {
            let (from, to) = (side[i], side[(i + 1) % 4]);
            let edge = *edges
                .entry((from.min(to), from.max(to)))
                .or_insert_with(|| b.line(corners[from.min(to)], corners[from.max(to)]));
            uses.push((edge, from < to));
        }
        let point = |i: usize| b.brep.vertices[corners[side[i]]].point;
        let normal = (point(1) - point(0)).cross(&(point(3) - point(0)));
        let frame = Frame::from_axis(point(0), normal, Some(point(1) - point(0))).expect("axes");
        b.face(Surface::Plane(frame), true, &[&uses]);
    }
    let turn = |a: f64, c: f64| x * y * z * (a * a + c * c) / 12.0;
    b.assert(2.0 * (x * y + y * z + z * x), x * y * z, 0.0, [turn(y, z), turn(x, z), turn(x, y)]);
}

/// A frustum from `z = 0` to `z = height`, its side without a seam, of either sense.
fn frustum(low: f64, high: f64, height: f64, side: Surface, same_sense: bool) -> Builder {
    let mut b = Builder::new();
    let (bottom, top) = (b.circle(0.0, low), b.circle(height, high));
    b.face(side, same_sense, &[&[(bottom, true)], &[(top, false)]]);
    b.face(Surface::Plane(downward(0.0)), true, &[&[(bottom, false)]]);
    // Turned by its sense: the plane looks down, the face up.
    b.face(Surface::Plane(downward(height)), false, &[&[(top, true)]]);
    b
}

#[test]
fn a_cylinder_between_two_bounds_that_run_round() {
    let (r, h) = (2.0, 5.0);
    let b = frustum(r, r, h, Surface::Cylinder { frame: upright(1.0), radius: r }, true);
    let (volume, turn) = (PI * r * r * h, |m: f64| m * (3.0 * r * r + h * h) / 12.0);
    b.assert(2.0 * PI * r * (r + h), volume, 2.5, [turn(volume), turn(volume), 0.5 * volume * r * r]);
}

#[test]
fn a_cone_to_its_apex_with_and_without_a_vertex_bound() {
    let (r, h) = (3.0f64, 4.0f64);
    for with_vertex in [false, true] {
        let mut b = Builder::new();
        let bottom = b.circle(0.0, r);
        let side = Surface::Cone { frame: upright(0.0), radius: r, semi_angle: -(r / h).atan() };
        let face = b.face(side, true, &[&[(bottom, true)]]);
        b.face(Surface::Plane(downward(0.0)), true, &[&[(bottom, false)]]);
        if with_vertex {
            let apex = b.vertex(0.0, 0.0, h);
            b.vertex_bound(face, apex);
        }
        let m = PI * r * r * h / 3.0;
        let across = 3.0 / 80.0 * m * (4.0 * r * r + h * h);
        b.assert(PI * r * (r + 5.0), m, 1.0, [across, across, 0.3 * m * r * r]);
    }
}

fn whole(surface: Surface) -> Builder {
    let mut b = Builder::new();
    let face = b.face(surface, true, &[]);
    let vertex = b.vertex(0.0, 0.0, 0.0);
    b.vertex_bound(face, vertex);
    b
}

#[test]
fn a_sphere_and_a_torus_without_an_edge() {
    let (m, turn) = (4.0 / 3.0 * PI * 8.0, 0.4 * 4.0 / 3.0 * PI * 32.0);
    whole(Surface::Sphere { frame: upright(0.5), radius: 2.0 }).assert(16.0 * PI, m, 0.5, [turn; 3]);
    let (big, small) = (5.0, 1.5);
    let m = 2.0 * PI * PI * big * small * small;
    let across = m * (4.0 * big * big + 5.0 * small * small) / 8.0;
    whole(Surface::Torus { frame: upright(0.0), major_radius: big, minor_radius: small }).assert(
        4.0 * PI * PI * big * small,
        m,
        0.0,
        [across, across, m * (big * big + 0.75 * small * small)],
    );
}

/// The sphere of radius `r` as a rational B-spline, poles at the ends of `v`.
fn spline_sphere(r: f64) -> Surface {
    let half = 0.5 * SQRT_2;
    let profile = [(0.0, -1.0, 1.0), (1.0, -1.0, half), (1.0, 0.0, 1.0), (1.0, 1.0, half), (0.0, 1.0, 1.0)];
    let ring =
        [(1., 0.), (1., 1.), (0., 1.), (-1., 1.), (-1., 0.), (-1., -1.), (0., -1.), (1., -1.), (1., 0.)];
    let ku = KnotVector::from_multiplicities(2, &[0.0, 1.0, 2.0, 3.0, 4.0], &[3, 2, 2, 2, 3]).expect("knots");
    let kv = KnotVector::from_multiplicities(2, &[0.0, 1.0, 2.0], &[3, 2, 3]).expect("knots");
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (i, (x, y)) in ring.into_iter().enumerate() {
        for (rho, z, weight) in profile {
            points.push(Point3::new(r * rho * x, r * rho * y, r * z));
            weights.push(weight * if i % 2 == 1 { half } else { 1.0 });
        }
    }
    Surface::Nurbs(NurbsSurface::from_points(ku, kv, &points, Some(&weights)).expect("a net"))
}

#[test]
fn a_sphere_cut_by_a_plane_analytic_and_rational_above_and_below() {
    let (r, z) = (2.0f64, 1.0f64);
    let rho = (r * r - z * z).sqrt();
    for surface in [Surface::Sphere { frame: upright(0.0), radius: r }, spline_sphere(r)] {
        for below in [false, true] {
            let mut b = Builder::new();
            let cut = b.circle(z, rho);
            b.face(surface.clone(), true, &[&[(cut, !below)]]);
            let lid = if below { upright(z) } else { downward(z) };
            b.face(Surface::Plane(lid), true, &[&[(cut, below)]]);
            let height = if below { r + z } else { r - z };
            let volume = PI * height * height * (3.0 * r - height) / 3.0;
            let area = 2.0 * PI * r * height + PI * rho * rho;
            let sign = if below { -1.0 } else { 1.0 };
            let centroid = sign * 0.75 * (2.0 * r - height).powi(2) / (3.0 * r - height);
            // About the axis by discs, ∫ π ρ⁴/2 dz; across by ∫ (π ρ⁴/4 + π ρ² z²) dz less the centroid's share.
            let low = r - height;
            let power = |n: i32| (r.powi(n + 1) - low.powi(n + 1)) / f64::from(n + 1);
            let fourth = r.powi(4) * power(0) - 2.0 * r * r * power(2) + power(4);
            let across = PI * (0.25 * fourth + r * r * power(2) - power(4)) - volume * centroid * centroid;
            b.assert(area, volume, centroid, [across, across, 0.5 * PI * fourth]);
        }
    }
}

#[test]
fn a_sphere_with_a_round_hole_away_from_its_poles_is_the_rest() {
    // A cylinder's end cut off the side: the loop goes round neither pole.
    let (r, x) = (2.0f64, 1.2f64);
    let rho = (r * r - x * x).sqrt();
    let mut b = Builder::new();
    let frame = Frame::from_axis(Point3::new(x, 0.0, 0.0), Vector3::x(), Some(Vector3::y())).expect("axes");
    let at = b.vertex(x, rho, 0.0);
    let cut = b.edge(Curve::Circle { frame, radius: rho }, at, at);
    let face = b.face(Surface::Sphere { frame: upright(0.0), radius: r }, true, &[&[(cut, false)]]);
    let found = of_face(&b.brep, face, &EXACT, Point3::origin()).expect("it is measured");
    let height = r + x;
    assert!((found.area() - 2.0 * PI * r * height).abs() < 1e-9, "{}", found.area());
    // From the centre every piece of a sphere is a cone of height r.
    assert!((found.volume() - found.area() * r / 3.0).abs() < 1e-9, "{}", found.volume());
}

#[test]
fn a_turned_shell_has_the_opposite_volume_and_a_turned_plane_the_same_area() {
    let (r, h) = (2.0, 5.0);
    let mut b = frustum(r, r, h, Surface::Cylinder { frame: upright(1.0), radius: r }, true);
    b.brep.shells[b.shell].forward = false;
    let found = of_body(&b.brep, b.body, &EXACT).expect("it is measured");
    assert!((found.volume() + PI * r * r * h).abs() < 1e-9);
    assert!((found.area() - 2.0 * PI * r * (r + h)).abs() < 1e-9);
}

#[test]
fn a_bound_round_an_endless_cylinder_is_refused() {
    let mut b = Builder::new();
    let bottom = b.circle(0.0, 1.0);
    let face = b.face(Surface::Cylinder { frame: upright(0.0), radius: 1.0 }, true, &[&[(bottom, true)]]);
    assert_eq!(of_face(&b.brep, face, &EXACT, Point3::origin()), Err(MassPropertiesError::Endless { face }));
}

#[test]
fn a_wavy_profile_turned_is_measured_as_pappus_says() {
    // Radius 4 + 3 t (1 - t) (1 - 2 t) · 8 and height 12 t: one span of a cubic that waves.
    let points = [(4.0, 0.0), (12.0, 4.0), (-4.0, 8.0), (4.0, 12.0)].map(|(x, z)| Point3::new(x, 0.0, z));
    let knots = KnotVector::clamped_uniform(3, 1, 0.0, 1.0).expect("knots");
    let profile = NurbsCurve3::from_points(knots, &points, None).expect("a curve");
    let mut b = Builder::new();
    let (low, high) = (b.circle(0.0, 4.0), b.circle(12.0, 4.0));
    let side = Surface::Revolution { curve: Box::new(Curve::Nurbs(profile.clone())), frame: upright(0.0) };
    b.face(side, true, &[&[(low, true)], &[(high, false)]]);
    let face = b.brep.faces.ids().next().expect("a face");
    let found = of_face(&b.brep, face, &EXACT, Point3::origin()).expect("it is measured");
    // Simpson's rule over the profile, in parts so fine that it is exact to rounding.
    let term = |t: f64| TAU * profile.point_at(t).x * profile.derivatives(t)[1].norm();
    let parts = 20_000u32;
    let step = 1.0 / f64::from(parts);
    let area: f64 = (0..parts)
        .map(|k| f64::from(k) * step)
        .map(|t| (term(t) + 4.0 * term(t + 0.5 * step) + term(t + step)) * step / 6.0)
        .sum();
    assert!((found.area() - area).abs() < 1e-9 * area, "{} {area}", found.area());
}

#[test]
fn half_a_sphere_is_bounded_by_a_circle_through_its_poles_or_beside_them() {
    let radius = 5.0;
    for tilt in [0.0, 1e-4, -1e-3, 0.3] {
        let mut b = Builder::new();
        let at = b.vertex(0.0, radius * 0.6, radius * 0.8);
        let x = Vector3::new(0.0, 0.6, 0.8);
        let cut = Frame::from_axis(Point3::origin(), Vector3::x(), Some(x)).expect("a frame");
        let circle = b.edge(Curve::Circle { frame: cut, radius }, at, at);
        let axis = Vector3::new(tilt, 0.5 * tilt, 1.0);
        let frame = Frame::from_axis(Point3::origin(), axis, Some(Vector3::x())).expect("a frame");
        b.face(Surface::Sphere { frame, radius }, true, &[&[(circle, true)]]);
        let back = Frame::from_axis(Point3::origin(), -Vector3::x(), None).expect("a frame");
        b.face(Surface::Plane(back), true, &[&[(circle, false)]]);
        let found = of_body(&b.brep, b.body, &EXACT).expect("it is measured");
        let (area, volume) = (3.0 * PI * radius * radius, 2.0 / 3.0 * PI * radius.powi(3));
        assert!((found.area() - area).abs() < 1e-9 * area, "{tilt}: {} {area}", found.area());
        assert!((found.volume() - volume).abs() < 1e-9 * volume, "{tilt}: {} {volume}", found.volume());
    }
}

#[test]
fn lunes_of_a_sphere_narrow_and_wide() {
    for angle in [0.01, 1.0, PI, 4.5] {
        let mut b = Builder::new();
        let (south, north) = (b.vertex(0.0, 0.0, -3.0), b.vertex(0.0, 0.0, 3.0));
        let mut meridian = |u: f64| {
            let out = Vector3::new(u.cos(), u.sin(), 0.0);
            let frame = Frame::from_axis(Point3::origin(), out.cross(&Vector3::z()), Some(-Vector3::z()));
            b.edge(Curve::Circle { frame: frame.expect("a frame"), radius: 3.0 }, south, north)
        };
        let (first, last) = (meridian(0.2), meridian(0.2 + angle));
        let sphere = Surface::Sphere { frame: upright(0.0), radius: 3.0 };
        let face = b.face(sphere, true, &[&[(last, true), (first, false)]]);
        let found = of_face(&b.brep, face, &EXACT, Point3::origin()).expect("it is measured");
        let area = 2.0 * angle * 9.0;
        assert!((found.area() - area).abs() < 1e-9 * area, "{angle}: {} {area}", found.area());
    }
}

#[test]
fn a_torus_cut_open_along_both_its_circles_is_whole_whichever_way_it_is_walked_round() {
    let (major, minor) = (4.0, 1.0);
    for turned in [false, true] {
        let mut b = Builder::new();
        let round = b.circle(0.0, major + minor);
        let at = b.brep.edges[round].start;
        let tube = Frame::from_axis(Point3::new(major, 0.0, 0.0), -Vector3::y(), Some(Vector3::x()));
        let tube = b.edge(Curve::Circle { frame: tube.expect("a frame"), radius: minor }, at, at);
        let (first, second) = if turned { (tube, round) } else { (round, tube) };
        let torus = Surface::Torus { frame: upright(0.0), major_radius: major, minor_radius: minor };
        b.face(torus, true, &[&[(first, true), (second, true), (first, false), (second, false)]]);
        let found = of_body(&b.brep, b.body, &EXACT).expect("it is measured");
        let (area, volume) = (4.0 * PI * PI * major * minor, 2.0 * PI * PI * major * minor * minor);
        assert!((found.area() - area).abs() < 1e-9 * area, "{turned}: {} {area}", found.area());
        assert!((found.volume() - volume).abs() < 1e-9 * volume, "{turned}: {} {volume}", found.volume());
    }
}
