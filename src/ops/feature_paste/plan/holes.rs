//! Holes of a feature: loops of the source face inside the region, carried onto the target as loops of its own.
//!
//! The map of parameters is affine, so that curves in parameters go over exactly; curves in space are laid onto the
//! finished surface, within a tolerance.

use super::super::error::PasteError;
use super::super::settings::ParameterMap;
use crate::brep::{Brep, ParameterLoop};
use crate::geometry::nurbs::{KnotVector, NurbsCurve2, NurbsCurve3, NurbsSurface};
use crate::geometry::{Curve, Curve2d};
use crate::math::{Frame, Point3, Vector3};
use crate::model::ChangeSet;
use crate::model::change_set::NewBound;
use crate::ops::net::spline_form::followed;

/// The edges of a hole in order, each in the parameters of its surface.
pub type Hole = Vec<NurbsCurve2>;

/// Part of a domain within which a point of a curve in parameters is where the loop passes.
const AGREES: f64 = 1e-6;
/// Part of a domain by which a hole may pass its end through rounding.
const PAST_END: f64 = 1e-9;

/// The hole that a traced loop is.
pub(super) fn hole_of(brep: &Brep, traced: &ParameterLoop, surface: &NurbsSurface) -> Hole {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let slack = [AGREES * (u1 - u0), AGREES * (v1 - v0)];
    let points = &traced.points;
    let mut hole = Vec::new();
    let mut at = 0;
    for run in points.chunk_by(|a, b| a.coedge == b.coedge) {
        at += run.len();
        let next = points[at % points.len()];
        let mut along: Vec<[f64; 2]> = run.iter().map(|p| [p.u, p.v]).collect();
        along.push([next.u, next.v]);
        let exact = brep.coedges[run[0].coedge].pcurve.as_ref().and_then(|pcurve| {
            let (first, last) = (run[0].t, run[run.len() - 1].t);
            let ascends = last > first || run.len() == 1;
            let edge = crate::brep::edge_range(brep, brep.coedges[run[0].coedge].edge)?;
            let range = (edge.start.min(edge.end), edge.start.max(edge.end));
            let agrees = run.iter().all(|p| {
                let q = pcurve.point_at(p.t);
                (q.x - p.u).abs() <= slack[0] && (q.y - p.v).abs() <= slack[1]
            });
            let curve = spline(pcurve, range).filter(|_| agrees)?;
            Some(if ascends { curve } else { curve.reversed() })
        });
        hole.extend(exact.or_else(|| through(&along)));
    }
    hole
}

/// A curve in parameters as B-spline over a range; `None` for kinds without an exact form.
fn spline(curve: &Curve2d, (start, end): (f64, f64)) -> Option<NurbsCurve2> {
    match curve {
        Curve2d::Line { origin, direction } => {
            let knots = KnotVector::clamped_uniform(1, 1, start, end).ok()?;
            let point = |t: f64| [origin.x + t * direction.x, origin.y + t * direction.y, 1.0];
            NurbsCurve2::new(knots, vec![point(start), point(end)]).ok()
        }
        Curve2d::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
            let flat = |v: &crate::math::Vector2<f64>| Vector3::new(v.x, v.y, 0.0);
            let frame = Frame {
                origin: Point3::new(center.x, center.y, 0.0),
                x: flat(x),
                y: flat(y),
                z: flat(x).cross(&flat(y)),
            };
            let whole = Curve::Ellipse { frame, semi_axis_1: *semi_axis_1, semi_axis_2: *semi_axis_2 };
            let arc = whole.to_nurbs((start, end)).ok()?;
            let net = arc.points().iter().map(|p| [p[0], p[1], p[3]]).collect();
            NurbsCurve2::new(arc.knots().clone(), net).ok()
        }
        Curve2d::Nurbs(curve) | Curve2d::Polyline(curve) => {
            let (first, last) = curve.knots().domain();
            let (start, end) = (start.max(first), end.min(last));
            if start == first && end == last { Some(curve.clone()) } else { curve.piece(start, end).ok() }
        }
        _ => None,
    }
}

/// A cubic through points, counted by the length of its chords, with the tangents of parabolas through three.
fn through(points: &[[f64; 2]]) -> Option<NurbsCurve2> {
    let mut t = vec![0.0];
    let mut kept = vec![*points.first()?];
    for p in &points[1..] {
        let last = kept[kept.len() - 1];
        let chord = (p[0] - last[0]).hypot(p[1] - last[1]);
        if chord > 0.0 {
            t.push(t[t.len() - 1] + chord);
            kept.push(*p);
        }
    }
    let n = kept.len();
    if n < 2 {
        return None;
    }
    let slope = |i: usize, j: usize| [0, 1].map(|k| (kept[j][k] - kept[i][k]) / (t[j] - t[i]));
    let tangent = |i: usize| {
        if n == 2 {
            return slope(0, 1);
        }
        let m = i.clamp(1, n - 2);
        let (a, b) = (slope(m - 1, m), slope(m, m + 1));
        let (ha, hb) = (t[m] - t[m - 1], t[m + 1] - t[m]);
        [0, 1].map(|k| {
            let bend = (b[k] - a[k]) / (ha + hb);
            // The derivative of the parabola through the three, at the point asked for.
            a[k] + bend * (2.0 * t[i] - t[m - 1] - t[m])
        })
    };
    let index = |x: f64| t.partition_point(|k| *k < x).min(n - 1);
    let at = |x: f64| (kept[index(x)], tangent(index(x)));
    let cubic = followed(&t, &at, &|_, _| 0.0, 0.0)?;
    let net = cubic.points.into_iter().map(|p| [p[0], p[1], 1.0]).collect();
    NurbsCurve2::new(cubic.knots, net).ok()
}

/// A hole in the parameters of the target; moved by whole periods where it goes all round.
///
/// # Errors
/// [`PasteError::HoleOutsideTarget`].
pub(super) fn carried(
    hole: &Hole,
    map: &ParameterMap,
    target: &NurbsSurface,
    round: [bool; 2],
) -> Result<Hole, PasteError> {
    let image = |curve: &NurbsCurve2| {
        let one = |p: &[f64; 3]| {
            let [u, v] = map.apply([p[0] / p[2], p[1] / p[2]]);
            [u * p[2], v * p[2], p[2]]
        };
        NurbsCurve2::new(curve.knots().clone(), curve.points().iter().map(one).collect())
            .map_err(|_| PasteError::HoleOutsideTarget)
    };
    let mut moved: Hole = hole.iter().map(image).collect::<Result<_, _>>()?;
    let (u, v) = target.domain();
    for (k, (low, high)) in [u, v].into_iter().enumerate() {
        let of = |hole: &Hole| {
            let at = hole.iter().flat_map(|c| c.points()).map(|p| p[k] / p[2]);
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b): (f64, f64), x| (a.min(x), b.max(x)))
        };
        let period = high - low;
        let (first, last) = of(&moved);
        if round[k] {
            let way = -period * ((0.5 * (first + last) - low) / period).floor();
            for curve in &mut moved {
                let net = curve.points().iter().map(|p| {
                    let mut q = *p;
                    q[k] += way * p[2];
                    q
                });
                *curve = NurbsCurve2::new(curve.knots().clone(), net.collect())
                    .map_err(|_| PasteError::HoleOutsideTarget)?;
            }
        }
        let (first, last) = of(&moved);
        if first < low - PAST_END * period || last > high + PAST_END * period {
            return Err(PasteError::HoleOutsideTarget);
        }
    }
    Ok(moved)
}

/// Adds the new bound that a hole becomes on the finished surface; `sense` tells whether the face's normal is the
/// surface's. Gives the greatest distance of its curves from the surface, too.
///
/// # Errors
/// [`PasteError::HoleOutsideTarget`].
pub(super) fn bound(
    hole: &Hole,
    surface: &NurbsSurface,
    sense: bool,
    tolerance: f64,
    changes: &mut ChangeSet,
) -> Result<(NewBound, f64), PasteError> {
    let mut edges = Vec::new();
    let mut worst = 0.0_f64;
    for curve in hole {
        let at = |t: f64| {
            let [c, dc, _] = curve.derivatives(t);
            let (point, du, dv) = surface.first_derivatives(c.x, c.y);
            let slope = du * dc.x + dv * dc.y;
            ([point.x, point.y, point.z], [slope.x, slope.y, slope.z])
        };
        let off = |p: [f64; 3], t: f64| (Point3::from(p) - Point3::from(at(t).0)).norm();
        let (breaks, _) = curve.knots().distinct();
        let cubic = followed(&breaks, &at, &off, tolerance).ok_or(PasteError::HoleOutsideTarget)?;
        worst = worst.max(cubic.error);
        let net = cubic.points.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
        let space = NurbsCurve3::new(cubic.knots, net).map_err(|_| PasteError::HoleOutsideTarget)?;
        let start = Point3::from(at(curve.domain().0).0);
        edges.push((Curve::Nurbs(space), Curve2d::Nurbs(curve.clone()), start));
    }
    // A hole runs clockwise as seen against the face's normal.
    let forward = (area(hole) < 0.0) == sense;
    Ok((changes.ring(edges, forward), worst))
}

/// Signed area that a hole encloses in the parameters, by its sampled edges.
fn area(hole: &Hole) -> f64 {
    const SAMPLES: usize = 64;
    let mut points = Vec::new();
    for curve in hole {
        let (start, end) = curve.domain();
        points
            .extend((0..SAMPLES).map(|k| curve.point_at(start + (end - start) * k as f64 / SAMPLES as f64)));
    }
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| 0.5 * (a.x * b.y - a.y * b.x)).sum()
}
