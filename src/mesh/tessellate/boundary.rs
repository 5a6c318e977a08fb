//! Loops of a face as polygons in the parameter plane, over the shared points of the edges.

use super::region::Corner;
use super::{TessellateError, Tolerances, Wrapped};
use crate::brep::{
    Brep, EdgeId, EdgePoint, FaceId, LoopPoint, LoopSampling, ParameterLoop, parameter_loops_with,
};
use crate::geometry::Surface;
use crate::math::Point3;
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

/// What the loops of a face need to know, and a way to new vertices of the mesh.
pub(super) struct Context<'a> {
    pub brep: &'a Brep,
    pub face: FaceId,
    pub surface: &'a Wrapped<'a>,
    pub tolerances: &'a Tolerances,
    pub edges: &'a BTreeMap<EdgeId, SharedEdge>,
    /// Vertices that are loops on their own.
    pub vertex_loops: &'a [Corner],
    pub push: &'a mut dyn FnMut(Point3<f64>) -> Result<u32, TessellateError>,
}

/// Loops of a face in one sheet of the parameter plane; loops that wind around a closed surface are cut
/// open and joined to one polygon.
pub(super) fn loops(context: &mut Context) -> Result<Vec<Vec<Corner>>, TessellateError> {
    let (brep, face, edges) = (context.brep, context.face, context.edges);
    let sampling = LoopSampling::of_tolerance(AGREEMENT * context.tolerances.chord);
    let samples = |edge: EdgeId| edges.get(&edge).map(|shared| shared.samples.clone());
    let found = parameter_loops_with(brep, face, &sampling, &samples)
        .map_err(|source| TessellateError::Bounds { face, source })?;
    let corners =
        |l: &ParameterLoop| l.points.iter().map(|p| corner(brep, p, edges)).collect::<Option<Vec<_>>>();
    let mut loops = Vec::with_capacity(found.len());
    let mut winding = Vec::new();
    for parameter_loop in &found {
        let mut corners =
            corners(parameter_loop).expect("the points are samples of the edges that were given");
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
    let unfit = TessellateError::WindingBounds { face };
    match <[Winding; 2]>::try_from(winding) {
        Ok([mut first, second]) => {
            first.start_clear_of(&loops);
            gather(&mut loops, &first);
            loops.push(band(context, first, second)?.ok_or(unfit)?);
        }
        Err(winding) if winding.is_empty() => {}
        Err(winding) => match <[Winding; 1]>::try_from(winding) {
            Ok([mut only]) => {
                only.start_clear_of(&loops);
                gather(&mut loops, &only);
                loops.push(cap(context, only)?.ok_or(unfit)?);
            }
            Err(_) => return Err(unfit),
        },
    }
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

    /// Starts at the corner that is farthest, around the surface, from all other loops: there the surface
    /// is cut open.
    fn start_clear_of(&mut self, others: &[Vec<Corner>]) {
        let along = self.along();
        let period = self.turns[along].abs();
        let ranges: Vec<_> = others.iter().map(|corners| range(corners, along)).collect();
        let clearance = |corner: &Corner| {
            let to_range = |&(low, high): &(f64, f64)| {
                let off = corner.uv[along] - 0.5 * (low + high);
                (off - period * (off / period).round()).abs() - 0.5 * (high - low)
            };
            ranges.iter().map(to_range).fold(period, f64::min)
        };
        let best = (0..self.corners.len())
            .rev()
            .max_by(|&a, &b| clearance(&self.corners[a]).total_cmp(&clearance(&self.corners[b])));
        let (Some(best), turns) = (best, self.turns) else { return };
        self.corners.rotate_left(best);
        let count = self.corners.len();
        for corner in &mut self.corners[count - best..] {
            *corner = moved(corner, turns);
        }
    }
}

/// Least and greatest of one parameter.
fn range(corners: &[Corner], along: usize) -> (f64, f64) {
    let all = corners.iter().map(|corner| corner.uv[along]);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
}

/// Moves loops by whole turns to where the region of a winding loop is cut out of the covering plane.
fn gather(loops: &mut [Vec<Corner>], winding: &Winding) {
    let along = winding.along();
    let (turn, Some(begin)) = (winding.turns[along], winding.corners.first()) else { return };
    for corners in loops {
        let (low, high) = range(corners, along);
        let away = ((0.5 * (low + high) - begin.uv[along]) / turn).floor();
        for corner in corners {
            corner.uv[along] -= away * turn;
        }
    }
}

/// The corner of a loop's point: the sample of its edge with the same parameter knows the vertex.
fn corner(brep: &Brep, at: &LoopPoint, edges: &BTreeMap<EdgeId, SharedEdge>) -> Option<Corner> {
    let shared = edges.get(&brep.coedges[at.coedge].edge)?;
    let index = shared.samples.iter().position(|sample| sample.t.to_bits() == at.t.to_bits())?;
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
    first: Winding,
    second: Winding,
) -> Result<Option<Vec<Corner>>, TessellateError> {
    let opposite =
        (0..2).all(|k| first.turns[k].to_bits() == (-second.turns[k]).to_bits() || first.turns[k] == 0.0);
    let Some(begin) = first.corners.first().copied().filter(|_| opposite) else { return Ok(None) };
    let (along, turns) = (first.along(), first.turns);
    let end = moved(&begin, turns);
    // The second loop starts at the corner that is closest to the first one's end, whole turns aside.
    let away = |corner: &Corner| (end.uv[along] - corner.uv[along]) / turns[along];
    let offset = |corner: &Corner| (away(corner) - away(corner).round()).abs();
    let corners = &second.corners;
    let start = (0..corners.len()).min_by(|&a, &b| offset(&corners[a]).total_cmp(&offset(&corners[b])));
    let Some(start) = start else { return Ok(None) };
    let shift = away(&corners[start]).round();
    let by = |count: f64| turns.map(|turn| turn * count);
    let across = cut(context, &end, &moved(&corners[start], by(shift)))?;
    let mut polygon = first.corners;
    polygon.push(end);
    polygon.extend(&across);
    polygon.extend(corners[start..].iter().map(|corner| moved(corner, by(shift))));
    polygon.extend(corners[..=start].iter().map(|corner| moved(corner, by(shift - 1.0))));
    polygon.extend(across.iter().rev().map(|corner| moved(corner, by(-1.0))));
    Ok(Some(polygon))
}

/// The region between a loop that winds once around and a pole, as one polygon cut open from the loop's
/// start to the pole; `None` when there is no pole on the face's side.
fn cap(context: &mut Context, only: Winding) -> Result<Option<Vec<Corner>>, TessellateError> {
    let (along, turns) = (only.along(), only.turns);
    let Some(begin) = only.corners.first().copied() else { return Ok(None) };
    let end = moved(&begin, turns);
    let Some(place) = pole(context, &only) else { return Ok(None) };
    let mut uv = end.uv;
    uv[1 - along] = place;
    let pole = match context.vertex_loops.first() {
        Some(vertex) => Corner { uv, ..*vertex },
        None => {
            let point = context.surface.derivatives(uv[0], uv[1]).point;
            Corner { uv, vertex: (context.push)(point)?, point }
        }
    };
    let across = cut(context, &end, &pole)?;
    let back = turns.map(|turn| -turn);
    let mut polygon = only.corners;
    polygon.push(end);
    polygon.extend(&across);
    polygon.extend([pole, moved(&pole, back)]);
    polygon.extend(across.iter().rev().map(|corner| moved(corner, back)));
    Ok(Some(polygon))
}

/// The other parameter at which the surface shrinks to a point: to the left of the loop, as the face lies.
fn pole(context: &Context, only: &Winding) -> Option<f64> {
    let along = only.along();
    let surface = context.surface.surface;
    let left = if context.brep.faces[context.face].same_sense { 1.0 } else { -1.0 };
    // Left of the direction of u is the direction of v; left of that of v is against that of u.
    let upward = left * only.turns[along] * if along == 0 { 1.0 } else { -1.0 } > 0.0;
    let place = match surface {
        Surface::Cone { radius, semi_angle, .. } => -radius / semi_angle.tan(),
        _ => {
            let ((u0, u1), (v0, v1)) = surface.domain();
            match (along, upward) {
                (0, false) => v0,
                (0, true) => v1,
                (_, false) => u0,
                (_, true) => u1,
            }
        }
    };
    let begin = only.corners.first()?.uv;
    let at = if along == 0 { [begin[0], place] } else { [place, begin[1]] };
    let d = context.surface.derivatives(at[0], at[1]);
    let speed = if along == 0 { d.du.norm() } else { d.dv.norm() };
    (place.is_finite() && speed * only.turns[along].abs() <= context.tolerances.chord).then_some(place)
}

/// New corners between two along a straight line of the parameter plane, as many as the surface's bend asks for.
fn cut(context: &mut Context, from: &Corner, to: &Corner) -> Result<Vec<Corner>, TessellateError> {
    let mut corners = Vec::new();
    let mut before = (from.uv, from.point);
    let mut ahead = vec![((to.uv, to.point), 0)];
    while let Some((after, depth)) = ahead.pop() {
        let uv = [0, 1].map(|k| 0.5 * (before.0[k] + after.0[k]));
        let point = context.surface.derivatives(uv[0], uv[1]).point;
        let off = (point - nalgebra::center(&before.1, &after.1)).norm();
        if depth < CUT_DEPTH && off > context.tolerances.chord {
            ahead.push((after, depth + 1));
            ahead.push(((uv, point), depth + 1));
        } else {
            if !ahead.is_empty() {
                corners.push(Corner { uv: after.0, vertex: (context.push)(after.1)?, point: after.1 });
            }
            before = after;
        }
    }
    Ok(corners)
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
