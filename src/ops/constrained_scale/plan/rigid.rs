//! Rigid copies of curves and surfaces: kind, radii and angles stay bit for bit, only places and axes move.

use crate::geometry::{Curve, Surface, Trimmed};
use crate::math::{Affine, Frame};
use std::convert::Infallible;

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
        Curve::Polyline(curve) => Curve::Polyline(curve.transformed(motion)),
        Curve::Parabola { frame: f, focal_distance } => {
            Curve::Parabola { frame: frame(f, motion), focal_distance: *focal_distance }
        }
        Curve::Hyperbola { frame: f, semi_axis, semi_imaginary_axis } => Curve::Hyperbola {
            frame: frame(f, motion),
            semi_axis: *semi_axis,
            semi_imaginary_axis: *semi_imaginary_axis,
        },
        Curve::Trimmed(piece) => {
            let basis = Box::new(moved_curve(&piece.basis, motion));
            Curve::Trimmed(Trimmed { basis, ..piece.clone() })
        }
        Curve::Composite(whole) => {
            let moved = whole.try_map(|curve| Ok::<_, Infallible>(moved_curve(curve, motion)));
            Curve::Composite(moved.unwrap_or_else(|never| match never {}))
        }
        Curve::Offset { basis, distance, direction } => Curve::Offset {
            basis: Box::new(moved_curve(basis, motion)),
            distance: *distance,
            direction: motion.vector(direction),
        },
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
        Surface::Offset { basis, distance } => {
            Surface::Offset { basis: Box::new(moved_surface(basis, motion)), distance: *distance }
        }
        Surface::Trimmed { basis, u, v, forward } => Surface::Trimmed {
            basis: Box::new(moved_surface(basis, motion)),
            u: *u,
            v: *v,
            forward: *forward,
        },
        Surface::CurveBounded { basis } => {
            Surface::CurveBounded { basis: Box::new(moved_surface(basis, motion)) }
        }
        Surface::Composite(grid) => {
            let moved = grid.try_map(|surface| Ok::<_, Infallible>(moved_surface(surface, motion)));
            Surface::Composite(moved.unwrap_or_else(|never| match never {}))
        }
    }
}
