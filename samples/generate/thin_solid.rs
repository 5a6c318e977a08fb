//! A panel as a thin solid with the holes through both skins.
//!
//! The inner skin is the outer one moved down by the thickness, so every wall is an exact ruled
//! surface: B-splines of degree 1 across along the border, linear extrusions in the holes.

use std::f64::consts::TAU;

use super::panel::Panel;
use super::records::{Name, Records, Schema, list};
use super::sheet::{BORDER_CORNERS, BORDERS, border_line, corners};
use super::spline::{Curve, Surface};

/// Thickness of a sheet of metal or plastic, in millimetres.
pub const SHEET: f64 = 2.0;
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
/// Colour of the walls in the holes.
const WALL: [f64; 3] = [0.85, 0.85, 0.2];

/// Faces and the two skins' loops while a solid grows.
struct Solid<'a> {
    records: &'a mut Records,
    panel: &'a Panel,
    thickness: f64,
    /// Outer skin, then inner.
    skins: [Name; 2],
    loops: [Vec<Name>; 2],
    walls: Vec<Name>,
    hole_walls: Vec<Name>,
}

/// The file of one thin solid.
pub fn write(title: &'static str, panel: &Panel, thickness: f64, schema: Schema) -> String {
    let mut records = Records::new(title, schema);
    let product = records.product(title);
    let skins = [
        records.surface("outer", &panel.surface),
        records.surface("inner", &panel.surface.translated(below(thickness))),
    ];
    let loops = [Vec::new(), Vec::new()];
    let mut solid =
        Solid { records: &mut records, panel, thickness, skins, loops, walls: vec![], hole_walls: vec![] };
    solid.border_walls();
    solid.hole_walls();
    let (faces, hole_walls) = solid.faces();
    let shell = records.add(format!("CLOSED_SHELL('',{})", list(&faces)));
    let body = records.add(format!("MANIFOLD_SOLID_BREP('{title}',{shell})"));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    records.representation(product, "ADVANCED_BREP_SHAPE_REPRESENTATION", &[placement, body]);
    let mut styled = vec![records.styled(body, panel.colour)];
    for &wall in &hole_walls {
        styled.push(records.styled(wall, WALL));
    }
    records.presentation(&styled);
    records.layer("skins", &faces[..2]);
    records.finish()
}

impl Solid<'_> {
    fn border_walls(&mut self) {
        let corners = corners(self.panel);
        let top = corners.map(|corner| self.records.vertex(corner));
        let bottom = corners.map(|[x, y, z]| self.records.vertex([x, y, z - self.thickness]));
        // A corner's edge lies on the walls beside it, so the walls' surfaces come first.
        let borders = BORDERS.map(|(side, at_end, _)| self.panel.surface.border(side, at_end));
        let walls = [0, 1, 2, 3].map(|i| self.records.surface("wall", &ruled(&borders[i], self.thickness)));
        let mut corner_edges = Vec::new();
        for corner in 0..4 {
            let pcurves: Vec<Name> = (0..4)
                .filter_map(|wall| {
                    let end = BORDER_CORNERS[wall].iter().position(|&c| c == corner)?;
                    Some(self.records.line_pcurve(walls[wall], [end as f64, 0.0], [0.0, 1.0]))
                })
                .collect();
            let line = self.records.line(corners[corner], DOWN);
            let ends = [top[corner], bottom[corner]];
            corner_edges.push(self.records.edge(ends, line, "SURFACE_CURVE", &pcurves));
        }
        let mut loops = [Vec::new(), Vec::new()];
        for (i, (side, at_end, forward)) in BORDERS.into_iter().enumerate() {
            let [start, end] = BORDER_CORNERS[i];
            let edges = [(top, [0.0; 3], 0.0), (bottom, below(self.thickness), self.thickness)];
            let mut skin = 0;
            let edges = edges.map(|(vertices, offset, v)| {
                let curve = self.records.curve("", &borders[i].translated(offset));
                let (origin, direction) = border_line(side, at_end);
                let on_skin = self.records.line_pcurve(self.skins[skin], origin, direction);
                let on_wall = self.records.line_pcurve(walls[i], [0.0, v], [1.0, 0.0]);
                skin += 1;
                let ends = [vertices[start], vertices[end]];
                self.records.edge(ends, curve, "SURFACE_CURVE", &[on_skin, on_wall])
            });
            loops[0].push((edges[0], forward));
            loops[1].push((edges[1], !forward));
            // The wall's own normal looks into the sheet where the border runs with the loop.
            let mut around = vec![
                (edges[0], true),
                (corner_edges[end], true),
                (edges[1], false),
                (corner_edges[start], false),
            ];
            if forward {
                around = around.into_iter().rev().map(|(edge, along)| (edge, !along)).collect();
            }
            let around = self.records.edge_loop(&around);
            self.walls.push(self.records.face("WALL", walls[i], !forward, &[around]));
        }
        loops[1].reverse();
        for (skin, edges) in loops.into_iter().enumerate() {
            let edges = self.records.edge_loop(&edges);
            self.loops[skin].push(edges);
        }
    }

    fn hole_walls(&mut self) {
        let holes = self.panel.holes.iter().zip(self.panel.hole_curves());
        for (hole, curve) in holes {
            let start = curve.points[0];
            let below = curve.translated(below(self.thickness));
            let vertices = [self.records.vertex(start), self.records.vertex(below.points[0])];
            let curves = [self.records.curve("hole", &curve), self.records.curve("hole", &below)];
            let along = self.records.vector(DOWN);
            let wall = self.records.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',{},{along})", curves[0]));
            let edges = [0, 1].map(|skin| {
                let on_skin = self.records.ellipse_pcurve(self.skins[skin], hole);
                let on_wall = self.records.line_pcurve(wall, [0.0, skin as f64 * self.thickness], [1.0, 0.0]);
                let ends = [vertices[skin]; 2];
                self.records.edge(ends, curves[skin], "SURFACE_CURVE", &[on_skin, on_wall])
            });
            let line = self.records.line(start, DOWN);
            let sides = [TAU, 0.0].map(|u| self.records.line_pcurve(wall, [u, 0.0], [0.0, 1.0]));
            let seam = self.records.edge(vertices, line, "SEAM_CURVE", &sides);
            let around = [(edges[0], true), (seam, true), (edges[1], false), (seam, false)];
            let around = self.records.edge_loop(&around);
            self.hole_walls.push(self.records.face("HOLE_WALL", wall, true, &[around]));
            for (skin, forward) in [(0, false), (1, true)] {
                let edges = self.records.edge_loop(&[(edges[skin], forward)]);
                self.loops[skin].push(edges);
            }
        }
    }

    /// All faces, the skins first, and the walls of the holes once more.
    fn faces(self) -> (Vec<Name>, Vec<Name>) {
        let outer = self.records.face("OUTER_SKIN", self.skins[0], true, &self.loops[0]);
        let inner = self.records.face("INNER_SKIN", self.skins[1], false, &self.loops[1]);
        let mut faces = vec![outer, inner];
        faces.extend(self.walls);
        faces.extend(&self.hole_walls);
        (faces, self.hole_walls)
    }
}

/// The strip below a curve, from the curve at `v = 0` down to the thickness.
fn ruled(curve: &Curve, thickness: f64) -> Surface {
    let below = curve.translated(below(thickness));
    let net = curve.points.iter().zip(&below.points).flat_map(|(a, b)| [*a, *b]).collect();
    let across = vec![0.0, 0.0, thickness, thickness];
    Surface { degrees: [curve.degree, 1], knots: [curve.knots.clone(), across], net }
}

/// The way from the outer skin to the inner one.
fn below(thickness: f64) -> [f64; 3] {
    [0.0, 0.0, -thickness]
}
