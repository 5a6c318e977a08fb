//! What a hold names: inner loops, edges, faces, or sets of them; and the loops and faces that these mean.

use std::collections::BTreeSet;

use super::contour::SpaceLoop;
use super::layout::Layouts;
use super::scope::face_name;
use crate::brep::{EdgeId, FaceId, LoopId};
use crate::model::Model;
use crate::ops::OperationError;

/// What is to be held.
#[derive(Debug, Clone, PartialEq)]
pub enum HoldTarget {
    /// All inner loops of some faces.
    InnerLoops(LoopFilter),
    /// One loop.
    Loop(LoopId),
    /// The inner loops that an edge belongs to.
    Edge(EdgeId),
    /// Faces, with what hangs on them.
    Faces(Vec<FaceId>),
}

/// Which inner loops.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoopFilter {
    /// Faces that bear them; none for all faces in scope.
    pub on: Option<Vec<FaceId>>,
    /// Greatest width: the diameter of the sphere round the loop's centre that holds it.
    pub up_to: Option<f64>,
}

/// Loops and faces that the flood starts from.
#[derive(Debug, Clone, Default)]
pub(super) struct Seeds {
    /// Faces and indices of their loops.
    pub loops: BTreeSet<(FaceId, usize)>,
    /// Faces.
    pub faces: BTreeSet<FaceId>,
}

/// The loops and faces that the targets mean.
pub(super) fn seeds(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    targets: &[HoldTarget],
    layouts: &mut Layouts,
) -> Result<Seeds, OperationError> {
    let mut seeds = Seeds::default();
    for target in targets {
        match target {
            HoldTarget::InnerLoops(filter) => {
                seeds.loops.extend(inner(model, scope, filter, layouts)?);
            }
            HoldTarget::Loop(id) => {
                let name = model.origins.loops[*id].to_string();
                seeds.loops.insert(holdable(model, scope, *id, layouts, &name)?);
            }
            HoldTarget::Edge(edge) => {
                let name = model.origins.edges[*edge].to_string();
                seeds.loops.extend(at_edge(model, scope, *edge, layouts, &name)?);
            }
            HoldTarget::Faces(faces) => {
                if let Some(&face) = faces.iter().find(|face| !scope.contains(face)) {
                    let (entity, reason) = (face_name(model, face), "it is not selected".to_owned());
                    return Err(OperationError::NotHoldable { entity, reason });
                }
                seeds.faces.extend(faces);
            }
        }
    }
    if seeds.loops.is_empty() && seeds.faces.is_empty() {
        let faces = scope.iter().map(|&f| face_name(model, f)).collect();
        return Err(OperationError::NothingToHold { faces });
    }
    Ok(seeds)
}

fn inner(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    filter: &LoopFilter,
    layouts: &mut Layouts,
) -> Result<Vec<(FaceId, usize)>, OperationError> {
    let on = |face: &FaceId| filter.on.as_ref().is_none_or(|on| on.contains(face));
    let mut found = Vec::new();
    for &face in scope.iter().filter(|face| on(face)) {
        let loops = &model.brep.faces[face].loops;
        // Faces with one loop have no inner one, and need not be traced.
        if loops.len() < 2 {
            continue;
        }
        let layout = layouts.of(model, face)?;
        let inner: Vec<usize> = (0..loops.len()).filter(|&k| layout.is_inner(k)).collect();
        for k in inner {
            let fits = match filter.up_to {
                Some(most) => SpaceLoop::of(model, loops[k])?.width() <= most,
                None => true,
            };
            if fits {
                found.push((face, k));
            }
        }
    }
    Ok(found)
}

/// A loop that can be held, or why it cannot.
fn holdable(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    id: LoopId,
    layouts: &mut Layouts,
    name: &str,
) -> Result<(FaceId, usize), OperationError> {
    let refuse = |reason: String| Err(OperationError::NotHoldable { entity: name.to_owned(), reason });
    let face = model.brep.loops[id].face;
    if !scope.contains(&face) {
        return refuse(format!("its face {} is not selected", face_name(model, face)));
    }
    let at = model.brep.faces[face].loops.iter().position(|&l| l == id);
    match at {
        Some(at) if layouts.of(model, face)?.is_inner(at) => Ok((face, at)),
        _ => refuse(format!("it is no inner loop of its face {}", face_name(model, face))),
    }
}

/// The holdable loops that an edge belongs to.
fn at_edge(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    edge: EdgeId,
    layouts: &mut Layouts,
    name: &str,
) -> Result<Vec<(FaceId, usize)>, OperationError> {
    let loops: BTreeSet<LoopId> =
        model.brep.coedges.iter().filter(|(_, c)| c.edge == edge).map(|(_, c)| c.in_loop).collect();
    let mut found = Vec::new();
    let mut refused = None;
    for id in loops {
        match holdable(model, scope, id, layouts, name) {
            Ok(seed) => found.push(seed),
            Err(error) => refused = Some(error),
        }
    }
    let reason = "no loop uses it".to_owned();
    match refused {
        _ if !found.is_empty() => Ok(found),
        Some(error) => Err(error),
        None => Err(OperationError::NotHoldable { entity: name.to_owned(), reason }),
    }
}
