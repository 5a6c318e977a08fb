//! A vase: one B-spline face that closes on itself, with a seam.

use std::f64::consts::{PI, TAU};

use super::panel::part;
use super::records::{Records, Schema, list, rounded};
use super::spline::Surface;

/// The wall: `u` runs up, `v` runs round, so that `du x dv` looks outwards.
fn wall() -> Surface {
    let radius = |x: f64| 60.0 + 22.0 * (PI * 1.5 * x).sin() - 10.0 * x;
    let mut surface = part([3, 3], [12, 32], |x, y| {
        let (sine, cosine) = (TAU * y).sin_cos();
        [radius(x) * cosine, -radius(x) * sine, 220.0 * x]
    });
    // The last column is the first to the last digit.
    let columns = surface.columns();
    for row in surface.net.chunks_mut(columns) {
        row[columns - 1] = row[0].map(rounded);
    }
    surface
}

/// The file of the vase.
pub fn write(schema: Schema) -> String {
    let mut records = Records::new("vase", schema);
    let product = records.product("vase");
    let wall = wall();
    let surface = records.closed_surface("wall", &wall);
    let columns = wall.columns();
    let low = records.vertex(wall.net[0]);
    let high = records.vertex(wall.net[wall.net.len() - columns]);
    let seam = records.curve("", &wall.border(1, false));
    let sides = [0.0, 1.0].map(|v| records.line_pcurve(surface, [0.0, v], [1.0, 0.0]));
    let seam = records.edge([low, high], seam, "SEAM_CURVE", &sides);
    let rims = [(low, false), (high, true)].map(|(vertex, at_end)| {
        let curve = records.curve("", &wall.border(0, at_end));
        let pcurve = records.line_pcurve(surface, [f64::from(at_end), 0.0], [0.0, 1.0]);
        records.edge([vertex; 2], curve, "SURFACE_CURVE", &[pcurve])
    });
    let around = records.edge_loop(&[(seam, true), (rims[1], true), (seam, false), (rims[0], false)]);
    let face = records.face("WALL", surface, true, &[around]);
    let shell = records.add(format!("OPEN_SHELL('',{})", list(&[face])));
    let model = records.add(format!("SHELL_BASED_SURFACE_MODEL('vase',{})", list(&[shell])));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    records.representation(product, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", &[placement, model]);
    let styled = records.styled(face, [0.35, 0.5, 0.75]);
    records.presentation(&[styled]);
    records.finish()
}
