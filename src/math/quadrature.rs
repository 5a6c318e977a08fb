//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Steps of Newton's method allowed per node; four suffice from the asymptotic guess.
const MAX_STEPS: usize = 20;

/// Nodes in `(-1, 1)`, ascending, and weights of the `n`-point rule, exact to degree `2 n - 1`.
///
/// Newton's method on the Legendre polynomial by its three-term recurrence; good to a few units in the
/// last place for the counts used here (up to about 100). Empty for `n = 0`.
#[must_use]
pub fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut nodes = vec![0.0; n];
    let mut weights = vec![0.0; n];
    for i in 0..n.div_ceil(2) {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        if 2 * i + 1 == n {
            x = 0.0;
        }
        for _ in 0..MAX_STEPS {
            let (value, slope) = legendre(n, x);
            let step = value / slope;
            x -= step;
            if step.abs() <= f64::EPSILON * x.abs() {
                break;
            }
        }
        let (_, slope) = legendre(n, x);
        let weight = 2.0 / ((1.0 - x * x) * slope * slope);
        nodes[i] = -x;
        nodes[n - 1 - i] = x;
        weights[i] = weight;
        weights[n - 1 - i] = weight;
    }
    (nodes, weights)
}

/// Nodes in `(-1, 1)`, weights of Kronrod's seven-point rule, exact to degree 11, and those of the three-point Gauss
/// rule within it, zero at its other nodes. After A. S. Kronrod; the numbers are those of the closed forms to
/// sixteen digits.
pub const KRONROD_7: [(f64, f64, f64); 7] = [
    (-0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0),
    (-0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0),
    (-0.434_243_749_346_802_56, 0.401_397_414_775_962_2, 0.0),
    (0.0, 0.450_916_538_658_474_1, 8.0 / 9.0),
    (0.434_243_749_346_802_56, 0.401_397_414_775_962_2, 0.0),
    (0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0),
    (0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0),
];

/// Legendre polynomial of degree `n >= 1` and its derivative, `|x| < 1`.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
    }
    let n = n as f64;
    (now, n * (x * now - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_integrate_to_their_closed_form() {
        for n in 1..=26 {
            let (x, w) = gauss_legendre(n);
            for degree in 0..2 * n {
                let sum: f64 = x.iter().zip(&w).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 1 { 0.0 } else { 2.0 / (degree as f64 + 1.0) };
                assert!((sum - exact).abs() < 4e-15, "{n} points, degree {degree}: {sum}");
            }
        }
    }

    #[test]
    fn kronrods_rule_is_exact_to_degree_eleven_and_the_gauss_rule_in_it_to_five() {
        for degree in 0..=11 {
            let exact = if degree % 2 == 1 { 0.0 } else { 2.0 / (f64::from(degree) + 1.0) };
            let kronrod: f64 = KRONROD_7.iter().map(|(x, w, _)| w * x.powi(degree)).sum();
            let gauss: f64 = KRONROD_7.iter().map(|(x, _, w)| w * x.powi(degree)).sum();
            assert!((kronrod - exact).abs() < 1e-15, "degree {degree}: {kronrod}");
            assert!(degree > 5 || (gauss - exact).abs() < 1e-15, "degree {degree}: {gauss}");
        }
    }

    #[test]
    fn two_point_rule_is_one_over_root_three() {
        let (x, w) = gauss_legendre(2);
        assert!((x[1] - 1.0 / 3f64.sqrt()).abs() <= f64::EPSILON && (w[0] - 1.0).abs() < 1e-15);
    }
}
