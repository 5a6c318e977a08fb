//! Knot cells and the control points that act on them.
//!
//! A cell is a closed rectangle between consecutive distinct knots. This module knows index sets and polygons
//! in the parameter plane, nothing of points in space.
//!
//! INVARIANT: the knot vectors are clamped; a [`Mask`] has the shape it was made with for life.

use super::polygon::Polygon;
use crate::geometry::nurbs::KnotVector;

/// A point or a polygon on a knot line, within this part of the knot range, belongs to both sides.
const ON_KNOT_LINE: f64 = 1e-9;

/// A set of places on a rectangular grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    rows: usize,
    columns: usize,
    bits: Vec<bool>,
}

impl Mask {
    /// The empty set.
    #[must_use]
    pub fn empty(rows: usize, columns: usize) -> Self {
        Self { rows, columns, bits: vec![false; rows * columns] }
    }

    /// Rows and columns.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Whether the place is in the set.
    #[must_use]
    pub fn contains(&self, i: usize, j: usize) -> bool {
        self.bits[i * self.columns + j]
    }

    /// Whether the place of a flat index `i * columns + j` is in the set.
    #[must_use]
    pub fn contains_index(&self, at: usize) -> bool {
        self.bits[at]
    }

    /// Puts a place into the set.
    pub fn insert(&mut self, i: usize, j: usize) {
        self.bits[i * self.columns + j] = true;
    }

    /// Adds all places of a set of the same shape.
    pub fn unite(&mut self, other: &Self) {
        for (bit, &more) in self.bits.iter_mut().zip(&other.bits) {
            *bit |= more;
        }
    }

    /// The places that are not in the set.
    #[must_use]
    pub fn complement(&self) -> Self {
        Self { bits: self.bits.iter().map(|b| !b).collect(), ..*self }
    }

    /// The places of either of two sets of the same shape.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let mut out = self.clone();
        out.unite(other);
        out
    }

    /// The places that are not in another set of the same shape.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        let bits = self.bits.iter().zip(&other.bits).map(|(&a, &b)| a && !b).collect();
        Self { bits, ..*self }
    }

    /// The places that are not among the first and last `rows` rows and columns.
    #[must_use]
    pub fn off_border(&self, rows: usize) -> Self {
        let mut out = Self::empty(self.rows, self.columns);
        for at in self.indices() {
            let (i, j) = (at / self.columns, at % self.columns);
            out.bits[at] = i >= rows && i + rows < self.rows && j >= rows && j + rows < self.columns;
        }
        out
    }

    /// First and last row, first and last column of the places; `None` for the empty set.
    #[must_use]
    pub fn extent(&self) -> Option<[(usize, usize); 2]> {
        let mut extent: Option<[(usize, usize); 2]> = None;
        for at in self.indices() {
            let (i, j) = (at / self.columns, at % self.columns);
            let [(i0, i1), (j0, j1)] = extent.unwrap_or([(i, i), (j, j)]);
            extent = Some([(i0.min(i), i1.max(i)), (j0.min(j), j1.max(j))]);
        }
        extent
    }

    /// Parameters on which the control points of the set act: from the first knot of the first to the last knot of the
    /// last, along `u` and along `v`; `None` for the empty set.
    #[must_use]
    pub fn support(&self, knots: [&KnotVector; 2]) -> Option<[(f64, f64); 2]> {
        let extent = self.extent()?;
        Some([0, 1].map(|k| {
            let (first, last) = extent[k];
            let all = knots[k].knots();
            (all[first], all[last + knots[k].degree() + 1])
        }))
    }

    /// The set with rows and columns exchanged.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut out = Self::empty(self.columns, self.rows);
        for at in self.indices() {
            out.insert(at % self.columns, at / self.columns);
        }
        out
    }

    /// Whether two sets of the same shape share a place.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.bits.iter().zip(&other.bits).any(|(&a, &b)| a && b)
    }

    /// Count of places.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bits.iter().filter(|&&b| b).count()
    }

    /// Flat indices of the places, ascending.
    pub fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        self.bits.iter().enumerate().filter_map(|(at, &b)| b.then_some(at))
    }

    /// All places at most `radius` rows and columns away (Chebyshev distance).
    #[must_use]
    pub fn dilated(&self, radius: usize) -> Self {
        let mut wide = Self::empty(self.rows, self.columns);
        for at in self.indices() {
            let (i, j) = (at / self.columns, at % self.columns);
            let end = (j + radius).min(self.columns - 1);
            wide.bits[i * self.columns + j.saturating_sub(radius)..=i * self.columns + end].fill(true);
        }
        let mut out = Self::empty(self.rows, self.columns);
        for i in 0..self.rows {
            for k in i.saturating_sub(radius)..=(i + radius).min(self.rows - 1) {
                for j in 0..self.columns {
                    out.bits[i * self.columns + j] |= wide.bits[k * self.columns + j];
                }
            }
        }
        out
    }
}

/// Distinct knots of one direction with the control points that each span depends on.
#[derive(Debug, Clone)]
struct Axis {
    knots: Vec<f64>,
    /// Index in the full knot vector of the last copy of each distinct knot.
    last: Vec<usize>,
    degree: usize,
    n_basis: usize,
}

impl Axis {
    fn new(knots: &KnotVector) -> Self {
        let (distinct, multiplicities) = knots.distinct();
        let last = multiplicities
            .iter()
            .scan(0, |sum, &m| {
                *sum += m;
                Some(*sum - 1)
            })
            .collect();
        Self { knots: distinct, last, degree: knots.degree(), n_basis: knots.n_basis() }
    }

    fn n_cells(&self) -> usize {
        self.knots.len() - 1
    }

    fn range(&self) -> f64 {
        self.knots[self.knots.len() - 1] - self.knots[0]
    }

    /// Closed cells within `margin` of `x`, first and last.
    fn touched(&self, x: f64, margin: f64) -> (usize, usize) {
        let margin = margin.max(ON_KNOT_LINE * self.range());
        let first = self.knots.partition_point(|&k| k < x - margin).saturating_sub(1);
        let last = self.knots.partition_point(|&k| k <= x + margin).saturating_sub(1);
        let end = self.n_cells() - 1;
        (first.min(end), last.min(end))
    }

    /// Fractions in (0, 1) at which the way from `a` to `b` crosses a knot.
    fn cuts(&self, a: f64, b: f64, into: &mut Vec<f64>) {
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        let from = self.knots.partition_point(|&k| k <= low);
        let to = self.knots.partition_point(|&k| k < high);
        into.extend(self.knots[from.min(to)..to].iter().map(|k| (k - a) / (b - a)));
    }

    /// Control points that act on a cell, first and last.
    fn support(&self, cell: usize) -> (usize, usize) {
        let last = self.last[cell].min(self.n_basis - 1);
        (last - self.degree, last)
    }
}

/// The cells of one net.
#[derive(Debug, Clone)]
pub struct CellGrid {
    u: Axis,
    v: Axis,
}

impl CellGrid {
    /// The cells between the distinct knots of two clamped knot vectors.
    #[must_use]
    pub fn new(knots_u: &KnotVector, knots_v: &KnotVector) -> Self {
        Self { u: Axis::new(knots_u), v: Axis::new(knots_v) }
    }

    /// Count of cells in `u` and in `v`.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.u.n_cells(), self.v.n_cells())
    }

    /// Control points that act on a cell, first and last, along one direction: 0 for `u`, 1 for `v`.
    #[must_use]
    pub fn support(&self, direction: usize, cell: usize) -> (usize, usize) {
        self.axis(direction).support(cell)
    }

    /// Parameters at which a cell begins and ends along one direction.
    #[must_use]
    pub fn span(&self, direction: usize, cell: usize) -> (f64, f64) {
        let knots = &self.axis(direction).knots;
        (knots[cell], knots[cell + 1])
    }

    fn axis(&self, direction: usize) -> &Axis {
        if direction == 0 { &self.u } else { &self.v }
    }

    /// Every closed cell that the closed polygon meets, or comes nearer to than its margin.
    ///
    /// Each side is cut at all knot lines; the cut points and the middles of the pieces are classified, so
    /// no cell is missed however long a side is.
    #[must_use]
    pub fn met_by(&self, polygon: &Polygon) -> Mask {
        self.met_by_sides(polygon.sides(), polygon.margin())
    }

    /// As [`met_by`](Self::met_by), for any set of straight pieces.
    #[must_use]
    pub fn met_by_sides(&self, sides: impl Iterator<Item = ([f64; 2], [f64; 2])>, margin: [f64; 2]) -> Mask {
        let mut cells = Mask::empty(self.u.n_cells(), self.v.n_cells());
        let mut cuts = Vec::new();
        for (a, b) in sides {
            cuts.clear();
            cuts.extend([0.0, 1.0]);
            self.u.cuts(a[0], b[0], &mut cuts);
            self.v.cuts(a[1], b[1], &mut cuts);
            cuts.sort_by(f64::total_cmp);
            cuts.dedup();
            let middles = cuts.windows(2).map(|w| 0.5 * (w[0] + w[1]));
            for t in cuts.iter().copied().chain(middles) {
                let at = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                self.mark(at, margin, &mut cells);
            }
        }
        cells
    }

    fn mark(&self, at: [f64; 2], margin: [f64; 2], cells: &mut Mask) {
        let (first_u, last_u) = self.u.touched(at[0], margin[0]);
        let (first_v, last_v) = self.v.touched(at[1], margin[1]);
        for i in first_u..=last_u {
            for j in first_v..=last_v {
                cells.insert(i, j);
            }
        }
    }

    /// Every cell whose centre is inside the polygon by the even-odd rule.
    #[must_use]
    pub fn inside(&self, polygon: &Polygon) -> Mask {
        let mut cells = Mask::empty(self.u.n_cells(), self.v.n_cells());
        let mut crossings = Vec::new();
        for j in 0..self.v.n_cells() {
            let y = 0.5 * (self.v.knots[j] + self.v.knots[j + 1]);
            polygon.crossings(y, &mut crossings);
            for i in 0..self.u.n_cells() {
                let x = 0.5 * (self.u.knots[i] + self.u.knots[i + 1]);
                let beyond = crossings.len() - crossings.partition_point(|&c| c <= x);
                if beyond % 2 == 1 {
                    cells.insert(i, j);
                }
            }
        }
        cells
    }

    /// Every control point that acts on some cell of a set.
    #[must_use]
    pub fn control_points(&self, cells: &Mask) -> Mask {
        let mut points = Mask::empty(self.u.n_basis, self.v.n_basis);
        let columns = self.v.n_cells();
        for at in cells.indices() {
            let (first_u, last_u) = self.u.support(at / columns);
            let (first_v, last_v) = self.v.support(at % columns);
            for i in first_u..=last_u {
                for j in first_v..=last_v {
                    points.insert(i, j);
                }
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: [(f64, f64); 2] = [(0.0, 1.0), (0.0, 1.0)];

    fn polygon(points: &[[f64; 2]]) -> Polygon {
        Polygon::new(points, [0.0; 2], DOMAIN).unwrap()
    }

    fn ten_spans() -> CellGrid {
        let knots = KnotVector::clamped_uniform(3, 10, 0.0, 1.0).unwrap();
        CellGrid::new(&knots, &knots)
    }

    #[test]
    fn a_polygon_on_knot_lines_meets_the_cells_on_both_sides() {
        let square = polygon(&[[0.3, 0.3], [0.5, 0.3], [0.5, 0.5], [0.3, 0.5]]);
        let met = ten_spans().met_by(&square);
        // The ring of cells 2 to 5 in both directions; nothing of a 2 x 2 square is strictly inside.
        for i in 0..10 {
            for j in 0..10 {
                let near = (2..=5).contains(&i) && (2..=5).contains(&j);
                assert_eq!(met.contains(i, j), near, "cell ({i}, {j})");
            }
        }
    }

    #[test]
    fn long_sides_miss_no_cell_and_the_inside_is_filled() {
        let triangle = polygon(&[[0.05, 0.05], [0.95, 0.05], [0.05, 0.95]]);
        let grid = ten_spans();
        let mut cells = grid.met_by(&triangle);
        assert!((0..10).all(|k| cells.contains(k, 9 - k)), "the diagonal side");
        assert!(!cells.contains(3, 3));
        cells.unite(&grid.inside(&triangle));
        // Cells on or below the diagonal u + v = 1.
        for i in 0..10 {
            for j in 0..10 {
                assert_eq!(
                    cells.contains(i, j),
                    i + j <= 10 && (i + j < 10 || (1..=9).contains(&i)),
                    "({i}, {j})"
                );
            }
        }
    }

    #[test]
    fn control_points_of_a_cell_count_multiple_knots() {
        // Degree 2, double knot at 0.5: functions 0 to 2 act on the first span, 2 to 4 on the second.
        let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
        let v = KnotVector::clamped_uniform(1, 1, 0.0, 1.0).unwrap();
        let grid = CellGrid::new(&u, &v);
        assert_eq!(grid.shape(), (2, 1));
        let points = |cell: usize| {
            let mut cells = Mask::empty(2, 1);
            cells.insert(cell, 0);
            grid.control_points(&cells).indices().collect::<Vec<_>>()
        };
        assert_eq!(points(0), [0, 1, 2, 3, 4, 5]);
        assert_eq!(points(1), [4, 5, 6, 7, 8, 9]);
    }

    #[test]
    fn dilation_is_by_chebyshev_distance_and_stops_at_the_border() {
        let mut mask = Mask::empty(5, 7);
        mask.insert(0, 3);
        let wide = mask.dilated(2);
        for i in 0..5 {
            for j in 0..7_usize {
                assert_eq!(wide.contains(i, j), i <= 2 && j.abs_diff(3) <= 2);
            }
        }
    }
}
