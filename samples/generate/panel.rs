//! The formulas of the panels.

use std::f64::consts::PI;

use super::records::rounded;
use super::spline::{Curve, Ellipse, Surface, clamped, greville};

/// A panel: one surface over the unit square with elliptic holes in the parameter plane.
pub struct Panel {
    /// Product name and stem of the files.
    pub name: &'static str,
    /// Colour of the panel.
    pub colour: [f64; 3],
    pub surface: Surface,
    pub holes: Vec<Ellipse>,
}

/// What the files claim as their uncertainty, in millimetres; no edge is farther from its surface.
pub const UNCERTAINTY: f64 = 1e-6;

impl Panel {
    /// A door panel of 1000 mm by 700 mm with a shoulder line.
    pub fn door() -> Self {
        let height = |x: f64, y: f64| {
            30.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 70.0 * (PI * y).sin() + 10.0 * (8.0 * (y - 0.55)).tanh()
        };
        Self {
            name: "door",
            colour: [0.75, 0.12, 0.1],
            surface: part([3, 3], [6, 6], |x, y| [1000.0 * x, 700.0 * y, height(x, y)]),
            holes: vec![
                ellipse([0.25, 0.7], [0.05, 0.05], 0.0),
                ellipse([0.72, 0.62], [0.09, 0.05], 0.0),
                ellipse([0.5, 0.3], [0.12, 0.08], 0.4),
            ],
        }
    }

    /// A trunk lid of 1200 mm by 900 mm with a dent for the handle.
    pub fn trunk() -> Self {
        let height = |x: f64, y: f64| {
            let dent = (-((x - 0.5).powi(2) + (y - 0.6).powi(2)) / 0.03).exp();
            150.0 * (0.9 * PI * (x - 0.5)).cos() * (1.0 - 0.3 * y) - 90.0 * y * y - 25.0 * dent
        };
        Self {
            name: "trunk",
            colour: [0.1, 0.25, 0.55],
            surface: part([3, 3], [6, 6], |x, y| [1200.0 * (x - 0.5), 900.0 * y, height(x, y)]),
            holes: vec![
                ellipse([0.5, 0.6], [0.08, 0.06], 0.0),
                ellipse([0.22, 0.35], [0.05, 0.05], 0.0),
                ellipse([0.78, 0.35], [0.05, 0.05], 0.0),
            ],
        }
    }

    /// A hood of 1400 mm by 1000 mm with two bulges, degree 5 along the car.
    pub fn hood() -> Self {
        let height = |x: f64, y: f64| {
            100.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 60.0 * y - 90.0 * y.powi(3)
                + 12.0 * (4.0 * PI * x).cos()
        };
        Self {
            name: "hood",
            colour: [0.2, 0.45, 0.25],
            surface: part([3, 5], [4, 2], |x, y| [1400.0 * (x - 0.5), 1000.0 * y, height(x, y)]),
            holes: vec![
                ellipse([0.3, 0.5], [0.06, 0.08], 0.0),
                ellipse([0.7, 0.5], [0.06, 0.08], 0.0),
                ellipse([0.5, 0.25], [0.05, 0.04], 0.0),
            ],
        }
    }

    /// A shell like the vamp of a shoe, 260 mm by 110 mm, high over the instep.
    pub fn vamp() -> Self {
        let height = |x: f64, y: f64| {
            let across = (2.0 * y - 1.0).powi(2);
            (35.0 + 45.0 * (1.0 - (2.4 * (x - 0.75)).powi(2)).max(-0.6)) * (1.0 - 0.9 * across) + 12.0 * x * y
        };
        Self {
            name: "vamp",
            colour: [0.55, 0.35, 0.25],
            surface: part([3, 3], [10, 8], |x, y| {
                let half = 35.0 + 20.0 * (PI * x).sin();
                [260.0 * x, half * (2.0 * y - 1.0) + 8.0 * (PI * x).sin(), height(x, y)]
            }),
            holes: vec![ellipse([0.12, 0.5], [0.05, 0.1], 0.0)],
        }
    }

    /// The edges of the holes, proved to lie on the surface within [`UNCERTAINTY`].
    pub fn hole_curves(&self) -> Vec<Curve> {
        let curves: Vec<Curve> = self.holes.iter().map(|hole| self.surface.hole(hole)).collect();
        for (hole, curve) in self.holes.iter().zip(&curves) {
            let gap = self.surface.gap(hole, curve);
            assert!(gap < UNCERTAINTY, "a hole of {} is {gap} mm off its surface", self.name);
        }
        curves
    }
}

/// The surface whose control points are the values of `f` at the Greville abscissae.
pub fn part(degrees: [usize; 2], spans: [usize; 2], f: impl Fn(f64, f64) -> [f64; 3]) -> Surface {
    let knots = [clamped(degrees[0], spans[0]), clamped(degrees[1], spans[1])];
    let (along, across) = (greville(&knots[0], degrees[0]), greville(&knots[1], degrees[1]));
    let value = |&x: &f64| across.iter().map(|&y| f(x, y).map(rounded)).collect::<Vec<_>>();
    let net = along.iter().flat_map(value).collect();
    Surface { degrees, knots, net }
}

fn ellipse(center: [f64; 2], semi_axes: [f64; 2], rotation: f64) -> Ellipse {
    Ellipse { center, semi_axes, rotation }
}
