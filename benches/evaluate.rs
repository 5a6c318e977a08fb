//! Time of the NURBS kernel: evaluation, closest point with a seed and without, refinement, elevation.
#![expect(missing_docs, reason = "criterion's macros make undocumented items")]
#![expect(clippy::unwrap_used, reason = "a benchmark stops at what cannot be built")]

use criterion::{Criterion, criterion_group, criterion_main};
use resurf::geometry::nurbs::{KnotVector, NurbsSurface, SurfaceLocator, Wrap};
use resurf::math::Point3;
use std::hint::black_box;

/// A wavy bicubic net of `n x n` control points over the unit square.
fn panel(n: usize) -> NurbsSurface {
    let knots = KnotVector::clamped_uniform(3, n - 3, 0.0, 1.0).unwrap();
    let g = knots.greville();
    let mut points = Vec::with_capacity(n * n);
    for &u in &g {
        points.extend(g.iter().map(|&v| Point3::new(u, v, 0.1 * (9.0 * u).sin() * (7.0 * v).cos())));
    }
    NurbsSurface::from_points(knots.clone(), knots, &points, None).unwrap()
}

fn kernel(c: &mut Criterion) {
    let surface = panel(51);
    let target = surface.point(0.413, 0.627) + surface.normal(0.413, 0.627).unwrap() * 0.01;
    c.bench_function("point", |b| b.iter(|| surface.point(black_box(0.413), black_box(0.627))));
    c.bench_function("second derivatives", |b| b.iter(|| surface.derivatives(black_box(0.413), 0.627)));
    c.bench_function("closest point with a seed", |b| {
        b.iter(|| surface.closest_from(black_box(&target), (0.41, 0.63), Wrap::default()));
    });
    let locator = SurfaceLocator::new(&surface, Wrap::default());
    c.bench_function("closest point without a seed", |b| b.iter(|| locator.closest(black_box(&target))));
    c.bench_function("bisect every span of 51 x 51", |b| {
        let middles: Vec<f64> = (0..48).map(|i| (f64::from(i) + 0.5) / 48.0).collect();
        b.iter(|| surface.refined_u(black_box(&middles)).unwrap().refined_v(&middles).unwrap());
    });
    c.bench_function("elevate 51 x 51 to degree 4", |b| {
        b.iter(|| black_box(&surface).elevated(4, 4).unwrap())
    });
}

criterion_group!(benches, kernel);
criterion_main!(benches);
