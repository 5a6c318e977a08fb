//! Input surfaces and loops, all given by formulas (specification, section 7).

use std::f64::consts::PI;

pub use crate::nets::{part, weighted_part};
use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::Point3;
use resurf::ops::constrained_scale::{Contour, Energy, Freedom, HeldLoop, Hold, Scaling};

/// Ellipse polygon of `n` vertices.
pub fn ellipse(center: [f64; 2], radii: [f64; 2], turn: f64, n: usize) -> Vec<[f64; 2]> {
    let vertex = |k: usize| {
        let t = 2.0 * PI * k as f64 / n as f64;
        let (x, y) = (radii[0] * t.cos(), radii[1] * t.sin());
        [center[0] + x * turn.cos() - y * turn.sin(), center[1] + x * turn.sin() + y * turn.cos()]
    };
    (0..n).map(vertex).collect()
}

pub fn hole(group: usize, center: [f64; 2], radii: [f64; 2], turn: f64) -> HeldLoop {
    held(group, ellipse(center, radii, turn, 48))
}

pub fn held(group: usize, points: Vec<[f64; 2]>) -> HeldLoop {
    HeldLoop { contour: contour(points), group, hold: Hold::Rigid }
}

pub fn contour(points: Vec<[f64; 2]>) -> Contour {
    Contour { points, margin: [0.0; 2] }
}

/// A small panel of 400 by 300.
pub fn small() -> NurbsSurface {
    part([3, 3], [6, 6], small_point)
}

pub fn small_point(x: f64, y: f64) -> [f64; 3] {
    [400.0 * x, 300.0 * y, 40.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 25.0 * (PI * y).sin()]
}

pub fn door() -> (NurbsSurface, Vec<HeldLoop>) {
    let surface = part([3, 3], [6, 6], |x, y| {
        let z =
            30.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 70.0 * (PI * y).sin() + 10.0 * (8.0 * (y - 0.55)).tanh();
        [1000.0 * x, 700.0 * y, z]
    });
    let holes = vec![
        hole(0, [0.25, 0.70], [0.05, 0.05], 0.0),
        hole(1, [0.72, 0.62], [0.09, 0.05], 0.0),
        hole(2, [0.5, 0.3], [0.12, 0.08], 0.4),
    ];
    (surface, holes)
}

pub fn trunk() -> (NurbsSurface, Vec<HeldLoop>) {
    let surface = part([3, 3], [6, 6], |x, y| {
        let bump = ((x - 0.5).powi(2) + (y - 0.6).powi(2)) / 0.03;
        let z = 150.0 * (0.9 * PI * (x - 0.5)).cos() * (1.0 - 0.3 * y) - 90.0 * y * y - 25.0 * (-bump).exp();
        [1200.0 * (x - 0.5), 900.0 * y, z]
    });
    let holes = vec![
        hole(0, [0.5, 0.6], [0.08, 0.06], 0.0),
        hole(1, [0.22, 0.35], [0.05, 0.05], 0.0),
        hole(2, [0.78, 0.35], [0.05, 0.05], 0.0),
    ];
    (surface, holes)
}

pub fn hood() -> (NurbsSurface, Vec<HeldLoop>) {
    let surface = part([3, 5], [4, 2], |x, y| {
        let z = 100.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 60.0 * y - 90.0 * y.powi(3)
            + 12.0 * (4.0 * PI * x).cos();
        [1400.0 * (x - 0.5), 1000.0 * y, z]
    });
    let holes = vec![
        hole(0, [0.3, 0.5], [0.06, 0.08], 0.0),
        hole(1, [0.7, 0.5], [0.06, 0.08], 0.0),
        hole(2, [0.5, 0.25], [0.05, 0.04], 0.0),
    ];
    (surface, holes)
}

pub fn published(factors: [f64; 3]) -> Scaling {
    Scaling { energy: Energy::Published, ..Scaling::new(factors) }
}

pub fn free(scaling: Scaling) -> Scaling {
    Scaling { freedom: Freedom::Free, ..scaling }
}

/// Euclidean control points.
pub fn points(surface: &NurbsSurface) -> Vec<Point3<f64>> {
    surface.net().iter().map(|h| Point3::new(h[0] / h[3], h[1] / h[3], h[2] / h[3])).collect()
}

/// Greatest distance of two lists of points.
pub fn distance(a: &[Point3<f64>], b: &[Point3<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Points of a surface on an even grid over its domain, as fractions.
pub fn grid(surface: &NurbsSurface, n: usize) -> Vec<Point3<f64>> {
    let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let at = |k: usize| k as f64 / (n - 1) as f64;
    (0..n * n).map(|k| surface.point(u0 + (u1 - u0) * at(k / n), v0 + (v1 - v0) * at(k % n))).collect()
}
