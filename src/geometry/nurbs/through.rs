//! Cubics through values at even parameters, periodic and open.
//!
//! Rows of any width: points of a curve, or whole rows of control points that are lofted.

use super::KnotVector;
use super::refine::clamp_rows;
use crate::math::banded::Banded;

/// Pole of the filter that inverts the cubic's values (1, 4, 1) / 6 at its knots.
const POLE: f64 = -0.267_949_192_431_122_7;
/// Powers of the pole that count: the next one is below rounding.
const POWERS: usize = 28;
/// Least count of values: with fewer there is no cubic.
const LEAST: usize = 4;

/// The periodic cubic with the i-th of `n` rows at the parameter `i / n`: clamped knots with `n` even spans over [0, 1],
/// and its `n + 3` control rows, of which the first is the last. Two times continuously differentiable at its ends, too.
///
/// # Panics
/// For fewer than four rows, or a length that is no multiple of the width.
#[must_use]
pub fn periodic_cubic(rows: &[f64], width: usize) -> (KnotVector, Vec<f64>) {
    let n = rows.len() / width;
    assert!(n >= LEAST && rows.len() == n * width, "whole rows, at least four");
    let mut coefficients = vec![0.0; rows.len()];
    for column in 0..width {
        let values: Vec<f64> = (0..n).map(|i| 6.0 * rows[i * width + column]).collect();
        for (i, c) in filtered(&values).into_iter().enumerate() {
            coefficients[i * width + column] = c;
        }
    }
    let knots = (0..n + 7).map(|j| (j as f64 - 3.0) / n as f64).collect();
    let knots = KnotVector::new(3, knots).expect("even knots ascend");
    let turned: Vec<f64> = (0..n + 3)
        .flat_map(|j| (0..width).map(move |c| ((j + n - 1) % n) * width + c))
        .map(|k| coefficients[k])
        .collect();
    let (knots, mut out) = clamp_rows(&knots, &turned, width);
    let (first, rest) = out.split_at_mut(width);
    let at = rest.len() - width;
    // The ends are one point, to the last bit.
    rest[at..].copy_from_slice(first);
    (knots, out)
}

/// Coefficients of the periodic cubic with these values (times 6): one pass along and one back (Unser, Aldroubi and Eden,
/// IEEE Transactions on Signal Processing 41, 1993).
fn filtered(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let powers = || (0..POWERS).map(|k| (k, POLE.powi(k as i32)));
    let mut along = vec![0.0; n];
    along[0] = powers().map(|(k, z)| z * values[(POWERS * n - k) % n]).sum();
    for i in 1..n {
        along[i] = values[i] + POLE * along[i - 1];
    }
    let mut back = vec![0.0; n];
    back[n - 1] = -POLE * powers().map(|(k, z)| z * along[(n - 1 + k) % n]).sum::<f64>();
    for i in (0..n - 1).rev() {
        back[i] = POLE * (back[i + 1] - along[i]);
    }
    back
}

/// The cubic with the i-th of `n` rows at the parameter `i / (n - 1)`, its first two and last two spans one polynomial
/// each: clamped knots over [0, 1] and `n` control rows.
///
/// # Panics
/// As [`periodic_cubic`].
#[must_use]
pub fn open_cubic(rows: &[f64], width: usize) -> (KnotVector, Vec<f64>) {
    let n = rows.len() / width;
    assert!(n >= LEAST && rows.len() == n * width, "whole rows, at least four");
    let place = |i: usize| i as f64 / (n - 1) as f64;
    let mut knots = vec![0.0; 4];
    knots.extend((2..n - 2).map(place));
    knots.extend([1.0; 4]);
    let knots = KnotVector::new(3, knots).expect("even knots ascend");
    let mut matrix = Banded::zeros(n, 3, 3);
    for i in 0..n {
        let basis = knots.basis_derivatives(place(i), 0);
        for (j, value) in basis.values().iter().enumerate().filter(|(_, value)| **value != 0.0) {
            matrix.add(i, basis.first() + j, *value);
        }
    }
    let factor = matrix.factored().expect("places and knots interlace (Schoenberg and Whitney)");
    let mut out = rows.to_vec();
    factor.solve_rows(&mut out, width);
    (knots, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nurbs::NurbsCurve2;
    use std::f64::consts::TAU;

    fn curve((knots, rows): (KnotVector, Vec<f64>)) -> NurbsCurve2 {
        let net = rows.chunks_exact(2).map(|p| [p[0], p[1], 1.0]).collect();
        NurbsCurve2::new(knots, net).expect("a curve")
    }

    #[test]
    fn the_periodic_cubic_passes_through_its_values_and_closes_twice_smoothly() {
        for n in [4, 5, 24, 333] {
            let at = |i: usize| TAU * i as f64 / n as f64;
            let rows: Vec<f64> =
                (0..n).flat_map(|i| [3.0 * at(i).cos(), at(i).sin() + 0.1 * (3.0 * at(i)).cos()]).collect();
            let curve = curve(periodic_cubic(&rows, 2));
            for (i, row) in rows.chunks_exact(2).enumerate() {
                let p = curve.point_at(i as f64 / n as f64);
                assert!((p.x - row[0]).abs() < 1e-13 && (p.y - row[1]).abs() < 1e-13, "{n} {i}");
            }
            let (start, end) = (curve.derivatives(0.0), curve.derivatives(1.0));
            assert_eq!(start[0], end[0]);
            for order in 1..3 {
                let size = (n as f64).powi(order);
                assert!((start[order as usize] - end[order as usize]).norm() < 1e-12 * size, "{n}");
            }
        }
    }

    #[test]
    fn the_periodic_cubic_follows_a_circle_to_fourth_order() {
        let error = |n: usize| {
            let rows: Vec<f64> = (0..n)
                .flat_map(|i| [(TAU * i as f64 / n as f64).cos(), (TAU * i as f64 / n as f64).sin()])
                .collect();
            let curve = curve(periodic_cubic(&rows, 2));
            (0..10 * n)
                .map(|k| (curve.point_at(k as f64 / (10 * n) as f64).coords.norm() - 1.0).abs())
                .fold(0.0, f64::max)
        };
        // The cubic's error against x⁗ h⁴ / 384 (de Boor).
        assert!((error(40) / (TAU / 40.0).powi(4) * 384.0 - 1.0).abs() < 0.05);
        assert!((error(40) / error(80) - 16.0).abs() < 0.5);
    }

    #[test]
    fn the_open_cubic_gives_cubics_back() {
        for n in [4, 5, 9, 120] {
            let f = |t: f64| [1.0 + t - 2.0 * t * t + 3.0 * t * t * t, 5.0 - t.powi(3)];
            let rows: Vec<f64> = (0..n).flat_map(|i| f(i as f64 / (n - 1) as f64)).collect();
            let curve = curve(open_cubic(&rows, 2));
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let p = curve.point_at(t);
                assert!((p.x - f(t)[0]).abs() < 1e-12 && (p.y - f(t)[1]).abs() < 1e-12);
            }
        }
    }
}
