//! What stood in a feature's place before: bounds of the primary inside it, and the faces that hang on them.

use std::collections::BTreeSet;

use super::super::error::ReconstructionError;
use crate::brep::{FaceId, LoopId};
use crate::model::{ChangeSet, Model};
use crate::ops::net::layout::face_name;

/// Takes away bounds of the primary, and every face that is reached from them without the primary.
///
/// # Errors
/// [`ReconstructionError::RegionGoesOn`] when such a face touches the primary elsewhere, too: then it is no feature that
/// stood there, but the rest of the part.
pub fn clear(
    model: &Model,
    primary: FaceId,
    bounds: &[LoopId],
    changes: &mut ChangeSet,
) -> Result<(), ReconstructionError> {
    let brep = &model.brep;
    let users = brep.faces_of_edges();
    let edges =
        |bound: &LoopId| brep.loops[*bound].coedges.iter().map(|&c| brep.coedges[c].edge).collect::<Vec<_>>();
    let inside: BTreeSet<_> = bounds.iter().flat_map(edges).collect();
    let outside: BTreeSet<_> =
        brep.faces[primary].loops.iter().filter(|l| !bounds.contains(l)).flat_map(edges).collect();
    let mut open: Vec<FaceId> =
        inside.iter().flat_map(|&edge| users[edge].iter().copied()).filter(|&face| face != primary).collect();
    let mut region: BTreeSet<FaceId> = BTreeSet::new();
    while let Some(face) = open.pop() {
        if !region.insert(face) {
            continue;
        }
        for coedge in brep.coedges_of(face) {
            let edge = brep.coedges[coedge].edge;
            if outside.contains(&edge) {
                return Err(ReconstructionError::RegionGoesOn { face: face_name(model, face) });
            }
            open.extend(users[edge].iter().copied().filter(|&other| other != primary));
        }
    }
    changes.removed_bounds.extend(bounds);
    changes.removed_faces.extend(region);
    Ok(())
}
