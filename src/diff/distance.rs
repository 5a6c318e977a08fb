//! Distances of points from a face within its bounds.

use super::Sampled;
use super::placed::{PlacedFace, Side};
use crate::brep::{EdgeId, EdgeRange, EdgeSampling, edge_range, sample_edge};
use crate::geometry::Surface;
use crate::geometry::nurbs::SurfaceLocator;
use crate::math::{Affine, Point3};
use crate::mesh::NearestTriangle;

/// Surface samples of a net at most, along each direction: beyond that its triangles do.
const MOST_GREVILLE: usize = 64;

/// A face that points are measured from.
pub(super) struct Target<'a> {
    surface: Option<Projector<'a>>,
    triangles: NearestTriangle,
    edges: Vec<TargetEdge<'a>>,
    /// From common coordinates to the body's.
    inverse: Affine,
    /// Common units in one of the body's.
    scale: f64,
    /// Distance of the triangles from the face, in the body's unit.
    chord: f64,
}

enum Projector<'a> {
    Nurbs(Box<SurfaceLocator<'a>>),
    Other(&'a Surface),
}

struct TargetEdge<'a> {
    curve: &'a crate::geometry::Curve,
    range: EdgeRange,
    points: Vec<crate::brep::EdgePoint>,
}

impl<'a> Target<'a> {
    pub(super) fn new(side: &'a Side<'_>, face: &PlacedFace) -> Self {
        let brep = &side.model.brep;
        let surface = brep.surface_of(face.face).read().map(|surface| match surface {
            Surface::Nurbs(net) => Projector::Nurbs(Box::new(SurfaceLocator::new(net, surface.wrap()))),
            other => Projector::Other(other),
        });
        let triangles = side.mesh(face).map_or_else(|| NearestTriangle::of(Vec::new()), NearestTriangle::new);
        let edges =
            brep.coedges_of(face.face).filter_map(|coedge| edge(side, brep.coedges[coedge].edge)).collect();
        let scale = face.transform.similarity_factor().unwrap_or(1.0);
        let chord = 4e-3 * face.bounds.diagonal() / scale;
        let inverse = face.transform.inverse().unwrap_or_else(Affine::identity);
        Self { surface, triangles, edges, inverse, scale, chord }
    }

    /// Distance of a point in common coordinates; infinite from a face of which nothing is known.
    pub(super) fn distance(&self, point: &Point3<f64>) -> f64 {
        let local = self.inverse.point(point);
        let to_triangles = self.triangles.distance(&local);
        let to_surface = self.surface.as_ref().map(|surface| surface.distance(&local));
        // The foot lies within the bounds where the triangles, which end there, are about as near; past them the bounds
        // are what is nearest.
        let away = match to_surface {
            Some(away) if to_triangles <= away + self.chord => away.max(0.0),
            _ => self.to_bounds(&local).min(to_triangles),
        };
        away * self.scale
    }

    /// Whether a point of a bound lies on a bound of this face.
    pub(super) fn bound_distance(&self, point: &Point3<f64>) -> f64 {
        self.to_bounds(&self.inverse.point(point)) * self.scale
    }

    fn to_bounds(&self, local: &Point3<f64>) -> f64 {
        self.edges.iter().map(|edge| edge.distance(local)).fold(f64::INFINITY, f64::min)
    }
}

impl Projector<'_> {
    fn distance(&self, point: &Point3<f64>) -> f64 {
        match self {
            Self::Nurbs(locator) => locator.closest(point).distance,
            Self::Other(surface) => {
                let (u, v) = surface.parameters_of(point, None);
                let (u, v) = surface.wrapped(u, v);
                (surface.point(u, v) - point).norm()
            }
        }
    }
}

fn edge<'a>(side: &'a Side<'_>, id: EdgeId) -> Option<TargetEdge<'a>> {
    let brep = &side.model.brep;
    let curve = brep.curve_of(id).read()?;
    let range = edge_range(brep, id)?;
    let points = sample_edge(brep, id, &EdgeSampling::default())?;
    Some(TargetEdge { curve, range, points })
}

impl TargetEdge<'_> {
    /// Distance of a point from the edge: of the foot near the nearest sample, or of an end.
    fn distance(&self, point: &Point3<f64>) -> f64 {
        let Some(nearest) =
            self.points.iter().min_by(|a, b| (a.point - point).norm().total_cmp(&(b.point - point).norm()))
        else {
            return f64::INFINITY;
        };
        let (low, high) = (self.range.start.min(self.range.end), self.range.start.max(self.range.end));
        let t = self.curve.parameter_of(point, Some(nearest.t)).clamp(low, high);
        (self.curve.point_wrapped(t) - point).norm().min((nearest.point - point).norm())
    }
}

/// Points of a face in common coordinates: corners of its triangles, and of a net those of its surface that its
/// freedom lies in.
pub(super) fn inner_samples(side: &Side<'_>, face: &PlacedFace) -> Vec<Point3<f64>> {
    let Some(mesh) = side.mesh(face) else { return bound_samples(side, face) };
    let mut local = mesh.vertices.clone();
    if let Some(Surface::Nurbs(net)) = side.model.brep.surface_of(face.face).read() {
        let within = NearestTriangle::new(mesh);
        let scale = face.transform.similarity_factor().unwrap_or(1.0);
        let chord = 2e-3 * face.bounds.diagonal() / scale;
        let (u, v) = (net.knots_u().greville(), net.knots_v().greville());
        if u.len().max(v.len()) <= MOST_GREVILLE {
            local.extend(net.grid(&u, &v).into_iter().filter(|point| within.distance(point) <= chord));
        }
    }
    local.iter().map(|point| face.transform.point(point)).collect()
}

/// Points of the bounds of a face in common coordinates.
pub(super) fn bound_samples(side: &Side<'_>, face: &PlacedFace) -> Vec<Point3<f64>> {
    let brep = &side.model.brep;
    let edges = brep.coedges_of(face.face).map(|coedge| brep.coedges[coedge].edge);
    let points =
        edges.filter_map(|edge| sample_edge(brep, edge, &EdgeSampling { chord: f64::INFINITY, per_span: 4 }));
    points.flatten().map(|at| face.transform.point(&at.point)).collect()
}

/// Greatest distance of the points of either face from the other.
pub(super) fn either_way(
    before: &Side<'_>,
    a: &PlacedFace,
    after: &Side<'_>,
    b: &PlacedFace,
) -> Option<Sampled> {
    let (to_a, to_b) = (Target::new(before, a), Target::new(after, b));
    let mut sampled: Option<Sampled> = None;
    for (points, target) in [(inner_samples(after, b), &to_a), (inner_samples(before, a), &to_b)] {
        for point in &points {
            let distance = target.distance(point);
            let points = sampled.map_or(0, |sampled| sampled.points) + 1;
            let at = point.coords.into();
            sampled = match sampled {
                Some(known) if known.distance >= distance => Some(Sampled { points, ..known }),
                _ => Some(Sampled { distance, at, points }),
            };
        }
    }
    sampled.filter(|sampled| sampled.distance.is_finite())
}

/// Whether two faces have the same points within a tolerance.
pub(super) fn are_same(
    before: &Side<'_>,
    a: &PlacedFace,
    after: &Side<'_>,
    b: &PlacedFace,
    tolerance: f64,
) -> bool {
    let (to_a, to_b) = (Target::new(before, a), Target::new(after, b));
    let lies = |points: Vec<Point3<f64>>, target: &Target<'_>| {
        points.iter().all(|point| target.distance(point) <= tolerance)
    };
    let bounds = |points: Vec<Point3<f64>>, target: &Target<'_>| {
        points.iter().all(|point| target.bound_distance(point) <= tolerance)
    };
    bounds(bound_samples(after, b), &to_a)
        && bounds(bound_samples(before, a), &to_b)
        && lies(inner_samples(after, b), &to_a)
        && lies(inner_samples(before, a), &to_b)
}
