//! Which element follows which motion: pieces of features, and the walls between them, whose two ends follow two.

use std::collections::{BTreeMap, BTreeSet};

use super::HeldPiece;
use super::contour::SpaceLoop;
use super::held::Held;
use super::scope::face_name;
use super::stretch::Stretched;
use super::wall::Ring;
use crate::brep::{EdgeId, FaceId, VertexId};
use crate::math::{Affine, Point3, Vector3};
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::ScaleError;
use crate::ops::constrained_scale::motion::Motion;

/// One motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mover {
    pub map: Affine,
    /// Whether it keeps all distances, so that kinds and radii stay.
    pub rigid: bool,
}

impl Mover {
    fn of(motion: &Motion) -> Self {
        let translation = motion.apply(&Point3::origin()).coords;
        let map = Affine { linear: motion.linear, translation };
        // Rounding of the origin's way to the pivot and back must not move what stays.
        let stays = motion.apply(&motion.pivot) == motion.pivot && motion.linear == Affine::identity().linear;
        Self { map: if stays { Affine::identity() } else { map }, rigid: motion.is_rigid() }
    }
}

/// What every element follows; those that are not named follow the scaling.
#[derive(Debug, Clone, Default)]
pub(super) struct Follow {
    pub movers: Vec<Mover>,
    /// Held faces; a wall that becomes longer follows one of its ends.
    pub faces: BTreeMap<FaceId, usize>,
    /// Held edges; those along a wall that becomes longer follow as it does.
    pub edges: BTreeMap<EdgeId, usize>,
    /// Vertices of held edges.
    pub vertices: BTreeMap<VertexId, usize>,
    /// Edges along walls that become longer.
    pub generators: BTreeSet<EdgeId>,
}

impl Follow {
    /// The elements that keep their shape, piece by piece; pieces that stretch along some axes have none.
    pub fn held_pieces(&self, stretched: &Stretched) -> Vec<HeldPiece> {
        let longer: BTreeSet<FaceId> = stretched.rings.iter().flat_map(|ring| &ring.faces).copied().collect();
        let rigid = self.movers.iter().enumerate().filter(|(_, mover)| mover.rigid);
        let piece = |(number, mover): (usize, &Mover)| {
            let faces = self.faces.iter().filter(|(face, of)| **of == number && !longer.contains(face));
            let edges = self.edges.iter().filter(|(e, of)| **of == number && !self.generators.contains(e));
            let vertices = self.vertices.iter().filter(|(_, of)| **of == number);
            HeldPiece {
                motion: mover.map,
                faces: faces.map(|(&face, _)| face).collect(),
                edges: edges.map(|(&edge, _)| edge).collect(),
                vertices: vertices.map(|(&vertex, _)| vertex).collect(),
            }
        };
        rigid.map(piece).collect()
    }
}

/// What is held where nothing moves.
pub(super) fn unmoved(model: &Model, held: &Held) -> Vec<HeldPiece> {
    let brep = &model.brep;
    let of_loops = held.loops.iter().flat_map(|held| &brep.loops[held.id].coedges);
    let of_loops = of_loops.map(|&coedge| brep.coedges[coedge].edge);
    let edges: BTreeSet<EdgeId> = held.edges.keys().copied().chain(of_loops).collect();
    let vertices: BTreeSet<VertexId> =
        edges.iter().flat_map(|&edge| [brep.edges[edge].start, brep.edges[edge].end]).collect();
    let piece = HeldPiece {
        motion: Affine::identity(),
        faces: held.hanging.keys().copied().collect(),
        edges: edges.into_iter().collect(),
        vertices: vertices.into_iter().collect(),
    };
    if piece.edges.is_empty() { Vec::new() } else { vec![piece] }
}

/// Finds what every element follows.
///
/// # Errors
/// [`ScaleError::WallInverted`].
pub(super) fn follow(model: &Model, held: &Held, stretched: &Stretched) -> Result<Follow, OperationError> {
    let movers = stretched.pieces.iter().map(|solved| Mover::of(&solved.piece.motion)).collect();
    let mut out = Follow { movers, ..Follow::default() };
    let brep = &model.brep;
    for (number, solved) in stretched.pieces.iter().enumerate() {
        for &face in &solved.piece.part.faces {
            out.faces.insert(face, number);
            out.edges.extend(brep.coedges_of(face).map(|c| (brep.coedges[c].edge, number)));
        }
        for &k in &solved.piece.part.loops {
            let coedges = brep.loops[held.loops[k].id].coedges.iter();
            out.edges.extend(coedges.map(|&c| (brep.coedges[c].edge, number)));
        }
    }
    for (&edge, &number) in &out.edges {
        let edge = &brep.edges[edge];
        out.vertices.extend([(edge.start, number), (edge.end, number)]);
    }
    for ring in &stretched.rings {
        let leader = ring.ends.iter().find_map(|edge| out.edges.get(edge)).copied();
        let leader = leader.expect("a wall ends at pieces");
        out.faces.extend(ring.faces.iter().map(|&face| (face, leader)));
        out.edges.extend(ring.generators.iter().map(|&edge| (edge, leader)));
        out.generators.extend(&ring.generators);
        refuse_inverted(model, &out, ring)?;
    }
    Ok(out)
}

/// A loop or arc at one end of a wall, as points across the wall's direction and along it, before and after.
struct End {
    across: Vec<Vector3<f64>>,
    before: Vec<f64>,
    after: Vec<f64>,
}

/// Refuses a wall whose ends would pass each other: above every point of one end its nearest points of the others must
/// stay on their sides.
fn refuse_inverted(model: &Model, follow: &Follow, ring: &Ring) -> Result<(), OperationError> {
    let mut ends: BTreeMap<usize, End> = BTreeMap::new();
    for edge in &ring.ends {
        let Some(&number) = follow.edges.get(edge) else { continue };
        let mover = follow.movers[number];
        let axis = mover.map.vector(&ring.axis).normalize();
        let empty = || End { across: Vec::new(), before: Vec::new(), after: Vec::new() };
        let end = ends.entry(number).or_insert_with(empty);
        for point in SpaceLoop::points_of(model, *edge)? {
            let before = point.coords.dot(&ring.axis);
            end.across.push(point.coords - ring.axis * before);
            end.before.push(before);
            end.after.push(mover.map.point(&point).coords.dot(&axis));
        }
    }
    let ends: Vec<End> = ends.into_values().collect();
    for (k, one) in ends.iter().enumerate() {
        for other in &ends[k + 1..] {
            if let Some((before, after)) = shortest(one, other) {
                let face = ring.faces.first().map(|&f| face_name(model, f)).unwrap_or_default();
                return Err(ScaleError::WallInverted { face, before, after }.into());
            }
        }
    }
    Ok(())
}

/// Length of a wall before and after where its ends pass each other, if they do.
fn shortest(one: &End, other: &End) -> Option<(f64, f64)> {
    let mut worst: Option<(f64, f64)> = None;
    for (k, at) in one.across.iter().enumerate() {
        let away = |j: &usize| (other.across[*j] - at).norm_squared();
        let Some(j) = (0..other.across.len()).min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
        let before = other.before[j] - one.before[k];
        let after = (other.after[j] - one.after[k]) * before.signum();
        if after <= 0.0 && worst.is_none_or(|(_, least)| after < least) {
            worst = Some((before.abs(), after));
        }
    }
    worst
}
