//! A ball rolled along a limiting line, and the blend that it leaves.

use super::Closure;
use super::ball::{Section, Station, Unrest, rest};
use super::blend_surface::{Blend, TooWide, lofted};
use super::error::ReconstructionError;
use super::radius::RadiusLaw;
use crate::geometry::nurbs::{NurbsCurve2, NurbsCurve3, NurbsSurface, open_cubic, periodic_cubic};
use crate::math::{Point3, Vector3};

/// Two surfaces and a line between them.
#[derive(Debug, Clone, Copy)]
pub struct Edge<'a> {
    /// Primary and secondary.
    pub surfaces: [&'a NurbsSurface; 2],
    /// The limiting line in the parameters of the primary, over [0, 1]; the secondary lies on the side of `normal x
    /// tangent`.
    pub line: &'a NurbsCurve2,
    /// Whether it is closed.
    pub closure: Closure,
    /// 1 where the ball lies on the side of the normals, -1 on the other.
    pub side: f64,
}

/// A ball at stations of an edge.
#[derive(Debug, Clone)]
pub struct Roller<'a> {
    edge: Edge<'a>,
    shares: Vec<f64>,
    stations: Vec<Station>,
}

/// Angle below which the surfaces meet too flatly for a start; a part of the radius is taken instead.
const FLAT: f64 = 1e-3;

impl<'a> Roller<'a> {
    /// Stations at even shares of the line, at least four.
    ///
    /// # Errors
    /// [`ReconstructionError::LineSingular`] where the line stands still.
    pub fn new(edge: Edge<'a>, count: usize) -> Result<Self, ReconstructionError> {
        let steps = if edge.closure == Closure::Closed { count } else { count - 1 };
        let shares: Vec<f64> = (0..count).map(|k| k as f64 / steps as f64).collect();
        let mut stations = Vec::with_capacity(count);
        for &share in &shares {
            let [at, slope, _] = edge.line.derivatives(share);
            let (point, du, dv) = edge.surfaces[0].first_derivatives(at.x, at.y);
            let along = du * slope.x + dv * slope.y;
            let tangent = along
                .try_normalize(0.0)
                .ok_or(ReconstructionError::LineSingular { near: point.coords.into() })?;
            stations.push(Station { point, tangent });
        }
        Ok(Self { edge, shares, stations })
    }

    /// The edge.
    #[must_use]
    pub fn edge(&self) -> &Edge<'a> {
        &self.edge
    }

    /// The stations.
    #[must_use]
    pub fn stations(&self) -> &[Station] {
        &self.stations
    }

    /// Whether the line is closed.
    #[must_use]
    pub fn closure(&self) -> Closure {
        self.edge.closure
    }

    /// The ball at rest at each station.
    ///
    /// # Errors
    /// [`ReconstructionError::BallDoesNotFit`] with the station.
    pub fn roll(&self, law: &RadiusLaw) -> Result<Vec<Section>, ReconstructionError> {
        let mut sections: Vec<Section> = Vec::with_capacity(self.stations.len());
        for (station, &share) in self.stations.iter().zip(&self.shares) {
            let radius = law.at(share);
            let distance = self.edge.side * radius;
            let fresh = self.start(station, share, radius);
            let found =
                fresh.map_or(Err(Unrest::NotFound), |at| rest(self.edge.surfaces, distance, station, at));
            // Where the tangent planes mislead, the ball beside knows better.
            let found = found.or_else(|unrest| match sections.last() {
                Some(last) => rest(self.edge.surfaces, distance, station, last.contacts.map(|c| c.at)),
                None => Err(unrest),
            });
            let section = found.map_err(|unrest| ReconstructionError::BallDoesNotFit {
                radius,
                near: station.point.coords.into(),
                reason: reason(unrest),
            })?;
            sections.push(section);
        }
        Ok(sections)
    }

    /// Where the contacts would be on the tangent planes.
    fn start(&self, station: &Station, share: f64, radius: f64) -> Option<[[f64; 2]; 2]> {
        let [primary, secondary] = self.edge.surfaces;
        let at = self.edge.line.point_at(share);
        let below =
            secondary.closest_from(&station.point, (at.x, at.y), crate::geometry::nurbs::Wrap::default());
        let normals = [primary.normal(at.x, at.y)?, secondary.normal(below.u, below.v)?];
        let half = 0.5 * normals[0].dot(&normals[1]).clamp(-1.0, 1.0).acos();
        let way = radius * half.tan().clamp(FLAT, 1.0 / FLAT);
        let inwards = normals.map(|n| n.cross(&station.tangent).try_normalize(0.0));
        Some([
            walked(primary, [at.x, at.y], inwards[0]? * -way)?,
            walked(secondary, [below.u, below.v], inwards[1]? * way)?,
        ])
    }
}

/// Parameters a way off along the tangent plane, held to the domain.
fn walked(surface: &NurbsSurface, at: [f64; 2], way: Vector3<f64>) -> Option<[f64; 2]> {
    let (_, du, dv) = surface.first_derivatives(at[0], at[1]);
    let (e, f, g) = (du.norm_squared(), du.dot(&dv), dv.norm_squared());
    let (a, b) = (way.dot(&du), way.dot(&dv));
    let determinant = e * g - f * f;
    let step = [(g * a - f * b) / determinant, (e * b - f * a) / determinant];
    let (u, v) = surface.domain();
    let moved = [(at[0] + step[0]).clamp(u.0, u.1), (at[1] + step[1]).clamp(v.0, v.1)];
    moved.iter().all(|x| x.is_finite()).then_some(moved)
}

fn reason(unrest: Unrest) -> &'static str {
    match unrest {
        Unrest::NotFound => "it finds no rest between the surfaces",
        Unrest::Outside(0) => "it would touch the primary beyond its end",
        Unrest::Outside(_) => {
            "it would touch the secondary beyond its end: the radius is greater than the feature"
        }
        Unrest::TooCurved(0) => "the primary bends more than the ball",
        Unrest::TooCurved(_) => "the secondary bends more than the ball",
    }
}

/// The way of the ball's centre over [0, 1], through centres at even steps, at least four.
#[must_use]
pub fn centre_curve(centres: &[Point3<f64>], closure: Closure) -> NurbsCurve3 {
    let rows: Vec<f64> = centres.iter().flat_map(|c| [c.x, c.y, c.z]).collect();
    let (knots, rows) = match closure {
        Closure::Closed => periodic_cubic(&rows, 3),
        Closure::Open => open_cubic(&rows, 3),
    };
    let points = rows.chunks_exact(3).map(|p| [p[0], p[1], p[2], 1.0]).collect();
    NurbsCurve3::new(knots, points).expect("as many points as the knots ask for")
}

/// A blend with what it misses.
#[derive(Debug, Clone, PartialEq)]
pub struct Rolled {
    /// The surface and its contact curves.
    pub blend: Blend,
    /// Sections that it was lofted through.
    pub sections: usize,
    /// Greatest distance of its borders from primary and secondary.
    pub deviation: [f64; 2],
    /// Greatest angle between its tangent planes and theirs along the contacts, in radians.
    pub angle: f64,
}

/// Sections at first and at most.
const SECTIONS: (usize, usize) = (32, 1024);
/// Angle between tangent planes that is good enough, in radians: 0.05 degrees.
const SMOOTH: f64 = 8.7e-4;
/// Places between two sections at which a blend is measured.
const BETWEEN: usize = 4;

/// Deviation, as a part of the radius, that more sections would not mend.
const JUMP: f64 = 0.01;

/// The section that is farthest from the one before it.
fn widest(sections: &[Section]) -> usize {
    let step = |k: &usize| (sections[*k].centre - sections[k - 1].centre).norm();
    (1..sections.len()).max_by(|a, b| step(a).total_cmp(&step(b))).unwrap_or(0)
}

/// Rolls a ball along an edge, with so many sections that the blend's borders lie within a tolerance of both surfaces.
///
/// # Errors
/// [`ReconstructionError::BallDoesNotFit`], [`ReconstructionError::ArcTooWide`], [`ReconstructionError::BlendNotFair`]
/// when the greatest count of sections is not enough.
pub fn rolled(edge: Edge<'_>, law: &RadiusLaw, tolerance: f64) -> Result<Rolled, ReconstructionError> {
    let mut count = SECTIONS.0;
    loop {
        let sections = Roller::new(edge, count)?.roll(law)?;
        let near = |k: usize| sections[k].centre.coords.into();
        let blend = lofted(&sections, edge.closure)
            .map_err(|TooWide(k)| ReconstructionError::ArcTooWide { near: near(k) })?;
        let found = measured(edge, blend, count);
        let off = found.deviation[0].max(found.deviation[1]);
        if off <= tolerance && found.angle <= SMOOTH {
            return Ok(found);
        }
        if count >= SECTIONS.1 && off > JUMP * law.mean() {
            let reason = "its place of rest jumps along the line";
            return Err(ReconstructionError::BallDoesNotFit {
                radius: law.mean(),
                near: near(widest(&sections)),
                reason,
            });
        }
        if count >= SECTIONS.1 {
            let angle = found.angle.to_degrees();
            return Err(ReconstructionError::BlendNotFair {
                sections: count,
                deviation: off,
                tolerance,
                angle,
            });
        }
        count *= 2;
    }
}

fn measured(edge: Edge<'_>, blend: Blend, sections: usize) -> Rolled {
    let (mut deviation, mut angle) = ([0.0_f64; 2], 0.0_f64);
    let places = BETWEEN * sections;
    for k in 0..=places {
        let t = k as f64 / places as f64;
        for (side, deviation) in deviation.iter_mut().enumerate() {
            let border = blend.surface.derivatives(side as f64, t);
            let at = blend.contacts[side].point_at(t);
            let ground = edge.surfaces[side].derivatives(at.x, at.y);
            *deviation = deviation.max((border.point - ground.point).norm());
            if let (Some(a), Some(b)) = (border.normal(), ground.normal()) {
                // The blend's normal looks the other way.
                angle = angle.max(a.cross(&b).norm().min(1.0).asin());
            }
        }
    }
    Rolled { blend, sections, deviation, angle }
}
