//! Laws B1 to B10 of the specification: relations that need no stored result.

use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::{Affine, Matrix3, Point3, Vector3};
use resurf::ops::constrained_scale::measures::motion_deviation;
use resurf::ops::constrained_scale::{Continuity, HeldLoop, Hold, Scaled, Scaling, scale_face};

use super::parts::{contour, distance, ellipse, grid, held, hole, points, small, small_point, weighted_part};

const GROW: [f64; 3] = [1.1, 1.2, 1.25];
/// Extent of the part of these tests.
const SIZE: f64 = 400.0;

fn off_center() -> Vec<HeldLoop> {
    vec![hole(0, [0.55, 0.47], [0.1, 0.07], 0.3)]
}

fn scale(surface: &NurbsSurface, loops: &[HeldLoop], scaling: &Scaling) -> Scaled {
    scale_face(surface, loops, None, scaling).unwrap()
}

fn mean_curvature(surface: &NurbsSurface, at: [f64; 2]) -> f64 {
    let d = surface.derivatives(at[0], at[1]);
    let n = d.du.cross(&d.dv).normalize();
    let (e, f, g) = (d.du.norm_squared(), d.du.dot(&d.dv), d.dv.norm_squared());
    (e * d.dvv.dot(&n) - 2.0 * f * d.duv.dot(&n) + g * d.duu.dot(&n)) / (2.0 * (e * g - f * f))
}

#[test]
fn b1_held_loops_are_rigid_in_every_mode() {
    let surface = small();
    let holds = [
        Hold::Rigid,
        Hold::Translated,
        Hold::Pinned(None),
        Hold::Pinned(Some(Point3::new(230.0, 150.0, 70.0))),
        Hold::Axes([true, true, false]),
    ];
    for hold in holds {
        let mut loops = off_center();
        loops[0].hold = hold;
        let scaled = scale(&surface, &loops, &Scaling::new(GROW));
        let motion = &scaled.groups[0].motion;
        let off =
            motion_deviation(&surface, &scaled.faces[0].surface, &loops[0].contour.points, motion).relative;
        assert!(off <= 1e-12, "{hold:?}: {off:.3e}");
        assert_eq!(motion.is_rigid(), !matches!(hold, Hold::Axes(_)));
    }
}

#[test]
fn the_image_of_the_pivot_obeys_the_mode() {
    let mut loops = off_center();
    let at = Point3::new(230.0, 150.0, 70.0);
    loops[0].hold = Hold::Pinned(Some(at));
    let scaled = scale(&small(), &loops, &Scaling::new(GROW));
    let motion = &scaled.groups[0].motion;
    assert!((motion.apply(&motion.pivot) - at).norm() < 1e-12);
    loops[0].hold = Hold::Axes([true, false, true]);
    let scaled = scale(&small(), &loops, &Scaling::new(GROW));
    let linear = scaled.groups[0].motion.linear;
    assert_eq!(linear, Matrix3::from_diagonal(&Vector3::new(1.0, 1.2, 1.0)));
}

#[test]
fn b2_mean_curvature_along_held_loops_is_unchanged() {
    let (surface, loops) = (small(), off_center());
    let scaled = scale(&surface, &loops, &Scaling::new([2.0; 3]));
    for &at in &loops[0].contour.points {
        let (before, after) = (mean_curvature(&surface, at), mean_curvature(&scaled.faces[0].surface, at));
        assert!((after - before).abs() <= 1e-10 * before.abs());
    }
}

#[test]
fn b3_b4_borders_scale_plainly_with_their_tangent_planes() {
    for continuity in [Continuity::Position, Continuity::Tangent, Continuity::Curvature] {
        let scaling = Scaling { continuity, ..Scaling::new(GROW) };
        let plain = small().transformed(&scaling.affine().unwrap());
        let scaled = scale(&small(), &off_center(), &scaling);
        let new = &scaled.faces[0].surface;
        for k in 0..=40 {
            let t = f64::from(k) / 40.0;
            for (u, v) in [(t, 0.0), (t, 1.0), (0.0, t), (1.0, t)] {
                let (a, b) = (plain.derivatives(u, v), new.derivatives(u, v));
                assert!((a.point - b.point).norm() <= 1e-12 * SIZE);
                if continuity != Continuity::Position {
                    let (m, n) = (a.du.cross(&a.dv).normalize(), b.du.cross(&b.dv).normalize());
                    assert!((m - n).norm() <= 1e-12);
                }
                if continuity == Continuity::Curvature {
                    let (h, k) = (mean_curvature(&plain, [u, v]), mean_curvature(new, [u, v]));
                    assert!((h - k).abs() <= 1e-9 * h.abs());
                }
            }
        }
    }
}

#[test]
fn b3_an_outer_loop_scales_plainly() {
    let loops = [hole(0, [0.5, 0.5], [0.05, 0.05], 0.0)];
    let outer = ellipse([0.5, 0.5], [0.46, 0.46], 0.0, 96);
    let scaling = Scaling::new(GROW);
    let plain = small().transformed(&scaling.affine().unwrap());
    let scaled = scale_face(&small(), &loops, Some(contour(outer.clone())), &scaling).unwrap();
    for at in outer {
        let (a, b) = (plain.derivatives(at[0], at[1]), scaled.faces[0].surface.derivatives(at[0], at[1]));
        assert!((a.point - b.point).norm() <= 1e-12 * SIZE);
        let (m, n) = (a.du.cross(&a.dv).normalize(), b.du.cross(&b.dv).normalize());
        assert!((m - n).norm() <= 1e-12);
    }
}

#[test]
fn b5_factors_of_one_change_nothing() {
    let scaled = scale(&small(), &off_center(), &Scaling::new([1.0; 3]));
    assert_eq!(scaled.faces[0].surface, small());
    // Close to one, the solve itself must give the input.
    let nearly = scale(&small(), &off_center(), &Scaling::new([1.0 + 1e-14, 1.0, 1.0]));
    let off = distance(&grid(&nearly.faces[0].surface, 21), &grid(&small(), 21));
    assert!(off <= 1e-11 * SIZE, "{off:.3e}");
}

#[test]
fn b6_parametrisation_does_not_matter() {
    let scaling = Scaling::new(GROW);
    let expected = grid(&scale(&small(), &off_center(), &scaling).faces[0].surface, 21);
    let loop_by = |f: &dyn Fn([f64; 2]) -> [f64; 2]| {
        vec![held(0, off_center()[0].contour.points.iter().map(|&p| f(p)).collect())]
    };
    let reversed = scale(&small().reversed_u(), &loop_by(&|p| [1.0 - p[0], p[1]]), &scaling);
    let mut back: Vec<Point3<f64>> = grid(&reversed.faces[0].surface, 21);
    let rows: Vec<Vec<Point3<f64>>> = back.chunks(21).map(<[_]>::to_vec).collect();
    back = rows.into_iter().rev().flatten().collect();
    assert!(distance(&back, &expected) <= 1e-9 * SIZE);
    let swapped = scale(&small().swapped(), &loop_by(&|p| [p[1], p[0]]), &scaling);
    let found = grid(&swapped.faces[0].surface, 21);
    let found: Vec<_> = (0..441).map(|k| found[k % 21 * 21 + k / 21]).collect();
    assert!(distance(&found, &expected) <= 1e-9 * SIZE);
    let stretched = with_knots(&small(), |u| 50.0 * u - 7.0, |v| 0.03 * v);
    let loops = loop_by(&|p| [50.0 * p[0] - 7.0, 0.03 * p[1]]);
    let found = grid(&scale(&stretched, &loops, &scaling).faces[0].surface, 21);
    assert!(distance(&found, &expected) <= 1e-9 * SIZE);
}

fn with_knots(surface: &NurbsSurface, f: impl Fn(f64) -> f64, g: impl Fn(f64) -> f64) -> NurbsSurface {
    use resurf::geometry::nurbs::KnotVector;
    let u = surface.knots_u().knots().iter().map(|&x| f(x)).collect();
    let v = surface.knots_v().knots().iter().map(|&x| g(x)).collect();
    let u = KnotVector::new(surface.knots_u().degree(), u).unwrap();
    let v = KnotVector::new(surface.knots_v().degree(), v).unwrap();
    NurbsSurface::new(u, v, surface.net().to_vec()).unwrap()
}

#[test]
fn b7_a_common_factor_of_all_weights_does_not_matter() {
    let weighted = |factor: f64| {
        weighted_part([3, 3], [6, 6], small_point, |x, y| {
            factor * (1.0 + 0.2 * (3.0 * x).sin() * (2.0 * y).cos())
        })
    };
    let scaling = Scaling::new(GROW);
    let a = scale(&weighted(1.0), &off_center(), &scaling);
    let b = scale(&weighted(2.5), &off_center(), &scaling);
    let off = distance(&points(&a.faces[0].surface), &points(&b.faces[0].surface));
    assert!(off <= 1e-9 * SIZE, "{off:.3e}");
}

#[test]
fn b8_part_and_centre_moved_together_move_the_result() {
    let by = Vector3::new(1000.0, -2000.0, 3000.0);
    let moved = small().transformed(&Affine::translation(by));
    let scaling = Scaling::new(GROW);
    let a = scale(&small(), &off_center(), &scaling);
    let b = scale(&moved, &off_center(), &Scaling { center: Point3::from(by), ..scaling });
    let back: Vec<_> = points(&b.faces[0].surface).iter().map(|p| p - by).collect();
    assert!(distance(&points(&a.faces[0].surface), &back) <= 1e-9 * SIZE);
}

#[test]
fn turning_part_and_axes_together_turns_the_result() {
    let (c, s) = (0.8_f64, 0.6_f64);
    let turn = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let map = Affine { linear: turn, translation: Vector3::zeros() };
    let scaling = Scaling::new(GROW);
    let a = scale(&small(), &off_center(), &scaling);
    let b = scale(&small().transformed(&map), &off_center(), &Scaling { axes: turn, ..scaling });
    let expected: Vec<_> = points(&a.faces[0].surface).iter().map(|p| map.point(p)).collect();
    assert!(distance(&points(&b.faces[0].surface), &expected) <= 1e-9 * SIZE);
}

#[test]
fn b9_the_solution_is_stationary() {
    for factors in [GROW, [2.0; 3]] {
        let scaled = scale(&small(), &off_center(), &Scaling::new(factors));
        assert!(scaled.residual <= 1e-11, "{:.3e}", scaled.residual);
        assert!(scaled.residual > 0.0, "a residual of exactly zero was not computed");
    }
}

#[test]
fn b10_two_faces_with_a_common_border_stay_together() {
    // The right half of a panel twice as long has other knots across, the same along the border.
    let half = |x0: f64, spans: usize| {
        super::parts::part([3, 3], [spans, 6], move |x, y| small_point(x0 + 0.5 * x, y))
    };
    let (left, right) = (half(0.0, 6), half(0.5, 9));
    let gap = |a: &NurbsSurface, b: &NurbsSurface| {
        (0..=50)
            .map(|k| f64::from(k) / 50.0)
            .map(|t| (a.point(1.0, t) - b.point(0.0, t)).norm())
            .fold(0.0, f64::max)
    };
    assert!(gap(&left, &right) <= 1e-12 * SIZE);
    let scaling = Scaling::new(GROW);
    let a = scale(&left, &[hole(0, [0.5, 0.5], [0.1, 0.07], 0.0)], &scaling);
    let b = scale(&right, &[hole(0, [0.4, 0.6], [0.08, 0.06], 0.0)], &scaling);
    assert!(gap(&a.faces[0].surface, &b.faces[0].surface) <= 1e-12 * SIZE);
}

#[test]
fn near_holes_are_merged_into_one_motion() {
    let loops = [hole(0, [0.45, 0.5], [0.045, 0.06], 0.0), hole(1, [0.55, 0.5], [0.045, 0.06], 0.0)];
    let scaling = Scaling { max_control_points: 3000, ..Scaling::new(GROW) };
    let scaled = scale(&small(), &loops, &scaling);
    assert_eq!(scaled.groups.len(), 1);
    assert!(scaled.groups[0].merged);
    assert_eq!(scaled.groups[0].loops, [(0, 0), (0, 1)]);
    let motion = &scaled.groups[0].motion;
    for held in &loops {
        let points = &held.contour.points;
        assert!(motion_deviation(&small(), &scaled.faces[0].surface, points, motion).relative <= 1e-12);
    }
}

#[test]
fn without_held_loops_the_face_scales_plainly() {
    let scaling = Scaling::new(GROW);
    let scaled = scale(&small(), &[], &scaling);
    assert_eq!(scaled.faces[0].surface, small().transformed(&scaling.affine().unwrap()));
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let run = || scale(&small(), &off_center(), &Scaling::new(GROW)).faces[0].surface.clone();
    assert_eq!(run(), run());
}

#[test]
fn uneven_knots_get_room_where_bisection_of_all_spans_would_not_fit() {
    use resurf::geometry::nurbs::KnotVector;
    // Thirty short spans at one end, three long ones for the rest: bisection wastes itself on the short ones.
    let mut knots = vec![0.0; 4];
    knots.extend((1..=30).map(|k| f64::from(k) / 300.0));
    knots.extend([0.4, 0.7, 1.0, 1.0, 1.0, 1.0]);
    let u = KnotVector::new(3, knots).unwrap();
    let v = KnotVector::clamped_uniform(3, 3, 0.0, 1.0).unwrap();
    let mut net = Vec::new();
    for x in u.greville() {
        for y in v.greville() {
            let p = small_point(x, y);
            net.push([p[0], p[1], p[2], 1.0]);
        }
    }
    let surface = NurbsSurface::new(u, v, net).unwrap();
    let loops = [hole(0, [0.8, 0.5], [0.05, 0.1], 0.0)];
    let scaling = Scaling { max_control_points: 5000, ..Scaling::new(GROW) };
    let scaled = scale(&surface, &loops, &scaling);
    let face = &scaled.faces[0];
    assert!(face.surface.net().len() <= 5000);
    let held = &loops[0].contour.points;
    assert!(motion_deviation(&surface, &face.surface, held, &scaled.groups[0].motion).relative <= 1e-12);
}
