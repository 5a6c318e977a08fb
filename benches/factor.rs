//! The factorisation behind smooth bases: thin plates and Laplacians over square nets, processor time and size.
//!
//! `cargo bench --bench factor` prints a table up to a million unknowns; with `-- --export FOLDER` it writes the smaller
//! matrices as plain binary files, for `benches/peer/factor.py` to factor by another program.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark that cannot go on stops"
)]

mod support;

use std::io::Write;
use std::path::Path;

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::math::CsMat;
use resurf::math::sparse::SymmetricFactor;
use resurf::ops::net::grams::Grams;
use resurf::ops::net::{GridSystem, Mask};
use support::{peak_megabytes, timed};

/// All places of a net of `side` by `side` but the outermost.
fn inner(side: usize, rows: usize) -> Mask {
    Mask::empty(side, side).complement().off_border(rows)
}

/// Bending energy of a bicubic net, two outer rows given: what smooth bases solve.
fn plate(side: usize) -> GridSystem {
    let knots = KnotVector::clamped_uniform(3, side + 1, 0.0, 1.0).unwrap();
    let count = knots.n_basis();
    let net = knots
        .greville()
        .into_iter()
        .flat_map(|x| knots.greville().into_iter().map(move |y| [x, y, 0.0, 1.0]));
    let surface = NurbsSurface::new(knots.clone(), knots.clone(), net.collect()).unwrap();
    let energy = Grams::new(&surface, [1.0; 2]).bending();
    let mut system = GridSystem::new(&inner(count, 2), [3, 3]);
    for k in 0..system.len() {
        let row = energy.outer_view(system.places()[k]).unwrap();
        for (at, value) in row.iter() {
            system.add(k, at, *value);
        }
    }
    system
}

/// The five-point Laplacian, the outermost row given.
fn laplacian(side: usize) -> GridSystem {
    let columns = side + 2;
    let mut system = GridSystem::new(&inner(columns, 1), [1, 1]);
    for k in 0..system.len() {
        let own = system.places()[k];
        system.add(k, own, 4.0);
        for at in [own - columns, own - 1] {
            system.add(k, at, -1.0);
        }
    }
    system
}

fn row(name: &str, side: usize, system: &GridSystem) {
    let size = system.len();
    let right: Vec<f64> = (0..3 * size).map(|k| (k as f64).sin()).collect();
    let solved = |factor: &SymmetricFactor| {
        let mut x = right.clone();
        factor.solve(&mut x);
        (x, factor.bytes())
    };
    let runs = if size > 200_000 { 1 } else { 3 };
    let (dissected, (x, bytes)) = timed(runs, || solved(system.factor().unwrap().unknowns()));
    let residual = residual(&system.lower(), &x, &right);
    let by_degree = (size <= 300_000).then(|| {
        let matrix = system.lower();
        timed(runs, || solved(&SymmetricFactor::new(&matrix).unwrap())).0
    });
    let by_degree = by_degree.map_or_else(|| "-".to_owned(), |s| format!("{s:.3}"));
    let (factor, peak) = (bytes as f64 / 1e6, peak_megabytes());
    println!(
        "| {name} {side}² | {size} | {dissected:.3} | {factor:.0} | {residual:.1e} | {by_degree} | {peak:.0} |"
    );
}

/// Greatest entry of what the solution leaves of the right sides, over the greatest of these.
fn residual(lower: &CsMat<f64>, x: &[f64], right: &[f64]) -> f64 {
    let size = lower.rows();
    let mut rest = right.to_vec();
    for (i, row) in lower.outer_iterator().enumerate() {
        for (j, value) in row.iter() {
            for c in 0..3 {
                rest[c * size + i] -= value * x[c * size + j];
                if i != j {
                    rest[c * size + j] -= value * x[c * size + i];
                }
            }
        }
    }
    let greatest = |v: &[f64]| v.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    greatest(&rest) / greatest(right)
}

/// Size, entries, then starts, columns and values of the lower triangle, little-endian, eight bytes each.
fn export(folder: &Path, name: &str, system: &GridSystem) {
    let matrix = system.lower();
    let mut bytes = Vec::new();
    let counts = [matrix.rows(), matrix.nnz()];
    let indices = matrix.proper_indptr();
    for k in counts.iter().chain(&*indices).chain(matrix.indices()) {
        bytes.extend((*k as u64).to_le_bytes());
    }
    matrix.data().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    std::fs::File::create(folder.join(name)).unwrap().write_all(&bytes).unwrap();
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = arguments.iter().position(|a| a == "--export").and_then(|at| arguments.get(at + 1));
    let most = if folder.is_some() { 320 } else { usize::MAX };
    println!("| matrix | unknowns | s | factor MB | residual | s by minimum degree | peak MB |");
    println!("|---|---|---|---|---|---|---|");
    for (name, side) in [
        ("plate", 50),
        ("plate", 100),
        ("plate", 200),
        ("plate", 316),
        ("laplacian", 316),
        ("plate", 500),
        ("laplacian", 1000),
        ("plate", 1000),
    ] {
        if side > most {
            continue;
        }
        let system = if name == "plate" { plate(side) } else { laplacian(side) };
        row(name, side, &system);
        if let Some(folder) = folder {
            export(Path::new(folder), &format!("{name}-{side}.bin"), &system);
        }
    }
}
