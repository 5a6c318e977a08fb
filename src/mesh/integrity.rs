//! What may be wrong with a mesh as a boundary of a solid, as counts and one place each.
//!
//! States facts, repairs nothing. Works on indices alone: vertices at one place under two indices are two
//! vertices.

use super::Mesh;
use crate::math::Point3;

/// Facts that decide whether a mesh bounds a solid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Integrity {
    /// Edges of one triangle only.
    pub open_edges: usize,
    /// Edges of more than two triangles.
    pub crowded_edges: usize,
    /// Edges that two triangles run through in the same direction: one of them is turned over.
    pub turned_edges: usize,
    /// Triangles that name a vertex twice.
    pub degenerate_triangles: usize,
    /// Triangles that name a vertex that is not there, or one that is not finite.
    pub dangling_triangles: usize,
    /// Middle of the first edge that is open, crowded or turned.
    pub first_place: Option<Point3<f64>>,
}

impl Integrity {
    /// Counts over all edges of a mesh, in `O(n log n)`.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let mut found = Self::default();
        let mut uses = Vec::with_capacity(3 * mesh.triangles.len());
        for &[a, b, c] in &mesh.triangles {
            let sound = |at: u32| {
                mesh.vertices
                    .get(at as usize)
                    .is_some_and(|p| p.iter().all(|coordinate| coordinate.is_finite()))
            };
            if ![a, b, c].into_iter().all(sound) {
                found.dangling_triangles += 1;
            } else if a == b || b == c || c == a {
                found.degenerate_triangles += 1;
            } else {
                uses.extend(
                    [(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to)),
                );
            }
        }
        uses.sort_unstable();
        for edge in uses.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let ascending = edge.iter().filter(|e| e.2).count();
            let fact = match edge.len() {
                1 => &mut found.open_edges,
                2 if ascending != 1 => &mut found.turned_edges,
                2 => continue,
                _ => &mut found.crowded_edges,
            };
            *fact += 1;
            let [a, b] = [edge[0].0, edge[0].1].map(|at| mesh.vertices[at as usize]);
            found.first_place.get_or_insert_with(|| nalgebra::center(&a, &b));
        }
        found
    }

    /// Whether every edge has exactly two triangles that run through it in opposite directions, and every
    /// triangle three vertices.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::tests::cube;

    fn after(change: impl FnOnce(&mut Mesh)) -> Integrity {
        let mut mesh = cube([0.0; 3]);
        change(&mut mesh);
        Integrity::of(&mesh)
    }

    #[test]
    fn a_cube_is_closed() {
        assert!(after(|_| ()).is_closed());
    }

    #[test]
    fn each_damage_has_its_own_count() {
        let open = after(|mesh| mesh.triangles.truncate(11));
        assert_eq!((open.open_edges, open.is_closed()), (3, false));
        assert!(open.first_place.is_some());
        let turned = after(|mesh| mesh.triangles[0].swap(0, 1));
        assert_eq!((turned.turned_edges, turned.open_edges), (3, 0));
        let crowded = after(|mesh| mesh.triangles.push([0, 2, 3]));
        assert_eq!(crowded.crowded_edges, 3);
        let degenerate = after(|mesh| mesh.triangles.push([0, 0, 3]));
        assert_eq!((degenerate.degenerate_triangles, degenerate.open_edges), (1, 0));
        let dangling = after(|mesh| mesh.triangles.push([0, 1, 99]));
        assert_eq!(dangling.dangling_triangles, 1);
        let infinite = after(|mesh| mesh.vertices[0].x = f64::NAN);
        assert!(infinite.dangling_triangles > 0);
    }
}
