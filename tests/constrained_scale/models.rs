//! Models made by hand: a thin panel with holes through both skins, as a closed solid.

use std::f64::consts::TAU;

use resurf::brep::{
    Body, BodyKind, Brep, Coedge, CurveId, Edge, EdgeId, Face, FaceId, Loop, LoopId, Shell, ShellId, Vertex,
    VertexId,
};
use resurf::geometry::nurbs::{KnotVector, NurbsCurve2, NurbsCurve3, NurbsSurface};
use resurf::geometry::{Carried, Curve, Curve2d, Surface};
use resurf::math::{Affine, Frame, Point2, Point3, Vector2, Vector3};
use resurf::model::{ChangeSet, Context, Model, Origin, Origins};
use resurf::units::{AngleUnit, LengthUnit, Tolerance};

use super::parts::ellipse;

/// Distance of the skins.
pub const THICKNESS: f64 = 3.0;

/// A hole: its curve on the upper skin with its image there, and its wall.
pub struct Hole {
    curve: Curve,
    pcurve: Curve2d,
    start: Point3<f64>,
    wall: Surface,
}

fn down() -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -THICKNESS)
}

/// A round hole in a flat panel of 400 by 300.
pub fn round_hole(x: f64, y: f64, radius: f64) -> Hole {
    let frame = Frame { origin: Point3::new(x, y, 0.0), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() };
    let pcurve = Curve2d::Ellipse {
        center: Point2::new(x / 400.0, y / 300.0),
        x: Vector2::x(),
        y: Vector2::y(),
        semi_axis_1: radius / 400.0,
        semi_axis_2: radius / 300.0,
    };
    let curve = Curve::Circle { frame, radius };
    Hole { curve, pcurve, start: Point3::new(x + radius, y, 0.0), wall: Surface::Cylinder { frame, radius } }
}

/// A hole of any shape in any panel: a fine polygon on the surface.
pub fn polygon_hole(top: &NurbsSurface, center: [f64; 2], radii: [f64; 2]) -> Hole {
    let mut uv = ellipse(center, radii, 0.3, 120);
    uv.push(uv[0]);
    let knots = KnotVector::clamped_uniform(1, 120, 0.0, TAU).unwrap();
    let points: Vec<Point3<f64>> = uv.iter().map(|p| top.point(p[0], p[1])).collect();
    let net = points.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect();
    let curve = Curve::Nurbs(NurbsCurve3::new(knots.clone(), net).unwrap());
    let flat = uv.iter().map(|p| [p[0], p[1], 1.0]).collect();
    let pcurve = Curve2d::Nurbs(NurbsCurve2::new(knots, flat).unwrap());
    let wall = Surface::LinearExtrusion { curve: Box::new(curve.clone()), direction: down() };
    Hole { curve, pcurve, start: points[0], wall }
}

/// Faces of the panel, in order.
pub const TOP: usize = 0;
pub const BOTTOM: usize = 1;
/// Side walls are 2 to 5, hole walls follow.
pub const FIRST_WALL: usize = 6;

#[derive(Default)]
struct Builder {
    brep: Brep,
    shell: Option<ShellId>,
}

impl Builder {
    fn vertex(&mut self, point: Point3<f64>) -> VertexId {
        self.brep.vertices.push(Vertex { point })
    }

    fn edge(&mut self, curve: Curve, start: VertexId, end: VertexId) -> EdgeId {
        let curve = self.brep.curves.push(Carried::Read(curve));
        self.brep.edges.push(Edge { curve, start, end, same_sense: true })
    }

    fn face(&mut self, surface: Surface, same_sense: bool) -> FaceId {
        let surface = self.brep.surfaces.push(Carried::Read(surface));
        let shell = self.shell.unwrap();
        let face = self.brep.faces.push(Face { surface, same_sense, loops: Vec::new(), shell });
        self.brep.shells[shell].faces.push(face);
        face
    }

    fn bound(&mut self, face: FaceId, outer: bool, edges: &[(EdgeId, bool, Option<Curve2d>)]) -> LoopId {
        let id = self.brep.loops.push(Loop { face, outer, forward: true, coedges: Vec::new(), vertex: None });
        for (edge, forward, pcurve) in edges {
            let (edge, forward, pcurve) = (*edge, *forward, pcurve.clone());
            let coedge = self.brep.coedges.push(Coedge { edge, in_loop: id, forward, pcurve });
            self.brep.loops[id].coedges.push(coedge);
        }
        self.brep.faces[face].loops.push(id);
        id
    }
}

fn shifted(curve: &Curve) -> Curve {
    curve.transformed(&Affine::translation(down())).unwrap()
}

/// The solid between a skin and its copy below. `bottom` may replace the lower skin's surface.
pub fn thin_solid(top: &NurbsSurface, holes: &[Hole], bottom: Option<Surface>) -> Model {
    let mut b = Builder::default();
    let body = b.brep.bodies.push(Body { kind: BodyKind::Solid, shells: Vec::new() });
    let shell = b.brep.shells.push(Shell { faces: Vec::new(), closed: true, forward: true, body });
    b.brep.bodies[body].shells.push(shell);
    b.shell = Some(shell);
    let lower = top.transformed(&Affine::translation(down()));
    let top_face = b.face(Surface::Nurbs(top.clone()), true);
    let bottom_face = b.face(bottom.unwrap_or(Surface::Nurbs(lower)), false);
    borders(&mut b, top, [top_face, bottom_face]);
    for hole in holes {
        add_hole(&mut b, hole, [top_face, bottom_face]);
    }
    model(b.brep)
}

/// The outer loops of both skins and the four side walls.
fn borders(b: &mut Builder, top: &NurbsSurface, skins: [FaceId; 2]) {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| top.point(u, v));
    let upper = corners.map(|p| b.vertex(p));
    let lower = corners.map(|p| b.vertex(p + down()));
    let curves = [
        top.iso_curve_v(0.0),
        top.iso_curve_u(1.0),
        top.iso_curve_v(1.0).reversed(),
        top.iso_curve_u(0.0).reversed(),
    ];
    let curves = curves.map(Curve::Nurbs);
    let line = |p: &Point3<f64>| Curve::Line { origin: *p, direction: down() };
    let posts: Vec<EdgeId> = (0..4).map(|k| b.edge(line(&corners[k]), upper[k], lower[k])).collect();
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (k, curve) in curves.iter().enumerate() {
        let next = (k + 1) % 4;
        let over = b.edge(curve.clone(), upper[k], upper[next]);
        let under = b.edge(shifted(curve), lower[k], lower[next]);
        let wall = Surface::LinearExtrusion { curve: Box::new(curve.clone()), direction: down() };
        let face = b.face(wall, false);
        let run =
            [(under, true, None), (posts[next], false, None), (over, false, None), (posts[k], true, None)];
        b.bound(face, true, &run);
        above.push((over, true, None));
        below.insert(0, (under, false, None));
    }
    b.bound(skins[0], true, &above);
    b.bound(skins[1], true, &below);
}

fn add_hole(b: &mut Builder, hole: &Hole, skins: [FaceId; 2]) {
    let (high, low) = (b.vertex(hole.start), b.vertex(hole.start + down()));
    let over = b.edge(hole.curve.clone(), high, high);
    let under = b.edge(shifted(&hole.curve), low, low);
    let seam = b.edge(Curve::Line { origin: hole.start, direction: down() }, high, low);
    let spline =
        |face: FaceId, b: &Builder| matches!(b.brep.surface_of(face).read(), Some(Surface::Nurbs(_)));
    let pcurve = |face: FaceId, b: &Builder| spline(face, b).then(|| hole.pcurve.clone());
    let (upper, lower) = (pcurve(skins[0], b), pcurve(skins[1], b));
    b.bound(skins[0], false, &[(over, false, upper)]);
    b.bound(skins[1], false, &[(under, true, lower)]);
    let wall = b.face(hole.wall.clone(), false);
    let run = [(over, true, None), (seam, true, None), (under, false, None), (seam, false, None)];
    b.bound(wall, true, &run);
}

/// A model of one body with origins counted through, faces from #1000.
pub fn model(brep: Brep) -> Model {
    let count = |n: usize, from: u64| (0..n as u64).map(move |k| Origin::Instance(from + k));
    let origins = Origins {
        curves: count(brep.curves.len(), 100).collect(),
        surfaces: count(brep.surfaces.len(), 200).collect(),
        vertices: count(brep.vertices.len(), 300).collect(),
        edges: count(brep.edges.len(), 400).collect(),
        coedges: count(brep.coedges.len(), 500).collect(),
        pcurves: brep.coedges.iter().map(|_| None).collect(),
        loops: count(brep.loops.len(), 700).collect(),
        faces: count(brep.faces.len(), 1000).collect(),
        shells: count(brep.shells.len(), 1200).collect(),
        bodies: count(brep.bodies.len(), 1300).collect(),
    };
    let context = Context {
        length: LengthUnit::millimetre(),
        angle: AngleUnit::radian(),
        uncertainty: Some(Tolerance(1e-3)),
    };
    Model {
        schema: Vec::new(),
        contexts: vec![context],
        body_context: brep.bodies.iter().map(|_| 0).collect(),
        faces: brep.faces.iter().map(|_| Default::default()).collect(),
        bodies: brep.bodies.iter().map(|_| Default::default()).collect(),
        free_curves: Vec::new(),
        free_curve_names: Vec::new(),
        products: Vec::new(),
        occurrences: Vec::new(),
        annotations: Vec::new(),
        origins,
        brep,
    }
}

/// The model with a change set applied: what a reader of the written file would see.
pub fn applied(model: &Model, changes: &ChangeSet) -> Model {
    let mut brep = model.brep.clone();
    for (face, surface) in &changes.surfaces {
        brep.faces[*face].surface = brep.surfaces.push(Carried::Read(surface.clone()));
    }
    for (edge, curve) in &changes.curves {
        let id: CurveId = brep.curves.push(Carried::Read(curve.clone()));
        brep.edges[*edge].curve = id;
    }
    for (vertex, point) in &changes.points {
        brep.vertices[*vertex].point = *point;
    }
    for (coedge, pcurve) in &changes.pcurves {
        brep.coedges[*coedge].pcurve = Some(pcurve.clone());
    }
    self::model(brep)
}
