//! Loops of a face as polygons in the parameter plane, over the shared points of the edges.

use super::region::{Corner, Shape};
use super::{TessellateError, Tolerances, Wrapped};
use crate::brep::{
    Brep, EdgeId, EdgePoint, FaceId, LoopPoint, LoopSampling, ParameterLoop, parameter_loops_with,
};
use crate::geometry::Surface;
use crate::math::Point3;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Samples of an edge from its start to its end, and their vertices in the mesh.
#[derive(Debug, Clone)]
pub(super) struct SharedEdge {
    pub samples: Vec<EdgePoint>,
    pub vertices: Vec<u32>,
}

/// Times that a piece of a cut is halved at most.
const CUT_DEPTH: u32 = 8;

/// Share of the chord tolerance within which a pcurve must agree with its edge to be followed, and a
/// parameter line counts as a pole.
const AGREEMENT: f64 = 0.1;

/// What the loops of a face need to know, and the count of its own vertices.
pub(super) struct Context<'a> {
    pub brep: &'a Brep,
    pub face: FaceId,
    pub surface: &'a Wrapped<'a>,
    pub tolerances: &'a Tolerances,
    pub edges: &'a BTreeMap<EdgeId, SharedEdge>,
    /// Vertices that are loops on their own.
    pub vertex_loops: &'a [Corner],
    /// Count of vertices that this face alone has, on cuts and at poles.
    pub own: u32,
}

/// Vertices from here on belong to one face: the count above it within the face.
pub(super) const OWN: u32 = 1 << 31;

impl Context<'_> {
    /// A new vertex of this face alone.
    fn push(&mut self) -> u32 {
        self.own += 1;
        OWN | (self.own - 1)
    }
}

/// Loops of a face in one sheet of the parameter plane; loops that wind around a closed surface are cut
/// open and joined to one polygon.
pub(super) fn loops(context: &mut Context) -> Result<Vec<Vec<Corner>>, TessellateError> {
    let (brep, face, edges) = (context.brep, context.face, context.edges);
    let sampling = LoopSampling::of_tolerance(AGREEMENT * context.tolerances.chord);
    let samples = |edge: EdgeId| edges.get(&edge).map(|shared| Cow::Borrowed(shared.samples.as_slice()));
    let found = parameter_loops_with(brep, face, &sampling, &samples)
        .map_err(|source| TessellateError::Bounds { face, source })?;
    // Places between the samples only tell the way, and are no vertices.
    let corners =
        |l: &ParameterLoop| l.points.iter().filter_map(|p| corner(brep, p, edges)).collect::<Vec<_>>();
    let mut loops = Vec::with_capacity(found.len());
    let mut winding = Vec::new();
    for parameter_loop in &found {
        let mut corners = corners(parameter_loop);
        let turns = [parameter_loop.winding.0, parameter_loop.winding.1];
        spread(&mut corners);
        let [Some(first), Some(last)] = [corners.first(), corners.last()] else { continue };
        if turns == [0.0; 2] || first.vertex == last.vertex {
            // A loop that starts at a pole stands there with both parameters: it is closed as it is.
            loops.push(corners);
        } else if let Some(pole) = corners.windows(2).position(|pair| pair[0].vertex == pair[1].vertex) {
            // The way out of a pole may be counted a turn off, which shows only where the loop ends.
            let back = turns.map(|turn| -turn);
            let (before, after) = corners.split_at(pole + 1);
            loops.push(before.iter().copied().chain(after.iter().map(|c| moved(c, back))).collect());
        } else {
            winding.push(Winding { corners, turns });
        }
    }
    let polygon = match <[Winding; 2]>::try_from(winding) {
        Ok([first, second]) => band(context, first, second, &loops),
        Err(mut winding) => match (winding.pop(), winding.is_empty()) {
            (None, _) if needs_border(context, &loops) => whole(context),
            (None, _) => return Ok(loops),
            (Some(only), true) => cap(context, only, &loops),
            (Some(_), false) => None,
        },
    };
    let polygon = polygon.ok_or(TessellateError::WindingBounds { face })?;
    gather(&mut loops, &polygon, context.surface);
    loops.push(polygon);
    Ok(loops)
}

/// A loop that runs once around a closed surface.
struct Winding {
    corners: Vec<Corner>,
    /// Whole periods from its start to its end.
    turns: [f64; 2],
}

impl Winding {
    /// The parameter in which it runs around.
    fn along(&self) -> usize {
        usize::from(self.turns[1].abs() > self.turns[0].abs())
    }

    /// Starts at another of its corners.
    fn start_at(&mut self, corner: usize) {
        let turns = self.turns;
        self.corners.rotate_left(corner);
        let count = self.corners.len();
        for at in &mut self.corners[count - corner..] {
            *at = moved(at, turns);
        }
    }

    /// Its sides, and those of other loops, over the turns before and after, for the question what a cut meets.
    fn walls(&self, others: &[&[Corner]], closed: &[Vec<Corner>]) -> Vec<[[f64; 2]; 2]> {
        let mut walls = Vec::new();
        let open = others.iter().map(|corners| (*corners, self.turns));
        let open = std::iter::once((self.corners.as_slice(), self.turns)).chain(open);
        let closed = closed.iter().map(|corners| (corners.as_slice(), [0.0; 2]));
        for (corners, turns) in open.chain(closed) {
            let Some(first) = corners.first() else { continue };
            // A loop that winds the other way closes a turn back.
            let onward = corners.last().map_or(turns, |last| {
                let far = |sign: f64| {
                    (0..2).map(|k| (first.uv[k] + sign * turns[k] - last.uv[k]).powi(2)).sum::<f64>()
                };
                if far(1.0) <= far(-1.0) { turns } else { turns.map(|t| -t) }
            });
            let end = moved(first, onward);
            let ends = corners.iter().skip(1).chain([&end]);
            for (a, b) in corners.iter().zip(ends) {
                for count in -TURNS..=TURNS {
                    let by = self.turns.map(|turn| turn * f64::from(count));
                    walls.push([moved(a, by).uv, moved(b, by).uv]);
                }
            }
        }
        walls
    }
}

/// Turns before and after the one at hand over which loops are looked at: a loop may begin a turn off, and
/// lean over another.
const TURNS: i32 = 2;

/// Candidates for a cut that are tried, the nearest first.
const CUTS: usize = 64;

/// Whether a cut meets no wall but at its ends.
fn is_clear(from: [f64; 2], to: [f64; 2], walls: &[[[f64; 2]; 2]]) -> bool {
    let side =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    walls.iter().all(|[a, b]| {
        let shared = |p: [f64; 2]| p == *a || p == *b;
        let (fa, fb) = (side(from, to, *a), side(from, to, *b));
        let (wf, wt) = (side(*a, *b, from), side(*a, *b, to));
        match (shared(from), shared(to)) {
            (false, false) => fa * fb > 0.0 || wf * wt > 0.0,
            // From a common end only a wall in line and in the same direction is met.
            _ => {
                fa != 0.0 || fb != 0.0 || {
                    let (end, other) = if shared(from) { (from, to) } else { (to, from) };
                    let far = if end == *a { b } else { a };
                    (0..2).map(|k| (far[k] - end[k]) * (other[k] - end[k])).sum::<f64>() <= 0.0
                }
            }
        }
    })
}

/// Least and greatest of one parameter.
fn range(corners: &[Corner], along: usize) -> (f64, f64) {
    let all = corners.iter().map(|corner| corner.uv[along]);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
}

/// Moves loops by whole turns to where they lie in the polygon that was cut out of the covering plane.
fn gather(loops: &mut [Vec<Corner>], polygon: &[Corner], surface: &Wrapped) {
    let turns = surface.turns.map(|turn| turn.map_or(0.0, |(_, period)| period));
    let counts = |turn: f64| if turn == 0.0 { 0..=0 } else { -TURNS..=TURNS };
    for corners in loops {
        let Some(first) = corners.first().copied() else { continue };
        let shifts = counts(turns[0]).flat_map(|i| counts(turns[1]).map(move |j| [i, j]));
        let mut shifts: Vec<[i32; 2]> = shifts.collect();
        shifts.sort_by_key(|[i, j]| i.abs() + j.abs());
        let by = |shift: [i32; 2]| [0, 1].map(|k| turns[k] * f64::from(shift[k]));
        let home = shifts.into_iter().find(|&shift| holds(polygon, moved(&first, by(shift)).uv));
        if let Some(shift) = home.filter(|shift| *shift != [0, 0]) {
            corners.iter_mut().for_each(|corner| *corner = moved(corner, by(shift)));
        }
    }
}

/// Whether a point lies inside a polygon, by the even-odd rule.
fn holds(polygon: &[Corner], [x, y]: [f64; 2]) -> bool {
    let ends = polygon.iter().skip(1).chain(polygon.first());
    let crossed = polygon.iter().zip(ends).filter(|(a, b)| {
        (a.uv[1] <= y) != (b.uv[1] <= y)
            && a.uv[0] + (b.uv[0] - a.uv[0]) * (y - a.uv[1]) / (b.uv[1] - a.uv[1]) > x
    });
    crossed.count() % 2 == 1
}

/// Twice the area that a loop encloses in the parameter plane, positive when it runs counter-clockwise.
fn twice_area(corners: &[Corner]) -> f64 {
    let ends = corners.iter().skip(1).chain(corners.first());
    corners.iter().zip(ends).map(|(a, b)| a.uv[0] * b.uv[1] - b.uv[0] * a.uv[1]).sum()
}

/// Whether the whole of a finite surface bounds the face beside its loops: there is none, or all of them cut
/// something out of a surface that is closed all round.
fn needs_border(context: &Context, loops: &[Vec<Corner>]) -> bool {
    let surface = context.surface.surface;
    if loops.is_empty() {
        return true;
    }
    let round = matches!(surface, Surface::Sphere { .. } | Surface::Torus { .. });
    let left = if context.brep.faces[context.face].same_sense { 1.0 } else { -1.0 };
    let seams = context.brep.bounds_are_seams(context.face);
    round && !seams && loops.iter().all(|corners| twice_area(corners) * left < 0.0)
}

/// The border of a surface with finite parameters as a polygon: closed sides share their vertices, and a side
/// that is a pole is one vertex. `None` where the parameters have no ends.
fn whole(context: &mut Context) -> Option<Vec<Corner>> {
    let ((u0, u1), (v0, v1)) = context.surface.surface.domain();
    if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        return None;
    }
    let closed = context.surface.turns.map(|turn| turn.is_some());
    let point = |uv: [f64; 2]| context.surface.surface.point(uv[0], uv[1]);
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(|uv| (uv, point(uv)));
    let chord = context.tolerances.chord;
    let middle = [[0.5 * (u0 + u1), v0], [0.5 * (u0 + u1), v1]].map(point);
    let poles = [0, 1].map(|k| {
        let (a, b) = if k == 0 { (0, 1) } else { (3, 2) };
        (corners[a].1 - corners[b].1).norm() <= chord && (corners[a].1 - middle[k]).norm() <= chord
    });
    // The vertices of the four corners, as far as they are told apart.
    let mut vertex = [0u32; 4];
    let given = |context: &Context, point: Point3<f64>| {
        let near = context.vertex_loops.iter().find(|corner| (corner.point - point).norm() <= chord);
        near.map(|corner| corner.vertex)
    };
    for at in 0..4 {
        let along_u = [1, 0, 3, 2][at];
        let along_v = [3, 2, 1, 0][at];
        let bottom = usize::from(at >= 2);
        vertex[at] = if along_u < at && (closed[0] || poles[bottom]) {
            vertex[along_u]
        } else if along_v < at && closed[1] {
            vertex[along_v]
        } else {
            given(context, corners[at].1).unwrap_or_else(|| context.push())
        };
    }
    let corner = |at: usize| Corner { uv: corners[at].0, vertex: vertex[at], point: corners[at].1 };
    let side = |context: &mut Context, a: usize, b: usize| cut(context, &corner(a), &corner(b));
    let pole = |k: usize| poles[k];
    let bottom = if pole(0) { Vec::new() } else { side(context, 0, 1) };
    let right = side(context, 1, 2);
    let shifted = |corners: &[Corner], by: [f64; 2]| -> Vec<Corner> {
        corners.iter().rev().map(|corner| moved(corner, by)).collect()
    };
    let top = match (pole(1), closed[1]) {
        (true, _) => Vec::new(),
        (false, true) => shifted(&bottom, [0.0, v1 - v0]),
        (false, false) => side(context, 2, 3),
    };
    let left = if closed[0] { shifted(&right, [u0 - u1, 0.0]) } else { side(context, 3, 0) };
    let mut polygon = Vec::new();
    for (at, inner) in [bottom, right, top, left].into_iter().enumerate() {
        polygon.push(corner(at));
        polygon.extend(inner);
    }
    Some(polygon)
}

/// The corner of a loop's point: the sample of its edge with the same parameter knows the vertex.
fn corner(brep: &Brep, at: &LoopPoint, edges: &BTreeMap<EdgeId, SharedEdge>) -> Option<Corner> {
    let shared = edges.get(&brep.coedges[at.coedge].edge)?;
    // Samples ascend or descend in their parameter.
    let (first, last) = (shared.samples.first()?.t, shared.samples.last()?.t);
    let found = shared.samples.binary_search_by(|sample| {
        let order = sample.t.total_cmp(&at.t);
        if first <= last { order } else { order.reverse() }
    });
    let by_search = found.ok();
    let index = by_search.or_else(|| shared.samples.iter().position(|s| s.t.to_bits() == at.t.to_bits()))?;
    Some(Corner { uv: [at.u, at.v], vertex: shared.vertices[index], point: shared.samples[index].point })
}

/// Moves corners that share one place of the parameter plane apart, along the way to the next place: an edge
/// that runs a little beyond its surface has several closest points in one at the surface's border.
fn spread(corners: &mut [Corner]) {
    let same = |a: &Corner, b: &Corner| a.uv == b.uv && a.vertex != b.vertex;
    let mut start = 0;
    while start + 1 < corners.len() {
        let run = corners[start..].windows(2).take_while(|pair| same(&pair[0], &pair[1])).count();
        // The next place may be the loop's first again; a whole turn off, it is not the way to go.
        if let Some(next) = corners.get(start + run + 1).map(|corner| corner.uv) {
            let from = corners[start].uv;
            for (corner, step) in corners[start..=start + run].iter_mut().zip(0u32..) {
                #[expect(clippy::cast_precision_loss, reason = "a count of samples of one edge")]
                let share = f64::from(step) / (run as f64 + 1.0);
                corner.uv = [0, 1].map(|k| from[k] + (next[k] - from[k]) * share);
            }
        }
        start += run + 1;
    }
}

fn moved(corner: &Corner, by: [f64; 2]) -> Corner {
    Corner { uv: [corner.uv[0] + by[0], corner.uv[1] + by[1]], ..*corner }
}

/// The region between two loops that wind once around in opposite senses, as one polygon cut open between
/// two of their vertices; `None` when the senses are not opposite.
fn band(
    context: &mut Context,
    mut first: Winding,
    second: Winding,
    inner: &[Vec<Corner>],
) -> Option<Vec<Corner>> {
    let opposite =
        (0..2).all(|k| first.turns[k].to_bits() == (-second.turns[k]).to_bits() || first.turns[k] == 0.0);
    if !opposite || first.corners.is_empty() || second.corners.is_empty() {
        return None;
    }
    let (turns, corners) = (first.turns, &second.corners);
    let along = first.along();
    let by = |count: f64| turns.map(|turn| turn * count);
    // The nearest corner of the second loop to each of the first, and the turn on which it is; all sides of
    // the band count alike in the measure.
    let size = [0, 1].map(|k| {
        let ends = [range(&first.corners, k), range(corners, k)];
        (ends[0].1.max(ends[1].1) - ends[0].0.min(ends[1].0)).max(f64::MIN_POSITIVE)
    });
    let away = |from: &Corner, to: &Corner| -> (f64, f64) {
        let count = ((from.uv[along] - to.uv[along]) / turns[along]).round();
        let to = moved(to, by(count));
        ((0..2).map(|k| ((from.uv[k] - to.uv[k]) / size[k]).powi(2)).sum(), count)
    };
    let nearest = |(at, from): (usize, &Corner)| {
        let all = corners.iter().enumerate().map(|(to, corner)| (away(from, corner), to));
        all.min_by(|a, b| a.0.0.total_cmp(&b.0.0)).map(|((far, count), to)| (far, count, at, to))
    };
    let mut cuts: Vec<_> = first.corners.iter().enumerate().filter_map(nearest).collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let walls = first.walls(&[corners], inner);
    let clear = |&&(_, count, from, to): &&(f64, f64, usize, usize)| {
        is_clear(first.corners[from].uv, moved(&corners[to], by(count)).uv, &walls)
    };
    let &(_, count, from, start) = cuts.iter().take(CUTS).find(clear).or_else(|| cuts.first())?;
    // The corners behind the start of the first loop move on by a turn; the cut is at its end.
    first.start_at(from);
    let begin = first.corners[0];
    let end = moved(&begin, turns);
    let shift = count + 1.0;
    let across = cut(context, &end, &moved(&corners[start], by(shift)));
    let mut polygon = first.corners;
    polygon.push(end);
    polygon.extend(&across);
    polygon.extend(corners[start..].iter().map(|corner| moved(corner, by(shift))));
    polygon.extend(corners[..=start].iter().map(|corner| moved(corner, by(shift - 1.0))));
    polygon.extend(across.iter().rev().map(|corner| moved(corner, by(-1.0))));
    Some(polygon)
}

/// The region between a loop that winds once around and a pole, as one polygon cut open from the loop's
/// start to the pole; `None` when there is no pole on the face's side.
fn cap(context: &mut Context, mut only: Winding, inner: &[Vec<Corner>]) -> Option<Vec<Corner>> {
    let (along, turns) = (only.along(), only.turns);
    let place = pole(context, &only)?;
    let mut cuts: Vec<usize> = (0..only.corners.len()).collect();
    let away = |at: usize| (only.corners[at].uv[1 - along] - place).abs();
    cuts.sort_by(|&a, &b| away(a).total_cmp(&away(b)));
    let walls = only.walls(&[], inner);
    let clear = |&at: &usize| {
        let from = only.corners[at].uv;
        let mut to = from;
        to[1 - along] = place;
        is_clear(from, to, &walls)
    };
    let start = cuts.iter().copied().take(CUTS).find(clear).or_else(|| cuts.first().copied())?;
    only.start_at(start);
    let end = moved(&only.corners[0], turns);
    let mut uv = end.uv;
    uv[1 - along] = place;
    let pole = match context.vertex_loops.first() {
        Some(vertex) => Corner { uv, ..*vertex },
        None => {
            let point = context.surface.point(uv[0], uv[1]);
            Corner { uv, vertex: context.push(), point }
        }
    };
    let across = cut(context, &end, &pole);
    let back = turns.map(|turn| -turn);
    let mut polygon = only.corners;
    polygon.push(end);
    polygon.extend(&across);
    polygon.extend([pole, moved(&pole, back)]);
    polygon.extend(across.iter().rev().map(|corner| moved(corner, back)));
    Some(polygon)
}

/// The other parameter at which the surface shrinks to a point: to the left of the loop, as the face lies.
fn pole(context: &Context, only: &Winding) -> Option<f64> {
    let along = only.along();
    let surface = context.surface.surface;
    let left = if context.brep.faces[context.face].same_sense { 1.0 } else { -1.0 };
    // Left of the direction of u is the direction of v; left of that of v is against that of u.
    let upward = left * only.turns[along] * if along == 0 { 1.0 } else { -1.0 } > 0.0;
    let place = surface.apex().unwrap_or_else(|| {
        let ((u0, u1), (v0, v1)) = surface.domain();
        match (along, upward) {
            (0, false) => v0,
            (0, true) => v1,
            (_, false) => u0,
            (_, true) => u1,
        }
    });
    let begin = only.corners.first()?.uv;
    let at = if along == 0 { [begin[0], place] } else { [place, begin[1]] };
    let d = context.surface.derivatives(at[0], at[1]);
    let speed = if along == 0 { d.du.norm() } else { d.dv.norm() };
    (place.is_finite() && speed * only.turns[along].abs() <= context.tolerances.chord).then_some(place)
}

/// New corners between two along a straight line of the parameter plane, as many as the surface's bend asks for.
fn cut(context: &mut Context, from: &Corner, to: &Corner) -> Vec<Corner> {
    let mut corners = Vec::new();
    let mut before = (from.uv, from.point);
    let mut ahead = vec![((to.uv, to.point), 0)];
    while let Some((after, depth)) = ahead.pop() {
        let uv = [0, 1].map(|k| 0.5 * (before.0[k] + after.0[k]));
        let point = context.surface.point(uv[0], uv[1]);
        let off = (point - nalgebra::center(&before.1, &after.1)).norm();
        if depth < CUT_DEPTH && off > context.tolerances.chord {
            ahead.push((after, depth + 1));
            ahead.push(((uv, point), depth + 1));
        } else {
            if !ahead.is_empty() {
                corners.push(Corner { uv: after.0, vertex: context.push(), point: after.1 });
            }
            before = after;
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_at_one_place_are_spread_towards_the_next() {
        let at = |vertex, uv| Corner { uv, vertex, point: Point3::origin() };
        let mut corners =
            [at(0, [0.0, 0.0]), at(1, [1.0, 0.0]), at(2, [1.0, 0.0]), at(3, [1.0, 0.0]), at(4, [1.0, 3.0])];
        spread(&mut corners);
        let places = corners.map(|corner| corner.uv);
        assert_eq!(places, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]);
        // A pole stands twice on purpose.
        let mut pole = [at(0, [0.0, 0.0]), at(0, [0.0, 0.0]), at(1, [1.0, 0.0])];
        let before = pole;
        spread(&mut pole);
        assert_eq!(pole, before);
    }
}
