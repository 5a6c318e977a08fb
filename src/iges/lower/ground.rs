//! What a face lies on: its surface as the file has it, the space that this is in, and how the file counts its parameters.

use std::collections::BTreeSet;

use super::super::{Entity, EntryNumber};
use super::slot::{Leaves, Slot, unreadable};
use super::{LowerError, Lowering, entry_of};
use crate::brep::{CoedgeId, EdgeId, FaceId, edge_range};
use crate::geometry::{ParameterMap, Surface};
use crate::iges::to_model::curve::{self, Piece};
use crate::iges::to_model::curve2d::Piece2d;
use crate::iges::to_model::pcurve::{self, Fit};
use crate::iges::to_model::surface::{self, SurfaceRead};
use crate::math::Affine;

/// What a face lies on.
#[derive(Debug, Clone)]
pub(super) struct Ground {
    pub(super) face: EntryNumber,
    /// Its surface in the file.
    pub(super) surface: EntryNumber,
    /// Its surface once the changes are made.
    pub(super) surface_now: EntryNumber,
    /// Whether the face is of a shell, whose edges stand in lists.
    pub(super) is_solid: bool,
    /// From the space that the surface and the boundaries stand in, by their own matrices, to that of the model.
    pub(super) within: Affine,
    /// Matrix of the surface's own entry.
    pub(super) own: Affine,
    pub(super) read: SurfaceRead,
    /// From the file's parameters to the model's; as the parameter-space curves of the face have it.
    pub(super) map: ParameterMap,
    /// The same once the changes are made.
    pub(super) map_now: ParameterMap,
    /// Boundaries of a loose face.
    pub(super) leaves: Leaves,
}

impl Ground {
    /// What a face of a new file lies on: nothing stands there yet.
    pub(super) fn of_new_file(surface: &Surface) -> Self {
        let read = SurfaceRead {
            surface: surface.clone(),
            bounds: None,
            parameters: Vec::new(),
            turned: false,
            off: None,
        };
        let none = EntryNumber(0);
        let identity = ParameterMap::identity();
        Self {
            face: none,
            surface: none,
            surface_now: none,
            is_solid: true,
            within: Affine::identity(),
            own: Affine::identity(),
            read,
            map: identity,
            map_now: identity,
            leaves: Leaves::default(),
        }
    }

    /// Whether the face is its surface, within its own bounds.
    pub(super) fn is_natural(&self) -> bool {
        self.face == self.surface
    }

    /// From the surface's own space to the model's.
    pub(super) fn placed(&self) -> Affine {
        if self.own.is_identity() { self.within } else { self.within.after(&self.own) }
    }
}

impl Lowering<'_> {
    /// The ground of a face of the model.
    pub(super) fn ground(&mut self, face: FaceId) -> Result<&mut Ground, LowerError> {
        if !self.grounds.contains_key(&face) {
            let ground = self.find_ground(face)?;
            self.grounds.insert(face, ground);
        }
        self.grounds.get_mut(&face).ok_or_else(|| LowerError::ForeignOrigin { origin: String::new() })
    }

    fn find_ground(&self, face: FaceId) -> Result<Ground, LowerError> {
        let number = entry_of(self.model.origins.faces[face])?;
        let surface = entry_of(self.model.origins.surfaces[self.model.brep.faces[face].surface])?;
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let is_solid = instance.entry().entity_type == Entity::Face.number();
        let within = if is_solid {
            self.space_of_shell(face)?
        } else if number == surface {
            Affine::identity()
        } else {
            self.scope.matrix(instance).map_err(|error| unreadable(number, &error))?
        };
        let read =
            surface::read(&self.scope, surface, &within).map_err(|error| unreadable(surface, &error))?;
        let on = self.scope.instance(surface).map_err(|error| unreadable(surface, &error))?;
        let own = self.scope.matrix(on).map_err(|error| unreadable(surface, &error))?;
        let leaves = if is_solid { Leaves::default() } else { self.leaves(number, &within)? };
        let map = read.parameters.first().copied().unwrap_or_else(ParameterMap::identity);
        let mut ground = Ground {
            face: number,
            surface,
            surface_now: surface,
            is_solid,
            within,
            own,
            read,
            map,
            map_now: map,
            leaves,
        };
        let fits = self.model.brep.coedges_of(face).find_map(|coedge| self.fit(&ground, coedge));
        if let Some((_, fit)) = fits {
            (ground.map, ground.map_now) = (fit.map, fit.map);
        }
        Ok(ground)
    }

    /// The space of the shell that a face is of.
    fn space_of_shell(&self, face: FaceId) -> Result<Affine, LowerError> {
        let shell = self.model.brep.faces[face].shell;
        let body = self.model.brep.shells[shell].body;
        let mut within = Affine::identity();
        let numbers: BTreeSet<EntryNumber> =
            [self.model.origins.bodies[body], self.model.origins.shells[shell]]
                .into_iter()
                .map(entry_of)
                .collect::<Result<_, _>>()?;
        // A shell without a solid is its own body. A solid may come before or behind its shell.
        let (body, shell) =
            (entry_of(self.model.origins.bodies[body])?, entry_of(self.model.origins.shells[shell])?);
        for number in [body, shell].into_iter().take(numbers.len()) {
            let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
            within = self.scope.placed(instance, &within).map_err(|error| unreadable(number, &error))?;
        }
        Ok(within)
    }

    /// The file's parameter-space curve of a coedge, and how it becomes the model's.
    pub(super) fn fit(&self, ground: &Ground, coedge: CoedgeId) -> Option<(Piece2d, Fit)> {
        let number = entry_of(self.model.origins.pcurves[coedge]?).ok()?;
        let leaf = ground.leaves.plane.iter().find(|leaf| leaf.number == number);
        let within = leaf.map_or_else(Affine::identity, |leaf| leaf.within);
        let flat = Piece2d::flat(&curve::read(&self.scope, number, &within).ok()?).ok()?;
        let edge = self.piece_of(self.model.brep.coedges[coedge].edge)?;
        let fit = pcurve::fit(&ground.read, &flat, &edge, self.scope.resolution)?;
        Some((flat, fit))
    }

    /// The piece of its curve that an edge of the model is.
    pub(super) fn piece_of(&self, edge: EdgeId) -> Option<Piece> {
        let curve = self.model.brep.curve_of(edge).read()?.clone();
        let range = edge_range(&self.model.brep, edge)?;
        Some(Piece { curve, range: (range.start, range.end) })
    }

    /// Pointers to the surface from a face and its boundaries: chains that begin at the face.
    pub(super) fn surface_chains(&self, ground: &Ground) -> Result<Vec<Vec<Slot>>, LowerError> {
        if ground.is_natural() {
            return Ok(Vec::new());
        }
        let own = vec![self.slot(ground.face, "surface")?];
        let behind = ground
            .leaves
            .surface
            .iter()
            .filter(|chain| chain.last().is_some_and(|slot| slot.target == ground.surface));
        Ok(std::iter::once(own).chain(behind.cloned()).collect())
    }
}
