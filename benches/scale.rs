//! Cost of constrained scaling: one face with holes, over the size of its net and the count of its holes. Prints processor
//! seconds of all threads together, the least of three runs, and the greatest memory of the process so far.
//!
//! `cargo bench --bench scale`; figures in `docs/benchmarks.md`. Linux: it reads `/proc/self`.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints, and stops when it cannot go on"
)]

use std::f64::consts::{PI, TAU};

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

fn hole(group: usize, center: [f64; 2], radius: f64) -> HeldLoop {
    let vertex = |k: i32| {
        let t = TAU * f64::from(k) / 48.0;
        [center[0] + radius * t.cos(), center[1] + radius * t.sin()]
    };
    let contour = Contour { points: (0..48).map(vertex).collect(), margin: [0.0; 2] };
    HeldLoop { contour, group, hold: Hold::Rigid }
}

/// `count` by `count` holes, evenly spread, each a seventh of its share wide.
fn holes(count: u32) -> Vec<HeldLoop> {
    let share = 1.0 / f64::from(count);
    let at = |k: u32| (f64::from(k) + 0.5) * share;
    let places = (0..count).flat_map(|i| (0..count).map(move |j| [at(i), at(j)]));
    places.enumerate().map(|(k, center)| hole(k, center, share / 14.0)).collect()
}

/// Processor seconds of all threads, in user mode.
fn processor() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let after_name = stat.rsplit(") ").next().unwrap();
    after_name.split(' ').nth(11).unwrap().parse::<f64>().unwrap() / 100.0
}

/// Greatest memory so far, in MiB.
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() / 1024
}

fn row(spans: usize, loops: &[HeldLoop]) {
    let surface = panel(spans);
    let scaling = Scaling { max_control_points: 200_000, ..Scaling::new([1.1, 1.2, 1.25]) };
    let mut least = f64::INFINITY;
    let mut free = 0;
    for _ in 0..3 {
        let start = processor();
        let scaled = scale_face(&surface, loops, None, &scaling).unwrap();
        least = least.min(processor() - start);
        free = scaled.faces[0].free_points;
    }
    println!("| {} | {} | {free} | {least:.2} s | {} MiB |", loops.len(), surface.net().len(), memory());
}

fn main() {
    println!("| holes | control points | free | processor | memory |\n|---|---|---|---|---|");
    for spans in [48, 96, 160, 240, 335] {
        row(spans, &[hole(0, [0.3, 0.5], 0.07), hole(1, [0.7, 0.5], 0.07)]);
    }
    for count in [1, 3, 5, 7, 10] {
        row(160, &holes(count));
    }
}
