//! Images of surfaces and curves under a motion: of the same kind where there is one, else of one that is exact.
//!
//! What has no image of its kind becomes a B-spline. A cylinder whose cross-section is stretched is the extrusion of an
//! ellipse as well: that keeps angle and height as parameters and needs no seam, so that readers find its edges on it
//! exactly in files without parameter curves.

use super::carrier::{Carrier, exact};
use super::follow::Mover;
use super::layout::outline;
use super::rigid::{moved_curve, moved_surface};
use super::scope::face_name;
use crate::brep::{EdgeId, FaceId, edge_range};
use crate::geometry::{Carried, Curve, ParameterLine, ParameterMap, Surface};
use crate::math::Affine;
use crate::model::Model;
use crate::ops::Obstacle;

/// How the parameters of a surface follow.
#[derive(Debug, Clone)]
pub(super) enum SurfaceParameters {
    /// By an affine map.
    Affine(ParameterMap),
    /// Each by itself, onto the exact B-spline that is given here before its motion.
    Lines(Box<Carrier>),
}

impl SurfaceParameters {
    pub fn stay() -> Self {
        Self::Affine(ParameterMap::identity())
    }
}

/// How the parameter of a curve follows.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum CurveParameter {
    /// The new parameter is the old one less this.
    Shift(f64),
    /// By a line.
    Line(ParameterLine),
}

impl CurveParameter {
    /// The new parameter, and its derivative by the old one.
    pub fn image(&self, t: f64) -> (f64, f64) {
        match self {
            Self::Shift(shift) => (t - shift, 1.0),
            Self::Line(line) => line.image(t),
        }
    }
}

/// The image of a face's surface with the way of its parameters.
///
/// # Errors
/// What cannot follow, and why.
pub(super) fn surface_image(
    model: &Model,
    face: FaceId,
    mover: &Mover,
) -> Result<(Surface, SurfaceParameters), Obstacle> {
    let refuse = |kind: &str, reason: String| Obstacle {
        entity: face_name(model, face),
        kind: kind.to_owned(),
        reason,
    };
    let surface = match model.brep.surface_of(face) {
        Carried::Read(surface) => surface,
        Carried::Unread { entity, reason } => return Err(refuse(entity, reason.clone())),
    };
    if mover.rigid {
        return Ok((moved_surface(surface, &mover.map), SurfaceParameters::stay()));
    }
    let kept =
        surface.transformed(&mover.map).and_then(|image| Ok((image, surface.parameter_map(&mover.map)?)));
    if let Ok((image, parameters)) = kept {
        return Ok((image, SurfaceParameters::Affine(parameters)));
    }
    // A B-spline wants parameter curves beside it, or every reader fits its own.
    let fitted = model.brep.coedges_of(face).all(|coedge| model.brep.coedges[coedge].pcurve.is_some());
    if !fitted && let Some((image, parameters)) = elliptic_cylinder(surface, &mover.map) {
        return Ok((image, SurfaceParameters::Affine(parameters)));
    }
    let layout = outline(model, face).map_err(|error| refuse(surface.kind(), error.to_string()))?;
    let carrier = exact(surface, &layout).map_err(|reason| refuse(surface.kind(), reason))?;
    let image = carrier.surface.transformed(&mover.map);
    Ok((Surface::Nurbs(image), SurfaceParameters::Lines(Box::new(carrier))))
}

/// A cylinder under any affine map: the extrusion of the image of its circle along the image of its axis.
fn elliptic_cylinder(surface: &Surface, map: &Affine) -> Option<(Surface, ParameterMap)> {
    let Surface::Cylinder { frame, radius } = surface else { return None };
    let circle = Box::new(Curve::Circle { frame: *frame, radius: *radius });
    let extrusion = Surface::LinearExtrusion { curve: circle, direction: frame.z };
    Some((extrusion.transformed(map).ok()?, extrusion.parameter_map(map).ok()?))
}

/// The image of an edge's curve with the way of its parameter.
///
/// # Errors
/// What cannot follow, and why.
pub(super) fn curve_image(
    model: &Model,
    edge: EdgeId,
    mover: &Mover,
) -> Result<(Curve, CurveParameter), Obstacle> {
    let refuse = |kind: &str, reason: String| Obstacle {
        entity: model.origins.edges[edge].to_string(),
        kind: kind.to_owned(),
        reason,
    };
    let curve = match model.brep.curve_of(edge) {
        Carried::Read(curve) => curve,
        Carried::Unread { entity, reason } => return Err(refuse(entity, reason.clone())),
    };
    if mover.rigid {
        return Ok((moved_curve(curve, &mover.map), CurveParameter::Shift(0.0)));
    }
    let error = match curve.transformed_with_shift(&mover.map) {
        Ok((image, shift)) => return Ok((image, CurveParameter::Shift(shift))),
        Err(error) => error,
    };
    let range = edge_range(&model.brep, edge).map(|r| (r.start.min(r.end), r.start.max(r.end)));
    let spline =
        range.and_then(|range| Some((curve.to_nurbs(range).ok()?, ParameterLine::of_curve(curve, range)?)));
    let (spline, line) = spline.ok_or_else(|| refuse(curve.kind(), error.to_string()))?;
    Ok((Curve::Nurbs(spline.transformed(&mover.map)), CurveParameter::Line(line)))
}
