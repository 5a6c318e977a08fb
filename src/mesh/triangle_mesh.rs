//! The container: vertices, triangles, the face of each triangle, normals at the corners.

use crate::brep::FaceId;
use crate::math::{Affine, Point3, Vector3};

/// Triangles over shared vertices, in file units.
///
/// Corners run counter-clockwise seen from outside. Two triangles that meet along an edge name the same two
/// vertices, so closedness is a question of indices and needs no tolerance. `faces` and `normals` are
/// either empty or as long as `triangles`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Positions.
    pub vertices: Vec<Point3<f64>>,
    /// Corners of each triangle: indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// B-rep face of each triangle; empty for a mesh that was read.
    pub faces: Vec<FaceId>,
    /// Unit normals of the face's surface at the corners, pointing outside; empty for a mesh that was read.
    pub normals: Vec<[Vector3<f64>; 3]>,
}

/// An axis-parallel box, in file units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Extents {
    /// Least coordinates.
    pub min: [f64; 3],
    /// Greatest coordinates.
    pub max: [f64; 3],
}

impl Extents {
    /// The least box around points; `None` without a point.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let start = Self { min: [first.x, first.y, first.z], max: [first.x, first.y, first.z] };
        Some(points.fold(start, |mut extents, point| {
            for axis in 0..3 {
                extents.min[axis] = extents.min[axis].min(point[axis]);
                extents.max[axis] = extents.max[axis].max(point[axis]);
            }
            extents
        }))
    }

    /// Length of the diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (Point3::from(self.max) - Point3::from(self.min)).norm()
    }

    /// Centre of the box.
    #[must_use]
    pub fn center(&self) -> Point3<f64> {
        Point3::from(std::array::from_fn(|axis| 0.5 * (self.min[axis] + self.max[axis])))
    }
}

impl Mesh {
    /// Corner positions of each triangle, in order.
    pub fn corners(&self) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
        self.triangles.iter().map(|corners| corners.map(|at| self.vertices[at as usize]))
    }

    /// The image under a similarity; a mirror turns the triangles over, so that they face outside again.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let keeps = map.keeps_orientation();
        let turned = |corners: &[u32; 3]| if keeps { *corners } else { [corners[0], corners[2], corners[1]] };
        let normals = self.normals.iter().map(|normals| {
            let [a, b, c] = normals.map(|n| map.vector(&n).try_normalize(0.0).unwrap_or(n));
            if keeps { [a, b, c] } else { [a, c, b] }
        });
        Self {
            vertices: self.vertices.iter().map(|p| map.point(p)).collect(),
            triangles: self.triangles.iter().map(turned).collect(),
            faces: self.faces.clone(),
            normals: normals.collect(),
        }
    }

    /// Puts another mesh beside this one. Faces and normals go with it when both have them.
    pub fn append(&mut self, other: &Self) {
        // Indices of 32 bits are what every mesh format has; tessellation stops long before.
        let first = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        self.faces.extend_from_slice(&other.faces);
        self.normals.extend_from_slice(&other.normals);
    }

    /// Box around all vertices; `None` for a mesh without one.
    #[must_use]
    pub fn extents(&self) -> Option<Extents> {
        Extents::around(&self.vertices)
    }

    /// Sum of the triangles' areas, in square file units.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.corners().map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
    }

    /// Volume by the divergence theorem, in cubic file units: positive for a closed mesh whose triangles
    /// face outside. Measured from the box's centre, so a part far from the origin loses no digits; the
    /// figure means nothing for an open mesh.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let Some(extents) = self.extents() else { return 0.0 };
        let center = extents.center();
        let spat = |[a, b, c]: [Point3<f64>; 3]| (a - center).dot(&(b - center).cross(&(c - center)));
        self.corners().map(spat).sum::<f64>() / 6.0
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The unit cube, two triangles a side, corners outside-in by the right-hand rule.
    pub(crate) fn cube(at: [f64; 3]) -> Mesh {
        let vertices = (0..8u32)
            .map(|k| Point3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)))
            .map(|p| p + Vector3::from(at))
            .collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { vertices, triangles, ..Mesh::default() }
    }

    #[test]
    fn a_cube_has_its_volume_wherever_it_lies() {
        for at in [[0.0; 3], [-3.0, 5.0, 0.5], [1e6, 0.0, -1e6]] {
            let mesh = cube(at);
            assert!((mesh.signed_volume() - 1.0).abs() < 1e-9);
            assert!((mesh.area() - 6.0).abs() < 1e-9);
            let extents = mesh.extents().expect("eight vertices");
            assert_eq!(extents.min, at);
            assert!((extents.diagonal() - 3f64.sqrt()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_mirrored_cube_faces_outside() {
        let mirror = Affine {
            linear: crate::math::Matrix3::from_diagonal(&Vector3::new(-2.0, 2.0, 2.0)),
            translation: Vector3::x(),
        };
        assert!((cube([0.0; 3]).transformed(&mirror).signed_volume() - 8.0).abs() < 1e-12);
    }

    #[test]
    fn an_empty_mesh_has_no_extents_and_no_volume() {
        assert_eq!(Mesh::default().extents(), None);
        assert_eq!(Mesh::default().signed_volume().to_bits(), 0f64.to_bits());
    }
}
