//! Which control points are held, which stay as plainly scaled, and which are free: types 1, 3 and 2 of the
//! published method.
//!
//! Works on index sets alone. A held loop holds its inside as well.

use super::cells::{CellGrid, Mask};
use super::polygon::Polygon;
use super::scaling::Hold;
use crate::geometry::nurbs::NurbsSurface;

/// One face, its loops checked, ready to be refined.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Name for messages.
    pub name: String,
    /// Clamped surface.
    pub surface: NurbsSurface,
    /// Held loops.
    pub held: Vec<PreparedLoop>,
    /// Outer loop, where it is not the natural border.
    pub outer: Option<Polygon>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Polygon>,
}

/// A held loop of one face.
#[derive(Debug, Clone)]
pub struct PreparedLoop {
    /// Its polygon.
    pub polygon: Polygon,
    /// What is held.
    pub hold: Hold,
}

/// The index sets of one net.
#[derive(Debug, Clone)]
pub struct Envelopes {
    /// Control points of each held loop (type 1).
    pub held: Vec<Mask>,
    /// Control points that stay as plainly scaled (type 3).
    pub fixed: Mask,
}

/// Control points that must lie free between a held loop and the border, and between two held loops.
///
/// Three: counting rows by knots, as published, forgets the multiplicity of the end knots.
pub const GAP: usize = 3;

impl Envelopes {
    /// The index sets of a refined net; `rows` rows stay fixed at each side of the natural border.
    #[must_use]
    pub fn new(face: &Prepared, surface: &NurbsSurface, rows: usize) -> Self {
        let grid = CellGrid::new(surface.knots_u(), surface.knots_v());
        let filled = |polygon: &Polygon| {
            let mut cells = grid.met_by(polygon);
            cells.unite(&grid.inside(polygon));
            grid.control_points(&cells)
        };
        let held = face.held.iter().map(|l| filled(&l.polygon)).collect();
        let mut fixed = match &face.outer {
            None => border(surface.shape(), rows),
            Some(outer) => {
                let mut cells = grid.met_by(outer);
                cells.unite(&grid.inside(outer).complement());
                grid.control_points(&cells)
            }
        };
        for polygon in &face.scaled {
            fixed.unite(&filled(polygon));
        }
        Self { held, fixed }
    }

    /// The first held loop that is too near to the fixed points.
    #[must_use]
    pub fn near_border(&self) -> Option<usize> {
        self.held.iter().position(|held| held.dilated(GAP).meets(&self.fixed))
    }

    /// Pairs of held loops of different groups that are too near to each other.
    #[must_use]
    pub fn near_pairs(&self, group: &[usize]) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        for a in 1..self.held.len() {
            if group[..a].iter().all(|&g| g == group[a]) {
                continue;
            }
            let wide = self.held[a].dilated(GAP);
            let near = (0..a).filter(|&b| group[a] != group[b] && wide.meets(&self.held[b]));
            pairs.extend(near.map(|b| (b, a)));
        }
        pairs
    }
}

fn border((rows, columns): (usize, usize), kept: usize) -> Mask {
    let mut mask = Mask::empty(rows, columns);
    for i in 0..rows {
        for j in 0..columns {
            if i.min(rows - 1 - i).min(j).min(columns - 1 - j) < kept {
                mask.insert(i, j);
            }
        }
    }
    mask
}
