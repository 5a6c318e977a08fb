//! How groups of held loops move: the rule that the numeric core asks, again whenever it had to join groups.

use super::ScaleError;
use super::envelope::Prepared;
use super::motion::{LoopFrame, Motion, degenerate};
use super::scaling::{Hold, Scaling};
use super::task::FaceTask;
use crate::math::Affine;

/// Motions, and which held loop follows which.
#[derive(Debug, Clone, Default)]
pub struct Arrangement {
    /// Motions, not yet shifted by the solve. Some may have no loop on any face of the run.
    pub motions: Vec<Motion>,
    /// By face and held loop: index of its motion.
    pub of_loop: Vec<Vec<usize>>,
}

/// Gives groups of held loops their motions.
pub trait MotionRule {
    /// Motions for sets of groups that move together, each set by the caller's numbers of its groups. Loops of one set
    /// may still get several motions, if they are not near each other on any face.
    ///
    /// # Errors
    /// [`ScaleError`] when a set has no motion.
    fn arrange(&self, sets: &[Vec<usize>]) -> Result<Arrangement, ScaleError>;
}

/// One motion for each set, from the held loops of the faces alone.
pub(super) struct ByLoops<'a> {
    pub(super) tasks: &'a [FaceTask<'a>],
    pub(super) faces: &'a [Prepared],
    pub(super) scaling: &'a Scaling,
    pub(super) plain: &'a Affine,
}

impl MotionRule for ByLoops<'_> {
    fn arrange(&self, sets: &[Vec<usize>]) -> Result<Arrangement, ScaleError> {
        let set_of = |group: usize| sets.iter().position(|set| set.contains(&group)).unwrap_or(0);
        let of_loop: Vec<Vec<usize>> =
            self.tasks.iter().map(|task| task.held.iter().map(|l| set_of(l.group)).collect()).collect();
        let motions = (0..sets.len()).map(|set| self.motion(set, &of_loop)).collect::<Result<_, _>>()?;
        Ok(Arrangement { motions, of_loop })
    }
}

impl ByLoops<'_> {
    fn motion(&self, set: usize, of_loop: &[Vec<usize>]) -> Result<Motion, ScaleError> {
        let mut frames = Vec::new();
        let mut first: Option<(&Prepared, usize, Hold)> = None;
        for (face, sets) in self.faces.iter().zip(of_loop) {
            for k in (0..sets.len()).filter(|&k| sets[k] == set) {
                let held = &face.held[k];
                first.get_or_insert((face, k, held.hold));
                let frame = LoopFrame::new(&face.surface, &held.polygon, self.scaling.energy);
                frames.push(frame.map_err(|at| degenerate(&face.name, k, self.scaling.energy, at))?);
            }
        }
        let (face, k, hold) = first.expect("a set has a loop");
        let motion = Motion::new(&frames, hold, self.scaling, self.plain);
        motion.ok_or(ScaleError::LoopDegenerate { face: face.name.clone(), held: k })
    }
}
