//! Where a feature runs out over the primary's border: its blends and its secondary surface are cut there, by the wall that
//! stands on the border, or along the border's own line where nothing stands on it.

use super::super::error::ReconstructionError;
use super::chart::Chart;
use super::outline::Bound;
use crate::brep::{Brep, CoedgeId, LoopPoint};
use crate::geometry::nurbs::{NurbsCurve2, NurbsCurve3, NurbsSurface, SearchRange, foot_point, open_cubic};
use crate::geometry::{Curve2d, Surface};
use crate::math::{Point3, Vector2, Vector3};

/// What cuts a feature at a border.
pub enum Cutter<'a> {
    /// The surface of the face on the other side of the border, longer than that face.
    Wall(Surface),
    /// The border's line on the primary, carried along the primary's normals.
    Line {
        /// Parameters of the primary.
        chart: Chart<'a>,
        /// Place on the line and its slope, by the parameter of the edge.
        line: Box<dyn Fn(f64) -> [Vector2<f64>; 2] + 'a>,
        /// Places of the border.
        seeds: Vec<LoopPoint>,
    },
}

/// A curve at which a surface is cut, over [0, 1].
#[derive(Debug, Clone)]
pub struct Section {
    /// In space.
    pub space: NurbsCurve3,
    /// On the surface that is cut.
    pub on_surface: NurbsCurve2,
    /// On the wall.
    pub on_wall: Option<NurbsCurve2>,
}

/// Places of a section at first and at most.
const PLACES: (usize, usize) = (8, 1024);
/// Steps of a search, and growth of its bracket.
const STEPS: usize = 80;
const GROWTH: f64 = 1.6;

impl<'a> Cutter<'a> {
    /// The line of a border edge.
    pub fn line(brep: &'a Brep, chart: Chart<'a>, bound: &Bound, coedge: CoedgeId) -> Self {
        let seeds: Vec<LoopPoint> = bound.points.iter().filter(|p| p.coedge == coedge).copied().collect();
        let first = seeds.first().map_or([0.0; 2], |s| [s.u, s.v]);
        let line: Box<dyn Fn(f64) -> [Vector2<f64>; 2] + 'a> = match &brep.coedges[coedge].pcurve {
            Some(pcurve) => Box::new(move |t| {
                let [at, slope, _] = pcurve.derivatives(t);
                [at, slope]
            }),
            None => {
                let curve = brep.curve_of(brep.coedges[coedge].edge).read();
                let place = move |t: f64| {
                    let point = curve.map_or_else(Point3::origin, |curve| curve.point_at(t));
                    Vector2::from(chart.place(&point, Some(first)))
                };
                let step = 1e-5 * (1.0 + seeds.iter().map(|s| s.t.abs()).fold(0.0, f64::max));
                Box::new(move |t| [place(t), (place(t + step) - place(t - step)) / (2.0 * step)])
            }
        };
        Self::Line { chart, line, seeds }
    }

    /// Signed distance of a point from the cut, and its foot on a wall. `near` are parameters near the foot.
    fn off(&self, point: &Point3<f64>, near: Option<[f64; 2]>) -> (f64, [f64; 2]) {
        match self {
            Self::Wall(surface) => {
                let near = near.unwrap_or_else(|| surface.parameters_of(point, None).into());
                let (u, v) = surface.domain();
                let range = SearchRange { u, v, wrap: surface.wrap() };
                let found = foot_point(&|u, v| surface.derivatives(u, v), &range, point, (near[0], near[1]));
                let normal = surface.normal(found.u, found.v).unwrap_or_else(Vector3::zeros);
                ((point - found.point).dot(&normal), [found.u, found.v])
            }
            Self::Line { chart, line, seeds } => {
                let away = |seed: &LoopPoint| (seed.point - point).norm_squared();
                let seed = seeds.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                let at = Vector2::from(chart.place(point, near.or(seed.map(|s| [s.u, s.v]))));
                let mut t = seed.map_or(0.0, |s| s.t);
                for _ in 0..STEPS {
                    let [place, slope] = line(t);
                    let step = (at - place).dot(&slope) / slope.norm_squared();
                    t += step;
                    if step.is_nan() || step.abs() <= 1e-14 * (1.0 + t.abs()) {
                        break;
                    }
                }
                let [place, slope] = line(t);
                let away = at - place;
                ((slope.x * away.y - slope.y * away.x) / slope.norm(), at.into())
            }
        }
    }

    /// The place on a curve where it is cut, near a guess, within [0, 1].
    pub fn on_curve(&self, curve: &NurbsCurve3, guess: f64) -> Option<f64> {
        root(&|t| self.off(&curve.point_at(t), None).0, guess, 1e-3, (0.0, 1.0))
    }

    /// The section of a blend from its contact with the primary to that with the secondary, at given places along.
    pub fn of_blend(
        &self,
        blend: &NurbsSurface,
        (first, last): (f64, f64),
        tolerance: f64,
    ) -> Result<Section, ReconstructionError> {
        let place = |s: f64| {
            let guess = first + s * (last - first);
            if s <= 0.0 || s >= 1.0 {
                return Some([s, guess]);
            }
            root(&|v| self.off(&blend.point(s, v), None).0, guess, 1e-3, (0.0, 1.0)).map(|v| [s, v])
        };
        self.traced(blend, &place, tolerance)
    }

    /// The section of a surface between two of its places.
    pub fn of_surface(
        &self,
        surface: &NurbsSurface,
        [a, b]: [[f64; 2]; 2],
        tolerance: f64,
    ) -> Result<Section, ReconstructionError> {
        let (from, to) = (Vector2::from(a), Vector2::from(b));
        let (u, v) = surface.domain();
        let (_, du, dv) = surface.first_derivatives(a[0], a[1]);
        // Across the chord in lengths, so that a step is the same way in both parameters.
        let scale = Vector2::new(du.norm(), dv.norm());
        let chord = (to - from).component_mul(&scale);
        let across = Vector2::new(-chord.y, chord.x).component_div(&scale) / chord.norm();
        let place = |s: f64| {
            let base = from + (to - from) * s;
            if s <= 0.0 || s >= 1.0 {
                return Some(base.into());
            }
            let at = |w: f64| {
                let p = base + across * w;
                [p.x.clamp(u.0, u.1), p.y.clamp(v.0, v.1)]
            };
            let off = |w: f64| {
                let p = at(w);
                self.off(&surface.point(p[0], p[1]), None).0
            };
            let reach = chord.norm();
            root(&off, 0.0, 1e-3 * reach, (-reach, reach)).map(at)
        };
        self.traced(surface, &place, tolerance)
    }

    /// Cubics through places that lie as near to the surface and the wall as wanted.
    fn traced(
        &self,
        surface: &NurbsSurface,
        place: &dyn Fn(f64) -> Option<[f64; 2]>,
        tolerance: f64,
    ) -> Result<Section, ReconstructionError> {
        let fault = |at: [f64; 2], reason: &str| ReconstructionError::Trim {
            near: surface.point(at[0], at[1]).coords.into(),
            reason: reason.to_owned(),
        };
        let ends = place(0.0).unwrap_or_default();
        let mut count = PLACES.0;
        loop {
            let places: Option<Vec<[f64; 2]>> = (0..=count).map(|k| place(k as f64 / count as f64)).collect();
            let Some(places) = places else {
                return Err(fault(ends, "the feature's end there does not meet the border all along"));
            };
            let section = self.through(surface, &places);
            let off = self.deviation(surface, &section, 4 * count);
            if off <= tolerance {
                return Ok(section);
            }
            if count >= PLACES.1 {
                return Err(fault(ends, &format!("the cut at the border misses its surfaces by {off:.3e}")));
            }
            count *= 2;
        }
    }

    fn through(&self, surface: &NurbsSurface, places: &[[f64; 2]]) -> Section {
        let points: Vec<Point3<f64>> = places.iter().map(|[u, v]| surface.point(*u, *v)).collect();
        let rows: Vec<f64> = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let (knots, rows) = open_cubic(&rows, 3);
        let net = rows.chunks_exact(3).map(|p| [p[0], p[1], p[2], 1.0]).collect();
        let space = NurbsCurve3::new(knots, net).expect("as many points as the knots ask for");
        let on_wall = matches!(self, Self::Wall(_)).then(|| {
            let mut near = None;
            let mut feet = Vec::with_capacity(points.len());
            for point in &points {
                let (_, foot) = self.off(point, near);
                near = Some(foot);
                feet.push(foot);
            }
            flat(&feet)
        });
        Section { space, on_surface: flat(places), on_wall }
    }

    fn deviation(&self, surface: &NurbsSurface, section: &Section, samples: usize) -> f64 {
        let off = |k: usize| {
            let s = k as f64 / samples as f64;
            let point = section.space.point_at(s);
            let at = section.on_surface.point_at(s);
            let own = (surface.point(at.x, at.y) - point).norm();
            let wall = match (self, &section.on_wall) {
                (Self::Wall(wall), Some(flat)) => {
                    let at = flat.point_at(s);
                    (wall.point(at.x, at.y) - point).norm()
                }
                _ => 0.0,
            };
            own.max(wall)
        };
        (0..=samples).map(off).fold(0.0, f64::max)
    }
}

/// The cubic through places of the parameters at even steps.
fn flat(places: &[[f64; 2]]) -> NurbsCurve2 {
    let (knots, rows) = open_cubic(places.as_flattened(), 2);
    let net = rows.chunks_exact(2).map(|p| [p[0], p[1], 1.0]).collect();
    NurbsCurve2::new(knots, net).expect("as many points as the knots ask for")
}

impl Section {
    /// The curve on a surface, as curves in parameters are kept.
    #[must_use]
    pub fn curve2d(curve: &NurbsCurve2) -> Curve2d {
        Curve2d::Nurbs(curve.clone())
    }
}

/// A zero near a guess: a bracket that grows to both sides, then regula falsi with halved weights (Illinois).
fn root(f: &dyn Fn(f64) -> f64, guess: f64, step: f64, (low, high): (f64, f64)) -> Option<f64> {
    let guess = guess.clamp(low, high);
    let here = f(guess);
    if here == 0.0 {
        return Some(guess);
    }
    let mut reach = step;
    let (mut a, mut fa, mut b, mut fb) = loop {
        let ends = [(guess - reach).max(low), (guess + reach).min(high)];
        if let Some(end) = ends.into_iter().find(|end| f(*end) * here <= 0.0) {
            break (guess, here, end, f(end));
        }
        if ends[0] <= low && ends[1] >= high {
            return None;
        }
        reach *= GROWTH;
    };
    for _ in 0..STEPS {
        if fb == 0.0 || (b - a).abs() <= 4.0 * f64::EPSILON * (1.0 + b.abs()) {
            break;
        }
        let c = (a * fb - b * fa) / (fb - fa);
        let fc = f(c);
        if fc * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (c, fc);
    }
    b.is_finite().then_some(b)
}
