//! A panel as one face in an open shell.

use super::panel::Panel;
use super::records::{Name, Product, Records, Schema, list};
use super::spline::Point;

/// The borders in the order of the outer loop, counter-clockwise in the parameter plane: which
/// parameter is fixed, whether at its end, and whether the loop runs as the border's own parameter.
pub const BORDERS: [(usize, bool, bool); 4] =
    [(1, false, true), (0, true, true), (1, true, false), (0, false, false)];

/// Corners at the start and the end of each border, as indices into [`corners`].
pub const BORDER_CORNERS: [[usize; 2]; 4] = [[0, 1], [1, 2], [3, 2], [0, 3]];

/// Corners of the net, counter-clockwise from (0, 0).
pub fn corners(panel: &Panel) -> [Point; 4] {
    let (rows, columns) = (panel.surface.rows(), panel.surface.columns());
    [0, (rows - 1) * columns, rows * columns - 1, columns - 1].map(|at| panel.surface.net[at])
}

/// Origin and direction of a border in the parameter plane.
pub fn border_line(side: usize, at_end: bool) -> ([f64; 2], [f64; 2]) {
    let mut origin = [0.0; 2];
    origin[side] = f64::from(at_end);
    let mut direction = [0.0; 2];
    direction[1 - side] = 1.0;
    (origin, direction)
}

/// The file of one panel.
pub fn write(panel: &Panel, schema: Schema) -> String {
    let mut records = Records::new(panel.name, schema);
    let product = records.product(panel.name);
    let face = add(&mut records, panel, product).face;
    let styled = records.styled(face, panel.colour);
    records.presentation(&[styled]);
    records.layer("outer skin", &[face]);
    records.finish()
}

/// What a panel has become in a file.
pub struct Sheet {
    pub face: Name,
    pub representation: Name,
    pub placement: Name,
}

/// Adds a panel to a product.
pub fn add(records: &mut Records, panel: &Panel, product: Product) -> Sheet {
    let surface = records.surface(panel.name, &panel.surface);
    let vertices = corners(panel).map(|corner| records.vertex(corner));
    let mut outer = Vec::new();
    for ((side, at_end, forward), [start, end]) in BORDERS.into_iter().zip(BORDER_CORNERS) {
        let curve = records.curve("", &panel.surface.border(side, at_end));
        let (origin, direction) = border_line(side, at_end);
        let pcurve = records.line_pcurve(surface, origin, direction);
        let edge = records.edge([vertices[start], vertices[end]], curve, "SURFACE_CURVE", &[pcurve]);
        outer.push((edge, forward));
    }
    let mut loops = vec![records.edge_loop(&outer)];
    for (hole, curve) in panel.holes.iter().zip(panel.hole_curves()) {
        let vertex = records.vertex(curve.points[0]);
        let curve = records.curve("hole", &curve);
        let pcurve = records.ellipse_pcurve(surface, hole);
        let edge = records.edge([vertex, vertex], curve, "SURFACE_CURVE", &[pcurve]);
        loops.push(records.edge_loop(&[(edge, false)]));
    }
    let face = records.face("OUTER_SKIN", surface, true, &loops);
    let shell = records.add(format!("OPEN_SHELL('',{})", list(&[face])));
    let model = records.add(format!("SHELL_BASED_SURFACE_MODEL('{}',{})", panel.name, list(&[shell])));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let representation =
        records.representation(product, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", &[placement, model]);
    Sheet { face, representation, placement }
}
