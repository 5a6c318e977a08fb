//! Transfers between splines against their vectors, and their laws.

use proptest::prelude::*;
use resurf::geometry::bspline_wavelet::decompose;
use resurf::geometry::nurbs::KnotVector;
use resurf::math::{Matrix3, Vector3};
use resurf::ops::detail_transfer::{
    Existing, Frame, LevelChoice, Scale, Settings, Spline, TargetBase, TransferError, transfer,
};
use serde_json::Value;

use crate::{difference, knots, list, numbers, rows, vector, whole};

fn spline(value: &Value) -> Spline {
    Spline { knots: knots(value, "knots", whole(value, "degree")), points: rows(&value["controls"]) }
}

fn global(ends: usize) -> Settings {
    Settings { frame: Frame::Global, scale: Scale::Factor(1.0), ends, ..Settings::default() }
}

#[test]
fn global_transfers_are_those_of_the_vectors() {
    let file = vector("a3_transfer_global.json");
    let tolerance = file["tolerance"].as_f64().expect("a number");
    for case in list(&file, "cases") {
        let (source, target) = (spline(&case["source"]), spline(&case["target"]));
        let made = transfer(&target, &source, &global(whole(case, "k"))).expect("a transfer");
        let expected = spline(&case["result"]);
        assert_eq!(made.curve.knots, expected.knots);
        assert!(difference(&made.curve.points, &expected.points) <= tolerance);
    }
}

fn direction(value: &Value) -> Option<Vector3<f64>> {
    Some(Vector3::from_vec(numbers(value)))
}

fn settings_of(case: &Value) -> Settings {
    let options = &case["options"];
    let local = options["mode"] == "frame";
    Settings {
        levels: LevelChoice::Finest(whole(options, "n_levels")),
        gains: options.get("gains").map_or(vec![1.0], numbers),
        frame: if local { Frame::Local } else { Frame::Global },
        scale: match &options["scale"] {
            Value::Number(factor) => Scale::Factor(factor.as_f64().expect("a number")),
            Value::String(word) if word == "arc" => Scale::ArcLength,
            _ => Scale::Factor(1.0),
        },
        ends: whole(options, "k"),
        interval: options.get("interval").map(|i| (numbers(i)[0], numbers(i)[1])),
        existing: Existing::Keep,
        target_base: TargetBase::Coarse,
        reverse: options.get("reverse").is_some_and(|r| r == true),
        roll: options.get("roll").map_or(0.0, |r| r.as_f64().expect("a number")),
        normals: [direction(&case["source_normal"]), direction(&case["target_normal"])],
    }
}

#[test]
fn transfers_in_the_local_frame_are_those_of_the_vectors() {
    let file = vector("a4_transfer_frame_partial.json");
    let tolerance = file["tolerance"].as_f64().expect("a number");
    let (source, target) = (spline(&file["source"]), spline(&file["target"]));
    for case in list(&file, "cases") {
        let made = transfer(&target, &source, &settings_of(case)).expect("a transfer");
        assert!((made.scale - case["scale_used"].as_f64().expect("a number")).abs() <= tolerance);
        let expected = spline(&case["result"]);
        assert_eq!(made.curve.knots.degree(), expected.knots.degree());
        assert_eq!(made.curve.points.len(), expected.points.len(), "{}", case["name"]);
        for (t, point) in numbers(&case["params"]).into_iter().zip(rows(&case["points"])) {
            let off = (made.curve.at(t)[0] - Vector3::from(point)).norm();
            assert!(off <= tolerance, "{} at {t}: {off:e}", case["name"]);
        }
    }
}

/// A wavy curve of size 30 over uneven knots.
fn wavy(degree: usize, spans: usize, seed: f64) -> Spline {
    let inner =
        (1..spans).map(|i| (i as f64 + 0.4 * (f64::from(i as u32) * 1.3 + seed).sin()) / spans as f64);
    let all = std::iter::repeat_n(0.0, degree + 1).chain(inner).chain(std::iter::repeat_n(1.0, degree + 1));
    let knots = KnotVector::new(degree, all.collect()).expect("good knots");
    let point = |g: &f64| {
        let wave = 0.4 * (40.0 * g + seed).sin();
        [30.0 * g, 8.0 * (3.0 * g + seed).sin() + wave, 5.0 * g * g + 0.3 * (31.0 * g).cos()]
    };
    let points = knots.greville().iter().map(point).collect();
    Spline { knots, points }
}

fn off(a: &Spline, b: &Spline) -> f64 {
    let at = |i: u32| f64::from(i) / 100.0;
    (0..=100).map(|i| (a.at(at(i))[0] - b.at(at(i))[0]).norm()).fold(0.0, f64::max)
}

fn moved(curve: &Spline, turn: &Matrix3<f64>, by: &Vector3<f64>) -> Spline {
    let points = curve.points.iter().map(|p| (turn * Vector3::from(*p) + by).into()).collect();
    Spline { knots: curve.knots.clone(), points }
}

fn with_normals() -> Settings {
    let normal = Vector3::new(0.2, 0.3, 0.9);
    Settings { normals: [Some(normal), Some(normal)], scale: Scale::Factor(1.0), ..Settings::default() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn the_own_detail_on_the_own_base_is_the_curve(
        degree in 1..=5usize, spans in 4..40usize, seed in 0.0..6.0f64, ends in 0..3usize
    ) {
        let curve = wavy(degree, spans, seed);
        let ends = ends.min(degree);
        let split = decompose(&curve.knots, &curve.points, usize::MAX, ends).expect("levels");
        prop_assume!(!split.levels.is_empty());
        let base = Spline { knots: split.base_knots, points: split.base };
        for frame in [Frame::Global, Frame::Local] {
            let made = transfer(&base, &curve, &Settings { frame, ends, ..with_normals() }).expect("a transfer");
            prop_assert!(off(&made.curve, &curve) <= 3e-9);
            // Its own detail instead of its own detail: the same again.
            let again = Settings { frame, ends, existing: Existing::Replace, ..with_normals() };
            let made = transfer(&curve, &curve, &again).expect("a transfer");
            prop_assert!(off(&made.curve, &curve) <= 3e-9);
        }
    }

    #[test]
    fn no_gain_is_the_target_and_gains_are_linear(
        degree in 1..=5usize, other in 1..=5usize, seed in 0.0..6.0f64, gain in -3.0..3.0f64
    ) {
        let (source, target) = (wavy(degree, 24, seed), wavy(other, 7, seed + 1.0));
        let with = |gain: f64| {
            transfer(&target, &source, &Settings { gains: vec![gain], ..with_normals() }).expect("a transfer")
        };
        prop_assert!(off(&with(0.0).curve, &target) <= 3e-10);
        let (one, more) = (with(1.0), with(gain));
        for i in 0..=50u32 {
            let t = f64::from(i) / 50.0;
            let [base, one, more] = [&target, &one.curve, &more.curve].map(|curve| curve.at(t)[0]);
            prop_assert!((more - base - (one - base) * gain).norm() <= 3e-10);
        }
    }

    #[test]
    fn rigid_motions_commute_in_the_local_frame(seed in 0.0..6.0f64, angle in 0.0..6.0f64, ends in 1..3usize) {
        let (source, target) = (wavy(3, 24, seed), wavy(3, 7, seed + 1.0));
        let turn = nalgebra_turn(angle);
        let by = Vector3::new(10.0, -20.0, 5.0);
        let settings = Settings { ends, ..with_normals() };
        let plain = transfer(&target, &source, &settings).expect("a transfer").curve;
        let turned = |settings: &Settings, which: usize| {
            let mut settings = settings.clone();
            settings.normals[which] = settings.normals[which].map(|n| turn * n);
            settings
        };
        let made = transfer(&moved(&target, &turn, &by), &source, &turned(&settings, 1)).expect("a transfer");
        prop_assert!(off(&made.curve, &moved(&plain, &turn, &by)) <= 3e-9);
        let made = transfer(&target, &moved(&source, &turn, &by), &turned(&settings, 0)).expect("a transfer");
        prop_assert!(off(&made.curve, &plain) <= 3e-9);
    }

    #[test]
    fn a_part_leaves_the_rest_and_meets_it_smoothly(seed in 0.0..6.0f64, from in 0.05..0.4f64, ends in 1..=3usize) {
        let (source, target) = (wavy(3, 24, seed), wavy(3, 9, seed + 1.0));
        let interval = (from, from + 0.37);
        let settings = Settings { ends, interval: Some(interval), ..with_normals() };
        let made = transfer(&target, &source, &settings).expect("a transfer").curve;
        for i in 0..=100u32 {
            let t = f64::from(i) / 100.0;
            if t <= interval.0 || t >= interval.1 {
                prop_assert!((made.at(t)[0] - target.at(t)[0]).norm() <= 3e-10);
            }
        }
        if ends >= 2 {
            for t in [interval.0, interval.1] {
                prop_assert!((made.at(t + 1e-9)[1] - made.at(t - 1e-9)[1]).norm() <= 1e-3);
            }
        }
        // Whole, the ends and their tangents stay to the last bit and to rounding.
        let made = transfer(&target, &source, &Settings { ends, ..with_normals() }).expect("a transfer").curve;
        prop_assert_eq!(made.points[0], target.points[0]);
        prop_assert_eq!(made.points.last(), target.points.last());
        if ends >= 2 {
            prop_assert!((made.at(0.0)[1] - target.at(0.0)[1]).norm() <= 1e-9);
        }
    }
}

/// A turn about a slanted axis.
fn nalgebra_turn(angle: f64) -> Matrix3<f64> {
    let axis = Vector3::new(1.0, 2.0, -0.5).normalize();
    let cross = axis.cross_matrix();
    Matrix3::identity() + cross * angle.sin() + cross * cross * (1.0 - angle.cos())
}

#[test]
fn what_cannot_be_done_is_refused() {
    let (source, target) = (wavy(3, 24, 1.0), wavy(3, 7, 2.0));
    let refused = |settings: Settings| transfer(&target, &source, &settings).expect_err("a refusal").code();
    let these =
        |levels: &[usize]| Settings { levels: LevelChoice::These(levels.to_vec()), ..Settings::default() };
    assert_eq!(refused(these(&[1, 9])), "detail.no-such-level");
    assert_eq!(refused(Settings { gains: vec![1.0; 3], ..these(&[1, 2]) }), "detail.gain-count");
    assert_eq!(refused(Settings { ends: 4, ..Settings::default() }), "detail.no-wavelets");
    let part = |a: f64, b: f64, ends| Settings { interval: Some((a, b)), ends, ..Settings::default() };
    assert_eq!(refused(part(0.2, 0.5, 0)), "detail.partial-needs-ends");
    assert_eq!(refused(part(0.5, 0.2, 1)), "detail.bad-interval");
    assert_eq!(refused(part(0.5, 1.2, 1)), "detail.bad-interval");
    assert_eq!(
        refused(Settings { gains: vec![1e308; 1], scale: Scale::Factor(1e308), ..Settings::default() }),
        "detail.not-finite"
    );
    let smooth = wavy(3, 1, 0.0);
    let error = transfer(&target, &smooth, &Settings::default()).expect_err("a refusal");
    assert!(matches!(error, TransferError::NoLevels { controls: 4, degree: 3, .. }));
    let point = Spline { points: vec![[1.0; 3]; source.points.len()], ..source.clone() };
    let error = transfer(&target, &point, &Settings::default()).expect_err("a refusal");
    assert!(matches!(error, TransferError::DegenerateBase { curve: "source", .. }));
    let mut closed = target.clone();
    let last = closed.points.len() - 1;
    closed.points[last] = closed.points[0];
    let free = Settings { ends: 0, ..Settings::default() };
    assert_eq!(transfer(&closed, &source, &free).expect_err("a refusal").code(), "detail.opens-seam");
}
