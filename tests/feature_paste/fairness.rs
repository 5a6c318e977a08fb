//! A bump on a cylinder by each engine: curvature of the collar round it, and error (specification, 2.12, A11).
//!
//! `cargo bench --bench methods` prints the whole table.

use std::f64::consts::PI;

use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::Point3;
use resurf::ops::feature_paste::{Existing, Method, Pasted, Settings, Turn};

use super::parts::{part, pasted};

const HEIGHT: f64 = 0.6;
/// Radii of the bump and of the contour in the source's parameters.
const BUMP: f64 = 0.25;
const CONTOUR: f64 = 0.42;

fn bump(spans: usize) -> NurbsSurface {
    part([3, 3], [spans, spans], |x, y| {
        let r = ((x - 0.5).hypot(y - 0.5) / BUMP).min(1.0);
        [4.0 * x, 4.0 * y, HEIGHT * (0.5 * PI * r).cos().powi(2)]
    })
}

fn cylinder() -> NurbsSurface {
    part([3, 3], [10, 10], |x, y| {
        let angle = 1.6 * (x - 0.5);
        [6.0 * angle.sin(), 10.0 * (y - 0.5), 6.0 * angle.cos() - 6.0]
    })
}

/// Greatest mean curvature in the collar, where the bump is flat and the region ends, over that of the target.
fn collar_ratio(result: &Pasted, spans: usize) -> f64 {
    // From where the bump's control points cease to act to where those of the region do.
    let reach = 2.0 / spans as f64;
    let mut worst = [0.0_f64; 2];
    for i in 0..=160 {
        for j in 0..=160 {
            let x = [f64::from(i) / 160.0, f64::from(j) / 160.0];
            let r = (x[0] - 0.5).hypot(x[1] - 0.5);
            if (BUMP + reach..CONTOUR + reach).contains(&r) {
                let at = result.map.apply(x);
                for (worst, surface) in worst.iter_mut().zip([&result.surface, &result.refined]) {
                    let (_, mean) = surface.derivatives(at[0], at[1]).curvatures().unwrap();
                    *worst = worst.max(mean.abs());
                }
            }
        }
    }
    worst[0] / worst[1]
}

/// Greatest distance from the cylinder with a radial bump of the source's own height, times the scale.
fn ideal_error(result: &Pasted, source: &NurbsSurface, scale: f64) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..=120 {
        for j in 0..=120 {
            let x = [f64::from(i) / 120.0, f64::from(j) / 120.0];
            let at = result.map.apply(x);
            let ground = result.refined.derivatives(at[0], at[1]);
            let ideal: Point3<f64> =
                ground.point + ground.normal().unwrap() * (scale * source.point(x[0], x[1]).z);
            worst = worst.max((result.surface.point(at[0], at[1]) - ideal).norm());
        }
    }
    worst
}

fn run(method: Method, turn: Turn, spans: usize, scale: f64) -> (f64, f64) {
    let existing = if method == Method::Displacement { Existing::Keep } else { Existing::Replace };
    let settings =
        Settings { method: Some(method), existing, turn, scale: [scale; 3], ..Settings::new(1e-3) };
    let source = bump(spans);
    let result = pasted(&source, &cylinder(), CONTOUR, &settings).unwrap();
    (collar_ratio(&result, spans), ideal_error(&result, &source, scale))
}

#[test]
fn a11_the_default_leaves_no_crease_under_refinement() {
    for spans in [18, 36, 72, 144] {
        for scale in [1.0, 2.0] {
            let (collar, _) = run(Method::Displacement, Turn::Frame, spans, scale);
            assert!(collar <= 1.05, "{spans} spans, scale {scale}: {collar}");
        }
    }
}

/// Errors to the ideal bump as another program measured them on the same parts, to the digits that it gives.
#[test]
fn errors_are_those_of_the_table_or_less() {
    let table = [
        (Method::Poisson, Turn::None, 1.0, 0.0909),
        (Method::Poisson, Turn::Normal, 1.0, 0.0900),
        (Method::Biharmonic, Turn::Frame, 1.0, 0.0317),
        (Method::Biharmonic, Turn::Frame, 2.0, 0.121),
        (Method::Displacement, Turn::Frame, 1.0, 0.0023),
        (Method::Displacement, Turn::Frame, 2.0, 0.0050),
    ];
    for (method, turn, scale, expected) in table {
        let (_, error) = run(method, turn, 18, scale);
        assert!(error < 1.02 * expected && error > 0.9 * expected, "{method:?} {turn:?} {scale}: {error}");
    }
}

#[test]
fn the_published_method_creases_and_the_biharmonic_one_does_less() {
    let (poisson, finer) =
        (run(Method::Poisson, Turn::None, 18, 1.0).0, run(Method::Poisson, Turn::None, 36, 1.0).0);
    let biharmonic = run(Method::Biharmonic, Turn::Frame, 36, 1.0).0;
    assert!(poisson > 4.0 && finer > 1.5 * poisson && biharmonic < 2.5, "{poisson}, {finer}, {biharmonic}");
}
