//! Surfaces carried along by a similarity together with their parameter lines: ISO 10303-42 `surface_replica`.
//!
//! A mirror turns `du × dv` against the image of the normal. Planes can follow; a cylinder, cone, sphere or torus in a
//! right-handed frame cannot, and becomes the surface of revolution about the opposite axis that it is.

use super::to_nurbs::{meridian, straight};
use super::transform::NotRepresentable;
use super::{Curve, Surface, Trimmed};
use crate::math::{Affine, Frame, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Part of the distance from the axis within which a generatrix meets it.
const MEETS: f64 = 1e-9;

impl Surface {
    /// Exact image under a similarity whose normal `du × dv` is that of the image of the parameter lines.
    ///
    /// Under a mirror every parameter stays; else those of
    /// [`transformed`](Self::transformed), which grow with straight lines.
    ///
    /// # Errors
    /// See [`NotRepresentable`].
    pub fn replica(&self, map: &Affine) -> Result<Self, NotRepresentable> {
        if map.keeps_orientation() {
            return self.transformed(map);
        }
        let refused = NotRepresentable::Kind { kind: self.kind() };
        let factor = map.similarity_factor().ok_or(refused)?;
        match self {
            Self::Plane(frame) => {
                let (x, y) = (map.vector(&frame.x), map.vector(&frame.y));
                let origin = map.point(&frame.origin);
                if !map.is_rigid() {
                    let curve = Box::new(Curve::Line { origin, direction: x });
                    return Ok(Self::LinearExtrusion { curve, direction: y });
                }
                let image = Frame::from_axis(origin, x.cross(&y), Some(x));
                image.map(Self::Plane).ok_or(NotRepresentable::Degenerate { kind: self.kind() })
            }
            Self::Offset { basis, distance } => {
                Ok(Self::Offset { basis: Box::new(basis.replica(map)?), distance: -distance * factor })
            }
            Self::Trimmed { basis, u, v, forward } => {
                Ok(Self::Trimmed { basis: Box::new(basis.replica(map)?), u: *u, v: *v, forward: *forward })
            }
            Self::CurveBounded { basis } => Ok(Self::CurveBounded { basis: Box::new(basis.replica(map)?) }),
            Self::Composite(grid) => grid.try_map(|surface| surface.replica(map)).map(Self::Composite),
            _ => self.as_revolution().as_ref().unwrap_or(self).transformed(map),
        }
    }

    /// A cylinder, cone, sphere or torus as the revolution of its line of `u = 0`, with the same parameters.
    fn as_revolution(&self) -> Option<Self> {
        let (frame, profile) = match self {
            Self::Cylinder { frame, radius } => (frame, straight(frame, *radius, 0.0)),
            Self::Cone { frame, radius, semi_angle } => (frame, straight(frame, *radius, semi_angle.tan())),
            Self::Sphere { frame, radius } => {
                let basis = Box::new(meridian(frame, 0.0, *radius));
                (frame, Curve::Trimmed(Trimmed { basis, start: -FRAC_PI_2, end: FRAC_PI_2, forward: true }))
            }
            Self::Torus { frame, major_radius, minor_radius } => {
                (frame, meridian(frame, *major_radius, *minor_radius))
            }
            _ => return None,
        };
        Some(Self::Revolution { curve: Box::new(profile), frame: *frame })
    }

    /// Value of `v` at which the straight lines of a surface without an end meet in one point: the apex of a cone.
    #[must_use]
    pub fn apex(&self) -> Option<f64> {
        let (origin, direction) = match self {
            Self::Cone { radius, semi_angle, .. } => return Some(-radius / semi_angle.tan()),
            Self::Revolution { curve, frame } => match &**curve {
                Curve::Line { origin, direction } => {
                    let across = |v: Vector3<f64>| v - frame.z * frame.z.dot(&v);
                    (across(origin - frame.origin), across(*direction))
                }
                _ => return None,
            },
            _ => return None,
        };
        let v = -origin.dot(&direction) / direction.norm_squared();
        ((origin + direction * v).norm() <= MEETS * origin.norm()).then_some(v).filter(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Matrix3, Point3};

    fn tilted() -> Frame {
        let (z, x) = (Vector3::new(0.2, -0.3, 0.9), Vector3::new(1.0, 0.4, 0.0));
        Frame::from_axis(Point3::new(1.0, 2.0, 3.0), z, Some(x)).expect("a frame")
    }

    /// Twice the size, mirrored in a plane that is parallel to no axis, and moved.
    fn mirror(factor: f64) -> Affine {
        let n = Vector3::new(1.0, 2.0, -0.5).normalize();
        let linear = (Matrix3::identity() - n * n.transpose() * 2.0) * factor;
        Affine { linear, translation: Vector3::new(4.0, -1.0, 0.5) }
    }

    #[test]
    fn a_mirrored_surface_keeps_its_parameters_and_turns_its_normal_with_them() {
        let frame = tilted();
        let cylinder = Surface::Cylinder { frame, radius: 2.0 };
        let surfaces = [
            Surface::Plane(frame),
            cylinder.clone(),
            Surface::Cone { frame, radius: 1.5, semi_angle: 0.4 },
            Surface::Sphere { frame, radius: 3.0 },
            Surface::Torus { frame, major_radius: 3.0, minor_radius: 1.0 },
            Surface::Offset { basis: Box::new(cylinder.clone()), distance: 0.5 },
            Surface::Trimmed {
                basis: Box::new(cylinder),
                u: (0.0, 2.0),
                v: (-1.0, 1.0),
                forward: [false, true],
            },
        ];
        for map in [mirror(1.0), mirror(2.0)] {
            for surface in &surfaces {
                let image = surface.replica(&map).expect("a similarity");
                for (u, v) in [(0.3, 0.2), (-0.7, -0.4), (1.2, 0.9)] {
                    let away = (image.point(u, v) - map.point(&surface.point(u, v))).norm();
                    assert!(away < 1e-13, "{}: {away}", surface.kind());
                    let d = surface.derivatives(u, v);
                    let carried = map.vector(&d.du).cross(&map.vector(&d.dv)).normalize();
                    let turned = image.normal(u, v).expect("regular") - carried;
                    assert!(turned.norm() < 1e-12, "{}: {}", surface.kind(), turned.norm());
                }
            }
        }
    }

    #[test]
    fn an_apex_is_where_the_lines_meet() {
        let cone = Surface::Cone { frame: tilted(), radius: 1.5, semi_angle: 0.4 };
        let mirrored = cone.replica(&mirror(2.0)).expect("a similarity");
        for cone in [cone, mirrored] {
            let v = cone.apex().expect("a cone has one");
            assert!((cone.point(0.3, v) - cone.point(2.0, v)).norm() < 1e-12);
        }
        assert_eq!(Surface::Cylinder { frame: tilted(), radius: 2.0 }.apex(), None);
        let round = Surface::Cylinder { frame: tilted(), radius: 2.0 }.replica(&mirror(1.0)).expect("rigid");
        assert_eq!((round.kind(), round.apex()), ("revolution", None));
    }
}
