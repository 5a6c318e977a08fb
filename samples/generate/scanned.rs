//! The parts that the clouds of [`scan`](super::scan) were taken of, without their features: what a designer has.

use std::f64::consts::TAU;

use super::panel::Panel;
use super::records::{Records, Schema, list, rounded};
use super::scan::{Kind, Part, RING, profile};
use super::spline::{Curve, Point, Surface, basis_matrix, clamped, greville};
use super::{sheet, thin_solid};

/// Thickness of the plate with the pad, in millimetres.
const PLATE: f64 = 12.0;

/// A plate as a thin solid: the pad's, whole or cut through.
pub fn plate(title: &'static str, kind: Kind, schema: Schema) -> String {
    thin_solid::write(title, &panel(title, kind), PLATE, schema)
}

/// The plate with the groove, as a sheet.
pub fn groove(schema: Schema) -> String {
    sheet::write(&panel("groove", Kind::Groove), schema)
}

fn panel(name: &'static str, kind: Kind) -> Panel {
    let part = Part::new(kind);
    let surface = cubic_patch(part.extent, |x, y| part.primary(x, y));
    Panel { name, colour: [0.6, 0.62, 0.65], surface, holes: Vec::new() }
}

/// The Bezier patch of a polynomial of degree 3 at most in each of x and y.
fn cubic_patch([x0, x1, y0, y1]: [f64; 4], height: impl Fn(f64, f64) -> f64) -> Surface {
    let third = |low: f64, high: f64, k: usize| low + (high - low) * (k as f64 / 3.0);
    let bezier = |f: [f64; 4]| {
        let second = (-5.0 * f[0] + 18.0 * f[1] - 9.0 * f[2] + 2.0 * f[3]) / 6.0;
        let third = (2.0 * f[0] - 9.0 * f[1] + 18.0 * f[2] - 5.0 * f[3]) / 6.0;
        [f[0], second, third, f[3]]
    };
    let along_y = |i: usize| bezier([0, 1, 2, 3].map(|j| height(third(x0, x1, i), third(y0, y1, j))));
    let rows = [0, 1, 2, 3].map(along_y);
    let columns = [0, 1, 2, 3].map(|j| bezier([0, 1, 2, 3].map(|i| rows[i][j])));
    let point = |i: usize, j: usize| [third(x0, x1, i), third(y0, y1, j), columns[j][i]].map(rounded);
    let net = (0..16).map(|k| point(k / 4, k % 4)).collect();
    Surface { degrees: [3, 3], knots: [clamped(3, 1), clamped(3, 1)], net }
}

/// Degree and spans of the membrane's profile: it follows the formula within [`PROFILE_ERROR`], rounding included.
const PROFILE: (usize, usize) = (5, 24);
const PROFILE_ERROR: f64 = 2e-9;

/// The membrane's profile over the radius, in the plane of x and z.
fn membrane() -> Curve {
    let (degree, spans) = PROFILE;
    let knots = clamped(degree, spans);
    let radius = |t: f64| RING[0] + (RING[1] - RING[0]) * t;
    let places = greville(&knots, degree);
    let heights: Vec<f64> = places.iter().map(|t| profile(radius(*t))).collect();
    let heights = solved(basis_matrix(&knots, degree, &places), heights);
    let points: Vec<Point> =
        places.iter().zip(heights).map(|(t, z)| [radius(*t), 0.0, z].map(rounded)).collect();
    let curve = Curve { degree, knots, points };
    for k in 0..=1000 {
        let [x, _, z] = curve.point(f64::from(k) / 1000.0);
        let off = (z - profile(x)).abs();
        assert!(off < PROFILE_ERROR, "the membrane's profile is {off} mm off");
    }
    curve
}

/// Equations by elimination; the matrix of a spline at its Greville abscissae needs no row exchanges.
fn solved(mut m: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for k in 0..n {
        let top = m[k].clone();
        for row in k + 1..n {
            let factor = m[row][k] / top[k];
            m[row].iter_mut().zip(&top).for_each(|(r, t)| *r -= factor * t);
            right[row] -= factor * right[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| m[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / m[k][k];
    }
    right
}

/// The membrane: one face turned about z, with a seam at the first axis, its outer side up.
pub fn diaphragm(schema: Schema) -> String {
    let mut records = Records::new("diaphragm", schema);
    let product = records.product("diaphragm");
    let profile = membrane();
    let curve = records.curve("", &profile);
    let (origin, axis) = (records.point([0.0; 3]), records.direction([0.0, 0.0, 1.0]));
    let axis = records.add(format!("AXIS1_PLACEMENT('',{origin},{axis})"));
    let surface = records.add(format!("SURFACE_OF_REVOLUTION('',{curve},{axis})"));
    let ends = [profile.points[0], profile.points[profile.points.len() - 1]];
    let vertices = ends.map(|end| records.vertex(end));
    let rims = [0, 1].map(|k| {
        let [radius, _, z] = ends[k];
        let placement = records.placement([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        let circle = records.add(format!("CIRCLE('',{placement},{radius:?})"));
        let pcurve = records.line_pcurve(surface, [0.0, k as f64], [1.0, 0.0]);
        records.edge([vertices[k]; 2], circle, "SURFACE_CURVE", &[pcurve])
    });
    let sides = [0.0, TAU].map(|u| records.line_pcurve(surface, [u, 0.0], [0.0, 1.0]));
    let seam = records.edge(vertices, curve, "SEAM_CURVE", &sides);
    // The surface's own normal, round by outwards, looks down: the loop runs the other way round it.
    let around = records.edge_loop(&[(seam, true), (rims[1], true), (seam, false), (rims[0], false)]);
    let face = records.face("MEMBRANE", surface, false, &[around]);
    let shell = records.add(format!("OPEN_SHELL('',{})", list(&[face])));
    let model = records.add(format!("SHELL_BASED_SURFACE_MODEL('diaphragm',{})", list(&[shell])));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    records.representation(product, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", &[placement, model]);
    let styled = records.styled(face, [0.8, 0.75, 0.55]);
    records.presentation(&[styled]);
    records.finish()
}
