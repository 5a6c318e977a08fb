//! The fit at every fifteen degrees, mirrored and not, at three scales: within the tolerance that it was given.

use resurf::math::{Matrix3, Vector3};
use resurf::ops::feature_paste::{Method, Mirror, Settings};

use super::parts::{bump, moved_plane, part, pasted, placed_error};

/// Greatest deviation asked for, on a feature of size 4 and height 0.8.
const TOLERANCE: f64 = 4e-2;

#[test]
fn the_fit_keeps_its_tolerance_at_24_angles_mirrored_and_not_at_three_scales() {
    let source = part([3, 3], [8, 8], bump);
    let target = moved_plane([3, 3]);
    let mut worst = 0.0_f64;
    for step in 0..24 {
        for mirror in [Mirror::None, Mirror::U] {
            for scale in [0.6, 1.0, 1.3] {
                let angle = f64::from(step) * std::f64::consts::PI / 12.0;
                let settings = Settings {
                    method: Some(Method::Fit),
                    angle,
                    mirror,
                    scale: [scale; 3],
                    ..Settings::new(TOLERANCE * scale)
                };
                let result = pasted(&source, &target, 0.42, &settings).unwrap();
                let reported = result.fit_error.unwrap();
                assert!(reported <= settings.tolerance, "{reported}");
                let (sine, cosine) = angle.sin_cos();
                let turn = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
                let flip = match mirror {
                    Mirror::None => Vector3::new(1.0, 1.0, 1.0),
                    Mirror::U => Vector3::new(-1.0, 1.0, 1.0),
                    Mirror::V => Vector3::new(1.0, -1.0, 1.0),
                };
                let map = turn * Matrix3::from_diagonal(&flip) * scale;
                let error = placed_error(&result, &source, &map) / settings.tolerance;
                assert!(error <= 1.0, "{step} x 15 degrees, {mirror:?}, {scale}: {error} of the tolerance");
                worst = worst.max(error);
            }
        }
    }
    // A sweep that never came near its tolerance would show nothing.
    assert!(worst > 1e-3, "{worst}");
}
