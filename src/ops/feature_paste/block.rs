//! The working part of two matched nets: the box round the feature's control points with two rings.

use super::PasteError;
use super::base::smoothed;
use super::frames::{carry, frame_at};
use super::matching::Matched;
use super::settings::{Existing, Method, Settings, Turn};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Matrix3, Vector3};
use crate::ops::net::Mask;

/// Rings of context round the feature's control points.
const RINGS: usize = 2;

/// A homogeneous point `(w x, w y, w z, w)`.
pub(super) type Point = [f64; 4];

/// Nets of source, target and their bases over the same box, row by row.
pub(super) struct Block {
    pub rows: usize,
    pub columns: usize,
    /// The feature's control points in the box.
    pub own: Mask,
    /// The source's net in the target's homogeneous scale.
    pub source: Vec<Point>,
    /// Its base, in the same scale.
    pub source_base: Vec<Point>,
    /// The target's net.
    pub target: Vec<Point>,
    /// Its base.
    pub target_base: Vec<Point>,
    /// Flat indices on the whole target.
    pub places: Vec<usize>,
    /// Linear map of detail for each of the feature's control points, in order.
    pub carries: Vec<Matrix3<f64>>,
    /// Physical Greville abscissae of rows and columns.
    pub abscissae: [Vec<f64>; 2],
}

/// Euclidean point of a homogeneous one.
pub(super) fn euclidean(point: &Point) -> Vector3<f64> {
    Vector3::new(point[0], point[1], point[2]) / point[3]
}

impl Block {
    /// Gathers the box of a matched pair; `base` is the source's where it is known already.
    pub fn new(
        matched: &Matched,
        base: Option<&NurbsSurface>,
        method: Method,
        settings: &Settings,
    ) -> Result<Self, PasteError> {
        let small = || PasteError::RegionTooSmall { rows: 0, columns: 0, needed: 1 };
        let extent = matched.own.extent().ok_or_else(small)?;
        let ranges = [0, 1].map(|k| {
            let pick = |s: (usize, usize)| if k == 0 { s.0 } else { s.1 };
            let (n, m) = (pick(matched.source.shape()) as isize, pick(matched.target.shape()) as isize);
            let d = matched.offset[k];
            let low = (extent[k].0 as isize - RINGS as isize).max(0).max(-d);
            let high = (extent[k].1 as isize + RINGS as isize + 1).min(n).min(m - d);
            (low as usize, high as usize)
        });
        let (rows, columns) = (ranges[0].1 - ranges[0].0, ranges[1].1 - ranges[1].0);
        let source_columns = matched.source.shape().1;
        let on_source: Vec<usize> = (ranges[0].0..ranges[0].1)
            .flat_map(|i| (ranges[1].0..ranges[1].1).map(move |j| i * source_columns + j))
            .collect();
        let places: Vec<usize> = on_source.iter().map(|&at| matched.partner(at)).collect();
        let mut own = Mask::empty(rows, columns);
        for (k, &at) in on_source.iter().enumerate().filter(|&(_, &at)| matched.own.contains_index(at)) {
            debug_assert!(at < matched.source.net().len());
            own.insert(k / columns, k % columns);
        }
        let source_base = match base {
            Some(base) => base.clone(),
            None => smoothed(&matched.source, &matched.own)?,
        };
        let keeps_target = method == Method::Displacement && settings.existing == Existing::Keep;
        let target_base =
            if keeps_target { matched.target.clone() } else { smoothed(&matched.target, &matched.partners)? };
        let take = |s: &NurbsSurface, at: &[usize]| at.iter().map(|&k| s.net()[k]).collect::<Vec<Point>>();
        let (target, target_points) = (take(&matched.target, &places), take(&target_base, &places));
        let raw = take(&matched.source, &on_source);
        let factor = homogeneous_scale(&own, &raw, &target);
        let scaled = |net: Vec<Point>| net.into_iter().map(|p| p.map(|c| c * factor)).collect::<Vec<Point>>();
        let greville = [matched.source.knots_u().greville(), matched.source.knots_v().greville()];
        let abscissae = [0, 1]
            .map(|k| greville[k][ranges[k].0..ranges[k].1].iter().map(|g| g * matched.speeds[k]).collect());
        let carries = carries(matched, &source_base, &target_base, &on_source, settings)?;
        let source_base = scaled(take(&source_base, &on_source));
        Ok(Self {
            rows,
            columns,
            own,
            source: scaled(raw),
            source_base,
            target,
            target_base: target_points,
            places,
            carries,
            abscissae,
        })
    }
}

/// Mean weight of the target over that of the source, on the ring round the feature's control points.
fn homogeneous_scale(own: &Mask, source: &[Point], target: &[Point]) -> f64 {
    let ring = own.dilated(1).without(own);
    let sum = |net: &[Point]| ring.indices().map(|at| net[at][3]).sum::<f64>();
    let factor = sum(target) / sum(source);
    if factor.is_finite() && factor > 0.0 { factor } else { 1.0 }
}

/// The linear maps of the feature's control points, from frames at Greville abscissae.
fn carries(
    matched: &Matched,
    source_base: &NurbsSurface,
    target_base: &NurbsSurface,
    on_source: &[usize],
    settings: &Settings,
) -> Result<Vec<Matrix3<f64>>, PasteError> {
    let abscissae = |s: &NurbsSurface| [s.knots_u().greville(), s.knots_v().greville()];
    let (gs, gt) = (abscissae(source_base), abscissae(target_base));
    let at = |g: &[Vec<f64>; 2], k: usize| [g[0][k / g[1].len()], g[1][k % g[1].len()]];
    let own = on_source.iter().filter(|&&k| matched.own.contains_index(k));
    let one = |&k: &usize| {
        if settings.turn == Turn::None {
            return Ok(Matrix3::identity());
        }
        let source = frame_at(source_base, at(&gs, k), "source")?;
        let target = frame_at(target_base, at(&gt, matched.partner(k)), "target")?;
        Ok(carry(&source, &target, settings.turn, &settings.scale))
    };
    own.map(one).collect()
}
