//! Whether a stretched face stays clear of what lies opposite to it through the material, where no feature ties the two
//! and nothing was solved that could tell: a boss that keeps its length draws its skin towards the other one.
//!
//! Looks along the inward normal at points of the stretched faces of solids, by triangles of the other faces; the two
//! skins of one feature are the concern of [`skins`](crate::ops::constrained_scale::skins).

use std::collections::BTreeSet;

use super::follow::Follow;
use super::held::Held;
use super::scope::face_name;
use super::stretch::Stretched;
use crate::brep::{BodyKind, FaceId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use crate::math::{Affine, BoundingBox, Point3, Vector3};
use crate::mesh::{Tolerances, tessellate_faces};
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::ScaleError;

/// Part of the lesser expected thickness below which a face is too close to what lies opposite.
const TOO_CLOSE: f64 = 0.8;
/// Points of one face that are looked from, about.
const SAMPLES: usize = 1000;
/// Most divisions of a triangle's side for points.
const DIVISIONS: usize = 8;
/// Least cosine between the normal of a face and the way to it, for it to be the other side of the material.
const OPPOSITE: f64 = 0.7;
/// Distance, as a part of the size, below which two faces meet.
const MEETS: f64 = 1e-6;

/// Refuses stretched faces of which material is lost that neither holding nor scaling takes away; a warning for each
/// that could not be looked at.
///
/// # Errors
/// [`ScaleError::SkinsTooClose`].
pub(super) fn refuse_too_close(
    model: &Model,
    held: &Held,
    stretched: &Stretched,
    follow: &Follow,
    plain: &Affine,
) -> Result<Vec<Diagnostic>, OperationError> {
    let mut notes = Vec::new();
    for &face in stretched.faces.keys() {
        let body = model.body_of(face);
        if model.brep.bodies[body].kind != BodyKind::Solid {
            continue;
        }
        let tied = stretched.skins.iter().filter(|(pair, _)| pair.contains(&face)).flat_map(|(pair, _)| pair);
        let tied: BTreeSet<FaceId> = tied.copied().chain([face]).collect();
        let shells = model.brep.bodies[body].shells.iter();
        let others = shells.flat_map(|&shell| model.brep.shells[shell].faces.iter().copied());
        let others: Vec<FaceId> = others.filter(|other| !tied.contains(other)).collect();
        let look = Look { model, held, stretched, follow, plain };
        match look.worst(face, &others) {
            Ok(Some(worst)) if worst.ratio.is_nan() || worst.ratio < TOO_CLOSE => {
                let faces = [face, worst.other].map(|f| face_name(model, f));
                return Err(ScaleError::SkinsTooClose { faces, ratio: worst.ratio, near: worst.near }.into());
            }
            Ok(_) => {}
            Err(reason) => notes.push(Diagnostic {
                code: "scale.clearance-not-checked",
                severity: Severity::Warning,
                entity: Some(face_name(model, face)),
                span: None,
                message: format!("whether it stays clear of what lies opposite is not known: {reason}"),
            }),
        }
    }
    Ok(notes)
}

struct Look<'a> {
    model: &'a Model,
    held: &'a Held,
    stretched: &'a Stretched,
    follow: &'a Follow,
    plain: &'a Affine,
}

/// Where the least is left of the material.
struct Worst {
    other: FaceId,
    ratio: f64,
    near: Point3<f64>,
}

/// A face that a ray may meet.
struct Target {
    face: FaceId,
    triangles: Vec<[Point3<f64>; 3]>,
    center: Point3<f64>,
    radius: f64,
}

/// What a ray meets first.
struct Hit<'a> {
    target: &'a Target,
    distance: f64,
}

impl Look<'_> {
    /// The place of a face with the least of the material left behind it.
    fn worst(&self, face: FaceId, others: &[FaceId]) -> Result<Option<Worst>, String> {
        let Some(base) = self.held.bases[&face].net() else { return Ok(None) };
        let scaled = &self.stretched.faces[&face];
        let size = scaled.image.bounding_box().diagonal().max(base.surface.bounding_box().diagonal());
        let targets = others.iter().map(|&other| self.target(other, size)).collect::<Result<Vec<_>, _>>()?;
        let locator = SurfaceLocator::new(&base.surface, Wrap::default());
        let inward = if self.model.brep.faces[face].same_sense { -1.0 } else { 1.0 };
        let mut worst: Option<Worst> = None;
        for point in spread(&self.triangles(face, size)?) {
            let found = locator.closest(&point);
            let at = (found.u, found.v);
            let (Some(way), point) = (base.surface.normal(at.0, at.1), base.surface.point(at.0, at.1)) else {
                continue;
            };
            let way = way * inward;
            let Some(hit) = first(&targets, &point, &way, MEETS * size) else { continue };
            let opposite = point + way * hit.distance;
            let [plain, after] = [&scaled.image, &scaled.surface].map(|s| Side::of(s, at, inward));
            let (Some(plain), Some(after)) = (plain, after) else { continue };
            let expected = hit.distance.min(plain.depth(&self.plain.point(&opposite)));
            let ratio = after.depth(&self.image(hit.target.face, &opposite)) / expected;
            if expected > 0.0 && worst.as_ref().is_none_or(|w| ratio.is_nan() || ratio < w.ratio) {
                worst = Some(Worst { other: hit.target.face, ratio, near: after.point });
            }
        }
        Ok(worst)
    }

    fn triangles(&self, face: FaceId, size: f64) -> Result<Vec<[Point3<f64>; 3]>, String> {
        let mesh = tessellate_faces(&self.model.brep, &[face], &Tolerances::for_size(size));
        Ok(mesh.map_err(|error| error.to_string())?.corners().collect())
    }

    fn target(&self, face: FaceId, size: f64) -> Result<Target, String> {
        let triangles = self.triangles(face, size)?;
        let bounds = BoundingBox::of(triangles.iter().flatten());
        let (center, radius) = (bounds.min + (bounds.max - bounds.min) * 0.5, 0.5 * bounds.diagonal());
        Ok(Target { face, triangles, center, radius })
    }

    /// Where a point of a face goes.
    fn image(&self, face: FaceId, point: &Point3<f64>) -> Point3<f64> {
        if let Some(&number) = self.follow.faces.get(&face) {
            return self.follow.movers[number].map.point(point);
        }
        let base = self.held.bases.get(&face).and_then(|base| base.net());
        match base.zip(self.stretched.faces.get(&face)) {
            Some((base, scaled)) => {
                let found = SurfaceLocator::new(&base.surface, Wrap::default()).closest(point);
                scaled.surface.point(found.u, found.v)
            }
            None => self.plain.point(point),
        }
    }
}

/// A point of a surface with the way into the material.
struct Side {
    point: Point3<f64>,
    way: Vector3<f64>,
}

impl Side {
    fn of(surface: &NurbsSurface, at: (f64, f64), inward: f64) -> Option<Self> {
        Some(Self { point: surface.point(at.0, at.1), way: surface.normal(at.0, at.1)? * inward })
    }

    fn depth(&self, other: &Point3<f64>) -> f64 {
        (other - self.point).dot(&self.way)
    }
}

/// Points evenly within triangles.
fn spread(triangles: &[[Point3<f64>; 3]]) -> Vec<Point3<f64>> {
    let per_triangle = SAMPLES as f64 / triangles.len().max(1) as f64;
    let n = (per_triangle.sqrt().ceil() as usize).clamp(1, DIVISIONS);
    let step = (triangles.len() / SAMPLES).max(1);
    let mut points = Vec::new();
    for [a, b, c] in triangles.iter().step_by(step) {
        for i in 0..n {
            for j in 0..n - i {
                let (s, t) = ((i as f64 + 1.0 / 3.0) / n as f64, (j as f64 + 1.0 / 3.0) / n as f64);
                points.push(a + (b - a) * s + (c - a) * t);
            }
        }
    }
    points
}

/// The first face beyond a least distance that a ray meets, if it lies opposite.
fn first<'a>(targets: &'a [Target], from: &Point3<f64>, way: &Vector3<f64>, least: f64) -> Option<Hit<'a>> {
    let mut best: Option<(f64, &Target, f64)> = None;
    for target in targets {
        let to = target.center - from;
        if to.cross(way).norm() > target.radius || to.dot(way) < -target.radius {
            continue;
        }
        for triangle in &target.triangles {
            let Some(distance) = meets(from, way, triangle) else { continue };
            if distance > least && best.is_none_or(|(nearest, ..)| distance < nearest) {
                let normal = (triangle[1] - triangle[0]).cross(&(triangle[2] - triangle[0]));
                best = Some((distance, target, normal.dot(way).abs() / normal.norm()));
            }
        }
    }
    let (distance, target, cosine) = best?;
    (cosine > OPPOSITE).then_some(Hit { target, distance })
}

/// Distance at which a ray passes through a triangle.
fn meets(from: &Point3<f64>, way: &Vector3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = way.cross(&ac);
    let volume = ab.dot(&across);
    let to = from - a;
    let s = to.dot(&across) / volume;
    let turned = to.cross(&ab);
    let t = way.dot(&turned) / volume;
    let distance = ac.dot(&turned) / volume;
    // Comparisons with what a parallel triangle gives are false.
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0 && distance > 0.0 && distance.is_finite()).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(height: f64) -> [Point3<f64>; 3] {
        [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]].map(|[x, y]| Point3::new(x, y, height))
    }

    #[test]
    fn a_ray_meets_a_triangle_ahead_and_inside_only() {
        let down = -Vector3::z();
        let from = |x: f64| Point3::new(x, 1.0, 3.0);
        assert_eq!(meets(&from(1.0), &down, &triangle(0.5)), Some(2.5));
        assert_eq!(meets(&from(1.0), &Vector3::z(), &triangle(0.5)), None);
        assert_eq!(meets(&from(3.5), &down, &triangle(0.5)), None);
        assert_eq!(meets(&from(1.0), &Vector3::x(), &triangle(0.5)), None);
    }

    #[test]
    fn points_are_spread_within_the_triangles() {
        let points = spread(&[triangle(2.0)]);
        assert_eq!(points.len(), DIVISIONS * (DIVISIONS + 1) / 2);
        assert!(points.iter().all(|p| p.x > 0.0 && p.y > 0.0 && p.x + p.y < 4.0 && p.z == 2.0));
    }
}
