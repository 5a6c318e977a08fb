//! Sheets with a feature to be pasted elsewhere: a bump, a groove and a symbol, each flat all round.

use std::f64::consts::PI;

use super::panel::{Panel, part};

/// A smooth step: 1 at 0 and below, 0 at 1 and above, flat at both.
fn fall(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    0.5 + 0.5 * (PI * t).cos()
}

/// Distance of a point from a chain of straight pieces.
fn off_chain(point: [f64; 2], chain: &[[f64; 2]]) -> f64 {
    let off_piece = |a: [f64; 2], b: [f64; 2]| {
        let (d, p) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
        let t = ((p[0] * d[0] + p[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (p[0] - t * d[0]).hypot(p[1] - t * d[1])
    };
    chain.windows(2).map(|w| off_piece(w[0], w[1])).fold(f64::INFINITY, f64::min)
}

fn sheet(name: &'static str, size: [f64; 2], spans: [usize; 2], height: impl Fn(f64, f64) -> f64) -> Panel {
    let surface = part([3, 3], spans, |x, y| {
        let at = [size[0] * (x - 0.5), size[1] * (y - 0.5)];
        [at[0], at[1], height(at[0], at[1])]
    });
    Panel { name, colour: [0.8, 0.6, 0.2], surface, holes: Vec::new() }
}

/// An asymmetric bump of 8 mm on a sheet of 80 mm by 80 mm.
pub fn bump() -> Panel {
    sheet("bump", [80.0, 80.0], [16, 16], |x, y| {
        6.0 * fall(x.hypot(y) / 20.0) + 4.0 * fall((x - 6.0).hypot(y + 5.0) / 12.0)
    })
}

/// A groove of 4 mm with round ends, 70 mm long, on a sheet of 120 mm by 60 mm.
pub fn groove() -> Panel {
    sheet("groove", [120.0, 60.0], [24, 12], |x, y| {
        -4.0 * fall(off_chain([x, y], &[[-28.0, 0.0], [28.0, 0.0]]) / 9.0)
    })
}

/// The letters `rs`, 3 mm high, on a sheet of 120 mm by 80 mm.
pub fn symbol() -> Panel {
    let r: &[[f64; 2]] = &[[-30.0, -18.0], [-30.0, 18.0]];
    let arm: &[[f64; 2]] = &[[-30.0, 4.0], [-24.0, 14.0], [-12.0, 17.0], [-6.0, 13.0]];
    let s: &[[f64; 2]] = &[
        [32.0, 13.0],
        [24.0, 18.0],
        [12.0, 17.0],
        [8.0, 9.0],
        [14.0, 2.0],
        [26.0, -2.0],
        [32.0, -9.0],
        [27.0, -17.0],
        [14.0, -18.0],
        [6.0, -13.0],
    ];
    sheet("symbol", [120.0, 80.0], [48, 32], move |x, y| {
        let off = [r, arm, s].iter().map(|chain| off_chain([x, y], chain)).fold(f64::INFINITY, f64::min);
        3.0 * fall((off - 1.5) / 5.0)
    })
}
