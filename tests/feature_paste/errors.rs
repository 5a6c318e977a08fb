//! Each bad input has its own error.

use resurf::math::{Point3, Vector3};
use resurf::ops::feature_paste::{
    Existing, Feature, Ground, Method, PasteError, Plane, Settings, contour::closed_points, paste,
    project_contour,
};

use super::parts::{circle, cylinder, moved_plane, pasted, source};

fn with_contour(contour: &[[f64; 2]]) -> &'static str {
    let (source, target) = (source(), cylinder());
    let feature = Feature { source: &source, contour, anchor: [0.5, 0.5] };
    let result = paste(&feature, &Ground { target: &target, at: [0.5, 0.5] }, &Settings::new(1e-3));
    result.map(|_| "no error").unwrap_or_else(|error| error.code())
}

#[test]
fn bad_contours_are_told_apart() {
    assert_eq!(
        with_contour(&[[0.2, 0.2], [0.8, 0.8], [0.8, 0.2], [0.2, 0.8]]),
        "paste.contour-crosses-itself"
    );
    assert_eq!(with_contour(&[[0.2, 0.2], [1.8, 0.2], [0.8, 0.8]]), "paste.contour-outside-source");
    assert_eq!(with_contour(&[[0.2, 0.2], [0.8, 0.2]]), "paste.contour-degenerate");
    assert_eq!(with_contour(&[[0.2, 0.2], [0.8, f64::NAN], [0.8, 0.8]]), "paste.contour-not-finite");
    assert_eq!(with_contour(&circle(0.0001)), "paste.region-too-small");
}

#[test]
fn a_weight_of_zero_or_below_makes_no_surface() {
    use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
    let knots = || KnotVector::clamped_uniform(1, 1, 0.0, 1.0).unwrap();
    let net = |w: f64| vec![[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], [w, w, 0.0, w]];
    assert!(NurbsSurface::new(knots(), knots(), net(1.0)).is_ok());
    for weight in [0.0, -1.0, f64::NAN] {
        assert!(NurbsSurface::new(knots(), knots(), net(weight)).is_err(), "{weight}");
    }
}

#[test]
fn a_feature_greater_than_the_target_is_refused_with_the_reach() {
    let settings = Settings { scale: [5.0; 3], ..Settings::new(1e-3) };
    for method in [Method::Displacement, Method::Fit] {
        let settings = Settings { method: Some(method), ..settings.clone() };
        let error = pasted(&source(), &cylinder(), 0.42, &settings).unwrap_err();
        assert!(matches!(error, PasteError::OutsideTarget { direction: "u" | "v", .. }), "{error}");
    }
}

#[test]
fn impossible_settings_are_refused() {
    let plane = moved_plane([3, 3]);
    let code = |settings: &Settings| pasted(&source(), &plane, 0.42, settings).unwrap_err().code();
    let base = Settings::new(1e-3);
    assert_eq!(code(&Settings { scale: [1.0, -1.0, 1.0], ..base.clone() }), "paste.bad-setting");
    assert_eq!(code(&Settings { scale: [1.0, 1.0, 0.0], ..base.clone() }), "paste.bad-setting");
    assert_eq!(code(&Settings { angle: f64::NAN, ..base.clone() }), "paste.bad-setting");
    assert_eq!(code(&Settings::new(-1.0)), "paste.bad-setting");
    let turned = Settings { angle: 0.3, method: Some(Method::Poisson), ..base.clone() };
    assert_eq!(code(&turned), "paste.method-cannot");
    let mixed = Settings { existing: Existing::Stronger, method: Some(Method::Fit), ..base.clone() };
    assert_eq!(code(&mixed), "paste.method-cannot");
    assert_eq!(code(&Settings { limit: 100, ..base.clone() }), "paste.net-too-large");
    let coarse = super::parts::part([3, 3], [6, 6], super::parts::bump);
    let precise = Settings { method: Some(Method::Fit), angle: 0.3, ..Settings::new(1e-13) };
    let refused = pasted(&coarse, &plane, 0.42, &precise).unwrap_err();
    assert_eq!(refused.code(), "paste.fit-tolerance-not-reached");
}

#[test]
fn contours_in_space_that_miss_or_stay_open_are_refused() {
    let target = cylinder();
    let ring = |radius: f64| -> Vec<Point3<f64>> {
        (0..40)
            .map(|k| 2.0 * std::f64::consts::PI * f64::from(k) / 40.0)
            .map(|t| Point3::new(radius * t.cos(), radius * t.sin(), 3.0))
            .collect()
    };
    let plane = Plane { origin: Point3::new(0.0, 0.0, 3.0), normal: Vector3::z() };
    assert_eq!(project_contour(&target, &ring(1.0), plane).unwrap().len(), 40);
    // The cylinder's part is 8.6 wide and 10 long.
    assert_eq!(project_contour(&target, &ring(9.0), plane).unwrap_err(), PasteError::ContourLargerThanFace);
    let beside: Vec<_> = ring(1.0).iter().map(|p| p + Vector3::new(20.0, 0.0, 0.0)).collect();
    assert_eq!(project_contour(&target, &beside, plane).unwrap_err(), PasteError::ContourOffFace);
    let across: Vec<_> = ring(1.0).iter().map(|p| p + Vector3::new(0.0, 5.0, 0.0)).collect();
    let left = project_contour(&target, &across, plane).unwrap_err();
    // The second point is the first above the end at y = 5.
    assert_eq!(left, PasteError::ContourProjectionFailed { point: 1 });
    assert_eq!(closed_points(ring(1.0)).unwrap_err().code(), "paste.contour-open");
    let mut closed = ring(1.0);
    closed.push(closed[0]);
    assert_eq!(closed_points(closed).unwrap().len(), 40);
}
