//! Distances of points from triangles, by a tree of boxes.

use super::Mesh;
use crate::math::{BoundingBox, Point3};

/// Triangles that are asked for their nearest point.
#[derive(Debug, Clone)]
pub struct NearestTriangle {
    corners: Vec<[Point3<f64>; 3]>,
    /// Triangles in the order of the tree's leaves.
    order: Vec<usize>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
struct Node {
    bounds: BoundingBox,
    /// Range of `order` below the node.
    range: (usize, usize),
    /// Its two children, if it is no leaf.
    children: Option<[usize; 2]>,
}

/// Triangles of a leaf at most.
const LEAF: usize = 8;

impl NearestTriangle {
    /// Builds the tree; empty without triangles.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(mesh.corners().collect())
    }

    /// Builds the tree of some triangles.
    #[must_use]
    pub fn of(corners: Vec<[Point3<f64>; 3]>) -> Self {
        let mut tree = Self { order: (0..corners.len()).collect(), corners, nodes: Vec::new() };
        if !tree.corners.is_empty() {
            tree.build(0, tree.corners.len());
        }
        tree
    }

    /// Halves along the longest side of the box, so the depth is the logarithm of the count.
    fn build(&mut self, start: usize, end: usize) -> usize {
        let bounds = BoundingBox::of(self.order[start..end].iter().flat_map(|&t| &self.corners[t]));
        let at = self.nodes.len();
        self.nodes.push(Node { bounds, range: (start, end), children: None });
        if end - start > LEAF {
            let size = bounds.max - bounds.min;
            let axis = size.imax();
            let corners = &self.corners;
            let key = |t: &usize| corners[*t].iter().map(|p| p[axis]).sum::<f64>();
            self.order[start..end].sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let middle = start.midpoint(end);
            let children = [self.build(start, middle), self.build(middle, end)];
            self.nodes[at].children = Some(children);
        }
        at
    }

    /// Distance of a point; infinite without triangles.
    #[must_use]
    pub fn distance(&self, point: &Point3<f64>) -> f64 {
        let mut best = f64::INFINITY;
        let mut ahead = Vec::new();
        if let Some(root) = self.nodes.first() {
            ahead.push((root.bounds.distance_squared(point), 0));
        }
        while let Some((away, at)) = ahead.pop() {
            if away >= best * best {
                continue;
            }
            let node = &self.nodes[at];
            match node.children {
                None => {
                    for &t in &self.order[node.range.0..node.range.1] {
                        best = best.min(to_triangle(point, &self.corners[t]));
                    }
                }
                Some(children) => {
                    let mut both =
                        children.map(|child| (self.nodes[child].bounds.distance_squared(point), child));
                    both.sort_by(|a, b| b.0.total_cmp(&a.0));
                    ahead.extend(both);
                }
            }
        }
        best
    }
}

/// Distance of a point from a triangle, by the regions of its corners and sides.
#[must_use]
pub fn to_triangle(p: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let inside = |from: &Point3<f64>, to: &Point3<f64>| (to - from).cross(&(p - from)).dot(&normal) >= 0.0;
    if normal.norm() > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        return ((p - a).dot(&normal) / normal.norm()).abs();
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}

/// Distance of a point from a segment.
#[must_use]
pub fn to_segment(p: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let (side, offset) = (to - from, p - from);
    let length = side.norm_squared();
    let t = if length > 0.0 { (offset.dot(&side) / length).clamp(0.0, 1.0) } else { 0.0 };
    (offset - side * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        [-10.0..10.0, -10.0..10.0, -10.0..10.0f64].prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_a_look_at_every_triangle_finds(
            corners in proptest::collection::vec([point(), point(), point()], 1..80), from in point(),
        ) {
            let plain = corners.iter().map(|t| to_triangle(&from, t)).fold(f64::INFINITY, f64::min);
            prop_assert!((NearestTriangle::of(corners).distance(&from) - plain).abs() <= 1e-12);
        }
    }

    #[test]
    fn known_distances() {
        let triangle = [Point3::origin(), Point3::new(4.0, 0.0, 0.0), Point3::new(0.0, 4.0, 0.0)];
        let cases = [
            ([1.0, 1.0, 3.0], 3.0),
            ([-3.0, 0.0, 4.0], 5.0),
            ([4.0, 4.0, 0.0], 8f64.sqrt()),
            ([2.0, -1.0, 0.0], 1.0),
        ];
        for (at, expected) in cases {
            assert!((to_triangle(&Point3::from(at), &triangle) - expected).abs() < 1e-14, "{at:?}");
        }
        assert_eq!(NearestTriangle::of(Vec::new()).distance(&Point3::origin()), f64::INFINITY);
    }
}
