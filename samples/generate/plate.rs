//! A plate with plane faces: a box of which every edge is a line.

use super::records::{Name, Records, Schema, list};
use super::spline::Point;

/// Length, width and thickness in millimetres.
const SIZE: [f64; 3] = [260.0, 160.0, 12.0];
/// Corners of each face, counter-clockwise as seen from outside; the digits of an index are its z, y and x.
const FACES: [(&str, [usize; 4]); 6] = [
    ("TOP", [4, 5, 7, 6]),
    ("BOTTOM", [0, 2, 3, 1]),
    ("FRONT", [0, 1, 5, 4]),
    ("BACK", [2, 6, 7, 3]),
    ("LEFT", [0, 4, 6, 2]),
    ("RIGHT", [1, 3, 7, 5]),
];

fn corner(index: usize) -> Point {
    [0, 1, 2].map(|k| if index >> k & 1 == 1 { SIZE[k] } else { 0.0 })
}

fn unit(from: usize, to: usize) -> Point {
    let (a, b) = (corner(from), corner(to));
    let d = [0, 1, 2].map(|k| b[k] - a[k]);
    let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
    d.map(|c| c / length)
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The file of the plate.
pub fn write(schema: Schema) -> String {
    let mut records = Records::new("plate", schema);
    let product = records.product("plate");
    let vertices: Vec<Name> = (0..8).map(|k| records.vertex(corner(k))).collect();
    let mut edges: Vec<([usize; 2], Name)> = Vec::new();
    let mut faces = Vec::new();
    for (name, around) in FACES {
        let mut bound = Vec::new();
        for k in 0..4 {
            let ends = [around[k], around[(k + 1) % 4]];
            let back = [ends[1], ends[0]];
            if let Some((_, edge)) = edges.iter().find(|(known, _)| *known == back) {
                bound.push((*edge, false));
                continue;
            }
            let line = records.line(corner(ends[0]), unit(ends[0], ends[1]));
            let edge = records.plain_edge(ends.map(|v| vertices[v]), line);
            edges.push((ends, edge));
            bound.push((edge, true));
        }
        let x = unit(around[0], around[1]);
        let z = cross(x, unit(around[1], around[2]));
        let placement = records.placement(corner(around[0]), z, x);
        let plane = records.add(format!("PLANE('',{placement})"));
        let bound = records.edge_loop(&bound);
        faces.push(records.face(name, plane, true, &[bound]));
    }
    let shell = records.add(format!("CLOSED_SHELL('',{})", list(&faces)));
    let body = records.add(format!("MANIFOLD_SOLID_BREP('plate',{shell})"));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    records.representation(product, "ADVANCED_BREP_SHAPE_REPRESENTATION", &[placement, body]);
    let styled = records.styled(body, [0.6, 0.65, 0.7]);
    records.presentation(&[styled]);
    records.finish()
}
