//! Where the edges of a face cross in its parameter plane: what two facts are about.

use super::limits::Limits;
use super::survey::Survey;
use crate::brep::{Brep, EdgeId, LoopPoint, ParameterLoop};
use crate::geometry::Curve;
use crate::math::Point3;

/// Pairs of chords that are compared on one face at most; a bound for hostile files.
const MAX_PAIRS: usize = 1 << 22;
/// Pairs of chords that cross on one face whose edges are searched at most: edges that run along each other have
/// many.
const MAX_NEAR: usize = 64;
/// Steps towards the point where two edges meet.
const STEPS: usize = 24;
/// Distance from the ends of edges, in tolerances, within which edges may meet.
const AT_ENDS: f64 = 10.0;

/// Part of a chord by which a crossing may miss its ends.
const INSIDE: f64 = 1e-9;
/// Sine of the angle below which edges run along each other: where neighbours leave a vertex side by side, a gap that
/// nobody minds makes them cross far from it.
const ALONG: f64 = 0.05;

/// A chord of a loop's polygon.
struct Chord {
    of: usize,
    from: LoopPoint,
    to: (f64, f64),
    /// Parameter of the edge's curve at the end.
    t_end: f64,
}

/// A place where edges of one loop, or of two, cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// The loops by their index, ascending.
    pub(super) loops: [usize; 2],
    pub(super) place: Point3<f64>,
}

/// Places where the edges of a face cross away from their ends: one for each pair of loops that do.
pub(super) fn crossings(survey: &Survey<'_>, loops: &[ParameterLoop], limits: &Limits) -> Vec<Crossing> {
    // Where vertices are off their edges, these cross beside them.
    let ends = limits.slight.max(AT_ENDS * limits.tolerance);
    let mut chords: Vec<Chord> =
        loops.iter().enumerate().flat_map(|(of, points)| chords_of(survey, of, points)).collect();
    chords.sort_by(|a, b| a.low().total_cmp(&b.low()));
    let mut found: Vec<Crossing> = Vec::new();
    let (mut pairs, mut near) = (0, 0);
    for (i, a) in chords.iter().enumerate() {
        for b in chords[i + 1..].iter().take_while(|b| b.low() <= a.high()) {
            pairs += 1;
            if pairs > MAX_PAIRS {
                return found;
            }
            let Some(crossing) = chords_cross(survey.brep, a, b) else { continue };
            let key = [a.of.min(b.of), a.of.max(b.of)];
            if near >= MAX_NEAR || found.iter().any(|known| known.loops == key) {
                continue;
            }
            // Neighbours share an end; what only touches there does not cross.
            if at_end(survey, &crossing, ends) {
                continue;
            }
            near += 1;
            if let Some(place) = edges_meet(survey, crossing, limits.tolerance, ends) {
                found.push(Crossing { loops: key, place });
            }
        }
    }
    found
}

fn chords_of(survey: &Survey<'_>, of: usize, points: &ParameterLoop) -> Vec<Chord> {
    let mut chords = Vec::new();
    let points = &points.points;
    let mut first = 0;
    for i in 0..points.len().saturating_sub(1) {
        let (from, to) = (points[i], points[i + 1]);
        if from.coedge != points[first].coedge {
            first = i;
        }
        let t_end = if to.coedge == from.coedge {
            to.t
        } else {
            // The chord's end counts by the next edge's parameter; this edge ends where it did not begin.
            let edge = survey.brep.coedges[from.coedge].edge;
            let Some(range) = survey.range(edge) else { continue };
            let began = points[first].t;
            if (began - range.start).abs() <= (began - range.end).abs() { range.end } else { range.start }
        };
        chords.push(Chord { of, from, to: (to.u, to.v), t_end });
    }
    chords
}

impl Chord {
    fn low(&self) -> f64 {
        self.from.u.min(self.to.0)
    }

    fn high(&self) -> f64 {
        self.from.u.max(self.to.0)
    }
}

/// An edge and a parameter on its curve.
type OnEdge = (EdgeId, f64);

/// Where two chords of different edges cross.
fn chords_cross(brep: &Brep, a: &Chord, b: &Chord) -> Option<(OnEdge, OnEdge)> {
    let (a_low, a_high) = (a.from.v.min(a.to.1), a.from.v.max(a.to.1));
    let (b_low, b_high) = (b.from.v.min(b.to.1), b.from.v.max(b.to.1));
    if a_low > b_high || b_low > a_high {
        return None;
    }
    let (edge_a, edge_b) = (brep.coedges[a.from.coedge].edge, brep.coedges[b.from.coedge].edge);
    if edge_a == edge_b {
        return None;
    }
    let (p, r) = ((a.from.u, a.from.v), (a.to.0 - a.from.u, a.to.1 - a.from.v));
    let (q, s) = ((b.from.u, b.from.v), (b.to.0 - b.from.u, b.to.1 - b.from.v));
    let cross = |x: (f64, f64), y: (f64, f64)| x.0 * y.1 - x.1 * y.0;
    let away = (q.0 - p.0, q.1 - p.1);
    let (share_a, share_b) = (cross(away, s) / cross(r, s), cross(away, r) / cross(r, s));
    // Samples may stand where edges cross, so that chords cross at their ends.
    let within = |x: f64| (-INSIDE..=1.0 + INSIDE).contains(&x);
    if !(within(share_a) && within(share_b)) {
        return None;
    }
    let t = a.from.t + share_a * (a.t_end - a.from.t);
    let u = b.from.t + share_b * (b.t_end - b.from.t);
    Some(((edge_a, t), (edge_b, u)))
}

/// Whether two edges that cross at given parameters do so at the ends of one.
fn at_end(survey: &Survey<'_>, (a, b): &(OnEdge, OnEdge), slack: f64) -> bool {
    let brep = survey.brep;
    [a, b].into_iter().any(|&(edge, t)| {
        let Some(curve) = brep.curve_of(edge).read() else { return true };
        let (place, of) = (curve.point_wrapped(t), &brep.edges[edge]);
        let vertices = [of.start, of.end].map(|end| brep.vertices[end].point);
        let points = survey.edge(edge).map_or(&[][..], |sampled| &sampled.points);
        let ends = points.first().into_iter().chain(points.last()).map(|at| at.point);
        vertices.into_iter().chain(ends).any(|end| (end - place).norm() <= slack)
    })
}

/// The point near given parameters where two edges meet away from their ends; chords may cross where curves do
/// not.
fn edges_meet(
    survey: &Survey<'_>,
    (a, b): (OnEdge, OnEdge),
    tolerance: f64,
    ends: f64,
) -> Option<Point3<f64>> {
    let brep = survey.brep;
    let (curve_a, curve_b) = (brep.curve_of(a.0).read()?, brep.curve_of(b.0).read()?);
    let (mut t, mut u) = (a.1, b.1);
    for _ in 0..STEPS {
        u = curve_b.parameter_of(&curve_a.point_wrapped(t), Some(u));
        t = curve_a.parameter_of(&curve_b.point_wrapped(u), Some(t));
    }
    let (p, q) = (curve_a.point_wrapped(t), curve_b.point_wrapped(u));
    let at_end = at_end(survey, &((a.0, t), (b.0, u)), ends);
    let on_edge = |edge: EdgeId, t: f64| {
        survey.range(edge).is_some_and(|r| t >= r.start.min(r.end) && t <= r.start.max(r.end))
    };
    let tangent = |curve: &Curve, t: f64| curve.derivatives(curve.wrapped_parameter(t))[1];
    let (along_a, along_b) = (tangent(curve_a, t), tangent(curve_b, u));
    let crosses = along_a.cross(&along_b).norm() > ALONG * along_a.norm() * along_b.norm();
    let meet = (p - q).norm() <= tolerance && on_edge(a.0, t) && on_edge(b.0, u);
    (meet && crosses && !at_end).then_some(p)
}
