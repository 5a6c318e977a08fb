//! Two skins and one motion: the coupled solve of a hole through a thin panel.

use resurf::geometry::nurbs::NurbsSurface;
use resurf::ops::constrained_scale::measures::motion_deviation;
use resurf::ops::constrained_scale::{FaceTask, HeldLoop, Scaled, Scaling, scale_face, scale_faces};

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
