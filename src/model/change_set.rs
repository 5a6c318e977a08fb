//! What an operation wants changed, in no format's words.
//!
//! Elements that are not named stay as they are. A change set is whole or absent: an operation that
//! cannot do its job returns an error instead.

use std::collections::{BTreeMap, BTreeSet};

use super::Origin;
use crate::brep::id::ids;
use crate::brep::{Arena, CoedgeId, CurveId, EdgeId, FaceId, LoopId, VertexId};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::Point3;

ids! {
    /// A vertex that a change set adds.
    NewVertexId,
    /// An edge that a change set adds.
    NewEdgeId,
}

/// A vertex of the model or a new one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexRef {
    /// Of the model.
    Kept(VertexId),
    /// Of the change set.
    New(NewVertexId),
}

/// An edge of the model or a new one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeRef {
    /// Of the model; its curves in parameters are those that the file has.
    Kept(EdgeId),
    /// Of the change set.
    New(NewEdgeId),
}

/// Where a new edge has its curve from.
#[derive(Debug, Clone, PartialEq)]
pub enum EdgeCurve {
    /// A curve of its own. The edge runs as it does.
    Own(Curve),
    /// The curve of an edge of the model, with its curves in parameters: the new edge is a piece of that one and runs
    /// as it does.
    Of(EdgeId),
}

/// A new edge. Bounds share it by its id; each gives it a direction.
#[derive(Debug, Clone, PartialEq)]
pub struct NewEdge {
    /// Its curve.
    pub curve: EdgeCurve,
    /// Where it starts.
    pub start: VertexRef,
    /// Where it ends; its start again for a closed one.
    pub end: VertexRef,
}

/// The use of an edge by a new bound.
#[derive(Debug, Clone, PartialEq)]
pub struct NewCoedge {
    /// The edge.
    pub edge: EdgeRef,
    /// Whether the bound runs along it from start to end.
    pub forward: bool,
    /// Curve in the parameters of the face's (new) surface, over the parameter of the edge's curve. Only edges with a
    /// curve of their own have one.
    pub pcurve: Option<Curve2d>,
}

/// A new closed bound, the face to its left as seen against the face's normal.
#[derive(Debug, Clone, PartialEq)]
pub struct NewBound {
    /// Whether it is the outer one.
    pub outer: bool,
    /// Its edges in order, at least one.
    pub coedges: Vec<NewCoedge>,
}

/// A new face.
#[derive(Debug, Clone, PartialEq)]
pub struct NewFace {
    /// Face whose shell, name, look and layers it gets.
    pub beside: FaceId,
    /// Its surface.
    pub surface: Surface,
    /// Whether its normal is the surface's.
    pub same_sense: bool,
    /// Its bounds, at least one.
    pub bounds: Vec<NewBound>,
}

/// New geometry for elements of a model, and elements that come and go.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChangeSet {
    /// New surface of a face. Orientation flags stay.
    pub surfaces: BTreeMap<FaceId, Surface>,
    /// New curve of an edge. Sense and vertices stay.
    pub curves: BTreeMap<EdgeId, Curve>,
    /// New curve of a coedge in the parameters of its (new) surface; only where the file has one.
    pub pcurves: BTreeMap<CoedgeId, Curve2d>,
    /// New point of a vertex.
    pub points: BTreeMap<VertexId, Point3<f64>>,
    /// New geometry of a curve that belongs to no edge.
    pub free_curves: BTreeMap<CurveId, Curve>,
    /// New numbers of records that state something of the shape: the value of a measure, the coordinates of a point.
    pub stated: BTreeMap<Origin, Vec<f64>>,
    /// Properties that are stated no more; one that something else in the file refers to stays.
    pub unstated: BTreeSet<Origin>,
    /// New vertices.
    pub new_vertices: Arena<NewVertexId, Point3<f64>>,
    /// New edges, each used by at least one bound.
    pub new_edges: Arena<NewEdgeId, NewEdge>,
    /// New bounds of faces of the model.
    pub new_bounds: BTreeMap<FaceId, Vec<NewBound>>,
    /// New faces.
    pub new_faces: Vec<NewFace>,
    /// Bounds that go; what only they used goes with them.
    pub removed_bounds: BTreeSet<LoopId>,
    /// Faces that go, with their bounds; what only they used goes with them.
    pub removed_faces: BTreeSet<FaceId>,
}

impl ChangeSet {
    /// Whether nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Adds a ring of new edges, each from its own start to that of the next one, and gives the bound of them: along
    /// the edges or, when `forward` is false, against them. Each edge comes as its curve, the curve in the parameters
    /// of the face, and its start.
    pub fn ring(
        &mut self,
        edges: impl IntoIterator<Item = (Curve, Curve2d, Point3<f64>)>,
        forward: bool,
    ) -> NewBound {
        let edges: Vec<_> = edges.into_iter().collect();
        let corners: Vec<NewVertexId> =
            edges.iter().map(|(_, _, start)| self.new_vertices.push(*start)).collect();
        let mut coedges = Vec::with_capacity(edges.len());
        for (k, (curve, pcurve, _)) in edges.into_iter().enumerate() {
            let [start, end] = [k, (k + 1) % corners.len()].map(|k| VertexRef::New(corners[k]));
            let edge = self.new_edges.push(NewEdge { curve: EdgeCurve::Own(curve), start, end });
            coedges.push(NewCoedge { edge: EdgeRef::New(edge), forward, pcurve: Some(pcurve) });
        }
        if !forward {
            coedges.reverse();
        }
        NewBound { outer: false, coedges }
    }

    /// New bounds, first of faces of the model, then of new faces.
    pub fn all_new_bounds(&self) -> impl Iterator<Item = &NewBound> {
        let of_old = self.new_bounds.values().flatten();
        of_old.chain(self.new_faces.iter().flat_map(|face| &face.bounds))
    }
}
