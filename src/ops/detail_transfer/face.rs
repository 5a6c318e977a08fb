//! Detail laid over a face: each parameter line that runs along gets the detail of the source, in the frame of its own
//! coarse curve and of the surface's normal.
//!
//! The lines through the Greville abscissae across are done one by one, and their detail is interpolated by the
//! columns of the net. Control points that act on a bound of the face, or lie outside the band, stay as they are; the
//! detail rises over a few control points beside them. So edges, vertices and neighbours stay valid.
//!
//! Planes, quadrics and swept surfaces become B-splines first. Weights stay: along a line the detail is multiplied by
//! them and the product held exactly, at the cost of the degree.
//!
//! What it does not do: detail across a seam; it ends there.

use super::embed::snapped;
use super::error::TransferError;
use super::measure::extent;
use super::on_curve::prepared;
use super::params::{
    Direction, FaceTarget, Measures, Params, Plan, SMOOTH, TOLERANCE, completed, in_file, notes,
};
use super::prepare::{Prepared, prepare};
use super::settings::{Existing, Frame, Settings, TargetBase};
use super::spline::Spline;
use super::transfer::{SourceDetail, Transferred, transfer_split};
use super::weighted::{MOST_DEGREE, product_knots};
use crate::geometry::nurbs::{GrevilleCollocation, KnotVector, NurbsSurface};
use crate::geometry::{Curve, Surface};
use crate::math::Vector3;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::net::Mask;
use crate::ops::net::creases::mended;
use crate::ops::net::spline_form::SplineForm;

/// Control points over which detail rises beside one that stays.
const RISE: usize = 3;
/// Spans across the band at least: fewer would hold no detail beside those that stay and those where it rises.
const BAND_SPANS: usize = 16;

/// Plans a transfer onto a face.
pub(super) fn plan(
    model: &Model,
    params: &Params<'_>,
    target: &FaceTarget,
    source: &Prepared,
    source_name: &str,
) -> Result<Plan, OperationError> {
    let unfit = |name: String, kind: &str| face_error(&name, &format!("it is a {kind}; {KINDS}")).into();
    let form = SplineForm::of(model, target.face, unfit)?;
    // From here on the detail runs along the first parameter.
    let along = match target.direction {
        Direction::U => form.surface.clamped(),
        Direction::V => form.surface.swapped().clamped(),
    };
    let band = band(&along, target.across)?;
    let middle = middle_line(&along, band, &form.name, params)?;
    let settings = settings(model, params, target, source, &middle.spline, &form.name)?;
    let named = |error| in_file(error, source_name, &form.name);
    let lines = Lines {
        along: &along,
        source: SourceDetail::of(&source.spline, &settings).map_err(named)?,
        outward: outward(model, target),
        tolerance: params.tolerance.unwrap_or(TOLERANCE * middle.spline.size()),
        name: &form.name,
    };
    let made = lines.at(0.5 * (band.0 + band.1), &settings).map_err(named)?;
    let knots = lines.knots(&made).ok_or_else(|| face_error(&form.name, "its degree is too high"))?;
    let refined =
        refined(&along, &knots, band).ok_or_else(|| face_error(&form.name, "its knots cannot be refined"))?;
    let field = lines.field(&refined, band, &settings).map_err(named)?;
    let weights = weights(&refined, &form, target.direction, band, settings.ends);
    let new = added(&refined, &field, &weights).ok_or(TransferError::NotFinite)?;
    let still = new.net() == refined.net();
    if !still && weights.iter().all(|weight| *weight < 1.0) {
        return Err(face_error(&form.name, "its bounds leave no room for detail").into());
    }
    let new = if target.direction == Direction::V { new.swapped() } else { new };
    let measures = measures(&form.name, &settings, [source, &middle], [&along, &refined], &made);
    let notes = notes(&measures, &form.name);
    let mut change_set = ChangeSet::default();
    if !still {
        change_set = form.changes(model, target.face, new, [false; 2]);
    }
    Ok(Plan { change_set, measures, notes })
}

/// What detail can be laid over.
const KINDS: &str = "detail is laid over a B-spline, a plane, a cylinder, a cone, a sphere, a torus, or a surface of \
                     extrusion or revolution";

/// The line in the middle of the band.
fn middle_line(
    along: &NurbsSurface,
    band: (f64, f64),
    name: &str,
    params: &Params<'_>,
) -> Result<Prepared, TransferError> {
    let middle = Curve::Nurbs(along.iso_curve_v(0.5 * (band.0 + band.1)));
    prepared(&middle, name, params.tolerance)
}

/// The settings of all lines.
fn settings(
    model: &Model,
    params: &Params<'_>,
    target: &FaceTarget,
    source: &Prepared,
    middle: &Spline,
    name: &str,
) -> Result<Settings, TransferError> {
    let mut settings = completed(params, &source.spline, middle)?;
    settings.ends = params.ends.unwrap_or(SMOOTH.min(source.spline.knots.degree()));
    if settings.ends == 0 {
        return Err(face_error(name, "free ends would move its edges; hold them in position at least"));
    }
    let plain =
        matches!(model.brep.surface_of(target.face).read(), Some(Surface::Nurbs(s)) if !s.is_rational());
    if settings.existing == Existing::Replace && !plain {
        return Err(face_error(
            name,
            "its own detail can be replaced on a B-spline surface without weights only",
        ));
    }
    if !plain {
        settings.target_base = TargetBase::AsItIs;
    }
    settings.normals = [bulge(&source.spline), None];
    Ok(settings)
}

fn face_error(face: &str, reason: &str) -> TransferError {
    TransferError::Face { face: face.to_owned(), reason: reason.to_owned() }
}

/// Part of the domain within which a band ends at a knot.
const ON_KNOT: f64 = 1e-9;

/// The band in the second parameter.
fn band(along: &NurbsSurface, [from, to]: [f64; 2]) -> Result<(f64, f64), TransferError> {
    let (start, end) = along.knots_v().domain();
    let knots = along.knots_v().knots();
    let at = |part: f64| {
        let at = start + (end - start) * part;
        knots.iter().copied().find(|k| (k - at).abs() <= ON_KNOT * (end - start)).unwrap_or(at)
    };
    if (0.0..to).contains(&from) && to <= 1.0 {
        Ok((at(from), at(to)))
    } else {
        Err(TransferError::BadInterval { start: from, end: to })
    }
}

/// 1 when the cross product of the derivatives, along first, looks out of the face's body, else -1.
fn outward(model: &Model, target: &FaceTarget) -> f64 {
    let face = &model.brep.faces[target.face];
    let natural = face.same_sense == model.brep.shells[face.shell].forward;
    if natural == (target.direction == Direction::U) { 1.0 } else { -1.0 }
}

/// The side to which a curve bulges from its chord: it goes outwards. `None` for a closed or a straight one.
fn bulge(curve: &Spline) -> Option<Vector3<f64>> {
    let points = || curve.points.iter().map(|p| Vector3::from(*p));
    let (first, last) = (points().next()?, points().next_back()?);
    let chord = (last - first).try_normalize(0.0)?;
    let off = |p: Vector3<f64>| (p - first) - chord * chord.dot(&(p - first));
    let far = points().map(off).max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
    far.try_normalize(STRAIGHT * curve.size())
}

/// Distance from the chord, as a part of the size, up to which a curve is straight.
const STRAIGHT: f64 = 1e-9;

/// The parameter lines along, and what they get.
struct Lines<'a> {
    along: &'a NurbsSurface,
    source: SourceDetail,
    outward: f64,
    /// Of the splines without weights that stand for lines with weights where frames are taken from.
    tolerance: f64,
    name: &'a str,
}

impl Lines<'_> {
    /// The transfer onto the line at a parameter across.
    fn at(&self, across: f64, settings: &Settings) -> Result<Transferred, TransferError> {
        let lost = || TransferError::DegenerateBase { curve: "target", at: across };
        let line = Curve::Nurbs(self.along.iso_curve_v(across));
        let line = prepare(&line, self.name, self.tolerance)?.spline;
        let start = settings.interval.unwrap_or(line.domain()).0;
        let mut settings = settings.clone();
        if settings.frame == Frame::Local {
            let normal = self.along.normal(start, across).ok_or_else(lost)?;
            settings.normals[1] = Some(normal * self.outward);
        }
        transfer_split(&line, &self.source, &settings)
    }

    /// Whether weights differ along a line: the detail then has to be multiplied by them.
    fn weighted(&self) -> bool {
        let columns = self.along.shape().1;
        let net = self.along.net();
        net.iter().zip(&net[columns..]).any(|(a, b)| a[3] != b[3])
    }

    /// Knots along that hold the surface, and the detail times the weights; `None` above the greatest degree.
    fn knots(&self, made: &Transferred) -> Option<KnotVector> {
        if !self.weighted() {
            return Some(made.curve.knots.clone());
        }
        let own = self.along.knots_u();
        let detail = &made.detail.knots;
        let snapped = KnotVector::new(detail.degree(), snapped(own, detail)).ok()?;
        product_knots(own, &snapped).filter(|knots| knots.degree() <= MOST_DEGREE)
    }

    /// Control points of the detail, times the weights, over the net of the refined surface, column by column.
    fn field(
        &self,
        refined: &NurbsSurface,
        band: (f64, f64),
        settings: &Settings,
    ) -> Result<Vec<[f64; 3]>, TransferError> {
        let rows = refined.shape().0;
        let lost = |_| TransferError::NotFinite;
        let collocation = [refined.knots_u(), refined.knots_v()].map(GrevilleCollocation::new);
        let [u, v] = collocation;
        let (u, v) = (u.map_err(lost)?, v.map_err(lost)?);
        let mut values = Vec::with_capacity(refined.net().len() * 3);
        for &across in v.abscissae() {
            // Beside the band nothing is added; there the nearest line of it serves as well.
            let detail = self.at(across.clamp(band.0, band.1), settings)?.detail;
            let line = refined.iso_curve_v(across);
            let column = values.len();
            for &at in u.abscissae() {
                let weight = line.homogeneous_point(at)[3];
                values.extend(detail.at(at)[0].iter().map(|c| weight * c));
            }
            u.solve_rows(&mut values[column..], 3);
        }
        v.solve_rows(&mut values, rows * 3);
        Ok(values.as_chunks::<3>().0.to_vec())
    }
}

/// The surface over knots along that hold its own, and with spans enough across the band.
fn refined(along: &NurbsSurface, knots: &KnotVector, (from, to): (f64, f64)) -> Option<NurbsSurface> {
    let elevated = along.elevated(knots.degree(), along.knots_v().degree()).ok()?;
    let mut more = Vec::new();
    for same in knots.knots().chunk_by(|a, b| a == b) {
        let lacking = same.len().saturating_sub(elevated.knots_u().multiplicity(same[0]));
        more.extend(std::iter::repeat_n(same[0], lacking));
    }
    elevated.refined_u(&more).ok()?.refined_v(&band_knots(&elevated.knots_v().distinct().0, from, to)).ok()
}

/// Knots that a band lacks: at its ends, and so many between that it has spans enough.
fn band_knots(knots: &[f64], from: f64, to: f64) -> Vec<f64> {
    let inner = knots.iter().copied().filter(|&k| from < k && k < to);
    let breaks: Vec<f64> = std::iter::once(from).chain(inner).chain(std::iter::once(to)).collect();
    let pieces = BAND_SPANS.div_ceil(breaks.len() - 1);
    let cuts = breaks.windows(2).flat_map(|pair| {
        let (low, high) = (pair[0], pair[1]);
        (1..pieces).map(move |k| low + (high - low) * k as f64 / pieces as f64)
    });
    let ends = [from, to].into_iter().filter(|end| !knots.contains(end));
    let mut cuts: Vec<f64> = cuts.chain(ends).collect();
    cuts.sort_by(f64::total_cmp);
    cuts
}

/// For each control point, row by row along, what part of the detail it gets.
fn weights(
    refined: &NurbsSurface,
    form: &SplineForm,
    direction: Direction,
    (from, to): (f64, f64),
    ends: usize,
) -> Vec<f64> {
    let (rows, columns) = refined.shape();
    let mut stay = Mask::empty(rows, columns);
    let knots = refined.knots_v();
    for j in 0..columns {
        let border = j < ends || j + ends >= columns;
        // A control point acts between the first and the last of its knots.
        let (first, last) = (knots.knots()[j], knots.knots()[j + knots.degree() + 1]);
        if border || first < from || last > to {
            (0..rows).for_each(|i| stay.insert(i, j));
        }
    }
    let net = match direction {
        Direction::U => refined.clone(),
        Direction::V => refined.swapped(),
    };
    for (_, acting) in form.acting_on_loops(&net) {
        for at in acting.indices() {
            match direction {
                Direction::U => stay.insert(at / columns, at % columns),
                Direction::V => stay.insert(at % rows, at / rows),
            }
        }
    }
    let mut weights = vec![1.0; rows * columns];
    for distance in (0..=RISE).rev() {
        let part = distance as f64 / (RISE + 1) as f64;
        for at in stay.dilated(distance).indices() {
            weights[at] = part * part * (3.0 - 2.0 * part);
        }
    }
    weights
}

/// The surface with the detail, column by column, that its weights, row by row, let through. Where quarters of a circle
/// meet it stays as smooth as it was.
fn added(refined: &NurbsSurface, field: &[[f64; 3]], weights: &[f64]) -> Option<NurbsSurface> {
    let (rows, columns) = refined.shape();
    let mut net = refined.net().to_vec();
    let mut changed = Mask::empty(rows, columns);
    for (at, point) in net.iter_mut().enumerate() {
        let detail = field[at % columns * rows + at / columns];
        for (c, d) in point.iter_mut().zip(detail) {
            *c += weights[at] * d;
        }
        if weights[at] > 0.0 {
            changed.insert(at / columns, at % columns);
        }
    }
    let over = |net| NurbsSurface::new(refined.knots_u().clone(), refined.knots_v().clone(), net).ok();
    let new = over(net)?;
    over(mended(refined, &new, &changed))
}

/// Figures: lengths are those of the middle line of the band, as if it got all of the detail.
fn measures(
    name: &str,
    settings: &Settings,
    [source, middle]: [&Prepared; 2],
    [before, after]: [&NurbsSurface; 2],
    made: &Transferred,
) -> Measures {
    let extent = extent(made);
    let (start, end) = middle.spline.domain();
    Measures {
        target: name.to_owned(),
        levels_available: made.levels_available,
        levels: made.levels.clone(),
        scale: made.scale,
        ends_held: settings.ends,
        interval: settings.interval.unwrap_or((start, end)).into(),
        greatest_detail: extent.greatest,
        detail_times_curvature: extent.fold,
        end_shift: extent.ends,
        length: [&middle.spline, &made.curve].map(|curve| curve.length(start, end)),
        degree: [before, after].map(|surface| surface.knots_u().degree()),
        control_points: [before, after].map(|surface| surface.net().len()),
        source_deviation: source.deviation,
        target_deviation: 0.0,
    }
}
