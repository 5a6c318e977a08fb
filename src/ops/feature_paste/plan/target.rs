//! The target face made ready: its surface as NURBS over the same parameters, and where a place is on it.

use super::super::error::PasteError;
use super::super::settings::{Method, Settings};
use super::Place;
use crate::brep::FaceId;
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::net::Polygon;
use crate::ops::net::acting::ON_BORDER;
use crate::ops::net::spline_form::{Bound, SplineForm};

/// Whether the surface's own normal is the outward one of its face.
pub(super) fn natural_sense(model: &Model, face: FaceId) -> bool {
    let face = &model.brep.faces[face];
    face.same_sense == model.brep.shells[face.shell].forward
}

/// A face that can take a feature.
#[derive(Debug, Clone)]
pub(super) struct Target {
    /// Its B-spline form.
    pub form: SplineForm,
}

impl Target {
    pub fn of(model: &Model, face: FaceId) -> Result<Self, OperationError> {
        let form = SplineForm::of(model, face, |name, kind| unfit(name, kind).into())?;
        Ok(Self { form })
    }

    /// Whether two regions, each in the covering plane, share a point of the surface.
    pub fn overlap(&self, a: &[(f64, f64); 2], b: &[(f64, f64); 2]) -> bool {
        let (u, v) = self.form.surface.domain();
        (0..2).all(|k| {
            let domain = [u, v][k];
            let ways = if self.form.round[k] { vec![-1.0, 0.0, 1.0] } else { vec![0.0] };
            let period = domain.1 - domain.0;
            ways.into_iter().any(|way| a[k].0 < b[k].1 + way * period && b[k].0 + way * period < a[k].1)
        })
    }

    /// Engines that smooth the target want one that is smooth inside: an exact quadric's quarters meet at knots of full
    /// multiplicity.
    ///
    /// # Errors
    /// [`PasteError::MethodCannot`].
    pub fn refuse_method(&self, settings: &Settings) -> Result<(), PasteError> {
        let method = settings.chosen_method()?;
        if self.form.converted.is_some() && matches!(method, Method::Poisson | Method::Biharmonic) {
            let reason = "smooths the target, whose quarters meet in knots of full multiplicity; expected \
                          `displacement` or `fit`";
            return Err(PasteError::MethodCannot { method: method.as_str(), reason });
        }
        Ok(())
    }

    /// Parameters of a place; it must lie within the face's loops.
    pub fn locate(&self, surface: &NurbsSurface, place: &Place) -> Result<[f64; 2], PasteError> {
        let off = |reason: String| PasteError::PlaceOffFace {
            face: self.form.name.clone(),
            place: place.at.coords.into(),
            reason,
        };
        let found = SurfaceLocator::new(surface, Wrap::default()).closest(&place.at);
        let size = surface.bounding_box().diagonal();
        if found.distance > FAR * size {
            return Err(off(format!("the surface is {:.6} away", found.distance)));
        }
        let at = [found.u, found.v];
        let (u, v) = surface.domain();
        // A seam is a bound on paper only.
        let inside = [0, 1].map(|k| {
            let (low, high) = [u, v][k];
            let inset = if self.form.round[k] { 2.0 * ON_BORDER * (high - low) } else { 0.0 };
            at[k].clamp(low + inset, high - inset)
        });
        for Bound { name, contour, outer, .. } in &self.form.bounds {
            let Ok(polygon) = Polygon::new(&contour.points, contour.margin, [u, v]) else { continue };
            if polygon.contains(inside) != *outer {
                let side = if *outer { "outside" } else { "inside" };
                return Err(off(format!("it is {side} loop {name}")));
            }
        }
        Ok(at)
    }
}

/// A place farther from the surface than this part of its size is a mistake, not a point beside it.
const FAR: f64 = 0.05;
fn unfit(face: String, kind: &str) -> PasteError {
    let expected = "a feature goes onto a B-spline, a plane, a cylinder, a cone, a sphere, a torus, or a surface of extrusion or revolution";
    PasteError::SurfaceKind { side: "target", face, kind: kind.to_owned(), expected }
}
