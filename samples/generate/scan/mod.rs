//! Parts on which a region of a primary surface was replaced by a secondary one and the edge between them rounded, as
//! formulas, and clouds of points on them, as a scanner would give.
//!
//! Heights over the plane of x and y in millimetres. The limiting line, where primary and secondary meet, and the lines
//! along which a ball of the blend's radius touches them are known from the formulas, so that whatever is reconstructed
//! from a cloud can be measured against them. Uses nothing but the standard library.

#![allow(dead_code, reason = "the samples and several test binaries each use a part of it")]

pub mod cloud;
pub mod contact;
pub mod ply;

use std::f64::consts::TAU;

pub use cloud::Cloud;
pub use contact::Contacts;

/// A part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A raised pad inside a curved plate of 171 mm by 73 mm.
    Pad,
    /// The same, cut through its middle along x: a pad at the border.
    Border,
    /// A groove that runs through a plate of 132 mm by 778 mm from one border to the other.
    Groove,
    /// One of forty raised features of a membrane turned about z, 5.4 mm in radius.
    Sector,
    /// All forty.
    Diaphragm,
}

/// Sectors of the diaphragm.
pub const SECTORS: usize = 40;
/// Least and greatest radius of the diaphragm.
pub const RING: [f64; 2] = [2.2, 5.4];
/// Stations of a limiting line.
const STATIONS: usize = 720;

/// A part with what is known of it.
#[derive(Debug, Clone)]
pub struct Part {
    pub kind: Kind,
    /// Least and greatest x, least and greatest y.
    pub extent: [f64; 4],
    /// Whether each limiting line is closed.
    pub closed: bool,
    /// 1 with the ball above the surface, -1 below.
    pub side: f64,
    /// Radius of the blend.
    pub radius: f64,
    /// Step of the differences that give normals.
    pub step: f64,
    /// One limiting line for a closed feature, two for a channel.
    pub truth: Vec<Contacts>,
}

impl Part {
    pub fn new(kind: Kind) -> Self {
        let (extent, closed, side, radius, step) = match kind {
            Kind::Pad => ([0.0, 171.0, 0.0, 73.0], true, 1.0, 5.0, 1e-3),
            Kind::Border => ([0.0, 171.0, 36.0, 73.0], false, 1.0, 5.0, 1e-3),
            Kind::Groove => ([0.0, 132.12, 0.0, 778.32], false, -1.0, 6.0, 1e-3),
            Kind::Sector => ([RING[0], RING[1], -0.5, 0.5], true, 1.0, 0.06, 1e-5),
            Kind::Diaphragm => ([-RING[1], RING[1], -RING[1], RING[1]], true, 1.0, 0.06, 1e-5),
        };
        let mut part = Self { kind, extent, closed, side, radius, step, truth: Vec::new() };
        part.truth = (0..part.lines()).map(|line| Contacts::of(&part, line)).collect();
        part
    }

    /// Count of limiting lines.
    fn lines(&self) -> usize {
        if self.kind == Kind::Groove { 2 } else { 1 }
    }

    /// Height of the primary surface.
    pub fn primary(&self, x: f64, y: f64) -> f64 {
        match self.kind {
            Kind::Pad | Kind::Border => {
                let (x, y) = (x / 171.0, y / 73.0);
                let across = 0.75 + 0.6 * y * (1.0 - y) * (1.0 + 0.5 * y);
                1.5 + 158.0 * x * (1.0 - x) * (1.0 - 0.35 * x) * across
            }
            Kind::Groove => {
                let (x, y) = (x / 132.12, y / 778.32);
                5.0 + 292.0 * y * (1.0 - y) * (1.0 - 0.4 * y) * (1.0 - 0.15 * x) + 30.0 * x * (1.0 - x)
            }
            Kind::Sector | Kind::Diaphragm => profile(x.hypot(y)),
        }
    }

    /// Height of the secondary surface; of the diaphragm, that of the feature on the first axis.
    pub fn secondary(&self, x: f64, y: f64) -> f64 {
        let base = self.primary(x, y);
        match self.kind {
            Kind::Pad | Kind::Border => {
                let along = (x - 82.0) / 47.0;
                let q = along.powi(2) + ((y - 36.0) / 20.0).powi(2);
                base + 13.5 * (1.0 - q) * (1.0 + 0.25 * q) * (1.0 + 0.12 * along)
            }
            Kind::Groove => {
                let q = ((x - groove_middle(y)) / groove_half(y)).powi(2);
                base - 16.0 * (1.0 - q) * (1.0 + 0.3 * q)
            }
            Kind::Sector | Kind::Diaphragm => {
                let q = (x - 3.9).powi(4) + (y / 0.21).powi(2);
                base + 0.16 * (1.0 - q) * (1.0 + 0.25 * q)
            }
        }
    }

    /// Parameters at which a limiting line is sampled.
    fn stations(&self) -> Vec<f64> {
        let even = |from: f64, to: f64, n: usize| {
            (0..n).map(move |i| from + (to - from) * (i as f64 / STATIONS as f64))
        };
        match self.kind {
            Kind::Pad | Kind::Sector | Kind::Diaphragm => even(0.0, TAU, STATIONS).collect(),
            // A little beyond the border: the blend's sections there lean over it.
            Kind::Border => even(-0.2, 0.5 * TAU + 0.2, STATIONS + 1).collect(),
            Kind::Groove => even(0.0, 778.32, STATIONS + 1).collect(),
        }
    }

    /// Point of a limiting line in the plane, with its unit tangent; the feature lies to the left.
    fn limiting(&self, line: usize, s: f64) -> ([f64; 2], [f64; 2]) {
        let (at, [tx, ty]) = match self.kind {
            Kind::Pad | Kind::Border => {
                let (sine, cosine) = s.sin_cos();
                ([82.0 + 47.0 * cosine, 36.0 + 20.0 * sine], [-47.0 * sine, 20.0 * cosine])
            }
            Kind::Sector | Kind::Diaphragm => {
                let (sine, cosine) = s.sin_cos();
                let x = cosine.signum() * cosine.abs().sqrt();
                let y = 0.21 * sine;
                ([3.9 + x, y], [-2.0 * y / (0.21 * 0.21), 4.0 * x.powi(3)])
            }
            Kind::Groove => {
                let at = |s: f64| {
                    if line == 0 {
                        [groove_middle(s) + groove_half(s), s]
                    } else {
                        let y = 778.32 - s;
                        [groove_middle(y) - groove_half(y), y]
                    }
                };
                let ([x0, y0], [x1, y1]) = (at(s - 1e-4), at(s + 1e-4));
                (at(s), [x1 - x0, y1 - y0])
            }
        };
        let length = tx.hypot(ty);
        (at, [tx / length, ty / length])
    }
}

/// Height of the membrane over the radius.
pub fn profile(radius: f64) -> f64 {
    0.35 + 0.5 * (1.4 * radius / 6.0).cos() - 0.04 * (2.0 * radius).sin()
}

fn groove_middle(y: f64) -> f64 {
    66.0 + 10.0 * (0.8 * TAU * y / 778.32).sin()
}

fn groove_half(y: f64) -> f64 {
    27.0 + 4.0 * (TAU * y / 778.32).cos()
}
