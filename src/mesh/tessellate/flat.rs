//! Triangles that are none in space: three points of one straight line, as between the apex of a cone and two points of
//! a line through it, which the parameter plane keeps apart. A side that is not the boundary is turned in them.
//!
//! Leaves those whose longest side is the boundary, and moves no point.

use super::region::Node;
use crate::math::{Point3, Vector3};
use std::collections::BTreeMap;

/// Height of a triangle over its longest side, relative to that, below which its corners stand on one line: formats
/// of single precision would say no other.
const FLAT: f64 = 1e-6;

/// Times that all triangles are looked at, at most: several points on one line need a turn each.
const ROUNDS: usize = 8;

/// Turns the longest sides of triangles without an area, where both triangles that come of it have one. Triangles that
/// have a vertex twice, as at a pole, are no more.
pub(super) fn turn_flat(triangles: &mut Vec<[u32; 3]>, nodes: &[Node]) {
    if !triangles.iter().any(|triangle| is_flat(triangle, nodes)) {
        return;
    }
    // A pole or a seam stands several times in the parameter plane: the first node stands for all.
    let mut firsts = BTreeMap::new();
    let first = |(node, k): (&Node, u32)| node.vertex.map_or(k, |vertex| *firsts.entry(vertex).or_insert(k));
    let firsts: Vec<u32> = nodes.iter().zip(0..).map(first).collect();
    triangles.retain(|triangle| {
        let [a, b, c] = triangle.map(|node| firsts[node as usize]);
        a != b && b != c && c != a
    });
    for _ in 0..ROUNDS {
        if !turn_some(triangles, nodes, &firsts) {
            return;
        }
    }
}

fn turn_some(triangles: &mut [[u32; 3]], nodes: &[Node], firsts: &[u32]) -> bool {
    let flat: Vec<usize> = (0..triangles.len()).filter(|&k| is_flat(&triangles[k], nodes)).collect();
    if flat.is_empty() {
        return false;
    }
    let mut users: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (k, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|node| firsts[node as usize]);
        users.extend([(a, b), (b, c), (c, a)].map(|side| (side, k)));
    }
    let mut touched = vec![false; triangles.len()];
    for k in flat {
        let Some((turned, beside)) = turn(triangles[k], triangles, &users, nodes, firsts) else { continue };
        if touched[k] || touched[beside] || turned.iter().any(|triangle| is_flat(triangle, nodes)) {
            continue;
        }
        (touched[k], touched[beside]) = (true, true);
        [triangles[k], triangles[beside]] = turned;
    }
    touched.contains(&true)
}

/// The two triangles instead of a flat one and its neighbour at the longest side, and which the neighbour is.
fn turn(
    flat: [u32; 3],
    triangles: &[[u32; 3]],
    users: &BTreeMap<(u32, u32), usize>,
    nodes: &[Node],
    firsts: &[u32],
) -> Option<([[u32; 3]; 2], usize)> {
    let at = |node: u32| nodes[node as usize].point;
    let [a, b, c] = flat;
    let length = |(a, b, _): &(u32, u32, u32)| (at(*b) - at(*a)).norm_squared();
    let sides = [(a, b, c), (b, c, a), (c, a, b)];
    let (from, to, middle) = sides.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let first = |node: u32| firsts[node as usize];
    let &beside = users.get(&(first(to), first(from)))?;
    let far = triangles[beside].into_iter().find(|&node| ![first(from), first(to)].contains(&first(node)))?;
    // What the new side joins must not be joined already.
    let side = (first(middle), first(far));
    let is_new = !users.contains_key(&side) && !users.contains_key(&(side.1, side.0));
    let turned = [[to, middle, far], [middle, from, far]];
    let before = twice_area(at(to), at(from), at(far));
    let upright = turned.iter().all(|t| {
        let [a, b, c] = t.map(at);
        twice_area(a, b, c).dot(&before) > 0.0
    });
    (is_new && upright).then_some((turned, beside))
}

fn is_flat(triangle: &[u32; 3], nodes: &[Node]) -> bool {
    let [a, b, c] = triangle.map(|node| nodes[node as usize].point);
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    twice_area(a, b, c).norm() <= FLAT * longest
}

fn twice_area(a: Point3<f64>, b: Point3<f64>, c: Point3<f64>) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_points_gives_its_side_to_the_neighbour() {
        let node = |x: f64, y: f64| Node {
            uv: [0.0; 2],
            point: Point3::new(x, y, 0.0),
            vertex: None,
            tangents: [Vector3::zeros(); 2],
        };
        // Three triangles on the line from (0, 0) to (3, 0), and one above it.
        let nodes = [node(0.0, 0.0), node(1.0, 0.0), node(2.0, 0.0), node(3.0, 0.0), node(1.5, 1.0)];
        let mut triangles = vec![[0, 1, 3], [1, 2, 3], [0, 3, 4]];
        turn_flat(&mut triangles, &nodes);
        for triangle in &mut triangles {
            let least = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
            triangle.rotate_left(least);
        }
        triangles.sort_unstable();
        assert_eq!(triangles, [[0, 1, 4], [1, 2, 4], [2, 3, 4]]);
        // Nothing stands beside the line here.
        let mut alone = vec![[0, 1, 3]];
        turn_flat(&mut alone, &nodes);
        assert_eq!(alone, [[0, 1, 3]]);
    }
}
