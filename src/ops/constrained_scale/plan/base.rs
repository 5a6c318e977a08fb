//! Faces that bear held loops: planes, on which a loop moves freely, and surfaces that have to be stretched, as exact
//! B-splines with the loops in their parameters.
//!
//! A surface that closes on itself is cut open where no loop is in the way, stretched, and closed again where it was.

use super::carrier::{Carrier, carrier};
use super::held::Held;
use super::layout::{Layouts, LoopShape, lay_out_on};
use super::scope::face_name;
use super::winding::{Round, outline};
use crate::brep::FaceId;
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Carried, Surface};
use crate::math::Frame;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::task::Contour;
use crate::ops::net::KnotRows;
use crate::ops::net::acting::closed_directions;

/// A face with held loops.
#[derive(Debug, Clone)]
pub(super) enum Base {
    /// A plane: nothing has to be stretched.
    Plane(Frame),
    /// A surface that is stretched.
    Net(Box<NetBase>),
}

/// A face to stretch.
#[derive(Debug, Clone)]
pub(super) struct NetBase {
    /// Its exact B-spline.
    pub carrier: Carrier,
    /// What is stretched: the B-spline, or that cut open elsewhere.
    pub surface: NurbsSurface,
    /// Seams that were moved, in the order in which they were.
    moved: Vec<MovedSeam>,
    /// Held loops: number among all, polygon in the parameters of what is stretched.
    pub held: Vec<(usize, Contour)>,
    /// The outer loop, where it is not the natural border.
    pub outer: Option<Contour>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Contour>,
}

/// A closed surface that was cut open elsewhere.
#[derive(Debug, Clone, Copy)]
struct MovedSeam {
    /// 0 for `u`, 1 for `v`.
    direction: usize,
    /// Its old domain.
    domain: (f64, f64),
    /// Where the old seam is now.
    seam: f64,
}

impl Base {
    /// The face as one to stretch.
    pub fn net(&self) -> Option<&NetBase> {
        match self {
            Self::Plane(_) => None,
            Self::Net(base) => Some(base),
        }
    }
}

impl NetBase {
    /// A stretched surface with its seams where those of the carrier are.
    pub fn restored(&self, stretched: &NurbsSurface) -> NurbsSurface {
        let mut surface = stretched.clone();
        for moved in self.moved.iter().rev() {
            let along = upright(&surface, moved.direction);
            // Refinement keeps the knot of the old seam; a smooth one may have gone, and is cut anew.
            let opened = along.opened_u(moved.seam, moved.domain);
            let (opened, _) = opened.expect("a surface that was cut open can be cut open again");
            surface = upright(&opened, moved.direction);
        }
        surface
    }
}

/// A surface with a direction as its first.
fn upright(surface: &NurbsSurface, direction: usize) -> NurbsSurface {
    if direction == 0 { surface.clone() } else { surface.swapped() }
}

/// Lays out all faces with held loops.
pub(super) fn lay_out(model: &Model, held: &mut Held, layouts: &mut Layouts) -> Result<(), OperationError> {
    for k in 0..held.loops.len() {
        let face = held.loops[k].face;
        if held.bases.contains_key(&face) {
            continue;
        }
        let base = match model.brep.surface_of(face) {
            Carried::Read(Surface::Plane(frame)) => Base::Plane(*frame),
            _ => Base::Net(Box::new(net_base(model, face, held, layouts)?)),
        };
        held.bases.insert(face, base);
    }
    Ok(())
}

fn net_base(
    model: &Model,
    face: FaceId,
    held: &Held,
    layouts: &mut Layouts,
) -> Result<NetBase, OperationError> {
    let carrier = carrier(model, face, layouts.of(model, face)?)?;
    let layout = lay_out_on(model, face, &carrier.surface)?;
    let clamped = carrier.surface.clamped();
    let surface = clamped.mended(MEETS * clamped.bounding_box().diagonal());
    let mut base =
        NetBase { carrier, surface, moved: Vec::new(), held: Vec::new(), outer: None, scaled: Vec::new() };
    let (mut rest, mut inner) = (Vec::new(), Vec::new());
    for (at, shape) in layout.loops.iter().enumerate() {
        let Some(shape) = shape else { continue };
        let contour = base.carrier.contour(&shape.contour);
        let number = held.loops_of(face).find(|&k| held.loops[k].at == at);
        if number.is_some() || layout.is_inner(at) {
            inner.push((number, contour));
        } else {
            rest.push(LoopShape { contour, closed: shape.closed });
        }
    }
    for direction in 0..2 {
        cut_open(&mut base, direction, &inner, &rest);
    }
    for (number, contour) in inner {
        let contour = homed(contour, &base.surface);
        match number {
            Some(number) => base.held.push((number, contour)),
            None => base.scaled.push(contour),
        }
    }
    for shape in rest.iter_mut().filter(|shape| shape.closed) {
        shape.contour = homed(std::mem::take(&mut shape.contour), &base.surface);
    }
    let round = Round { surface: &base.surface, same_sense: model.brep.faces[face].same_sense };
    base.outer = outline(&round, rest).map_err(|reason| {
        let (face, reason) = (face_name(model, face), reason.to_owned());
        OperationError::NoParameterLoops { face, reason }
    })?;
    Ok(base)
}

/// Part of the surface's size within which the two sides of a knot that occurs too often meet.
const MEETS: f64 = 1e-9;
/// Part of the widest way round between inner loops that must be left between them and the seam, or the seam moves.
const SEAM_ROOM: f64 = 0.25;
/// Part of the surface's size by which control points may move when the knot of a smooth seam is removed.
const SMOOTH: f64 = 1e-10;

/// Cuts a closed surface open in the middle of the widest way between loops when its seam is in the way of one. A face
/// that fills the surface between edges along its seam is left as it is.
fn cut_open(base: &mut NetBase, direction: usize, inner: &[(Option<usize>, Contour)], rest: &[LoopShape]) {
    let Some(period) = closed_directions(&base.surface)[direction] else { return };
    let (u, v) = base.surface.domain();
    let domain = [u, v][direction];
    let closed = rest.iter().filter(|shape| shape.closed).map(|shape| &shape.contour);
    let mut spans: Vec<(f64, f64)> =
        inner.iter().map(|(_, c)| c).chain(closed).map(|c| extent(c, direction)).collect();
    for span in &mut spans {
        let turns = ((span.0 - domain.0) / period).floor() * period;
        *span = (span.0 - turns, span.1 - turns);
    }
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((low, high)) = widest(&spans, period) else { return };
    let room = spans.iter().map(|s| (s.0 - domain.0).min(domain.1 - s.1)).fold(f64::INFINITY, f64::min);
    if room >= SEAM_ROOM * (high - low) {
        return;
    }
    let middle = 0.5 * (low + high);
    let cut = domain.0 + (middle - domain.0).rem_euclid(period);
    let along = upright(&base.surface, direction);
    let Some((opened, seam)) = along.opened_u(cut, (cut, cut + period)) else { return };
    let mut rows = KnotRows::new(&opened);
    rows.smooth(seam, SMOOTH * opened.bounding_box().diagonal());
    let opened = rows.surface().unwrap_or(opened);
    base.surface = upright(&opened, direction);
    base.moved.push(MovedSeam { direction, domain, seam });
}

fn extent(contour: &Contour, direction: usize) -> (f64, f64) {
    let values = || contour.points.iter().map(|p| p[direction]);
    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
}

/// The widest gap between spans on a circle; spans ascend by their starts.
fn widest(spans: &[(f64, f64)], period: f64) -> Option<(f64, f64)> {
    let (first, _) = spans.first()?;
    let mut reached = f64::NEG_INFINITY;
    let mut gaps = Vec::new();
    for span in spans {
        if reached.is_finite() {
            gaps.push((reached, span.0));
        }
        reached = reached.max(span.1);
    }
    gaps.push((reached, first + period));
    gaps.into_iter().filter(|gap| gap.1 > gap.0).max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
}

/// A polygon moved by whole periods of a closed surface to where its middle lies in the domain.
fn homed(mut contour: Contour, surface: &NurbsSurface) -> Contour {
    let (u, v) = surface.domain();
    for (k, (domain, period)) in [u, v].into_iter().zip(closed_directions(surface)).enumerate() {
        let Some(period) = period else { continue };
        let (low, high) = extent(&contour, k);
        // The middle of a loop that fills the period is that of the domain, but for rounding.
        let turns = ((0.5 * (domain.0 + domain.1) - 0.5 * (low + high)) / period).round();
        contour.points.iter_mut().for_each(|p| p[k] += turns * period);
    }
    contour
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ParameterLine;
    use crate::math::{Point3, Vector3};
    use std::f64::consts::TAU;

    /// A cylinder of radius 2 with a hole round a place, and what it becomes.
    fn opened(at: f64) -> (NurbsSurface, NetBase, Contour) {
        let frame = Frame { origin: Point3::origin(), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() };
        let surface = Surface::Cylinder { frame, radius: 2.0 }.to_nurbs((0.0, TAU), (0.0, 5.0)).unwrap();
        let lines = [ParameterLine::Same, ParameterLine::Same];
        let carrier = Carrier { surface: surface.clone(), lines };
        let (held, scaled) = (Vec::new(), Vec::new());
        let mut base =
            NetBase { carrier, surface: surface.clone(), moved: Vec::new(), held, outer: None, scaled };
        let points =
            (0..12).map(|k| f64::from(k) * TAU / 12.0).map(|t| [at + 0.3 * t.cos(), 2.5 + 0.3 * t.sin()]);
        let contour = Contour { points: points.collect(), margin: [0.0; 2] };
        for direction in 0..2 {
            cut_open(&mut base, direction, &[(Some(0), contour.clone())], &[]);
        }
        (surface, base, contour)
    }

    #[test]
    fn a_hole_over_the_seam_moves_the_seam_to_the_other_side_and_back() {
        let (whole, base, contour) = opened(0.1);
        assert_eq!(base.moved.len(), 1);
        let (start, end) = base.surface.domain().0;
        assert!((start - (0.1 + 0.5 * TAU)).abs() < 1e-6 && (end - start - TAU).abs() < 1e-12);
        let homed = homed(contour.clone(), &base.surface);
        for (old, new) in contour.points.iter().zip(&homed.points) {
            assert!(new[0] > start && new[0] < end);
            let there = base.surface.point(new[0], new[1]);
            let here = whole.point(old[0].rem_euclid(TAU), old[1]);
            assert!((there - here).norm() < 1e-12);
        }
        let back = base.restored(&base.surface);
        assert_eq!(back.domain(), whole.domain());
        for k in 0..=40 {
            let u = TAU * f64::from(k) / 40.0;
            assert!((back.point(u, 1.0) - whole.point(u, 1.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn a_hole_away_from_the_seam_leaves_it() {
        let (whole, base, _) = opened(3.0);
        assert!(base.moved.is_empty());
        assert_eq!(base.restored(&base.surface), whole);
    }
}
