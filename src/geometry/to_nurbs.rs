//! Curves and surfaces as rational B-splines, exactly, over a bounded range of their parameters.
//!
//! The NURBS Book: arcs by algorithm A7.1, parabolas and hyperbolas as conics in section 7.5, extrusions in
//! section 8.3, revolutions by algorithm A8.1. The knots run over the given range, but inside a piece of a conic
//! a B-spline counts otherwise than the conic does: points are the same, their parameters only at the ends of
//! pieces. Offsets have no exact form and are refused.

use super::nurbs::{KnotVector, NurbsCurve3, NurbsSurface};
use super::{Composite, Curve, Surface};
use crate::math::{Frame, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Why there is no exact B-spline.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ToNurbsError {
    /// The kind has no exact form as a rational B-spline, or none is offered.
    #[error("a {kind} has no exact form as a rational B-spline")]
    Kind {
        /// Kind of curve or surface.
        kind: &'static str,
    },
    /// The range is empty, not finite, or not within the domain.
    #[error("[{start}, {end}] is no range of the parameter")]
    Range {
        /// First parameter.
        start: f64,
        /// Last parameter.
        end: f64,
    },
}

/// A turn longer than this part of a right angle gets another piece: rounding alone makes no piece more.
const PIECE_SLACK: f64 = 1e-12;

/// Pieces of one conic at most: 2^10 quarter turns.
const MOST_PIECES: f64 = 1024.0;

/// Homogeneous points of a profile.
type Net = Vec<[f64; 4]>;

impl Curve {
    /// The exact B-spline of a piece of the curve, from `range.0` to `range.1`.
    ///
    /// # Errors
    /// See [`ToNurbsError`].
    pub fn to_nurbs(&self, range: (f64, f64)) -> Result<NurbsCurve3, ToNurbsError> {
        let (start, end) = range;
        let bad = ToNurbsError::Range { start, end };
        if !(end > start && (end - start).is_finite()) {
            return Err(bad);
        }
        match self {
            Self::Line { .. } => {
                let ends = [start, end].map(|t| homogeneous(&self.point_at(t), 1.0));
                assembled(1, &[start, end], ends.to_vec()).ok_or(bad)
            }
            Self::Circle { frame, radius } => arc(frame, *radius, *radius, range).ok_or(bad),
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                arc(frame, *semi_axis_1, *semi_axis_2, range).ok_or(bad)
            }
            Self::Parabola { .. } => {
                // Quadratic in the parameter: the polar form's middle point, no weights.
                let (a, d) = (self.point_at(start), self.derivatives(start)[1]);
                let middle = a + d * (0.5 * (end - start));
                let net = [a, middle, self.point_at(end)].map(|p| homogeneous(&p, 1.0));
                assembled(2, &[start, end], net.to_vec()).ok_or(bad)
            }
            Self::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
                hyperbola(frame, *semi_axis, *semi_imaginary_axis, range).ok_or(bad)
            }
            Self::Nurbs(curve) | Self::Polyline(curve) => {
                let (first, last) = curve.domain();
                if first <= start && end <= last {
                    return curve.piece(start, end).map_err(|_| bad);
                }
                Err(bad)
            }
            Self::Trimmed(piece) if piece.forward => piece.basis.to_nurbs(range),
            Self::Trimmed(piece) => {
                let reversed = piece.basis.to_nurbs((-end, -start))?.reversed();
                let knots = reversed.knots();
                let shift = start - knots.domain().0;
                let knots = knots.affine(1.0, shift).map_err(|_| bad.clone())?;
                NurbsCurve3::new(knots, reversed.points().to_vec()).map_err(|_| bad)
            }
            Self::Composite(whole) => composite(whole, range),
            Self::Offset { .. } => Err(ToNurbsError::Kind { kind: self.kind() }),
        }
    }
}

impl Surface {
    /// The exact B-spline of a rectangle of the parameters.
    ///
    /// # Errors
    /// See [`ToNurbsError`].
    pub fn to_nurbs(&self, u: (f64, f64), v: (f64, f64)) -> Result<NurbsSurface, ToNurbsError> {
        for (start, end) in [u, v] {
            if !(end > start && (end - start).is_finite()) {
                return Err(ToNurbsError::Range { start, end });
            }
        }
        match self {
            Self::Plane(frame) => {
                let line = Curve::Line { origin: frame.origin, direction: frame.x };
                extruded(&line.to_nurbs(u)?, &frame.y, v)
            }
            Self::Cylinder { frame, radius } => revolved(frame, &straight(frame, *radius, 0.0), u, v),
            Self::Cone { frame, radius, semi_angle } => {
                revolved(frame, &straight(frame, *radius, semi_angle.tan()), u, v)
            }
            Self::Sphere { frame, radius } => revolved(frame, &meridian(frame, 0.0, *radius), u, v),
            Self::Torus { frame, major_radius, minor_radius } => {
                revolved(frame, &meridian(frame, *major_radius, *minor_radius), u, v)
            }
            Self::LinearExtrusion { curve, direction } => extruded(&curve.to_nurbs(u)?, direction, v),
            Self::Revolution { curve, frame } => revolved(frame, curve, u, v),
            Self::Nurbs(surface) => piece_of(surface, u, v),
            Self::CurveBounded { basis } => basis.to_nurbs(u, v),
            Self::Trimmed { basis, forward: [true, true], .. } => basis.to_nurbs(u, v),
            Self::Offset { .. } | Self::Trimmed { .. } | Self::Composite(_) => {
                Err(ToNurbsError::Kind { kind: self.kind() })
            }
        }
    }
}

/// How the parameter of an exact B-spline follows from that of the curve or surface it was made of.
///
/// Inside a piece of a conic the two differ: for half the opening `h` of the piece and its middle `m` the B-spline
/// counts `tan((x - m) / 2) / tan(h / 2)` of half a piece.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterLine {
    /// The same.
    Same,
    /// Pieces of a turn between these breaks; beyond them the turn goes on, whole turns being the same.
    Turn(Vec<f64>),
    /// One piece of a hyperbola.
    Hyperbola(f64, f64),
    /// The negative of another's image of the negative.
    Reversed(Box<ParameterLine>),
}

impl ParameterLine {
    /// For a B-spline of [`Curve::to_nurbs`] over the same range; `None` where there is none.
    #[must_use]
    pub fn of_curve(curve: &Curve, range: (f64, f64)) -> Option<Self> {
        match curve {
            Curve::Circle { .. } | Curve::Ellipse { .. } => turn_breaks(range).map(Self::Turn),
            Curve::Hyperbola { .. } => Some(Self::Hyperbola(range.0, range.1)),
            Curve::Line { .. } | Curve::Parabola { .. } | Curve::Nurbs(_) | Curve::Polyline(_) => {
                Some(Self::Same)
            }
            Curve::Trimmed(piece) if piece.forward => Self::of_curve(&piece.basis, range),
            Curve::Trimmed(piece) => {
                let inner = Self::of_curve(&piece.basis, (-range.1, -range.0))?;
                Some(if inner == Self::Same { inner } else { Self::Reversed(Box::new(inner)) })
            }
            Curve::Composite(_) | Curve::Offset { .. } => None,
        }
    }

    /// For the B-spline of [`Surface::to_nurbs`] over the same ranges, along `u` and along `v`.
    #[must_use]
    pub fn of_surface(surface: &Surface, u: (f64, f64), v: (f64, f64)) -> Option<[Self; 2]> {
        let turn = |range| turn_breaks(range).map(Self::Turn);
        Some(match surface {
            Surface::Plane(_) | Surface::Nurbs(_) => [Self::Same, Self::Same],
            Surface::Cylinder { .. } | Surface::Cone { .. } => [turn(u)?, Self::Same],
            Surface::Sphere { .. } | Surface::Torus { .. } => [turn(u)?, turn(v)?],
            Surface::LinearExtrusion { curve, .. } => [Self::of_curve(curve, u)?, Self::Same],
            Surface::Revolution { curve, .. } => [turn(u)?, Self::of_curve(curve, v)?],
            Surface::CurveBounded { basis } | Surface::Trimmed { basis, forward: [true, true], .. } => {
                return Self::of_surface(basis, u, v);
            }
            Surface::Trimmed { .. } | Surface::Offset { .. } | Surface::Composite(_) => return None,
        })
    }

    /// The B-spline's parameter, and its derivative by the other.
    #[must_use]
    pub fn image(&self, x: f64) -> (f64, f64) {
        match self {
            Self::Same => (x, 1.0),
            Self::Turn(breaks) => {
                let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
                // Both ends of a full turn are themselves, not each other.
                let within = x >= first - PIECE_SLACK && x <= last + PIECE_SLACK;
                let turns = if within { 0.0 } else { ((x - 0.5 * (first + last)) / TAU).round() };
                let shift = TAU * turns;
                let inside = x - shift;
                let at = breaks.partition_point(|b| *b <= inside).clamp(1, breaks.len() - 1);
                let (m, h) = (0.5 * (breaks[at - 1] + breaks[at]), 0.5 * (breaks[at] - breaks[at - 1]));
                let (half, scale) = (0.5 * (inside - m), h / (0.5 * h).tan());
                let ends = [breaks[at - 1], breaks[at]];
                let image = ends.into_iter().find(|b| *b == inside).unwrap_or(m + scale * half.tan());
                (shift + image, 0.5 * scale / half.cos().powi(2))
            }
            Self::Hyperbola(start, end) => {
                let (m, h) = (0.5 * (start + end), 0.5 * (end - start));
                let (half, scale) = (0.5 * (x - m), h / (0.5 * h).tanh());
                (m + scale * half.tanh(), 0.5 * scale / half.cosh().powi(2))
            }
            Self::Reversed(inner) => {
                let (y, slope) = inner.image(-x);
                (-y, slope)
            }
        }
    }
}

/// The segments that reach into a range, as one curve.
fn composite(whole: &Composite<Curve>, (start, end): (f64, f64)) -> Result<NurbsCurve3, ToNurbsError> {
    let bad = ToNurbsError::Range { start, end };
    let (first, last) = whole.domain();
    if !(first <= start && end <= last) {
        return Err(bad);
    }
    let mut pieces = Vec::new();
    for (segment, breaks) in whole.segments().iter().zip(whole.breaks().windows(2)) {
        let (low, high) = (start.max(breaks[0]), end.min(breaks[1]));
        if low >= high {
            continue;
        }
        let (from, to) = (low - breaks[0], high - breaks[0]);
        pieces.push(if segment.forward {
            segment.curve.to_nurbs((segment.domain.0 + from, segment.domain.0 + to))?
        } else {
            segment.curve.to_nurbs((segment.domain.1 - to, segment.domain.1 - from))?.reversed()
        });
    }
    NurbsCurve3::joined(&pieces, start).map_err(|_| bad)
}

/// `(w x, w y, w z, w)`.
fn homogeneous(point: &Point3<f64>, weight: f64) -> [f64; 4] {
    [point.x * weight, point.y * weight, point.z * weight, weight]
}

/// A curve of pieces of one degree over breaks.
fn assembled(degree: usize, breaks: &[f64], net: Net) -> Option<NurbsCurve3> {
    NurbsCurve3::new(piecewise(degree, breaks)?, net).ok()
}

/// Knots of pieces: each break as often as the degree, the ends once more.
fn piecewise(degree: usize, breaks: &[f64]) -> Option<KnotVector> {
    let last = breaks.len() - 1;
    let multiplicities: Vec<usize> =
        (0..=last).map(|i| if i == 0 || i == last { degree + 1 } else { degree }).collect();
    KnotVector::from_multiplicities(degree, breaks, &multiplicities).ok()
}

/// Breaks of a turn into pieces of a right angle at most.
fn turn_breaks((start, end): (f64, f64)) -> Option<Vec<f64>> {
    let pieces = ((end - start) / FRAC_PI_2 - PIECE_SLACK).ceil().max(1.0);
    if pieces > MOST_PIECES {
        return None;
    }
    let count = pieces as usize;
    let inner = (1..count).map(|i| start + (end - start) * (i as f64 / pieces));
    Some([start].into_iter().chain(inner).chain([end]).collect())
}

/// Cosines and sines of a turn's points with their weights: ends of pieces of weight one and between them the
/// points where the tangents meet (A7.1).
fn turn_net(breaks: &[f64]) -> Vec<[f64; 3]> {
    let mut net = vec![[breaks[0].cos(), breaks[0].sin(), 1.0]];
    for pair in breaks.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        // Weight cos(half) at distance 1 / cos(half): homogeneous coordinates on the circle itself.
        net.push([middle.cos(), middle.sin(), half.cos()]);
        net.push([pair[1].cos(), pair[1].sin(), 1.0]);
    }
    net
}

fn arc(frame: &Frame, a: f64, b: f64, range: (f64, f64)) -> Option<NurbsCurve3> {
    let breaks = turn_breaks(range)?;
    let place = |[cos, sin, w]: [f64; 3]| {
        let p = frame.origin.coords * w + frame.x * (a * cos) + frame.y * (b * sin);
        [p.x, p.y, p.z, w]
    };
    assembled(2, &breaks, turn_net(&breaks).into_iter().map(place).collect())
}

/// As an arc, with hyperbolic functions: the weight in the middle is above one.
fn hyperbola(frame: &Frame, a: f64, b: f64, (start, end): (f64, f64)) -> Option<NurbsCurve3> {
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let place = |t: f64, w: f64| {
        let p = frame.origin.coords * w + frame.x * (a * t.cosh()) + frame.y * (b * t.sinh());
        [p.x, p.y, p.z, w]
    };
    assembled(2, &[start, end], vec![place(start, 1.0), place(middle, half.cosh()), place(end, 1.0)])
}

/// The generatrix of a cylinder or cone, by the length along the axis.
pub(super) fn straight(frame: &Frame, radius: f64, slope: f64) -> Curve {
    Curve::Line { origin: frame.origin + frame.x * radius, direction: frame.x * slope + frame.z }
}

/// The circle that a sphere or torus is turned from, in the plane of the first axis.
pub(super) fn meridian(frame: &Frame, major: f64, minor: f64) -> Curve {
    let origin = frame.origin + frame.x * major;
    Curve::Circle { frame: Frame { origin, x: frame.x, y: frame.z, z: -frame.y }, radius: minor }
}

fn extruded(
    curve: &NurbsCurve3,
    direction: &Vector3<f64>,
    (start, end): (f64, f64),
) -> Result<NurbsSurface, ToNurbsError> {
    let bad = ToNurbsError::Range { start, end };
    let along = |p: &[f64; 4], v: f64| {
        let w = p[3];
        [p[0] + w * v * direction.x, p[1] + w * v * direction.y, p[2] + w * v * direction.z, w]
    };
    let net = curve.points().iter().flat_map(|p| [along(p, start), along(p, end)]).collect();
    let knots = piecewise(1, &[start, end]).ok_or(bad.clone())?;
    NurbsSurface::new(curve.knots().clone(), knots, net).map_err(|_| bad)
}

/// A profile turned about the frame's third axis (A8.1): in homogeneous coordinates the turned points are
/// linear in cosine and sine.
fn revolved(
    frame: &Frame,
    profile: &Curve,
    u: (f64, f64),
    v: (f64, f64),
) -> Result<NurbsSurface, ToNurbsError> {
    let bad = ToNurbsError::Range { start: u.0, end: u.1 };
    let profile = profile.to_nurbs(v)?;
    let breaks = turn_breaks(u).ok_or(bad.clone())?;
    let mut net = Vec::with_capacity(turn_net(&breaks).len() * profile.points().len());
    for [cos, sin, weight] in turn_net(&breaks) {
        for p in profile.points() {
            let arm = Vector3::new(p[0], p[1], p[2]) - frame.origin.coords * p[3];
            let along = frame.z * frame.z.dot(&arm);
            let across = arm - along;
            let turned = across * cos + frame.z.cross(&across) * sin;
            let q = turned + (along + frame.origin.coords * p[3]) * weight;
            net.push([q.x, q.y, q.z, p[3] * weight]);
        }
    }
    let knots = piecewise(2, &breaks).ok_or(bad.clone())?;
    NurbsSurface::new(knots, profile.knots().clone(), net).map_err(|_| bad)
}

/// A rectangle of a B-spline surface, by knots inserted up to the degree and the piece between them.
fn piece_of(surface: &NurbsSurface, u: (f64, f64), v: (f64, f64)) -> Result<NurbsSurface, ToNurbsError> {
    let rows = |surface: &NurbsSurface, (start, end): (f64, f64)| {
        let bad = ToNurbsError::Range { start, end };
        let (first, last) = surface.knots_u().domain();
        if !(first <= start && end <= last) {
            return Err(bad);
        }
        // Each column of the net is a curve along u with the same knots.
        let (nu, nv) = surface.shape();
        let mut columns = Vec::with_capacity(nv);
        for j in 0..nv {
            let points: Net = (0..nu).map(|i| surface.net()[i * nv + j]).collect();
            let column = NurbsCurve3::new(surface.knots_u().clone(), points).map_err(|_| bad.clone())?;
            columns.push(column.piece(start, end).map_err(|_| bad.clone())?);
        }
        let knots = columns[0].knots().clone();
        let net = (0..knots.n_basis()).flat_map(|i| columns.iter().map(move |c| c.points()[i])).collect();
        NurbsSurface::new(knots, surface.knots_v().clone(), net).map_err(|_| bad)
    };
    let cut = rows(surface, u)?.swapped();
    Ok(rows(&cut, v)?.swapped())
}
