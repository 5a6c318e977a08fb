//! Closed polygons in the parameter plane: checks that a loop must pass before cells are counted with it.

/// Points nearer to each other than this part of the domain's range are one: below it, sides carry no direction.
const SAME_POINT: f64 = 1e-10;

/// A closed polygon in the parameters of a face.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contour {
    /// Points in order; the closing side is implied.
    pub points: Vec<[f64; 2]>,
    /// By how much the true curve may miss the polygon, in `u` and in `v`.
    pub margin: [f64; 2],
}

/// A closed polygon with the parameter distances by which the true curve may miss it.
///
/// INVARIANT: at least three points, consecutive ones distinct; the last is not the first repeated.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    points: Vec<[f64; 2]>,
    margin: [f64; 2],
}

/// What keeps a list of points from being a polygon of a domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PolygonFault {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// A point lies outside the domain by more than the margin.
    Outside([f64; 2]),
    /// Fewer than three distinct points, or no area.
    Degenerate,
    /// Two sides cross near this point.
    Crosses([f64; 2]),
}

/// The rectangle `[u0, u1] x [v0, v1]`.
pub type Domain = [(f64, f64); 2];

impl Polygon {
    /// Checks points against a domain; the closing side is implied, and a repeated first point is dropped.
    ///
    /// Points that lie outside by less than the margin, or by rounding, are moved to the border.
    ///
    /// # Errors
    /// See [`PolygonFault`].
    pub fn new(points: &[[f64; 2]], margin: [f64; 2], domain: Domain) -> Result<Self, PolygonFault> {
        if !points.iter().flatten().chain(&margin).all(|c| c.is_finite()) {
            return Err(PolygonFault::NotFinite);
        }
        let range = [domain[0].1 - domain[0].0, domain[1].1 - domain[1].0];
        let mut kept: Vec<[f64; 2]> = Vec::with_capacity(points.len());
        for &point in points {
            let inner = [point[0].clamp(domain[0].0, domain[0].1), point[1].clamp(domain[1].0, domain[1].1)];
            let allowed = |k: usize| margin[k].max(ON_BORDER * range[k]);
            if (0..2).any(|k| (inner[k] - point[k]).abs() > allowed(k)) {
                return Err(PolygonFault::Outside(point));
            }
            if kept.last().is_none_or(|&last| !same(last, inner, range)) {
                kept.push(inner);
            }
        }
        while kept.len() > 1 && same(kept[0], kept[kept.len() - 1], range) {
            kept.pop();
        }
        let polygon = Self { points: kept, margin };
        if polygon.points.len() < 3 {
            return Err(PolygonFault::Degenerate);
        }
        // First: a bow tie encloses as much on its left as on its right.
        if let Some(at) = polygon.first_crossing() {
            return Err(PolygonFault::Crosses(at));
        }
        if polygon.area().abs() <= SAME_POINT * SAME_POINT * range[0] * range[1] {
            return Err(PolygonFault::Degenerate);
        }
        Ok(polygon)
    }

    /// The points in order.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// By how much the true curve may miss the polygon, in `u` and in `v`.
    #[must_use]
    pub fn margin(&self) -> [f64; 2] {
        self.margin
    }

    /// Sides in order, the closing one last.
    pub fn sides(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().copied().zip(next.copied())
    }

    /// Signed area, positive when the polygon runs counter-clockwise.
    #[must_use]
    pub fn area(&self) -> f64 {
        let origin = self.points.first().copied().unwrap_or_default();
        let off = |p: [f64; 2]| [p[0] - origin[0], p[1] - origin[1]];
        self.sides().map(|(a, b)| (off(a), off(b))).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
    }

    /// First coordinates at which the polygon crosses the line of second coordinate `y`, ascending.
    ///
    /// Counts each vertex with one of its sides only, so that parity tells inside from outside.
    pub fn crossings(&self, y: f64, into: &mut Vec<f64>) {
        into.clear();
        for (a, b) in self.sides() {
            if (a[1] > y) != (b[1] > y) {
                into.push((b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0]);
            }
        }
        into.sort_by(f64::total_cmp);
    }

    /// Whether a point is inside by the even-odd rule.
    #[must_use]
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let mut crossings = Vec::new();
        self.crossings(point[1], &mut crossings);
        crossings.iter().filter(|&&c| c > point[0]).count() % 2 == 1
    }

    /// Whether two polygons cross, or one lies within the other.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        let nested = self.contains(other.points[0]) || other.contains(self.points[0]);
        nested || self.crosses(other).is_some()
    }

    /// A place near which the two cross.
    #[must_use]
    pub fn crosses(&self, other: &Self) -> Option<[f64; 2]> {
        let mut sides: Vec<_> = self.sides().map(|s| (s, 0)).collect();
        sides.extend(other.sides().map(|s| (s, 1)));
        sweep(&sides, |a, b| a != b)
    }

    fn first_crossing(&self) -> Option<[f64; 2]> {
        let sides: Vec<_> = self.sides().enumerate().map(|(k, s)| (s, k)).collect();
        let n = sides.len();
        sweep(&sides, |a: usize, b: usize| {
            let apart = a.abs_diff(b);
            apart > 1 && apart < n - 1
        })
    }
}

/// A loop that leaves the domain by less than this part of its range is on the border.
const ON_BORDER: f64 = 1e-7;

type Side = ([f64; 2], [f64; 2]);

/// First pair of sides that cross properly among those that `relevant` accepts, in order of their first coordinate.
fn sweep(sides: &[(Side, usize)], relevant: impl Fn(usize, usize) -> bool) -> Option<[f64; 2]> {
    let low = |s: &Side| s.0[0].min(s.1[0]);
    let mut order: Vec<_> = sides.iter().collect();
    order.sort_by(|a, b| low(&a.0).total_cmp(&low(&b.0)));
    for (at, (side, tag)) in order.iter().enumerate() {
        let high = side.0[0].max(side.1[0]);
        for (other, other_tag) in order[at + 1..].iter().take_while(|(s, _)| low(s) <= high) {
            if relevant(*tag, *other_tag) && cross(*side, *other) {
                return Some(side.0);
            }
        }
    }
    None
}

fn same(a: [f64; 2], b: [f64; 2], range: [f64; 2]) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() <= SAME_POINT * range[k])
}

/// Whether two sides cross at an inner point of both.
fn cross((a, b): Side, (c, d): Side) -> bool {
    let turn =
        |o: [f64; 2], p: [f64; 2], q: [f64; 2]| (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: Domain = [(0.0, 1.0), (0.0, 1.0)];

    fn made(points: &[[f64; 2]]) -> Result<Polygon, PolygonFault> {
        Polygon::new(points, [0.0; 2], DOMAIN)
    }

    #[test]
    fn a_repeated_first_point_is_dropped_and_the_area_is_signed() {
        let square = made(&[[0.2, 0.2], [0.6, 0.2], [0.6, 0.4], [0.2, 0.4], [0.2, 0.2]]).unwrap();
        assert_eq!(square.points().len(), 4);
        assert!((square.area() - 0.08).abs() < 1e-15);
        let turned = made(&[[0.2, 0.4], [0.6, 0.4], [0.6, 0.2], [0.2, 0.2]]).unwrap();
        assert!((turned.area() + 0.08).abs() < 1e-15);
    }

    #[test]
    fn points_off_by_rounding_come_to_the_border_and_others_are_refused() {
        let near = made(&[[-1e-12, 0.2], [0.6, 0.2], [0.6, 0.4]]).unwrap();
        assert_eq!(near.points()[0], [0.0, 0.2]);
        assert_eq!(made(&[[-0.01, 0.2], [0.6, 0.2], [0.6, 0.4]]), Err(PolygonFault::Outside([-0.01, 0.2])));
    }

    #[test]
    fn inside_is_told_by_parity() {
        // A comb with two teeth: the gap between them is outside.
        let comb =
            [[0.1, 0.1], [0.9, 0.1], [0.9, 0.8], [0.7, 0.8], [0.7, 0.3], [0.3, 0.3], [0.3, 0.8], [0.1, 0.8]];
        let comb = made(&comb).unwrap();
        assert!(comb.contains([0.2, 0.6]) && comb.contains([0.8, 0.6]) && comb.contains([0.5, 0.2]));
        assert!(!comb.contains([0.5, 0.6]) && !comb.contains([0.05, 0.2]));
    }

    #[test]
    fn crossings_within_one_polygon_and_between_two_are_found() {
        let bow = made(&[[0.1, 0.1], [0.9, 0.9], [0.9, 0.1], [0.1, 0.9]]);
        assert!(matches!(bow, Err(PolygonFault::Crosses(_))));
        let square = |x: f64, size: f64| {
            made(&[[x, 0.4], [x + size, 0.4], [x + size, 0.4 + size], [x, 0.4 + size]]).unwrap()
        };
        assert!(square(0.2, 0.2).overlaps(&square(0.3, 0.25)));
        assert!(square(0.2, 0.4).overlaps(&square(0.3, 0.1)));
        assert!(!square(0.2, 0.2).overlaps(&square(0.5, 0.2)));
    }
}
