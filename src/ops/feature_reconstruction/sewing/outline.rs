//! The bounds of the primary in its parameters, and where contact curves meet them.

use super::super::Closure;
use super::super::error::ReconstructionError;
use super::rail::Rail;
use crate::brep::parameter_loop::{LoopPoint, LoopSampling, ParameterLoop, parameter_loops};
use crate::brep::{Brep, CoedgeId, FaceId, LoopId};
use crate::math::{Point3, Vector3};
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::net::layout::face_name;

/// The bounds of a face, run so that the face lies to their left as seen against the surface's normal.
#[derive(Debug, Clone)]
pub struct Outline {
    /// Bounds, as polygons.
    pub bounds: Vec<Bound>,
    /// Whether the face's normal is the surface's.
    pub same_sense: bool,
    periods: [Option<f64>; 2],
}

/// A bound.
#[derive(Debug, Clone)]
pub struct Bound {
    /// Its id.
    pub of: LoopId,
    /// Its points, the first not repeated at the end.
    pub points: Vec<LoopPoint>,
    /// Whether it is closed in the parameter plane.
    pub closed: bool,
    /// Coedges in order, each with whether the bound runs along its edge.
    pub coedges: Vec<(CoedgeId, bool)>,
}

/// Where a contact curve meets a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// The bound, and the place along it: number of the polygon's side and share of it.
    pub bound: usize,
    /// Place along the bound, in sides.
    pub along: f64,
    /// The coedge.
    pub coedge: CoedgeId,
    /// Parameter on the edge's curve.
    pub edge_at: f64,
    /// Place on the contact curve.
    pub rail_at: f64,
    /// The point, on the edge.
    pub point: Point3<f64>,
    /// Whether the bound enters the feature here, or leaves it.
    pub enters: bool,
}

/// Sides of a contact curve's polygon for each of its spans.
const SIDES: usize = 4;
/// Steps of the search for a meeting.
const STEPS: usize = 30;

impl Outline {
    /// The outline of a face.
    ///
    /// # Errors
    /// [`OperationError::NoParameterLoops`].
    pub fn of(model: &Model, face: FaceId) -> Result<Self, OperationError> {
        let brep = &model.brep;
        let tolerance = model.context_of(face).uncertainty.map_or(f64::INFINITY, |t| t.0);
        let loops = parameter_loops(brep, face, &LoopSampling::of_tolerance(tolerance)).map_err(|e| {
            OperationError::NoParameterLoops { face: face_name(model, face), reason: e.to_string() }
        })?;
        let same_sense = brep.faces[face].same_sense;
        let bounds = loops.into_iter().map(|traced| Bound::new(brep, traced, same_sense)).collect();
        let periods = brep.surface_of(face).read().map_or([None; 2], |s| s.periods().into());
        Ok(Self { bounds, same_sense, periods })
    }

    /// Where a contact curve meets the bounds, in the order of the curve.
    ///
    /// # Errors
    /// [`ReconstructionError::Trim`] where a meeting is no point of both.
    pub fn meetings(
        &self,
        brep: &Brep,
        rail: &Rail,
        tolerance: f64,
    ) -> Result<Vec<Meeting>, ReconstructionError> {
        let sides = SIDES * rail.flat.knots().spans().count();
        let at = |k: usize| k as f64 / sides as f64;
        let polygon: Vec<[f64; 2]> = (0..=sides).map(|k| rail.flat.point_at(at(k)).into()).collect();
        let mut found = Vec::new();
        for shift in self.shifts() {
            let moved: Vec<[f64; 2]> = polygon.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect();
            let range = box_of(&moved);
            for (number, bound) in self.bounds.iter().enumerate() {
                for side in 0..bound.points.len() {
                    let ends = bound.side(side);
                    if !meet_boxes(&range, &box_of(&ends)) {
                        continue;
                    }
                    for k in 0..sides {
                        let Some([a, b]) = crossing([moved[k], moved[k + 1]], ends) else { continue };
                        let seed = [(k as f64 + a) / sides as f64, b];
                        found.push(self.refined(
                            brep,
                            rail,
                            (number, side),
                            seed,
                            (&moved[k..k + 2], tolerance),
                        )?);
                    }
                }
            }
        }
        found.sort_by(|a, b| a.rail_at.total_cmp(&b.rail_at));
        Ok(found)
    }

    /// Whole periods by which a contact curve is looked for.
    fn shifts(&self) -> Vec<[f64; 2]> {
        let ways = |period: Option<f64>| period.map_or(vec![0.0], |p| vec![0.0, -p, p]);
        let vs = ways(self.periods[1]);
        ways(self.periods[0]).into_iter().flat_map(|u| vs.iter().map(move |&v| [u, v])).collect()
    }

    fn refined(
        &self,
        brep: &Brep,
        rail: &Rail,
        (number, side): (usize, usize),
        [rail_at, share]: [f64; 2],
        (way, tolerance): (&[[f64; 2]], f64),
    ) -> Result<Meeting, ReconstructionError> {
        let bound = &self.bounds[number];
        let (from, to) = bound.parameters(side);
        let coedge = bound.points[side].coedge;
        let seed = [rail_at, from + share * (to - from)];
        let (rail_at, edge_at, point, off) = nearest(brep, rail, coedge, seed);
        if off > tolerance {
            return Err(ReconstructionError::Trim {
                near: point.coords.into(),
                reason: format!("the contact curve passes an edge of the primary {off:.3e} away"),
            });
        }
        let [a, b] = bound.side(side);
        let along = [b[0] - a[0], b[1] - a[1]];
        let across = [way[1][0] - way[0][0], way[1][1] - way[0][1]];
        let enters = across[0] * along[1] - across[1] * along[0] > 0.0;
        Ok(Meeting { bound: number, along: side as f64 + share, coedge, edge_at, rail_at, point, enters })
    }

    /// Whether a point lies within the bounds, by the even-odd rule; `None` for a face whose bounds run round its surface.
    #[must_use]
    pub fn contains(&self, at: [f64; 2]) -> Option<bool> {
        if self.bounds.iter().any(|b| !b.closed || b.points.is_empty()) {
            return None;
        }
        let inside = |shift: &[f64; 2]| {
            let p = [at[0] + shift[0], at[1] + shift[1]];
            self.bounds.iter().filter(|b| b.contains(p)).count() % 2 == 1
        };
        Some(self.shifts().iter().any(inside))
    }
}

/// The nearest points of a contact curve and an edge: their parameters, the edge's point, and the distance.
fn nearest(brep: &Brep, rail: &Rail, coedge: CoedgeId, seed: [f64; 2]) -> (f64, f64, Point3<f64>, f64) {
    let Some(curve) = brep.curve_of(brep.coedges[coedge].edge).read() else {
        return (seed[0], seed[1], Point3::origin(), f64::INFINITY);
    };
    let [mut s, mut t] = seed;
    for _ in 0..STEPS {
        let ([p, dp, _], [q, dq, _]): ([Vector3<f64>; 3], [Vector3<f64>; 3]) =
            (rail.space.derivatives(s), curve.derivatives(t));
        let apart = p - q;
        let (a, b, c) = (dp.norm_squared(), -dp.dot(&dq), dq.norm_squared());
        let (x, y) = (-apart.dot(&dp), apart.dot(&dq));
        let determinant = a * c - b * b;
        if determinant <= 0.0 {
            break;
        }
        let (ds, dt) = ((c * x - b * y) / determinant, (a * y - b * x) / determinant);
        s = (s + ds).clamp(0.0, 1.0);
        t += dt;
        if ds.abs() < 1e-15 && (dt * dq.norm()).abs() < 1e-14 * (1.0 + q.amax()) {
            break;
        }
    }
    let point = curve.point_at(t);
    (s, t, point, (rail.space.point_at(s) - point).norm())
}

impl Bound {
    fn new(brep: &Brep, traced: ParameterLoop, same_sense: bool) -> Self {
        let of = &brep.loops[traced.of];
        // Once turned by the bound's own orientation, once more where the face turns its surface.
        let turns = of.forward != same_sense;
        let mut coedges: Vec<(CoedgeId, bool)> =
            of.coedges.iter().map(|&c| (c, brep.coedges[c].forward != turns)).collect();
        if turns {
            coedges.reverse();
        }
        let points = if same_sense { traced.points } else { turned(&traced.points) };
        Self { of: traced.of, points, closed: traced.winding == (0.0, 0.0), coedges }
    }

    /// Ends of a side of the polygon.
    fn side(&self, side: usize) -> [[f64; 2]; 2] {
        let next = &self.points[(side + 1) % self.points.len()];
        let here = &self.points[side];
        [[here.u, here.v], [next.u, next.v]]
    }

    /// Parameters of the edge at the ends of a side.
    fn parameters(&self, side: usize) -> (f64, f64) {
        let here = &self.points[side];
        let next = &self.points[(side + 1) % self.points.len()];
        if next.coedge == here.coedge {
            return (here.t, next.t);
        }
        // The side ends where the next coedge begins: a step on along this one is near enough for a start.
        let before = side.checked_sub(1).map(|k| &self.points[k]).filter(|p| p.coedge == here.coedge);
        (here.t, before.map_or(here.t, |p| 2.0 * here.t - p.t))
    }

    fn contains(&self, at: [f64; 2]) -> bool {
        let sides = 0..self.points.len();
        sides.map(|side| self.side(side)).filter(|[a, b]| passes(*a, *b, at)).count() % 2 == 1
    }
}

/// The points of a polygon run the other way: each with the coedge that leaves from it then.
fn turned(points: &[LoopPoint]) -> Vec<LoopPoint> {
    let n = points.len();
    (0..n)
        .map(|k| {
            let here = points[(n - k) % n];
            let before = points[(2 * n - k - 1) % n];
            LoopPoint { coedge: before.coedge, ..here }
        })
        .collect()
}

/// Least and greatest parameters.
pub fn box_of(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.iter().fold(start, |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// Whether two boxes share a point.
pub fn meet_boxes(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> bool {
    (0..2).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k])
}

/// Shares of two segments at which they cross; each counts with its start and without its end.
fn crossing([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (p, q, r) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]], [c[0] - a[0], c[1] - a[1]]);
    let determinant = p[0] * q[1] - p[1] * q[0];
    if determinant == 0.0 {
        return None;
    }
    let s = (r[0] * q[1] - r[1] * q[0]) / determinant;
    let t = (r[0] * p[1] - r[1] * p[0]) / determinant;
    ((0.0..1.0).contains(&s) && (0.0..1.0).contains(&t)).then_some([s, t])
}

/// Whether a closed contact curve holds a point of the parameters.
#[must_use]
pub fn within(rail: &Rail, at: [f64; 2]) -> bool {
    rail.closure == Closure::Closed && inside(&rail.polygon((0.0, 1.0)), at)
}

/// Whether a polygon holds a point, by the even-odd rule.
#[must_use]
pub fn inside(polygon: &[[f64; 2]], at: [f64; 2]) -> bool {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).filter(|(a, b)| passes(**a, **b, at)).count() % 2 == 1
}

/// Whether a side lies to the right of a point, at its height.
fn passes(a: [f64; 2], b: [f64; 2], at: [f64; 2]) -> bool {
    let x = || a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    (a[1] > at[1]) != (b[1] > at[1]) && at[0] < x()
}
