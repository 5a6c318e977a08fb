//! What an operation wants changed, in no format's words.
//!
//! Elements that are not named stay as they are. A change set is whole or absent: an operation that
//! cannot do its job returns an error instead.

use std::collections::{BTreeMap, BTreeSet};

use super::Origin;
use crate::brep::{CoedgeId, CurveId, EdgeId, FaceId, VertexId};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::Point3;

/// An edge of a new bound, from its own start to that of the next one.
#[derive(Debug, Clone, PartialEq)]
pub struct NewEdge {
    /// The curve in space; the edge is all of it.
    pub curve: Curve,
    /// The curve in the parameters of the face's new surface, over the same parameter.
    pub pcurve: Curve2d,
    /// Where it starts.
    pub start: Point3<f64>,
}

/// A new closed bound of a face.
#[derive(Debug, Clone, PartialEq)]
pub struct NewBound {
    /// Its edges in order, at least one.
    pub edges: Vec<NewEdge>,
    /// Whether the bound runs as its edges do.
    pub forward: bool,
}

/// New geometry for elements of a model; their topology stays, but for new bounds.
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
    /// New bounds of a face, with edges of their own.
    pub bounds: BTreeMap<FaceId, Vec<NewBound>>,
    /// New geometry of a curve that belongs to no edge.
    pub free_curves: BTreeMap<CurveId, Curve>,
    /// New numbers of records that state something of the shape: the value of a measure, the coordinates of a point.
    pub stated: BTreeMap<Origin, Vec<f64>>,
    /// Properties that are stated no more; one that something else in the file refers to stays.
    pub unstated: BTreeSet<Origin>,
}

impl ChangeSet {
    /// Whether nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
            && self.curves.is_empty()
            && self.pcurves.is_empty()
            && self.points.is_empty()
            && self.bounds.is_empty()
            && self.free_curves.is_empty()
            && self.stated.is_empty()
            && self.unstated.is_empty()
    }
}
