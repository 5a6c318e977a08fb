//! Feature paste: a freeform feature of one NURBS surface is carried onto another, with nothing changed outside.
//!
//! The feature is what a closed contour holds on its source, as deviation from a smooth base. Engines:
//! displacement of control points over matched knots (default), the published Poisson method, a biharmonic one, and a
//! least-squares fit for any angle, mirror and parametrisation. The result is one NURBS surface over the same domain.
//!
//! The numeric core ([`paste`]) takes surfaces and polygons in their parameters. It knows neither models nor files.
//!
//! Source: Poisson reuse of freeform features with the corrections of `docs/decisions/feature-paste.md`; displacement
//! and fit are our own.

mod across_seam;
mod base;
mod block;
pub mod contour;
mod displacement;
pub mod error;
mod fit;
mod frames;
pub mod identify;
mod laplacian;
mod matched_paste;
pub mod matching;
pub mod plan;
pub mod settings;

pub use contour::{Plane, project_contour};
pub use error::PasteError;
pub use identify::{Identified, contour_polygon, identify};
pub use settings::{
    EdgeWeights, Ends, Existing, Feature, Ground, Method, Mirror, ParameterMap, Pasted, Rule, Settings, Turn,
};

use crate::geometry::nurbs::{KnotVector, NurbsSurface};

/// Pastes a feature onto a surface.
///
/// # Errors
/// [`PasteError`]; there is no partly changed result.
pub fn paste(feature: &Feature<'_>, ground: &Ground<'_>, settings: &Settings) -> Result<Pasted, PasteError> {
    let method = settings.chosen_method()?;
    refuse_torn(feature.source, "source")?;
    refuse_torn(ground.target, "target")?;
    let (source, target) = (feature.source.clamped(), ground.target.clamped());
    for (what, at) in [("anchor on the source", feature.anchor), ("place on the target", ground.at)] {
        if !at.iter().all(|c| c.is_finite()) {
            return Err(PasteError::BadSetting { what, expected: "finite", found: format!("{at:?}") });
        }
    }
    let feature = Feature { source: &source, ..*feature };
    let ground = Ground { target: &target, ..*ground };
    match method {
        Method::Fit => fit::paste(&feature, &ground, settings),
        _ => matched_paste::paste(&feature, &ground, method, settings),
    }
}

fn refuse_torn(surface: &NurbsSurface, side: &'static str) -> Result<(), PasteError> {
    let torn = |knots: &KnotVector| {
        let (start, end) = knots.domain();
        let (distinct, counts) = knots.distinct();
        let inner = distinct.into_iter().zip(counts).filter(|(k, _)| *k > start && *k < end);
        inner.filter(|(_, count)| *count > knots.degree()).map(|(k, _)| k).next()
    };
    for (direction, knots) in [("u", surface.knots_u()), ("v", surface.knots_v())] {
        if let Some(knot) = torn(knots) {
            return Err(PasteError::BadKnots { side, direction, knot, degree: knots.degree() });
        }
    }
    Ok(())
}
