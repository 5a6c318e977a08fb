//! Lines over the door: a crest above it that fades out at both ends, and one line on either side that stays where it is.

use super::panel::Panel;
use super::records::{Records, Schema};
use super::spline::{Curve, Surface, clamped, greville};
use super::wires::finish;

/// Spans of a line.
const SPANS: usize = 40;
/// The crest's greatest height over the door, in millimetres.
const HEIGHT: f64 = 7.0;
/// Where the lines run: first and last `u`, and `v` of the crest and of the lines beside it.
const ALONG: [f64; 2] = [0.12, 0.88];
const CREST: f64 = 0.47;
const BESIDE: [f64; 2] = [0.42, 0.52];

/// A cubic that follows the door at a height.
fn line(door: &Surface, v: f64, height: impl Fn(f64) -> f64) -> Curve {
    let knots = clamped(3, SPANS);
    let at = |s: f64| {
        let u = ALONG[0] + (ALONG[1] - ALONG[0]) * s;
        let [x, y, z] = door.derivative([u, v], [0, 0]);
        [x, y, z + height(s)]
    };
    let points = greville(&knots, 3).into_iter().map(at).collect();
    Curve { degree: 3, knots, points }
}

/// The file of the lines, named `CREST`, `BELOW` and `ABOVE`.
pub fn lines() -> String {
    let door = Panel::door().surface;
    let mut records = Records::new("crease", Schema::Ap214);
    let fade = |s: f64| HEIGHT * (4.0 * s * (1.0 - s)).powi(2);
    let curves = [
        records.curve("CREST", &line(&door, CREST, fade)),
        records.curve("BELOW", &line(&door, BESIDE[0], |_| 0.0)),
        records.curve("ABOVE", &line(&door, BESIDE[1], |_| 0.0)),
    ];
    finish(records, "crease", "", &curves)
}
