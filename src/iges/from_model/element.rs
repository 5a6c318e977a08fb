//! Curves and surfaces: pieces of edges, surfaces of faces, curves in parameters, free curves.

use super::super::lower::draft::Look;
use super::super::lower::{compose_curve, lift};
use super::super::to_model::curve::Piece;
use super::super::to_model::curve2d::Piece2d;
use super::super::to_model::pcurve;
use super::super::{DirectoryEntry, EntryNumber};
use super::{FromModelError, LowerError, Rank, Writer};
use crate::brep::{CoedgeId, EdgeId, FaceId, edge_range};
use crate::geometry::{Curve2d, ParameterMap, Surface};
use crate::model::Origin;

/// An entity that new ones stand for, where there is none.
const NONE: EntryNumber = EntryNumber(0);

impl Writer<'_, '_> {
    /// The piece of its curve that an edge is, run as the curve does.
    pub(super) fn piece(&self, edge: EdgeId) -> Result<Piece, FromModelError> {
        let origin = self.model.origins.edges[edge];
        let brep = &self.model.brep;
        let curve = brep.curve_of(edge).read().ok_or(FromModelError::Unread { origin })?.clone();
        let range = edge_range(brep, edge).ok_or(FromModelError::Unread { origin })?;
        Ok(Piece { curve, range: (range.start.min(range.end), range.start.max(range.end)) })
    }

    pub(super) fn curve(&mut self, piece: &Piece, origin: Origin) -> Result<EntryNumber, FromModelError> {
        let entry = DirectoryEntry::default();
        let look = Look { from: &entry, status: Rank::Part.status() };
        self.lowering.add_curve(NONE, piece, look).map_err(|error| at(error, origin))
    }

    /// All curves that belong to no edge, each with its name.
    pub(super) fn free_curves(&mut self) -> Result<(), FromModelError> {
        let model = self.model;
        for (&id, name) in model.free_curves.iter().zip(&model.free_curve_names) {
            let origin = model.origins.curves[id];
            let curve = model.brep.curves[id].read().ok_or(FromModelError::Unread { origin })?;
            let piece = Piece { curve: curve.clone(), range: curve.domain() };
            let behind = self.named(name)?;
            let entry = DirectoryEntry::default();
            let look = Look { from: &entry, status: Rank::Own.status() };
            let written = self.lowering.add_named_curve(&piece, look, &behind);
            written.map_err(|error| at(error, origin))?;
        }
        Ok(())
    }

    /// The surface of a face, and how the file counts its parameters.
    pub(super) fn surface_of(
        &mut self,
        face: FaceId,
        surface: &Surface,
    ) -> Result<(EntryNumber, ParameterMap), FromModelError> {
        let origin = self.model.origins.faces[face];
        let (record, map) =
            self.lowering.surface_of_new_file(face, surface).map_err(|error| at(error, origin))?;
        Ok((self.add(&record, Rank::Part)?, map))
    }

    /// The curve of a coedge in the file's parameters of a B-spline surface, run as the coedge does; `None` where the
    /// model has none, on a surface whose parameters readers count in several ways, and where it could be taken for the
    /// curve run the other way (a closed one) or at another pace (a conic).
    pub(super) fn pcurve(
        &mut self,
        coedge: CoedgeId,
        piece: &Piece,
        map: &ParameterMap,
    ) -> Result<Option<EntryNumber>, FromModelError> {
        let brep = &self.model.brep;
        let of = &brep.coedges[coedge];
        let face = brep.loops[of.in_loop].face;
        let on_spline = matches!(brep.surface_of(face).read(), Some(Surface::Nurbs(_)));
        let open = brep.edges[of.edge].start != brep.edges[of.edge].end;
        let plain = |curve: &Curve2d| matches!(curve, Curve2d::Line { .. } | Curve2d::Nurbs(_));
        let Some(curve) = of.pcurve.clone().filter(|curve| on_spline && open && plain(curve)) else {
            return Ok(None);
        };
        let own = lift::in_file(&Piece2d { curve, range: piece.range }, map);
        let along = of.forward == brep.edges[of.edge].same_sense;
        let own = own.and_then(|own| if along { Some(own) } else { pcurve::reversed(&own) });
        let Some(lifted) = own.and_then(|own| lift::lifted(&own)) else { return Ok(None) };
        let entry = DirectoryEntry::default();
        let written = self.lowering.add_curve(NONE, &lifted, Look::in_parameters(&entry));
        Ok(written.ok())
    }

    /// A piece run as its coedge does.
    pub(super) fn along(&self, coedge: CoedgeId) -> Result<Piece, FromModelError> {
        let of = &self.model.brep.coedges[coedge];
        let piece = self.piece(of.edge)?;
        let along = of.forward == self.model.brep.edges[of.edge].same_sense;
        Ok(if along { piece } else { compose_curve::reversed(compose_curve::resolved(piece)) })
    }
}

/// The error of an element, by its own name.
pub(super) fn at(error: LowerError, origin: Origin) -> FromModelError {
    match error {
        LowerError::Unwritable { kind, .. } => FromModelError::Unwritable { origin, kind },
        other => other.into(),
    }
}
