//! What the numeric core takes and gives.

use super::cells::Mask;
use super::fold::Compression;
use super::motion::Motion;
pub use super::polygon::Contour;
use super::scaling::Hold;
use super::skins::SkinPair;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::Point3;

/// A loop whose inside keeps its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldLoop {
    /// Its polygon.
    pub contour: Contour,
    /// Loops with the same number, on whatever face, move as one.
    pub group: usize,
    /// What is held; the first loop of a group decides.
    pub hold: Hold,
}

/// One face with what is held on it.
#[derive(Debug, Clone)]
pub struct FaceTask<'a> {
    /// Name for messages.
    pub name: String,
    /// Its surface.
    pub surface: &'a NurbsSurface,
    /// Held loops; without any the face is scaled plainly.
    pub held: Vec<HeldLoop>,
    /// The outer loop, where it is not the natural border.
    pub outer: Option<Contour>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Contour>,
}

/// A scaled face.
#[derive(Debug, Clone)]
pub struct ScaledFace {
    /// The result: same degrees and domain as the input, knots refined.
    pub surface: NurbsSurface,
    /// The plainly scaled surface over the same knots.
    pub plain: NurbsSurface,
    /// The plainly scaled surface over the knots that it came with: what a deviation is measured from.
    pub image: NurbsSurface,
    /// Control points that moved rigidly.
    pub held: Mask,
    /// Control points before refinement.
    pub points_before: usize,
    /// Control points that were solved for.
    pub free_points: usize,
    /// How often the spans were bisected.
    pub level: usize,
    /// Strongest compression against the plainly scaled surface.
    pub compression: Compression,
}

/// Held loops with one motion.
#[derive(Debug, Clone)]
pub struct Group {
    /// Face and loop, by the caller's indices.
    pub loops: Vec<(usize, usize)>,
    /// Their motion.
    pub motion: Motion,
    /// Whether loops of different numbers were joined because they lie too near to each other.
    pub merged: bool,
}

/// Faces scaled together.
#[derive(Debug, Clone)]
pub struct Scaled {
    /// One for each task, in order.
    pub faces: Vec<ScaledFace>,
    /// The caller's numbers of the groups that had to be joined, or stayed alone, in the order of their first loops.
    pub sets: Vec<Vec<usize>>,
    /// One for each motion of the rule.
    pub groups: Vec<Group>,
    /// Faces that share a group and lie opposite to each other, with the material between them.
    pub skins: Vec<SkinPair>,
    /// Greatest relative residual of the stationarity conditions: of the free points, and of the groups' motions.
    pub residual: f64,
}

impl ScaledFace {
    /// A face of which nothing is held.
    pub(super) fn whole(surface: NurbsSurface) -> Self {
        let (rows, columns) = surface.shape();
        Self {
            plain: surface.clone(),
            image: surface.clone(),
            surface,
            held: Mask::empty(rows, columns),
            points_before: rows * columns,
            free_points: 0,
            level: 0,
            compression: Compression { ratio: 1.0, near: Point3::origin() },
        }
    }
}
