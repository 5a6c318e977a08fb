//! Facts that a sound boundary representation holds, one file each, and findings where one is violated.
//!
//! Repairs nothing and judges nothing: every finding names the fact, the elements, a place and a size.
//! Tolerances are the caller's, as a rule the file's own uncertainty.
//!
//! Geometry that was not read is passed over: that it is missing is said elsewhere.

mod crossing;
mod crowded_edge;
mod degenerate_edge;
mod edge_off_surface;
mod edge_use;
mod gap;
mod inconsistent_sense;
mod limits;
mod missing_seam;
mod one_way_edge;
mod open_loop;
mod open_shell;
mod overlapping_bounds;
mod pcurve_off_edge;
mod reach;
mod reversed_loop;
mod self_crossing_loop;
mod sliver_face;
mod solid_inside_out;
mod survey;
mod turned_face;
mod vertex_off_edge;

use super::{BodyId, Brep, FaceId, LoopSampling, ParameterLoop, parameter_loops_with};
use crate::diagnostic::Severity;
use crate::math::Point3;
pub use crowded_edge::CrowdedEdge;
pub use degenerate_edge::DegenerateEdge;
pub use edge_off_surface::EdgeOffSurface;
use edge_use::Uses;
pub use gap::Gap;
pub use inconsistent_sense::InconsistentSense;
use limits::Limits;
pub use missing_seam::MissingSeam;
pub use one_way_edge::OneWayEdge;
pub use open_loop::OpenLoop;
pub use open_shell::{FreeEdge, OpenShell};
pub use overlapping_bounds::OverlappingBounds;
pub use pcurve_off_edge::PcurveOffEdge;
pub use reversed_loop::{BoundKind, ReversedLoop};
pub use self_crossing_loop::SelfCrossingLoop;
pub use sliver_face::SliverFace;
use solid_inside_out::Outline;
pub use solid_inside_out::SolidInsideOut;
use std::collections::BTreeSet;
use survey::Survey;
pub use turned_face::TurnedFace;
pub use vertex_off_edge::VertexOffEdge;

/// A violated fact.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// A coedge does not start where the one before ends.
    OpenLoop(OpenLoop),
    /// An edge leaves the surface of its face.
    EdgeOffSurface(EdgeOffSurface),
    /// A vertex is not at the end of its edge.
    VertexOffEdge(VertexOffEdge),
    /// A pcurve does not lie on its edge.
    PcurveOffEdge(PcurveOffEdge),
    /// An outer bound runs clockwise, or an inner one counter-clockwise.
    ReversedLoop(ReversedLoop),
    /// An edge of a shell that is said to be closed has a face on one side only.
    FreeEdge(FreeEdge),
    /// Two faces use an edge in the same direction.
    OneWayEdge(OneWayEdge),
    /// More than two faces of a shell meet at an edge.
    CrowdedEdge(CrowdedEdge),
    /// A shell that is said to be closed has free edges.
    OpenShell(OpenShell),
    /// All neighbours of a face run against it.
    TurnedFace(TurnedFace),
    /// The curves of two edges end apart, though their vertex is one.
    Gap(Gap),
    /// An edge is shorter than the tolerance.
    DegenerateEdge(DegenerateEdge),
    /// A loop crosses itself.
    SelfCrossingLoop(SelfCrossingLoop),
    /// Two bounds of a face cross, or an inner one lies outside the outer one.
    OverlappingBounds(OverlappingBounds),
    /// A face is narrower than the tolerance.
    SliverFace(SliverFace),
    /// Bounds run round a surface and leave a side open where it has no end.
    MissingSeam(MissingSeam),
    /// The bounds of a face leave it on the other side than its sense says.
    InconsistentSense(InconsistentSense),
    /// A solid's outer shell encloses a negative volume, or the shell of a void a positive one.
    SolidInsideOut(SolidInsideOut),
}

impl Finding {
    /// Stable name of the violated fact.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::OpenLoop(_) => "open-loop",
            Self::EdgeOffSurface(_) => "edge-off-surface",
            Self::VertexOffEdge(_) => "vertex-off-edge",
            Self::PcurveOffEdge(_) => "pcurve-off-edge",
            Self::ReversedLoop(_) => "reversed-loop",
            Self::FreeEdge(_) => "free-edge",
            Self::OneWayEdge(_) => "one-way-edge",
            Self::CrowdedEdge(_) => "crowded-edge",
            Self::OpenShell(_) => "open-shell",
            Self::TurnedFace(_) => "turned-face",
            Self::Gap(_) => "gap",
            Self::DegenerateEdge(_) => "degenerate-edge",
            Self::SelfCrossingLoop(_) => "self-crossing-loop",
            Self::OverlappingBounds(_) => "overlapping-bounds",
            Self::SliverFace(_) => "sliver-face",
            Self::MissingSeam(_) => "missing-seam",
            Self::InconsistentSense(_) => "inconsistent-sense",
            Self::SolidInsideOut(_) => "solid-inside-out",
        }
    }

    /// Where it is worst, in file units.
    #[must_use]
    pub fn place(&self) -> Point3<f64> {
        match self {
            Self::OpenLoop(f) => f.place,
            Self::EdgeOffSurface(f) => f.place,
            Self::VertexOffEdge(f) => f.place,
            Self::PcurveOffEdge(f) => f.place,
            Self::ReversedLoop(f) => f.place,
            Self::FreeEdge(f) => f.place,
            Self::OneWayEdge(f) => f.place,
            Self::CrowdedEdge(f) => f.place,
            Self::OpenShell(f) => f.place,
            Self::TurnedFace(f) => f.place,
            Self::Gap(f) => f.place,
            Self::DegenerateEdge(f) => f.place,
            Self::SelfCrossingLoop(f) => f.place,
            Self::OverlappingBounds(f) => f.place,
            Self::SliverFace(f) => f.place,
            Self::MissingSeam(f) => f.place,
            Self::InconsistentSense(f) => f.place,
            Self::SolidInsideOut(f) => f.place,
        }
    }

    /// Whether programs stumble over it: an error. A warning is a fact that a sound part may have.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::EdgeOffSurface(f) => f.severity,
            Self::VertexOffEdge(f) => f.severity,
            Self::PcurveOffEdge(f) => f.severity,
            Self::Gap(f) => f.severity,
            Self::DegenerateEdge(_) | Self::SliverFace(_) => Severity::Warning,
            _ => Severity::Error,
        }
    }

    /// Whether an operation that adds it has failed: anything but what a sound part may well have.
    #[must_use]
    pub fn fails_a_change(&self) -> bool {
        !matches!(self, Self::DegenerateEdge(_) | Self::SliverFace(_))
    }

    /// Distance by which it is violated, in file units; `None` where the fact is not one of distance.
    #[must_use]
    pub fn size(&self) -> Option<f64> {
        match self {
            Self::OpenLoop(f) => Some(f.gap),
            Self::EdgeOffSurface(f) => Some(f.distance),
            Self::VertexOffEdge(f) => Some(f.distance),
            Self::PcurveOffEdge(f) => Some(f.distance),
            Self::Gap(f) => Some(f.distance),
            Self::DegenerateEdge(f) => Some(f.length),
            Self::SliverFace(f) => Some(f.width),
            _ => None,
        }
    }
}

/// Checks every body, each by its own tolerance, in file units. Findings come body by body, in file order.
#[must_use]
pub fn check(brep: &Brep, tolerance: &dyn Fn(BodyId) -> f64) -> Vec<Finding> {
    let survey = Survey::new(brep);
    let mut findings = Vec::new();
    for (id, body) in brep.bodies.iter() {
        let faces = body.shells.iter().flat_map(|&shell| brep.shells[shell].faces.iter().copied());
        let limits = Limits::new(tolerance(id), survey.extent(faces));
        for &shell in &body.shells {
            let faces = &brep.shells[shell].faces;
            let uses = Uses::of(brep, shell);
            check_uses(&uses, &mut findings);
            vertex_off_edge::check(&survey, faces, &limits, &mut findings);
            let mut outline = Outline::new(brep, shell);
            for &face in faces {
                let loops = check_face(&survey, face, &limits, &mut findings);
                outline.add(brep, face, loops);
            }
            degenerate_edge::check(&survey, faces, limits.tolerance, &mut findings);
            solid_inside_out::check(&survey, &uses, &outline, limits.tolerance, &mut findings);
        }
    }
    findings
}

/// As [`check`], of some faces with their edges, and of the shells that these are in: for what an operation
/// has changed. The volume of solids is not looked at.
#[must_use]
pub fn check_faces(brep: &Brep, faces: &BTreeSet<FaceId>, tolerance: &dyn Fn(BodyId) -> f64) -> Vec<Finding> {
    let survey = Survey::new(brep);
    let mut findings = Vec::new();
    for (id, body) in brep.bodies.iter() {
        for &shell in &body.shells {
            let some: Vec<FaceId> =
                brep.shells[shell].faces.iter().copied().filter(|face| faces.contains(face)).collect();
            if some.is_empty() {
                continue;
            }
            let limits = Limits::new(tolerance(id), survey.extent(some.iter().copied()));
            check_uses(&Uses::of(brep, shell), &mut findings);
            vertex_off_edge::check(&survey, &some, &limits, &mut findings);
            for &face in &some {
                check_face(&survey, face, &limits, &mut findings);
            }
            degenerate_edge::check(&survey, &some, limits.tolerance, &mut findings);
        }
    }
    findings
}

/// Checks how the faces of a shell share their edges.
fn check_uses(uses: &Uses<'_>, findings: &mut Vec<Finding>) {
    turned_face::check(uses, findings);
    open_shell::check(uses, findings);
    one_way_edge::check(uses, findings);
    crowded_edge::check(uses, findings);
}

/// Checks one face: its loops, and the edges on its surface. Gives the loops, where they are known.
fn check_face(
    survey: &Survey<'_>,
    face: FaceId,
    limits: &Limits,
    findings: &mut Vec<Finding>,
) -> Option<Vec<ParameterLoop>> {
    let (brep, tolerance) = (survey.brep, limits.tolerance);
    open_loop::check(brep, face, tolerance, findings);
    pcurve_off_edge::check(survey, face, limits, findings);
    let sampling = LoopSampling::of_tolerance(tolerance);
    let found = parameter_loops_with(brep, face, &sampling, &|edge| survey.points(edge)).ok();
    let loops = found.as_deref().unwrap_or_default();
    edge_off_surface::check(face, loops, limits, findings);
    reversed_loop::check(brep, face, loops, findings);
    gap::check(survey, face, limits, findings);
    let crossings = crossing::crossings(survey, loops, limits);
    self_crossing_loop::check(face, loops, &crossings, findings);
    overlapping_bounds::check(brep, face, loops, &crossings, findings);
    inconsistent_sense::check(brep, face, loops, findings);
    missing_seam::check(brep, face, loops, tolerance, findings);
    sliver_face::check(brep, face, loops, tolerance, findings);
    found
}
