//! Selectors of curves against a model.

use crate::brep::CurveId;
use crate::geometry::Carried;
use crate::job::file::detail::CurveSelector;
use crate::job::operate::select::SelectError;
use crate::model::{Model, Origin};

/// Candidates that a message names.
const NAMED: usize = 5;

/// The one curve of a selector; the only free curve of the model when there is none.
///
/// A record may be that of a curve or of an edge, whose own curve it then means, and of a curve that
/// edges use: what may be done with it is the operation's business. Names are those of free curves.
///
/// # Errors
/// [`SelectError`] with the nearest candidates.
pub(in crate::job) fn one(model: &Model, selector: Option<&CurveSelector>) -> Result<CurveId, SelectError> {
    let free = || model.free_curves.iter().copied();
    let (found, what): (Vec<CurveId>, String) = match selector {
        Some(CurveSelector::Record(record)) => {
            return of_record(model, *record)
                .ok_or_else(|| no_match(model, format!("`{record}`"), Some(*record)));
        }
        Some(CurveSelector::Name(pattern)) => {
            let glob = pattern.matcher();
            let named = free().zip(&model.free_curve_names).filter(|(_, name)| glob.is_match(name));
            (named.map(|(curve, _)| curve).collect(), format!("name `{pattern}`"))
        }
        None => (free().collect(), "a selector that is left out".to_owned()),
    };
    match found.as_slice() {
        [curve] => Ok(*curve),
        [] => Err(no_match(model, what, None)),
        _ => Err(SelectError::SeveralCurves {
            what,
            found: found.iter().map(|&curve| describe(model, curve)).collect(),
        }),
    }
}

fn of_record(model: &Model, wanted: Origin) -> Option<CurveId> {
    let origins = &model.origins;
    let curve = origins.curves.iter().find(|(_, origin)| **origin == wanted).map(|(curve, _)| curve);
    let edge = || origins.edges.iter().find(|(_, origin)| **origin == wanted).map(|(edge, _)| edge);
    curve.or_else(|| edge().map(|edge| model.brep.edges[edge].curve))
}

fn name(model: &Model, curve: CurveId) -> &str {
    let at = model.free_curves.iter().position(|&free| free == curve);
    at.and_then(|at| model.free_curve_names.get(at)).map_or("", String::as_str)
}

fn no_match(model: &Model, what: String, near: Option<Origin>) -> SelectError {
    let mut free = model.free_curves.clone();
    if let Some(near) = near {
        free.sort_by_key(|&curve| model.origins.curves[curve].distance(near));
    }
    let nearest = free.into_iter().take(NAMED).map(|curve| describe(model, curve)).collect();
    SelectError::NoCurve { what, nearest }
}

/// A curve in words: `#1042 "RIM" b_spline`.
fn describe(model: &Model, curve: CurveId) -> String {
    let name = name(model, curve);
    let quoted = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
    let kind = match &model.brep.curves[curve] {
        Carried::Read(curve) => curve.kind(),
        Carried::Unread { .. } => "unread",
    };
    format!("{}{quoted} {kind}", model.origins.curves[curve])
}
