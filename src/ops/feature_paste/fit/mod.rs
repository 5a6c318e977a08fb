//! The engine for any angle, mirror, scale and parametrisation: the feature's displacement field, carried by an
//! affine map of the parameters and the frames of both surfaces, fitted by least squares on the target's net.
//!
//! The map of parameters is affine by design, so that curves in parameters are carried exactly.

mod density;
mod deviation;
mod field;
mod system;

use super::PasteError;
use super::base::{smoothed, with_net};
use super::frames::frame_of;
use super::identify::{contour_polygon, refine_for_region};
use super::settings::{Existing, Feature, Ground, Method, Mirror, ParameterMap, Pasted, Settings};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::math::Matrix2;
use crate::ops::net::creases::mended;
use crate::ops::net::{CellGrid, Mask, Polygon};
use deviation::greatest_deviation;
use field::Field;
use system::least_squares;

/// Rows and columns of own control points that a region needs.
const NEEDED: usize = 6;
/// Degree to which a target of lower degree is raised, unless the source's is lower.
pub(super) const DEGREE: usize = 3;
/// Times the density may be doubled.
const MAX_LEVEL: u32 = 4;
/// Part of a domain by which a region may reach past the border through rounding.
const PAST_BORDER: f64 = 1e-9;

/// Pastes by a least-squares fit. Both surfaces are clamped.
pub(super) fn paste(
    feature: &Feature<'_>,
    ground: &Ground<'_>,
    settings: &Settings,
) -> Result<Pasted, PasteError> {
    let contour = contour_polygon(feature.source, feature.contour)?;
    let (source, sets) = refine_for_region(feature.source, &contour, settings.rule, NEEDED)?;
    let base = smoothed(&source, &sets.own)?;
    let map = parameter_map(&base, feature.anchor, ground, settings)?;
    let field = Field::new(&source, &base, &sets.own, map, settings)?;
    let corners = field.corners();
    refuse_outside(&corners, ground.target)?;
    let raise = |source: &KnotVector| source.degree().min(DEGREE);
    let target = ground.target.elevated(raise(source.knots_u()), raise(source.knots_v()))?;
    let mut level = 0;
    loop {
        let refined = field.densified(&target, &corners, level, settings.limit)?;
        let fitted = fit(&field, &refined, &corners, settings)?;
        if fitted.error <= settings.tolerance {
            return Ok(Pasted {
                surface: fitted.surface,
                refined,
                changed: fitted.free,
                map,
                method: Method::Fit,
                lost: 0,
                lost_detail: 0.0,
                fit_error: Some(fitted.error),
                offset: None,
            });
        }
        // A net that is twice as dense gains the order of its splines at best.
        let order = target.knots_u().degree().max(target.knots_v().degree()) as i32 + 1;
        let within_reach = fitted.error * 0.5_f64.powi(order * (MAX_LEVEL - level) as i32);
        if within_reach > settings.tolerance || level == MAX_LEVEL {
            let (error, tolerance, points) = (fitted.error, settings.tolerance, refined.net().len());
            return Err(PasteError::FitToleranceNotReached { error, tolerance, points });
        }
        level += 1;
    }
}

/// Tangent coordinates of the parameters: columns `S_u`, `S_v` in the orthonormal pair of the frame.
fn jacobian(surface: &NurbsSurface, at: [f64; 2], side: &'static str) -> Result<Matrix2<f64>, PasteError> {
    let (_, du, dv) = surface.first_derivatives(at[0], at[1]);
    let frame = frame_of(&du, &dv).ok_or(PasteError::SingularParametrisation { side, at })?;
    let (e, f) = (frame.column(0), frame.column(1));
    Ok(Matrix2::new(e.dot(&du), e.dot(&dv), f.dot(&du), f.dot(&dv)))
}

fn parameter_map(
    base: &NurbsSurface,
    anchor: [f64; 2],
    ground: &Ground<'_>,
    settings: &Settings,
) -> Result<ParameterMap, PasteError> {
    let on_source = jacobian(base, anchor, "source")?;
    let on_target = jacobian(ground.target, ground.at, "target")?;
    let (sine, cosine) = settings.angle.sin_cos();
    let [flip_u, flip_v] = match settings.mirror {
        Mirror::None => [1.0, 1.0],
        Mirror::U => [-1.0, 1.0],
        Mirror::V => [1.0, -1.0],
    };
    let turn = Matrix2::new(cosine, -sine, sine, cosine);
    let stretch = Matrix2::new(flip_u * settings.scale[0], 0.0, 0.0, flip_v * settings.scale[1]);
    let singular = PasteError::SingularParametrisation { side: "target", at: ground.at };
    let linear = on_target.try_inverse().ok_or(singular)? * turn * stretch * on_source;
    let linear = [[linear[(0, 0)], linear[(0, 1)]], [linear[(1, 0)], linear[(1, 1)]]];
    Ok(ParameterMap { linear, from: anchor, to: ground.at })
}

fn extent(corners: &[[f64; 2]; 4], k: usize) -> (f64, f64) {
    let at = || corners.iter().map(|c| c[k]);
    (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max))
}

fn refuse_outside(corners: &[[f64; 2]; 4], target: &NurbsSurface) -> Result<(), PasteError> {
    let domains = [target.knots_u().domain(), target.knots_v().domain()];
    for (k, domain) in domains.into_iter().enumerate() {
        let reach = extent(corners, k);
        let slack = PAST_BORDER * (domain.1 - domain.0);
        if reach.0 < domain.0 - slack || reach.1 > domain.1 + slack {
            return Err(PasteError::OutsideTarget { direction: ["u", "v"][k], reach, domain });
        }
    }
    Ok(())
}

/// Part of a domain by which a window is drawn in, above what counts as on a knot line.
const DRAWN_IN: f64 = 4e-9;

/// The window a little smaller: a side on a knot line would take in the cells beyond it, however large.
fn drawn_in(corners: &[[f64; 2]; 4], domains: [(f64, f64); 2]) -> [[f64; 2]; 4] {
    let extents = [0, 1].map(|k| extent(corners, k));
    let centre = extents.map(|(low, high)| 0.5 * (low + high));
    let share = |k: usize| DRAWN_IN * (domains[k].1 - domains[k].0) / (centre[k] - extents[k].0);
    let part = share(0).max(share(1)).min(0.5);
    corners.map(|corner| [0, 1].map(|k| corner[k] + part * (centre[k] - corner[k])))
}

struct Fitted {
    surface: NurbsSurface,
    free: Mask,
    error: f64,
}

/// Control points that act inside the image of the window alone, off the border rows.
fn free_points(cells: &Mask, grid: &CellGrid, margin: usize) -> Mask {
    let own = grid.control_points(cells).without(&grid.control_points(&cells.complement()));
    own.off_border(margin)
}

fn fit(
    field: &Field<'_>,
    refined: &NurbsSurface,
    corners: &[[f64; 2]; 4],
    settings: &Settings,
) -> Result<Fitted, PasteError> {
    let (u, v) = refined.domain();
    let polygon = Polygon::new(&drawn_in(corners, [u, v]), [0.0; 2], [u, v])
        .map_err(|_| PasteError::ContourDegenerate)?;
    let grid = CellGrid::new(refined.knots_u(), refined.knots_v());
    let mut cells = grid.met_by(&polygon);
    cells.unite(&grid.inside(&polygon));
    let free = free_points(&cells, &grid, settings.margin);
    if free.count() == 0 {
        return Err(PasteError::RegionTooSmall { rows: 0, columns: 0, needed: 1 });
    }
    let ground = match settings.existing {
        Existing::Replace => smoothed(refined, &free)?,
        _ => refined.clone(),
    };
    let solution = least_squares(field, &ground, &cells, &free)?;
    let columns = free.count();
    let mut net = ground.net().to_vec();
    for (k, at) in free.indices().enumerate() {
        let weight = net[at][3];
        for (c, coordinate) in net[at].iter_mut().take(3).enumerate() {
            *coordinate += weight * solution[c * columns + k];
        }
    }
    let surface = with_net(refined, mended(&ground, &with_net(refined, net)?, &free))?;
    let error = greatest_deviation(field, &ground, &surface, &cells);
    Ok(Fitted { surface, free, error })
}
