//! A face on a plane, quadric or swept surface as an exact B-spline: its range of parameters, and its curves in
//! parameters carried over.
//!
//! The points stay; what changes is how a turn is counted inside its quarters. Curves in parameters that stay straight
//! are carried exactly, others become piecewise cubics within a tolerance. Edges are not touched.

use std::collections::BTreeMap;

use super::hermite::followed;
use crate::brep::{CoedgeId, FaceId, ParameterLoop, edge_range};
use crate::geometry::nurbs::{NurbsCurve2, NurbsSurface};
use crate::geometry::{Curve2d, ParameterLine, Surface};
use crate::math::Point2;
use crate::model::Model;

/// Part of a face's range of parameters by which its surface reaches beyond the bounds.
const MARGIN: f64 = 0.02;
/// Part of a turn by which bounds that leave out no more count as going all round.
const FULL: f64 = 1e-9;
/// Tolerance of carried curves as a part of the face's size, at most; and at least, above the rounding of points.
const CARRIED: (f64, f64) = (1e-6, 1e-11);
/// Part of the file's own uncertainty that a carried curve may use up.
const OF_UNCERTAINTY: f64 = 0.1;

/// A surface as B-spline, and how parameters go over.
#[derive(Debug, Clone)]
pub(super) struct Exact {
    /// Over the face and a little more.
    pub surface: NurbsSurface,
    /// From the file's parameters.
    lines: [ParameterLine; 2],
    /// Period in the file's parameters.
    periods: [Option<f64>; 2],
}

/// Tolerance of a curve that is laid onto a surface of this size, in a file of this uncertainty.
#[must_use]
pub fn carry_tolerance(uncertainty: Option<f64>, size: f64) -> f64 {
    let allowed = uncertainty.map_or(f64::INFINITY, |t| OF_UNCERTAINTY * t);
    allowed.clamp(CARRIED.1 * size, CARRIED.0 * size)
}

/// Least and greatest parameters of the loops in one direction.
fn extent(loops: &[ParameterLoop], k: usize) -> Option<(f64, f64)> {
    let at = loops.iter().flat_map(|l| &l.points).map(|p| if k == 0 { p.u } else { p.v });
    at.fold(None, |range: Option<(f64, f64)>, x| {
        let (low, high) = range.unwrap_or((x, x));
        Some((low.min(x), high.max(x)))
    })
}

/// Range of one parameter that the exact surface needs.
fn range(surface: &Surface, loops: &[ParameterLoop], k: usize) -> Option<(f64, f64)> {
    let of = |pair: ((f64, f64), (f64, f64))| if k == 0 { pair.0 } else { pair.1 };
    let domain = of(surface.domain());
    let periods = surface.periods();
    let period = if k == 0 { periods.0 } else { periods.1 };
    let winds = |l: &ParameterLoop| if k == 0 { l.winding.0 != 0.0 } else { l.winding.1 != 0.0 };
    let Some((low, high)) = extent(loops, k) else {
        return (domain.0.is_finite() && domain.1.is_finite()).then_some(domain);
    };
    if let Some(period) = period {
        if loops.iter().any(winds) || high - low >= (1.0 - FULL) * period {
            return Some((low, low + period));
        }
        let beyond = (MARGIN * (high - low)).min(0.5 * (period - (high - low)));
        return Some((low - beyond, high + beyond));
    }
    // A loop all round may have an apex or a pole on its other side.
    let other = |l: &ParameterLoop| if k == 0 { l.winding.1 != 0.0 } else { l.winding.0 != 0.0 };
    let round = loops.iter().any(other) || loops.iter().any(|l| l.points.is_empty());
    if round && domain.0.is_finite() && domain.1.is_finite() {
        return Some(domain);
    }
    let (low, high) = match apex(surface).filter(|_| round && k == 1) {
        Some(apex) => (low.min(apex), high.max(apex)),
        None => (low, high),
    };
    let beyond = MARGIN * (high - low);
    let mut wide = (low - beyond, high + beyond);
    if let Some(apex) = apex(surface).filter(|_| k == 1) {
        // Beyond its apex a cone is another one.
        wide.0 = if low >= apex { wide.0.max(apex) } else { wide.0 };
        wide.1 = if high <= apex { wide.1.min(apex) } else { wide.1 };
    }
    Some((wide.0.max(domain.0), wide.1.min(domain.1)))
}

/// Whether a range goes all round.
fn goes_round(surface: &Surface, range: (f64, f64), k: usize) -> bool {
    let periods = surface.periods();
    let period = if k == 0 { periods.0 } else { periods.1 };
    period.is_some_and(|p| range.1 - range.0 >= (1.0 - FULL) * p)
}

/// A surface that goes all round along `u` ends on the very points where it starts: sine and cosine of a full turn
/// are those of none but for rounding.
fn shut(surface: &NurbsSurface, full: bool) -> NurbsSurface {
    if !full {
        return surface.clone();
    }
    let columns = surface.shape().1;
    let mut net = surface.net().to_vec();
    let last = net.len() - columns;
    net.copy_within(..columns, last);
    NurbsSurface::new(surface.knots_u().clone(), surface.knots_v().clone(), net)
        .unwrap_or_else(|_| surface.clone())
}

fn apex(surface: &Surface) -> Option<f64> {
    match surface {
        Surface::Cone { radius, semi_angle, .. } => Some(-radius / semi_angle.tan()),
        _ => None,
    }
}

impl Exact {
    /// The exact surface of a face with these loops.
    ///
    /// # Errors
    /// Why there is none.
    pub fn of(surface: &Surface, loops: &[ParameterLoop]) -> Result<Self, String> {
        let endless = || "its bounds leave it endless".to_owned();
        let u = range(surface, loops, 0).ok_or_else(endless)?;
        let v = range(surface, loops, 1).ok_or_else(endless)?;
        let spline = surface.to_nurbs(u, v).map_err(|e| e.to_string())?;
        let spline =
            shut(&shut(&spline, goes_round(surface, u, 0)).swapped(), goes_round(surface, v, 1)).swapped();
        let none = || format!("a {} has no exact form as a rational B-spline", surface.kind());
        let lines = ParameterLine::of_surface(surface, u, v).ok_or_else(none)?;
        let (pu, pv) = surface.periods();
        Ok(Self { surface: spline, lines, periods: [pu, pv] })
    }

    /// Parameters of the B-spline, of parameters in the covering plane of the file's.
    pub fn image(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.lines[k].image(at[k]).0)
    }

    /// Greatest stretch of a parameter.
    pub fn slope(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.lines[k].image(at[k]).1)
    }

    /// The face's curves in parameters carried over, and the greatest distance in space that this cost.
    pub fn carried(&self, model: &Model, face: FaceId) -> (BTreeMap<CoedgeId, Curve2d>, f64) {
        if self.lines.iter().all(|line| *line == ParameterLine::Same) {
            return (BTreeMap::new(), 0.0);
        }
        let brep = &model.brep;
        let Some(surface) = brep.surface_of(face).read() else { return (BTreeMap::new(), 0.0) };
        let size = self.surface.bounding_box().diagonal();
        let tolerance = carry_tolerance(model.context_of(face).uncertainty.map(|t| t.0), size);
        let mut worst = 0.0_f64;
        let mut carried = BTreeMap::new();
        for coedge in brep.coedges_of(face) {
            let of = &brep.coedges[coedge];
            let Some(pcurve) = &of.pcurve else { continue };
            let whole = pcurve.domain();
            let range = edge_range(brep, of.edge).map_or(whole, |r| (r.start.min(r.end), r.start.max(r.end)));
            let range = (range.0.max(whole.0), range.1.min(whole.1));
            let one = Carrying { exact: self, surface, pcurve, shift: self.shift(pcurve, range), tolerance };
            let (curve, off) = one.curve(range);
            worst = worst.max(off);
            carried.insert(coedge, curve);
        }
        (carried, worst)
    }

    /// Whole periods that bring the middle of a curve into the surface's range.
    fn shift(&self, pcurve: &Curve2d, range: (f64, f64)) -> [f64; 2] {
        let middle = pcurve.point_at(0.5 * (range.0 + range.1));
        let (u, v) = self.surface.domain();
        [(0, u), (1, v)].map(|(k, (low, high))| {
            let centre = 0.5 * (low + high);
            // A seam lies on an end of the range, and stays on its own.
            let far = (middle[k] - centre).abs() > 0.5 * (high - low) * (1.0 + FULL);
            self.periods[k].filter(|_| far).map_or(0.0, |p| p * ((centre - middle[k]) / p).round())
        })
    }
}

/// One curve in parameters on its way.
struct Carrying<'a> {
    exact: &'a Exact,
    surface: &'a Surface,
    pcurve: &'a Curve2d,
    shift: [f64; 2],
    tolerance: f64,
}

impl Carrying<'_> {
    /// The carried curve over a range, and its greatest distance in space.
    fn curve(&self, range: (f64, f64)) -> (Curve2d, f64) {
        if let Some(line) = self.line() {
            return (line, 0.0);
        }
        let off = |p: [f64; 2], t: f64| {
            let old = self.pcurve.point_at(t);
            (self.exact.surface.point(p[0], p[1]) - self.surface.point(old.x, old.y)).norm()
        };
        let cubic = followed(&[range.0, range.1], &|t| self.at(t), &off, self.tolerance);
        let spline = cubic.and_then(|cubic| {
            let net = cubic.points.iter().map(|p| [p[0], p[1], 1.0]).collect();
            Some((NurbsCurve2::new(cubic.knots, net).ok()?, cubic.error))
        });
        spline.map_or_else(|| (self.pcurve.clone(), f64::INFINITY), |(s, off)| (Curve2d::Nurbs(s), off))
    }

    /// A line stays one where it keeps one parameter, and the other is the same on both surfaces.
    fn line(&self) -> Option<Curve2d> {
        let Curve2d::Line { origin, direction } = self.pcurve else { return None };
        let keeps = |k: usize| direction[k] == 0.0 || self.exact.lines[k] == ParameterLine::Same;
        if !(keeps(0) && keeps(1)) {
            return None;
        }
        let at = self.exact.image([origin.x + self.shift[0], origin.y + self.shift[1]]);
        Some(Curve2d::Line { origin: Point2::new(at[0], at[1]), direction: *direction })
    }

    /// Point and derivative of the carried curve.
    fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let [point, slope, _] = self.pcurve.derivatives(t);
        let from = [point.x + self.shift[0], point.y + self.shift[1]];
        let (to, stretch) = (self.exact.image(from), self.exact.slope(from));
        (to, [slope.x * stretch[0], slope.y * stretch[1]])
    }
}
