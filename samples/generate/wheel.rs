//! Turned solids with a bore: a wheel whose tread is a surface of revolution, and the same with a cylinder or a cone.
//!
//! The tread has a seam at the first axis; no face has curves in parameters but the tread, when asked for.

use std::f64::consts::TAU;

use super::records::{Name, Records, Schema, list};
use super::spline::{Curve, Point};

/// What the outer face is turned from.
#[derive(Clone, Copy, PartialEq)]
pub enum Tread {
    /// A B-spline profile: `SURFACE_OF_REVOLUTION`.
    Profile,
    /// `CYLINDRICAL_SURFACE`.
    Cylinder,
    /// `CONICAL_SURFACE`.
    Cone,
}

const BORE: f64 = 30.0;
const WIDTH: f64 = 120.0;
const LOW: f64 = 95.0;
/// Radius of the upper rim of the cone.
const HIGH_OF_CONE: f64 = 75.0;

const UP: Point = [0.0, 0.0, 1.0];
const DOWN: Point = [0.0, 0.0, -1.0];
const ALONG: Point = [1.0, 0.0, 0.0];

fn profile() -> Curve {
    let radius = [LOW, 101.0, 107.0, 110.0, 107.0, 101.0, LOW];
    let height = [0.0, 12.0, 36.0, 60.0, 84.0, 108.0, WIDTH];
    let points = radius.iter().zip(height).map(|(r, z)| [*r, 0.0, z]).collect();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0];
    Curve { degree: 3, knots, points }
}

struct Ring {
    vertex: Name,
    edge: Name,
}

fn ring(records: &mut Records, radius: f64, z: f64, pcurves: &[Name]) -> Ring {
    let vertex = records.vertex([radius, 0.0, z]);
    let placement = records.placement([0.0, 0.0, z], UP, ALONG);
    let circle = records.add(format!("CIRCLE('',{placement},{radius:?})"));
    let edge = if pcurves.is_empty() {
        records.plain_edge([vertex; 2], circle)
    } else {
        records.edge([vertex; 2], circle, "SURFACE_CURVE", pcurves)
    };
    Ring { vertex, edge }
}

/// The file of a turned solid.
pub fn write(name: &'static str, tread: Tread, schema: Schema) -> String {
    let mut records = Records::new(name, schema);
    let product = records.product(name);
    let high = if tread == Tread::Cone { HIGH_OF_CONE } else { LOW };
    let placement = records.placement([0.0; 3], UP, ALONG);
    let line = |records: &mut Records, from: Point, to: Point| {
        let d = [0, 1, 2].map(|k| to[k] - from[k]);
        let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
        records.line(from, d.map(|c| c / length))
    };
    let curve = records.curve("", &profile());
    let outer = match tread {
        Tread::Profile => {
            let (origin, axis) = (records.point([0.0; 3]), records.direction(UP));
            let axis = records.add(format!("AXIS1_PLACEMENT('',{origin},{axis})"));
            records.add(format!("SURFACE_OF_REVOLUTION('',{curve},{axis})"))
        }
        Tread::Cylinder => records.add(format!("CYLINDRICAL_SURFACE('',{placement},{LOW:?})")),
        Tread::Cone => {
            // A cone opens along its axis: this one looks down.
            let placement = records.placement([0.0, 0.0, WIDTH], DOWN, ALONG);
            let angle = ((LOW - HIGH_OF_CONE) / WIDTH).atan();
            records.add(format!("CONICAL_SURFACE('',{placement},{HIGH_OF_CONE:?},{angle:?})"))
        }
    };
    let rims = match tread {
        Tread::Profile => [0.0, 1.0].map(|v| records.line_pcurve(outer, [0.0, v], [1.0, 0.0])),
        Tread::Cylinder => [0.0, WIDTH].map(|v| records.line_pcurve(outer, [0.0, v], [1.0, 0.0])),
        Tread::Cone => [WIDTH, 0.0].map(|v| records.line_pcurve(outer, [TAU, v], [-1.0, 0.0])),
    };
    let low = ring(&mut records, LOW, 0.0, &rims[..1]);
    let up = ring(&mut records, high, WIDTH, &rims[1..]);
    let seam = if tread == Tread::Profile {
        let sides = [0.0, TAU].map(|u| records.line_pcurve(outer, [u, 0.0], [0.0, 1.0]));
        records.edge([low.vertex, up.vertex], curve, "SEAM_CURVE", &sides)
    } else {
        let line = line(&mut records, [LOW, 0.0, 0.0], [high, 0.0, WIDTH]);
        records.plain_edge([low.vertex, up.vertex], line)
    };
    let around = records.edge_loop(&[(low.edge, true), (seam, true), (up.edge, false), (seam, false)]);
    let mut faces = vec![records.face("TREAD", outer, true, &[around])];
    let inner = records.add(format!("CYLINDRICAL_SURFACE('',{placement},{BORE:?})"));
    let (inner_low, inner_up) = (ring(&mut records, BORE, 0.0, &[]), ring(&mut records, BORE, WIDTH, &[]));
    let wall = line(&mut records, [BORE, 0.0, 0.0], [BORE, 0.0, WIDTH]);
    let wall = records.plain_edge([inner_low.vertex, inner_up.vertex], wall);
    let around =
        records.edge_loop(&[(inner_low.edge, false), (wall, true), (inner_up.edge, true), (wall, false)]);
    faces.push(records.face("BORE", inner, false, &[around]));
    let sides = [("SIDE_LOW", 0.0, DOWN, [&low, &inner_low]), ("SIDE_UP", WIDTH, UP, [&up, &inner_up])];
    for (name, z, normal, [outside, inside]) in sides {
        let placement = records.placement([0.0, 0.0, z], normal, ALONG);
        let plane = records.add(format!("PLANE('',{placement})"));
        let forward = z > 0.0;
        let bounds =
            [(outside.edge, forward), (inside.edge, !forward)].map(|(e, f)| records.edge_loop(&[(e, f)]));
        faces.push(records.face(name, plane, true, &bounds));
    }
    let shell = records.add(format!("CLOSED_SHELL('',{})", list(&faces)));
    let body = records.add(format!("MANIFOLD_SOLID_BREP('{name}',{shell})"));
    let placement = records.placement([0.0; 3], UP, ALONG);
    records.representation(product, "ADVANCED_BREP_SHAPE_REPRESENTATION", &[placement, body]);
    let styled = records.styled(body, [0.25, 0.27, 0.3]);
    records.presentation(&[styled]);
    records.finish()
}
