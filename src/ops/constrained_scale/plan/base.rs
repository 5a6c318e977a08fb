//! Faces that bear held loops: planes, on which a loop moves freely, and surfaces that have to be stretched, as exact
//! B-splines with the loops in their parameters.

use super::carrier::{Carrier, carrier};
use super::held::Held;
use super::layout::{Layouts, lay_out_on};
use super::scope::face_name;
use crate::brep::FaceId;
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Carried, Surface};
use crate::math::Frame;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::task::Contour;
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
    /// Held loops: number among all, polygon in the parameters of the carrier.
    pub held: Vec<(usize, Contour)>,
    /// The outer loop, where it is not the natural border.
    pub outer: Option<Contour>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Contour>,
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
    let fault = |reason: &str| {
        let reason = reason.to_owned();
        OperationError::NoParameterLoops { face: face_name(model, face), reason }
    };
    let carrier = carrier(model, face, layouts.of(model, face)?)?;
    let layout = lay_out_on(model, face, &carrier.surface)?;
    let mut base = NetBase { carrier, held: Vec::new(), outer: None, scaled: Vec::new() };
    for (at, shape) in layout.loops.iter().enumerate() {
        let Some(shape) = shape else { continue };
        let contour = homed(base.carrier.contour(&shape.contour), &base.carrier.surface);
        if let Some(number) = held.loops_of(face).find(|&k| held.loops[k].at == at) {
            base.held.push((number, contour));
        } else if layout.is_inner(at) {
            base.scaled.push(contour);
        } else if !on_border(&base.carrier.surface, &contour) {
            if !shape.closed {
                return Err(fault("a loop winds round the closed surface away from its border"));
            }
            base.outer = Some(contour);
        }
    }
    Ok(base)
}

/// A polygon moved by whole periods of a closed surface to where its middle lies in the domain.
fn homed(mut contour: Contour, surface: &NurbsSurface) -> Contour {
    let (u, v) = surface.domain();
    for (k, (domain, period)) in [u, v].into_iter().zip(closed_directions(surface)).enumerate() {
        let Some(period) = period else { continue };
        let low = contour.points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = contour.points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        // The middle of a loop that fills the period is that of the domain, but for rounding.
        let turns = ((0.5 * (domain.0 + domain.1) - 0.5 * (low + high)) / period).round();
        contour.points.iter_mut().for_each(|p| p[k] += turns * period);
    }
    contour
}

/// Distance from a side of the domain, as a part of its range, within which a loop runs on the natural border.
const ON_BORDER: f64 = 1e-7;

/// Whether every point of a loop lies on the natural border of a surface.
fn on_border(surface: &NurbsSurface, contour: &Contour) -> bool {
    let (u, v) = surface.domain();
    let near = |x: f64, (start, end): (f64, f64)| {
        let room = ON_BORDER * (end - start);
        (x - start).abs() <= room || (x - end).abs() <= room
    };
    contour.points.iter().all(|p| near(p[0], u) || near(p[1], v))
}
