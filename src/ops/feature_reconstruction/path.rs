//! Paths: lines in the metric plane of the primary, by their length.
//!
//! A slice of a cloud is what lies over a path, along the primary's normals; a path may bend.

use super::Closure;
use super::metric::{Metric, ParameterLine};
use crate::math::{Point2, Vector2};

/// A line in the metric plane, of two points at least, none of them twice in a row. Beyond its ends it goes on straight.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    points: Vec<Point2<f64>>,
    /// Length up to each point.
    lengths: Vec<f64>,
}

/// A place on two paths, by the length along each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Along the one.
    pub here: f64,
    /// Along the other.
    pub there: f64,
}

impl Path {
    /// Through points; `None` when they are one place.
    #[must_use]
    pub fn new(points: impl IntoIterator<Item = Point2<f64>>) -> Option<Self> {
        let mut path = Self { points: Vec::new(), lengths: Vec::new() };
        for point in points {
            let length = match (path.points.last(), path.lengths.last()) {
                (Some(last), Some(length)) => {
                    let step = (point - last).norm();
                    if step == 0.0 {
                        continue;
                    }
                    length + step
                }
                _ => 0.0,
            };
            path.points.push(point);
            path.lengths.push(length);
        }
        (path.points.len() > 1).then_some(path)
    }

    /// A line of parameters; a closed one comes back to its start.
    #[must_use]
    pub fn of(line: &ParameterLine, metric: &Metric) -> Option<Self> {
        let again = (line.closure == Closure::Closed).then(|| line.points.first()).flatten();
        Self::new(line.points.iter().chain(again).map(|at| Point2::from(metric.lengths(*at))))
    }

    /// Its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The piece at a length, by the number of its second point.
    fn piece(&self, s: f64) -> usize {
        self.lengths.partition_point(|l| *l < s).clamp(1, self.points.len() - 1)
    }

    /// The point at a length.
    #[must_use]
    pub fn at(&self, s: f64) -> Point2<f64> {
        let k = self.piece(s);
        self.points[k - 1] + self.heading(k) * (s - self.lengths[k - 1])
    }

    /// Unit direction at a length, of the chord over `reach` to both sides.
    #[must_use]
    pub fn direction(&self, s: f64, reach: f64) -> Vector2<f64> {
        let chord = self.at(s + reach) - self.at(s - reach);
        chord.try_normalize(0.0).unwrap_or_else(|| self.heading(self.piece(s)))
    }

    fn heading(&self, k: usize) -> Vector2<f64> {
        (self.points[k] - self.points[k - 1]) / (self.lengths[k] - self.lengths[k - 1])
    }

    /// Length along and distance to the left of the nearest place.
    #[must_use]
    pub fn located(&self, point: Point2<f64>) -> (f64, f64) {
        let (mut best, mut found) = (f64::INFINITY, (0.0, 0.0));
        let last = self.points.len() - 1;
        for k in 1..=last {
            let heading = self.heading(k);
            let away = point - self.points[k - 1];
            let (low, high) = (
                if k == 1 { f64::NEG_INFINITY } else { 0.0 },
                if k == last { f64::INFINITY } else { self.lengths[k] - self.lengths[k - 1] },
            );
            let along = away.dot(&heading).clamp(low, high);
            let rest = away - heading * along;
            let square = rest.norm_squared();
            if square < best {
                best = square;
                let left = away.perp(&heading) < 0.0;
                found = (self.lengths[k - 1] + along, if left { square.sqrt() } else { -square.sqrt() });
            }
        }
        found
    }

    /// Where it crosses another path, in its own order; touching ends count once.
    #[must_use]
    pub fn crossings(&self, other: &Self) -> Vec<Meeting> {
        let mut all = Vec::new();
        for k in 1..self.points.len() {
            let (a, b) = (self.points[k - 1], self.points[k]);
            let (low, high) = (a.coords.inf(&b.coords), a.coords.sup(&b.coords));
            for j in 1..other.points.len() {
                let (c, d) = (other.points[j - 1], other.points[j]);
                let apart = |i: usize| c[i].max(d[i]) < low[i] || c[i].min(d[i]) > high[i];
                if apart(0) || apart(1) {
                    continue;
                }
                let (along, across, between) = (b - a, d - c, c - a);
                let area = along.perp(&across);
                let (s, t) = (between.perp(&across) / area, between.perp(&along) / area);
                // A crossing in a point between two pieces belongs to the later one.
                let last = |n: usize, of: &Self| n + 1 == of.points.len();
                let within = |x: f64, closed: bool| x >= 0.0 && (x < 1.0 || closed && x <= 1.0);
                if area != 0.0 && within(s, last(k, self)) && within(t, last(j, other)) {
                    let place = |of: &Self, n: usize, x: f64| {
                        of.lengths[n - 1] + x * (of.lengths[n] - of.lengths[n - 1])
                    };
                    all.push(Meeting { here: place(self, k, s), there: place(other, j, t) });
                }
            }
        }
        all.sort_by(|a, b| a.here.total_cmp(&b.here));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_a_bent_path_and_beyond_its_ends() {
        let path = Path::new([[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 4.0]].map(Point2::from)).unwrap();
        assert_eq!(path.length(), 7.0);
        for (s, point) in [(1.0, [1.0, 0.0]), (5.0, [3.0, 2.0]), (-2.0, [-2.0, 0.0]), (8.0, [3.0, 5.0])] {
            assert!((path.at(s) - Point2::from(point)).norm() < 1e-15);
        }
        assert_eq!(path.located(Point2::new(1.0, 0.5)), (1.0, 0.5));
        assert_eq!(path.located(Point2::new(3.5, 2.0)), (5.0, -0.5));
        assert_eq!(path.located(Point2::new(3.0, 6.0)), (9.0, 0.0));
        assert_eq!(path.direction(6.0, 0.5), Vector2::new(0.0, 1.0));
        assert_eq!(Path::new([[1.0, 1.0]; 3].map(Point2::from)), None);
    }

    #[test]
    fn crossings_are_counted_once() {
        let line = Path::new([[-1.0, 0.5], [4.0, 0.5]].map(Point2::from)).unwrap();
        let zigzag = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 0.5]].map(Point2::from);
        let zigzag = Path::new(zigzag).unwrap();
        let found: Vec<f64> = line.crossings(&zigzag).iter().map(|m| m.here).collect();
        assert_eq!(found, [1.5, 2.5, 4.0]);
        let through_corner = Path::new([[1.0, -1.0], [1.0, 3.0]].map(Point2::from)).unwrap();
        assert_eq!(through_corner.crossings(&zigzag).len(), 1);
        assert_eq!(line.crossings(&line), []);
    }
}
