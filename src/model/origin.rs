//! Which record of the file each element came from.

use crate::brep::{Arena, BodyId, CoedgeId, CurveId, EdgeId, FaceId, LoopId, ShellId, SurfaceId, VertexId};

/// The name of a record in its file: a STEP entity instance name (`#12`) or an IGES directory entry (`D5`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Origin {
    /// STEP: the number behind `#`.
    Instance(u64),
    /// IGES: the sequence number of the directory entry.
    DirectoryEntry(u32),
}

impl Origin {
    /// Reads `#12` or `D5`; `None` for anything else.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        match (text.strip_prefix('#'), text.strip_prefix('D')) {
            (Some(name), _) if digits(name) => name.parse().ok().map(Self::Instance),
            (_, Some(number)) if digits(number) => number.parse().ok().map(Self::DirectoryEntry),
            _ => None,
        }
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Instance(name) => write!(f, "#{name}"),
            Self::DirectoryEntry(number) => write!(f, "D{number}"),
        }
    }
}

/// The record of each element of a model.
#[derive(Debug, Clone, Default)]
pub struct Origins {
    /// Curves: the curve itself, not a surface curve around it.
    pub curves: Arena<CurveId, Origin>,
    /// Surfaces.
    pub surfaces: Arena<SurfaceId, Origin>,
    /// Vertices: the vertex point.
    pub vertices: Arena<VertexId, Origin>,
    /// Edges: the edge curve.
    pub edges: Arena<EdgeId, Origin>,
    /// Uses of edges: the oriented edge.
    pub coedges: Arena<CoedgeId, Origin>,
    /// Records of the curves in parameter space, beside [`Coedge::pcurve`](crate::brep::Coedge::pcurve).
    pub pcurves: Arena<CoedgeId, Option<Origin>>,
    /// Loops: the bound.
    pub loops: Arena<LoopId, Origin>,
    /// Faces.
    pub faces: Arena<FaceId, Origin>,
    /// Shells.
    pub shells: Arena<ShellId, Origin>,
    /// Bodies.
    pub bodies: Arena<BodyId, Origin>,
}
