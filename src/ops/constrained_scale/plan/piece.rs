//! How a feature moves: as one piece, or cut at its walls into pieces that follow the scaling each for itself; around
//! which point, where to, and how free each stays for the solve.
//!
//! A feature that ends on planes is where the planes put it. Two planes at a distance that scales cannot both be met by
//! one rigid piece: then the longest straight wall between them is made longer.

use std::collections::{BTreeMap, BTreeSet};

use super::base::Base;
use super::contour::SpaceLoop;
use super::held::Held;
use super::scope::face_name;
use super::wall::{Cut, LoopEdges, RigidPart, Ring, Uses, connected, cut};
use super::{Params, Wall};
use crate::brep::{EdgeId, FaceId};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Affine, Matrix3, Vector3, cofactor, nearest_rotation};
use crate::model::Model;
use crate::ops::constrained_scale::motion::{LoopFrame, Motion};
use crate::ops::constrained_scale::polygon::Polygon;
use crate::ops::constrained_scale::rule::{Arrangement, MotionRule};
use crate::ops::constrained_scale::scaling::{Energy, Hold};
use crate::ops::constrained_scale::{Contour, ScaleError};

/// Part of a feature's place and size within which it meets a plane, and sine within which planes are parallel.
const MEETS: f64 = 1e-9;
/// Cosine of the angle from which two ends of a feature face so differently that one direction speaks for neither.
const ASKEW: f64 = 0.866_025_403_784_438_6;
/// Cosine below which a wall runs along a loop and not through it.
const ALONG: f64 = 1e-3;
/// Weight of no turn beside the ends of a feature: it decides the turn about their direction.
const STAY: f64 = 1e-3;
/// Vector area, as a part of the squared length, below which a loop encloses nothing.
const NO_AREA: f64 = 1e-12;

/// A rigid piece of a feature.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub motion: Motion,
    pub part: RigidPart,
}

/// A feature as it moves.
#[derive(Debug, Clone, Default)]
pub(super) struct Formed {
    pub pieces: Vec<Piece>,
    /// Walls between pieces.
    pub rings: Vec<Ring>,
}

/// Forms features.
pub(super) struct Former<'a> {
    pub model: &'a Model,
    pub held: &'a Held,
    pub params: &'a Params,
    pub plain: &'a Affine,
    pub uses: &'a Uses<'a>,
}

impl Former<'_> {
    /// The pieces of groups that move together.
    ///
    /// # Errors
    /// [`ScaleError`] when a loop has no direction, or planes cannot be met.
    pub fn form(&self, groups: &[usize]) -> Result<Formed, ScaleError> {
        let held = self.held;
        let loops: Vec<usize> =
            (0..held.loops.len()).filter(|&k| groups.contains(&held.loops[k].group)).collect();
        let faces: BTreeSet<FaceId> =
            held.hanging.iter().filter(|(_, group)| groups.contains(group)).map(|(&face, _)| face).collect();
        let whole = self.whole(&loops)?;
        let conflict = self.conflict(&whole, &loops);
        let bases: BTreeSet<FaceId> = loops.iter().map(|&k| held.loops[k].face).collect();
        let cuts = match self.params.wall {
            Wall::Slide => bases.len() > 1,
            Wall::Rigid => conflict.is_some(),
            Wall::Strict => false,
        };
        if cuts && let Some(formed) = self.cut_apart(&whole, &loops, &faces)? {
            return Ok(formed);
        }
        if let Some(apart) = conflict {
            return Err(self.planes_conflict(&loops, apart));
        }
        Ok(Formed {
            pieces: vec![Piece { motion: whole, part: RigidPart { faces, loops } }],
            rings: Vec::new(),
        })
    }

    fn planes_conflict(&self, loops: &[usize], apart: f64) -> ScaleError {
        let faces: BTreeSet<FaceId> =
            loops.iter().filter(|&&k| self.plane(k).is_some()).map(|&k| self.held.loops[k].face).collect();
        ScaleError::PlanesConflict { faces: faces.iter().map(|&f| face_name(self.model, f)).collect(), apart }
    }

    /// Normal of the plane that bears a loop.
    fn plane(&self, number: usize) -> Option<Vector3<f64>> {
        match self.held.bases[&self.held.loops[number].face] {
            Base::Plane(frame) => Some(frame.z),
            Base::Net(_) => None,
        }
    }

    fn shape(&self, number: usize) -> &SpaceLoop {
        &self.held.loops[number].shape
    }

    /// The motion of some loops as one piece: planes decide where there are any.
    fn whole(&self, loops: &[usize]) -> Result<Motion, ScaleError> {
        for &k in loops {
            let shape = self.shape(k);
            if shape.area.norm() < NO_AREA * shape.length * shape.length {
                return Err(self.degenerate(k));
            }
        }
        let on_planes: Vec<usize> = loops.iter().copied().filter(|&k| self.plane(k).is_some()).collect();
        if on_planes.is_empty() { self.on_nets(loops) } else { self.on_planes(&on_planes) }
    }

    fn degenerate(&self, number: usize) -> ScaleError {
        let held = &self.held.loops[number];
        ScaleError::LoopDegenerate { face: face_name(self.model, held.face), held: held.at }
    }

    /// The loop with the greatest vector area; the first of several.
    fn greatest(&self, loops: &[usize]) -> usize {
        let area = |k: usize| self.shape(k).area.norm_squared();
        loops.iter().copied().fold(loops[0], |best, k| if area(k) > area(best) { k } else { best })
    }

    fn on_planes(&self, loops: &[usize]) -> Result<Motion, ScaleError> {
        let reference = self.greatest(loops);
        let normal = self.plane(reference).unwrap_or_else(Vector3::z);
        let side = if normal.dot(&self.shape(reference).area) < 0.0 { -1.0 } else { 1.0 };
        let weighted = loops.iter().map(|&k| self.shape(k).weighted).sum();
        let length = loops.iter().map(|&k| self.shape(k).length).sum();
        let frame = LoopFrame::of_sums(weighted, length, normal * side);
        let motion = self.motion(&[frame]).ok_or_else(|| self.degenerate(reference))?;
        Ok(Motion { directions: Vec::new(), amounts: Vec::new(), ..motion })
    }

    fn motion(&self, frames: &[LoopFrame]) -> Option<Motion> {
        Motion::new(frames, self.params.mode, &self.params.scaling, self.plain)
    }

    fn on_nets(&self, loops: &[usize]) -> Result<Motion, ScaleError> {
        let frames: Vec<LoopFrame> = match self.params.scaling.energy {
            Energy::Slide => {
                let of = |&k: &usize| {
                    let shape = self.shape(k);
                    LoopFrame::of_sums(shape.weighted, shape.length, shape.area)
                };
                loops.iter().map(of).collect()
            }
            Energy::Published => loops.iter().map(|&k| self.published(k)).collect::<Result<_, _>>()?,
        };
        let reference = self.greatest(loops);
        let motion = self.motion(&frames).ok_or_else(|| self.degenerate(reference))?;
        let axis = self.shape(reference).area.normalize();
        let askew = loops.iter().any(|&k| {
            let area = &self.shape(k).area;
            area.dot(&axis).abs() < ASKEW * area.norm()
        });
        let turns = self.params.mode == Hold::Rigid && self.params.scaling.energy == Energy::Slide;
        Ok(if askew && turns { self.on_all_sides(loops, motion, &axis) } else { motion })
    }

    /// The rotation that fits the directions of all ends best (Wahba's problem), for a feature whose ends face
    /// differently.
    fn on_all_sides(&self, loops: &[usize], motion: Motion, axis: &Vector3<f64>) -> Motion {
        let cofactor = cofactor(&self.plain.linear);
        let total: f64 = loops.iter().map(|&k| self.shape(k).area.norm()).sum();
        let products: Matrix3<f64> = loops
            .iter()
            .map(|&k| {
                let area = self.shape(k).area;
                (cofactor * area).normalize() * area.transpose() / total
            })
            .sum();
        let Some(turn) = nearest_rotation(&(products + Matrix3::identity() * STAY)) else { return motion };
        Motion::placed(turn, motion.pivot, turn * axis, self.params.mode, &self.params.scaling, self.plain)
    }

    /// The frame of a loop by unit normals, as published.
    fn published(&self, number: usize) -> Result<LoopFrame, ScaleError> {
        let held = &self.held.loops[number];
        let fault = || self.degenerate(number);
        let base = self.held.bases[&held.face].net().ok_or_else(fault)?;
        let (_, contour) = base.held.iter().find(|(k, _)| *k == number).ok_or_else(fault)?;
        let surface = base.surface.clamped();
        let polygon = polygon(&surface, contour).ok_or_else(fault)?;
        LoopFrame::new(&surface, &polygon, Energy::Published)
            .map_err(|at| ScaleError::SingularParametrisation { face: face_name(self.model, held.face), at })
    }

    /// How far some loop is from the image of its plane, when it is too far; infinite for planes that turn against each
    /// other.
    fn conflict(&self, motion: &Motion, loops: &[usize]) -> Option<f64> {
        let cofactors = [cofactor(&self.plain.linear), cofactor(&motion.linear)];
        let mut worst: Option<f64> = None;
        for &k in loops {
            let Some(normal) = self.plane(k) else { continue };
            let [scaled, moved] = cofactors.map(|c| (c * normal).normalize());
            let center = self.shape(k).center();
            let apart = scaled.dot(&(motion.apply(&center) - self.plain.point(&center))).abs();
            let room = MEETS * (center.coords.norm() + self.shape(k).length);
            if scaled.cross(&moved).norm() > MEETS {
                return Some(f64::INFINITY);
            }
            if apart > room {
                worst = Some(worst.map_or(apart, |w| w.max(apart)));
            }
        }
        worst
    }

    /// Whether a direction passes through a loop and not along it, so that sliding brings the loop onto its scaled surface.
    fn crosses(&self, number: usize, axis: &Vector3<f64>) -> bool {
        let normal = cofactor(&self.plain.linear) * self.plane(number).unwrap_or(self.shape(number).area);
        normal.dot(axis).abs() > ALONG * normal.norm()
    }

    /// How far a loop has to slide along `axis` beyond the motion of the whole to come onto its scaled surface.
    fn slide(&self, number: usize, whole: &Motion, axis: &Vector3<f64>) -> f64 {
        let side = |area: Vector3<f64>| if area.dot(&whole.axis) < 0.0 { -area } else { area };
        let normal = self.plane(number).unwrap_or_else(|| side(self.shape(number).area));
        let normal = cofactor(&self.plain.linear) * normal;
        let center = self.shape(number).center();
        normal.dot(&(self.plain.point(&center) - whole.apply(&center))) / normal.dot(axis)
    }

    /// The feature cut at walls; none when nothing can be cut.
    fn cut_apart(
        &self,
        whole: &Motion,
        loops: &[usize],
        faces: &BTreeSet<FaceId>,
    ) -> Result<Option<Formed>, ScaleError> {
        let mut rings = Vec::new();
        let mut parts: Vec<(RigidPart, Option<Vector3<f64>>)> = Vec::new();
        for component in connected(self.uses, faces, &self.edges_of(loops), &BTreeSet::new()) {
            let numbers = self.edges_of(&component.loops);
            let good = |part: &RigidPart, axis: &Vector3<f64>| self.is_good(part, whole, axis);
            match cut(self.uses, &component.faces, &numbers, &good) {
                Some(Cut { rings: cut, parts: apart }) => {
                    let axis = (whole.linear * cut[0].axis).normalize();
                    parts.extend(apart.into_iter().map(|part| (part, Some(axis))));
                    rings.extend(cut);
                }
                None if self.conflict(whole, &component.loops).is_some() => return Ok(None),
                None => parts.push((component, None)),
            }
        }
        if rings.is_empty() {
            return Ok(None);
        }
        let mut pieces = Vec::new();
        for (part, axis) in self.joined(parts) {
            let motion = match axis {
                Some(axis) => {
                    self.sliding(&part, whole, &axis).map_err(|apart| self.planes_conflict(loops, apart))?
                }
                None => whole.clone(),
            };
            pieces.push(Piece { motion, part });
        }
        Ok(Some(Formed { pieces, rings }))
    }

    fn edges_of(&self, loops: &[usize]) -> LoopEdges {
        let brep = &self.model.brep;
        let edges = |k: usize| -> BTreeSet<EdgeId> {
            brep.loops[self.held.loops[k].id].coedges.iter().map(|&c| brep.coedges[c].edge).collect()
        };
        loops.iter().map(|&k| (k, edges(k))).collect()
    }

    /// Whether a part can be one piece: its planes need one slide, and no two skins where walls shall slide.
    fn is_good(&self, part: &RigidPart, whole: &Motion, axis: &Vector3<f64>) -> bool {
        let axis = (whole.linear * axis).normalize();
        if !part.loops.iter().all(|&k| self.crosses(k, &axis)) {
            return false;
        }
        let slides: Vec<f64> = part
            .loops
            .iter()
            .filter(|&&k| self.plane(k).is_some())
            .map(|&k| self.slide(k, whole, &axis))
            .collect();
        let low = slides.iter().copied().fold(f64::INFINITY, f64::min);
        let high = slides.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let room = MEETS
            * (whole.pivot.coords.norm() + part.loops.iter().map(|&k| self.shape(k).length).sum::<f64>());
        let bases: BTreeSet<FaceId> = part.loops.iter().map(|&k| self.held.loops[k].face).collect();
        let apart = self.params.wall != Wall::Slide || bases.len() < 2;
        apart && (slides.len() < 2 || high - low <= room)
    }

    /// Parts with loops on one stretched face are one: they are in one group because they are too near to part.
    fn joined(
        &self,
        parts: Vec<(RigidPart, Option<Vector3<f64>>)>,
    ) -> Vec<(RigidPart, Option<Vector3<f64>>)> {
        let stretched = |part: &RigidPart| -> BTreeSet<FaceId> {
            let faces = part.loops.iter().filter(|&&k| self.plane(k).is_none());
            faces.map(|&k| self.held.loops[k].face).collect()
        };
        let mut out: Vec<(RigidPart, Option<Vector3<f64>>)> = Vec::new();
        for (mut part, mut axis) in parts {
            let faces = stretched(&part);
            let (near, apart): (Vec<_>, Vec<_>) =
                out.drain(..).partition(|(other, _)| !stretched(other).is_disjoint(&faces));
            for (other, its) in near {
                part.faces.extend(other.faces);
                part.loops.extend(other.loops);
                axis = axis.or(its);
            }
            part.loops.sort_unstable();
            out = apart;
            out.push((part, axis));
        }
        out
    }

    /// The motion of a part that slides along the walls it was cut from; how far it misses its planes where it does.
    fn sliding(&self, part: &RigidPart, whole: &Motion, axis: &Vector3<f64>) -> Result<Motion, f64> {
        let on_plane = part.loops.iter().copied().find(|&k| self.plane(k).is_some());
        let reference = on_plane.unwrap_or(part.loops[0]);
        let slide = self.slide(reference, whole, axis);
        let directions = if on_plane.is_some() { Vec::new() } else { vec![*axis] };
        let target = whole.target + axis * slide;
        let amounts = vec![0.0; directions.len()];
        let motion = Motion { target, axis: *axis, directions, amounts, ..whole.clone() };
        match self.conflict(&motion, &part.loops) {
            Some(apart) => Err(apart),
            None => Ok(motion),
        }
    }
}

fn polygon(surface: &NurbsSurface, contour: &Contour) -> Option<Polygon> {
    let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
    Polygon::new(&contour.points, contour.margin, domain).ok()
}

/// The rule by which the numeric core moves the loops of some faces.
pub(super) struct FaceRule<'a> {
    pub former: &'a Former<'a>,
    /// Faces in the order of the core's tasks.
    pub faces: &'a [FaceId],
}

impl MotionRule for FaceRule<'_> {
    fn arrange(&self, sets: &[Vec<usize>]) -> Result<Arrangement, ScaleError> {
        let mut motions = Vec::new();
        let mut piece_of: BTreeMap<usize, usize> = BTreeMap::new();
        for set in sets {
            for piece in self.former.form(set)?.pieces {
                piece_of.extend(piece.part.loops.iter().map(|&k| (k, motions.len())));
                motions.push(piece.motion);
            }
        }
        let of_face = |face: &FaceId| -> Vec<usize> {
            let base = self.former.held.bases[face].net();
            base.into_iter().flat_map(|base| &base.held).map(|(k, _)| piece_of[k]).collect()
        };
        Ok(Arrangement { motions, of_loop: self.faces.iter().map(of_face).collect() })
    }
}
