//! The numeric core: surfaces and loops in, surfaces and motions out. Knows no topology and no files.
//!
//! Several faces are scaled together so that a feature that passes through several of them gets one motion: the
//! free points are eliminated face by face, and the reduced energies of a group are added before its motion is
//! chosen.

use super::ScaleError;
use super::envelope::{Prepared, PreparedLoop};
use super::fold::Compression;
use super::grouping::{Grouping, refine_together};
use super::motion::{LoopFrame, Motion, degenerate};
use super::prepare::prepare;
use super::refine::Refined;
use super::scaling::{Hold, Scaling};
use super::skins;
use super::solve::choose_amounts;
use super::stage::{Residual, finish, held_sets, stage};
use super::task::{Contour, FaceTask, Group, HeldLoop, Scaled, ScaledFace};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::Affine;

/// Scales one face; see [`scale_faces`].
///
/// # Errors
/// See [`ScaleError`].
pub fn scale_face(
    surface: &NurbsSurface,
    held: &[HeldLoop],
    outer: Option<Contour>,
    scaling: &Scaling,
) -> Result<Scaled, ScaleError> {
    let held = held.to_vec();
    let task = FaceTask { name: "1".to_owned(), surface, held, outer, scaled: Vec::new() };
    scale_faces(&[task], scaling)
}

/// Scales faces whose held loops keep their shape, with one motion for each group of loops.
///
/// All or nothing: an error leaves no face changed. Deterministic. Time and memory are bounded by
/// [`Scaling::max_control_points`].
///
/// # Errors
/// See [`ScaleError`]; each names the face.
pub fn scale_faces(tasks: &[FaceTask<'_>], scaling: &Scaling) -> Result<Scaled, ScaleError> {
    let plain = scaling.affine()?;
    let faces = tasks.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    let mut grouping = Grouping::new(tasks);
    let moves = |l: &PreparedLoop| matches!(l.hold, Hold::Pinned(Some(_)));
    if plain.is_identity() && !faces.iter().flat_map(|f| &f.held).any(moves) {
        return unchanged(tasks, &faces, &grouping, scaling, &plain);
    }
    let mut least = vec![0; faces.len()];
    let mut parted = false;
    loop {
        let refined = refine_together(&faces, &mut grouping, &mut least, scaling)?;
        let motions = motions(&faces, &grouping, scaling, &plain)?;
        let mut solved = solve(tasks, &faces, refined, &grouping, motions, scaling, &plain)?;
        // One more level gives the stretched part more room, as long as the limit allows.
        if let Some(folded) = solved.faces.iter().position(|f| f.compression.is_fold()) {
            let Compression { ratio, near } = solved.faces[folded].compression;
            if solved.faces[folded].level < least[folded] {
                return Err(ScaleError::FoldOver { face: faces[folded].name.clone(), ratio, near });
            }
            least[folded] = solved.faces[folded].level + 1;
            continue;
        }
        solved.skins = skins::pairs(&faces, &solved);
        let Some(close) = solved.skins.iter().find(|pair| pair.is_too_close()) else { return Ok(solved) };
        if parted {
            let names = close.faces.map(|face| faces[face].name.clone());
            let (ratio, near) = (close.least_ratio, close.near);
            return Err(ScaleError::SkinsTooClose { faces: names, ratio, near });
        }
        parted = true;
        for face in close.faces {
            least[face] = solved.faces[face].level + 1;
        }
    }
}

fn motions(
    faces: &[Prepared],
    grouping: &Grouping,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Vec<Motion>, ScaleError> {
    let mut motions = Vec::new();
    for group in grouping.groups() {
        let mut frames = Vec::new();
        let mut first: Option<(&Prepared, usize, Hold)> = None;
        for (face, roots) in faces.iter().zip(&grouping.root) {
            for (k, _) in roots.iter().enumerate().filter(|(_, root)| **root == group) {
                let held = &face.held[k];
                first.get_or_insert((face, k, held.hold));
                let frame = LoopFrame::new(&face.surface, &held.polygon, scaling.energy);
                frames.push(frame.map_err(|at| degenerate(&face.name, k, scaling.energy, at))?);
            }
        }
        let (face, k, hold) = first.expect("a group has a loop");
        let motion = Motion::new(&frames, hold, scaling, plain);
        motions.push(motion.ok_or(ScaleError::LoopDegenerate { face: face.name.clone(), held: k })?);
    }
    Ok(motions)
}

fn solve(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    refined: Vec<Refined>,
    grouping: &Grouping,
    mut motions: Vec<Motion>,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Scaled, ScaleError> {
    let groups = grouping.groups();
    let mut stages = Vec::with_capacity(faces.len());
    for (k, refined) in refined.into_iter().enumerate() {
        let held = held_sets(&refined, &grouping.root[k], &groups);
        let staged = || stage(&faces[k].name, refined, held, &motions, scaling, plain);
        stages.push((!faces[k].held.is_empty()).then(staged).transpose()?);
    }
    let rows: Vec<_> = stages.iter().flatten().map(|s| (s.per_area, s.elimination.rows.as_slice())).collect();
    choose_amounts(&mut motions, &rows)
        .map_err(|unknowns| ScaleError::SingularSystem { face: faces[0].name.clone(), unknowns })?;
    let mut residual = Residual::new(&motions);
    let mut done = Vec::with_capacity(stages.len());
    for ((stage, face), task) in stages.into_iter().zip(faces).zip(tasks) {
        let image = task.surface.transformed(plain);
        done.push(match stage {
            Some(stage) => finish(stage, &face.name, image, &motions, &mut residual)?,
            None => ScaledFace::whole(image),
        });
    }
    let residual = residual.greatest(&motions);
    Ok(Scaled { faces: done, groups: group_list(grouping, motions), skins: Vec::new(), residual })
}

fn group_list(grouping: &Grouping, motions: Vec<Motion>) -> Vec<Group> {
    let of = |group: usize| {
        let faces = grouping.root.iter().enumerate();
        let loops = faces.flat_map(move |(f, roots)| {
            roots.iter().enumerate().filter(move |(_, r)| **r == group).map(move |(k, _)| (f, k))
        });
        loops.collect()
    };
    let groups = grouping.groups().into_iter().zip(motions);
    groups
        .map(|(group, motion)| Group { loops: of(group), motion, merged: grouping.merged.contains(&group) })
        .collect()
}

/// The result of the identity: every surface as it came, every motion the identity.
fn unchanged(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    grouping: &Grouping,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Scaled, ScaleError> {
    let motions = motions(faces, grouping, scaling, plain)?;
    let done = tasks.iter().map(|task| ScaledFace::whole(task.surface.clone()));
    let groups = group_list(grouping, motions);
    Ok(Scaled { faces: done.collect(), groups, skins: Vec::new(), residual: 0.0 })
}
