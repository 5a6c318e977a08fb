//! Which control points a contour means: those that act inside it at all (CCPS), and those that act inside it
//! alone (PCPS). What is in the first and not in the second is the geometry context, which only blends.

use super::PasteError;
use super::settings::Rule;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::ops::net::{CellGrid, Mask, Polygon, PolygonFault};

/// Index sets of one contour.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identified {
    /// Control points that act inside the contour.
    pub acting: Mask,
    /// Control points that act inside it alone, and carry the feature.
    pub own: Mask,
}

/// Parameters within this part of the knot range of a knot count as on it.
const ON_KNOT: f64 = 1e-9;

/// Checks a contour against the domain of the source.
///
/// # Errors
/// The contour errors of [`PasteError`].
pub fn contour_polygon(source: &NurbsSurface, contour: &[[f64; 2]]) -> Result<Polygon, PasteError> {
    let (u, v) = source.domain();
    Polygon::new(contour, [0.0; 2], [u, v]).map_err(|fault| match fault {
        PolygonFault::NotFinite => PasteError::ContourNotFinite,
        PolygonFault::Outside(at) => PasteError::ContourOutside { at },
        PolygonFault::Degenerate => PasteError::ContourDegenerate,
        PolygonFault::Crosses(at) => PasteError::ContourCrosses { at },
    })
}

/// The index sets of a contour on a clamped surface.
#[must_use]
pub fn identify(surface: &NurbsSurface, contour: &Polygon, rule: Rule) -> Identified {
    match rule {
        Rule::Support => by_support(surface, contour),
        Rule::RowsAndColumns => by_rows_and_columns(surface, contour),
    }
}

fn by_support(surface: &NurbsSurface, contour: &Polygon) -> Identified {
    let grid = CellGrid::new(surface.knots_u(), surface.knots_v());
    let mut cells = grid.met_by(contour);
    cells.unite(&grid.inside(contour));
    let acting = grid.control_points(&cells);
    let own = acting.without(&grid.control_points(&cells.complement()));
    Identified { acting, own }
}

/// Knot indices of an interval: the last knot at or before its start, the first at or behind its end.
fn knot_range(knots: &KnotVector, start: f64, end: f64) -> (usize, usize) {
    let all = knots.knots();
    let slack = ON_KNOT * (all[all.len() - 1] - all[0]);
    let first = all.partition_point(|&k| k <= start + slack).saturating_sub(1);
    let last = all.partition_point(|&k| k < end - slack);
    (first.min(knots.n_basis() - 1), last.max(knots.degree() + 1))
}

/// The published sets: on the parameter line of each row, and of each column, at its Greville abscissa.
fn by_rows_and_columns(surface: &NurbsSurface, contour: &Polygon) -> Identified {
    let (rows, columns) = surface.shape();
    let mut out = Identified { acting: Mask::empty(rows, columns), own: Mask::empty(rows, columns) };
    let lines = [(surface.knots_u(), surface.knots_v()), (surface.knots_v(), surface.knots_u())];
    let turned: Vec<([f64; 2], [f64; 2])> =
        contour.sides().map(|(a, b)| ([a[1], a[0]], [b[1], b[0]])).collect();
    let upright: Vec<([f64; 2], [f64; 2])> = contour.sides().collect();
    for (direction, (along, across)) in lines.into_iter().enumerate() {
        let sides = if direction == 0 { &upright } else { &turned };
        for (line, &abscissa) in across.greville().iter().enumerate() {
            for (start, end) in intervals(sides, abscissa) {
                let (first, last) = knot_range(along, start, end);
                let p = along.degree();
                let insert = |mask: &mut Mask, range: std::ops::Range<usize>| {
                    for k in range {
                        if direction == 0 { mask.insert(k, line) } else { mask.insert(line, k) }
                    }
                };
                insert(&mut out.acting, first.saturating_sub(p)..last.min(along.n_basis()));
                insert(&mut out.own, first..last.saturating_sub(p).max(first));
            }
        }
    }
    out
}

/// Inside intervals of the line of second coordinate `y`.
fn intervals(sides: &[([f64; 2], [f64; 2])], y: f64) -> Vec<(f64, f64)> {
    let crosses = sides.iter().filter(|(a, b)| (a[1] > y) != (b[1] > y));
    let mut at: Vec<f64> = crosses.map(|(a, b)| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])).collect();
    at.sort_by(f64::total_cmp);
    at.as_chunks::<2>().0.iter().map(|&[a, b]| (a, b)).collect()
}

/// Rounds of bisection to give a small region enough control points.
const MAX_ROUNDS: usize = 6;

/// Bisects the source's spans under the contour until the region has `needed` rows and columns of its own.
///
/// # Errors
/// [`PasteError::RegionTooSmall`] when six rounds are not enough.
pub fn refine_for_region(
    source: &NurbsSurface,
    contour: &Polygon,
    rule: Rule,
    needed: usize,
) -> Result<(NurbsSurface, Identified), PasteError> {
    let mut source = source.clone();
    let mut found = (0, 0);
    for _ in 0..MAX_ROUNDS {
        let mut sets = identify(&source, contour, rule);
        sets.own = sets.own.off_border(1);
        found = occupied(&sets.own);
        if found.0 >= needed && found.1 >= needed {
            return Ok((source, sets));
        }
        let range = |k: usize| {
            let at = || contour.points().iter().map(|p| p[k]);
            (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max))
        };
        if found.0 < needed {
            source = source.refined_u(&middles(source.knots_u(), range(0)))?;
        }
        if found.1 < needed {
            source = source.refined_v(&middles(source.knots_v(), range(1)))?;
        }
    }
    Err(PasteError::RegionTooSmall { rows: found.0, columns: found.1, needed })
}

/// Rows and columns that hold a place of the set.
fn occupied(mask: &Mask) -> (usize, usize) {
    let (rows, columns) = mask.shape();
    let (mut in_row, mut in_column) = (vec![false; rows], vec![false; columns]);
    for at in mask.indices() {
        in_row[at / columns] = true;
        in_column[at % columns] = true;
    }
    let count = |bits: &[bool]| bits.iter().filter(|&&b| b).count();
    (count(&in_row), count(&in_column))
}

fn middles(knots: &KnotVector, (start, end): (f64, f64)) -> Vec<f64> {
    let (distinct, _) = knots.distinct();
    let met = distinct.windows(2).filter(|w| w[1] > start && w[0] < end);
    met.map(|w| 0.5 * (w[0] + w[1])).filter(|x| x.is_finite()).collect()
}
