//! Seams: edges that a face uses twice, on a border where its surface meets itself.

use std::collections::BTreeMap;

use super::home;
use crate::brep::parameter_loop::{LoopPoint, ParameterLoop};
use crate::brep::{CoedgeId, EdgeId};
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Curve, Curve2d};
use crate::math::{Point2, Vector2};
use crate::model::Model;
use crate::ops::net::acting::ON_BORDER;

/// What is known of a seam: an edge that its face uses twice, on a border where the surface meets itself.
#[derive(Debug, Clone)]
pub struct SeamUse {
    /// The use.
    pub coedge: CoedgeId,
    /// The direction that repeats: 0 for `u`.
    pub closed: usize,
    /// Whether this use lies at the end of the range.
    pub at_end: bool,
    /// Range of the other parameter.
    pub along: (f64, f64),
    /// Whether the edge's curve runs as that parameter does.
    pub forward: bool,
}

impl SeamUse {
    /// New curve of the edge and in parameters; `None` where the range is none of the surface.
    #[must_use]
    pub fn curves(&self, surface: &NurbsSurface) -> Option<(Curve, Curve2d)> {
        let knots = [surface.knots_u(), surface.knots_v()];
        let (first, last) = knots[self.closed].domain();
        let whole = if self.closed == 0 { surface.iso_curve_u(first) } else { surface.iso_curve_v(first) };
        let (low, high) = whole.knots().domain();
        let (from, to) = (self.along.0.max(low), self.along.1.min(high));
        let inner = from > low || to < high;
        let piece = if inner { whole.piece(from, to).ok()? } else { whole };
        let mut origin = Point2::origin();
        let mut direction = Vector2::zeros();
        origin[self.closed] = if self.at_end { last } else { first };
        direction[1 - self.closed] = if self.forward { 1.0 } else { -1.0 };
        let curve = if self.forward {
            piece
        } else {
            origin[1 - self.closed] = from + to;
            piece.reversed()
        };
        Some((Curve::Nurbs(curve), Curve2d::Line { origin, direction }))
    }
}

/// Uses of edges that lie on a border where the surface meets itself.
pub(super) fn seams(
    model: &Model,
    traced: &[ParameterLoop],
    surface: &NurbsSurface,
    periods: [Option<f64>; 2],
    image: &dyn Fn([f64; 2]) -> [f64; 2],
) -> Vec<SeamUse> {
    let mut uses: BTreeMap<EdgeId, usize> = BTreeMap::new();
    let mut found = Vec::new();
    let edge_of = |p: &LoopPoint| model.brep.coedges[p.coedge].edge;
    let (u, v) = surface.domain();
    for l in traced {
        let count = l.points.len();
        let runs = l.points.chunk_by(|a, b| a.coedge == b.coedge);
        let mut at = 0;
        let polygon: Vec<[f64; 2]> = l.points.iter().map(|p| image([p.u, p.v])).collect();
        let shift = home(&polygon, periods, [u, v]);
        for run in runs {
            at += run.len();
            *uses.entry(edge_of(&run[0])).or_insert(0) += 1;
            let mut along: Vec<[f64; 2]> = run.iter().map(|p| image([p.u, p.v])).collect();
            // A run ends where the next one begins, unless it has its own end at a pole.
            let (next, turn) = if at < count { (l.points[at], (0.0, 0.0)) } else { (l.points[0], l.winding) };
            if next.point != run[run.len() - 1].point {
                along.push(image([next.u + turn.0, next.v + turn.1]));
            }
            along.iter_mut().for_each(|p| *p = [p[0] + shift[0], p[1] + shift[1]]);
            let grows = |f: &dyn Fn(usize) -> f64, n: usize| n > 1 && f(n - 1) > f(0);
            for (k, (low, high)) in [u, v].into_iter().enumerate().filter(|(k, _)| periods[*k].is_some()) {
                let slack = ON_BORDER * (high - low);
                let on = |x: f64| along.iter().all(|p| (p[k] - x).abs() <= slack);
                if run.len() < 2 || !(on(low) || on(high)) {
                    continue;
                }
                let other = |i: usize| along[i][1 - k];
                let t_grows = grows(&|i| run[i].t, run.len());
                let forward = t_grows == grows(&other, run.len());
                let range = (0..along.len())
                    .map(other)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                found.push(SeamUse {
                    coedge: run[0].coedge,
                    closed: k,
                    at_end: on(high),
                    along: range,
                    forward,
                });
            }
        }
    }
    found.retain(|s| uses.get(&model.brep.coedges[s.coedge].edge) == Some(&2));
    found
}
