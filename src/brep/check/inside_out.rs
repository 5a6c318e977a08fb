//! Facts: the shells of a solid enclose a positive volume, and a face is on the side of its loops that its sense
//! says.

use super::Finding;
use crate::brep::mass_properties::{MassPropertiesError, Quadrature, middle, of_body, of_loops};
use crate::brep::{BodyId, BodyKind, Brep, FaceId, ParameterLoop, Shell};
use crate::geometry::Surface;
use crate::math::Point3;

/// A solid whose shells are turned inside out.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidInsideOut {
    /// The body.
    pub body: BodyId,
    /// Its volume, negative, in cubic file units.
    pub volume: f64,
    /// A vertex of it.
    pub place: Point3<f64>,
}

/// Bounds run round a surface and leave a side open where it has no end: a seam, or another bound, is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingSeam {
    /// The face.
    pub face: FaceId,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// The bounds of a face that runs round its surface leave it on the other side than its sense says.
#[derive(Debug, Clone, PartialEq)]
pub struct InconsistentSense {
    /// The face.
    pub face: FaceId,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// A face that is narrower than the tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct SliverFace {
    /// The face.
    pub face: FaceId,
    /// Twice its area over the length of its bounds, in file units.
    pub width: f64,
    /// A point of the bounds.
    pub place: Point3<f64>,
}

/// Part of area times extent that a negative volume must have to be believed: what a rough quadrature tells.
const SURE: f64 = 1e-3;
/// Part of area times extent that the volume of flat fans must have to be believed without a quadrature.
const PLAIN: f64 = 1e-2;

/// What the loops of a body's faces enclose when each face is replaced by triangles from one of its points: a
/// closed surface that turns as the body's does.
pub(super) struct Fan {
    reference: Point3<f64>,
    volume: f64,
    area: f64,
    extent: f64,
}

impl Fan {
    pub(super) fn new(brep: &Brep, body: BodyId) -> Self {
        Self { reference: middle(brep, body), volume: 0.0, area: 0.0, extent: 0.0 }
    }

    /// Adds the loops of a face of a shell that counts as it is, or turned.
    pub(super) fn add(&mut self, loops: &[ParameterLoop], forward: bool) {
        let sign = if forward { 1.0 } else { -1.0 };
        let Some(apex) = loops.iter().find_map(|l| l.points.first()).map(|p| p.point - self.reference) else {
            return;
        };
        for points in loops.iter().map(|l| &l.points) {
            for (i, from) in points.iter().enumerate() {
                let from = from.point - self.reference;
                let to = points[(i + 1) % points.len()].point - self.reference;
                self.volume += sign * apex.dot(&from.cross(&to)) / 6.0;
                self.area += 0.5 * (from - apex).cross(&(to - apex)).norm();
                self.extent = self.extent.max(from.norm());
            }
        }
    }

    fn is_plainly_positive(&self) -> bool {
        self.volume > PLAIN * self.area * self.extent
    }
}

/// Looks at the volume of a solid whose shells are closed and whose faces are all known.
pub(super) fn check_body(brep: &Brep, id: BodyId, fan: &Fan, tolerance: f64, findings: &mut Vec<Finding>) {
    let body = &brep.bodies[id];
    let closed = |shell: &Shell| shell.closed && !shell.faces.is_empty();
    if fan.is_plainly_positive() {
        return;
    }
    if body.kind != BodyKind::Solid || !body.shells.iter().all(|&shell| closed(&brep.shells[shell])) {
        return;
    }
    let Ok(found) = of_body(brep, id, &Quadrature::rough(tolerance)) else { return };
    let place = found.reference;
    let extent = brep.bodies[id].shells.iter().flat_map(|&shell| &brep.shells[shell].faces);
    let extent = extent
        .flat_map(|&face| brep.coedges_of(face))
        .map(|c| (brep.vertices[brep.edges[brep.coedges[c].edge].start].point - place).norm())
        .fold(0.0, f64::max);
    if found.volume() < -SURE * found.area() * extent {
        findings.push(Finding::SolidInsideOut(SolidInsideOut { body: id, volume: found.volume(), place }));
    }
}

/// Looks at one face.
pub(super) fn check_face(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    tolerance: f64,
    findings: &mut Vec<Finding>,
) {
    let Some(first) = loops.iter().find_map(|l| l.points.first()) else { return };
    let place = first.point;
    if runs_wrong(brep, face, loops) {
        findings.push(Finding::InconsistentSense(InconsistentSense { face, place }));
    }
    if loops.iter().any(|l| l.winding != (0.0, 0.0)) {
        let rough = Quadrature::rough(tolerance);
        if let Err(MassPropertiesError::Endless { .. } | MassPropertiesError::BothWays { .. }) =
            of_loops(brep, face, loops, &rough, place)
        {
            findings.push(Finding::MissingSeam(MissingSeam { face, place }));
        }
    }
    let length: f64 = loops.iter().map(length).sum();
    // A polygon of small vector area may still be wide: the area decides.
    if length > 0.0 && 2.0 * vector_area(loops) <= SUSPECT * tolerance * length {
        let rough = Quadrature::rough(tolerance);
        if let Ok(found) = of_loops(brep, face, loops, &rough, place) {
            let width = 2.0 * found.area() / length;
            if width <= tolerance {
                findings.push(Finding::SliverFace(SliverFace { face, width, place }));
            }
        }
    }
}

/// Factor on the tolerance below which the flat measure of a width makes a face worth measuring.
const SUSPECT: f64 = 4.0;

fn length(of: &ParameterLoop) -> f64 {
    let closing = of.points.last().zip(of.points.first()).map(|(a, b)| (b.point - a.point).norm());
    of.points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum::<f64>() + closing.unwrap_or(0.0)
}

/// Length of the sum of the loops' vector areas.
fn vector_area(loops: &[ParameterLoop]) -> f64 {
    let mut sum = crate::math::Vector3::zeros();
    for points in loops.iter().map(|l| &l.points).filter(|p| !p.is_empty()) {
        let origin = points[0].point;
        for w in points.windows(2) {
            sum += (w[0].point - origin).cross(&(w[1].point - origin)) * 0.5;
        }
    }
    sum.norm()
}

/// Whether two or more loops that run round a surface with borders leave a negative area to their left.
fn runs_wrong(brep: &Brep, face: FaceId, loops: &[ParameterLoop]) -> bool {
    let Some(surface) = brep.surface_of(face).read() else { return false };
    let (around, total): (usize, f64) = loops
        .iter()
        .filter(|l| l.winding.0 != 0.0 && l.winding.1 == 0.0)
        .fold((0, 0.0), |(n, sum), l| (n + 1, sum + l.winding.0));
    let both_ways = loops.iter().any(|l| l.winding.1 != 0.0);
    let closed = matches!(surface, Surface::Sphere { .. } | Surface::Torus { .. })
        || matches!(surface.periods(), (Some(_), Some(_)));
    if around < 2 || both_ways || closed || total.abs() > 1e-9 {
        return false;
    }
    let mut area = 0.0;
    let mut size = 0.0f64;
    for of in loops {
        let Some(first) = of.points.first() else { continue };
        let ends = of.points.iter().skip(1).map(|p| (p.u, p.v)).chain([(first.u + of.winding.0, first.v)]);
        let mut here = (first.u, first.v);
        for to in ends {
            area -= 0.5 * (here.1 + to.1) * (to.0 - here.0);
            size = size.max(to.1.abs() * (to.0 - here.0).abs());
            here = to;
        }
    }
    let signed = if brep.faces[face].same_sense { area } else { -area };
    signed < -1e-9 * size
}
