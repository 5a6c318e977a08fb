//! Piecewise cubics through the points and tangents of a curve that is known by evaluation, refined until they follow it.

use crate::geometry::nurbs::KnotVector;

/// Times that a piece may be halved.
const MAX_HALVINGS: u32 = 12;
/// Inner places of a piece at which it is compared.
const COMPARED: [f64; 3] = [0.25, 0.5, 0.75];

/// Point and derivative of a curve at a parameter.
pub type Evaluate<'a, const N: usize> = &'a dyn Fn(f64) -> ([f64; N], [f64; N]);

/// A piecewise cubic: knots and points.
#[derive(Debug, Clone)]
pub struct Cubic<const N: usize> {
    /// Knots.
    pub knots: KnotVector,
    /// Points.
    pub points: Vec<[f64; N]>,
    /// Greatest deviation met.
    pub error: f64,
}

/// Follows a curve from break to break; `off` measures the distance of a point from where the curve is at a parameter.
///
/// `None` for breaks that do not ascend.
#[must_use]
pub fn followed<const N: usize>(
    breaks: &[f64],
    at: Evaluate<'_, N>,
    off: &dyn Fn([f64; N], f64) -> f64,
    tolerance: f64,
) -> Option<Cubic<N>> {
    let mut kept = vec![*breaks.first()?];
    let mut error = 0.0_f64;
    let mut open: Vec<(f64, u32)> = breaks[1..].iter().rev().map(|&b| (b, 0)).collect();
    while let Some((end, halvings)) = open.pop() {
        let start = kept[kept.len() - 1];
        let net = piece(at, start, end);
        let deviation = |s: f64| off(cubic(&net, s), start + s * (end - start));
        let worst = COMPARED.into_iter().map(deviation).fold(0.0, f64::max);
        if worst > tolerance && halvings < MAX_HALVINGS {
            open.push((end, halvings + 1));
            open.push((0.5 * (start + end), halvings + 1));
        } else {
            error = error.max(worst);
            kept.push(end);
        }
    }
    let last = kept.len() - 1;
    let counts: Vec<usize> = (0..=last).map(|k| if k == 0 || k == last { 4 } else { 2 }).collect();
    let knots = KnotVector::from_multiplicities(3, &kept, &counts).ok()?;
    let mut points = vec![at(kept[0]).0];
    for pair in kept.windows(2) {
        let [_, b, c, _] = piece(at, pair[0], pair[1]);
        points.extend([b, c]);
    }
    points.push(at(kept[last]).0);
    Some(Cubic { knots, points, error })
}

/// Bezier points of the cubic with a piece's ends and end tangents.
fn piece<const N: usize>(at: Evaluate<'_, N>, start: f64, end: f64) -> [[f64; N]; 4] {
    let ((a, da), (b, db)) = (at(start), at(end));
    let third = (end - start) / 3.0;
    let step = |p: [f64; N], d: [f64; N], by: f64| std::array::from_fn(|k| p[k] + by * d[k]);
    // An inner break belongs to two pieces with one tangent each: the derivative there is the one behind it.
    [a, step(a, da, third), step(b, db, -third), b]
}

fn cubic<const N: usize>(net: &[[f64; N]; 4], s: f64) -> [f64; N] {
    let r = 1.0 - s;
    let weights = [r * r * r, 3.0 * r * r * s, 3.0 * r * s * s, s * s * s];
    std::array::from_fn(|k| net.iter().zip(weights).map(|(p, w)| p[k] * w).sum())
}
