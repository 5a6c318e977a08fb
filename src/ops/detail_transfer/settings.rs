//! Parameters of a transfer.

use crate::math::Vector3;

/// Which levels are carried over, counted from the finest, which is 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LevelChoice {
    /// All that the source has.
    All,
    /// The finest so many, or all when there are fewer.
    Finest(usize),
    /// These.
    These(Vec<usize>),
}

/// In which directions detail is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// Along the coarse curves, by frames of least rotation.
    Local,
    /// As it stands, in world directions.
    Global,
}

/// Factor on all detail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Length of the coarse target over that of the coarse source.
    ArcLength,
    /// This factor.
    Factor(f64),
}

/// What becomes of the target's own detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// The new detail is added to it.
    Keep,
    /// It gives way.
    Replace,
}

/// Which curve the frames and the length of a target are taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetBase {
    /// The target without its own detail.
    Coarse,
    /// The target as it is: its knots say nothing of its detail, because it is an approximation of a curve of another
    /// kind.
    AsItIs,
}

/// Parameters of a transfer between two splines.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Levels.
    pub levels: LevelChoice,
    /// Gain of each chosen level, finest first or in the order of [`LevelChoice::These`]; one for all.
    pub gains: Vec<f64>,
    /// Directions.
    pub frame: Frame,
    /// Factor.
    pub scale: Scale,
    /// Derivatives at both ends that stay, the position counted as one: 0 leaves the ends free.
    pub ends: usize,
    /// Part of the target, in its parameter; `None` for all of it.
    pub interval: Option<(f64, f64)>,
    /// The target's own detail.
    pub existing: Existing,
    /// Where frames and length are taken from.
    pub target_base: TargetBase,
    /// Whether the source is run the other way first.
    pub reverse: bool,
    /// Angle about the target's tangent by which detail is turned, in radians; local frame only.
    pub roll: f64,
    /// Directions that belong together at the starts of source and target; each need not be exactly across. Left
    /// out: by the least rotation between the tangents.
    pub normals: [Option<Vector3<f64>>; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            levels: LevelChoice::All,
            gains: vec![1.0],
            frame: Frame::Local,
            scale: Scale::ArcLength,
            ends: 1,
            interval: None,
            existing: Existing::Keep,
            target_base: TargetBase::Coarse,
            reverse: false,
            roll: 0.0,
            normals: [None, None],
        }
    }
}
