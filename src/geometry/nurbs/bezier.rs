//! Bézier patches: the polynomial pieces of a surface over any rectangle, and what can be made of them exactly.
//!
//! A patch lies in the hull of its control points, so that a bound of those bounds the patch. Every step here is a
//! mean with weights between 0 and 1 of what was there before (but for a piece that is continued beyond its span),
//! so rounding does not grow with the degree. Knows nothing of what the patches are compared for.

use super::degree::blossom;
use super::{KnotVector, NurbsSurface};

/// A piece of a surface over the unit square, in homogeneous control points.
///
/// Control point `(i, j)` stands at `i * (degrees[1] + 1) + j`; `i` runs with the first parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BezierPatch {
    /// Degrees along both parameters.
    pub degrees: [usize; 2],
    /// `(degrees[0] + 1) (degrees[1] + 1)` homogeneous points.
    pub net: Vec<[f64; 4]>,
}

/// Rows of the matrix that makes the control points acting on a span into those of its polynomial over an interval.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Extraction {
    first: usize,
    degree: usize,
    rows: Vec<f64>,
}

impl Extraction {
    /// The polynomial of `span` over `[from, to]`, which may lie beyond the span: there it goes on.
    pub fn new(knots: &KnotVector, span: usize, (from, to): (f64, f64)) -> Self {
        let p = knots.degree();
        let width = p + 1;
        let mut unit = vec![0.0; width * width];
        for k in 0..width {
            unit[k * width + k] = 1.0;
        }
        let mut rows = Vec::with_capacity(width * width);
        let (mut pyramid, mut at) = (vec![0.0; width * width], vec![from; p]);
        for i in 0..width {
            if i > 0 {
                at[p - i] = to;
            }
            blossom(knots, &unit, width, span, &at, &mut pyramid);
            rows.extend_from_slice(&pyramid[p * width..]);
        }
        Self { first: span - p, degree: p, rows }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * (self.degree + 1)..(i + 1) * (self.degree + 1)]
    }
}

impl NurbsSurface {
    /// The piece that two extractions name.
    pub(super) fn bezier(&self, u: &Extraction, v: &Extraction) -> BezierPatch {
        let columns = self.shape().1;
        let degrees = [u.degree, v.degree];
        let mut net = Vec::with_capacity((degrees[0] + 1) * (degrees[1] + 1));
        let mut along = vec![[0.0; 4]; degrees[1] + 1];
        for i in 0..=degrees[0] {
            along.fill([0.0; 4]);
            for (k, factor) in u.row(i).iter().enumerate() {
                let row = &self.net()[(u.first + k) * columns + v.first..][..=degrees[1]];
                for (sum, point) in along.iter_mut().zip(row) {
                    add(sum, *factor, point);
                }
            }
            for j in 0..=degrees[1] {
                let mut sum = [0.0; 4];
                for (factor, point) in v.row(j).iter().zip(&along) {
                    add(&mut sum, *factor, point);
                }
                net.push(sum);
            }
        }
        BezierPatch { degrees, net }
    }
}

impl BezierPatch {
    /// The same patch with at least the given degrees.
    pub fn elevated(&self, degrees: [usize; 2]) -> Self {
        let mut patch = self.clone();
        for (direction, degree) in degrees.into_iter().enumerate() {
            while patch.degrees[direction] < degree {
                patch = patch.elevated_once(direction);
            }
        }
        patch
    }

    fn elevated_once(&self, direction: usize) -> Self {
        let mut degrees = self.degrees;
        degrees[direction] += 1;
        let n = degrees[direction];
        let columns = self.degrees[1] + 1;
        let mut net = Vec::with_capacity((degrees[0] + 1) * (degrees[1] + 1));
        for i in 0..=degrees[0] {
            for j in 0..=degrees[1] {
                let k = [i, j][direction];
                let share = k as f64 / n as f64;
                let stride = [columns, 1][direction];
                let mut sum = [0.0; 4];
                let here = i * columns + j;
                if k < n {
                    add(&mut sum, 1.0 - share, &self.net[here]);
                }
                if k > 0 {
                    add(&mut sum, share, &self.net[here - stride]);
                }
                net.push(sum);
            }
        }
        Self { degrees, net }
    }

    /// The patch at parameters that are bilinear functions over the unit square, with the values `x` and `y` at its
    /// corners `(0, 0)`, `(0, 1)`, `(1, 0)`, `(1, 1)`: de Casteljau's algorithm with polynomials for numbers. Both
    /// degrees of the result are the sum of the patch's.
    pub fn composed(&self, x: &[f64; 4], y: &[f64; 4]) -> Self {
        let [p, q] = self.degrees;
        let column = |j: usize| {
            let points = (0..=p).map(|i| vec![self.net[i * (q + 1) + j]]).collect();
            collapsed(points, 0, x)
        };
        let net = collapsed((0..=q).map(column).collect(), p, y);
        Self { degrees: [p + q; 2], net }
    }
}

/// De Casteljau's algorithm on polynomials of degree `degree` in both directions, at a bilinear function.
fn collapsed(mut level: Vec<Vec<[f64; 4]>>, mut degree: usize, at: &[f64; 4]) -> Vec<[f64; 4]> {
    while level.len() > 1 {
        level = level.windows(2).map(|pair| between(degree, &pair[0], &pair[1], at)).collect();
        degree += 1;
    }
    level.swap_remove(0)
}

/// `(1 - x) a + x b` for a bilinear `x` and polynomials of degree `n` in both directions.
fn between(n: usize, a: &[[f64; 4]], b: &[[f64; 4]], x: &[f64; 4]) -> Vec<[f64; 4]> {
    let width = n + 1;
    let mut out = Vec::with_capacity((width + 1) * (width + 1));
    let shares = |k: usize| {
        let share = k as f64 / width as f64;
        [1.0 - share, share]
    };
    for k in 0..=width {
        for l in 0..=width {
            let (of_k, of_l) = (shares(k), shares(l));
            let mut sum = [0.0; 4];
            for (corner, at) in x.iter().enumerate() {
                let (i, j) = (corner / 2, corner % 2);
                let share = of_k[i] * of_l[j];
                if share > 0.0 {
                    let point = (k - i) * width + l - j;
                    add(&mut sum, share * (1.0 - at), &a[point]);
                    add(&mut sum, share * at, &b[point]);
                }
            }
            out.push(sum);
        }
    }
    out
}

#[inline]
fn add(sum: &mut [f64; 4], factor: f64, point: &[f64; 4]) {
    for (s, c) in sum.iter_mut().zip(point) {
        *s += factor * c;
    }
}

/// The greatest distance of two patches at equal parameters, from above.
///
/// Without weights the difference is a patch whose control points are the differences, once both have the same degrees.
/// With weights, `A / a - B / b = (A b - B a) / (a b)`: numerator and denominator are Bernstein polynomials of the
/// degrees' sums with coefficients `N_k` and `D_k`, and where all `D_k` are positive the quotient is a mean of the
/// points `N_k / D_k`, weighted by the `D_k` times the Bernstein polynomials. So the greatest `|N_k / D_k|` bounds it.
/// Infinite where a weight of the product is not positive.
pub(super) fn distance_bound(a: &BezierPatch, b: &BezierPatch, rational: bool) -> f64 {
    if rational {
        return rational_bound(a, b);
    }
    let degrees = [0, 1].map(|k| a.degrees[k].max(b.degrees[k]));
    let (a, b) = (a.elevated(degrees), b.elevated(degrees));
    let difference = |(p, q): (&[f64; 4], &[f64; 4])| {
        let of = |c: usize| p[c] / p[3] - q[c] / q[3];
        of(0).powi(2) + of(1).powi(2) + of(2).powi(2)
    };
    a.net.iter().zip(&b.net).map(difference).fold(0.0, greater).sqrt()
}

fn rational_bound(a: &BezierPatch, b: &BezierPatch) -> f64 {
    let rows = [0, 1].map(|k| shares_of_product(a.degrees[k], b.degrees[k]));
    let columns = [a.degrees[1] + 1, b.degrees[1] + 1];
    let degrees = [0, 1].map(|k| a.degrees[k] + b.degrees[k]);
    let mut worst = 0.0;
    for k in 0..=degrees[0] {
        for l in 0..=degrees[1] {
            let mut sum = [0.0; 4];
            for &(i, i2, along_u) in &rows[0][k] {
                for &(j, j2, along_v) in &rows[1][l] {
                    let (p, q) = (&a.net[i * columns[0] + j], &b.net[i2 * columns[1] + j2]);
                    let share = along_u * along_v;
                    for c in 0..3 {
                        sum[c] += share * (p[c] * q[3] - q[c] * p[3]);
                    }
                    sum[3] += share * p[3] * q[3];
                }
            }
            if sum[3].is_nan() || sum[3] <= 0.0 {
                return f64::INFINITY;
            }
            let length = (sum[0].powi(2) + sum[1].powi(2) + sum[2].powi(2)).sqrt() / sum[3];
            worst = greater(worst, length);
        }
    }
    worst
}

/// For each coefficient of a product of Bernstein polynomials of degrees `m` and `n`: which coefficients of the factors
/// make it, and their shares, which sum to 1.
fn shares_of_product(m: usize, n: usize) -> Vec<Vec<(usize, usize, f64)>> {
    let of = |k: usize| {
        let pairs = k.saturating_sub(n)..=k.min(m);
        pairs.map(|i| (i, k - i, choose(m, i) * choose(n, k - i) / choose(m + n, k))).collect()
    };
    (0..=m + n).map(of).collect()
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
}

/// The greater of two numbers; not a number is greatest of all.
fn greater(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
