//! Whole solves of constrained scaling: one face with two holes at nets of 27², 51² and 99² control points.

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

use std::f64::consts::{PI, TAU};

use criterion::{Criterion, criterion_group, criterion_main};
use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::ops::constrained_scale::{Contour, HeldLoop, Hold, Scaling, scale_face};

fn panel(spans: usize) -> NurbsSurface {
    let knots = KnotVector::clamped_uniform(3, spans, 0.0, 1.0).unwrap();
    let greville = knots.greville();
    let point = |x: f64, y: f64| {
        let z = 30.0 * (1.0 - (2.0 * x - 1.0).powi(2)) + 70.0 * (PI * y).sin();
        [1000.0 * x, 700.0 * y, z, 1.0]
    };
    let net = greville.iter().flat_map(|&x| greville.iter().map(move |&y| point(x, y))).collect();
    NurbsSurface::new(knots.clone(), knots, net).unwrap()
}

fn hole(group: usize, u: f64) -> HeldLoop {
    let vertex = |k: i32| {
        let t = TAU * f64::from(k) / 48.0;
        [u + 0.07 * t.cos(), 0.5 + 0.07 * t.sin()]
    };
    let contour = Contour { points: (0..48).map(vertex).collect(), margin: [0.0; 2] };
    HeldLoop { contour, group, hold: Hold::Rigid }
}

fn solves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("constrained_scale");
    group.sample_size(10);
    let loops = [hole(0, 0.3), hole(1, 0.7)];
    for spans in [24, 48, 96] {
        let surface = panel(spans);
        let scaling = Scaling::new([1.1, 1.2, 1.25]);
        let scaled = scale_face(&surface, &loops, None, &scaling).unwrap();
        let size = scaled.faces[0].surface.shape();
        group.bench_function(format!("{}x{}", size.0, size.1), |bencher| {
            bencher.iter(|| scale_face(&surface, &loops, None, &scaling).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
