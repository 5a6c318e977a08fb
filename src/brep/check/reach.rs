//! How far faces reach in a direction, at most: bounds without a search.

use super::survey::Survey;
use crate::brep::FaceId;
use crate::geometry::{Curve, Surface};
use crate::math::{Frame, Point3, Vector3};

/// A bound on `direction · x` over a face, for a unit direction; infinite where none is known.
///
/// A plane reaches as far as its edges, other surfaces as far as their control points or closed forms say, which may
/// be further than the face does.
pub(super) fn reach(survey: &Survey<'_>, face: FaceId, direction: &Vector3<f64>) -> f64 {
    let brep = survey.brep;
    let edges = || brep.coedges_of(face).filter_map(|c| survey.edge(brep.coedges[c].edge));
    let points = || edges().flat_map(|edge| &edge.points).map(|at| at.point);
    let Some(surface) = brep.surface_of(face).read() else { return f64::INFINITY };
    if points().next().is_none() {
        return f64::INFINITY;
    }
    // A bound alone that runs round a cone may have the apex on its other side.
    let apex = surface.apex().filter(|_| brep.faces[face].loops.len() == 1);
    of_surface(surface, &points, apex, direction)
}

fn of_surface<P: Iterator<Item = Point3<f64>>>(
    surface: &Surface,
    points: &impl Fn() -> P,
    apex: Option<f64>,
    direction: &Vector3<f64>,
) -> f64 {
    // Least and greatest coordinate of the edges along an axis.
    let range = |origin: &Point3<f64>, axis: &Vector3<f64>| {
        let along = points().map(|p| (p - origin).dot(axis));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    // A circle about an axis, at a height above the origin.
    let circle = |frame: &Frame, z: f64, radius: f64| {
        let up = frame.z.dot(direction);
        frame.origin.coords.dot(direction) + z * up + radius.abs() * (1.0 - up * up).max(0.0).sqrt()
    };
    match surface {
        Surface::Plane(_) => range(&Point3::origin(), direction).1,
        // Straight lines end at edges, so that heights do not exceed these.
        Surface::Cylinder { frame, radius } => {
            let (low, high) = range(&frame.origin, &frame.z);
            circle(frame, low, *radius).max(circle(frame, high, *radius))
        }
        Surface::Cone { frame, radius, semi_angle } => {
            let (low, high) = range(&frame.origin, &frame.z);
            let ends = [low, high].into_iter().chain(apex);
            let reaches = ends.map(|z| circle(frame, z, radius + z * semi_angle.tan()));
            reaches.fold(f64::NEG_INFINITY, f64::max)
        }
        Surface::Sphere { frame, radius } => frame.origin.coords.dot(direction) + radius,
        Surface::Torus { frame, major_radius, minor_radius } => {
            circle(frame, 0.0, *major_radius) + minor_radius
        }
        Surface::Nurbs(nurbs) => furthest(nurbs.control_points(), direction),
        Surface::LinearExtrusion { curve, direction: line } => match &**curve {
            Curve::Nurbs(profile) => {
                let axis = line.normalize();
                let (low, high) = range(&Point3::origin(), &axis);
                let up = axis.dot(direction);
                (low * up).max(high * up) + furthest(profile.control_points(), &(direction - axis * up))
            }
            _ => f64::INFINITY,
        },
        Surface::Trimmed { basis, .. } | Surface::CurveBounded { basis } => {
            of_surface(basis, points, apex, direction)
        }
        Surface::Revolution { .. } | Surface::Offset { .. } | Surface::Composite(_) => f64::INFINITY,
    }
}

fn furthest(points: impl Iterator<Item = Point3<f64>>, direction: &Vector3<f64>) -> f64 {
    points.map(|p| p.coords.dot(direction)).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nurbs::{KnotVector, NurbsCurve3};

    fn frame() -> Frame {
        let (z, x) = (Vector3::new(0.3, -0.2, 0.9), Vector3::new(1.0, 0.5, 0.0));
        Frame::from_axis(Point3::new(3.0, -2.0, 1.0), z, Some(x)).expect("a frame")
    }

    #[test]
    fn no_point_of_a_patch_lies_beyond_its_reach() {
        let frame = frame();
        let knots = KnotVector::clamped_uniform(2, 1, 0.0, 1.0).expect("knots");
        let bow = [Point3::origin(), Point3::new(0.5, 1.0, 0.2), Point3::new(1.0, 0.0, 0.0)];
        let bow = NurbsCurve3::from_points(knots, &bow, None).expect("a curve");
        let surfaces = [
            Surface::Plane(frame),
            Surface::Cylinder { frame, radius: 2.0 },
            Surface::Cone { frame, radius: 2.0, semi_angle: 0.5 },
            Surface::Sphere { frame, radius: 2.0 },
            Surface::Torus { frame, major_radius: 3.0, minor_radius: 1.0 },
            Surface::LinearExtrusion {
                curve: Box::new(Curve::Nurbs(bow)),
                direction: Vector3::new(0.2, 0.1, 2.0),
            },
        ];
        let share = |i: usize| f64::from(u32::try_from(i).expect("small")) / 20.0;
        for surface in &surfaces {
            // The rectangle from 0 to 1 both ways, and its border.
            let at = |i: usize, j: usize| surface.point(share(i), share(j));
            let border = || (0..=20).flat_map(|i| [at(i, 0), at(i, 20), at(0, i), at(20, i)]);
            for direction in [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::new(1.0, 2.0, 2.0) / 3.0] {
                let bound = of_surface(surface, &border, None, &direction);
                let inner = (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))).map(|(i, j)| at(i, j));
                let furthest = furthest(inner, &direction);
                assert!(furthest <= bound + 1e-12, "{} {direction}: {furthest} {bound}", surface.kind());
            }
        }
    }

    #[test]
    fn a_whole_cylinder_reaches_as_far_as_its_closed_form_says() {
        let frame = frame();
        let cylinder = Surface::Cylinder { frame, radius: 2.0 };
        let ends = || [cylinder.point(0.0, 0.0), cylinder.point(0.0, 5.0)].into_iter();
        let bound = of_surface(&cylinder, &ends, None, &frame.x);
        assert!((bound - frame.origin.coords.dot(&frame.x) - 2.0).abs() < 1e-12);
        let up = of_surface(&cylinder, &ends, None, &frame.z);
        assert!((up - frame.origin.coords.dot(&frame.z) - 5.0).abs() < 1e-12);
    }
}
