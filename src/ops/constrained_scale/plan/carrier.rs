//! The exact B-spline that takes the place of a face's surface, over the parameters that the face needs, and how its
//! parameters follow from the old ones.

use super::layout::Layout;
use super::scope::face_name;
use crate::brep::FaceId;
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Carried, Curve, ParameterLine, Surface};
use crate::model::Model;
use crate::ops::constrained_scale::task::Contour;
use crate::ops::{Obstacle, OperationError};
use std::f64::consts::FRAC_PI_2;

/// An exact B-spline of a face's surface.
#[derive(Debug, Clone)]
pub(super) struct Carrier {
    /// The B-spline.
    pub surface: NurbsSurface,
    /// Its parameters from those of the face's surface.
    pub lines: [ParameterLine; 2],
}

impl Carrier {
    /// Whether parameters stay.
    pub fn is_same(&self) -> bool {
        self.lines.iter().all(|line| *line == ParameterLine::Same)
    }

    /// A polygon in the parameters of the B-spline.
    pub fn contour(&self, contour: &Contour) -> Contour {
        let mut margin = contour.margin;
        let mut steepest = [0.0_f64; 2];
        let points = contour.points.iter().map(|point| {
            [0, 1].map(|k| {
                let (image, slope) = self.lines[k].image(point[k]);
                steepest[k] = steepest[k].max(slope.abs());
                image
            })
        });
        let points = points.collect();
        for (margin, slope) in margin.iter_mut().zip(steepest) {
            *margin *= slope;
        }
        Contour { points, margin }
    }
}

/// Parameters that a face covers, along `u` and along `v`.
type Window = [(f64, f64); 2];

/// The exact B-spline of the surface of a face with this layout.
///
/// # Errors
/// [`OperationError::CannotFollow`] when the surface was not read or has no exact B-spline.
pub(super) fn carrier(model: &Model, face: FaceId, layout: &Layout) -> Result<Carrier, OperationError> {
    let refuse = |kind: &str, reason: String| {
        let obstacle = Obstacle { entity: face_name(model, face), kind: kind.to_owned(), reason };
        OperationError::CannotFollow { obstacles: vec![obstacle] }
    };
    match model.brep.surface_of(face) {
        Carried::Read(surface) => exact(surface, layout).map_err(|reason| refuse(surface.kind(), reason)),
        Carried::Unread { entity, reason } => Err(refuse(entity, reason.clone())),
    }
}

/// The exact B-spline of a surface over what a layout reaches.
///
/// # Errors
/// A lower-case fragment.
pub(super) fn exact(surface: &Surface, layout: &Layout) -> Result<Carrier, String> {
    if let Surface::Nurbs(surface) = surface {
        let lines = [ParameterLine::Same, ParameterLine::Same];
        return Ok(Carrier { surface: surface.clone(), lines });
    }
    let unknown = || "the parameters that the face covers are not known".to_owned();
    let [u, v] = window(surface, layout).ok_or_else(unknown)?;
    let spline = surface.to_nurbs(u, v).map_err(|error| error.to_string())?;
    let lines = ParameterLine::of_surface(surface, u, v).ok_or_else(unknown)?;
    Ok(Carrier { surface: spline, lines })
}

/// Part of a period by which a loop may fall short of a whole turn through sampling and rounding.
const NEARLY: f64 = 1e-6;
/// Part of a range within which points are at its end.
const AT_END: f64 = 1e-9;
/// Part of a range by which samples may miss where a loop reaches farthest.
const ROOM: f64 = 0.02;

/// The parameters that the loops of a face reach; a whole period where they go all round, and up to the pole where a
/// loop winds round the axis alone.
fn window(surface: &Surface, layout: &Layout) -> Option<Window> {
    let shapes = || layout.loops.iter().flatten();
    let windings = shapes().filter(|l| !l.closed).count();
    let (du, dv) = surface.domain();
    let (pu, pv) = surface.periods();
    let reach = |k: usize, domain: (f64, f64), period: Option<f64>| {
        let (low, high) = reached(shapes().map(|l| &l.contour), k, domain, turns(surface, k));
        match period {
            Some(period) if high - low >= period * (1.0 - NEARLY) || windings > 0 => {
                let start = if turns(surface, k) { low } else { domain.0 };
                (start, start + period)
            }
            _ => (low, high),
        }
    };
    let u = reach(0, du, pu);
    let v = if windings == 1 && pv.is_none() { to_pole(surface, reach(1, dv, pv)) } else { reach(1, dv, pv) };
    [u, v].iter().all(|range| range.1 > range.0).then_some([u, v])
}

/// First and last parameter of the loops, with room where they only touch it; not beyond the domain of what has ends.
fn reached<'a>(
    loops: impl Iterator<Item = &'a Contour> + Clone,
    k: usize,
    domain: (f64, f64),
    endless: bool,
) -> (f64, f64) {
    let points = || loops.clone().flat_map(|contour| contour.points.iter().map(move |p| p[k]));
    let low = points().fold(f64::INFINITY, f64::min);
    let high = points().fold(f64::NEG_INFINITY, f64::max);
    let near = AT_END * (high - low);
    // A side along the end is the end itself; a single point may have farther ones beside it.
    let along = |end: f64| {
        let at = |contour: &Contour| contour.points.iter().filter(|p| (p[k] - end).abs() <= near).count();
        loops.clone().any(|contour| at(contour) > 1)
    };
    let room = ROOM * (high - low);
    let low = if along(low) { low } else { low - room };
    let high = if along(high) { high } else { high + room };
    if endless { (low, high) } else { (low.max(domain.0), high.min(domain.1)) }
}

/// Whether a parameter is an angle, which may start anywhere.
fn turns(surface: &Surface, k: usize) -> bool {
    let conic = |curve: &Curve| matches!(curve, Curve::Circle { .. } | Curve::Ellipse { .. });
    match surface {
        Surface::Cylinder { .. } | Surface::Cone { .. } | Surface::Sphere { .. } => k == 0,
        Surface::Torus { .. } => true,
        Surface::Revolution { curve, .. } => k == 0 || conic(curve),
        Surface::LinearExtrusion { curve, .. } => k == 0 && conic(curve),
        Surface::CurveBounded { basis } => turns(basis, k),
        _ => false,
    }
}

/// A cap round a pole is bounded by one loop that winds round the axis: the face goes on to a pole.
fn to_pole(surface: &Surface, v: (f64, f64)) -> (f64, f64) {
    match surface {
        Surface::Sphere { .. } => (-FRAC_PI_2, FRAC_PI_2),
        Surface::Cone { radius, semi_angle, .. } => {
            let apex = -radius / semi_angle.tan();
            (v.0.min(apex), v.1.max(apex))
        }
        Surface::Revolution { curve, .. } => {
            let (first, last) = curve.domain();
            if first.is_finite() && last.is_finite() { (first, last) } else { v }
        }
        _ => v,
    }
}
