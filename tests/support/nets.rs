//! Surfaces given by formulas, for the operations that work on nets.

use resurf::geometry::nurbs::{KnotVector, NurbsSurface};

/// Clamped uniform knots on [0, 1], control points `f(x, y)` at the Greville abscissae.
pub fn part(degree: [usize; 2], spans: [usize; 2], f: impl Fn(f64, f64) -> [f64; 3]) -> NurbsSurface {
    weighted_part(degree, spans, f, |_, _| 1.0)
}

/// The same with weights `w(x, y)`.
pub fn weighted_part(
    degree: [usize; 2],
    spans: [usize; 2],
    f: impl Fn(f64, f64) -> [f64; 3],
    w: impl Fn(f64, f64) -> f64,
) -> NurbsSurface {
    let u = KnotVector::clamped_uniform(degree[0], spans[0], 0.0, 1.0).unwrap();
    let v = KnotVector::clamped_uniform(degree[1], spans[1], 0.0, 1.0).unwrap();
    let mut net = Vec::new();
    for x in u.greville() {
        for y in v.greville() {
            let (p, weight) = (f(x, y), w(x, y));
            net.push([p[0] * weight, p[1] * weight, p[2] * weight, weight]);
        }
    }
    NurbsSurface::new(u, v, net).unwrap()
}
