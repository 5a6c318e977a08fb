//! Whole pastes of a bump onto targets of growing nets, by the default method and by the others at one size.

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

use std::f64::consts::{PI, TAU};

use criterion::{Criterion, criterion_group, criterion_main};
use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::ops::feature_paste::{Existing, Feature, Ground, Method, Settings, paste};

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

fn pastes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("feature_paste");
    group.sample_size(10);
    let contour: Vec<[f64; 2]> = (0..64)
        .map(|k| TAU * f64::from(k) / 64.0)
        .map(|t| [0.5 + 0.42 * t.cos(), 0.5 + 0.42 * t.sin()])
        .collect();
    let mut run = |name: String, spans: [usize; 2], method: Method, angle: f64| {
        let (source, target) = (bump(spans[0]), cylinder(spans[1]));
        let existing = if method == Method::Poisson { Existing::Replace } else { Existing::Keep };
        let settings = Settings { method: Some(method), existing, angle, ..Settings::new(1e-3) };
        let feature = Feature { source: &source, contour: &contour, anchor: [0.5, 0.5] };
        let ground = Ground { target: &target, at: [0.5, 0.5] };
        let (rows, columns) = paste(&feature, &ground, &settings).unwrap().surface.shape();
        group.bench_function(format!("{name}/{rows}x{columns}"), |bencher| {
            bencher.iter(|| paste(&feature, &ground, &settings).unwrap());
        });
    };
    for spans in [[18, 20], [36, 40], [72, 80], [96, 100]] {
        run("displacement".to_owned(), spans, Method::Displacement, 0.0);
    }
    run("poisson".to_owned(), [36, 40], Method::Poisson, 0.0);
    run("biharmonic".to_owned(), [36, 40], Method::Biharmonic, 0.0);
    run("fit".to_owned(), [36, 40], Method::Fit, 0.5);
    group.finish();
}

criterion_group!(benches, pastes);
criterion_main!(benches);
