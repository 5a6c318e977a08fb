//! Making two nets match: equal degrees, knots of one scale, every knot of either in both, and the indices of
//! control points that have the same knots.

use super::PasteError;
use super::identify::{Identified, identify};
use super::settings::{Ends, Ground, ParameterMap, Settings};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::ops::net::sampling::{Tangents, steps};
use crate::ops::net::{Mask, Polygon};

/// Part of the window within which two knots are one.
const SAME_KNOT: f64 = 1e-9;
/// Part of a domain by which the window keeps away from its ends: the multiplicity of end knots must not get into
/// the inside of the other surface.
const OPEN: f64 = 1e-7;
/// Part of the target's knot range within which the knots of partners agree.
const PARTNERS: f64 = 1e-8;
/// Samples in each direction at which the speed of the source's parameters is measured.
const SPEED_SAMPLES: usize = 9;

/// The map `x ↦ factor x + shift` of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineMap {
    /// Factor, positive.
    pub factor: f64,
    /// Shift.
    pub shift: f64,
}

impl LineMap {
    fn image(&self, x: f64) -> f64 {
        self.factor * x + self.shift
    }

    fn original(&self, y: f64) -> f64 {
        (y - self.shift) / self.factor
    }
}

/// Two nets with the same knots under the feature.
#[derive(Debug, Clone)]
pub struct Matched {
    /// Refined source.
    pub source: NurbsSurface,
    /// Refined target.
    pub target: NurbsSurface,
    /// The feature's control points on the source that have a partner on the target.
    pub own: Mask,
    /// The partners.
    pub partners: Mask,
    /// Row and column of the target that the source's first ones fall on.
    pub offset: [isize; 2],
    /// Knot maps of `u` and `v`.
    pub maps: [LineMap; 2],
    /// Lengths of source parameters on the target, per knot unit.
    pub speeds: [f64; 2],
    /// The feature's control points without a partner.
    pub lost: Mask,
}

impl Matched {
    /// Flat index on the target of a flat index on the source.
    #[must_use]
    pub fn partner(&self, at: usize) -> usize {
        let (columns, target_columns) = (self.source.shape().1, self.target.shape().1);
        let (i, j) = ((at / columns) as isize + self.offset[0], (at % columns) as isize + self.offset[1]);
        // Partners exist, so both are indices of the target.
        i as usize * target_columns + j as usize
    }

    /// The knot maps as one map of parameters.
    #[must_use]
    pub fn parameter_map(&self, anchor: [f64; 2], at: [f64; 2]) -> ParameterMap {
        let [u, v] = self.maps.map(|m| m.factor);
        ParameterMap { linear: [[u, 0.0], [0.0, v]], from: anchor, to: at }
    }
}

/// Speeds `|S_u|`, `|S_v|` at a point.
fn speeds(surface: &NurbsSurface, at: [f64; 2]) -> [f64; 2] {
    let t = Tangents::of(surface, at[0], at[1]);
    [t.du.norm(), t.dv.norm()]
}

/// Mean speeds of the source's base over the box of the contour.
fn mean_speeds(base: &NurbsSurface, contour: &Polygon) -> [f64; 2] {
    let [u, v] = bounds(contour);
    let mut sum = [0.0; 2];
    for x in steps(u.0, u.1, SPEED_SAMPLES) {
        for y in steps(v.0, v.1, SPEED_SAMPLES) {
            let s = speeds(base, [x, y]);
            sum = [sum[0] + s[0], sum[1] + s[1]];
        }
    }
    sum.map(|s| s / (SPEED_SAMPLES * SPEED_SAMPLES) as f64)
}

/// Least and greatest parameters of a polygon.
pub(super) fn bounds(contour: &Polygon) -> [(f64, f64); 2] {
    [0, 1].map(|k| {
        let at = || contour.points().iter().map(|p| p[k]);
        (at().fold(f64::INFINITY, f64::min), at().fold(f64::NEG_INFINITY, f64::max))
    })
}

/// Matches the nets of a source with its index sets and a target.
///
/// `base` is the source without its feature. The degrees must be equal already. The knots of neighbours up to
/// `reach` rows and columns away must agree too.
///
/// # Errors
/// [`PasteError::OutsideTarget`], [`PasteError::RegionTooSmall`], [`PasteError::NetTooLarge`],
/// [`PasteError::SingularParametrisation`], [`PasteError::Knots`].
pub fn matched(
    (source, sets, base): (&NurbsSurface, &Identified, &NurbsSurface),
    contour: &Polygon,
    anchor: [f64; 2],
    ground: &Ground<'_>,
    (settings, reach): (&Settings, usize),
) -> Result<Matched, PasteError> {
    let target = ground.target;
    let (on_source, on_target) = (mean_speeds(base, contour), speeds(target, ground.at));
    let maps = [0, 1].map(|k| {
        let factor = settings.scale[k] * on_source[k] / on_target[k];
        LineMap { factor, shift: ground.at[k] - factor * anchor[k] }
    });
    if maps.iter().any(|m| !(m.factor.is_finite() && m.factor > 0.0 && m.shift.is_finite())) {
        return Err(PasteError::SingularParametrisation { side: "target", at: ground.at });
    }
    let small = || PasteError::RegionTooSmall { rows: 0, columns: 0, needed: 1 };
    let (acting, own) = (sets.acting.extent().ok_or_else(small)?, sets.own.extent().ok_or_else(small)?);
    let mut lines = Vec::with_capacity(2);
    for k in 0..2 {
        let knots = [direction(source, k), direction(target, k)];
        let mut line = Line::new(knots, maps[k], acting[k], own[k], ["u", "v"][k])?;
        if settings.ends == Ends::Inserted {
            line.insert_ends(knots, maps[k]);
        }
        lines.push(line);
    }
    let counts = [0, 1].map(|k| direction(target, k).n_basis() + lines[k].into_target.len());
    let points = counts[0].saturating_mul(counts[1]);
    if points > settings.limit {
        return Err(PasteError::NetTooLarge { points, limit: settings.limit });
    }
    let source = source.refined_u(&lines[0].into_source)?.refined_v(&lines[1].into_source)?;
    let target = target.refined_u(&lines[0].into_target)?.refined_v(&lines[1].into_target)?;
    let mut offset = [0; 2];
    for k in 0..2 {
        let knots = [direction(&source, k), direction(&target, k)];
        offset[k] = index_offset(knots, maps[k], lines[k].window).ok_or_else(small)?;
    }
    let found = identify(&source, contour, settings.rule).own.off_border(1);
    let (own, partners) = with_partners((&source, &target), &found, offset, maps, (settings, reach));
    if own.count() == 0 {
        return Err(small());
    }
    let speeds = [0, 1].map(|k| settings.scale[k] * on_source[k]);
    let lost = found.without(&own);
    Ok(Matched { source, target, own, partners, offset, maps, speeds, lost })
}

fn direction(surface: &NurbsSurface, k: usize) -> &KnotVector {
    if k == 0 { surface.knots_u() } else { surface.knots_v() }
}

/// Knots that one direction lacks on either side.
struct Line {
    window: (f64, f64),
    into_source: Vec<f64>,
    into_target: Vec<f64>,
}

impl Line {
    fn new(
        [source, target]: [&KnotVector; 2],
        map: LineMap,
        acting: (usize, usize),
        own: (usize, usize),
        name: &'static str,
    ) -> Result<Self, PasteError> {
        let p = source.degree();
        let (from, to) = (source.domain(), target.domain());
        let support = |(first, last): (usize, usize)| (source.knots()[first], source.knots()[last + p + 1]);
        let needed = support(own);
        let reach = (map.image(needed.0), map.image(needed.1));
        let slack = SAME_KNOT * (to.1 - to.0);
        if reach.0 < to.0 - slack || reach.1 > to.1 + slack {
            return Err(PasteError::OutsideTarget { direction: name, reach, domain: to });
        }
        let wide = support(acting);
        let (inner_from, inner_to) = (OPEN * (from.1 - from.0), OPEN * (to.1 - to.0) / map.factor);
        let window = (
            wide.0.max(from.0 + inner_from).max(map.original(to.0) + inner_to),
            wide.1.min(from.1 - inner_from).min(map.original(to.1) - inner_to),
        );
        let (into_source, into_target) = lacking(source, target, window, map);
        Ok(Self { window, into_source, into_target })
    }
}

impl Line {
    /// Puts the ends of the source's domain into the target, where they fall between its knots.
    fn insert_ends(&mut self, [source, target]: [&KnotVector; 2], map: LineMap) {
        let (from, to) = (source.domain(), target.domain());
        for end in [from.0, from.1].map(|x| map.image(x)) {
            let slack = OPEN * (to.1 - to.0);
            let inside = end > to.0 + slack && end < to.1 - slack;
            let known = target.knots().iter().chain(&self.into_target).any(|k| (k - end).abs() <= slack);
            if inside && !known {
                self.into_target.push(end);
            }
        }
    }
}

/// Every knot of either within the window, as often as it occurs more often there.
fn lacking(
    source: &KnotVector,
    target: &KnotVector,
    window: (f64, f64),
    map: LineMap,
) -> (Vec<f64>, Vec<f64>) {
    let slack = SAME_KNOT * (window.1 - window.0);
    let inside = |x: f64| x >= window.0 - slack && x <= window.1 + slack;
    let (on_source, counts) = source.distinct();
    let (on_target, target_counts) = target.distinct();
    let pulled: Vec<f64> = on_target.iter().map(|&y| map.original(y)).collect();
    let near = |list: &[f64], x: f64| {
        let from = list.partition_point(|&k| k < x - slack);
        list.get(from).filter(|&&k| k <= x + slack).map(|_| from)
    };
    let (mut into_source, mut into_target) = (Vec::new(), Vec::new());
    for (k, (&x, &count)) in on_source.iter().zip(&counts).enumerate().filter(|(_, (x, _))| inside(**x)) {
        let found = near(&pulled, x);
        let count = if is_end(k, on_source.len()) { 1 } else { count };
        let y = found.map_or_else(|| map.image(x), |at| on_target[at]);
        let have = found.map_or(0, |at| target_counts[at]);
        into_target.extend(std::iter::repeat_n(y, count.saturating_sub(have)));
    }
    for (k, (&x, &count)) in pulled.iter().zip(&target_counts).enumerate().filter(|(_, (x, _))| inside(**x)) {
        let found = near(&on_source, x);
        let count = if is_end(k, pulled.len()) { 1 } else { count };
        let y = found.map_or(x, |at| on_source[at]);
        let have = found.map_or(0, |at| counts[at]);
        into_source.extend(std::iter::repeat_n(y, count.saturating_sub(have)));
    }
    (into_source, into_target)
}

fn is_end(k: usize, count: usize) -> bool {
    k == 0 || k + 1 == count
}

/// Difference of the indices of one knot that both have.
fn index_offset([source, target]: [&KnotVector; 2], map: LineMap, window: (f64, f64)) -> Option<isize> {
    let (distinct, _) = source.distinct();
    let inside: Vec<f64> = distinct.into_iter().filter(|&k| k >= window.0 && k <= window.1).collect();
    let middle = *inside.get(inside.len() / 2)?;
    Some(nearest(target, map.image(middle)) as isize - nearest(source, middle) as isize)
}

/// First index of the knot nearest to a value.
fn nearest(knots: &KnotVector, x: f64) -> usize {
    let all = knots.knots();
    let off = |k: usize| (all[k] - x).abs();
    (0..all.len()).reduce(|best, k| if off(k) < off(best) { k } else { best }).unwrap_or(0)
}

/// The feature's control points of which all inner knots are those of their partner, and the partners.
///
/// For engines that compare differences, the neighbours' knots must agree too.
fn with_partners(
    (source, target): (&NurbsSurface, &NurbsSurface),
    found: &Mask,
    offset: [isize; 2],
    maps: [LineMap; 2],
    (settings, reach): (&Settings, usize),
) -> (Mask, Mask) {
    let margin = settings.margin;
    let (shape, target_shape) = (source.shape(), target.shape());
    let (mut own, mut partners) =
        (Mask::empty(shape.0, shape.1), Mask::empty(target_shape.0, target_shape.1));
    let agree = [0, 1].map(|k| {
        let knots = [direction(source, k), direction(target, k)];
        let count = knots[0].n_basis();
        let same: Vec<Option<usize>> = (0..count).map(|i| partner(knots, i, offset[k], maps[k])).collect();
        let off_border = |i: usize, index: usize| {
            index >= margin && index + margin < knots[1].n_basis() && i >= 1 && i + 1 < count
        };
        let fits =
            |i: usize, index: usize| settings.ends == Ends::Open || same_support(knots, i, index, maps[k]);
        let near = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(count);
        (0..count)
            .map(|i| {
                same[i].filter(|&at| off_border(i, at) && fits(i, at) && near(i).all(|q| same[q].is_some()))
            })
            .collect::<Vec<Option<usize>>>()
    });
    for at in found.indices() {
        let (i, j) = (at / shape.1, at % shape.1);
        if let (Some(row), Some(column)) = (agree[0][i], agree[1][j]) {
            own.insert(i, j);
            partners.insert(row, column);
        }
    }
    (own, partners)
}

/// Whether two partners act on the same interval too.
fn same_support([source, target]: [&KnotVector; 2], i: usize, index: usize, map: LineMap) -> bool {
    let (start, end) = target.domain();
    let slack = PARTNERS * (end - start);
    let p = source.degree();
    [0, p + 1].iter().all(|k| (target.knots()[index + k] - map.image(source.knots()[i + k])).abs() <= slack)
}

/// Index on the target of the control point with the same inner knots.
fn partner([source, target]: [&KnotVector; 2], i: usize, offset: isize, map: LineMap) -> Option<usize> {
    let p = source.degree();
    let index = usize::try_from(i as isize + offset).ok().filter(|&index| index < target.n_basis())?;
    let (start, end) = target.domain();
    let slack = PARTNERS * (end - start);
    let pairs = target.knots()[index + 1..=index + p].iter().zip(&source.knots()[i + 1..=i + p]);
    pairs.into_iter().all(|(y, x)| (y - map.image(*x)).abs() <= slack).then_some(index)
}
