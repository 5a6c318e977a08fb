//! Rigid copies of curves and surfaces: kind, radii and angles stay bit for bit, only places and axes move.

use crate::geometry::{Curve, Surface};
use crate::math::{Affine, Frame};

/// A frame carried by a rigid motion; a motion without rotation leaves its axes as they are.
fn frame(frame: &Frame, motion: &Affine) -> Frame {
    let axis = |v| motion.linear * v;
    Frame { origin: motion.point(&frame.origin), x: axis(frame.x), y: axis(frame.y), z: axis(frame.z) }
}

/// The rigid copy of a curve; its parameters stay.
pub(super) fn moved_curve(curve: &Curve, motion: &Affine) -> Curve {
    match curve {
        Curve::Line { origin, direction } => {
            Curve::Line { origin: motion.point(origin), direction: motion.vector(direction) }
        }
        Curve::Circle { frame: f, radius } => Curve::Circle { frame: frame(f, motion), radius: *radius },
        Curve::Ellipse { frame: f, semi_axis_1, semi_axis_2 } => {
            Curve::Ellipse { frame: frame(f, motion), semi_axis_1: *semi_axis_1, semi_axis_2: *semi_axis_2 }
        }
        Curve::Nurbs(curve) => Curve::Nurbs(curve.transformed(motion)),
    }
}

/// The rigid copy of a surface; its parameters stay, and with them all curves in them.
pub(super) fn moved_surface(surface: &Surface, motion: &Affine) -> Surface {
    match surface {
        Surface::Plane(f) => Surface::Plane(frame(f, motion)),
        Surface::Cylinder { frame: f, radius } => {
            Surface::Cylinder { frame: frame(f, motion), radius: *radius }
        }
        Surface::Cone { frame: f, radius, semi_angle } => {
            Surface::Cone { frame: frame(f, motion), radius: *radius, semi_angle: *semi_angle }
        }
        Surface::Sphere { frame: f, radius } => Surface::Sphere { frame: frame(f, motion), radius: *radius },
        Surface::Torus { frame: f, major_radius, minor_radius } => Surface::Torus {
            frame: frame(f, motion),
            major_radius: *major_radius,
            minor_radius: *minor_radius,
        },
        Surface::LinearExtrusion { curve, direction } => Surface::LinearExtrusion {
            curve: Box::new(moved_curve(curve, motion)),
            direction: motion.vector(direction),
        },
        Surface::Revolution { curve, frame: f } => {
            Surface::Revolution { curve: Box::new(moved_curve(curve, motion)), frame: frame(f, motion) }
        }
        Surface::Nurbs(surface) => Surface::Nurbs(surface.transformed(motion)),
    }
}
