//! Tessellation of bodies built by hand, against closed forms.

use resurf::brep::{
    Body, BodyId, BodyKind, Brep, Coedge, CurveId, Edge, EdgeId, Face, FaceId, Loop, Shell, ShellId,
    SurfaceId, Vertex, VertexId,
};
use resurf::geometry::nurbs::{KnotVector, NurbsCurve3, NurbsSurface};
use resurf::geometry::{Carried, Curve, Surface};
use resurf::math::{Frame, Point3, Vector3};
use resurf::mesh::{
    Integrity, Mesh, TessellateError, Tolerances, off, stl, tessellate_bodies, tessellate_faces,
};
use resurf::validate::{Request, ValidateError, ask_openscad};
use std::f64::consts::PI;

/// Builds one body face by face.
struct Builder {
    brep: Brep,
    shell: ShellId,
    body: BodyId,
}

impl Builder {
    fn new(kind: BodyKind) -> Self {
        let mut brep = Brep::default();
        let body = brep.bodies.next_id();
        let shell =
            brep.shells.push(Shell { faces: vec![], closed: kind == BodyKind::Solid, forward: true, body });
        brep.bodies.push(Body { kind, shells: vec![shell] });
        Self { brep, shell, body }
    }

    fn vertex(&mut self, point: Point3<f64>) -> VertexId {
        self.brep.vertices.push(Vertex { point })
    }

    fn edge(&mut self, curve: Curve, start: VertexId, end: VertexId) -> EdgeId {
        let curve: CurveId = self.brep.curves.push(Carried::Read(curve));
        self.brep.edges.push(Edge { curve, start, end, same_sense: true })
    }

    fn line(&mut self, start: VertexId, end: VertexId) -> EdgeId {
        let [from, to] = [start, end].map(|v| self.brep.vertices[v].point);
        self.edge(Curve::Line { origin: from, direction: to - from }, start, end)
    }

    fn face(&mut self, surface: Surface, loops: &[&[(EdgeId, bool)]]) -> FaceId {
        let surface: SurfaceId = self.brep.surfaces.push(Carried::Read(surface));
        let face = self.brep.faces.next_id();
        let mut bounds = Vec::new();
        for (at, edges) in loops.iter().enumerate() {
            let in_loop = self.brep.loops.next_id();
            let uses = edges.iter().map(|&(edge, forward)| Coedge { edge, in_loop, forward, pcurve: None });
            let coedges = uses.map(|coedge| self.brep.coedges.push(coedge)).collect();
            bounds.push(self.brep.loops.push(Loop {
                face,
                outer: at == 0,
                forward: true,
                coedges,
                vertex: None,
            }));
        }
        self.brep.faces.push(Face { surface, same_sense: true, loops: bounds, shell: self.shell });
        self.brep.shells[self.shell].faces.push(face);
        face
    }

    fn mesh(&self, tolerances: &Tolerances) -> Result<Mesh, TessellateError> {
        tessellate_bodies(&self.brep, &[self.body], tolerances)
    }
}

fn frame(origin: Point3<f64>, z: Vector3<f64>, x: Vector3<f64>) -> Frame {
    Frame::from_axis(origin, z, Some(x)).expect("directions that differ")
}

/// A box with one corner in the origin.
fn cuboid([a, b, c]: [f64; 3]) -> Builder {
    let mut builder = Builder::new(BodyKind::Solid);
    let corner = |k: u32| Point3::new(f64::from(k & 1) * a, f64::from(k >> 1 & 1) * b, f64::from(k >> 2) * c);
    let vertices: Vec<_> = (0..8).map(|k| builder.vertex(corner(k))).collect();
    let mut edges = std::collections::BTreeMap::new();
    for [p, q, r, s] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        let uses: Vec<_> = [(p, q), (q, r), (r, s), (s, p)]
            .into_iter()
            .map(|(from, to): (usize, usize)| {
                let key = (from.min(to), from.max(to));
                let edge =
                    *edges.entry(key).or_insert_with(|| builder.line(vertices[key.0], vertices[key.1]));
                (edge, from < to)
            })
            .collect();
        let [origin, x, y] = [p, q, s].map(|k| builder.brep.vertices[vertices[k]].point);
        let plane = Surface::Plane(frame(origin, (x - origin).cross(&(y - origin)), x - origin));
        builder.face(plane, &[&uses]);
    }
    builder
}

/// A solid between two circles about the z axis; with a seam, or with a side of two loops.
fn turned(radii: [f64; 2], height: f64, side: Surface, seam: bool) -> Builder {
    let mut builder = Builder::new(BodyKind::Solid);
    let up = |z: f64| frame(Point3::new(0.0, 0.0, z), Vector3::z(), Vector3::x());
    let rings = [(radii[0], 0.0), (radii[1], height)].map(|(radius, z)| {
        let vertex = builder.vertex(Point3::new(radius, 0.0, z));
        (vertex, builder.edge(Curve::Circle { frame: up(z), radius }, vertex, vertex))
    });
    let [(low, bottom), (high, top)] = rings;
    if seam {
        let seam = builder.line(low, high);
        builder.face(side, &[&[(bottom, true), (seam, true), (top, false), (seam, false)]]);
    } else {
        builder.face(side, &[&[(bottom, true)], &[(top, false)]]);
    }
    let down = frame(Point3::origin(), -Vector3::z(), Vector3::x());
    builder.face(Surface::Plane(down), &[&[(bottom, false)]]);
    builder.face(Surface::Plane(up(height)), &[&[(top, true)]]);
    builder
}

fn upright() -> Frame {
    frame(Point3::origin(), Vector3::z(), Vector3::x())
}

fn assert_closed(mesh: &Mesh) {
    let integrity = Integrity::of(mesh);
    assert!(integrity.is_closed(), "{integrity:?}");
    assert_eq!((mesh.faces.len(), mesh.normals.len()), (mesh.triangles.len(), mesh.triangles.len()));
}

const FINE: Tolerances = Tolerances { chord: 0.01, angle: 0.35 };

#[test]
fn a_box_is_twelve_triangles_of_its_own_volume() {
    let mesh = cuboid([4.0, 3.0, 2.0]).mesh(&FINE).expect("planes");
    assert_closed(&mesh);
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 12));
    assert!((mesh.signed_volume() - 24.0).abs() < 1e-12);
    assert!((mesh.area() - 52.0).abs() < 1e-12);
    for (corners, normals) in mesh.corners().zip(&mesh.normals) {
        let flat = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
        assert!(normals.iter().all(|normal| (normal - flat).norm() < 1e-12));
    }
}

#[test]
fn a_reversed_shell_is_turned_over() {
    let mut builder = cuboid([1.0, 1.0, 1.0]);
    builder.brep.shells[builder.shell].forward = false;
    let mesh = builder.mesh(&FINE).expect("planes");
    assert_closed(&mesh);
    assert!((mesh.signed_volume() + 1.0).abs() < 1e-12);
}

#[test]
fn a_cylinder_closes_with_and_without_a_seam() {
    for seam in [true, false] {
        let side = Surface::Cylinder { frame: upright(), radius: 5.0 };
        let mesh = turned([5.0, 5.0], 12.0, side, seam).mesh(&FINE).expect("a cylinder");
        assert_closed(&mesh);
        // A chord of sagitta s on radius r cuts at most 4 s / (3 r) of the circle's area off.
        let exact = PI * 25.0 * 12.0;
        let volume = mesh.signed_volume();
        assert!(volume < exact && volume > exact * (1.0 - 4.0 * 0.0101 / 15.0), "{volume} of {exact}");
        assert!(mesh.triangles.len() < 1000, "{}", mesh.triangles.len());
    }
}

#[test]
fn a_cone_frustum_closes_with_and_without_a_seam() {
    let semi_angle = (3.0f64 / 8.0).atan();
    for seam in [true, false] {
        let side = Surface::Cone { frame: upright(), radius: 2.0, semi_angle };
        let mesh = turned([2.0, 5.0], 8.0, side, seam).mesh(&FINE).expect("a cone");
        assert_closed(&mesh);
        let exact = PI * 8.0 / 3.0 * (4.0 + 10.0 + 25.0);
        let volume = mesh.signed_volume();
        assert!(volume < exact && volume > exact * (1.0 - 4.0 * 0.0101 / 6.0), "{volume} of {exact}");
    }
}

/// A solid under a cap that shrinks to a pole above the circle of the given radius about the z axis.
fn capped(radius: f64, cap: Surface, pole: Pole) -> Builder {
    let mut builder = Builder::new(BodyKind::Solid);
    let vertex = builder.vertex(Point3::new(radius, 0.0, 0.0));
    let rim = builder.edge(Curve::Circle { frame: upright(), radius }, vertex, vertex);
    let face = match pole {
        Pole::Implied => builder.face(cap, &[&[(rim, true)]]),
        Pole::VertexLoop(at) => {
            let face = builder.face(cap, &[&[(rim, true)]]);
            let vertex = Some(builder.vertex(at));
            let apex =
                builder.brep.loops.push(Loop { face, outer: false, forward: true, coedges: vec![], vertex });
            builder.brep.faces[face].loops.push(apex);
            face
        }
        Pole::Seam(at) => {
            let apex = builder.vertex(at);
            let seam = builder.line(vertex, apex);
            builder.face(cap, &[&[(rim, true), (seam, true), (seam, false)]])
        }
    };
    assert!(builder.brep.faces[face].same_sense);
    let down = frame(Point3::origin(), -Vector3::z(), Vector3::x());
    builder.face(Surface::Plane(down), &[&[(rim, false)]]);
    builder
}

enum Pole {
    Implied,
    VertexLoop(Point3<f64>),
    Seam(Point3<f64>),
}

#[test]
fn cones_and_hemispheres_close_at_their_poles() {
    let top = Point3::new(0.0, 0.0, 4.0);
    // Narrowing upwards: radius 3 + v tan(angle) is zero at v = 4.
    let cone = || Surface::Cone { frame: upright(), radius: 3.0, semi_angle: -(3.0f64 / 4.0).atan() };
    let sphere = || Surface::Sphere { frame: upright(), radius: 4.0 };
    let (cone_volume, half_ball) = (PI * 9.0 * 4.0 / 3.0, PI * 64.0 * 2.0 / 3.0);
    for (radius, cap, pole, exact) in [
        (3.0, cone(), Pole::Implied, cone_volume),
        (3.0, cone(), Pole::VertexLoop(top), cone_volume),
        (3.0, cone(), Pole::Seam(top), cone_volume),
        (4.0, sphere(), Pole::Implied, half_ball),
        (4.0, sphere(), Pole::VertexLoop(top), half_ball),
    ] {
        let mesh = capped(radius, cap, pole).mesh(&FINE).expect("a cap");
        assert_closed(&mesh);
        let volume = mesh.signed_volume();
        // All chords lie inside; off by at most the chord over the area of the cap.
        let area = 2.0 * exact / radius.min(2.0);
        assert!(volume < exact && volume > exact - 0.0101 * area, "{volume} of {exact}");
    }
}

/// A solid of one face without an edge, bounded by a vertex loop or by nothing.
fn alone(surface: Surface, vertex: Option<Point3<f64>>) -> Builder {
    let mut builder = Builder::new(BodyKind::Solid);
    let face = builder.face(surface, &[]);
    if let Some(at) = vertex {
        let vertex = Some(builder.vertex(at));
        let bound =
            builder.brep.loops.push(Loop { face, outer: true, forward: true, coedges: vec![], vertex });
        builder.brep.faces[face].loops.push(bound);
    }
    builder
}

#[test]
fn whole_surfaces_close_without_an_edge() {
    let sphere = || Surface::Sphere { frame: upright(), radius: 4.0 };
    let torus = || Surface::Torus { frame: upright(), major_radius: 5.0, minor_radius: 2.0 };
    let (ball, ring) = (4.0 / 3.0 * PI * 64.0, 2.0 * PI * PI * 5.0 * 4.0);
    for (surface, vertex, exact, area) in [
        (sphere(), Some(Point3::new(0.0, 0.0, -4.0)), ball, 4.0 * PI * 16.0),
        (sphere(), None, ball, 4.0 * PI * 16.0),
        (torus(), Some(Point3::new(7.0, 0.0, 0.0)), ring, 4.0 * PI * PI * 10.0),
    ] {
        let mesh = alone(surface, vertex).mesh(&FINE).expect("a whole surface");
        assert_closed(&mesh);
        assert!((mesh.signed_volume() - exact).abs() < 0.0101 * area, "{} of {exact}", mesh.signed_volume());
    }
}

#[test]
fn what_is_left_of_a_sphere_has_both_poles() {
    // A ball of radius 5 cut off by the plane x = 3: its face is bounded by one small circle, clockwise, that
    // goes round neither pole nor seam.
    let mut builder = Builder::new(BodyKind::Solid);
    let towards_x = frame(Point3::new(-3.0, 0.0, 0.0), -Vector3::x(), Vector3::y());
    let vertex = builder.vertex(towards_x.point(4.0, 0.0, 0.0));
    let rim = builder.edge(Curve::Circle { frame: towards_x, radius: 4.0 }, vertex, vertex);
    builder.face(Surface::Sphere { frame: upright(), radius: 5.0 }, &[&[(rim, false)]]);
    builder.face(Surface::Plane(towards_x), &[&[(rim, true)]]);
    let mesh = builder.mesh(&FINE).expect("a ball without a cap");
    assert_closed(&mesh);
    // Ball less the cap of height 2: π h² (3 r - h) / 3.
    let exact = 4.0 / 3.0 * PI * 125.0 - PI * 4.0 * 13.0 / 3.0;
    assert!((mesh.signed_volume() - exact).abs() < 0.0101 * 314.0, "{} of {exact}", mesh.signed_volume());
}

#[test]
fn a_face_that_contradicts_its_loops_and_neighbours_is_turned() {
    let mut builder = cuboid([4.0, 3.0, 2.0]);
    let face = builder.brep.faces.ids().next().expect("six faces");
    builder.brep.faces[face].same_sense = false;
    let mesh = builder.mesh(&FINE).expect("planes");
    assert_closed(&mesh);
    assert!((mesh.signed_volume() - 24.0).abs() < 1e-12);
}

#[test]
fn a_band_is_cut_open_where_the_cut_meets_no_bound() {
    // The lower bound of a cylinder's side leans over: it goes back in u before it goes on, so that straight
    // up from its start stands its own other part.
    let mut builder = Builder::new(BodyKind::Surface);
    let at = |u: f64, v: f64| Point3::new(5.0 * u.cos(), 5.0 * u.sin(), v);
    let corners = [(0.0, 0.0), (-0.5, 1.0), (0.3, 2.0), (1.0, 0.5), (3.0, 0.0), (5.0, 0.0)];
    let vertices = corners.map(|(u, v)| builder.vertex(at(u, v)));
    let mut low = Vec::new();
    for k in 0..corners.len() {
        let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
        let to = if k + 1 == corners.len() { (to.0 + 2.0 * PI, to.1) } else { to };
        // A degree-one chain of short chords, near enough to the helix between its ends.
        let points: Vec<Point3<f64>> = (0..=40)
            .map(|i| f64::from(i) / 40.0)
            .map(|s| at(from.0 + s * (to.0 - from.0), from.1 + s * (to.1 - from.1)))
            .collect();
        let knots = KnotVector::clamped_uniform(1, 40, 0.0, 40.0).expect("good knots");
        let curve =
            NurbsCurve3::new(knots, points.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect()).expect("a net");
        let end = vertices[(k + 1) % corners.len()];
        low.push((builder.edge(Curve::Polyline(curve), vertices[k], end), true));
    }
    let top = frame(Point3::new(0.0, 0.0, 6.0), Vector3::z(), Vector3::x());
    let vertex = builder.vertex(at(0.0, 6.0));
    let high = builder.edge(Curve::Circle { frame: top, radius: 5.0 }, vertex, vertex);
    builder.face(Surface::Cylinder { frame: upright(), radius: 5.0 }, &[&low, &[(high, false)]]);
    let mesh = builder.mesh(&FINE).expect("a band");
    // The area under the lower bound, by the trapezoids of its corners, is missing.
    let ring = |k: usize| if k == corners.len() { (2.0 * PI, 0.0) } else { corners[k] };
    let under: f64 = (0..corners.len())
        .map(|k| (ring(k), ring(k + 1)))
        .map(|(a, b)| 0.5 * (a.1 + b.1) * (b.0 - a.0))
        .sum();
    let exact = 5.0 * (12.0 * PI - under);
    assert!((mesh.area() - exact).abs() < 3e-3 * exact, "{} of {exact}", mesh.area());
    let integrity = Integrity::of(&mesh);
    assert_eq!((integrity.crowded_edges, integrity.turned_edges), (0, 0));
}

#[test]
fn a_band_with_a_hole_where_it_might_be_cut_open() {
    let mut builder = Builder::new(BodyKind::Surface);
    let rings = [0.0, 6.0].map(|z| {
        let vertex = builder.vertex(Point3::new(5.0, 0.0, z));
        let frame = frame(Point3::new(0.0, 0.0, z), Vector3::z(), Vector3::x());
        builder.edge(Curve::Circle { frame, radius: 5.0 }, vertex, vertex)
    });
    // Cut by planes z = 2 and z = 4 and by two half planes at ±0.3 rad, around the rings' common start.
    let arc = |z: f64| Curve::Circle {
        frame: frame(Point3::new(0.0, 0.0, z), Vector3::z(), Vector3::x()),
        radius: 5.0,
    };
    let corner = |u: f64, z: f64| Point3::new(5.0 * u.cos(), 5.0 * u.sin(), z);
    let [a, b, c, d] =
        [(-0.3, 2.0), (0.3, 2.0), (0.3, 4.0), (-0.3, 4.0)].map(|(u, z)| builder.vertex(corner(u, z)));
    let sides =
        [builder.edge(arc(2.0), a, b), builder.line(b, c), builder.edge(arc(4.0), d, c), builder.line(d, a)];
    let hole = [(sides[3], false), (sides[2], true), (sides[1], false), (sides[0], false)];
    let side = Surface::Cylinder { frame: upright(), radius: 5.0 };
    builder.face(side, &[&[(rings[0], true)], &[(rings[1], false)], &hole]);
    let mesh = builder.mesh(&FINE).expect("a band");
    let exact = 2.0 * PI * 5.0 * 6.0 - 0.6 * 5.0 * 2.0;
    assert!((mesh.area() - exact).abs() < 2e-3 * exact, "{} of {exact}", mesh.area());
    assert_eq!(Integrity::of(&mesh).crowded_edges, 0);
    assert_eq!(Integrity::of(&mesh).turned_edges, 0);
}

#[test]
fn the_same_body_gives_the_same_mesh() {
    let builder = turned([5.0, 5.0], 12.0, Surface::Cylinder { frame: upright(), radius: 5.0 }, true);
    assert_eq!(builder.mesh(&FINE), builder.mesh(&FINE));
}

/// A flat bicubic face over [0, 20] x [0, 10] whose inner control points are pushed aside, so that parameters
/// are far from even, with two elliptic holes.
fn panel() -> (Builder, FaceId) {
    let mut builder = Builder::new(BodyKind::Surface);
    let knots = || KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0]).expect("good knots");
    let shares = [0.0, 0.1, 0.35, 0.8, 1.0];
    let net =
        shares.iter().flat_map(|x| shares.iter().map(move |y| [20.0 * x, 10.0 * y, 0.0, 1.0])).collect();
    let surface = NurbsSurface::new(knots(), knots(), net).expect("a good net");
    let corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]];
    let vertices = corners.map(|[x, y]| builder.vertex(Point3::new(x, y, 0.0)));
    let sides: Vec<_> = (0..4).map(|k| (builder.line(vertices[k], vertices[(k + 1) % 4]), true)).collect();
    let holes = [(5.0, 5.0, 3.0, 2.0, 0.3f64), (14.0, 4.0, 2.5, 1.0, -0.8)].map(|(x, y, a, b, turn)| {
        let axis = Vector3::new(turn.cos(), turn.sin(), 0.0);
        let frame = frame(Point3::new(x, y, 0.0), Vector3::z(), axis);
        let vertex = builder.vertex(frame.point(a, 0.0, 0.0));
        vec![(builder.edge(Curve::Ellipse { frame, semi_axis_1: a, semi_axis_2: b }, vertex, vertex), false)]
    });
    let face = builder.face(Surface::Nurbs(surface), &[&sides, &holes[0], &holes[1]]);
    (builder, face)
}

#[test]
fn a_b_spline_face_with_two_elliptic_holes_has_its_area() {
    let (builder, face) = panel();
    let tolerances = Tolerances { chord: 1e-3, angle: 0.2 };
    let mesh = tessellate_faces(&builder.brep, &[face], &tolerances).expect("a flat face");
    let exact = 200.0 - PI * (6.0 + 2.5);
    // Chords cut the holes, so the mesh is greater, by at most 2/3 of the chord's sagitta along the hole.
    let rim = 2.0 * PI * (3.0 + 2.5);
    assert!(mesh.area() > exact && mesh.area() < exact + rim * 1e-3, "{} of {exact}", mesh.area());
    let integrity = Integrity::of(&mesh);
    assert_eq!((integrity.crowded_edges, integrity.turned_edges, integrity.degenerate_triangles), (0, 0, 0));
    assert!(mesh.normals.iter().flatten().all(|normal| (normal - Vector3::z()).norm() < 1e-9));
}

#[test]
fn what_cannot_be_tessellated_is_named() {
    let (mut builder, face) = panel();
    let nonsense = Tolerances { chord: 0.0, angle: f64::NAN };
    let error = tessellate_faces(&builder.brep, &[face], &nonsense).expect_err("no tolerance");
    assert!(matches!(error, TessellateError::Tolerances { .. }));
    let entity = "OFFSET_SURFACE".to_owned();
    let surface = builder.brep.faces[face].surface;
    builder.brep.surfaces[surface] = Carried::Unread { entity, reason: "not read yet".to_owned() };
    let error = builder.mesh(&FINE).expect_err("an unread surface");
    assert_eq!(error.face(), Some(face));
    assert!(error.to_string().contains("OFFSET_SURFACE"), "{error}");
    let mut builder = cuboid([1.0, 1.0, 1.0]);
    let curve = builder.brep.edges.iter().next().map(|(_, edge)| edge.curve).expect("twelve edges");
    let entity = "OFFSET_CURVE_3D".to_owned();
    builder.brep.curves[curve] = Carried::Unread { entity, reason: "not read yet".to_owned() };
    let error = builder.mesh(&FINE).expect_err("an unread curve");
    assert!(error.to_string().contains("OFFSET_CURVE_3D") && error.edge().is_some(), "{error}");
}

#[test]
fn a_tolerance_far_too_small_ends_in_bounded_work() {
    let builder = cuboid([1.0, 1.0, 1.0]);
    let mesh = builder.mesh(&Tolerances { chord: 1e-300, angle: 1e-300 }).expect("planes need no vertices");
    assert_eq!(mesh.triangles.len(), 12);
}

#[test]
fn written_meshes_read_back_closed() {
    let side = Surface::Cylinder { frame: upright(), radius: 5.0 };
    let mesh = turned([5.0, 5.0], 12.0, side, true).mesh(&FINE).expect("a cylinder");
    let mut bytes = [Vec::new(), Vec::new(), Vec::new()];
    off::write(&mesh, &mut bytes[0]).expect("a vector takes all bytes");
    stl::write_binary(&mesh, "cylinder", &mut bytes[1]).expect("a vector takes all bytes");
    stl::write_text(&mesh, "cylinder", &mut bytes[2]).expect("a vector takes all bytes");
    let back = [off::read(&bytes[0]), stl::read(&bytes[1]), stl::read(&bytes[2])];
    for back in back {
        let back = back.expect("our own bytes");
        assert!(Integrity::of(&back).is_closed());
        assert_eq!(back.triangles.len(), mesh.triangles.len());
        assert!((back.signed_volume() - mesh.signed_volume()).abs() < 1e-4);
    }
}

#[test]
fn openscad_accepts_the_meshes() {
    let side = Surface::Cylinder { frame: upright(), radius: 5.0 };
    for builder in [cuboid([4.0, 3.0, 2.0]), turned([5.0, 5.0], 12.0, side, true)] {
        let mesh = builder.mesh(&FINE).expect("simple solids");
        let directory = tempfile::tempdir().expect("a temporary directory");
        let file = directory.path().join("given.off");
        let mut bytes = Vec::new();
        off::write(&mesh, &mut bytes).expect("a vector takes all bytes");
        std::fs::write(&file, bytes).expect("the directory is ours");
        let request = Request {
            file: &file,
            scratch: directory.path(),
            timeout: Request::DEFAULT_TIMEOUT,
            program: None,
        };
        match ask_openscad(&request) {
            Err(ValidateError::Missing { .. }) if std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_none() => {
                return;
            }
            verdict => {
                let verdict = verdict.expect("a verdict");
                assert!(verdict.accepted, "{verdict:?}");
            }
        }
    }
}
