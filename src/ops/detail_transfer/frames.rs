//! Frames of least rotation along a curve, by double reflection.
//!
//! Source: Wang, Jüttler, Zheng, Liu, Computation of rotation minimizing frames (2008).

use super::spline::Spline;
use crate::math::{Matrix3, Vector3};

/// Steps between consecutive break points: the error against eight times as many is below 1e-10.
const STEPS: usize = 32;

/// Derivative, relative to the greatest, at which a curve has no direction.
const STANDING: f64 = 1e-9;

/// Frames with the columns tangent, normal, binormal at ascending parameters, from a normal at the first.
///
/// Where the derivative vanishes the nearest tangent before counts.
///
/// # Errors
/// The parameter at which the curve has no direction.
pub(super) fn frames(curve: &Spline, at: &[f64], normal: &Vector3<f64>) -> Result<Vec<Matrix3<f64>>, f64> {
    let Some((&first, &last)) = at.first().zip(at.last()) else { return Ok(Vec::new()) };
    let inner = curve.knots.knots().iter().copied().filter(|&k| first < k && k < last);
    let mut breaks: Vec<f64> = at.iter().copied().chain(inner).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let greatest = breaks.iter().map(|&t| curve.at(t)[1].norm()).fold(0.0, f64::max);
    let tangent = |derivative: Vector3<f64>| {
        let length = derivative.norm();
        (length.is_finite() && length > STANDING * greatest).then(|| derivative / length)
    };
    let [mut point, derivative] = curve.at(first);
    let mut t = tangent(derivative).ok_or(first)?;
    let mut n = across(normal, &t).ok_or(first)?;
    let mut frames = Vec::with_capacity(at.len());
    let mut wanted = at.iter().peekable();
    let mut keep = |x: f64, t: &Vector3<f64>, n: &Vector3<f64>| {
        while wanted.next_if(|&&w| w <= x).is_some() {
            frames.push(Matrix3::from_columns(&[*t, *n, t.cross(n)]));
        }
    };
    keep(first, &t, &n);
    for pair in breaks.windows(2) {
        for step in 1..=STEPS {
            let x = if step == STEPS {
                pair[1]
            } else {
                pair[0] + (pair[1] - pair[0]) * step as f64 / STEPS as f64
            };
            let [next, derivative] = curve.at(x);
            let next_t = tangent(derivative).unwrap_or(t);
            let moved = reflected(&n, &t, &(next - point), &next_t);
            n = across(&moved, &next_t).ok_or(x)?;
            (t, point) = (next_t, next);
        }
        keep(pair[1], &t, &n);
    }
    Ok(frames)
}

/// A normal reflected from one point of a curve to the next.
fn reflected(n: &Vector3<f64>, t: &Vector3<f64>, step: &Vector3<f64>, next: &Vector3<f64>) -> Vector3<f64> {
    let mirror = |v: &Vector3<f64>, plane: &Vector3<f64>| {
        let square = plane.norm_squared();
        if square > 0.0 { v - plane * (2.0 / square * plane.dot(v)) } else { *v }
    };
    let (r, l) = (mirror(n, step), mirror(t, step));
    mirror(&r, &(next - l))
}

/// The part of a direction across another, of length 1.
pub(super) fn across(v: &Vector3<f64>, t: &Vector3<f64>) -> Option<Vector3<f64>> {
    let rest = v - t * t.dot(v);
    let length = rest.norm();
    (length.is_finite() && length > STANDING * v.norm()).then(|| rest / length)
}

/// The coordinate axis that is least aligned with a direction.
pub(super) fn least_aligned(t: &Vector3<f64>) -> Vector3<f64> {
    let axis = (0..3).min_by(|&a, &b| t[a].abs().total_cmp(&t[b].abs())).unwrap_or(0);
    let mut v = Vector3::zeros();
    v[axis] = 1.0;
    v
}
