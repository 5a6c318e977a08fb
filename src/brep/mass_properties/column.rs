//! Integrals along one parameter of a surface, the other held: what the boundary integral is taken of.

use super::Quadrature;
use super::adaptive::Accuracy;
use super::moments::Sums;
use crate::brep::inner_breaks;
use crate::geometry::{Curve, Repetition, Surface};
use crate::math::quadrature::gauss_legendre;
use crate::math::{Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Points that are exact for the integrands of a plane or along a straight generatrix: cubics.
const STRAIGHT: usize = 2;
/// The same along a cone, where the area element grows too.
const TAPERED: usize = 3;
/// Points for a quarter of a turn: the fifth harmonic to rounding.
const QUARTER: usize = 12;
/// Points for a span of a B-spline beyond its degree: exact for the volume, and good for the root in the area.
const BEYOND: usize = 3;
/// Further points where the integrand is no polynomial.
const RATIONAL: usize = 3;
/// Greatest count of points for one span.
const MAX_POINTS: usize = 16;
/// Columns that tell how finely a surface has to be cut.
const PROBES: usize = 5;
/// Parts of one piece at most.
const MAX_PARTS: usize = 32;
/// Greatest count of pieces of one column; a bound for hostile files.
const MAX_PIECES: usize = 1 << 14;

/// Which parameter a column runs along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// `u`, at a `v`.
    U,
    /// `v`, at a `u`.
    V,
}

/// Places and weights of a rule over `[-1, 1]`.
type Rule = Vec<(f64, f64)>;

/// Integrates along one parameter.
pub(super) struct Column<'a> {
    pub(super) surface: &'a Surface,
    pub(super) along: Along,
    reference: Point3<f64>,
    fine: Vec<(f64, f64)>,
    coarse: Vec<(f64, f64)>,
    /// Rules across columns, for whole rectangles.
    across: (Rule, Rule),
    pub(super) breaks: Vec<f64>,
    pub(super) period: Option<f64>,
    /// Where the surface repeats itself; none for kinds that take any parameter.
    repetition: Option<Repetition>,
    pieces: usize,
    /// Even parts that each piece between breaks is cut into.
    parts: usize,
}

impl Along {
    /// The direction across.
    pub(super) fn other(self) -> Self {
        match self {
            Self::U => Self::V,
            Self::V => Self::U,
        }
    }
}

impl<'a> Column<'a> {
    pub(super) fn new(
        surface: &'a Surface,
        along: Along,
        reference: Point3<f64>,
        quadrature: &Quadrature,
    ) -> Self {
        let points = points_of(surface, along).min(quadrature.points);
        let rule = |n: usize| {
            let (x, w) = gauss_legendre(n);
            x.into_iter().zip(w).collect::<Vec<_>>()
        };
        // Rules that are exact need no second opinion.
        let exact = points <= TAPERED;
        let coarse = if exact { Vec::new() } else { rule(points - 2) };
        let periods = surface.periods();
        let period = if along == Along::U { periods.0 } else { periods.1 };
        let endless = matches!(
            surface,
            Surface::Plane(_)
                | Surface::Cylinder { .. }
                | Surface::Cone { .. }
                | Surface::Sphere { .. }
                | Surface::Torus { .. }
        );
        let repetition = (!endless).then(|| surface.repetition());
        let breaks = breaks(surface, along);
        let points_across = points_of(surface, along.other()).min(quadrature.points);
        let across = (rule(points_across), rule(points_across.saturating_sub(2).max(1)));
        let fine = rule(points);
        let pieces = quadrature.pieces;
        Self { surface, along, reference, fine, coarse, across, breaks, period, repetition, pieces, parts: 1 }
    }

    /// Cuts pieces into parts until the rules are at one over a rectangle, as far as some columns in it tell.
    pub(super) fn cut_finely(&mut self, across: (f64, f64), along: (f64, f64), accuracy: &Accuracy) {
        let width = across.1 - across.0;
        let off = |column: &Self| {
            let places = (0..PROBES).map(|i| across.0 + width * ((i as f64 + 0.5) / PROBES as f64));
            let errors = places.map(|at| column.error(at, along.0, along.1) * width);
            errors.map(|error| error.relative(accuracy.size, accuracy.reach)).fold(0.0, f64::max)
        };
        while self.parts < MAX_PARTS && off(self) > accuracy.target {
            self.parts *= 2;
        }
    }

    /// The integral over a rectangle between lines, and how far coarser rules are off there.
    pub(super) fn rectangle(&self, across: (f64, f64), along: (f64, f64)) -> (Sums, Sums) {
        let coarse = if self.coarse.is_empty() { &self.fine } else { &self.coarse };
        let fine = self.tensor(&self.across.0, &self.fine, across, along);
        let other = self.tensor(&self.across.1, coarse, across, along);
        (fine.0, fine.0.error_against(&other.0, &fine.1))
    }

    /// The integral by a rule each way, and that of the integrand's absolute values.
    fn tensor(
        &self,
        rule_across: &[(f64, f64)],
        rule_along: &[(f64, f64)],
        across: (f64, f64),
        along: (f64, f64),
    ) -> (Sums, Sums) {
        let (middle_a, half_a) = (0.5 * (across.0 + across.1), 0.5 * (across.1 - across.0));
        let (middle_b, half_b) = (0.5 * (along.0 + along.1), 0.5 * (along.1 - along.0));
        let at = |rule: &[(f64, f64)], middle: f64, half: f64| -> Vec<f64> {
            rule.iter().map(|&(x, _)| middle + half * x).collect()
        };
        let values =
            self.elements(&at(rule_across, middle_a, half_a), &at(rule_along, middle_b, half_b)).into_iter();
        let weights = rule_across
            .iter()
            .flat_map(|&(_, x)| rule_along.iter().map(move |&(_, y)| x * y * half_a * half_b));
        let (mut sum, mut size) = (Sums::ZERO, Sums::ZERO);
        for (value, weight) in values.zip(weights) {
            sum += value * weight;
            size += value.abs() * weight.abs();
        }
        (sum, size)
    }

    /// As [`element`](Self::element) over a grid, the values along a column together.
    fn elements(&self, across: &[f64], along: &[f64]) -> Vec<Sums> {
        let places = || (0..across.len()).flat_map(|a| (0..along.len()).map(move |b| (a, b)));
        let Surface::Nurbs(nurbs) = self.surface else {
            return places().map(|(a, b)| self.element(across[a], along[b])).collect();
        };
        let v_columns = self.along == Along::V;
        let (us, vs) = if v_columns { (across, along) } else { (along, across) };
        let us: Vec<f64> = us.iter().map(|&u| self.surface.wrapped(u, vs[0]).0).collect();
        let vs: Vec<f64> = vs.iter().map(|&v| self.surface.wrapped(us[0], v).1).collect();
        let places: Vec<[usize; 2]> =
            places().map(|(a, b)| if v_columns { [a, b] } else { [b, a] }).collect();
        let tangents = nurbs.grid_tangents(&us, &vs, &places).into_iter();
        tangents.map(|(point, du, dv)| Sums::at(&(point - self.reference), &du.cross(&dv))).collect()
    }

    /// Point, seen from the reference, and `du × dv`.
    fn element(&self, at: f64, x: f64) -> Sums {
        let (u, v) = if self.along == Along::V { (at, x) } else { (x, at) };
        let (u, v) = self.repetition.map_or((u, v), |repetition| repetition.wrapped(u, v));
        let (point, n): (Point3<f64>, Vector3<f64>) = match self.surface {
            Surface::Nurbs(nurbs) => {
                let (point, du, dv) = nurbs.first_derivatives(u, v);
                (point, du.cross(&dv))
            }
            surface => {
                let d = surface.derivatives(u, v);
                (d.point, d.cross())
            }
        };
        Sums::at(&(point - self.reference), &n)
    }

    /// The integral from one value of the parameter to another, the other parameter held at `at`.
    pub(super) fn integral(&self, at: f64, from: f64, to: f64) -> Sums {
        self.by(&self.fine, at, from, to)
    }

    /// How far a coarser rule is off there.
    pub(super) fn error(&self, at: f64, from: f64, to: f64) -> Sums {
        if self.coarse.is_empty() {
            return Sums::ZERO;
        }
        (self.by(&self.fine, at, from, to) + self.by(&self.coarse, at, from, to) * -1.0).abs()
    }

    fn by(&self, rule: &[(f64, f64)], at: f64, from: f64, to: f64) -> Sums {
        let mut sum = Sums::ZERO;
        let (low, high, sign) = if from <= to { (from, to, 1.0) } else { (to, from, -1.0) };
        let mut start = low;
        let mut stops = vec![low];
        stops.extend(between(&self.breaks, self.period, low, high));
        stops.push(high);
        for &end in &super::thinned(&stops, self.pieces)[1..] {
            let half = 0.5 * (end - start) / self.parts as f64;
            for part in (0..self.parts).filter(|_| half > 0.0) {
                let middle = start + half * (2 * part + 1) as f64;
                for &(x, weight) in rule {
                    sum += self.element(at, middle + half * x) * (weight * half * sign);
                }
            }
            start = end;
        }
        sum
    }
}

/// Values of a periodic list within an interval, ascending.
pub(super) fn between(values: &[f64], period: Option<f64>, low: f64, high: f64) -> Vec<f64> {
    let Some((&first, &last)) = values.first().zip(values.last()) else { return Vec::new() };
    let turns = period.map_or((0.0, 0.0), |p| (((low - last) / p).floor(), ((high - first) / p).ceil()));
    let mut out = Vec::new();
    let mut turn = turns.0;
    while turn <= turns.1 && out.len() < MAX_PIECES {
        let shift = turn * period.unwrap_or(0.0);
        out.extend(values.iter().map(|x| x + shift).filter(|&x| x > low && x < high));
        turn += 1.0;
    }
    out.sort_by(f64::total_cmp);
    out.dedup();
    out
}

/// Points of the rule for one piece between breaks.
fn points_of(surface: &Surface, along: Along) -> usize {
    match (surface, along) {
        (Surface::Plane(_), _) | (Surface::Cylinder { .. } | Surface::LinearExtrusion { .. }, Along::V) => {
            STRAIGHT
        }
        (Surface::Cone { .. }, Along::V) => TAPERED,
        (Surface::Nurbs(nurbs), _) => {
            let knots = if along == Along::U { nurbs.knots_u() } else { nurbs.knots_v() };
            let rational = if nurbs.is_rational() { RATIONAL } else { 0 };
            (knots.degree() + BEYOND + rational).clamp(4, MAX_POINTS)
        }
        (Surface::Trimmed { basis, .. } | Surface::CurveBounded { basis }, _) => {
            points_of(basis, along).max(4)
        }
        _ => QUARTER,
    }
}

/// Values of a parameter where the surface may change its form, over one period of it.
pub(super) fn breaks(surface: &Surface, along: Along) -> Vec<f64> {
    let quarters = || (0..4).map(|i| FRAC_PI_2 * f64::from(i)).collect();
    match (surface, along) {
        (Surface::Plane(_), _)
        | (Surface::Cylinder { .. } | Surface::Cone { .. } | Surface::LinearExtrusion { .. }, Along::V) => {
            Vec::new()
        }
        (Surface::Sphere { .. }, Along::V) => vec![0.0],
        (Surface::Nurbs(nurbs), _) => {
            let knots = if along == Along::U { nurbs.knots_u() } else { nurbs.knots_v() };
            let (low, high) = knots.domain();
            knots.distinct().0.into_iter().filter(|k| (low..=high).contains(k)).collect()
        }
        (Surface::LinearExtrusion { curve, .. }, Along::U) => of_curve(curve),
        (Surface::Revolution { curve, .. }, Along::V) => of_curve(curve),
        (Surface::Offset { basis, .. } | Surface::CurveBounded { basis }, _) => breaks(basis, along),
        (Surface::Trimmed { basis, forward, .. }, _) => {
            let forward = forward[usize::from(along == Along::V)];
            let of_basis = breaks(basis, along);
            if forward { of_basis } else { of_basis.into_iter().rev().map(|x| -x).collect() }
        }
        (Surface::Composite(grid), _) => {
            let count = if along == Along::U { grid.shape().0 } else { grid.shape().1 };
            (0..=count).map(|i| i as f64).collect()
        }
        _ => quarters(),
    }
}

fn of_curve(curve: &Curve) -> Vec<f64> {
    let (low, high) = curve.domain();
    let mut all = inner_breaks(curve, low, high);
    if low.is_finite() && high.is_finite() {
        all.extend([low, high]);
        all.sort_by(f64::total_cmp);
    }
    all
}
