//! The control points that act on a bound of a face, across seams too.
//!
//! Works on polygons in parameters and on nets; knows no model.

use super::cells::{CellGrid, Mask};
use super::polygon::Contour;
use crate::geometry::nurbs::NurbsSurface;

/// Distance of opposite borders that meet, as a part of the surface's size.
pub const MEETS: f64 = 1e-7;
/// Part of the domain within which a side lies on its border.
pub const ON_BORDER: f64 = 1e-7;

/// Periods of a surface that closes on itself.
#[must_use]
pub fn closed_directions(surface: &NurbsSurface) -> [Option<f64>; 2] {
    let tolerance = MEETS * surface.bounding_box().diagonal();
    let ((u0, u1), (v0, v1)) = surface.domain();
    [surface.is_closed_u(tolerance).then_some(u1 - u0), surface.is_closed_v(tolerance).then_some(v1 - v0)]
}

/// Whole periods by which an open polygon winds round the surface before it meets its start again.
#[must_use]
pub fn winding(contour: &Contour, periods: [Option<f64>; 2]) -> [f64; 2] {
    let (Some(first), Some(last)) = (contour.points.first(), contour.points.last()) else { return [0.0; 2] };
    [0, 1].map(|k| periods[k].map_or(0.0, |p| p * ((last[k] - first[k]) / p).round()))
}

/// The control points of a net that act on a bound. Pieces on the border of the domain do not count: there only the
/// outermost rows act.
#[must_use]
pub fn acting_on(contour: &Contour, net: &NurbsSurface, periods: [Option<f64>; 2]) -> Mask {
    let (u, v) = net.domain();
    let border = [u, v];
    let turn = winding(contour, periods);
    let mut points = contour.points.clone();
    points.extend(points.first().map(|p| [p[0] + turn[0], p[1] + turn[1]]));
    let sides = points.windows(2).map(|w| (w[0], w[1]));
    let inner = sides
        .flat_map(|side| copies(side, periods, border))
        .filter(|(a, b)| !on_border(*a, *b, border, contour.margin));
    let grid = CellGrid::new(net.knots_u(), net.knots_v());
    let cells = grid.met_by_sides(inner, contour.margin);
    grid.control_points(&cells)
}

type Side = ([f64; 2], [f64; 2]);

/// The parts of a side, moved by whole periods, that lie within the domain.
fn copies(side: Side, periods: [Option<f64>; 2], domain: [(f64, f64); 2]) -> Vec<Side> {
    let mut found = vec![side];
    for (k, period) in periods.into_iter().enumerate() {
        let Some(period) = period else { continue };
        let moved = |&(a, b): &Side, way: f64| {
            let (mut a, mut b) = (a, b);
            a[k] += way;
            b[k] += way;
            clipped((a, b), k, domain[k])
        };
        found =
            found.iter().flat_map(|s| [-period, 0.0, period].map(|way| moved(s, way))).flatten().collect();
    }
    found
}

/// The part of a side between two lines of one coordinate.
fn clipped((a, b): Side, k: usize, (low, high): (f64, f64)) -> Option<Side> {
    let slack = ON_BORDER * (high - low);
    let (low, high) = (low - slack, high + slack);
    if a[k].max(b[k]) < low || a[k].min(b[k]) > high {
        return None;
    }
    let way = b[k] - a[k];
    let cut = |at: [f64; 2]| {
        let to = at[k].clamp(low, high);
        if to == at[k] {
            return at;
        }
        let share = (to - a[k]) / way;
        let mut on = [0, 1].map(|m| a[m] + share * (b[m] - a[m]));
        on[k] = to;
        on
    };
    Some((cut(a), cut(b)))
}

fn on_border(a: [f64; 2], b: [f64; 2], border: [(f64, f64); 2], margin: [f64; 2]) -> bool {
    (0..2).any(|k| {
        let slack = (ON_BORDER * (border[k].1 - border[k].0)).max(margin[k]);
        [border[k].0, border[k].1].iter().any(|x| (a[k] - x).abs() <= slack && (b[k] - x).abs() <= slack)
    })
}
