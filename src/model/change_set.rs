//! What an operation wants changed, in no format's words.
//!
//! Elements that are not named stay as they are. A change set is whole or absent: an operation that
//! cannot do its job returns an error instead.

use std::collections::BTreeMap;

use crate::brep::{CoedgeId, CurveId, EdgeId, FaceId, VertexId};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::Point3;

/// New geometry for elements of a model; the topology stays.
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
}

impl ChangeSet {
    /// Whether nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
            && self.curves.is_empty()
            && self.pcurves.is_empty()
            && self.points.is_empty()
            && self.free_curves.is_empty()
    }
}
