//! Input surfaces and contours, all given by formulas (specification, section 7).

use std::f64::consts::PI;

pub use crate::nets::{part, weighted_part};
use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::{Affine, Matrix3, Point3, Vector3};
use resurf::ops::feature_paste::{Feature, Ground, PasteError, Pasted, Settings, paste};

pub fn circle(radius: f64) -> Vec<[f64; 2]> {
    let vertex = |k: u32| {
        let t = 2.0 * PI * f64::from(k) / 64.0;
        [0.5 + radius * t.cos(), 0.5 + radius * t.sin()]
    };
    (0..64).map(vertex).collect()
}

/// An asymmetric bump on a plane of 4 by 4.
pub fn bump(x: f64, y: f64) -> [f64; 3] {
    let (r, r2) = ((x - 0.5).hypot(y - 0.5), (x - 0.56).hypot(y - 0.46));
    let main = if r < 0.2 { 0.6 * (PI * (r / 0.2).min(1.0) / 2.0).cos().powi(2) } else { 0.0 };
    let side = if r2 < 0.13 { 0.25 * (-r2 * r2 / 0.002).exp() } else { 0.0 };
    [4.0 * x, 4.0 * y, main + side]
}

pub fn source() -> NurbsSurface {
    part([3, 3], [12, 12], bump)
}

pub fn weighted_source() -> NurbsSurface {
    weighted_part([3, 3], [12, 12], bump, |x, y| {
        let r = (x - 0.5).hypot(y - 0.5);
        if r < 0.25 { 1.0 + 0.4 * (-r * r / 0.004).exp() } else { 1.0 }
    })
}

/// A part of a cylinder of radius 6.
pub fn cylinder() -> NurbsSurface {
    part([3, 3], [8, 7], |x, y| {
        let angle = 1.6 * (x - 0.5);
        [6.0 * angle.sin(), 10.0 * (y - 0.5), 6.0 * angle.cos() - 6.0]
    })
}

pub fn motion() -> Affine {
    let axis = Vector3::new(0.3, -0.8, 0.5);
    let turn = resurf::math::minimal_rotation(&Vector3::x(), &axis, &Vector3::y());
    Affine { linear: turn, translation: Vector3::new(10.0, -4.0, 7.0) }
}

/// A plane of 9 by 9, moved rigidly.
pub fn moved_plane(degree: [usize; 2]) -> NurbsSurface {
    part(degree, [9, 9], |x, y| [9.0 * x, 9.0 * y, 0.0]).transformed(&motion())
}

/// Pastes between the middles of two surfaces.
pub fn pasted(
    source: &NurbsSurface,
    target: &NurbsSurface,
    radius: f64,
    settings: &Settings,
) -> Result<Pasted, PasteError> {
    let contour = circle(radius);
    let feature = Feature { source, contour: &contour, anchor: [0.5, 0.5] };
    paste(&feature, &Ground { target, at: [0.5, 0.5] }, settings)
}

/// Greatest distance of the result from the source placed by a rigid motion on a plane of 9 by 9, over the source.
///
/// `turn` maps plane coordinates about the anchor of the source to those about the anchor of the target.
pub fn placed_error(result: &Pasted, source: &NurbsSurface, turn: &Matrix3<f64>) -> f64 {
    let (centre, shift) = (Point3::new(2.0, 2.0, 0.0), Vector3::new(4.5, 4.5, 0.0));
    let motion = motion();
    let mut worst = 0.0_f64;
    // Steps that fall on no knot of either surface but the ends.
    for i in 0..=151 {
        for j in 0..=151 {
            let x = [f64::from(i) / 151.0, f64::from(j) / 151.0];
            let ideal = motion.point(&Point3::from(turn * (source.point(x[0], x[1]) - centre) + shift));
            let at = result.map.apply(x);
            let inside = at.iter().all(|c| (0.0..=1.0).contains(c));
            if inside {
                worst = worst.max((result.surface.point(at[0], at[1]) - ideal).norm());
            }
        }
    }
    worst
}

/// Euclidean control points.
pub fn points(surface: &NurbsSurface) -> Vec<Point3<f64>> {
    surface.control_points().collect()
}

/// Greatest distance of two lists of points.
pub fn distance(a: &[Point3<f64>], b: &[Point3<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}
