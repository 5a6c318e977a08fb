//! Lines: where they go, and from which parameters of the face they are pulled there.

use super::DeformError;
use crate::brep::FaceId;
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, SurfaceProjection, Wrap};
use crate::math::{Point3, Vector3};
use crate::model::Model;
use crate::ops::net::layout::{Layout, face_name};
use crate::ops::net::{Contour, Polygon};

/// A line of points.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// Points that count one by one.
    Points(Vec<Point3<f64>>),
    /// Points so near to each other along a curve that what lies between is known.
    Curve(Vec<Point3<f64>>),
}

impl Path {
    /// Its points.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        match self {
            Self::Points(points) | Self::Curve(points) => points,
        }
    }
}

/// What becomes of the face's normal along a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Normal {
    /// It follows.
    #[default]
    Free,
    /// It stays as it was.
    Keep,
    /// It takes this direction.
    Along(Vector3<f64>),
}

/// A line that the face is pulled to.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Where it goes.
    pub to: Path,
    /// The line on the face that goes there, each part of its length to the same part of the other's. Left out: the
    /// nearest points of the face.
    pub from: Option<Path>,
    /// Weight against other lines.
    pub weight: f64,
    /// The normal along it.
    pub normal: Normal,
}

/// A point of a line with its place on the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pulled {
    /// Parameters.
    pub at: [f64; 2],
    /// Where that goes.
    pub to: Point3<f64>,
}

/// A line made ready.
#[derive(Debug, Clone)]
pub(super) struct Traced {
    /// Number, from 1.
    pub number: usize,
    pub points: Vec<Pulled>,
    /// Whether each point counts by itself.
    pub single: bool,
    pub weight: f64,
    pub normal: Normal,
}

/// Distance of a line that is to lie on the face, as a part of the surface's size.
const ON_FACE: f64 = 1e-3;
/// Height times curvature beyond which a nearest point is not to be trusted.
const UNCLEAR: f64 = 0.8;
/// Share of such points that a line may have.
const UNCLEAR_SHARE: f64 = 0.01;

/// A face that lines are traced on.
pub(super) struct Tracer<'a> {
    pub model: &'a Model,
    pub face: FaceId,
    pub surface: &'a NurbsSurface,
    pub layout: &'a Layout,
    pub wrap: Wrap,
}

impl Tracer<'_> {
    /// All lines with their parameters.
    pub fn traced(&self, lines: &[Line]) -> Result<Vec<Traced>, DeformError> {
        if lines.is_empty() {
            return Err(DeformError::EmptyLine { line: 1 });
        }
        let locator = SurfaceLocator::new(self.surface, self.wrap);
        lines.iter().enumerate().map(|(k, line)| self.one(&locator, line, k + 1)).collect()
    }

    fn one(&self, locator: &SurfaceLocator, line: &Line, number: usize) -> Result<Traced, DeformError> {
        let to = line.to.points();
        if to.is_empty() || line.from.as_ref().is_some_and(|from| from.points().is_empty()) {
            return Err(DeformError::EmptyLine { line: number });
        }
        let starts = match &line.from {
            Some(from) => at_same_parts(from.points(), to),
            None => to.to_vec(),
        };
        let feet: Vec<SurfaceProjection> = starts.iter().map(|p| locator.closest(p)).collect();
        match &line.from {
            Some(_) => self.lies_on_face(&feet, number)?,
            None => self.is_clear(&feet, number)?,
        }
        self.lies_inside(&feet, number)?;
        let points = feet.iter().zip(to).map(|(foot, to)| Pulled { at: [foot.u, foot.v], to: *to }).collect();
        let single = matches!(line.to, Path::Points(_));
        Ok(Traced { number, points, single, weight: line.weight, normal: line.normal })
    }

    fn off(&self, line: usize, at: Point3<f64>, reason: String) -> DeformError {
        DeformError::LineOffFace { line, at, reason, face: face_name(self.model, self.face) }
    }

    fn lies_on_face(&self, feet: &[SurfaceProjection], line: usize) -> Result<(), DeformError> {
        let most = ON_FACE * self.surface.bounding_box().diagonal();
        match feet.iter().find(|foot| foot.distance > most) {
            Some(foot) => Err(self.off(line, foot.point, format!("{:.6} beside the surface", foot.distance))),
            None => Ok(()),
        }
    }

    fn is_clear(&self, feet: &[SurfaceProjection], line: usize) -> Result<(), DeformError> {
        let unclear = |foot: &&SurfaceProjection| {
            let curvature = self.surface.derivatives(foot.u, foot.v).greatest_curvature();
            curvature.is_none_or(|k| k * foot.distance > UNCLEAR)
        };
        let share = feet.iter().filter(unclear).count() as f64 / feet.len() as f64;
        if share > UNCLEAR_SHARE {
            let face = face_name(self.model, self.face);
            return Err(DeformError::HeightExceedsCurvature { line, share: 100.0 * share, face });
        }
        Ok(())
    }

    fn lies_inside(&self, feet: &[SurfaceProjection], line: usize) -> Result<(), DeformError> {
        let (u, v) = self.surface.domain();
        let loops = self.model.brep.faces[self.face].loops.iter().zip(&self.layout.loops).enumerate();
        for (k, (id, shape)) in loops {
            let Some(shape) = shape else { continue };
            let Contour { points, margin } = &shape.contour;
            let Ok(polygon) = Polygon::new(points, *margin, [u, v]) else { continue };
            let outer = self.layout.outer == Some(k);
            if !outer && !self.layout.is_inner(k) {
                continue;
            }
            // On the border of the domain the outer loop's polygon may run a little inside.
            let inset = |x: f64, (low, high): (f64, f64), m: f64| x.clamp(low + 2.0 * m, high - 2.0 * m);
            let inside = |foot: &SurfaceProjection| {
                polygon.contains([inset(foot.u, u, margin[0]), inset(foot.v, v, margin[1])])
            };
            if let Some(foot) = feet.iter().find(|foot| inside(foot) != outer) {
                let side = if outer { "outside" } else { "inside" };
                let name = self.model.origins.loops[*id].to_string();
                return Err(self.off(line, foot.point, format!("{side} loop {name}")));
            }
        }
        Ok(())
    }
}

/// For each point of a line, the point of another at the same part of its length.
fn at_same_parts(on: &[Point3<f64>], of: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let (along, parts) = (lengths(on), lengths(of));
    let at = |part: f64| {
        let k = along.partition_point(|a| *a < part).clamp(1, along.len().max(2) - 1);
        let (Some(a), Some(b)) = (along.get(k - 1), along.get(k)) else { return on[0] };
        let share = if b > a { ((part - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        on[k - 1] + (on[k] - on[k - 1]) * share
    };
    parts.into_iter().map(at).collect()
}

/// Length up to each point as a part of the whole; by number where the whole has none.
fn lengths(points: &[Point3<f64>]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for pair in points.windows(2) {
        sums.push(sums[sums.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let whole = sums[sums.len() - 1];
    if whole > 0.0 {
        sums.iter_mut().for_each(|s| *s /= whole);
    }
    sums
}
