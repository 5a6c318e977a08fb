//! Fact: the outer shell of a solid encloses a positive volume, and those of its voids negative ones.

use super::Finding;
use super::edge_use::Uses;
use super::reach::reach;
use super::survey::Survey;
use crate::brep::mass_properties::{Quadrature, middle, of_shell_with};
use crate::brep::{
    BodyId, BodyKind, Brep, FaceId, LoopSampling, ParameterLoop, ShellId, parameter_loops_with,
};
use crate::geometry::Surface;
use crate::math::{Point3, Vector3};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A shell of a solid that is turned inside out.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidInsideOut {
    /// The body.
    pub body: BodyId,
    /// The shell, the outer one or that of a void.
    pub shell: ShellId,
    /// The volume that it encloses, of the wrong sign, in cubic file units.
    pub volume: f64,
    /// The middle of the body.
    pub place: Point3<f64>,
}

/// Part of area times extent that a volume of the wrong sign must have to be believed: what a rough quadrature tells.
const SURE: f64 = 1e-3;
/// Part of area times extent that the volume of flat fans must have to be believed without a quadrature.
const PLAIN: f64 = 1e-2;
/// Plane faces furthest from the middle that are looked at for one that the whole shell lies behind.
const MAX_FLATS: usize = 8;
/// Part of the extent by which a shell may reach over a plane and still lie behind it: rounding.
const BEHIND: f64 = 1e-9;
/// Points of loops that are kept for the quadrature: 10 MB. Those of further faces are found once more.
const MAX_KEPT: usize = 1 << 17;

/// What the loops of a shell's faces tell of its volume.
///
/// They enclose one when each face is replaced by triangles from one of its points: a closed surface that turns as the
/// shell's does. And its plane faces say which way is out.
pub(super) struct Outline {
    body: BodyId,
    shell: ShellId,
    /// The sign that the volume should have.
    expected: f64,
    reference: Point3<f64>,
    volume: f64,
    area: f64,
    extent: f64,
    flats: Vec<Flat>,
    /// The loops themselves, face by face, while they are few.
    kept: BTreeMap<FaceId, Vec<ParameterLoop>>,
    points: usize,
    /// Whether the loops of all faces are known.
    known: bool,
}

/// A plane face: its way out by its loops, and how far out it lies from the middle.
struct Flat {
    normal: Vector3<f64>,
    away: f64,
}

impl Outline {
    /// Of a shell of a body, of which the first is the outer one.
    pub(super) fn new(brep: &Brep, shell: ShellId) -> Self {
        let body = brep.shells[shell].body;
        let expected = if brep.bodies[body].shells.first() == Some(&shell) { 1.0 } else { -1.0 };
        let reference = middle(brep, body);
        Self {
            body,
            shell,
            expected,
            reference,
            volume: 0.0,
            area: 0.0,
            extent: 0.0,
            flats: Vec::new(),
            kept: BTreeMap::new(),
            points: 0,
            known: true,
        }
    }

    /// Adds the loops of a face; `None` where they are not known.
    pub(super) fn add(&mut self, brep: &Brep, face: FaceId, loops: Option<Vec<ParameterLoop>>) {
        let Some(loops) = loops else {
            self.known = false;
            return;
        };
        self.measure(brep, face, &loops);
        self.points += loops.iter().map(|l| l.points.len()).sum::<usize>();
        if self.points <= MAX_KEPT {
            self.kept.insert(face, loops);
        }
    }

    fn measure(&mut self, brep: &Brep, face: FaceId, loops: &[ParameterLoop]) {
        let sign = if brep.shells[self.shell].forward { self.expected } else { -self.expected };
        let Some(apex) = loops.iter().find_map(|l| l.points.first()).map(|p| p.point - self.reference) else {
            return;
        };
        let mut twice = Vector3::zeros();
        for points in loops.iter().map(|l| &l.points) {
            for (i, from) in points.iter().enumerate() {
                let from = from.point - self.reference;
                let to = points[(i + 1) % points.len()].point - self.reference;
                self.volume += sign * apex.dot(&from.cross(&to)) / 6.0;
                let half = (from - apex).cross(&(to - apex));
                self.area += 0.5 * half.norm();
                self.extent = self.extent.max(from.norm());
                twice += half;
            }
        }
        if let Some(Surface::Plane(frame)) = brep.surface_of(face).read() {
            let normal = if brep.faces[face].same_sense { frame.z } else { -frame.z };
            // Where loops and sense are at odds, neither is believed.
            if twice.dot(&normal) > 0.0 {
                self.keep(Flat { normal: normal * sign, away: (normal * sign).dot(&apex) });
            }
        }
    }

    fn keep(&mut self, flat: Flat) {
        let at = self.flats.partition_point(|other| other.away.abs() >= flat.away.abs());
        self.flats.insert(at, flat);
        self.flats.truncate(MAX_FLATS);
    }

    /// Whether the volume is of the sign that it should have, by a large margin.
    fn is_plain(&self) -> bool {
        self.volume > PLAIN * self.area * self.extent
    }

    /// Whether all of a shell, whose faces turn alike, lies behind one of its plane faces, seen from outside.
    fn lies_behind_a_face(&self, survey: &Survey<'_>, uses: &Uses<'_>) -> bool {
        if !uses.by_edge().all(|(_, of)| matches!(of, [a, b] if a.along != b.along)) {
            return false;
        }
        let faces = &survey.brep.shells[self.shell].faces;
        let slack = BEHIND * self.extent;
        self.flats.iter().any(|flat| {
            let plane = flat.normal.dot(&self.reference.coords) + flat.away;
            faces.iter().all(|&face| reach(survey, face, &flat.normal) <= plane + slack)
        })
    }
}

/// Looks at the volume of a shell of a solid that is closed and whose faces are all known.
pub(super) fn check(
    survey: &Survey<'_>,
    uses: &Uses<'_>,
    outline: &Outline,
    tolerance: f64,
    findings: &mut Vec<Finding>,
) {
    let (brep, body, shell) = (survey.brep, outline.body, outline.shell);
    let closed = brep.shells[shell].closed && !brep.shells[shell].faces.is_empty();
    if brep.bodies[body].kind != BodyKind::Solid || !closed || !outline.known {
        return;
    }
    if outline.is_plain() || outline.lies_behind_a_face(survey, uses) {
        return;
    }
    let place = outline.reference;
    let sampling = LoopSampling::of_tolerance(tolerance);
    let loops = |face| match outline.kept.get(&face) {
        Some(loops) => Ok(Cow::Borrowed(loops.as_slice())),
        None => parameter_loops_with(brep, face, &sampling, &|edge| survey.points(edge)).map(Cow::Owned),
    };
    let found = of_shell_with(brep, shell, &Quadrature::of_sign(tolerance), place, &loops);
    let Ok(found) = found else { return };
    let volume = found.volume();
    if volume * outline.expected < -SURE * found.area() * outline.extent {
        findings.push(Finding::SolidInsideOut(SolidInsideOut { body, shell, volume, place }));
    }
}
