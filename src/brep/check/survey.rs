//! What several facts need of the edges of a body, found once: where they lie on their curves, and points along.

use crate::brep::edge_samples::sample_curve;
use crate::brep::{Arena, Brep, EdgeId, EdgePoint, EdgeRange, EdgeSampling, FaceId, edge_range};
use crate::math::BoundingBox;
use std::borrow::Cow;
use std::cell::OnceCell;

/// An edge as its curve has it.
#[derive(Debug, Clone)]
pub(super) struct Sampled {
    pub(super) range: EdgeRange,
    pub(super) points: Vec<EdgePoint>,
}

/// Edges of one model, sampled when first asked for.
pub(super) struct Survey<'a> {
    pub(super) brep: &'a Brep,
    edges: Arena<EdgeId, OnceCell<Option<Sampled>>>,
}

impl<'a> Survey<'a> {
    pub(super) fn new(brep: &'a Brep) -> Self {
        Self { brep, edges: brep.edges.iter().map(|_| OnceCell::new()).collect() }
    }

    /// `None` where the curve was not read, or its ends have no parameters.
    pub(super) fn edge(&self, edge: EdgeId) -> Option<&Sampled> {
        let find = || {
            let curve = self.brep.curve_of(edge).read()?;
            let range = edge_range(self.brep, edge)?;
            Some(Sampled { range, points: sample_curve(curve, range, &EdgeSampling::default()) })
        };
        self.edges[edge].get_or_init(find).as_ref()
    }

    /// Size of some faces by their edges: the diagonal of the box.
    pub(super) fn extent(&self, faces: impl Iterator<Item = FaceId>) -> f64 {
        let mut bounds = BoundingBox::EMPTY;
        for coedge in faces.flat_map(|face| self.brep.coedges_of(face)) {
            let edge = self.edge(self.brep.coedges[coedge].edge);
            edge.into_iter().flat_map(|edge| &edge.points).for_each(|at| bounds.include(&at.point));
        }
        let size = bounds.diagonal();
        if size.is_finite() { size } else { 0.0 }
    }

    /// Parameters of the ends of an edge.
    pub(super) fn range(&self, edge: EdgeId) -> Option<EdgeRange> {
        self.edge(edge).map(|sampled| sampled.range)
    }

    /// Points along an edge.
    pub(super) fn points(&self, edge: EdgeId) -> Option<Cow<'_, [EdgePoint]>> {
        self.edge(edge).map(|sampled| Cow::Borrowed(sampled.points.as_slice()))
    }
}
