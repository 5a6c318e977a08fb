//! An assembly of two: a door panel, and a bracket with plane faces that stands on it.

use super::panel::Panel;
use super::records::{Name, Product, Records, Schema, list};
use super::sheet;
use super::spline::Point;

/// Sides of the bracket, in millimetres.
const BRACKET: Point = [60.0, 40.0, 20.0];

/// The file of the assembly.
pub fn write(panel: &Panel, schema: Schema) -> String {
    let mut records = Records::new("assembly", schema);
    let whole = records.product("door-assembly");
    let door = records.product("door");
    let bracket = records.product("bracket");
    let sheet = sheet::add(&mut records, panel, door);
    let (body, solid, placement) = add_bracket(&mut records, bracket);
    let origin = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let panel_at = records.placement([0.0, 0.0, 50.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let bracket_at = records.placement([500.0, 600.0, 50.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let parent = records.representation(whole, "SHAPE_REPRESENTATION", &[origin, panel_at, bracket_at]);
    let uses = [
        ("panel", door, sheet.representation, sheet.placement, panel_at),
        ("bracket", bracket, solid, placement, bracket_at),
    ];
    for (name, part, child, from, to) in uses {
        let usage = records.add(format!(
            "NEXT_ASSEMBLY_USAGE_OCCURRENCE('{name}','{name}','',{},{},$)",
            whole.definition, part.definition
        ));
        let shape = records.add(format!("PRODUCT_DEFINITION_SHAPE('','',{usage})"));
        let transform = records.add(format!("ITEM_DEFINED_TRANSFORMATION('','',{from},{to})"));
        let relation = records.add(format!(
            "( REPRESENTATION_RELATIONSHIP('','',{child},{parent}) \
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({transform}) SHAPE_REPRESENTATION_RELATIONSHIP() )"
        ));
        records.add(format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{shape})"));
    }
    let styled = [records.styled(sheet.face, panel.colour), records.styled(body, [0.6, 0.6, 0.65])];
    records.presentation(&styled);
    records.finish()
}

/// A corner of the bracket: bit `k` of the index says whether coordinate `k` is at its end.
fn corner(index: usize) -> Point {
    [0, 1, 2].map(|k| if index >> k & 1 == 1 { BRACKET[k] } else { 0.0 })
}

/// Adds a box to a product: its body, representation and placement.
fn add_bracket(records: &mut Records, product: Product) -> (Name, Name, Name) {
    let vertices: Vec<Name> = (0..8).map(|i| records.vertex(corner(i))).collect();
    let mut edges = std::collections::BTreeMap::new();
    for start in 0..8_usize {
        for k in (0..3).filter(|k| start >> k & 1 == 0) {
            let end = start | 1 << k;
            let mut direction = [0.0; 3];
            direction[k] = 1.0;
            let line = records.line(corner(start), direction);
            edges.insert((start, end), records.plain_edge([vertices[start], vertices[end]], line));
        }
    }
    let mut faces = Vec::new();
    for k in 0..3 {
        for at_end in [false, true] {
            let (a, b) = (1 << ((k + 1) % 3), 1 << ((k + 2) % 3));
            let base = usize::from(at_end) << k;
            // Counter-clockwise seen along +k; turned for the side that looks along -k.
            let mut ring = [base, base | a, base | a | b, base | b];
            if !at_end {
                ring.reverse();
            }
            let around: Vec<(Name, bool)> = (0..4)
                .map(|i| (ring[i], ring[(i + 1) % 4]))
                .map(|(from, to)| (edges[&(from.min(to), from.max(to))], from < to))
                .collect();
            let mut normal = [0.0; 3];
            normal[k] = if at_end { 1.0 } else { -1.0 };
            let mut first = [0.0; 3];
            first[(k + 1) % 3] = 1.0;
            let placement = records.placement(corner(base), normal, first);
            let plane = records.add(format!("PLANE('',{placement})"));
            let around = records.edge_loop(&around);
            faces.push(records.face("", plane, true, &[around]));
        }
    }
    let shell = records.add(format!("CLOSED_SHELL('',{})", list(&faces)));
    let body = records.add(format!("MANIFOLD_SOLID_BREP('bracket',{shell})"));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let representation =
        records.representation(product, "ADVANCED_BREP_SHAPE_REPRESENTATION", &[placement, body]);
    (body, representation, placement)
}
