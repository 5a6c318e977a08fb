//! Wires: three wavy source curves of the dyadic levels 4, 3 and 5, and three smooth targets of the levels 3, 1
//! and 1, for the nine transfers of detail between them.

use std::f64::consts::PI;

use super::records::{Name, Records, Schema, list};
use super::spline::{Curve, Point, clamped, greville};

/// A target and its level.
#[derive(Clone, Copy)]
pub enum Target {
    /// Half a circle of radius 60, nearly, that rises; level 3.
    Arch,
    /// A flat bow; level 1.
    Bow,
    /// An S in space; level 1.
    Hook,
}

/// A cubic of `2^level + 3` control points, given over the Greville abscissae.
fn cubic(level: u32, point: impl Fn(f64) -> Point) -> Curve {
    let knots = clamped(3, 1 << level);
    let points = greville(&knots, 3).into_iter().map(point).collect();
    Curve { degree: 3, knots, points }
}

/// A straight base 120 long with ripples across it.
fn source(level: u32) -> Curve {
    match level {
        3 => cubic(3, |s| [120.0 * s, 6.0 * (6.0 * PI * s).sin(), 0.0]),
        4 => cubic(4, |s| {
            [120.0 * s, 5.0 * (10.0 * PI * s).sin() + 2.0 * (4.0 * PI * s).cos(), 1.5 * (12.0 * s).sin()]
        }),
        _ => cubic(5, |s| {
            let wave = 1.0 - (2.0 * s - 1.0).powi(2);
            [120.0 * s, 4.0 * wave * (22.0 * PI * s).sin(), 2.0 * wave * (14.0 * PI * s).cos()]
        }),
    }
}

fn target(which: Target) -> Curve {
    match which {
        Target::Arch => cubic(3, |s| [60.0 * (PI * s).cos(), 60.0 * (PI * s).sin(), 12.0 * s]),
        Target::Bow => cubic(1, |s| [150.0 * s, 90.0 * s * (1.0 - s), 0.0]),
        Target::Hook => cubic(1, |s| [100.0 * s, 70.0 * (2.0 * PI * s).sin(), 80.0 * s * s]),
    }
}

/// The file of the three sources, named `SOURCE_4`, `SOURCE_3` and `SOURCE_5`.
pub fn sources() -> String {
    let mut records = Records::new("sources", Schema::Ap214);
    let curves: Vec<Name> =
        [4, 3, 5].iter().map(|level| records.curve(&format!("SOURCE_{level}"), &source(*level))).collect();
    finish(records, "sources", "", &curves)
}

/// The file of one target, a wire without a name in a set named `TARGET`.
pub fn one_target(which: Target, name: &'static str) -> String {
    let mut records = Records::new(name, Schema::Ap214);
    let curve = records.curve("", &target(which));
    finish(records, name, "TARGET", &[curve])
}

/// A file of free curves.
pub fn finish(mut records: Records, product: &str, set: &str, curves: &[Name]) -> String {
    let product = records.product(product);
    let set = records.add(format!("GEOMETRIC_CURVE_SET('{set}',{})", list(curves)));
    let placement = records.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    records.representation(
        product,
        "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION",
        &[placement, set],
    );
    records.finish()
}
