//! The numeric core: surfaces and loops in, surfaces and motions out. Knows no topology and no files.
//!
//! Several faces are scaled together so that a feature that passes through several of them gets one motion: the
//! free points are eliminated face by face, and the reduced energies of a group are added before its motion is
//! chosen.

use super::ScaleError;
use super::envelope::{Prepared, PreparedLoop};
use super::fold::Compression;
use super::grouping::{Grouping, refine_together};
use super::motion::Motion;
use super::prepare::prepare;
use super::refine::Refined;
use super::rule::{Arrangement, ByLoops, MotionRule};
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
    let rule = ByLoops { tasks, faces: &faces, scaling, plain: &plain };
    run(tasks, &faces, scaling, &plain, &rule)
}

/// As [`scale_faces`], with the motions of a rule that knows more than the loops of these faces.
///
/// # Errors
/// As [`scale_faces`], and those of the rule.
pub fn scale_faces_by(
    tasks: &[FaceTask<'_>],
    scaling: &Scaling,
    rule: &dyn MotionRule,
) -> Result<Scaled, ScaleError> {
    let plain = scaling.affine()?;
    let faces = tasks.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    run(tasks, &faces, scaling, &plain, rule)
}

fn run(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    scaling: &Scaling,
    plain: &Affine,
    rule: &dyn MotionRule,
) -> Result<Scaled, ScaleError> {
    let mut grouping = Grouping::new(tasks);
    let moves = |l: &PreparedLoop| matches!(l.hold, Hold::Pinned(Some(_)));
    if plain.is_identity() && !faces.iter().flat_map(|f| &f.held).any(moves) {
        return unchanged(tasks, &grouping, rule);
    }
    let mut least = vec![0; faces.len()];
    let mut parted = false;
    loop {
        let refined = refine_together(faces, &mut grouping, &mut least, scaling)?;
        let arrangement = rule.arrange(&grouping.sets())?;
        let mut solved = solve(tasks, faces, refined, &grouping, arrangement, scaling, plain)?;
        // One more level gives the stretched part more room, as long as the limit allows.
        if let Some(folded) = solved.faces.iter().position(|f| f.compression.is_fold()) {
            let Compression { ratio, near } = solved.faces[folded].compression;
            if solved.faces[folded].level < least[folded] {
                return Err(ScaleError::FoldOver { face: faces[folded].name.clone(), ratio, near });
            }
            least[folded] = solved.faces[folded].level + 1;
            continue;
        }
        solved.skins = skins::pairs(faces, &solved);
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

fn solve(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    refined: Vec<Refined>,
    grouping: &Grouping,
    arrangement: Arrangement,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Scaled, ScaleError> {
    let Arrangement { mut motions, of_loop } = arrangement;
    let mut stages = Vec::with_capacity(faces.len());
    for (k, refined) in refined.into_iter().enumerate() {
        let held = held_sets(&refined, &of_loop[k]);
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
    Ok(Scaled {
        faces: done,
        sets: grouping.sets(),
        groups: group_list(grouping, motions, &of_loop),
        skins: Vec::new(),
        residual,
    })
}

/// The motions with the loops that follow them.
fn group_list(grouping: &Grouping, motions: Vec<Motion>, of_loop: &[Vec<usize>]) -> Vec<Group> {
    let mut groups: Vec<Group> =
        motions.into_iter().map(|motion| Group { loops: Vec::new(), motion, merged: false }).collect();
    for (face, own) in of_loop.iter().enumerate() {
        for (k, &motion) in own.iter().enumerate() {
            groups[motion].loops.push((face, k));
            groups[motion].merged |= grouping.merged.contains(&grouping.root[face][k]);
        }
    }
    groups
}

/// The result of the identity: every surface as it came, every motion the identity.
fn unchanged(
    tasks: &[FaceTask<'_>],
    grouping: &Grouping,
    rule: &dyn MotionRule,
) -> Result<Scaled, ScaleError> {
    let Arrangement { motions, of_loop } = rule.arrange(&grouping.sets())?;
    let faces = tasks.iter().map(|task| ScaledFace::whole(task.surface.clone())).collect();
    let groups = group_list(grouping, motions, &of_loop);
    Ok(Scaled { faces, sets: grouping.sets(), groups, skins: Vec::new(), residual: 0.0 })
}
