//! The collar round a pasted bump on a cylinder: curvature ratio and error of each engine (specification, 2.12, A11).

use std::f64::consts::PI;

use resurf::geometry::nurbs::NurbsSurface;
use resurf::math::Point3;
use resurf::ops::feature_paste::{Existing, Method, Pasted, Settings};

use super::parts::{cylinder, part, pasted};

const HEIGHT: f64 = 0.6;

fn height(r: f64) -> f64 {
    if r < 0.8 { HEIGHT * (PI * r / 1.6).cos().powi(2) } else { 0.0 }
}

fn bump(spans: usize) -> NurbsSurface {
    part([3, 3], [spans, spans], |x, y| [4.0 * x, 4.0 * y, height((4.0 * x - 2.0).hypot(4.0 * y - 2.0))])
}

/// Greatest mean curvature in the collar, where the bump is flat and the region ends, over that of the target.
fn collar_ratio(result: &Pasted) -> f64 {
    let mut worst = [0.0_f64; 2];
    for i in 0..=160 {
        for j in 0..=160 {
            let x = [f64::from(i) / 160.0, f64::from(j) / 160.0];
            let r = 4.0 * (x[0] - 0.5).hypot(x[1] - 0.5);
            if (1.1..1.95).contains(&r) {
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

/// Greatest distance from the cylinder with a radial bump of the source's own height.
fn ideal_error(result: &Pasted, source: &NurbsSurface) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..=60 {
        for j in 0..=60 {
            let x = [f64::from(i) / 60.0, f64::from(j) / 60.0];
            let at = result.map.apply(x);
            let ground = result.refined.derivatives(at[0], at[1]);
            let ideal: Point3<f64> = ground.point + ground.normal().unwrap() * source.point(x[0], x[1]).z;
            worst = worst.max((result.surface.point(at[0], at[1]) - ideal).norm());
        }
    }
    worst
}

fn run(method: Method, spans: usize) -> (f64, f64) {
    let existing = if method == Method::Displacement { Existing::Keep } else { Existing::Replace };
    let settings = Settings { method: Some(method), existing, ..Settings::new(1e-3) };
    let source = bump(spans);
    let result = pasted(&source, &cylinder(), 0.45, &settings).unwrap();
    (collar_ratio(&result), ideal_error(&result, &source))
}

#[test]
fn a11_the_default_leaves_no_crease_under_refinement() {
    for spans in [18, 36, 72] {
        let (collar, error) = run(Method::Displacement, spans);
        assert!(collar <= 1.05, "{spans} spans: {collar}");
        assert!(error <= 0.003, "{spans} spans: {error}");
    }
}

#[test]
fn the_published_method_creases_and_the_biharmonic_one_does_less() {
    let (poisson, poisson_error) = run(Method::Poisson, 18);
    let (biharmonic, biharmonic_error) = run(Method::Biharmonic, 18);
    assert!(poisson > 4.0 && biharmonic < 2.5, "{poisson}, {biharmonic}");
    assert!(biharmonic_error < poisson_error, "{biharmonic_error}, {poisson_error}");
}
