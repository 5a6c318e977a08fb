//! A blend ready to be sewn in: its contact curves in space and on both surfaces, and the edges that they become.

use super::super::Closure;
use super::super::blend_surface::Blend;
use super::super::error::ReconstructionError;
use super::chart::Chart;
use crate::geometry::nurbs::{NurbsCurve2, NurbsCurve3, NurbsSurface};
use crate::geometry::{Curve, Curve2d};
use crate::math::{Affine, Point3};
use crate::model::ChangeSet;
use crate::model::change_set::{EdgeCurve, EdgeRef, NewCoedge, NewEdge, NewEdgeId, NewVertexId, VertexRef};

/// A blend with its contact curves, all over the parameter along the line.
#[derive(Debug, Clone, PartialEq)]
pub struct Rail {
    /// Whether the line is closed.
    pub closure: Closure,
    /// The blend: 0 to 1 from the primary to the secondary, 0 to 1 along the line.
    pub blend: NurbsSurface,
    /// Contact with the primary.
    pub space: NurbsCurve3,
    /// Contact with the secondary.
    pub far: NurbsCurve3,
    /// Contact with the primary in the parameters of its face.
    pub flat: NurbsCurve2,
    /// Contact with the secondary in its parameters.
    pub on_secondary: NurbsCurve2,
}

impl Rail {
    /// The image of a blend by a motion.
    ///
    /// # Errors
    /// [`ReconstructionError::Trim`] for a closed line that runs round the primary.
    pub fn new(
        blend: &Blend,
        closure: Closure,
        motion: Option<&Affine>,
        chart: &Chart<'_>,
    ) -> Result<Self, ReconstructionError> {
        let surface =
            motion.map_or_else(|| blend.surface.clone(), |motion| blend.surface.transformed(motion));
        let (space, far) = (surface.iso_curve_u(0.0), surface.iso_curve_u(1.0));
        let stays = motion.is_none() && matches!(chart, Chart::Same(_));
        let flat = if stays { Some(blend.contacts[0].clone()) } else { on_face(&space, closure, chart) };
        let flat = flat.ok_or_else(|| ReconstructionError::Trim {
            near: space.point_at(0.0).coords.into(),
            reason: "the contact curve runs round the primary".to_owned(),
        })?;
        Ok(Self { closure, blend: surface, space, far, flat, on_secondary: blend.contacts[1].clone() })
    }

    /// Places of the contact with the primary from one place along it to another; from the later one on round to the
    /// earlier one when `from` is not before `to`.
    #[must_use]
    pub fn polygon(&self, (from, to): (f64, f64)) -> Vec<[f64; 2]> {
        let to = if from < to { to } else { to + 1.0 };
        let sides = 4 * self.flat.knots().spans().count();
        let count = ((to - from) * sides as f64).ceil().max(1.0) as usize;
        let at = |k: usize| (from + (to - from) * k as f64 / count as f64).rem_euclid(1.0);
        (0..count).map(|k| self.flat.point_at(at(k)).into()).collect()
    }

    /// Greatest distance of the contact with the primary from its place on the face.
    #[must_use]
    pub fn deviation(&self, chart: &Chart<'_>) -> f64 {
        let places = 4 * self.flat.knots().spans().count();
        let off = |k: usize| {
            let t = k as f64 / places as f64;
            (chart.point(self.flat.point_at(t).into()) - self.space.point_at(t)).norm()
        };
        (0..=places).map(off).fold(0.0, f64::max)
    }
}

/// A contact curve in the parameters of the face, through its places at the curve's own stations.
fn on_face(space: &NurbsCurve3, closure: Closure, chart: &Chart<'_>) -> Option<NurbsCurve2> {
    let (count, steps) = match closure {
        // A closed cubic has a span for each station; an open one lacks two.
        Closure::Closed => (space.knots().spans().count(), space.knots().spans().count()),
        Closure::Open => (space.points().len(), space.points().len() - 1),
    };
    let points: Vec<Point3<f64>> = (0..count).map(|k| space.point_at(k as f64 / steps as f64)).collect();
    chart.curve(&points, closure, None)
}

/// Edges that a curve was cut into: each from one break to the next.
#[derive(Debug, Clone)]
pub struct Chain {
    breaks: Vec<f64>,
    edges: Vec<NewEdgeId>,
}

/// A curve that cannot be cut.
fn uncut(at: Point3<f64>) -> ReconstructionError {
    ReconstructionError::Trim {
        near: at.coords.into(),
        reason: "two cuts of a contact curve are one".to_owned(),
    }
}

impl Chain {
    /// Adds the edges of a curve between breaks, ascending, each with its vertex.
    ///
    /// # Errors
    /// [`ReconstructionError::Trim`] for breaks at one place.
    pub fn new(
        changes: &mut ChangeSet,
        curve: &NurbsCurve3,
        breaks: &[(f64, NewVertexId)],
    ) -> Result<Self, ReconstructionError> {
        let mut edges = Vec::with_capacity(breaks.len().saturating_sub(1));
        for pair in breaks.windows(2) {
            let piece = curve.piece(pair[0].0, pair[1].0).map_err(|_| uncut(curve.point_at(pair[0].0)))?;
            let [start, end] = [pair[0].1, pair[1].1].map(VertexRef::New);
            let curve = EdgeCurve::Own(Curve::Nurbs(piece));
            edges.push(changes.new_edges.push(NewEdge { curve, start, end }));
        }
        Ok(Self { breaks: breaks.iter().map(|b| b.0).collect(), edges })
    }

    /// Uses of the edges between two breaks along the curve; from the later one on round to the earlier one when `from` is
    /// not before `to`. `flat` gives the pieces of the curve on the surface of the bound.
    pub fn along(
        &self,
        (from, to): (f64, f64),
        flat: &dyn Fn(f64, f64) -> Option<Curve2d>,
    ) -> Vec<NewCoedge> {
        let n = self.edges.len();
        let index = |t: f64| {
            (0..=n).min_by(|&a, &b| (self.breaks[a] - t).abs().total_cmp(&(self.breaks[b] - t).abs()))
        };
        let (first, last) = (index(from).unwrap_or(0), index(to).unwrap_or(n));
        let pieces: Vec<usize> =
            if first < last { (first..last).collect() } else { (first..n).chain(0..last).collect() };
        pieces
            .into_iter()
            .map(|k| NewCoedge {
                edge: EdgeRef::New(self.edges[k]),
                forward: true,
                pcurve: flat(self.breaks[k], self.breaks[k + 1]),
            })
            .collect()
    }

    /// The first edge.
    #[must_use]
    pub fn first_edge(&self) -> Option<NewEdgeId> {
        self.edges.first().copied()
    }

    /// First and last break.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.breaks[0], self.breaks[self.breaks.len() - 1])
    }
}

/// Uses of edges in the other direction.
#[must_use]
pub fn reversed(mut coedges: Vec<NewCoedge>) -> Vec<NewCoedge> {
    coedges.reverse();
    coedges.iter_mut().for_each(|coedge| coedge.forward = !coedge.forward);
    coedges
}
