//! The engines that work on matched nets: displacement, Poisson, biharmonic.

use super::PasteError;
use super::base::{smoothed, with_net};
use super::block::{Block, euclidean};
use super::displacement::displaced;
use super::identify::{contour_polygon, refine_for_region};
use super::laplacian::{biharmonic, poisson};
use super::matching::{Matched, matched};
use super::settings::{Feature, Ground, Method, Pasted, Settings};
use crate::ops::net::creases::mended;

/// Rows and columns of own control points that a region needs.
const NEEDED: usize = 4;

/// Pastes by control points with the same knots. Both surfaces are clamped.
pub(super) fn paste(
    feature: &Feature<'_>,
    ground: &Ground<'_>,
    method: Method,
    settings: &Settings,
) -> Result<Pasted, PasteError> {
    let (s, t) = (feature.source, ground.target);
    let degree_u = s.knots_u().degree().max(t.knots_u().degree());
    let degree_v = s.knots_v().degree().max(t.knots_v().degree());
    let source = s.elevated(degree_u, degree_v)?;
    let target = t.elevated(degree_u, degree_v)?;
    let contour = contour_polygon(&source, feature.contour)?;
    let (source, sets) = refine_for_region(&source, &contour, settings.rule, NEEDED)?;
    let base = smoothed(&source, &sets.own)?;
    let ground = Ground { target: &target, at: ground.at };
    let reach = match method {
        Method::Displacement | Method::Fit => 0,
        Method::Poisson | Method::Biharmonic => 1,
    };
    let nets = matched((&source, &sets, &base), &contour, feature.anchor, &ground, (settings, reach))?;
    // The base is the same where no knot was wanting on the source.
    let known = (nets.source == source && nets.own == sets.own).then_some(&base);
    let block = Block::new(&nets, known, method, settings)?;
    let points = match method {
        Method::Displacement => displaced(&block),
        Method::Poisson => poisson(&block, settings)?,
        Method::Biharmonic | Method::Fit => biharmonic(&block, settings)?,
    };
    let mut net = nets.target.net().to_vec();
    for (at, point) in block.own.indices().zip(points) {
        net[block.places[at]] = point;
    }
    let surface = with_net(&nets.target, net)?;
    let surface = with_net(&nets.target, mended(&nets.target, &surface, &nets.partners))?;
    let lost_detail = lost_detail(&nets)?;
    Ok(Pasted {
        surface,
        map: nets.parameter_map(feature.anchor, ground.at),
        offset: Some(nets.offset),
        lost: nets.lost.count(),
        lost_detail,
        changed: nets.partners,
        refined: nets.target,
        method,
        fit_error: None,
    })
}

/// Greatest displacement, in the source's units, of a control point without a partner.
fn lost_detail(nets: &Matched) -> Result<f64, PasteError> {
    if nets.lost.count() == 0 {
        return Ok(0.0);
    }
    let base = smoothed(&nets.source, &nets.own.union(&nets.lost))?;
    let off = |at: usize| (euclidean(&nets.source.net()[at]) - euclidean(&base.net()[at])).norm();
    Ok(nets.lost.indices().map(off).fold(0.0, f64::max))
}
