//! Just enough B-splines for the generator: written for clearness, not for speed.

use std::f64::consts::TAU;

use super::records::rounded;

pub type Point = [f64; 3];

/// Clamped knots over [0, 1] with `spans` equal spans.
pub fn clamped(degree: usize, spans: usize) -> Vec<f64> {
    let mut knots = vec![0.0; degree];
    knots.extend((0..=spans).map(|i| i as f64 / spans as f64));
    knots.extend(std::iter::repeat_n(1.0, degree));
    knots
}

/// Greville abscissae: the mean of each `degree` knots in a row.
pub fn greville(knots: &[f64], degree: usize) -> Vec<f64> {
    let n = knots.len() - degree - 1;
    (0..n).map(|i| knots[i + 1..=i + degree].iter().sum::<f64>() / degree as f64).collect()
}

/// Derivative of order `order` of the B-spline `N(i, degree)` at `t`, by the definition.
fn basis(knots: &[f64], degree: usize, i: usize, t: f64, order: usize) -> f64 {
    if degree == 0 {
        let last = knots[knots.len() - 1];
        let at_end = t >= last && knots[i] < last && knots[i + 1] >= last;
        return f64::from(order == 0 && ((knots[i] <= t && t < knots[i + 1]) || at_end));
    }
    let left = knots[i + degree] - knots[i];
    let right = knots[i + degree + 1] - knots[i + 1];
    let lower = |i, order| basis(knots, degree - 1, i, t, order);
    let mut sum = 0.0;
    if left > 0.0 {
        let slope = degree as f64 / left;
        sum += if order > 0 { slope * lower(i, order - 1) } else { (t - knots[i]) / left * lower(i, 0) };
    }
    if right > 0.0 {
        let (slope, end) = (degree as f64 / right, knots[i + degree + 1]);
        sum += if order > 0 { -slope * lower(i + 1, order - 1) } else { (end - t) / right * lower(i + 1, 0) };
    }
    sum
}

/// All B-splines at some places: a row for each place.
pub fn basis_matrix(knots: &[f64], degree: usize, places: &[f64]) -> Vec<Vec<f64>> {
    let n = knots.len() - degree - 1;
    places.iter().map(|&t| (0..n).map(|i| basis(knots, degree, i, t, 0)).collect()).collect()
}

/// Indices of the B-splines that may differ from zero at `t`.
fn support(knots: &[f64], degree: usize, t: f64) -> std::ops::RangeInclusive<usize> {
    let n = knots.len() - degree - 1;
    let span = (degree..n).rev().find(|&i| knots[i] <= t && knots[i] < knots[i + 1]).unwrap_or(degree);
    span - degree..=span
}

/// A B-spline curve.
pub struct Curve {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub points: Vec<Point>,
}

impl Curve {
    pub fn point(&self, t: f64) -> Point {
        let mut sum = [0.0; 3];
        for i in support(&self.knots, self.degree, t) {
            add(&mut sum, &self.points[i], basis(&self.knots, self.degree, i, t, 0));
        }
        sum
    }

    pub fn translated(&self, by: Point) -> Self {
        let points = self.points.iter().map(|p| moved(*p, by)).collect();
        Self { degree: self.degree, knots: self.knots.clone(), points }
    }
}

/// A B-spline surface over [0, 1] x [0, 1]; control point `(i, j)` stands at `i * columns + j`.
pub struct Surface {
    pub degrees: [usize; 2],
    pub knots: [Vec<f64>; 2],
    pub net: Vec<Point>,
}

/// An ellipse in the parameter plane, run through counter-clockwise for `t` from 0 to 2 pi.
#[derive(Clone, Copy)]
pub struct Ellipse {
    pub center: [f64; 2],
    pub semi_axes: [f64; 2],
    /// Angle of the first semi-axis.
    pub rotation: f64,
}

impl Ellipse {
    /// First axis of the ellipse, unit length.
    pub fn axis(&self) -> [f64; 2] {
        [self.rotation.cos(), self.rotation.sin()]
    }

    /// Point and two derivatives at `t`.
    fn derivatives(&self, t: f64) -> [[f64; 2]; 3] {
        let ([a, b], [x, y]) = (self.semi_axes, self.axis());
        let turned = |along: f64, across: f64| [along * x - across * y, along * y + across * x];
        let [du, dv] = turned(a * t.cos(), b * t.sin());
        let first = turned(-a * t.sin(), b * t.cos());
        [[self.center[0] + du, self.center[1] + dv], first, [-du, -dv]]
    }

    /// Where the coordinate `side` of the ellipse meets `value`.
    fn crossings(&self, side: usize, value: f64) -> Vec<f64> {
        let ([a, b], [x, y]) = (self.semi_axes, self.axis());
        let (cosine, sine) = if side == 0 { (a * x, -b * y) } else { (a * y, b * x) };
        let ratio = (value - self.center[side]) / cosine.hypot(sine);
        if ratio.abs() >= 1.0 {
            return Vec::new();
        }
        let (middle, half) = (sine.atan2(cosine), ratio.acos());
        vec![(middle - half).rem_euclid(TAU), (middle + half).rem_euclid(TAU)]
    }
}

impl Surface {
    pub fn columns(&self) -> usize {
        self.knots[1].len() - self.degrees[1] - 1
    }

    pub fn rows(&self) -> usize {
        self.knots[0].len() - self.degrees[0] - 1
    }

    /// The partial derivative of orders `orders`.
    pub fn derivative(&self, at: [f64; 2], orders: [usize; 2]) -> Point {
        let values = |side: usize| -> Vec<(usize, f64)> {
            let (knots, degree) = (&self.knots[side], self.degrees[side]);
            let value = |i| (i, basis(knots, degree, i, at[side], orders[side]));
            support(knots, degree, at[side]).map(value).collect()
        };
        let (along, across) = (values(0), values(1));
        let mut sum = [0.0; 3];
        for (i, a) in &along {
            for (j, b) in &across {
                add(&mut sum, &self.net[i * self.columns() + j], a * b);
            }
        }
        sum
    }

    pub fn translated(&self, by: Point) -> Self {
        let net = self.net.iter().map(|p| moved(*p, by)).collect();
        Self { degrees: self.degrees, knots: self.knots.clone(), net }
    }

    /// The border where parameter `side` is at its start or its end, as an exact curve.
    pub fn border(&self, side: usize, at_end: bool) -> Curve {
        let (rows, columns) = (self.rows(), self.columns());
        let points = if side == 0 {
            let row = if at_end { rows - 1 } else { 0 };
            (0..columns).map(|j| self.net[row * columns + j]).collect()
        } else {
            let column = if at_end { columns - 1 } else { 0 };
            (0..rows).map(|i| self.net[i * columns + column]).collect()
        };
        let other = 1 - side;
        Curve { degree: self.degrees[other], knots: self.knots[other].clone(), points }
    }

    /// Point and two derivatives by `t` of the image of an ellipse.
    fn image(&self, ellipse: &Ellipse, t: f64) -> [Point; 3] {
        let [at, [u1, v1], [u2, v2]] = ellipse.derivatives(t);
        let d = |orders| self.derivative(at, orders);
        let sum = |terms: &[(Point, f64)]| {
            let mut sum = [0.0; 3];
            terms.iter().for_each(|(point, factor)| add(&mut sum, point, *factor));
            sum
        };
        let (su, sv) = (d([1, 0]), d([0, 1]));
        let second =
            [(d([2, 0]), u1 * u1), (d([1, 1]), 2.0 * u1 * v1), (d([0, 2]), v1 * v1), (su, u2), (sv, v2)];
        [d([0, 0]), sum(&[(su, u1), (sv, v1)]), sum(&second)]
    }

    /// A curve of degree 5 beside the image of the ellipse, in the same parameter: position, tangent
    /// and second derivative agree at every break. The breaks include all places where the ellipse
    /// crosses a knot line, so that the image is smooth between them.
    pub fn hole(&self, ellipse: &Ellipse) -> Curve {
        let breaks = self.breaks(ellipse);
        let mut points: Vec<Point> = Vec::new();
        for ends in breaks.windows(2) {
            let h = ends[1] - ends[0];
            let (start, end) = (self.image(ellipse, ends[0]), self.image(ellipse, ends[1]));
            // Bezier points of the quintic with the given derivatives at its ends.
            let b1 = combine(&[(start[0], 1.0), (start[1], h / 5.0)]);
            let b2 = combine(&[(start[0], 1.0), (start[1], 2.0 * h / 5.0), (start[2], h * h / 20.0)]);
            let b3 = combine(&[(end[0], 1.0), (end[1], -2.0 * h / 5.0), (end[2], h * h / 20.0)]);
            let b4 = combine(&[(end[0], 1.0), (end[1], -h / 5.0)]);
            points.extend([start[0], b1, b2, b3, b4]);
        }
        points.push(points[0]);
        smooth_joints(&breaks, &points)
    }

    fn breaks(&self, ellipse: &Ellipse) -> Vec<f64> {
        let mut breaks: Vec<f64> = vec![0.0, TAU];
        for side in 0..2 {
            let inner =
                &self.knots[side][self.degrees[side] + 1..self.knots[side].len() - self.degrees[side] - 1];
            breaks.extend(inner.iter().flat_map(|&knot| ellipse.crossings(side, knot)));
        }
        let step = TAU / HOLE_SPANS as f64;
        for even in (1..HOLE_SPANS).map(|i| i as f64 * step) {
            if breaks.iter().all(|b| (b - even).abs() > 0.4 * step) {
                breaks.push(even);
            }
        }
        breaks.sort_by(f64::total_cmp);
        // Two crossings that nearly coincide (a knot line touched, or a corner of the knot grid) count as one.
        breaks.dedup_by(|b, a| *b - *a < 1e-3 * step);
        breaks.into_iter().map(rounded).map(|t| if (t - TAU).abs() < 1e-6 { TAU } else { t }).collect()
    }

    /// Greatest distance between the image of the ellipse and a curve in the same parameter, at a
    /// thousand places.
    pub fn gap(&self, ellipse: &Ellipse, curve: &Curve) -> f64 {
        let places = (0..=1000).map(|i| TAU * f64::from(i) / 1000.0);
        places
            .map(|t| {
                let (p, q) = (self.image(ellipse, t)[0], curve.point(t));
                (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
            })
            .fold(0.0, f64::max)
    }
}

/// Spans of a hole's edge before the knot lines are added.
const HOLE_SPANS: usize = 64;

/// Bezier quintics that meet with two equal derivatives, as one curve with triple inner knots: of the
/// points b3, b4, (joint), b1, b2 around a joint, knots of multiplicity 3 need three, found by removing
/// the knot twice.
fn smooth_joints(breaks: &[f64], bezier: &[Point]) -> Curve {
    let spans = breaks.len() - 1;
    let mut points = vec![bezier[0], bezier[1], bezier[2]];
    let mut knots = vec![breaks[0]; 6];
    for joint in 1..spans {
        let (h0, h1) = (breaks[joint] - breaks[joint - 1], breaks[joint + 1] - breaks[joint]);
        let at = joint * 5;
        let (b3, b4, b1, b2) = (bezier[at - 2], bezier[at - 1], bezier[at + 1], bezier[at + 2]);
        // b4 lies on b3..c, b1 on c..b2, both in the ratio of the spans; the two guesses agree but for rounding.
        let left = combine(&[(b3, -h1 / h0), (b4, (h0 + h1) / h0)]);
        let right = combine(&[(b2, -h0 / h1), (b1, (h0 + h1) / h1)]);
        points.extend([b3, combine(&[(left, 0.5), (right, 0.5)]), b2]);
        knots.extend([breaks[joint]; 3]);
    }
    let end = bezier.len() - 1;
    points.extend([bezier[end - 2], bezier[end - 1], bezier[end]]);
    knots.extend([breaks[spans]; 6]);
    let points = points.into_iter().map(|p| p.map(rounded)).collect();
    Curve { degree: 5, knots, points }
}

fn add(sum: &mut Point, point: &Point, factor: f64) {
    (0..3).for_each(|k| sum[k] += factor * point[k]);
}

fn combine(terms: &[(Point, f64)]) -> Point {
    let mut sum = [0.0; 3];
    terms.iter().for_each(|(point, factor)| add(&mut sum, point, *factor));
    sum
}

fn moved(point: Point, by: Point) -> Point {
    [0, 1, 2].map(|k| rounded(point[k] + by[k]))
}
