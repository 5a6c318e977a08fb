//! Runs the numeric core on the faces that have to be stretched, one run for each set of faces that share groups, and
//! gives every group its motion, those that end on planes alone as well.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::Params;
use super::held::Held;
use super::piece::{FaceRule, Former, Piece};
use super::scope::face_name;
use super::wall::{Ring, Uses};
use crate::brep::FaceId;
use crate::math::Affine;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::faces::scale_faces_by;
use crate::ops::constrained_scale::skins::SkinPair;
use crate::ops::constrained_scale::task::{FaceTask, HeldLoop, Scaled, ScaledFace};

/// Stretched faces and the pieces of all features.
#[derive(Debug, Clone, Default)]
pub(super) struct Stretched {
    /// Faces that were stretched.
    pub faces: BTreeMap<FaceId, ScaledFace>,
    /// Pieces with their final motions.
    pub pieces: Vec<Solved>,
    /// Walls that became longer, each with the pieces that it lies between in the order of its faces.
    pub rings: Vec<Ring>,
    /// Opposite faces that share a piece.
    pub skins: Vec<([FaceId; 2], SkinPair)>,
}

/// A piece as it was solved.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    /// The piece.
    pub piece: Piece,
    /// Whether features were joined in it because they lie too near to each other.
    pub merged: bool,
    /// Residual of the run that solved it; zero where nothing had to be solved.
    pub residual: f64,
}

/// Groups and faces that share unknowns.
#[derive(Debug, Clone, Default)]
struct Cluster {
    groups: BTreeSet<usize>,
    faces: BTreeSet<FaceId>,
}

/// Stretches all faces with held loops that are not planes.
pub(super) fn stretch(
    model: &Model,
    held: &Held,
    params: &Params,
    plain: &Affine,
) -> Result<Stretched, OperationError> {
    let uses = Uses::new(model);
    let former = Former { model, held, params, plain, uses: &uses };
    let clusters = clusters(held);
    // Different clusters share no unknown; results are gathered in their order.
    let solved: Vec<_> = clusters.par_iter().map(|cluster| run(&former, cluster)).collect();
    let mut out = Stretched::default();
    for found in solved {
        let Stretched { faces, pieces, rings, skins } = found?;
        out.faces.extend(faces);
        out.pieces.extend(pieces);
        out.rings.extend(rings);
        out.skins.extend(skins);
    }
    Ok(out)
}

fn run(former: &Former<'_>, cluster: &Cluster) -> Result<Stretched, OperationError> {
    let faces: Vec<FaceId> = cluster.faces.iter().copied().collect();
    let mut out = Stretched::default();
    if faces.is_empty() {
        for &group in &cluster.groups {
            let formed = former.form(&[group])?;
            out.rings.extend(formed.rings);
            out.pieces.extend(formed.pieces.into_iter().map(|piece| Solved {
                piece,
                merged: false,
                residual: 0.0,
            }));
        }
        return Ok(out);
    }
    let tasks: Vec<FaceTask<'_>> = faces.iter().map(|&face| task(former, face)).collect();
    let rule = FaceRule { former, faces: &faces };
    let Scaled { faces: scaled, sets, groups, skins, residual } =
        scale_faces_by(&tasks, &former.params.scaling, &rule)?;
    // The rule gives the same pieces again; only the solve knows how far they moved.
    let mut solved = groups.into_iter();
    for set in &sets {
        let formed = former.form(set)?;
        out.rings.extend(formed.rings);
        for (mut piece, group) in formed.pieces.into_iter().zip(solved.by_ref()) {
            piece.motion = group.motion;
            out.pieces.push(Solved { piece, merged: set.len() > 1, residual });
        }
    }
    out.skins = skins.into_iter().map(|pair| (pair.faces.map(|f| faces[f]), pair)).collect();
    out.faces = faces.into_iter().zip(scaled).collect();
    Ok(out)
}

fn task<'a>(former: &Former<'a>, face: FaceId) -> FaceTask<'a> {
    let base = former.held.bases[&face].net().expect("a face of a cluster is stretched");
    let held = base.held.iter().map(|(number, contour)| HeldLoop {
        contour: contour.clone(),
        group: former.held.loops[*number].group,
        hold: former.params.mode,
    });
    FaceTask {
        name: face_name(former.model, face),
        surface: &base.surface,
        held: held.collect(),
        outer: base.outer.clone(),
        scaled: base.scaled.clone(),
    }
}

/// Groups in sets that share stretched faces, in order of their first groups.
fn clusters(held: &Held) -> Vec<Cluster> {
    let mut clusters: Vec<Cluster> = Vec::new();
    for group in 0..held.groups {
        let loops = held.loops.iter().filter(|l| l.group == group);
        let faces: BTreeSet<FaceId> =
            loops.map(|l| l.face).filter(|face| held.bases[face].net().is_some()).collect();
        let (near, mut apart): (Vec<Cluster>, Vec<Cluster>) =
            clusters.into_iter().partition(|cluster| !cluster.faces.is_disjoint(&faces));
        let mut cluster = Cluster { groups: BTreeSet::from([group]), faces };
        for other in near {
            cluster.groups.extend(other.groups);
            cluster.faces.extend(other.faces);
        }
        apart.push(cluster);
        clusters = apart;
    }
    clusters.sort_by_key(|cluster| cluster.groups.first().copied());
    clusters
}
