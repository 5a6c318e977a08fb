//! A mesh with shorter sides: for what is drawn or measured at vertices and not between them.

use std::collections::BTreeMap;

use super::Mesh;
use super::tessellate::Tolerances;
use crate::math::{Point3, Vector3};

/// The triangles cut until no side is longer than `longest`, or the mesh has the most vertices that one may have. A side
/// is cut in its middle, for both its triangles, so that a closed mesh stays closed. New vertices lie on the old
/// triangles; normals at them are the mean of those at the side's ends.
#[must_use]
pub fn divided(mesh: &Mesh, longest: f64) -> Mesh {
    let mut mesh = mesh.clone();
    while longest > 0.0 && mesh.vertices.len() < Tolerances::MOST_VERTICES / 4 {
        let middles = middles(&mut mesh, longest);
        if middles.is_empty() {
            break;
        }
        mesh = cut(&mesh, &middles);
    }
    mesh
}

type Side = (u32, u32);

fn side(a: u32, b: u32) -> Side {
    (a.min(b), a.max(b))
}

/// A new vertex for each side that is too long.
fn middles(mesh: &mut Mesh, longest: f64) -> BTreeMap<Side, u32> {
    let mut found = BTreeMap::new();
    for corners in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = side(corners[k], corners[(k + 1) % 3]);
            let [p, q] = [a, b].map(|at| mesh.vertices[at as usize]);
            if (q - p).norm() > longest && !found.contains_key(&(a, b)) {
                // Below the limit of vertices, which an index holds.
                found.insert((a, b), mesh.vertices.len() as u32);
                mesh.vertices.push(Point3::from(0.5 * (p.coords + q.coords)));
            }
        }
    }
    found
}

/// A corner of a triangle in the making: vertex and normal.
type Corner = (u32, Vector3<f64>);

fn cut(mesh: &Mesh, middles: &BTreeMap<Side, u32>) -> Mesh {
    let mut out = Mesh { vertices: mesh.vertices.clone(), ..Mesh::default() };
    for (at, corners) in mesh.triangles.iter().enumerate() {
        let normals = mesh.normals.get(at).copied();
        let own: [Corner; 3] =
            std::array::from_fn(|k| (corners[k], normals.map_or(Vector3::zeros(), |n| n[k])));
        let mut put = |triangle: [Corner; 3]| {
            out.triangles.push(triangle.map(|corner| corner.0));
            out.faces.extend(mesh.faces.get(at));
            out.normals.extend(normals.map(|_| triangle.map(|corner| corner.1)));
        };
        let middle = |k: usize| {
            let (a, b) = (own[k], own[(k + 1) % 3]);
            let normal = (a.1 + b.1).try_normalize(0.0).unwrap_or(a.1);
            middles.get(&side(a.0, b.0)).map(|&vertex| (vertex, normal))
        };
        let turned = |k: usize| [own[k % 3], own[(k + 1) % 3], own[(k + 2) % 3]];
        match [middle(0), middle(1), middle(2)] {
            [Some(x), Some(y), Some(z)] => {
                [[own[0], x, z], [x, own[1], y], [z, y, own[2]], [x, y, z]].into_iter().for_each(put);
            }
            [Some(x), Some(y), None] => two(turned(0), x, y).into_iter().for_each(put),
            [None, Some(x), Some(y)] => two(turned(1), x, y).into_iter().for_each(put),
            [Some(y), None, Some(x)] => two(turned(2), x, y).into_iter().for_each(put),
            [Some(x), None, None] => one(turned(0), x).into_iter().for_each(put),
            [None, Some(x), None] => one(turned(1), x).into_iter().for_each(put),
            [None, None, Some(x)] => one(turned(2), x).into_iter().for_each(put),
            [None, None, None] => put(own),
        }
    }
    out
}

/// A triangle whose first side is cut.
fn one([a, b, c]: [Corner; 3], x: Corner) -> [[Corner; 3]; 2] {
    [[a, x, c], [x, b, c]]
}

/// A triangle whose first and second sides are cut.
fn two([a, b, c]: [Corner; 3], x: Corner, y: Corner) -> [[Corner; 3]; 3] {
    [[x, b, y], [a, x, y], [a, y, c]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Integrity;

    #[test]
    fn a_closed_mesh_stays_closed_with_its_volume_and_has_short_sides() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh {
            vertices: corners.map(Point3::from).to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
            ..Mesh::default()
        };
        let fine = divided(&mesh, 0.3);
        assert!((fine.signed_volume() - 1.0).abs() < 1e-12 && (fine.area() - mesh.area()).abs() < 1e-12);
        assert!(Integrity::of(&fine).is_closed());
        for [a, b, c] in fine.corners() {
            assert!([b - a, c - b, a - c].iter().all(|side| side.norm() <= 0.3));
        }
        assert_eq!(divided(&mesh, 4.0), mesh);
    }
}
