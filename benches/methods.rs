//! The methods of pasting side by side: a round bump on a part of a cylinder, against the cylinder with a radial bump.
//!
//! `cargo bench --bench methods` prints the tables of `docs/benchmarks.md`. The collar is where the bump has ended and
//! the region has not: its greatest mean curvature over the target's says what a reader of reflections sees.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark that cannot go on stops"
)]

use std::f64::consts::{FRAC_PI_2, TAU};

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};
use resurf::ops::feature_paste::{
    EdgeWeights, Existing, Feature, Ground, Method, Pasted, Settings, Turn, paste,
};

const HEIGHT: f64 = 0.6;
/// Radii of the bump and of the contour in the parameters of the source, which is 4 by 4.
const BUMP: f64 = 0.25;
const CONTOUR: f64 = 0.42;

fn part(spans: [usize; 2], f: impl Fn(f64, f64) -> [f64; 3]) -> NurbsSurface {
    let knots = spans.map(|count| KnotVector::clamped_uniform(3, count, 0.0, 1.0).unwrap());
    let [u, v] = knots.each_ref().map(KnotVector::greville);
    let point = |[x, y, z]: [f64; 3]| [x, y, z, 1.0];
    let net = u.iter().flat_map(|&x| v.iter().map(move |&y| (x, y))).map(|(x, y)| point(f(x, y))).collect();
    let [u, v] = knots;
    NurbsSurface::new(u, v, net).unwrap()
}

fn bump(spans: usize) -> NurbsSurface {
    part([spans, spans], |x, y| {
        let r = (x - 0.5).hypot(y - 0.5) / BUMP;
        let height = if r < 1.0 { HEIGHT * (FRAC_PI_2 * r).cos().powi(2) } else { 0.0 };
        [4.0 * x, 4.0 * y, height]
    })
}

fn cylinder() -> NurbsSurface {
    part([10, 10], |x, y| {
        let angle = 1.6 * (x - 0.5);
        [6.0 * angle.sin(), 10.0 * (y - 0.5), 6.0 * angle.cos() - 6.0]
    })
}

/// Figures of one paste.
struct Figures {
    collar: f64,
    peak: f64,
    greatest: f64,
    mean_square: f64,
}

/// Radii of the collar: from where the bump's control points cease to act to where those of the region do.
fn collar(source: &NurbsSurface) -> std::ops::Range<f64> {
    let span = 1.0 / source.knots_u().spans().count() as f64;
    BUMP + 2.0 * span..CONTOUR + 2.0 * span
}

fn figures(source: &NurbsSurface, scale: f64, result: &Pasted) -> Figures {
    let collar = collar(source);
    let (mut bent, mut peak, mut greatest, mut sum, mut count) = ([0.0_f64; 2], 0.0_f64, 0.0_f64, 0.0, 0.0);
    for i in 0..=240 {
        for j in 0..=240 {
            let x = [f64::from(i) / 240.0, f64::from(j) / 240.0];
            let at = result.map.apply(x);
            let (new, ground) =
                (result.surface.derivatives(at[0], at[1]), result.refined.derivatives(at[0], at[1]));
            let normal = ground.normal().unwrap();
            let height = source.point(x[0], x[1]).z;
            let off = (new.point - (ground.point + normal * (scale * height))).norm();
            greatest = greatest.max(off);
            sum += off * off;
            count += 1.0;
            peak = peak.max(normal.dot(&(new.point - ground.point)) / (HEIGHT * scale));
            let r = (x[0] - 0.5).hypot(x[1] - 0.5);
            if collar.contains(&r) {
                for (most, of) in bent.iter_mut().zip([&new, &ground]) {
                    *most = most.max(of.curvatures().unwrap().1.abs());
                }
            }
        }
    }
    Figures { collar: bent[0] / bent[1], peak, greatest, mean_square: (sum / count).sqrt() }
}

fn pasted(source: &NurbsSurface, scale: f64, settings: &Settings) -> Pasted {
    let target = cylinder();
    let vertex = |k: u32| {
        let t = TAU * f64::from(k) / 64.0;
        [0.5 + CONTOUR * t.cos(), 0.5 + CONTOUR * t.sin()]
    };
    let contour: Vec<[f64; 2]> = (0..64).map(vertex).collect();
    let settings = Settings { scale: [scale; 3], ..settings.clone() };
    let feature = Feature { source, contour: &contour, anchor: [0.5, 0.5] };
    paste(&feature, &Ground { target: &target, at: [0.5, 0.5] }, &settings).unwrap()
}

fn main() {
    let by = |method: Method| Settings { method: Some(method), ..Settings::new(1e-4) };
    let replacing = |method: Method| Settings { existing: Existing::Replace, ..by(method) };
    let published = Settings { edge_weights: EdgeWeights::Uniform, ..replacing(Method::Poisson) };
    let methods = [
        ("poisson, as published", Settings { turn: Turn::None, ..published.clone() }),
        ("poisson, turned by normals, as published", Settings { turn: Turn::Normal, ..published }),
        ("poisson, frames, finite volumes", replacing(Method::Poisson)),
        (
            "poisson, frames, mixed gradients",
            Settings { existing: Existing::Stronger, ..by(Method::Poisson) },
        ),
        ("biharmonic", replacing(Method::Biharmonic)),
        ("displacement (default)", by(Method::Displacement)),
        ("fit, within 1e-4", by(Method::Fit)),
    ];
    println!("| method | scale | collar | peak | greatest error | rms error |\n|---|---|---|---|---|---|");
    for (name, settings) in &methods {
        for scale in [1.0, 2.0] {
            let source = bump(18);
            let f = figures(&source, scale, &pasted(&source, scale, settings));
            println!(
                "| {name} | {scale} | {:.2} | {:.3} | {:.4} | {:.4} |",
                f.collar, f.peak, f.greatest, f.mean_square
            );
        }
    }
    println!("\n| collar over spans of the source | 18 | 36 | 72 |\n|---|---|---|---|");
    for (name, settings) in &methods {
        let collar = |spans: usize| {
            let source = bump(spans);
            format!("{:.2}", figures(&source, 1.0, &pasted(&source, 1.0, settings)).collar)
        };
        println!("| {name} | {} |", [18, 36, 72].map(collar).join(" | "));
    }
}
