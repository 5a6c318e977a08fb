//! Parameter curves that follow their surface and their edge: exactly where both change by affine maps, else within a
//! tolerance in space by cubic pieces with exact tangents.

use super::carrier::Carrier;
use super::image::{CurveParameter, SurfaceParameters};
use crate::geometry::nurbs::{KnotVector, NurbsCurve2};
use crate::geometry::{Curve2d, ParameterLine, ParameterMap};
use crate::math::{Point2, Vector2};

/// Relative size of a cosine below which axes are at right angles.
const SQUARE: f64 = 1e-12;
/// Pieces of a part between breaks at first, and at most.
const PIECES: usize = 8;
const MOST_PIECES: usize = 512;
/// Samples of a curve between which it may cross a break once.
const CROSSING_SAMPLES: usize = 400;
/// Halvings of an interval around a crossing.
const CROSSING_STEPS: usize = 60;
/// Distance in space that an approximation may add, as a part of the surface's size.
const TOLERANCE: f64 = 1e-10;
/// Part of a range within which two breaks are one.
const SAME: f64 = 1e-9;

/// The image of a parameter curve, over the new parameter of its edge.
///
/// `range` is the edge's, ascending, in its old parameter.
///
/// # Errors
/// A lower-case fragment when there is no image.
pub(super) fn image(
    curve: &Curve2d,
    surface: &SurfaceParameters,
    edge: &CurveParameter,
    range: (f64, f64),
) -> Result<Curve2d, String> {
    match (surface, edge) {
        (SurfaceParameters::Affine(map), CurveParameter::Shift(shift)) => {
            if let Some(image) = affine(curve, map, *shift) {
                return Ok(image);
            }
        }
        (SurfaceParameters::Lines(carrier), _) => {
            if let Some(image) = along_line(curve, &carrier.lines, edge, range) {
                return Ok(image);
            }
        }
        _ => {}
    }
    Fit { curve, surface, edge, range }.image()
}

/// The exact image under affine maps, if it is of a kind that there is.
fn affine(curve: &Curve2d, map: &ParameterMap, shift: f64) -> Option<Curve2d> {
    if shift == 0.0 && map.is_identity() {
        return Some(curve.clone());
    }
    match curve {
        Curve2d::Line { origin, direction } => {
            let at = map.point(&(origin + direction * shift));
            let direction = map.linear * direction;
            (direction.norm() > 0.0).then_some(Curve2d::Line { origin: at, direction })
        }
        Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
            // New conjugate radii; with the shift of the edge they are at right angles again on a plane.
            let (a, b) = (map.linear * x * *semi_axis_1, map.linear * y * *semi_axis_2);
            let (sin, cos) = shift.sin_cos();
            let (a, b) = if shift == 0.0 { (a, b) } else { (a * cos + b * sin, b * cos - a * sin) };
            let (r1, r2) = (a.norm(), b.norm());
            let left = a.x * b.y - a.y * b.x;
            if a.dot(&b).abs() > SQUARE * r1 * r2 || left <= 0.0 {
                return None;
            }
            let x = a / r1;
            let same = (r1 - r2).abs() <= SQUARE * r1;
            let center = map.point(center);
            let y = Vector2::new(-x.y, x.x);
            Some(Curve2d::Ellipse { center, x, y, semi_axis_1: r1, semi_axis_2: if same { r1 } else { r2 } })
        }
        Curve2d::Nurbs(spline) => {
            let knots = spline.knots().affine(1.0, -shift).ok()?;
            let points = spline.points().iter().map(|p| {
                let q = map.linear * Vector2::new(p[0], p[1]) + map.translation * p[2];
                [q.x, q.y, p[2]]
            });
            Some(Curve2d::Nurbs(NurbsCurve2::new(knots, points.collect()).ok()?))
        }
        _ if shift == 0.0 => curve.transformed(map).ok(),
        _ => None,
    }
}

/// The image of a parameter line, or of another straight line along which the parameters stay.
fn along_line(
    curve: &Curve2d,
    lines: &[ParameterLine; 2],
    edge: &CurveParameter,
    range: (f64, f64),
) -> Option<Curve2d> {
    let Curve2d::Line { origin, direction } = curve else { return None };
    let CurveParameter::Shift(shift) = edge else { return None };
    let fixed = |k: usize| direction[k] == 0.0 && lines[1 - k] == ParameterLine::Same;
    let all = lines.iter().all(|line| *line == ParameterLine::Same);
    if !(all || fixed(0) || fixed(1)) {
        return None;
    }
    let start = origin + direction * range.0;
    let at = Point2::new(lines[0].image(start.x).0, lines[1].image(start.y).0);
    Some(Curve2d::Line { origin: at - direction * (range.0 - shift), direction: *direction })
}

/// A parameter curve to fit.
struct Fit<'a> {
    curve: &'a Curve2d,
    surface: &'a SurfaceParameters,
    edge: &'a CurveParameter,
    range: (f64, f64),
}

/// A place on the new curve: parameter, point, derivative by the new parameter.
type Place = (f64, Point2<f64>, Vector2<f64>);

impl Fit<'_> {
    fn at(&self, t: f64) -> Place {
        let (p, d) = (self.curve.point_at(t), self.curve.derivatives(t)[1]);
        let (new_t, speed) = self.edge.image(t);
        let (point, tangent) = match self.surface {
            SurfaceParameters::Affine(map) => (map.point(&p), map.linear * d),
            SurfaceParameters::Lines(carrier) => {
                let ((u, du), (v, dv)) = (carrier.lines[0].image(p.x), carrier.lines[1].image(p.y));
                (Point2::new(u, v), Vector2::new(du * d.x, dv * d.y))
            }
        };
        (new_t, point, tangent / speed)
    }

    fn image(&self) -> Result<Curve2d, String> {
        let breaks = self.breaks();
        let mut pieces = PIECES;
        loop {
            let places = self.places(&breaks, pieces);
            let fitted = hermite(&places).ok_or("its image has no finite points")?;
            if pieces >= MOST_PIECES || self.is_near(&fitted, &breaks, pieces) {
                return Ok(Curve2d::Nurbs(fitted));
            }
            pieces *= 2;
        }
    }

    fn places(&self, breaks: &[f64], pieces: usize) -> Vec<Place> {
        let within = breaks
            .windows(2)
            .flat_map(|w| (0..pieces).map(move |k| w[0] + (w[1] - w[0]) * (k as f64 / pieces as f64)));
        within.chain(breaks.last().copied()).map(|t| self.at(t)).collect()
    }

    /// Whether the middles of all pieces are near enough in space; in parameters where there is no surface to ask.
    fn is_near(&self, fitted: &NurbsCurve2, breaks: &[f64], pieces: usize) -> bool {
        let middles = breaks.windows(2).flat_map(|w| {
            (0..pieces).map(move |k| w[0] + (w[1] - w[0]) * ((k as f64 + 0.5) / pieces as f64))
        });
        let mut middles = middles.map(|t| self.at(t));
        match self.surface {
            SurfaceParameters::Lines(carrier) => {
                let Carrier { surface, .. } = &**carrier;
                let room = TOLERANCE * surface.bounding_box().diagonal();
                middles.all(|(t, p, _)| {
                    let q = fitted.point_at(t);
                    (surface.point(p.x, p.y) - surface.point(q.x, q.y)).norm() <= room
                })
            }
            SurfaceParameters::Affine(_) => {
                let extent = self.extent();
                middles.all(|(t, p, _)| (fitted.point_at(t) - p).norm() <= TOLERANCE * extent)
            }
        }
    }

    fn extent(&self) -> f64 {
        let (a, b) = self.range;
        let points = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| self.at(a + (b - a) * part).1);
        points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max)
    }

    /// Ends of the range, breaks of the parameters that the curve crosses, and its own knots.
    fn breaks(&self) -> Vec<f64> {
        let (a, b) = self.range;
        let mut breaks = vec![a, b];
        if let Curve2d::Nurbs(spline) | Curve2d::Polyline(spline) = self.curve {
            breaks.extend(spline.knots().distinct().0.into_iter().filter(|t| *t > a && *t < b));
        }
        if let SurfaceParameters::Lines(carrier) = self.surface {
            for (k, line) in carrier.lines.iter().enumerate() {
                if let ParameterLine::Turn(values) = line {
                    self.crossings(k, values, &mut breaks);
                }
            }
        }
        if let CurveParameter::Line(ParameterLine::Turn(values)) = self.edge {
            breaks.extend(values.iter().copied().filter(|t| *t > a && *t < b));
        }
        breaks.sort_by(f64::total_cmp);
        let near = SAME * (b - a);
        breaks.dedup_by(|later, earlier| *later - *earlier <= near);
        // The end itself stays, whatever lies near to it.
        breaks.pop();
        breaks.push(b);
        breaks
    }

    /// Parameters at which a coordinate crosses a value.
    fn crossings(&self, k: usize, values: &[f64], into: &mut Vec<f64>) {
        let (a, b) = self.range;
        let coordinate = |t: f64| self.curve.point_at(t)[k];
        let step = (b - a) / CROSSING_SAMPLES as f64;
        for i in 0..CROSSING_SAMPLES {
            let (low, high) = (a + step * i as f64, a + step * (i + 1) as f64);
            let (x, y) = (coordinate(low), coordinate(high));
            for value in values.iter().filter(|v| (x - **v) * (y - **v) < 0.0) {
                let (mut low, mut high) = (low, high);
                for _ in 0..CROSSING_STEPS {
                    let middle = 0.5 * (low + high);
                    if (coordinate(middle) - value) * (x - value) > 0.0 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                into.push(0.5 * (low + high));
            }
        }
    }
}

/// The cubic spline with continuous tangent through places with their derivatives.
fn hermite(places: &[Place]) -> Option<NurbsCurve2> {
    let mut points = vec![weighted(&places[0].1)];
    let mut knots = vec![places[0].0];
    for pair in places.windows(2) {
        let ((t0, p0, d0), (t1, p1, d1)) = (pair[0], pair[1]);
        let third = (t1 - t0) / 3.0;
        points.extend([weighted(&(p0 + d0 * third)), weighted(&(p1 - d1 * third))]);
        knots.push(t1);
    }
    points.push(weighted(&places[places.len() - 1].1));
    let last = knots.len() - 1;
    let counts: Vec<usize> = (0..=last).map(|k| if k == 0 || k == last { 4 } else { 2 }).collect();
    let knots = KnotVector::from_multiplicities(3, &knots, &counts).ok()?;
    NurbsCurve2::new(knots, points).ok()
}

fn weighted(point: &Point2<f64>) -> [f64; 3] {
    [point.x, point.y, 1.0]
}
