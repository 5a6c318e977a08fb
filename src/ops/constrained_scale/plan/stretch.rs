//! Runs the numeric core on the faces with held loops, one run for each set of faces that share groups.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::Params;
use super::hold::Held;
use super::layout::spline_of;
use super::scope::face_name;
use crate::brep::FaceId;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::faces::scale_faces;
use crate::ops::constrained_scale::motion::Motion;
use crate::ops::constrained_scale::skins::SkinPair;
use crate::ops::constrained_scale::task::{FaceTask, Group, HeldLoop, Scaled, ScaledFace};

/// Stretched faces and the motions of all groups.
#[derive(Debug, Clone, Default)]
pub(super) struct Stretched {
    /// Faces with held loops.
    pub faces: BTreeMap<FaceId, ScaledFace>,
    /// Motion of each group of the hold.
    pub motions: Vec<Motion>,
    /// Groups as they were solved.
    pub groups: Vec<SolvedGroup>,
    /// Opposite faces that share a group.
    pub skins: Vec<([FaceId; 2], SkinPair)>,
}

/// A group as it was solved.
#[derive(Debug, Clone)]
pub(super) struct SolvedGroup {
    /// Faces, and indices among their held loops.
    pub loops: Vec<(FaceId, usize)>,
    /// Its motion.
    pub group: Group,
    /// Residual of the run that solved it.
    pub residual: f64,
}

/// Scales all faces with held loops.
pub(super) fn stretch(model: &Model, held: &Held, params: &Params) -> Result<Stretched, OperationError> {
    let sets = connected(held);
    // Faces of different sets share no unknown; results are gathered in the order of the sets.
    let solved: Vec<_> = sets.par_iter().map(|faces| run(model, held, params, faces)).collect();
    let mut out = Stretched::default();
    let mut motions = vec![None; held.groups];
    for (faces, solved) in sets.iter().zip(solved) {
        let Scaled { faces: scaled, groups, skins, residual } = solved?;
        out.skins.extend(skins.into_iter().map(|pair| (pair.faces.map(|f| faces[f]), pair)));
        for group in groups {
            let loops: Vec<(FaceId, usize)> = group.loops.iter().map(|&(f, k)| (faces[f], k)).collect();
            for (face, k) in &loops {
                motions[held.bases[face].held[*k].2] = Some(group.motion.clone());
            }
            out.groups.push(SolvedGroup { loops, group, residual });
        }
        out.faces.extend(faces.iter().copied().zip(scaled));
    }
    out.motions = motions.into_iter().map(|m| m.expect("every group has a loop on a base")).collect();
    Ok(out)
}

fn run(model: &Model, held: &Held, params: &Params, faces: &[FaceId]) -> Result<Scaled, OperationError> {
    let tasks: Vec<FaceTask<'_>> = faces
        .iter()
        .map(|&face| {
            let base = &held.bases[&face];
            let held = base.held.iter().map(|(_, contour, group)| HeldLoop {
                contour: contour.clone(),
                group: *group,
                hold: params.mode,
            });
            FaceTask {
                name: face_name(model, face),
                surface: spline_of(model, face).expect("a face with held loops is a B-spline"),
                held: held.collect(),
                outer: base.outer.clone(),
                scaled: base.scaled.clone(),
            }
        })
        .collect();
    Ok(scale_faces(&tasks, &params.scaling)?)
}

/// Faces with held loops in sets that share groups, each ascending, in order of their first faces.
fn connected(held: &Held) -> Vec<Vec<FaceId>> {
    let mut set_of_group: Vec<Option<usize>> = vec![None; held.groups];
    let mut sets: Vec<Vec<FaceId>> = Vec::new();
    for (&face, base) in &held.bases {
        let mut at = sets.len();
        sets.push(vec![face]);
        for (_, _, group) in &base.held {
            if let Some(other) = set_of_group[*group].filter(|&other| other != at) {
                let (keep, drop) = (at.min(other), at.max(other));
                let moved = std::mem::take(&mut sets[drop]);
                sets[keep].extend(moved);
                for set in set_of_group.iter_mut().filter(|s| **s == Some(drop)) {
                    *set = Some(keep);
                }
                at = keep;
            }
            set_of_group[*group] = Some(at);
        }
    }
    sets.retain(|s| !s.is_empty());
    for set in &mut sets {
        set.sort_unstable();
    }
    sets
}
