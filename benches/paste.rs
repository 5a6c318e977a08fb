//! Whole pastes of a bump onto a cylinder: processor time over the size of the net, for each method.
//!
//! `cargo bench --bench paste` prints the table; with `-- --million` it ends with a feature of a million control points,
//! which takes some gigabytes.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark that cannot go on stops"
)]

mod support;

use std::f64::consts::{PI, TAU};

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::ops::feature_paste::{Existing, Feature, Ground, Method, Settings, paste};
use support::{peak_megabytes, timed};

fn sheet(spans: usize, f: impl Fn(f64, f64) -> [f64; 3]) -> NurbsSurface {
    let knots = KnotVector::clamped_uniform(3, spans, 0.0, 1.0).unwrap();
    let greville = knots.greville();
    let point = |x: f64, y: f64| {
        let [x, y, z] = f(x, y);
        [x, y, z, 1.0]
    };
    let net = greville.iter().flat_map(|&x| greville.iter().map(move |&y| point(x, y))).collect();
    NurbsSurface::new(knots.clone(), knots, net).unwrap()
}

fn bump(spans: usize) -> NurbsSurface {
    sheet(spans, |x, y| {
        let r = (x - 0.5).hypot(y - 0.5) / 0.2;
        let height = if r < 1.0 { 0.6 * (0.5 * PI * r).cos().powi(2) } else { 0.0 };
        [4.0 * x, 4.0 * y, height]
    })
}

fn cylinder(spans: usize) -> NurbsSurface {
    sheet(spans, |x, y| {
        let angle = 1.6 * (x - 0.5);
        [6.0 * angle.sin(), 10.0 * (y - 0.5), 6.0 * angle.cos()]
    })
}

fn row(method: Method, spans: [usize; 2], angle: f64, runs: usize) {
    let contour: Vec<[f64; 2]> = (0..64)
        .map(|k| TAU * f64::from(k) / 64.0)
        .map(|t| [0.5 + 0.42 * t.cos(), 0.5 + 0.42 * t.sin()])
        .collect();
    let (source, target) = (bump(spans[0]), cylinder(spans[1]));
    let existing = if method == Method::Poisson { Existing::Replace } else { Existing::Keep };
    let settings = Settings { method: Some(method), existing, angle, ..Settings::new(1e-3) };
    let feature = Feature { source: &source, contour: &contour, anchor: [0.5, 0.5] };
    let ground = Ground { target: &target, at: [0.5, 0.5] };
    let (seconds, pasted) = timed(runs, || paste(&feature, &ground, &settings).unwrap());
    let ((a, b), (rows, columns)) = (target.shape(), pasted.surface.shape());
    let (changed, peak) = (pasted.changed.count(), peak_megabytes());
    println!(
        "| {} | {a} x {b} | {rows} x {columns} | {changed} | {seconds:.3} | {:.1} | {peak:.0} |",
        method.as_str(),
        1e6 * seconds / (rows * columns) as f64,
    );
}

fn main() {
    println!(
        "| method | target | result | control points changed | s | µs for each of the result | peak MB |"
    );
    println!("|---|---|---|---|---|---|---|");
    for spans in [[18, 20], [36, 40], [72, 80], [96, 100], [192, 200], [384, 400]] {
        row(Method::Displacement, spans, 0.0, 3);
    }
    for method in [Method::Poisson, Method::Biharmonic, Method::Fit] {
        for spans in [[36, 40], [96, 100]] {
            row(method, spans, if method == Method::Fit { 0.5 } else { 0.0 }, 3);
        }
    }
    if std::env::args().any(|argument| argument == "--million") {
        row(Method::Displacement, [1360, 40], 0.0, 1);
    }
}
