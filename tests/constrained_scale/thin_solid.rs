//! Two skins and one motion: the coupled solve of a hole through a thin panel.

use std::f64::consts::PI;

use resurf::geometry::nurbs::NurbsSurface;
use resurf::ops::constrained_scale::measures::motion_deviation;
use resurf::ops::constrained_scale::{
    FaceTask, HeldLoop, ScaleError, Scaled, Scaling, scale_face, scale_faces,
};

use super::parts::{hole, part, small, small_point};

/// The panel's other skin: below and flatter, turned over so that its normal points away.
fn below() -> NurbsSurface {
    let offset = part([3, 3], [6, 6], |x, y| {
        let p = small_point(x, y);
        [p[0], p[1], 0.7 * p[2] - 3.0]
    });
    offset.reversed_u()
}

fn task(surface: &NurbsSurface, held: Vec<HeldLoop>) -> FaceTask<'_> {
    FaceTask { name: "skin".to_owned(), surface, held, outer: None, scaled: Vec::new() }
}

fn skins(factors: [f64; 3]) -> Scaled {
    let (top, bottom) = (small(), below());
    let holes = |mirror: bool| {
        let u = |x: f64| if mirror { 1.0 - x } else { x };
        vec![hole(0, [u(0.3), 0.5], [0.06, 0.08], 0.0), hole(1, [u(0.7), 0.5], [0.06, 0.08], 0.0)]
    };
    scale_faces(&[task(&top, holes(false)), task(&bottom, holes(true))], &Scaling::new(factors)).unwrap()
}

#[test]
fn both_ends_of_a_hole_move_by_one_motion() {
    let scaled = skins([1.1, 1.2, 1.25]);
    assert_eq!(scaled.groups.len(), 2);
    for (k, group) in scaled.groups.iter().enumerate() {
        assert_eq!(group.loops, [(0, k), (1, k)]);
        assert!(!group.merged);
        let u = [0.3, 0.7][k];
        for (face, surface, u) in [(0, small(), u), (1, below(), 1.0 - u)] {
            let points = hole(k, [u, 0.5], [0.06, 0.08], 0.0).contour.points;
            let off =
                motion_deviation(&surface, &scaled.faces[face].surface, &points, &group.motion).relative;
            assert!(off <= 1e-12, "{off:.3e}");
        }
    }
    assert!(scaled.residual <= 1e-11);
}

#[test]
fn the_common_amount_lies_between_those_of_the_skins_alone() {
    let factors = [2.0; 3];
    let together = skins(factors);
    let alone = |surface: &NurbsSurface, at: f64| {
        let scaled = scale_face(
            surface,
            &[hole(0, [at, 0.5], [0.06, 0.08], 0.0), hole(1, [1.0 - at, 0.5], [0.06, 0.08], 0.0)],
            None,
            &Scaling::new(factors),
        )
        .unwrap();
        let motion = scaled.groups[0].motion.clone();
        // As a displacement of the pivot in space, so that the side of the axis does not matter.
        motion.target + motion.shift() - 2.0 * motion.pivot.coords
    };
    let (top, bottom) = (alone(&small(), 0.3).z, alone(&below(), 0.7).z);
    let motion = &together.groups[0].motion;
    let both = (motion.target + motion.shift() - 2.0 * motion.pivot.coords).z;
    let (low, high) = (top.min(bottom), top.max(bottom));
    let room = 0.02 * (high - low).abs() + 1e-6;
    assert!(both >= low - room && both <= high + room, "{low} {both} {high}");
}

#[test]
fn faces_of_one_group_get_one_level() {
    // The lower skin's hole is nearer to its border, so that it alone needs more levels.
    let (top, bottom) = (small(), below());
    let tasks = [
        task(&top, vec![hole(0, [0.5, 0.5], [0.06, 0.08], 0.0)]),
        task(&bottom, vec![hole(0, [0.5, 0.5], [0.06, 0.08], 0.0), hole(1, [0.5, 0.22], [0.05, 0.05], 0.0)]),
    ];
    let scaled = scale_faces(&tasks, &Scaling::new([1.1, 1.2, 1.25])).unwrap();
    let lower = scale_faces(&tasks[1..], &Scaling::new([1.1, 1.2, 1.25])).unwrap();
    let upper = scale_faces(&tasks[..1], &Scaling::new([1.1, 1.2, 1.25])).unwrap();
    assert!(lower.faces[0].level > upper.faces[0].level, "the test needs faces of different levels");
    assert_eq!(scaled.faces[0].level, scaled.faces[1].level);
}

/// The door of the specification as two skins of 3 mm, with two holes through both (its part on solids, section 3).
fn door_skins(factors: [f64; 3]) -> Result<Scaled, ScaleError> {
    let shape = |x: f64, y: f64| {
        let bend = 30.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 70.0 * (PI * y).sin();
        [1000.0 * x, 700.0 * y, bend + 10.0 * (8.0 * (y - 0.55)).tanh()]
    };
    let top = part([3, 3], [6, 6], shape);
    let bottom = part([3, 3], [6, 6], |x, y| {
        let p = shape(x, y);
        [p[0], p[1], p[2] - 3.0]
    });
    let holes = || {
        vec![
            hole(0, [0.72, 430.0 / 700.0], [0.06, 0.06 / 0.7], 0.0),
            hole(1, [0.25, 0.7], [0.04, 0.04 / 0.7], 0.0),
        ]
    };
    let of =
        |surface| FaceTask { name: "door".to_owned(), surface, held: holes(), outer: None, scaled: vec![] };
    scale_faces(&[of(&top), of(&bottom)], &Scaling::new(factors))
}

#[test]
fn the_door_stays_as_thick_as_the_specification_says() {
    // Input 2.848 to 3.000, plain and held at both scales; the specification samples more densely.
    for (factors, plain, held, mean) in [
        ([1.1, 1.2, 1.25], [3.541, 3.750], [2.919, 3.719], 3.317),
        ([2.0; 3], [5.696, 6.000], [2.923, 5.958], 4.506),
    ] {
        let scaled = door_skins(factors).unwrap();
        let [pair] = scaled.skins[..] else { panic!("{:?}", scaled.skins) };
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() <= 0.03 * expected, "{pair:?}");
        close(pair.before.least, 2.848);
        close(pair.before.greatest, 3.000);
        close(pair.plain.least, plain[0]);
        close(pair.plain.greatest, plain[1]);
        close(pair.after.least, held[0]);
        close(pair.after.greatest, held[1]);
        close(pair.after.mean, mean);
        assert!(pair.least_ratio > 0.9, "{pair:?}");
    }
}

#[test]
fn skins_that_would_meet_are_refused() {
    // A sheet of 0.02 whose skins have different knots: they deviate from the plain scaling by more than that, and not alike.
    let top = small();
    let bottom = part([3, 3], [9, 5], |x, y| {
        let p = small_point(x, y);
        [p[0], p[1], p[2] - 0.02]
    });
    let held = || vec![hole(0, [0.3, 0.5], [0.06, 0.08], 0.0)];
    let of = |surface, name: &str| FaceTask {
        name: name.to_owned(),
        surface,
        held: held(),
        outer: None,
        scaled: Vec::new(),
    };
    let found = scale_faces(&[of(&top, "top"), of(&bottom, "bottom")], &Scaling::new([2.0; 3]));
    match found {
        Err(ScaleError::SkinsTooClose { faces, ratio, .. }) => {
            assert_eq!(faces, ["top", "bottom"]);
            assert!(ratio < 0.8);
        }
        other => panic!("{:?}", other.map(|scaled| scaled.skins)),
    }
}
