//! Analysis of curves by wavelets over their size, beside the dense analysis by an inverse.

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::DMatrix;
use resurf::geometry::bspline_wavelet::{Level, decompose};
use resurf::geometry::nurbs::KnotVector;

fn curve(log: u32) -> (KnotVector, Vec<[f64; 3]>) {
    let knots = KnotVector::clamped_uniform(3, 1 << log, 0.0, 1.0).unwrap();
    let point = |i: usize| [i as f64, (i as f64).sin(), (1.7 * i as f64).cos()];
    let points = (0..knots.n_basis()).map(point).collect();
    (knots, points)
}

/// `[P|Q]` of a level, inverted and applied: what the published method does.
fn dense(level: &Level, points: &[[f64; 3]]) -> DMatrix<f64> {
    let n = points.len();
    let mut filters = DMatrix::zeros(n, n);
    for i in 0..n {
        let (first, row) = level.refinement().row(i);
        for (j, value) in (first..).zip(row) {
            filters[(i, j)] = *value;
        }
    }
    let columns = level.refinement().columns();
    for j in 0..level.wavelet_count() {
        let (first, column) = level.wavelet(j);
        for (i, value) in (first..).zip(column) {
            filters[(i, columns + j)] = *value;
        }
    }
    filters.try_inverse().unwrap() * DMatrix::from_fn(n, 3, |i, c| points[i][c])
}

fn analysis(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("analysis");
    group.sample_size(10);
    for log in [10, 12, 14, 16, 18, 20] {
        let (knots, points) = curve(log);
        group.throughput(Throughput::Elements(points.len() as u64));
        group.bench_with_input(
            BenchmarkId::new("all levels, with filters", points.len()),
            &log,
            |bencher, _| {
                bencher.iter(|| decompose(&knots, &points, usize::MAX, 1).unwrap());
            },
        );
        let level = Level::new(&knots, 1).unwrap().unwrap();
        group.bench_with_input(BenchmarkId::new("one level, banded", points.len()), &log, |bencher, _| {
            bencher.iter(|| level.split(&points).unwrap());
        });
    }
    for log in [6, 8, 9] {
        let (knots, points) = curve(log);
        let level = Level::new(&knots, 0).unwrap().unwrap();
        group.bench_with_input(BenchmarkId::new("one level, dense", points.len()), &log, |bencher, _| {
            bencher.iter(|| dense(&level, &points));
        });
    }
    group.finish();
}

criterion_group!(benches, analysis);
criterion_main!(benches);
