//! The engine for any angle, mirror, scale and parametrisation: the feature's displacement field, carried by an
//! affine map of the parameters and the frames of both surfaces, fitted by least squares on the target's net.
//!
//! The map of parameters is affine by design, so that curves in parameters are carried exactly.

use super::PasteError;
use super::base::{smoothed, solve, with_net};
use super::creases::mended;
use super::frames::frame_of;
use super::identify::{contour_polygon, refine_for_region};
use super::settings::{Existing, Feature, Ground, Method, Mirror, ParameterMap, Pasted, Settings};
use crate::geometry::nurbs::{KnotVector, LocalBasis, NurbsSurface};
use crate::math::quadrature::gauss_legendre;
use crate::math::{CsMat, Matrix2, Matrix3, TriMat, Vector3};
use crate::ops::net::{CellGrid, Mask, Polygon};

/// Rows and columns of own control points that a region needs.
const NEEDED: usize = 6;
/// Degree to which a target of lower degree is raised, unless the source's is lower.
pub(super) const DEGREE: usize = 3;
/// Times the density may be doubled.
const MAX_LEVEL: u32 = 3;
/// Parts of the greatest entry below which an entry of the parameter map says nothing about density.
const SMALL_ENTRY: f64 = 1e-3;
/// Part of a domain by which a region may reach past the border through rounding.
const PAST_BORDER: f64 = 1e-9;
/// Slack of a count of parts: a span that fits in by rounding is not cut.
const WHOLE: f64 = 1e-6;

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
        let refined = field.densified(&target, &corners, level)?;
        let points = refined.net().len();
        if points > settings.limit {
            return Err(PasteError::NetTooLarge { points, limit: settings.limit });
        }
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
        if level == MAX_LEVEL {
            let (error, tolerance) = (fitted.error, settings.tolerance);
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

/// The displacement that the feature asks for, as a function of the target's parameters.
struct Field<'a> {
    source: &'a NurbsSurface,
    base: &'a NurbsSurface,
    /// Rectangle of source parameters outside which there is none.
    window: [(f64, f64); 2],
    map: ParameterMap,
    inverse: ParameterMap,
    scale: [f64; 3],
    /// -1 for a mirrored feature.
    side: f64,
}

impl<'a> Field<'a> {
    fn new(
        source: &'a NurbsSurface,
        base: &'a NurbsSurface,
        own: &Mask,
        map: ParameterMap,
        settings: &Settings,
    ) -> Result<Self, PasteError> {
        let small = PasteError::RegionTooSmall { rows: 0, columns: 0, needed: NEEDED };
        let window = own.support([source.knots_u(), source.knots_v()]).ok_or(small)?;
        let singular = PasteError::SingularParametrisation { side: "target", at: map.to };
        let inverse = map.inverse().ok_or(singular)?;
        let side = if settings.mirror == Mirror::None { 1.0 } else { -1.0 };
        Ok(Self { source, base, window, map, inverse, scale: settings.scale, side })
    }

    /// Images of the window's corners.
    fn corners(&self) -> [[f64; 2]; 4] {
        let [u, v] = self.window;
        [[u.0, v.0], [u.1, v.0], [u.1, v.1], [u.0, v.1]].map(|x| self.map.apply(x))
    }

    /// The displacement at target parameters with the target's derivatives there.
    fn at(&self, y: [f64; 2], (tu, tv): (&Vector3<f64>, &Vector3<f64>)) -> Vector3<f64> {
        let x = self.inverse.apply(y);
        let outside = (0..2).any(|k| x[k] < self.window[k].0 || x[k] > self.window[k].1);
        if outside {
            return Vector3::zeros();
        }
        let (point, bu, bv) = self.base.first_derivatives(x[0], x[1]);
        let detail = self.source.point(x[0], x[1]) - point;
        let along = tu * self.map.linear[0][0] + tv * self.map.linear[1][0];
        let (Some(from), Some(e)) = (frame_of(&bu, &bv), along.try_normalize(0.0)) else {
            return Vector3::zeros();
        };
        let Some(n) = tu.cross(tv).try_normalize(0.0) else { return Vector3::zeros() };
        let to = Matrix3::from_columns(&[e, n.cross(&e) * self.side, n]);
        let local = from.transpose() * detail;
        to * Vector3::new(local.x * self.scale[0], local.y * self.scale[1], local.z * self.scale[2])
    }

    /// The target with spans under the feature as short as the source's are there.
    fn densified(
        &self,
        target: &NurbsSurface,
        corners: &[[f64; 2]; 4],
        level: u32,
    ) -> Result<NurbsSurface, PasteError> {
        let spacing = [(self.source.knots_u(), 0), (self.source.knots_v(), 1)]
            .map(|(knots, k)| median_span(knots, self.window[k]));
        let greatest = self.map.linear.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        let mut out = target.clone();
        for k in 0..2 {
            let entries = (0..2).filter(|&m| self.map.linear[k][m].abs() >= SMALL_ENTRY * greatest);
            let step =
                entries.map(|m| self.map.linear[k][m].abs() * spacing[m]).fold(f64::INFINITY, f64::min);
            let step = step / f64::from(1 << level);
            let range = extent(corners, k);
            let knots = if k == 0 { out.knots_u() } else { out.knots_v() };
            let ends = new_ends(knots, range, step);
            out = if k == 0 { out.refined_u(&ends)? } else { out.refined_v(&ends)? };
            let knots = if k == 0 { out.knots_u() } else { out.knots_v() };
            let more = subdivisions(knots, range, step);
            out = if k == 0 { out.refined_u(&more)? } else { out.refined_v(&more)? };
        }
        Ok(out)
    }
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

/// Median length of the spans within a range.
fn median_span(knots: &KnotVector, (start, end): (f64, f64)) -> f64 {
    let (distinct, _) = knots.distinct();
    let inside = distinct.windows(2).filter(|w| w[1] > start && w[0] < end);
    let mut lengths: Vec<f64> = inside.map(|w| w[1] - w[0]).collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths.len() / 2;
    match lengths.len() {
        0 => end - start,
        n if n % 2 == 1 => lengths[middle],
        _ => 0.5 * (lengths[middle - 1] + lengths[middle]),
    }
}

/// Ends of a range that become knots, so that a long span is not refined beyond it: those farther than a step from
/// every knot.
fn new_ends(knots: &KnotVector, (start, end): (f64, f64), step: f64) -> Vec<f64> {
    let far = |x: &f64| knots.knots().iter().all(|k| (k - x).abs() > step);
    [start, end].into_iter().filter(far).collect()
}

/// Knots that cut every span that meets the range into equal parts no longer than `step`.
fn subdivisions(knots: &KnotVector, (start, end): (f64, f64), step: f64) -> Vec<f64> {
    let (distinct, _) = knots.distinct();
    let mut more = Vec::new();
    let slack = WHOLE * (end - start);
    for w in distinct.windows(2).filter(|w| w[1] > start + slack && w[0] < end - slack) {
        let length = w[1] - w[0];
        let parts = (length / step - WHOLE).ceil();
        // The caller refuses nets beyond its limit; a span is never cut into more than a million parts.
        let parts = if parts.is_finite() { parts.clamp(1.0, 1e6) as usize } else { 1 };
        more.extend((1..parts).map(|m| w[0] + length * (m as f64 / parts as f64)));
    }
    more
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
    let polygon = Polygon::new(corners, [0.0; 2], [u, v]).map_err(|_| PasteError::ContourDegenerate)?;
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
    let system = System::gather(field, &ground, &cells, &free);
    let solution = system.solve()?;
    let columns = free.count();
    let mut net = ground.net().to_vec();
    for (k, at) in free.indices().enumerate() {
        let weight = net[at][3];
        for (c, coordinate) in net[at].iter_mut().take(3).enumerate() {
            *coordinate += weight * solution[c * columns + k];
        }
    }
    let net = mended(&ground, &with_net(refined, net)?, &free);
    let mut solution = solution;
    for (k, at) in free.indices().enumerate() {
        for c in 0..3 {
            solution[c * columns + k] = (net[at][c] - ground.net()[at][c]) / net[at][3];
        }
    }
    let error = system.error(&solution);
    Ok(Fitted { surface: with_net(refined, net)?, free, error })
}

/// One sample of the field: its basis functions and value.
struct Sample {
    bases: (LocalBasis, LocalBasis),
    weight: f64,
    value: Vector3<f64>,
}

/// Samples at the Gauss points of all cells.
struct System<'a> {
    samples: Vec<Sample>,
    ground: &'a NurbsSurface,
    number: Vec<usize>,
    unknowns: usize,
}

impl<'a> System<'a> {
    fn gather(field: &Field<'_>, ground: &'a NurbsSurface, cells: &Mask, free: &Mask) -> Self {
        let lines = [ground.knots_u(), ground.knots_v()].map(gauss_lines);
        let columns = cells.shape().1;
        let mut samples = Vec::new();
        for cell in cells.indices() {
            for (bu, wu, u) in &lines[0][cell / columns] {
                for (bv, wv, v) in &lines[1][cell % columns] {
                    let at = ground.derivatives_by(bu, bv);
                    let value = field.at([*u, *v], (&at.du, &at.dv));
                    samples.push(Sample { bases: (bu.clone(), bv.clone()), weight: wu * wv, value });
                }
            }
        }
        let mut number = vec![usize::MAX; ground.net().len()];
        let mut unknowns = 0;
        for at in free.indices() {
            number[at] = unknowns;
            unknowns += 1;
        }
        Self { samples, ground, number, unknowns }
    }

    /// Unknowns that act at a sample, with their rational basis values.
    fn entries(&self, sample: &Sample, into: &mut Vec<(usize, f64)>) {
        into.clear();
        let (bu, bv) = &sample.bases;
        let columns = self.ground.shape().1;
        let mut sum = 0.0;
        for (i, nu) in bu.values().iter().enumerate() {
            for (j, nv) in bv.values().iter().enumerate() {
                let at = (bu.first() + i) * columns + bv.first() + j;
                let value = nu * nv * self.ground.net()[at][3];
                sum += value;
                if self.number[at] != usize::MAX {
                    into.push((self.number[at], value));
                }
            }
        }
        into.iter_mut().for_each(|(_, value)| *value /= sum);
    }

    fn solve(&self) -> Result<Vec<f64>, PasteError> {
        let n = self.unknowns;
        let mut matrix = TriMat::new((n, n));
        let mut right = vec![0.0; 3 * n];
        let mut entries = Vec::new();
        // Samples of one cell share their functions: their products are added up before they become triplets.
        for of_cell in
            self.samples.chunk_by(|a, b| a.bases.0.span == b.bases.0.span && a.bases.1.span == b.bases.1.span)
        {
            let mut local: Vec<f64> = Vec::new();
            let mut places: Vec<usize> = Vec::new();
            for sample in of_cell.iter().filter(|sample| sample.weight > 0.0) {
                self.entries(sample, &mut entries);
                if local.is_empty() {
                    places = entries.iter().map(|e| e.0).collect();
                    local = vec![0.0; places.len() * places.len()];
                }
                let m = places.len();
                for (a, (k, value)) in entries.iter().enumerate() {
                    for c in 0..3 {
                        right[c * n + k] += sample.weight * value * sample.value[c];
                    }
                    for (sum, (_, other)) in local[a * m..(a + 1) * m].iter_mut().zip(&entries) {
                        *sum += sample.weight * value * other;
                    }
                }
            }
            for (at, sum) in local.iter().enumerate() {
                matrix.add_triplet(places[at / places.len()], places[at % places.len()], *sum);
            }
        }
        let matrix: CsMat<f64> = matrix.to_csr();
        solve(&matrix, &mut right)?;
        Ok(right)
    }

    /// Greatest deviation at the samples.
    fn error(&self, solution: &[f64]) -> f64 {
        let n = self.unknowns;
        let mut worst = 0.0_f64;
        let mut entries = Vec::new();
        for sample in &self.samples {
            self.entries(sample, &mut entries);
            let mut rest = -sample.value;
            for (k, value) in &entries {
                rest += Vector3::new(solution[*k], solution[n + k], solution[2 * n + k]) * *value;
            }
            worst = worst.max(rest.norm());
        }
        worst
    }
}

/// Places of a cell, from -1 to 1, between the Gauss points and its ends, at which a fit is compared too.
const BETWEEN: [f64; 2] = [-0.97, 0.97];

/// For each cell of one direction its Gauss points: basis, weight and parameter; and, with weight 0, places between.
fn gauss_lines(knots: &KnotVector) -> Vec<Vec<(LocalBasis, f64, f64)>> {
    let (nodes, weights) = gauss_legendre(knots.degree() + 1);
    let (distinct, _) = knots.distinct();
    let of_cell = |w: &[f64]| {
        let (half, middle) = (0.5 * (w[1] - w[0]), 0.5 * (w[0] + w[1]));
        let between = BETWEEN.iter().map(|x| (x, &0.0));
        let points = nodes.iter().zip(&weights).chain(between);
        points
            .map(|(x, weight)| {
                let at = middle + half * x;
                (knots.basis_derivatives(at, 2), weight * half, at)
            })
            .collect()
    };
    distinct.windows(2).map(of_cell).collect()
}
