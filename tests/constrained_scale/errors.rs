//! Every bad input has its error, and none panics.

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::math::Matrix3;
use resurf::ops::constrained_scale::{HeldLoop, ScaleError, Scaling, scale_face};

use super::parts::{contour, door, ellipse, held, hole, part, small};

fn error(loops: &[HeldLoop], scaling: &Scaling) -> ScaleError {
    scale_face(&small(), loops, None, scaling).map(|_| ()).unwrap_err()
}

fn middle() -> Vec<HeldLoop> {
    vec![hole(0, [0.5, 0.5], [0.09, 0.09], 0.0)]
}

#[test]
fn factors_that_are_not_positive_numbers() {
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = error(&middle(), &Scaling::new([1.1, factor, 1.2]));
        assert_eq!(found.code(), "scale.bad-scale");
    }
}

#[test]
fn axes_and_centre_are_checked() {
    let skew = Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let mut scaling = Scaling::new([1.1, 1.2, 1.25]);
    scaling.axes = skew;
    assert_eq!(error(&middle(), &scaling).code(), "scale.bad-scale");
    scaling.axes = Matrix3::from_element(f64::NAN);
    assert_eq!(error(&middle(), &scaling).code(), "scale.bad-scale");
    scaling.axes = Matrix3::identity();
    scaling.center.x = f64::INFINITY;
    assert_eq!(error(&middle(), &scaling).code(), "scale.bad-scale");
}

#[test]
fn loops_that_are_no_loops() {
    let scaling = Scaling::new([1.1, 1.2, 1.25]);
    let bow = vec![[0.4, 0.4], [0.6, 0.6], [0.6, 0.4], [0.4, 0.6]];
    assert_eq!(error(&[held(0, bow)], &scaling).code(), "scale.loop-self-intersects");
    let outside = ellipse([0.95, 0.5], [0.1, 0.1], 0.0, 48);
    assert_eq!(error(&[held(0, outside)], &scaling).code(), "scale.loop-outside-domain");
    for points in [vec![], vec![[0.5, 0.5]], vec![[0.5, 0.5]; 9], vec![[0.4, 0.5], [0.6, 0.5], [0.5, 0.5]]] {
        assert_eq!(error(&[held(0, points)], &scaling).code(), "scale.loop-degenerate");
    }
    let holes = [f64::NAN, f64::INFINITY].map(|bad| held(0, vec![[0.4, 0.4], [0.6, bad], [0.5, 0.6]]));
    for hole in holes {
        assert_eq!(error(&[hole], &scaling).code(), "scale.non-finite-input");
    }
}

#[test]
fn loops_that_cross_or_contain_each_other() {
    let scaling = Scaling::new([1.1, 1.2, 1.25]);
    let inner = hole(1, [0.5, 0.5], [0.03, 0.03], 0.0);
    let across = hole(1, [0.58, 0.5], [0.05, 0.05], 0.0);
    for other in [inner, across] {
        let loops = [middle().remove(0), other];
        let found = error(&loops, &scaling);
        assert_eq!(found, ScaleError::HeldLoopsOverlap { face: "1".to_owned(), first: 0, second: 1 });
    }
}

#[test]
fn a_loop_near_the_border_runs_into_the_limit() {
    let loops = [hole(0, [0.5, 0.06], [0.05, 0.05], 0.0)];
    let scaling = Scaling { max_control_points: 3000, ..Scaling::new([1.1, 1.2, 1.25]) };
    assert_eq!(error(&loops, &scaling).code(), "scale.feature-too-close-to-boundary");
}

#[test]
fn a_loop_round_the_whole_face_leaves_nothing() {
    let loops = [held(0, vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])];
    let scaling = Scaling { max_control_points: 3000, ..Scaling::new([1.1, 1.2, 1.25]) };
    assert_eq!(error(&loops, &scaling).code(), "scale.hold-covers-face");
}

#[test]
fn a_net_over_the_limit() {
    let scaling = Scaling { max_control_points: 80, ..Scaling::new([1.1, 1.2, 1.25]) };
    let expected = ScaleError::NetTooLarge { face: "1".to_owned(), points: 81, limit: 80 };
    assert_eq!(error(&middle(), &scaling), expected);
}

#[test]
fn shrinking_folds_and_says_where() {
    let (surface, loops) = door();
    let scaling = Scaling { max_control_points: 3000, ..Scaling::new([0.5; 3]) };
    let found = scale_face(&surface, &loops, None, &scaling).map(|_| ()).unwrap_err();
    let ScaleError::FoldOver { ratio, .. } = found else { panic!("{found}") };
    assert!(ratio <= 0.02);
}

#[test]
fn a_torn_surface_is_refused() {
    let knots = vec![0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
    let u = KnotVector::new(2, knots).unwrap();
    let v = KnotVector::clamped_uniform(2, 1, 0.0, 1.0).unwrap();
    let net = (0..18).map(|k| [f64::from(k / 3), f64::from(k % 3), 0.0, 1.0]).collect();
    let surface = NurbsSurface::new(u, v, net).unwrap();
    let loops = [hole(0, [0.5, 0.5], [0.09, 0.09], 0.0)];
    let found = scale_face(&surface, &loops, None, &Scaling::new([2.0; 3])).map(|_| ()).unwrap_err();
    assert_eq!(found.code(), "scale.bad-knots");
}

#[test]
fn a_surface_collapsed_to_a_point_is_refused() {
    let surface = part([3, 3], [6, 6], |_, _| [1.0, 2.0, 3.0]);
    let found = scale_face(&surface, &middle(), None, &Scaling::new([2.0; 3])).map(|_| ()).unwrap_err();
    assert_eq!(found.code(), "scale.loop-degenerate");
}

#[test]
fn an_outer_loop_is_checked_like_the_others() {
    let bow = contour(vec![[0.1, 0.1], [0.9, 0.9], [0.9, 0.1], [0.1, 0.9]]);
    let found = scale_face(&small(), &middle(), Some(bow), &Scaling::new([2.0; 3])).map(|_| ()).unwrap_err();
    assert_eq!(found.code(), "scale.loop-self-intersects");
}
