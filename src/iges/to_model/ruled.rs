//! Ruled surfaces (IGES 5.3 section 4.17): straight lines between points of two curves, at equal parts of their lengths
//! (form 0) or of their parameters (form 1).
//!
//! The surface is a B-spline: exact where its lines are those between the exact B-splines of the curves, which holds
//! for lines, splines of equal parameters and arcs of one angle; else one within a tolerance.

use super::approximate::{self, Jet};
use super::curve::Piece;
use super::error::ReadError;
use crate::geometry::nurbs::{JoinError, NurbsCurve3, NurbsSurface};
use crate::geometry::{Curve, ParameterLine};
use crate::math::Point3;
use crate::math::quadrature::gauss_legendre;

/// How far along the two curves a straight line begins and ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// At equal parts of the lengths.
    Length,
    /// At equal parts of the ranges of the parameters.
    Parameter,
}

/// The surface between two curves, and how far it is from the true one; `None` where it is that.
pub(super) fn ruled(
    pieces: [&Piece; 2],
    reversed: bool,
    pace: Pace,
    tolerance: f64,
) -> Result<(NurbsSurface, Option<f64>), ReadError> {
    let mut off = None;
    let [first, second] = if exact(pieces, pace) {
        let [first, second] = pieces.map(|piece| piece.curve.to_nurbs(piece.range));
        [first?, second?]
    } else {
        let [first, second] = pieces.map(|piece| paced(piece, pace, tolerance));
        let ((first, off_first), (second, off_second)) = (first?, second?);
        off = Some(f64::max(off_first, off_second));
        [first, second]
    };
    let second = if reversed { second.reversed() } else { second };
    let surface = NurbsSurface::ruled(&first, &second).map_err(|error| match error {
        JoinError::Knots(error) => error.into(),
        JoinError::Net(error) => error.into(),
        JoinError::Nothing => ReadError::Empty("curves"),
    })?;
    Ok((surface, off))
}

/// Whether the exact B-splines of both curves have their points at the pace that is asked for, or at another that both
/// share, so that the lines are the same.
fn exact([first, second]: [&Piece; 2], pace: Pace) -> bool {
    let angle = |piece: &Piece| match &piece.curve {
        Curve::Circle { .. } => Some(piece.range.1 - piece.range.0),
        _ => None,
    };
    if let (Some(a), Some(b)) = (angle(first), angle(second)) {
        return (a - b).abs() < SAME_ANGLE;
    }
    [first, second].iter().all(|piece| match pace {
        Pace::Length => matches!(piece.curve, Curve::Line { .. }),
        Pace::Parameter => ParameterLine::of_curve(&piece.curve, piece.range) == Some(ParameterLine::Same),
    })
}

/// Difference of angle below which arcs are cut into the same pieces.
const SAME_ANGLE: f64 = 1e-12;

/// A B-spline over `[0, 1]` at the pace.
fn paced(piece: &Piece, pace: Pace, tolerance: f64) -> Result<(NurbsCurve3, f64), ReadError> {
    let (from, to) = piece.range;
    if !((to - from).is_finite() && from < to) {
        return Err(ReadError::EmptyRange { from, to });
    }
    let what = "a ruled surface whose curves are too long for its resolution";
    let breaks = breaks(piece);
    match pace {
        Pace::Parameter => {
            let unit = breaks.iter().map(|t| (t - from) / (to - from)).collect();
            let course = |s: f64| -> Jet {
                let [p, d, _] = piece.curve.derivatives(from + (to - from) * s);
                (Point3::from(p), d * (to - from))
            };
            approximate::hermite(&course, unit, tolerance, what)
        }
        Pace::Length => {
            let way = Way::along(&piece.curve, &breaks);
            let unit = breaks.iter().map(|t| way.part_at(*t)).collect();
            let course = |s: f64| -> Jet {
                let [p, d, _] = piece.curve.derivatives(way.parameter_at(s));
                (Point3::from(p), d * (way.total() / d.norm()))
            };
            approximate::hermite(&course, unit, tolerance, what)
        }
    }
}

/// Parameters between which the curve is smooth, its ends among them.
fn breaks(piece: &Piece) -> Vec<f64> {
    let (from, to) = piece.range;
    let mut breaks = match &piece.curve {
        Curve::Nurbs(curve) | Curve::Polyline(curve) => curve.knots().distinct().0,
        Curve::Composite(whole) => {
            let mut at = 0.0;
            let ends = whole.segments().iter().map(|segment| {
                at += segment.domain.1 - segment.domain.0;
                at
            });
            ends.collect()
        }
        _ => Vec::new(),
    };
    breaks.retain(|t| *t > from && *t < to);
    breaks.insert(0, from);
    breaks.push(to);
    breaks
}

/// The length of a curve by its parameter.
struct Way<'c> {
    curve: &'c Curve,
    /// Ends of the cells within which the length is a quadrature away.
    parameters: Vec<f64>,
    /// Length up to each.
    lengths: Vec<f64>,
    rule: (Vec<f64>, Vec<f64>),
}

/// Cells between two breaks.
const CELLS: u32 = 16;
/// Points of the quadrature of a cell.
const POINTS: usize = 8;
/// Steps of Newton's method for the parameter at a length.
const STEPS: usize = 8;

impl<'c> Way<'c> {
    fn along(curve: &'c Curve, breaks: &[f64]) -> Self {
        let mut parameters = vec![breaks[0]];
        for pair in breaks.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            parameters.extend((1..=CELLS).map(|k| a + (b - a) * f64::from(k) / f64::from(CELLS)));
        }
        let mut way = Self { curve, parameters, lengths: vec![0.0], rule: gauss_legendre(POINTS) };
        let mut total = 0.0;
        for at in 1..way.parameters.len() {
            total += way.length(way.parameters[at - 1], way.parameters[at]);
            way.lengths.push(total);
        }
        way
    }

    fn total(&self) -> f64 {
        self.lengths.last().copied().unwrap_or_default()
    }

    fn length(&self, a: f64, b: f64) -> f64 {
        let speed = |x: &f64| self.curve.derivatives(a + 0.5 * (b - a) * (1.0 + x))[1].norm();
        0.5 * (b - a) * self.rule.0.iter().zip(&self.rule.1).map(|(x, w)| w * speed(x)).sum::<f64>()
    }

    /// Part of the whole length up to a parameter that ends a cell.
    fn part_at(&self, t: f64) -> f64 {
        let at = self.parameters.partition_point(|end| *end < t).min(self.lengths.len() - 1);
        self.lengths[at] / self.total()
    }

    /// The parameter at a part of the whole length.
    fn parameter_at(&self, part: f64) -> f64 {
        let wanted = part * self.total();
        let at = self.lengths.partition_point(|end| *end < wanted).clamp(1, self.lengths.len() - 1);
        let (a, b) = (self.parameters[at - 1], self.parameters[at]);
        let rest = wanted - self.lengths[at - 1];
        let mut t = a + (b - a) * rest / (self.lengths[at] - self.lengths[at - 1]);
        for _ in 0..STEPS {
            let step = (self.length(a, t) - rest) / self.curve.derivatives(t)[1].norm();
            t = (t - step).clamp(a, b);
            if step.abs() <= f64::EPSILON * (b - a) {
                break;
            }
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, Vector3};
    use std::f64::consts::FRAC_PI_2;

    fn arc(radius: f64, z: f64, angle: f64) -> Piece {
        let frame = Frame::from_axis(Point3::new(0.0, 0.0, z), Vector3::z(), Some(Vector3::x()));
        Piece { curve: Curve::Circle { frame: frame.expect("a frame"), radius }, range: (0.0, angle) }
    }

    /// A parabola `(t, t^2, z)` of degree 2, over `[0, 1]`.
    fn parabola(z: f64) -> Piece {
        let frame = Frame::from_axis(Point3::new(0.0, 0.0, z), Vector3::z(), Some(Vector3::y()));
        let curve = Curve::Parabola { frame: frame.expect("a frame"), focal_distance: 0.25 };
        // focal (t^2 y - 2 t x): from (1, 1) to (0, 0).
        Piece { curve, range: (-2.0, 0.0) }
    }

    #[test]
    fn arcs_of_one_angle_give_an_exact_cone() {
        let (surface, off) =
            ruled([&arc(2.0, 0.0, 2.0), &arc(1.0, 3.0, 2.0)], false, Pace::Length, 1e-6).expect("a surface");
        assert_eq!(off, None);
        for k in 0..=10 {
            for j in 0..=10 {
                let p = surface.point(f64::from(k) / 10.0, f64::from(j) / 10.0);
                let radius = 2.0 - p.z / 3.0;
                assert!((p.x.hypot(p.y) - radius).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn an_arc_and_a_line_are_joined_at_equal_parts_of_their_lengths() {
        let line = Piece {
            curve: Curve::Line { origin: Point3::new(5.0, 0.0, 1.0), direction: Vector3::new(0.0, 4.0, 0.0) },
            range: (0.0, 1.0),
        };
        let (surface, off) =
            ruled([&arc(1.0, 0.0, FRAC_PI_2), &line], false, Pace::Length, 1e-9).expect("a surface");
        assert!(off.expect("an approximation") <= 1e-9);
        for k in 0..=20 {
            let s = f64::from(k) / 20.0;
            let angle = FRAC_PI_2 * s;
            assert!((surface.point(s, 0.0) - Point3::new(angle.cos(), angle.sin(), 0.0)).norm() < 2e-9);
            assert!((surface.point(s, 1.0) - Point3::new(5.0, 4.0 * s, 1.0)).norm() < 2e-9);
        }
    }

    #[test]
    fn lengths_are_those_of_the_parabola() {
        // From the vertex: (2 t sqrt(1 + 4 t^2) + asinh 2 t) / 4, at t = 1 and t = 1/2.
        let length = |t: f64| 0.25 * (2.0 * t * (1.0 + 4.0 * t * t).sqrt() + (2.0 * t).asinh());
        let piece = parabola(0.0);
        let way = Way::along(&piece.curve, &[-2.0, 0.0]);
        assert!((way.total() - length(1.0)).abs() < 1e-13);
        let half = way.parameter_at(1.0 - length(0.5) / length(1.0));
        assert!((half + 1.0).abs() < 1e-12, "{half}");
    }

    #[test]
    fn by_length_and_by_parameter_are_different_surfaces() {
        let line = Piece {
            curve: Curve::Line {
                origin: Point3::new(1.0, 1.0, 1.0),
                direction: Vector3::new(-1.0, -1.0, 0.0),
            },
            range: (0.0, 1.0),
        };
        let parabola = parabola(0.0);
        let by = |pace| ruled([&parabola, &line], false, pace, 1e-9).expect("a surface");
        let ((even, off), (given, none)) = (by(Pace::Length), by(Pace::Parameter));
        assert!(off.is_some() && none.is_none());
        // Half the parameter is (1/2, 1/4); half the length is not.
        assert!((given.point(0.5, 0.0) - Point3::new(0.5, 0.25, 0.0)).norm() < 1e-14);
        assert!((even.point(0.5, 0.0) - Point3::new(0.5, 0.25, 0.0)).norm() > 0.05);
    }
}
