//! Nearest points: a k-d tree without nodes.
//!
//! The points stand in the order of the tree: the middle one of a range splits the rest of it by one coordinate, and short
//! ranges are searched one by one. One byte for each point tells the coordinate. Same points, same tree, whatever the
//! number of threads.

use crate::math::Point3;
use std::cmp::Ordering;

/// Points ordered for searches.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    points: Vec<Point3<f64>>,
    /// Where each point stood before.
    origin: Vec<u32>,
    /// The coordinate by which a range's middle point splits it.
    axes: Vec<u8>,
}

/// Ranges up to this length are searched one by one.
const LEAF: usize = 12;
/// Ranges beyond this length are ordered by two threads.
const SHARED: usize = 1 << 16;

impl Neighbours {
    /// Orders points, all finite.
    ///
    /// # Panics
    /// For more points than 32-bit numbers can name.
    #[must_use]
    pub fn new(points: &[Point3<f64>]) -> Self {
        let count =
            u32::try_from(points.len()).expect("a cloud has at most as many points as 32 bits can name");
        let mut entries: Vec<(Point3<f64>, u32)> = points.iter().copied().zip(0..count).collect();
        let mut axes = vec![0; entries.len()];
        order(&mut entries, &mut axes);
        let (points, origin) = entries.into_iter().unzip();
        Self { points, origin, axes }
    }

    /// The points in the tree's order.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Where each point stood in the list that was given.
    #[must_use]
    pub fn origin(&self) -> &[u32] {
        &self.origin
    }

    /// Calls for each point within a distance, with its place in the tree's order and the square of its distance; the
    /// order of the calls depends on the points alone.
    pub fn within(&self, at: &Point3<f64>, radius: f64, mut found: impl FnMut(usize, f64)) {
        let square = radius * radius;
        let mut visit = |k: usize, d: f64, _: f64| {
            if d <= square {
                found(k, d);
            }
            square
        };
        self.search(at, (0, self.points.len()), square, &mut visit);
    }

    /// The nearest point: its place in the tree's order and its distance; `None` without points.
    #[must_use]
    pub fn nearest(&self, at: &Point3<f64>) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        let mut visit = |k: usize, d: f64, reach: f64| {
            // Of equally near points, the first one in the list that was given.
            let wins = best.is_none_or(|(b, e)| {
                d.total_cmp(&e).then_with(|| self.origin[k].cmp(&self.origin[b])) == Ordering::Less
            });
            if wins {
                best = Some((k, d));
                d
            } else {
                reach
            }
        };
        self.search(at, (0, self.points.len()), f64::INFINITY, &mut visit);
        best.map(|(k, d)| (k, d.sqrt()))
    }

    /// Squares of the distances of the `count` nearest points, ascending; fewer when there are fewer.
    #[must_use]
    pub fn nearest_distances(&self, at: &Point3<f64>, count: usize) -> Vec<f64> {
        let mut best: Vec<f64> = Vec::with_capacity(count + 1);
        let mut visit = |_: usize, d: f64, _: f64| {
            let place = best.partition_point(|b| *b <= d);
            if place < count {
                best.insert(place, d);
                best.truncate(count);
            }
            if best.len() < count { f64::INFINITY } else { best[count - 1] }
        };
        self.search(at, (0, self.points.len()), f64::INFINITY, &mut visit);
        best
    }

    /// Visits the points of a range that may be nearer than a reach, given by its square; each visit tells the reach from
    /// then on. Gives the reach at the end.
    fn search(
        &self,
        at: &Point3<f64>,
        (low, high): (usize, usize),
        mut reach: f64,
        visit: &mut impl FnMut(usize, f64, f64) -> f64,
    ) -> f64 {
        let distance = |k: usize| (self.points[k] - at).norm_squared();
        if high - low <= LEAF {
            for k in low..high {
                let d = distance(k);
                if d <= reach {
                    reach = visit(k, d, reach);
                }
            }
            return reach;
        }
        let middle = low + (high - low) / 2;
        let axis = usize::from(self.axes[middle]);
        let off = at[axis] - self.points[middle][axis];
        let (near, far) = if off <= 0.0 {
            ((low, middle), (middle + 1, high))
        } else {
            ((middle + 1, high), (low, middle))
        };
        reach = self.search(at, near, reach, visit);
        if off * off <= reach {
            let d = distance(middle);
            if d <= reach {
                reach = visit(middle, d, reach);
            }
            reach = self.search(at, far, reach, visit);
        }
        reach
    }

    /// Distance of neighbouring points: the root of the area of one point, from the circles round some points that hold
    /// `AROUND` others. 0 for a cloud of one place.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let n = self.points.len();
        let around = AROUND.min(n.saturating_sub(1));
        if around == 0 {
            return 0.0;
        }
        let stride = (n / SAMPLED).max(1);
        let area = |k: usize| {
            // The point itself is the nearest.
            let all = self.nearest_distances(&self.points[k], around + 1);
            std::f64::consts::PI * all[all.len() - 1] / around as f64
        };
        let mut areas: Vec<f64> = (0..n).step_by(stride).map(area).collect();
        let half = areas.len() / 2;
        areas.select_nth_unstable_by(half, f64::total_cmp).1.sqrt()
    }
}

/// Points of the circle that measures the density.
const AROUND: usize = 12;
/// Circles that are measured.
const SAMPLED: usize = 1000;

/// Puts the middle point by the longest side of the points' box into the middle, and goes on with both halves.
fn order(entries: &mut [(Point3<f64>, u32)], axes: &mut [u8]) {
    if entries.len() <= LEAF {
        return;
    }
    let axis = longest(entries);
    let middle = entries.len() / 2;
    let before = |a: &(Point3<f64>, u32), b: &(Point3<f64>, u32)| {
        a.0[usize::from(axis)].total_cmp(&b.0[usize::from(axis)]).then(a.1.cmp(&b.1))
    };
    let (left, _, right) = entries.select_nth_unstable_by(middle, before);
    let (left_axes, rest) = axes.split_at_mut(middle);
    rest[0] = axis;
    let right_axes = &mut rest[1..];
    if left.len() > SHARED {
        rayon::join(|| order(left, left_axes), || order(right, right_axes));
    } else {
        order(left, left_axes);
        order(right, right_axes);
    }
}

fn longest(entries: &[(Point3<f64>, u32)]) -> u8 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (point, _) in entries {
        for k in 0..3 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    let side = |k: usize| high[k] - low[k];
    if side(0) >= side(1) && side(0) >= side(2) {
        0
    } else if side(1) >= side(2) {
        1
    } else {
        2
    }
}
