//! Facts that a sound boundary representation holds, one file each, and findings where one is violated.
//!
//! Repairs nothing and judges nothing: every finding names the fact, the elements, a place and a size.
//! Tolerances are the caller's, as a rule the file's own uncertainty.
//!
//! Geometry that was not read is passed over: that it is missing is said elsewhere.

mod edge_off_surface;
mod edge_use;
mod open_loop;
mod orientation;
mod pcurve_off_edge;
mod vertex_off_edge;

use super::{BodyId, Brep, FaceId, LoopSampling, ParameterLoop, parameter_loops};
use crate::math::Point3;
pub use edge_off_surface::EdgeOffSurface;
pub use edge_use::{CrowdedEdge, FreeEdge, OneWayEdge};
pub use open_loop::OpenLoop;
pub use orientation::{BoundKind, ReversedLoop};
pub use pcurve_off_edge::PcurveOffEdge;
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
        }
    }

    /// Distance by which it is violated, in file units; `None` where the fact is not one of distance.
    #[must_use]
    pub fn size(&self) -> Option<f64> {
        match self {
            Self::OpenLoop(f) => Some(f.gap),
            Self::EdgeOffSurface(f) => Some(f.distance),
            Self::VertexOffEdge(f) => Some(f.distance),
            Self::PcurveOffEdge(f) => Some(f.distance),
            Self::ReversedLoop(_) | Self::FreeEdge(_) | Self::OneWayEdge(_) | Self::CrowdedEdge(_) => None,
        }
    }
}

/// Checks every body, each by its own tolerance, in file units. Findings come body by body, in file order.
#[must_use]
pub fn check(brep: &Brep, tolerance: &dyn Fn(BodyId) -> f64) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (id, body) in brep.bodies.iter() {
        let tolerance = tolerance(id);
        for &shell in &body.shells {
            let faces = &brep.shells[shell].faces;
            edge_use::check(brep, shell, &mut findings);
            vertex_off_edge::check(brep, faces, tolerance, &mut findings);
            for &face in faces {
                check_face(brep, face, tolerance, &mut findings);
            }
        }
    }
    findings
}

/// Checks one face: its loops, and the edges on its surface.
pub fn check_face(brep: &Brep, face: FaceId, tolerance: f64, findings: &mut Vec<Finding>) {
    open_loop::check(brep, face, tolerance, findings);
    pcurve_off_edge::check(brep, face, tolerance, findings);
    let loops: Vec<ParameterLoop> =
        parameter_loops(brep, face, &LoopSampling::of_tolerance(tolerance)).unwrap_or_default();
    edge_off_surface::check(face, &loops, tolerance, findings);
    orientation::check(brep, face, &loops, findings);
}
