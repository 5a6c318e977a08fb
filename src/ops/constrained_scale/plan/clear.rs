//! Whether held loops stay clear on planes, where nothing is solved that could tell: each within the scaled outline, and
//! none over another.

use super::base::Base;
use super::contour::SpaceLoop;
use super::follow::Follow;
use super::held::Held;
use super::scope::face_name;
use crate::brep::FaceId;
use crate::math::{Affine, Frame, cofactor};
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::ScaleError;
use crate::ops::constrained_scale::polygon::Polygon;

/// A loop of a plane after the scaling.
struct Flat {
    /// Index among the loops of the face.
    at: usize,
    held: bool,
    polygon: Polygon,
}

/// Refuses planes on which held loops come to lie over each other, or over the border.
///
/// # Errors
/// [`ScaleError::HeldLoopsOverlap`].
pub(super) fn refuse_overlaps(
    model: &Model,
    held: &Held,
    follow: &Follow,
    plain: &Affine,
) -> Result<(), OperationError> {
    for (&face, base) in &held.bases {
        let Base::Plane(frame) = base else { continue };
        let loops = flat_loops(model, face, frame, held, follow, plain)?;
        // The outline encloses most, before and after.
        let outer = loops.iter().max_by(|a, b| a.polygon.area().abs().total_cmp(&b.polygon.area().abs()));
        let Some(outer) = outer.map(|l| l.at) else { continue };
        for (k, one) in loops.iter().enumerate() {
            for other in &loops[k + 1..] {
                if !(one.held || other.held) {
                    continue;
                }
                let clear = if other.at == outer {
                    within(&one.polygon, &other.polygon)
                } else if one.at == outer {
                    within(&other.polygon, &one.polygon)
                } else {
                    !one.polygon.overlaps(&other.polygon)
                };
                if !clear {
                    let face = face_name(model, face);
                    return Err(ScaleError::HeldLoopsOverlap { face, first: one.at, second: other.at }.into());
                }
            }
        }
    }
    Ok(())
}

/// Whether a polygon lies within another and does not cross it.
fn within(inner: &Polygon, outer: &Polygon) -> bool {
    inner.points().iter().all(|&p| outer.contains(p)) && !outer.points().iter().any(|&p| inner.contains(p))
}

/// The loops of a plane after the scaling, in the plane's image. One that has become degenerate is left out.
fn flat_loops(
    model: &Model,
    face: FaceId,
    frame: &Frame,
    held: &Held,
    follow: &Follow,
    plain: &Affine,
) -> Result<Vec<Flat>, OperationError> {
    let image = Frame::from_axis(plain.point(&frame.origin), cofactor(&plain.linear) * frame.z, None);
    let Some(image) = image else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for (at, &id) in model.brep.faces[face].loops.iter().enumerate() {
        let first = model.brep.loops[id].coedges.first().map(|&c| model.brep.coedges[c].edge);
        let mover = first.and_then(|edge| follow.edges.get(&edge));
        let map = mover.map_or(*plain, |&k| follow.movers[k].map);
        let points: Vec<[f64; 2]> = SpaceLoop::of(model, id)?
            .points
            .iter()
            .map(|p| image.local(&map.point(p)))
            .map(|p| [p.x, p.y])
            .collect();
        let is_held = held.loops_of(face).any(|k| held.loops[k].at == at);
        if let Some(polygon) = flat(&points) {
            found.push(Flat { at, held: is_held, polygon });
        }
    }
    Ok(found)
}

fn flat(points: &[[f64; 2]]) -> Option<Polygon> {
    let range = |k: usize| {
        let low = points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        (low, high)
    };
    Polygon::new(points, [0.0; 2], [range(0), range(1)]).ok()
}
